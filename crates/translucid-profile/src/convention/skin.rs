//! Blender Cycles' "Random Walk (Skin)": the radius as the diffuse mean free path of a dipole.
//!
//! ```text
//! ℓ* = radius √(3 (1 − α')),     A = (α'/2) (1 + e^{−(4/3) A_F √(3(1−α'))}) e^{−√(3(1−α'))}
//! ```
//!
//! The second equation, from which the code finds α', is H. W. Jensen, S. R. Marschner, M. Levoy and P. Hanrahan, *A
//! Practical Model for Subsurface Light Transport*, 2001; A_F = (1 + F_dr)/(1 − F_dr) with the polynomial
//! F_dr = −1.440/η² + 0.710/η + 0.668 + 0.0636 η.
//! The code bisects twelve times, so α' is a multiple of 2⁻¹²: a rule to be kept, since an exact α' would be another
//! material.

/// Factor √(3(1 − α')) from the radius to the transport mean free path.
pub(super) fn mfp_per_radius(surface_albedo: f64, ior: f64) -> f64 {
    (3.0 * (1.0 - alpha_prime(surface_albedo, ior))).sqrt()
}

/// Reduced albedo α' as Cycles finds it, with its limits at dark and bright albedos and twelve bisections.
fn alpha_prime(surface_albedo: f64, ior: f64) -> f64 {
    if surface_albedo < 1e-4 {
        return 0.0;
    }
    if surface_albedo >= 0.995 {
        return 0.999999;
    }
    let boundary = boundary_factor(ior);
    let (mut low, mut high, mut middle) = (0.0, 1.0, 0.5);
    for _ in 0..12 {
        middle = 0.5 * (low + high);
        if dipole_total(middle, boundary) < surface_albedo {
            low = middle;
        } else {
            high = middle;
        }
    }
    middle
}

/// Total of the standard dipole.
fn dipole_total(alpha_prime: f64, boundary: f64) -> f64 {
    let root = (3.0 * (1.0 - alpha_prime)).sqrt();
    0.5 * alpha_prime * (1.0 + libm::exp(-4.0 / 3.0 * boundary * root)) * libm::exp(-root)
}

/// A_F of an index of refraction, which Cycles keeps in [1.01, 3.8].
fn boundary_factor(ior: f64) -> f64 {
    let eta = ior.max(1.01).min(3.8);
    let reflected = (0.710 - 1.440 / eta) / eta + 0.668 + 0.0636 * eta;
    (1.0 + reflected) / (1.0 - reflected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_prime_inverts_the_dipole_to_its_twelve_bits() {
        for ior in [1.01, 1.4, 2.0] {
            for a in [1e-3, 0.1, 0.5, 0.9, 0.99] {
                let alpha = alpha_prime(a, ior);
                assert_eq!((alpha * 4096.0).fract(), 0.0);
                let (below, above) = (alpha - 1.0 / 4096.0, (alpha + 1.0 / 4096.0).min(1.0));
                let boundary = boundary_factor(ior);
                assert!(
                    dipole_total(below, boundary) < a && a < dipole_total(above, boundary),
                    "{ior} {a}: {alpha}"
                );
            }
        }
    }

    #[test]
    fn mfp_per_radius_is_positive_everywhere() {
        assert_eq!(mfp_per_radius(0.0, 1.4), 3f64.sqrt());
        assert!((mfp_per_radius(1.0, 1.4) - 3e-6f64.sqrt()).abs() < 1e-12);
        for i in 0..=1000 {
            let factor = mfp_per_radius(f64::from(i) / 1000.0, 1.4);
            assert!(factor > 1e-3 && factor <= 3f64.sqrt(), "{i}: {factor}");
        }
    }
}
