//! `[[material]]`: a surface with the parameter names of OpenPBR.

use translucid_profile::convention::preset;
use translucid_scene::{Material, PARAMETERS, SceneError, Slot, SubsurfaceModel, Unit, WORD_PARAMETERS};

use super::build::check_present;
use super::document::{Item, Table};
use super::input::{Documents, FileList, read_color, read_normal_map, read_scalar};
use crate::file::extension;
use crate::materialx::{MaterialChoice, load_materialx};

/// Every key.
pub(super) fn keys() -> Vec<&'static str> {
    let mut keys = vec!["name", "preset", "file", "file_material", "file_unit"];
    keys.extend(PARAMETERS.iter().map(|parameter| parameter.name));
    keys.extend(["subsurface_model", "subsurface_table"]);
    keys.extend(WORD_PARAMETERS.iter().map(|parameter| parameter.name));
    keys.push("geometry_normal");
    keys
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
    for parameter in WORD_PARAMETERS {
        if let Some(item) = table.get(parameter.name) {
            let words: Vec<_> = parameter.words().into_iter().map(|word| (word, word)).collect();
            parameter.set(&mut material, item.word(&words)?);
        }
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
        Ok(preset) => Ok(Material::of_preset(preset, unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error.into() }),
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
