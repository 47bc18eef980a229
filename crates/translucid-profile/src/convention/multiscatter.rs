//! The medium of a multi-scatter color, by the approximation that several systems share.
//!
//! H. C. van de Hulst, *Multiple Light Scattering*, 1980, has the surface albedo c of a half space of isotropic scatterers, and
//! C. Kulla and A. Conty, *Revisiting Physically Based Shading at Imageworks*, 2017, solve it for the single-scattering albedo α:
//!
//! ```text
//! c = (1 − s)(1 − 0.139 s)/(1 + 1.17 s)
//! s = 4.09712 + 4.20863 c − √(9.59217 + 41.6808 c + 17.7126 c²)
//! α = (1 − s²)/(1 − g s²)
//! ```
//!
//! With g it is the medium that is similar to the isotropic one.

/// Single-scattering albedo α of a color, at a mean cosine g; the color is clamped to [0, 1].
pub(super) fn single_scattering_albedo(color: f64, g: f64) -> f64 {
    let color = color.max(0.0).min(1.0);
    let root = (9.59217 + 41.6808 * color + 17.7126 * color * color).sqrt();
    let s = 4.09712 + 4.20863 * color - root;
    ((1.0 - s * s) / (1.0 - g * s * s)).max(0.0).min(1.0)
}

/// Color of the reduced single-scattering albedo α'.
pub(super) fn color(alpha_prime: f64) -> f64 {
    let s = (1.0 - alpha_prime).max(0.0).sqrt();
    (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Configuration, half_space_surface_albedo};

    #[test]
    fn color_inverts_the_albedo() {
        for i in 0..=100 {
            let c = f64::from(i) / 100.0;
            // The published inverse has six digits
            assert!((color(single_scattering_albedo(c, 0.0)) - c).abs() < 2e-5, "{c}");
        }
    }

    /// Within 0.002 of the exact half space; g finds the similar medium.
    #[test]
    fn color_is_nearly_the_surface_albedo() {
        for i in 1..=100 {
            let c = f64::from(i) / 100.0;
            let alpha = single_scattering_albedo(c, 0.0);
            let exact = half_space_surface_albedo(alpha, Configuration::Diffuse);
            assert!((exact - c).abs() < 2.5e-3, "{c}: {exact}");
            for g in [-0.6, 0.8] {
                let alpha_g = single_scattering_albedo(c, g);
                let similar = alpha_g * (1.0 - g) / (1.0 - g * alpha_g);
                assert!((similar - alpha).abs() < 1e-12, "{c} {g}");
            }
        }
    }
}
