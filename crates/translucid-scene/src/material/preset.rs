//! Presets of translucent materials as materials of a scene.

use glam::DVec3;
use translucid_profile::convention::{Preset, Unit};

use super::{Configuration, Material, SubsurfaceParameter};
use crate::{ColorInput, ScalarInput};

impl Material {
    /// The material of a preset in a scene of the given unit. What is clear refracts and absorbs light, and scatters none.
    ///
    /// ```
    /// use translucid_profile::convention::{Unit, preset};
    /// use translucid_scene::Material;
    ///
    /// let jade = Material::of_preset(preset("jade")?, Unit::Centimeter);
    /// assert_eq!(jade.subsurface_radius.factor, 0.48); // the longest mean free path, 4.8 mm
    /// # Ok::<(), translucid_profile::InputError>(())
    /// ```
    pub fn of_preset(preset: &Preset, unit: Unit) -> Self {
        let mfp = DVec3::from(preset.mfp_in_millimeters()) / unit.in_millimeters();
        let radius = mfp.max_element();
        let surface_albedo = ColorInput::constant(DVec3::from(preset.surface_albedo()).as_vec3());
        let clear = preset.clear_color();
        let is_clear = if clear.is_some() { 1.0 } else { 0.0 };
        let depth = if clear.is_some() { Preset::CLEAR_DEPTH / unit.in_millimeters() } else { 0.0 };
        let [coat_weight, coat_roughness] = preset.coat.map(|number| ScalarInput::constant(number as f32));
        Self {
            name: String::from(preset.name),
            base_color: surface_albedo,
            specular_ior: preset.eta as f32,
            specular_roughness: ScalarInput::constant(preset.roughness as f32),
            transmission_weight: ScalarInput::constant(is_clear),
            transmission_color: ColorInput::constant(DVec3::from(clear.unwrap_or([1.0; 3])).as_vec3()),
            transmission_depth: depth as f32,
            coat_weight,
            coat_roughness,
            subsurface_weight: ScalarInput::constant(1.0 - is_clear),
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

    /// Beer and Lambert: what passes a depth is e^(−σ_a depth).
    #[test]
    fn preset_of_a_drink_absorbs_as_measured() {
        let merlot = preset("merlot").unwrap();
        let material = Material::of_preset(merlot, Unit::Centimeter);
        assert_eq!((material.transmission_weight.factor, material.subsurface_weight.factor), (1.0, 0.0));
        let passes = material.transmission_color.factor.as_dvec3();
        let depth = f64::from(material.transmission_depth) * Unit::Centimeter.in_millimeters();
        let expected = DVec3::from(merlot.clear_absorption().unwrap());
        assert!((-passes.map(f64::ln) / depth / expected - 1.0).abs().max_element() < 1e-6);
    }

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
