//! Inside of a glTF material: transmission, absorption and scattering.
//!
//! - *Clear*: KHR_materials_transmission is `transmission_weight` (red channel). The base color tints each crossing. With an
//!   attenuationDistance d in KHR_materials_volume it is `transmission_tint`, and `transmission_color` =
//!   attenuationColor at `transmission_depth` = d; without one it is `transmission_color`.
//! - *Scattering*, of two drafts. KHR_materials_volume_scatter (KhronosGroup/glTF pull request 2453) states
//!   ρ = multiscatterColorFactor, at first spelled multiscatterColor, the color after many scattering events,
//!   which is `subsurface_color`. KHR_materials_volume then gives the extinction σ_t = −ln(c)/d per channel of
//!   the attenuation color c, whatever the anisotropy, so that `subsurface_radius` ×
//!   `subsurface_radius_scale` = d / −ln(c), the mean free path. KHR_materials_transmission lets its factor t of
//!   the light in, KHR_materials_diffuse_transmission its factor of the rest: both are `subsurface_weight`. The diffuse
//!   transmission's color multiplies `subsurface_color` by its share. The base color, by which t is tinted, is left out.
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
use translucid_scene::{Channel, ColorInput, Material, ScalarInput};

use super::document::TextureInfo;
use super::extensions::Members;
use super::materials::MaterialReader;
use crate::result::Result;

/// Scattering inside, whichever extension states it.
struct Scattering {
    /// How much of the light that is let through is scattered.
    strength: f32,
    /// Color after many scattering events.
    color: ColorInput,
    /// Mean cosine of the phase function.
    g: f32,
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
    pub(super) fn read_media(&mut self, material: &mut Material) -> Result<()> {
        let volume = self.extension("KHR_materials_volume")?;
        let attenuation = volume.as_ref().map(|data| self.attenuation(data)).transpose()?.flatten();
        let clear = match self.extension("KHR_materials_transmission")? {
            Some(data) => self.weight_of(&data, "transmission", 0.0, Channel::Red)?,
            None => ScalarInput::constant(0.0),
        };
        let thickness = volume.as_ref().map(|data| data.get("thicknessFactor")).transpose()?.flatten();
        let mut is_thin = thickness.unwrap_or(0.0) <= 0.0;
        let mut diffuse = self.extension("KHR_materials_diffuse_transmission")?;
        let scatter = if let Some(data) = self.extension("KHR_materials_scatter")? {
            for name in ["KHR_materials_volume_scatter", "KHR_materials_diffuse_transmission"] {
                if self.data.extensions.contains_key(name) {
                    self.warn(&format!("{name} is left out beside KHR_materials_scatter, which replaces it"));
                }
            }
            diffuse = None;
            self.scattering(&data)?
        } else {
            match self.extension("KHR_materials_volume_scatter")? {
                Some(data) if volume.is_some() => {
                    is_thin = false;
                    Some(self.volume_scattering(&data)?)
                }
                Some(_) => {
                    self.warn("KHR_materials_volume_scatter without KHR_materials_volume is left out");
                    None
                }
                None => None,
            }
        };
        let diffuse = diffuse.map(|data| self.diffuse(&data)).transpose()?.flatten();
        if is_thin {
            self.read_thin_wall(material, clear, scatter.as_ref(), diffuse);
            return Ok(());
        }
        match (attenuation, scatter, diffuse) {
            (Some(attenuation), Some(scatter), diffuse) => {
                if clear.factor > 0.0 && !is_white(&material.base_color) {
                    self.warn("the base color of light that transmissionFactor lets in is left out: the scattering colors it");
                }
                let (weight, tint) = self.entering(clear, diffuse);
                set_subsurface(material, attenuation, weight, tint);
                self.set_scattering(material, &scatter);
            }
            (Some(attenuation), None, Some((weight, tint))) => {
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
        diffuse: Option<(ScalarInput, ColorInput)>,
    ) {
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
        } else if let Some((weight, tint)) = diffuse {
            (material.subsurface_weight, material.subsurface_color) = (weight, tint);
            material.subsurface_scatter_anisotropy = FORWARD;
        }
        material.geometry_thin_walled =
            material.subsurface_weight.factor > 0.0 || material.transmission_weight.factor > 0.0;
    }

    /// Scattering as KHR_materials_volume_scatter states it, in either of its spellings.
    fn volume_scattering(&mut self, data: &Members<'_>) -> Result<Scattering> {
        let color = match (data.get("multiscatterColorFactor")?, data.get("multiscatterColor")?) {
            (None, Some(old)) => {
                let texture: Option<TextureInfo> = data.get("multiscatterColorTexture")?;
                self.color(old, texture.as_ref(), "multiscatterColor")?
            }
            (new, _) => self.color_of(data, "multiscatterColor", new.unwrap_or_default())?,
        };
        Ok(Scattering { strength: 1.0, color, g: self.anisotropy(data)? })
    }

    /// What KHR_materials_scatter states; none where its strength is 0, at which it is as if it were not there.
    fn scattering(&mut self, data: &Members<'_>) -> Result<Option<Scattering>> {
        let strength = self.unit(data.get("scatterStrengthFactor")?.unwrap_or(0.0), "scatterStrengthFactor");
        if data.get::<TextureInfo>("scatterStrengthTexture")?.is_some() {
            self.warn("scatterStrengthTexture is left out: scatterStrengthFactor counts everywhere");
        }
        let (color, g) = (self.color_of(data, "multiscatterColor", [1.0; 3])?, self.anisotropy(data)?);
        Ok((strength > 0.0).then_some(Scattering { strength, color, g }))
    }

    /// A mean cosine that a phase function can have.
    fn anisotropy(&self, data: &Members<'_>) -> Result<f32> {
        let g: f32 = data.get("scatterAnisotropy")?.unwrap_or(0.0);
        let nearest = if g.is_nan() { 0.0 } else { g.clamp(-0.99, 0.99) };
        if nearest != g {
            self.warn(&format!("scatterAnisotropy is {g}, but must be in (-1, 1): it becomes {nearest}"));
        }
        Ok(nearest)
    }

    fn attenuation(&self, volume: &Members<'_>) -> Result<Option<Attenuation>> {
        let color: [f32; 3] = volume.get("attenuationColor")?.unwrap_or([1.0; 3]);
        let Some(distance) = volume.get::<f64>("attenuationDistance")? else { return Ok(None) };
        let distance = (distance * self.units) as f32;
        let color = Vec3::from_array(color.map(|channel| self.unit(channel, "attenuationColor")));
        if distance.is_finite() && distance > 0.0 {
            return Ok(Some(Attenuation { color, distance }));
        }
        self.warn("an attenuationDistance that is not above 0 and finite is left out");
        Ok(None)
    }

    /// Share and tint of the light that passes diffusely; none for a factor of 0, at which it is as if it were not there.
    fn diffuse(&mut self, data: &Members<'_>) -> Result<Option<(ScalarInput, ColorInput)>> {
        let weight = self.weight_of(data, "diffuseTransmission", 0.0, Channel::Alpha)?;
        let tint = self.color_of(data, "diffuseTransmissionColor", [1.0; 3])?;
        Ok((weight.factor > 0.0).then_some((weight, tint)))
    }

    /// Share of the light that enters a scattering medium, and its tint: clearly t, and diffusely d of the rest.
    fn entering(
        &self,
        clear: ScalarInput,
        diffuse: Option<(ScalarInput, ColorInput)>,
    ) -> (ScalarInput, ColorInput) {
        let white = ColorInput::constant(Vec3::ONE);
        let Some((weight, tint)) = diffuse else { return (clear, white) };
        if clear.factor == 0.0 {
            return (weight, tint);
        }
        let textured = [
            (clear.texture.is_some(), "transmissionTexture"),
            (weight.texture.is_some(), "diffuseTransmissionTexture"),
            (tint.texture.is_some(), "diffuseTransmissionColorTexture"),
        ];
        // None of them is a factor of the sums
        for (_, name) in textured.into_iter().filter(|(is_textured, _)| *is_textured) {
            self.warn(&format!("{name} is left out where light enters both clearly and diffusely"));
        }
        let diffuse = (1.0 - clear.factor) * weight.factor;
        let all = clear.factor + diffuse;
        let tint = (Vec3::splat(clear.factor) + diffuse * tint.factor) / all;
        (ScalarInput::constant(all), ColorInput::constant(tint))
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
            material.transmission_tint = material.base_color;
        }
        None => material.transmission_color = material.base_color,
    }
}

/// Whether a color leaves light as it is; vertex colors are for meshes to tell.
fn is_white(color: &ColorInput) -> bool {
    color.factor == Vec3::ONE && color.texture.is_none()
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
