//! The factor by which a profile is normalized, given the share of it that the body holds.

use glam::Vec3;
use translucid_scene::{Material, SubsurfaceNormalization};

/// Least N: a body that holds less of the profile is a point to it.
const LEAST_ENERGY: f32 = 1e-6;

/// Factor on the light that leaves where the surfaces around hold the share N of the profile's energy; 1 where a channel has
/// no profile.
pub(crate) fn shape_factor(material: &Material, energy: Vec3) -> Vec3 {
    match material.subsurface_normalization {
        SubsurfaceNormalization::None => Vec3::ONE,
        SubsurfaceNormalization::Energy => {
            energy.map(|n| if n > 0.0 { n.max(LEAST_ENERGY).recip() } else { 1.0 })
        }
    }
}
