//! Metals of systems in which the weight and the color of the highlight are those of what is no metal.
//!
//! In OpenPBR they are a metal's, too: with a weight of 0 it would be black.

use glam::Vec3;
use translucid_scene::{ColorInput, Material, ScalarInput};

/// Gives a metal the whole of its highlight; says what changes where the material is partly none.
pub(crate) fn reflect_fully(material: &mut Material) -> Option<&'static str> {
    let (weight, color) = (ScalarInput::constant(1.0), ColorInput::constant(Vec3::ONE));
    let is_plain = material.specular_weight == weight && material.specular_color == color;
    if material.base_metalness.factor <= 0.0 || is_plain {
        return None;
    }
    (material.specular_weight, material.specular_color) = (weight, color);
    let is_all_metal = material.base_metalness == ScalarInput::constant(1.0);
    (!is_all_metal).then_some(
        "the weight and the color of its highlight are left out, as for metals, and so they are where it is no metal",
    )
}
