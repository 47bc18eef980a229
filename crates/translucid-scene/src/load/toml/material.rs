//! `[[material]]`: a surface with the parameter names of OpenPBR.

use super::document::{Item, Table};
use super::input::{FileList, read_color, read_normal_map, read_scalar};
use crate::material::{PARAMETERS, Parameter, Slot};
use crate::preset::preset;
use crate::{
    Configuration, Material, SceneError, SubsurfaceModel, SubsurfaceNormalization, SubsurfaceParameter,
    SubsurfaceTextureAt, Unit,
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

const PARAMETERIZATIONS: [(&str, SubsurfaceParameter); 2] =
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
    for parameter in PARAMETERS {
        read_parameter(table, parameter, &mut material, images)?;
    }
    read_model(table, &mut material, images)?;
    read_words(table, &mut material)?;
    material.geometry_normal =
        table.read("geometry_normal", None, |item| read_normal_map(item, images).map(Some))?;
    Ok(material)
}

fn read_preset(item: &Item<'_>, unit: Unit) -> Result<Material, SceneError> {
    match preset(item.string()?) {
        Ok(preset) => Ok(preset.material(unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error }),
    }
}

fn read_parameter(
    table: &Table<'_>,
    parameter: &Parameter,
    material: &mut Material,
    images: &mut FileList,
) -> Result<(), SceneError> {
    let (name, range) = (parameter.name, parameter.range);
    match parameter.slot(material) {
        Slot::Number(number) => *number = table.read(name, *number, |item| item.number(range))?,
        Slot::Scalar(input) => *input = table.read(name, *input, |item| read_scalar(item, range, images))?,
        Slot::Color(input) => *input = table.read(name, *input, |item| read_color(item, range, images))?,
    }
    Ok(())
}

/// Reads `subsurface_model` or `subsurface_table`; without either the medium decides.
fn read_model(table: &Table<'_>, material: &mut Material, files: &mut FileList) -> Result<(), SceneError> {
    let models = SubsurfaceModel::ALL.map(|model| (model.name(), model));
    let default =
        SubsurfaceModel::default_of(material.subsurface_scatter_anisotropy, material.subsurface_eta);
    material.subsurface_model = table.read("subsurface_model", default, |item| item.word(&models))?;
    let Some(item) = table.get("subsurface_table") else { return Ok(()) };
    if table.get("subsurface_model").is_some() {
        let message = "subsurface_table is the model: leave subsurface_model out, or the table";
        return Err(SceneError::at(item.place(), message));
    }
    material.subsurface_model = SubsurfaceModel::Tabulated(files.request_table(&item)?);
    Ok(())
}

fn read_words(table: &Table<'_>, material: &mut Material) -> Result<(), SceneError> {
    let parameter = material.subsurface_parameter;
    material.subsurface_parameter =
        table.read("subsurface_parameter", parameter, |item| item.word(&PARAMETERIZATIONS))?;
    let configuration = material.subsurface_configuration;
    material.subsurface_configuration =
        table.read("subsurface_configuration", configuration, |item| item.word(&CONFIGURATIONS))?;
    let texture_at = material.subsurface_texture_at;
    material.subsurface_texture_at =
        table.read("subsurface_texture_at", texture_at, |item| item.word(&TEXTURE_AT))?;
    let normalization = material.subsurface_normalization;
    material.subsurface_normalization =
        table.read("subsurface_normalization", normalization, |item| item.word(&NORMALIZATIONS))?;
    Ok(())
}
