//! The isotropic GGX microfacet distribution.

use std::f32::consts::PI;

use glam::Vec3;

use crate::elementary::{circle, unit_or};

/// Widths below this are treated as a perfect mirror.
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// GGX (Trowbridge–Reitz) facets of width α with Smith's height-correlated shadowing
/// [Walter et al. 2007; Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 99].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// α².
    pub alpha2: f32,
}

impl Ggx {
    /// Facets of a perceptual roughness in [0, 1]: α = roughness².
    #[inline]
    pub fn from_roughness(roughness: f32) -> Self {
        let alpha = roughness * roughness;
        Self { alpha2: alpha * alpha }
    }

    /// Returns `true` for a mirror: α < 0.001.
    #[inline]
    pub fn is_smooth(&self) -> bool {
        self.alpha2 < SMOOTH_ALPHA * SMOOTH_ALPHA
    }

    /// Density of facet normals D(h), normalized as ∫ D cosθ dω = 1.
    #[inline]
    pub fn density(&self, h: Vec3) -> f32 {
        // sin² from x and y keeps its digits where 1 − cos² would lose them.
        let t = self.alpha2 * h.z * h.z + (h.x * h.x + h.y * h.y);
        self.alpha2 / (PI * t * t)
    }

    /// Smith's Λ for a direction with cosine `cos` ≠ 0 to the normal, on either side.
    #[inline]
    pub fn lambda(&self, cos: f32) -> f32 {
        // Squares of the least cosines would vanish
        let cos2 = (cos * cos).max(1e-30);
        0.5 * ((1.0 + self.alpha2 * (1.0 - cos2).max(0.0) / cos2).sqrt() - 1.0)
    }

    /// Part of the visible facets' area that is not masked.
    #[inline]
    pub fn masking(&self, cos: f32) -> f32 {
        1.0 / (1.0 + self.lambda(cos))
    }

    /// Masking and shadowing together, correlated by height.
    #[inline]
    pub fn masking_shadowing(&self, cos_o: f32, cos_i: f32) -> f32 {
        1.0 / (1.0 + self.lambda(cos_o) + self.lambda(cos_i))
    }

    /// Density D_v(h) of the normals that `wo` (z > 0) sees, per solid angle of h.
    #[inline]
    pub fn visible_density(&self, wo: Vec3, h: Vec3) -> f32 {
        self.masking(wo.z) * wo.dot(h).max(0.0) * self.density(h) / wo.z
    }

    /// A facet normal with density [`Ggx::visible_density`]
    /// [Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps"].
    #[inline]
    pub fn sample_visible(&self, wo: Vec3, v: [f32; 2]) -> Vec3 {
        let alpha = self.alpha2.sqrt();
        let stretched = Vec3::new(wo.x * alpha, wo.y * alpha, wo.z).normalize();
        let z = (1.0 - v[0]) * (1.0 + stretched.z) - stretched.z;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let around = circle(v[1]);
        let h = Vec3::new(r * around.x, r * around.y, z) + stretched;
        unit_or(Vec3::new(h.x * alpha, h.y * alpha, h.z.max(0.0)), Vec3::Z)
    }

    /// f cosθi of a white lobe that mirrors at these facets, and its sampling density; `h` is the half vector.
    #[inline]
    pub fn reflection(&self, wo: Vec3, wi: Vec3, h: Vec3) -> [f32; 2] {
        let density = self.density(h) / (4.0 * wo.z);
        let (lambda_o, lambda_i) = (self.lambda(wo.z), self.lambda(wi.z));
        [density / (1.0 + lambda_o + lambda_i), density / (1.0 + lambda_o)]
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    fn direction(mu: f32) -> Vec3 {
        Vec3::new((1.0 - mu * mu).sqrt(), 0.0, mu)
    }

    /// Integral over the upper hemisphere: midpoints in x, μ = 1 − x², which are dense around the normal.
    fn integrate(f: impl Fn(Vec3) -> f32) -> f64 {
        let (n_mu, n_phi) = (1000, 400);
        let mut sum = 0.0;
        for i in 0..n_mu {
            let x = (i as f32 + 0.5) / n_mu as f32;
            let mu = 1.0 - x * x;
            let r = x * (1.0 + mu).sqrt();
            for j in 0..n_phi {
                let (sin, cos) = ((j as f32 + 0.5) / n_phi as f32 * TAU).sin_cos();
                sum += f64::from(f(Vec3::new(r * cos, r * sin, mu)) * 2.0 * x);
            }
        }
        sum * f64::from(TAU) / f64::from(n_mu * n_phi)
    }

    #[test]
    fn density_projects_to_one() {
        for roughness in [0.3, 0.6, 1.0] {
            let ggx = Ggx::from_roughness(roughness);
            let total = integrate(|h| ggx.density(h) * h.z);
            assert!((total - 1.0).abs() < 2e-3, "{roughness}: {total}");
        }
    }

    #[test]
    fn visible_density_integrates_to_one() {
        for roughness in [0.4, 0.7, 1.0] {
            let ggx = Ggx::from_roughness(roughness);
            for mu in [0.05, 0.4, 0.99] {
                let total = integrate(|h| ggx.visible_density(direction(mu), h));
                assert!((total - 1.0).abs() < 3e-3, "{roughness} {mu}: {total}");
            }
        }
    }

    #[test]
    fn sample_visible_follows_its_density() {
        // Mean of h from stratified samples against the integral with the density.
        for roughness in [0.5, 0.9] {
            let ggx = Ggx::from_roughness(roughness);
            for mu in [0.1, 0.6, 1.0] {
                let wo = direction(mu);
                let n = 200;
                let mut mean = [0.0_f64; 2];
                for k in 0..n * n {
                    let v = [((k % n) as f32 + 0.5) / n as f32, ((k / n) as f32 + 0.5) / n as f32];
                    let h = ggx.sample_visible(wo, v);
                    mean[0] += f64::from(h.x) / f64::from(n * n);
                    mean[1] += f64::from(h.z * h.z) / f64::from(n * n);
                }
                let x = integrate(|h| h.x * ggx.visible_density(wo, h));
                let z2 = integrate(|h| h.z * h.z * ggx.visible_density(wo, h));
                assert!(
                    (mean[0] - x).abs() < 2e-3 && (mean[1] - z2).abs() < 2e-3,
                    "{roughness} {mu}: {mean:?} {x} {z2}"
                );
            }
        }
    }
}
