//! `[[material]]`: a surface with the parameter names of OpenPBR.

use super::document::{Item, Table};
use super::input::{FileList, read_color, read_normal_map, read_scalar};
use crate::material::{PARAMETERS, Slot};
use crate::preset::preset;
use crate::{
    Configuration, Material, SceneError, SubsurfaceModel, SubsurfaceNormalization, SubsurfaceParameter,
    SubsurfaceTextureAt, Unit, WordValue,
};

/// Every key.
pub(super) fn keys() -> Vec<&'static str> {
    let mut keys = vec!["name", "preset"];
    keys.extend(PARAMETERS.iter().map(|parameter| parameter.name));
    keys.extend([
        "subsurface_model",
        "subsurface_table",
        "subsurface_parameter",
        "subsurface_configuration",
        "subsurface_texture_at",
        "subsurface_normalization",
        "geometry_normal",
    ]);
    keys
}

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

impl Material {
    /// Every parameter whose value is a word, in the order of the fields.
    #[must_use]
    pub fn words(&self) -> Vec<WordValue> {
        fn value<T: Copy + PartialEq>(
            name: &'static str,
            value: T,
            words: &[(&'static str, T)],
        ) -> WordValue {
            let word = words.iter().find(|(_, meaning)| *meaning == value).map_or("", |(word, _)| word);
            WordValue { name, word, words: words.iter().map(|(word, _)| *word).collect() }
        }
        let models = SubsurfaceModel::ALL.map(|model| (model.name(), model));
        let model = value("subsurface_model", self.subsurface_model, &models);
        vec![
            WordValue { word: self.subsurface_model.name(), ..model },
            value("subsurface_parameter", self.subsurface_parameter, &PARAMETERIZATIONS),
            value("subsurface_configuration", self.subsurface_configuration, &CONFIGURATIONS),
            value("subsurface_texture_at", self.subsurface_texture_at, &TEXTURE_AT),
            value("subsurface_normalization", self.subsurface_normalization, &NORMALIZATIONS),
        ]
    }
}

/// Reads a material; what it does not say comes from its preset, else from `base`.
pub(super) fn read_material(
    table: &Table<'_>,
    base: Material,
    unit: Unit,
    images: &mut FileList,
) -> Result<Material, SceneError> {
    let is_default = base.subsurface_model == default_model(&base);
    let mut material = table.read("preset", base, |item| read_preset(item, unit))?;
    table.update("name", &mut material.name, Item::name)?;
    for parameter in PARAMETERS {
        let (name, range) = (parameter.name, parameter.range);
        match parameter.slot(&mut material) {
            Slot::Number(number) => table.update(name, number, |item| item.number(range))?,
            Slot::Scalar(input) => table.update(name, input, |item| read_scalar(item, range, images))?,
            Slot::Color(input) => table.update(name, input, |item| read_color(item, range, images))?,
        }
    }
    if is_default || table.get("preset").is_some() {
        material.subsurface_model = default_model(&material);
    }
    read_model(table, &mut material, images)?;
    table.update("subsurface_parameter", &mut material.subsurface_parameter, |item| {
        item.word(&PARAMETERIZATIONS)
    })?;
    table.update("subsurface_configuration", &mut material.subsurface_configuration, |item| {
        item.word(&CONFIGURATIONS)
    })?;
    let texture_at = &mut material.subsurface_texture_at;
    table.update("subsurface_texture_at", texture_at, |item| item.word(&TEXTURE_AT))?;
    let normalization = &mut material.subsurface_normalization;
    table.update("subsurface_normalization", normalization, |item| item.word(&NORMALIZATIONS))?;
    table.update("geometry_normal", &mut material.geometry_normal, |item| {
        read_normal_map(item, images).map(Some)
    })?;
    Ok(material)
}

fn read_preset(item: &Item<'_>, unit: Unit) -> Result<Material, SceneError> {
    match preset(item.string()?) {
        Ok(preset) => Ok(preset.material(unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error }),
    }
}

/// The model that the medium decides on where none is named.
fn default_model(material: &Material) -> SubsurfaceModel {
    SubsurfaceModel::default_of(material.subsurface_scatter_anisotropy, material.subsurface_eta)
}

/// Reads `subsurface_model` or `subsurface_table`.
fn read_model(table: &Table<'_>, material: &mut Material, files: &mut FileList) -> Result<(), SceneError> {
    let models = SubsurfaceModel::ALL.map(|model| (model.name(), model));
    table.update("subsurface_model", &mut material.subsurface_model, |item| item.word(&models))?;
    let Some(item) = table.get("subsurface_table") else { return Ok(()) };
    if table.get("subsurface_model").is_some() {
        let message = "subsurface_table is the model: leave subsurface_model out, or the table";
        return Err(SceneError::at(item.place(), message));
    }
    material.subsurface_model = SubsurfaceModel::Tabulated(files.table(&item)?);
    Ok(())
}
