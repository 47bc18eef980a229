//! Inside of a glTF material: transmission, absorption and scattering.
//!
//! - *Clear*: KHR_materials_transmission is `transmission_weight` (red channel). Its tint is the base
//!   color, or, with an attenuationDistance d in KHR_materials_volume, `transmission_color` =
//!   attenuationColor at `transmission_depth` = d.
//! - *Scattering*, of two drafts. KHR_materials_volume_scatter (KhronosGroup/glTF pull request 2453) states
//!   ρ = multiscatterColorFactor, at first spelled multiscatterColor, the color after many scattering events,
//!   which is `subsurface_color`. KHR_materials_volume then gives the extinction σ_t = −ln(c)/d per channel of
//!   the attenuation color c, whatever the anisotropy, so that `subsurface_radius` ×
//!   `subsurface_radius_scale` = d / −ln(c), the mean free path. As much light enters as
//!   KHR_materials_diffuse_transmission says, else as KHR_materials_transmission says:
//!   `subsurface_weight`. The diffuse transmission's color multiplies `subsurface_color`.
//!   KHR_materials_scatter (pull request 2579) is to take the place of both: scatterStrengthFactor times ρ is
//!   `subsurface_color`, and KHR_materials_transmission says how much light enters.
//! - *Absorbing, entered diffusely*: KHR_materials_diffuse_transmission with a volume but no scattering
//!   is how files described wax and skin before; ρ is then the diffuse transmission's color.
//! - *Thin-walled*: where no volume has a thickness, all of them describe a sheet, `geometry_thin_walled`, with what
//!   it passes clearly in `transmission_weight`, tinted by the base color, and what it scatters in `subsurface_weight`.
//!   Of the base's light, KHR_materials_transmission lets through t. KHR_materials_diffuse_transmission takes its factor
//!   of the rest and passes all of it to the other side, as a mean cosine of 1 does. KHR_materials_scatter takes its
//!   strength s of t and divides that by its anisotropy, as OpenPBR does:
//!
//!   ```text
//!   transmission_weight = t (1 − s)      subsurface_weight = t s / (1 − t (1 − s))
//!   ```
//!
//! The drafts find the single-scattering albedo from ρ by the approximation of C. Kulla and A. Conty (2017), we by the
//! inversion that our models have, so that ρ itself comes out. A boundary that refracts is left out, as for any material
//! without `subsurface_eta`.
//!
//! Lengths in the extensions are meters in world space.
//! An example of KHR_materials_volume_scatter's draft has a volume without a thickness: beside it, every volume is one.

use glam::Vec3;
use serde::Deserialize;
use translucid_scene::{Channel, ColorInput, Material, ScalarInput, SceneError};

use super::document::TextureInfo;
use super::materials::{MaterialReader, white};

/// KHR_materials_transmission.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Transmission {
    #[serde(default)]
    transmission_factor: f32,
    transmission_texture: Option<TextureInfo>,
}

/// KHR_materials_volume.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Volume {
    #[serde(default)]
    thickness_factor: f32,
    attenuation_distance: Option<f64>,
    #[serde(default = "white")]
    attenuation_color: [f32; 3],
}

/// KHR_materials_volume_scatter, in both of its spellings.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct VolumeScatter {
    multiscatter_color: Option<[f32; 3]>,
    multiscatter_color_factor: Option<[f32; 3]>,
    multiscatter_color_texture: Option<TextureInfo>,
    #[serde(default)]
    scatter_anisotropy: f32,
}

/// KHR_materials_scatter.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Scatter {
    #[serde(default)]
    scatter_strength_factor: f32,
    scatter_strength_texture: Option<TextureInfo>,
    #[serde(default = "white")]
    multiscatter_color_factor: [f32; 3],
    multiscatter_color_texture: Option<TextureInfo>,
    #[serde(default)]
    scatter_anisotropy: f32,
}

/// Scattering inside, whichever extension states it.
struct Scattering {
    /// How much of the light that is let through is scattered.
    strength: f32,
    /// Color after many scattering events.
    color: ColorInput,
    /// Mean cosine of the phase function.
    g: f32,
}

/// KHR_materials_diffuse_transmission.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct DiffuseTransmission {
    #[serde(default)]
    diffuse_transmission_factor: f32,
    diffuse_transmission_texture: Option<TextureInfo>,
    #[serde(default = "white")]
    diffuse_transmission_color_factor: [f32; 3],
    diffuse_transmission_color_texture: Option<TextureInfo>,
}

/// Attenuation colors above this would make the mean free path longer than 10⁴ attenuation distances.
const CLEAREST: f64 = 0.9999;

/// Mean cosine of a sheet that scatters all light to its other side, as near to 1 as materials have it.
const FORWARD: f32 = 0.9999;

/// Attenuation of a volume: the color that is left after a distance in scene units.
#[derive(Clone, Copy)]
struct Attenuation {
    color: Vec3,
    distance: f32,
}

impl Attenuation {
    /// Mean free path per channel, d / −ln c.
    fn mean_free_path(&self) -> Vec3 {
        let path = |c: f32| (f64::from(self.distance) / -libm::log(f64::from(c).min(CLEAREST))) as f32;
        Vec3::from_array(self.color.to_array().map(path))
    }
}

impl MaterialReader<'_> {
    /// Transmission and subsurface parameters.
    pub(super) fn read_media(&mut self, material: &mut Material) -> Result<(), SceneError> {
        let volume = self.extension::<Volume>("KHR_materials_volume")?;
        let attenuation = volume.as_ref().and_then(|volume| self.attenuation(volume));
        let transmission = self.extension::<Transmission>("KHR_materials_transmission")?;
        let clear = match &transmission {
            Some(data) => {
                let texture = data.transmission_texture.as_ref();
                self.weight(data.transmission_factor, texture, Channel::Red, "transmissionFactor")?
            }
            None => ScalarInput::constant(0.0),
        };
        let mut diffuse = self.extension::<DiffuseTransmission>("KHR_materials_diffuse_transmission")?;
        let mut is_thin = volume.as_ref().is_none_or(|volume| volume.thickness_factor <= 0.0);
        let scatter = match self.extension::<Scatter>("KHR_materials_scatter")? {
            Some(data) => {
                for name in ["KHR_materials_volume_scatter", "KHR_materials_diffuse_transmission"] {
                    if self.data.extensions.contains_key(name) {
                        self.warn(&format!(
                            "{name} is left out beside KHR_materials_scatter, which replaces it"
                        ));
                    }
                }
                diffuse = None;
                self.scattering(&data)?
            }
            None => match self.extension::<VolumeScatter>("KHR_materials_volume_scatter")? {
                Some(data) if volume.is_some() => {
                    is_thin = false;
                    Some(self.volume_scattering(&data)?)
                }
                Some(_) => {
                    self.warn("KHR_materials_volume_scatter without KHR_materials_volume is left out");
                    None
                }
                None => None,
            },
        };
        if is_thin {
            return self.read_thin_wall(material, clear, scatter.as_ref(), diffuse.as_ref());
        }
        match (attenuation, scatter, &diffuse) {
            (Some(attenuation), Some(scatter), _) => {
                let (weight, tint) = self.entering(clear, diffuse.as_ref())?;
                set_subsurface(material, attenuation, weight, tint);
                self.set_scattering(material, &scatter);
            }
            (Some(attenuation), None, Some(_)) => {
                let (weight, tint) = self.entering(clear, diffuse.as_ref())?;
                set_subsurface(material, attenuation, weight, tint);
                set_transmission(material, clear, Some(attenuation));
            }
            (_, scatter, diffuse) => {
                if scatter.is_some() || diffuse.is_some() {
                    self.warn("scattering in a KHR_materials_volume without attenuationDistance is left out");
                }
                set_transmission(material, clear, attenuation);
            }
        }
        Ok(())
    }

    /// A sheet without an inside, if it lets light through.
    fn read_thin_wall(
        &mut self,
        material: &mut Material,
        clear: ScalarInput,
        scatter: Option<&Scattering>,
        diffuse: Option<&DiffuseTransmission>,
    ) -> Result<(), SceneError> {
        set_transmission(material, clear, None);
        if let Some(scatter) = scatter {
            material.subsurface_color = scatter.color;
            material.subsurface_scatter_anisotropy = scatter.g;
            let strength = scatter.strength;
            let mut scattered = clear;
            if strength == 1.0 {
                material.transmission_weight = ScalarInput::constant(0.0);
            } else {
                material.transmission_weight.factor = clear.factor * (1.0 - strength);
                let opaque = 1.0 - material.transmission_weight.factor;
                scattered.factor = (clear.factor * strength / opaque).min(1.0);
                // Both weights are a product with one image only where all light is let through or scattered
                if scattered.texture.take().is_some() {
                    material.transmission_weight.texture = None;
                    self.warn("transmissionTexture is left out beside a scatterStrengthFactor below 1");
                }
            }
            material.subsurface_weight = scattered;
        } else if diffuse.is_some() {
            let (weight, tint) = self.entering(clear, diffuse)?;
            (material.subsurface_weight, material.subsurface_color) = (weight, tint);
            material.subsurface_scatter_anisotropy = FORWARD;
        }
        material.geometry_thin_walled =
            material.subsurface_weight.factor > 0.0 || material.transmission_weight.factor > 0.0;
        Ok(())
    }

    /// Scattering as KHR_materials_volume_scatter states it.
    fn volume_scattering(&mut self, data: &VolumeScatter) -> Result<Scattering, SceneError> {
        let (key, factor) = match (data.multiscatter_color_factor, data.multiscatter_color) {
            (Some(factor), _) => ("multiscatterColorFactor", factor),
            (None, Some(color)) => ("multiscatterColor", color),
            (None, None) => ("multiscatterColorFactor", [0.0; 3]),
        };
        let texture = data.multiscatter_color_texture.as_ref();
        let color = self.color(factor, texture, key)?;
        Ok(Scattering { strength: 1.0, color, g: self.anisotropy(data.scatter_anisotropy) })
    }

    /// What KHR_materials_scatter states; none where its strength is 0, at which it is as if it were not there.
    fn scattering(&mut self, data: &Scatter) -> Result<Option<Scattering>, SceneError> {
        let strength = self.unit(data.scatter_strength_factor, "scatterStrengthFactor");
        if data.scatter_strength_texture.is_some() {
            self.warn("scatterStrengthTexture is left out: scatterStrengthFactor counts everywhere");
        }
        let texture = data.multiscatter_color_texture.as_ref();
        let color = self.color(data.multiscatter_color_factor, texture, "multiscatterColorFactor")?;
        let g = self.anisotropy(data.scatter_anisotropy);
        Ok((strength > 0.0).then_some(Scattering { strength, color, g }))
    }

    /// A mean cosine that a phase function can have.
    fn anisotropy(&self, g: f32) -> f32 {
        let nearest = if g.is_nan() { 0.0 } else { g.clamp(-0.99, 0.99) };
        if nearest != g {
            self.warn(&format!("scatterAnisotropy is {g}, but must be in (-1, 1): it becomes {nearest}"));
        }
        nearest
    }

    fn attenuation(&self, volume: &Volume) -> Option<Attenuation> {
        let distance = (volume.attenuation_distance? * self.units) as f32;
        let color = Vec3::from_array(volume.attenuation_color.map(|c| self.unit(c, "attenuationColor")));
        if distance.is_finite() && distance > 0.0 {
            return Some(Attenuation { color, distance });
        }
        self.warn("an attenuationDistance that is not above 0 and finite is left out");
        None
    }

    /// Share of the light that enters a scattering medium, and its tint.
    fn entering(
        &mut self,
        clear: ScalarInput,
        diffuse: Option<&DiffuseTransmission>,
    ) -> Result<(ScalarInput, ColorInput), SceneError> {
        let Some(data) = diffuse else { return Ok((clear, ColorInput::constant(Vec3::ONE))) };
        let texture = data.diffuse_transmission_texture.as_ref();
        let key = "diffuseTransmissionFactor";
        let weight = self.weight(data.diffuse_transmission_factor, texture, Channel::Alpha, key)?;
        let texture = data.diffuse_transmission_color_texture.as_ref();
        let tint =
            self.color(data.diffuse_transmission_color_factor, texture, "diffuseTransmissionColorFactor")?;
        Ok((weight, tint))
    }

    /// Brings scattering into a material whose color is the tint of the light that enters.
    fn set_scattering(&self, material: &mut Material, scatter: &Scattering) {
        let tint = material.subsurface_color;
        if tint.texture.is_some() && scatter.color.texture.is_some() {
            self.warn("diffuseTransmissionColorTexture is left out beside multiscatterColorTexture");
        }
        material.subsurface_color.factor = tint.factor * scatter.color.factor * scatter.strength;
        material.subsurface_color.texture = scatter.color.texture.or(tint.texture);
        material.subsurface_scatter_anisotropy = scatter.g;
    }
}

/// A medium under the surface, and how light enters it.
fn set_subsurface(material: &mut Material, attenuation: Attenuation, weight: ScalarInput, tint: ColorInput) {
    let path = attenuation.mean_free_path();
    let longest = path.max_element();
    material.subsurface_weight = weight;
    material.subsurface_radius = ScalarInput::constant(longest);
    material.subsurface_radius_scale =
        ColorInput::constant(if longest > 0.0 { path / longest } else { Vec3::ONE });
    material.subsurface_color = tint;
}

fn set_transmission(material: &mut Material, weight: ScalarInput, attenuation: Option<Attenuation>) {
    material.transmission_weight = weight;
    match attenuation {
        Some(Attenuation { color, distance }) => {
            material.transmission_color = ColorInput::constant(color);
            material.transmission_depth = distance;
        }
        None => material.transmission_color = material.base_color,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_free_path_inverts_beer_s_law() {
        let color = Vec3::new(0.9, 0.5, 0.1);
        let path = Attenuation { color, distance: 3.0 }.mean_free_path();
        let after = Vec3::from_array((-3.0 / path).to_array().map(f32::exp));
        assert!(after.abs_diff_eq(color, 1e-6), "{after}");
    }

    #[test]
    fn mean_free_path_is_finite_for_black_and_white() {
        let path = Attenuation { color: Vec3::new(0.0, 1.0, 1.0), distance: 2.0 }.mean_free_path();
        assert_eq!(path.x, 0.0);
        assert!(path.is_finite() && path.y > 1.9e4, "{path}");
    }
}
