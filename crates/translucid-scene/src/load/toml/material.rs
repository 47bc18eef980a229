//! `[[material]]`: a surface with the parameter names of OpenPBR.

use super::build::check_present;
use super::document::{Item, Table};
use super::input::{Documents, FileList, read_color, read_normal_map, read_scalar};
use super::text::word_of;
use crate::load::extension;
use crate::load::materialx::{MaterialChoice, load_materialx};
use crate::material::{PARAMETERS, Slot};
use crate::preset::preset;
use crate::{
    CameraVisibility, Configuration, Material, SceneError, SubsurfaceModel, SubsurfaceNormalization,
    SubsurfaceParameter, SubsurfaceTextureAt, Unit, WordValue,
};

/// Every key.
pub(super) fn keys() -> Vec<&'static str> {
    let mut keys = vec!["name", "preset", "file", "file_material", "file_unit"];
    keys.extend(PARAMETERS.iter().map(|parameter| parameter.name));
    keys.extend(["subsurface_model", "subsurface_table"]);
    keys.extend(WORDS.iter().map(|setting| setting.key));
    keys.push("geometry_normal");
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

const CAMERA_VISIBILITIES: [(&str, CameraVisibility); 3] = [
    ("surface", CameraVisibility::Surface),
    ("shadow", CameraVisibility::Shadow),
    ("none", CameraVisibility::None),
];

/// A parameter whose value is a word.
pub(super) struct WordParameter {
    pub(super) key: &'static str,
    words: fn() -> Vec<&'static str>,
    read: fn(&Item<'_>, &mut Material) -> Result<(), SceneError>,
    pub(super) word: fn(&Material) -> &'static str,
}

macro_rules! word {
    ($name:ident of $words:ident) => {
        WordParameter {
            key: stringify!($name),
            words: || $words.iter().map(|(word, _)| *word).collect(),
            read: |item, material| item.word(&$words).map(|word| material.$name = word),
            word: |material| word_of(&$words, material.$name),
        }
    };
}

/// Parameters whose values are words, but for the model, which may be a table.
pub(super) const WORDS: [WordParameter; 5] = [
    word!(subsurface_parameter of PARAMETERIZATIONS),
    word!(subsurface_configuration of CONFIGURATIONS),
    word!(subsurface_texture_at of TEXTURE_AT),
    word!(subsurface_normalization of NORMALIZATIONS),
    word!(camera_visibility of CAMERA_VISIBILITIES),
];

impl Material {
    /// Every parameter whose value is a word, in the order of the fields.
    pub fn words(&self) -> Vec<WordValue> {
        let mut values = vec![WordValue {
            name: "subsurface_model",
            word: self.subsurface_model.name(),
            words: SubsurfaceModel::ALL.iter().map(|model| model.name()).collect(),
        }];
        values.extend(WORDS.iter().map(|parameter| WordValue {
            name: parameter.key,
            word: (parameter.word)(self),
            words: (parameter.words)(),
        }));
        values
    }
}

/// Reads a material; what it does not say comes from its preset or its document, else from `base`.
pub(super) fn read_material(
    table: &Table<'_>,
    base: Material,
    unit: Unit,
    images: &mut FileList,
) -> Result<Material, SceneError> {
    let Some(base) = read_document(table, &base, unit, images)? else {
        let mut named = base;
        table.update("name", &mut named.name, Item::name)?;
        return Ok(named);
    };
    let mut material = table.read("preset", base, |item| read_preset(item, unit))?;
    table.update("name", &mut material.name, Item::name)?;
    for parameter in PARAMETERS {
        let (name, range) = (parameter.name, parameter.range);
        match parameter.slot(&mut material) {
            Slot::Number(number) => table.update(name, number, |item| item.number(range))?,
            Slot::Scalar(input) => {
                let base = *input;
                table.update(name, input, |item| read_scalar(item, base, range, images))?;
            }
            Slot::Color(input) => {
                let base = *input;
                table.update(name, input, |item| read_color(item, base, range, images))?;
            }
        }
    }
    read_model(table, &mut material, images)?;
    for WordParameter { key, read, .. } in &WORDS {
        table.get(key).map_or(Ok(()), |item| read(&item, &mut material))?;
    }
    let map = material.geometry_normal;
    table.update("geometry_normal", &mut material.geometry_normal, |item| {
        read_normal_map(item, map, images)
    })?;
    Ok(material)
}

/// The material of the MaterialX document that the keys `file` name, else `base`; none if that is opened later.
fn read_document(
    table: &Table<'_>,
    base: &Material,
    unit: Unit,
    files: &mut FileList,
) -> Result<Option<Material>, SceneError> {
    let name = table.get("file_material").map(|item| item.name()).transpose()?;
    let length_unit = table.get("file_unit").map(|item| item.word(&Unit::WORDS)).transpose()?;
    let Some(item) = table.get("file") else {
        return match table.get("file_material").or(table.get("file_unit")) {
            Some(item) => Err(item.error(format!("{} is for a material with the key file", item.path()))),
            None => Ok(Some(base.clone())),
        };
    };
    let path = item.file()?;
    if extension(&path) != "mtlx" {
        return Err(item.refuse("the path of a MaterialX document (.mtlx)"));
    }
    if let Some(preset) = table.get("preset") {
        return Err(preset.error("preset and file both give all other keys, but one of them must"));
    }
    let is_new = files.named_documents.insert((path.clone(), name.clone()));
    let warnings = match &mut files.documents {
        Documents::Refused => {
            let error = item.error("this scene takes no further materials from files");
            return Err(error.with_help("make a scene that has it"));
        }
        Documents::Later => return Ok(None),
        Documents::Opened(warnings) => warnings,
    };
    check_present(&path, &item.place())?;
    let choice = MaterialChoice { name: name.as_deref(), length_unit, unit };
    let mut known = Vec::new();
    let (mut material, images) = load_materialx(&path, choice, if is_new { warnings } else { &mut known })?;
    let numbers: Vec<usize> = images.into_iter().map(|image| files.image_of_document(image)).collect();
    material.for_each_texture(|texture| texture.image = numbers[texture.image]);
    Ok(Some(material))
}

fn read_preset(item: &Item<'_>, unit: Unit) -> Result<Material, SceneError> {
    match preset(item.string()?) {
        Ok(preset) => Ok(preset.material(unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error }),
    }
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
