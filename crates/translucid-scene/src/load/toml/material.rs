//! `[[material]]`: a surface with the parameter names of OpenPBR.

use super::document::{Item, Table};
use super::input::{FileList, read_color, read_normal_map, read_scalar};
use super::interval::Interval;
use crate::preset::preset;
use crate::{
    ColorInput, Configuration, Material, ScalarInput, SceneError, SubsurfaceModel, SubsurfaceNormalization,
    SubsurfaceParameter, SubsurfaceTextureAt, Unit,
};

pub(super) const KEYS: &[&str] = &[
    "name",
    "preset",
    "base_weight",
    "base_color",
    "base_metalness",
    "specular_weight",
    "specular_color",
    "specular_roughness",
    "specular_ior",
    "transmission_weight",
    "transmission_color",
    "transmission_depth",
    "subsurface_weight",
    "subsurface_color",
    "subsurface_radius",
    "subsurface_radius_scale",
    "subsurface_scatter_anisotropy",
    "subsurface_model",
    "subsurface_table",
    "subsurface_parameter",
    "subsurface_configuration",
    "subsurface_eta",
    "subsurface_texture_at",
    "subsurface_normalization",
    "coat_weight",
    "coat_color",
    "coat_roughness",
    "coat_ior",
    "emission_luminance",
    "emission_color",
    "geometry_opacity",
    "geometry_normal",
];

const PARAMETERS: [(&str, SubsurfaceParameter); 2] =
    [("mfp", SubsurfaceParameter::Mfp), ("dmfp", SubsurfaceParameter::Dmfp)];
const CONFIGURATIONS: [(&str, Configuration); 2] =
    [("searchlight", Configuration::Searchlight), ("diffuse", Configuration::Diffuse)];
const TEXTURE_AT: [(&str, SubsurfaceTextureAt); 3] = [
    ("exit", SubsurfaceTextureAt::Exit),
    ("entry", SubsurfaceTextureAt::Entry),
    ("both", SubsurfaceTextureAt::Both),
];
const NORMALIZATIONS: [(&str, SubsurfaceNormalization); 2] =
    [("none", SubsurfaceNormalization::None), ("energy", SubsurfaceNormalization::Energy)];

/// Reads a material; what it does not say comes from its preset, else from OpenPBR.
pub(super) fn read_material(
    table: &Table<'_>,
    unit: Unit,
    images: &mut FileList,
) -> Result<Material, SceneError> {
    let mut material = table.read("preset", Material::default(), |item| read_preset(item, unit))?;
    material.name = table.require("name")?.name()?;
    let mut reader = Reader { table, images };
    reader.base(&mut material)?;
    reader.transmission(&mut material)?;
    reader.subsurface(&mut material)?;
    reader.coat_and_emission(&mut material)?;
    reader.geometry(&mut material)?;
    Ok(material)
}

fn read_preset(item: &Item<'_>, unit: Unit) -> Result<Material, SceneError> {
    match preset(item.string()?) {
        Ok(preset) => Ok(preset.material(unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error }),
    }
}

struct Reader<'a, 'b> {
    table: &'a Table<'a>,
    images: &'b mut FileList,
}

impl Reader<'_, '_> {
    fn color(
        &mut self,
        key: &'static str,
        range: Interval,
        color: &mut ColorInput,
    ) -> Result<(), SceneError> {
        *color = self.table.read(key, *color, |item| read_color(item, range, self.images))?;
        Ok(())
    }

    fn scalar(
        &mut self,
        key: &'static str,
        range: Interval,
        scalar: &mut ScalarInput,
    ) -> Result<(), SceneError> {
        *scalar = self.table.read(key, *scalar, |item| read_scalar(item, range, self.images))?;
        Ok(())
    }

    fn number(&self, key: &'static str, range: Interval, number: &mut f32) -> Result<(), SceneError> {
        *number = self.table.read(key, *number, |item| item.number(range))?;
        Ok(())
    }

    fn base(&mut self, material: &mut Material) -> Result<(), SceneError> {
        self.number("base_weight", Interval::UNIT, &mut material.base_weight)?;
        self.color("base_color", Interval::UNIT, &mut material.base_color)?;
        self.scalar("base_metalness", Interval::UNIT, &mut material.base_metalness)?;
        self.scalar("specular_weight", Interval::UNIT, &mut material.specular_weight)?;
        self.color("specular_color", Interval::UNIT, &mut material.specular_color)?;
        self.scalar("specular_roughness", Interval::UNIT, &mut material.specular_roughness)?;
        self.number("specular_ior", Interval::IOR, &mut material.specular_ior)
    }

    fn transmission(&mut self, material: &mut Material) -> Result<(), SceneError> {
        self.scalar("transmission_weight", Interval::UNIT, &mut material.transmission_weight)?;
        self.color("transmission_color", Interval::UNIT, &mut material.transmission_color)?;
        self.number("transmission_depth", Interval::LENGTH, &mut material.transmission_depth)
    }

    fn subsurface(&mut self, material: &mut Material) -> Result<(), SceneError> {
        self.scalar("subsurface_weight", Interval::UNIT, &mut material.subsurface_weight)?;
        self.color("subsurface_color", Interval::UNIT, &mut material.subsurface_color)?;
        self.scalar("subsurface_radius", Interval::LENGTH, &mut material.subsurface_radius)?;
        self.color("subsurface_radius_scale", Interval::FACTOR, &mut material.subsurface_radius_scale)?;
        let anisotropy = &mut material.subsurface_scatter_anisotropy;
        self.number("subsurface_scatter_anisotropy", Interval::open(-1.0, 1.0), anisotropy)?;
        let eta = &mut material.subsurface_eta;
        self.number("subsurface_eta", Interval::closed(0.5, 3.0), eta)?;
        let models = SubsurfaceModel::ALL.map(|model| (model.name(), model));
        let model =
            SubsurfaceModel::default_of(material.subsurface_scatter_anisotropy, material.subsurface_eta);
        material.subsurface_model = self.table.read("subsurface_model", model, |item| item.word(&models))?;
        if let Some(item) = self.table.get("subsurface_table") {
            if self.table.get("subsurface_model").is_some() {
                let message = "subsurface_table is the model: leave subsurface_model out, or the table";
                return Err(SceneError::at(item.place(), message));
            }
            material.subsurface_model = SubsurfaceModel::Tabulated(self.images.request_table(&item)?);
        }
        let parameter = material.subsurface_parameter;
        material.subsurface_parameter =
            self.table.read("subsurface_parameter", parameter, |item| item.word(&PARAMETERS))?;
        let configuration = material.subsurface_configuration;
        material.subsurface_configuration =
            self.table.read("subsurface_configuration", configuration, |item| item.word(&CONFIGURATIONS))?;
        let texture_at = material.subsurface_texture_at;
        material.subsurface_texture_at =
            self.table.read("subsurface_texture_at", texture_at, |item| item.word(&TEXTURE_AT))?;
        let normalization = material.subsurface_normalization;
        material.subsurface_normalization =
            self.table.read("subsurface_normalization", normalization, |item| item.word(&NORMALIZATIONS))?;
        Ok(())
    }

    fn coat_and_emission(&mut self, material: &mut Material) -> Result<(), SceneError> {
        self.scalar("coat_weight", Interval::UNIT, &mut material.coat_weight)?;
        self.color("coat_color", Interval::UNIT, &mut material.coat_color)?;
        self.scalar("coat_roughness", Interval::UNIT, &mut material.coat_roughness)?;
        self.number("coat_ior", Interval::IOR, &mut material.coat_ior)?;
        self.number("emission_luminance", Interval::LIGHT, &mut material.emission_luminance)?;
        self.color("emission_color", Interval::FACTOR, &mut material.emission_color)
    }

    fn geometry(&mut self, material: &mut Material) -> Result<(), SceneError> {
        self.scalar("geometry_opacity", Interval::UNIT, &mut material.geometry_opacity)?;
        material.geometry_normal =
            self.table.read("geometry_normal", None, |item| read_normal_map(item, self.images).map(Some))?;
        Ok(())
    }
}
