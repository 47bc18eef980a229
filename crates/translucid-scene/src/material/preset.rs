//! Presets of translucent materials as materials of a scene.

use glam::DVec3;
use translucid_profile::convention::{Preset, Unit};

use super::{Configuration, Material, SubsurfaceParameter};
use crate::{ColorInput, ScalarInput};

impl Material {
    /// The material of a preset in a scene of the given unit.
    ///
    /// ```
    /// use translucid_profile::convention::{Unit, preset};
    /// use translucid_scene::Material;
    ///
    /// let jade = Material::of_preset(preset("jade")?, Unit::Centimeter);
    /// assert_eq!(jade.subsurface_radius.factor, 0.26); // the longest mean free path, 2.6 mm
    /// # Ok::<(), translucid_profile::InputError>(())
    /// ```
    pub fn of_preset(preset: &Preset, unit: Unit) -> Self {
        let mfp = DVec3::from(preset.mfp_in_millimeters()) / unit.in_millimeters();
        let radius = mfp.max_element();
        let surface_albedo = ColorInput::constant(DVec3::from(preset.surface_albedo()).as_vec3());
        Self {
            name: String::from(preset.name),
            base_color: surface_albedo,
            specular_ior: preset.eta,
            specular_roughness: ScalarInput::constant(preset.roughness),
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_color: surface_albedo,
            subsurface_radius: ScalarInput::constant(radius as f32),
            subsurface_radius_scale: ColorInput::constant((mfp / radius).as_vec3()),
            subsurface_parameter: SubsurfaceParameter::Mfp,
            subsurface_configuration: Configuration::Diffuse,
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::convention::preset;

    use super::*;

    #[test]
    fn preset_lengths_follow_the_scene_unit() {
        let preset = preset("skin1").unwrap();
        for unit in [Unit::Millimeter, Unit::Centimeter, Unit::Meter] {
            let material = Material::of_preset(preset, unit);
            let mfp = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
            let millimeters = mfp.as_dvec3() * unit.in_millimeters();
            let expected = DVec3::from(preset.mfp_in_millimeters());
            assert!((millimeters / expected - 1.0).abs().max_element() < 1e-6, "{unit:?}");
            assert!(material.subsurface_radius_scale.factor.max_element() <= 1.0);
        }
    }
}
