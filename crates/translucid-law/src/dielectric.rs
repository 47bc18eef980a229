//! Reflection and refraction at a smooth dielectric interface.

use glam::Vec3;

/// Fresnel reflectance of unpolarized light.
///
/// `cos` ≥ 0 is the cosine on the side where the light is, `eta` the index of the other side over that of
/// this side. 1 beyond the critical angle, exactly 0 at `eta` = 1 [Born & Wolf, *Principles of Optics*, 1.5.2].
#[inline]
pub fn fresnel_dielectric(cos: f32, eta: f32) -> f32 {
    // Roots of squares need not be exact on devices
    if eta == 1.0 {
        return 0.0;
    }
    let mu = cos.clamp(0.0, 1.0);
    // n² cos²θt = n² − sin²θi, without the cancellation of 1 − cos² near grazing.
    let g2 = (eta - 1.0) * (eta + 1.0) + mu * mu;
    if g2 <= 0.0 {
        return 1.0;
    }
    let g = g2.sqrt();
    let eta2 = eta * eta;
    let s = (mu - g) / (mu + g);
    let p = (eta2 * mu - g) / (eta2 * mu + g);
    0.5 * (s * s + p * p)
}

/// Index whose reflectance at normal incidence is `weight` times that of `ior` ≥ 1
/// [OpenPBR Surface 1.1, "Dielectric base"]; 1 at `weight` = 0.
#[inline]
pub fn scaled_ior(ior: f32, weight: f32) -> f32 {
    let root = (ior - 1.0) / (ior + 1.0) * weight.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Direction refracted at a facet with normal `h` on the side of `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refracted {
    /// Unit vector.
    pub direction: Vec3,
    /// `false` beyond the critical angle, where there is no direction.
    pub exists: bool,
}

/// Refracts at a facet with normal `h` on the side of `wo`.
#[inline]
pub fn refracted(wo: Vec3, h: Vec3, eta: f32) -> Refracted {
    let cos_o = wo.dot(h);
    let g2 = (eta - 1.0) * (eta + 1.0) + cos_o * cos_o;
    if g2 <= 0.0 {
        return Refracted { direction: Vec3::ZERO, exists: false };
    }
    let wi = (-wo + h * (cos_o - g2.sqrt())) / eta;
    Refracted { direction: wi.normalize(), exists: true }
}

/// Direction [refracted] at a facet; `None` beyond the critical angle.
#[inline]
pub fn refract(wo: Vec3, h: Vec3, eta: f32) -> Option<Vec3> {
    let refracted = refracted(wo, h, eta);
    refracted.exists.then_some(refracted.direction)
}

/// Mirror direction of `wo` about `h`.
#[inline]
pub fn mirrored(wo: Vec3, h: Vec3) -> Vec3 {
    h * (2.0 * wo.dot(h)) - wo
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cosine on the other side, 0 beyond the critical angle.
    fn refracted_cos(cos: f32, eta: f32) -> f32 {
        ((eta - 1.0) * (eta + 1.0) + cos * cos).max(0.0).sqrt() / eta
    }

    #[test]
    fn fresnel_matches_known_values() {
        // Normal incidence ((n−1)/(n+1))²; at Brewster's angle only s: ½((n²−1)/(n²+1))²; 60° from the formulas.
        assert!((fresnel_dielectric(1.0, 1.5) - 0.04).abs() < 1e-7);
        assert!((fresnel_dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-7);
        let brewster = 1.0 / (1.0 + 1.5_f32 * 1.5).sqrt();
        assert!((fresnel_dielectric(brewster, 1.5) - 0.5 * (1.25_f32 / 3.25).powi(2)).abs() < 1e-6);
        assert!((fresnel_dielectric(0.5, 1.5) - 0.089_185).abs() < 1e-5);
        assert!((fresnel_dielectric(0.0, 1.5) - 1.0).abs() < 1e-7);
        assert_eq!(fresnel_dielectric(0.5, 0.5), 1.0);
    }

    #[test]
    fn fresnel_vanishes_without_index_step() {
        for i in 0..=100 {
            assert_eq!(fresnel_dielectric(i as f32 / 100.0, 1.0), 0.0);
        }
    }

    #[test]
    fn fresnel_is_the_same_from_both_sides() {
        for eta in [1.1_f32, 1.5, 2.4, 4.0] {
            for i in 1..=50 {
                let cos = i as f32 / 50.0;
                let other = refracted_cos(cos, eta);
                let difference = fresnel_dielectric(cos, eta) - fresnel_dielectric(other, 1.0 / eta);
                // Near grazing the inside cosine stands by its last bits only.
                assert!(difference.abs() < 1e-4, "{cos} {eta}: {difference}");
            }
        }
    }

    #[test]
    fn scaled_ior_scales_normal_reflectance() {
        for weight in [0.0, 0.3, 1.0] {
            let f = fresnel_dielectric(1.0, scaled_ior(1.5, weight));
            assert!((f - 0.04 * weight).abs() < 1e-6, "{weight}: {f}");
        }
        assert_eq!(scaled_ior(1.5, 0.0), 1.0);
    }

    #[test]
    fn refract_obeys_snell() {
        let h = Vec3::new(0.1, -0.2, 1.0).normalize();
        for i in 1..20 {
            let wo = Vec3::new((i as f32 * 0.05).sin(), 0.0, (i as f32 * 0.05).cos());
            for eta in [1.5, 1.0, 0.9] {
                let Some(wi) = refract(wo, h, eta) else { continue };
                let tangential = (wo - h * wo.dot(h)) + (wi - h * wi.dot(h)) * eta;
                assert!(tangential.length() < 1e-5 && wi.dot(h) < 0.0, "{wo} {eta}");
                assert!((wi.dot(h) + refracted_cos(wo.dot(h), eta)).abs() < 1e-5);
            }
        }
    }
}
