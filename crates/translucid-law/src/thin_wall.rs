//! The other side of a thin-walled surface [OpenPBR Surface 1.1, "Thin-walled mode"].
//!
//! The clear part is a sheet whose two faces reflect F each, and which passes c of the light on a way across. The light that
//! goes to and fro in it adds up to
//!
//! ```text
//! T = c (1 − F)² / (1 − c² F²)      R = F + c F T      c = transmission_color^(1 / cosθt)
//! ```
//!
//! that is R = 2F / (1 + F) = 1 − T where it absorbs nothing. Light that passes goes straight on, or, behind rough faces, as
//! if facets of another roughness had mirrored it and the sheet had mirrored that. As in Cycles, R and T are those of the
//! sheet as a whole: facets change directions, not shares.

use glam::Vec3;

use crate::dielectric::fresnel_dielectric;
use crate::elementary::color_power;

/// Reflectance and transmittance of a smooth clear sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Share that returns.
    pub reflectance: Vec3,
    /// Share that passes.
    pub transmittance: Vec3,
}

impl Slab {
    /// A sheet of the index `eta` ≥ 1 that is seen at `cos` and that passes `color` of the light along its normal.
    #[inline]
    pub fn new(cos: f32, eta: f32, color: Vec3) -> Self {
        let f = fresnel_dielectric(cos, eta);
        let cos_inside = (1.0 - (1.0 - cos * cos) / (eta * eta)).max(0.0).sqrt();
        let passed = color_power(color, 1.0 / cos_inside.max(1e-4));
        let reflected = passed * f;
        let transmittance =
            passed * ((1.0 - f) * (1.0 - f)) / (1.0 - reflected * reflected).max(Vec3::splat(1e-6));
        Self { reflectance: f + reflected * transmittance, transmittance }
    }
}

/// Perceptual roughness of the facets that stand for two refractions at faces of a perceptual roughness: their width is
/// √(3.4 (η − 1) (η − ½)² / η³) of the faces' [Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks"; the
/// slides have 3.7, where Cycles has 3.4].
#[inline]
pub fn roughness_through(roughness: f32, eta: f32) -> f32 {
    let step = (eta - 0.5) / eta;
    let width = (3.4 * (eta - 1.0) / eta).max(0.0).sqrt() * step;
    (roughness * width.sqrt()).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slab_adds_up_all_ways_across() {
        let color = Vec3::new(1.0, 0.8, 0.0);
        for cos in [1.0, 0.5, 0.1] {
            let f = f64::from(fresnel_dielectric(cos, 1.5));
            let cos_inside = (1.0 - (1.0 - f64::from(cos * cos)) / 2.25).sqrt();
            let slab = Slab::new(cos, 1.5, color);
            for channel in 0..3 {
                let c = f64::from(color[channel]).powf(1.0 / cos_inside);
                let (mut reflected, mut passed, mut inside) = (f, 0.0, (1.0 - f) * c);
                for way in 0..100 {
                    *if way % 2 == 0 { &mut passed } else { &mut reflected } += inside * (1.0 - f);
                    inside *= f * c;
                }
                assert!((f64::from(slab.reflectance[channel]) - reflected).abs() < 1e-5, "{cos} {channel}");
                assert!((f64::from(slab.transmittance[channel]) - passed).abs() < 1e-5, "{cos} {channel}");
            }
        }
    }

    #[test]
    fn clear_slab_loses_nothing() {
        for eta in [1.0, 1.5, 4.0] {
            for cos in [0.0, 1e-3, 0.3, 1.0] {
                let slab = Slab::new(cos, eta, Vec3::ONE);
                assert!(
                    (slab.reflectance + slab.transmittance - 1.0).abs().max_element() < 1e-5,
                    "{eta} {cos}: {slab:?}"
                );
            }
        }
    }
}
