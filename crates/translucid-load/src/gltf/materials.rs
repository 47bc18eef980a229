//! Materials: metallic-roughness with the extensions that have a counterpart in OpenPBR.
//!
//! | glTF | here |
//! |---|---|
//! | baseColor × COLOR_0, metallic (blue), roughness (green) | `base_color`, `base_metalness`, `specular_roughness` |
//! | alpha of baseColor: BLEND / MASK | `geometry_opacity`, for MASK an image cut at the cutoff |
//! | normalTexture, scale | `geometry_normal` |
//! | emissive × KHR_materials_emissive_strength | `emission_color` × `emission_luminance` |
//! | KHR_materials_unlit | `emission_color` = baseColor, no reflection |
//! | KHR_materials_ior, _specular | `specular_ior`; of what is no metal `specular_weight` (alpha), `specular_color` |
//! | KHR_materials_clearcoat | `coat_weight` (red), `coat_roughness` (green), `coat_ior` 1.5 |
//! | KHR_materials_transmission, _volume | `transmission_*`, see [`super::media`] |
//! | KHR_materials_volume_scatter, _scatter, _diffuse_transmission | `subsurface_*`, see [`super::media`] |
//! | no thickness in KHR_materials_volume, or no volume | `geometry_thin_walled`, see [`super::media`] |
//!
//! Occlusion is what a path tracer computes, and `doubleSided` means nothing for closed surfaces: both
//! are not read.

use std::collections::{BTreeSet, HashMap};

use glam::Vec3;
use translucid_scene::{Channel, ColorInput, Material, NormalMap, ScalarInput};

use super::buffers::Arrays;
use super::document::{self, AlphaMode, TextureInfo};
use super::extensions::{Members, Support, support};
use super::textures::{ImageShelf, Use};
use super::uri::clip;
use crate::result::Result;

/// A material and the texture coordinates that it reads.
#[derive(Clone, Copy)]
pub(super) struct MaterialUse {
    /// Index into [`MaterialShelf::materials`].
    pub(super) index: usize,
    /// Number of the texture coordinates; `None` if there is no texture.
    pub(super) uv_set: Option<usize>,
}

/// The materials that primitives asked for.
#[derive(Default)]
pub(super) struct MaterialShelf {
    pub(super) materials: Vec<Material>,
    pub(super) images: ImageShelf,
    /// Names of extensions that had to be left out.
    left_out: BTreeSet<String>,
    known: HashMap<Option<usize>, MaterialUse>,
}

impl MaterialShelf {
    /// A material by its index in the file; `None` is the specification's default material.
    ///
    /// `units` is the number of scene units to the meter.
    pub(super) fn get(
        &mut self,
        index: Option<usize>,
        user: &str,
        units: f64,
        arrays: &Arrays<'_>,
    ) -> Result<MaterialUse> {
        if let Some(&known) = self.known.get(&index) {
            return Ok(known);
        }
        let default = document::Material::default();
        let (data, part) = match index {
            Some(index) => {
                let data = arrays.document.materials.get(index, user)?;
                (data, arrays.document.materials.label(index))
            }
            None => (&default, String::from("default material")),
        };
        let mut reader = MaterialReader { data, part, units, arrays, images: &mut self.images, uv_set: None };
        let material = reader.material()?;
        let uv_set = reader.uv_set;
        let is_left_out = |name: &&String| support(name) != Support::OfMaterials;
        self.left_out.extend(data.extensions.keys().filter(is_left_out).cloned());
        self.materials.push(material);
        let found = MaterialUse { index: self.materials.len() - 1, uv_set };
        self.known.insert(index, found);
        Ok(found)
    }

    /// Says once which extensions were left out.
    pub(super) fn report(&self, arrays: &Arrays<'_>) {
        if !self.left_out.is_empty() {
            let names: Vec<String> = self.left_out.iter().take(16).map(|name| clip(name)).collect();
            let message = format!("without a counterpart here, left out: {}", names.join(", "));
            arrays.notes.warn("materials", message);
        }
    }
}

/// One material on its way.
pub(super) struct MaterialReader<'a> {
    pub(super) data: &'a document::Material,
    pub(super) part: String,
    /// Scene units to the meter.
    pub(super) units: f64,
    arrays: &'a Arrays<'a>,
    images: &'a mut ImageShelf,
    uv_set: Option<usize>,
}

impl<'a> MaterialReader<'a> {
    fn material(&mut self) -> Result<Material> {
        let mut material = Material { name: self.name(), ..Material::default() };
        self.read_base(&mut material)?;
        self.read_opacity(&mut material)?;
        self.read_normal(&mut material)?;
        self.read_emission(&mut material)?;
        self.read_specular(&mut material)?;
        self.read_coat(&mut material)?;
        self.read_media(&mut material)?;
        if let Some(change) = crate::metal::reflect_fully(&mut material) {
            self.warn(change);
        }
        self.read_unlit(&mut material);
        material.clamp().iter().for_each(|change| self.warn(change));
        Ok(material)
    }

    fn name(&self) -> String {
        self.data.name.clone().unwrap_or_else(|| self.part.clone())
    }

    fn read_base(&mut self, material: &mut Material) -> Result<()> {
        let data = &self.data.pbr_metallic_roughness;
        let [r, g, b, _] = data.base_color_factor.unwrap_or([1.0; 4]);
        material.base_color = self.color([r, g, b], data.base_color_texture.as_ref(), "baseColorFactor")?;
        material.base_color.vertex_color = true;
        let texture = data.metallic_roughness_texture.as_ref();
        material.base_metalness =
            self.weight(data.metallic_factor.unwrap_or(1.0), texture, Channel::Blue, "metallicFactor")?;
        material.specular_roughness =
            self.weight(data.roughness_factor.unwrap_or(1.0), texture, Channel::Green, "roughnessFactor")?;
        Ok(())
    }

    fn read_opacity(&mut self, material: &mut Material) -> Result<()> {
        let data = &self.data.pbr_metallic_roughness;
        let alpha = data.base_color_factor.map_or(1.0, |[.., alpha]| alpha);
        let alpha = self.unit(alpha, "alpha of baseColorFactor");
        let texture = data.base_color_texture.as_ref();
        let cutoff = self.data.alpha_cutoff.unwrap_or(0.5);
        material.geometry_opacity = match (self.data.alpha_mode, texture) {
            (AlphaMode::Opaque, _) => ScalarInput::constant(1.0),
            (AlphaMode::Blend, _) => {
                ScalarInput { factor: alpha, texture: self.channel(texture, Use::Color, Channel::Alpha)? }
            }
            (AlphaMode::Mask, None) => ScalarInput::constant(if alpha >= cutoff { 1.0 } else { 0.0 }),
            (AlphaMode::Mask, Some(_)) if alpha < cutoff => ScalarInput::constant(0.0),
            (AlphaMode::Mask, Some(_)) => {
                let used_as = Use::Mask((cutoff / alpha).clamp(0.0, 1.0).to_bits());
                ScalarInput { factor: 1.0, texture: self.channel(texture, used_as, Channel::Alpha)? }
            }
        };
        Ok(())
    }

    fn read_normal(&mut self, material: &mut Material) -> Result<()> {
        let Some(info) = &self.data.normal_texture else { return Ok(()) };
        let texture = self.texture(Some(info), Use::Data)?;
        let scale = if info.scale.is_finite() { info.scale } else { 1.0 };
        material.geometry_normal = texture.map(|texture| NormalMap { texture, scale });
        Ok(())
    }

    fn read_emission(&mut self, material: &mut Material) -> Result<()> {
        if self.data.emissive_factor == [0.0; 3] {
            return Ok(());
        }
        let strength = self.extension("KHR_materials_emissive_strength")?;
        let strength = strength.map(|data| data.get("emissiveStrength")).transpose()?.flatten();
        let texture = self.data.emissive_texture.as_ref();
        material.emission_color = self.color(self.data.emissive_factor, texture, "emissiveFactor")?;
        material.emission_luminance = strength.unwrap_or(1.0);
        Ok(())
    }

    fn read_specular(&mut self, material: &mut Material) -> Result<()> {
        if let Some(data) = self.extension("KHR_materials_ior")? {
            material.specular_ior = data.get("ior")?.unwrap_or(1.5);
        }
        let Some(data) = self.extension("KHR_materials_specular")? else { return Ok(()) };
        material.specular_weight = self.weight_of(&data, "specular", 1.0, Channel::Alpha)?;
        let texture: Option<TextureInfo> = data.get("specularColorTexture")?;
        material.specular_color = self.color([1.0; 3], texture.as_ref(), "specularColorFactor")?;
        // Unlike the others this factor may exceed 1; its product with the image may not.
        let factor = Vec3::from_array(data.get("specularColorFactor")?.unwrap_or([1.0; 3]));
        let most = if material.specular_color.texture.is_some() { f32::MAX } else { 1.0 };
        material.specular_color.factor =
            if factor.is_finite() { factor.clamp(Vec3::ZERO, Vec3::splat(most)) } else { Vec3::ONE };
        Ok(())
    }

    fn read_coat(&mut self, material: &mut Material) -> Result<()> {
        let Some(data) = self.extension("KHR_materials_clearcoat")? else { return Ok(()) };
        material.coat_weight = self.weight_of(&data, "clearcoat", 0.0, Channel::Red)?;
        material.coat_roughness = self.weight_of(&data, "clearcoatRoughness", 0.0, Channel::Green)?;
        material.coat_ior = 1.5;
        if data.get::<TextureInfo>("clearcoatNormalTexture")?.is_some() {
            self.warn("clearcoatNormalTexture is left out");
        }
        Ok(())
    }

    /// KHR_materials_unlit: the base color, whatever the light.
    fn read_unlit(&self, material: &mut Material) {
        if self.data.extensions.contains_key("KHR_materials_unlit") {
            let name = material.name.clone();
            let (emission_color, geometry_opacity) = (material.base_color, material.geometry_opacity);
            *material = Material { name, emission_color, geometry_opacity, ..Material::default() };
            material.emission_luminance = 1.0;
            material.base_weight = 0.0;
            material.specular_weight = ScalarInput::constant(0.0);
        }
    }

    pub(super) fn extension(&self, name: &str) -> Result<Option<Members<'a>>> {
        Members::of(&self.data.extensions, name, &self.part, self.arrays.notes.path)
    }

    pub(super) fn warn(&self, message: &str) {
        self.arrays.notes.warn(&self.part, message);
    }

    /// A number clamped to [0, 1], with a warning if that changed it.
    pub(super) fn unit(&self, value: f32, key: &str) -> f32 {
        if (0.0..=1.0).contains(&value) {
            return value;
        }
        let clamped = if value > 1.0 { 1.0 } else { 0.0 };
        self.warn(&format!("{key} is {value}, but must be in [0, 1]: it becomes {clamped}"));
        clamped
    }

    /// A color factor with its image.
    pub(super) fn color(
        &mut self,
        factor: [f32; 3],
        info: Option<&TextureInfo>,
        key: &str,
    ) -> Result<ColorInput> {
        let factor = Vec3::from_array(factor.map(|channel| self.unit(channel, key)));
        Ok(ColorInput { factor, texture: self.texture(info, Use::Color)?, vertex_color: false })
    }

    /// The color that an extension states by two members, a factor and a texture, whose names begin alike.
    pub(super) fn color_of(
        &mut self,
        data: &Members<'_>,
        name: &str,
        default: [f32; 3],
    ) -> Result<ColorInput> {
        let key = format!("{name}Factor");
        let texture: Option<TextureInfo> = data.get(&format!("{name}Texture"))?;
        self.color(data.get(&key)?.unwrap_or(default), texture.as_ref(), &key)
    }

    /// As [`color_of`](Self::color_of), of one channel.
    pub(super) fn weight_of(
        &mut self,
        data: &Members<'_>,
        name: &str,
        default: f32,
        channel: Channel,
    ) -> Result<ScalarInput> {
        let key = format!("{name}Factor");
        let texture: Option<TextureInfo> = data.get(&format!("{name}Texture"))?;
        self.weight(data.get(&key)?.unwrap_or(default), texture.as_ref(), channel, &key)
    }

    /// A factor with one channel of an image.
    fn weight(
        &mut self,
        factor: f32,
        info: Option<&TextureInfo>,
        channel: Channel,
        key: &str,
    ) -> Result<ScalarInput> {
        Ok(ScalarInput { factor: self.unit(factor, key), texture: self.channel(info, Use::Data, channel)? })
    }

    fn channel(
        &mut self,
        info: Option<&TextureInfo>,
        used_as: Use,
        channel: Channel,
    ) -> Result<Option<(translucid_scene::TextureRef, Channel)>> {
        Ok(self.texture(info, used_as)?.map(|texture| (texture, channel)))
    }

    /// A texture; the first one decides which texture coordinates the mesh gets.
    fn texture(
        &mut self,
        info: Option<&TextureInfo>,
        used_as: Use,
    ) -> Result<Option<translucid_scene::TextureRef>> {
        let Some(info) = info else { return Ok(None) };
        let Some((texture, set)) = self.images.texture(info, used_as, &self.part, self.arrays)? else {
            return Ok(None);
        };
        let first = *self.uv_set.get_or_insert(set);
        if set != first {
            self.warn(&format!(
                "its textures use TEXCOORD_{first} and TEXCOORD_{set}: all are given TEXCOORD_{first}"
            ));
        }
        Ok(Some(texture))
    }
}
