//! `[[material]]`: a surface with the parameter names of OpenPBR.

use translucid_profile::convention::preset;
use translucid_scene::description::{Item, Table};
use translucid_scene::{Material, SceneError, Unit};

use super::build::check_present;
use super::files::{Documents, NamedFiles};
use crate::file::extension;
use crate::materialx::{MaterialChoice, load_materialx};
use crate::result::Result;

/// Reads a material; what it does not say comes from its preset or its document, else from `base`.
pub(super) fn read_material(
    table: &Table<'_>,
    base: Material,
    unit: Unit,
    files: &mut NamedFiles,
) -> Result<Material> {
    let Some(base) = read_document(table, &base, unit, files)? else {
        let mut named = base;
        named.name = table.read("name", named.name, Item::name)?;
        return Ok(named);
    };
    let mut material = table.read("preset", base, |item| read_preset(item, unit))?;
    material.name = table.read("name", material.name, Item::name)?;
    Material::DESCRIPTION.change(material, table, &mut files.list)
}

/// The name of a material of a base that becomes a preset's: one that is a preset with its name follows the new one, unless
/// another material has that name.
///
/// ```
/// use translucid_load::name_after_preset;
/// use translucid_profile::convention::preset;
/// use translucid_scene::{Material, Unit};
///
/// let marble = Material::of_preset(preset("marble")?, Unit::Meter);
/// assert_eq!(name_after_preset(&marble, Unit::Meter, "skin1", ["backdrop"]), "skin1");
/// assert_eq!(name_after_preset(&marble, Unit::Meter, "skin1", ["skin1"]), "marble");
/// let of_a_person = Material { name: "nose".into(), ..marble };
/// assert_eq!(name_after_preset(&of_a_person, Unit::Meter, "skin1", ["backdrop"]), "nose");
/// # Ok::<(), translucid_profile::InputError>(())
/// ```
pub fn name_after_preset<'a>(
    base: &'a Material,
    unit: Unit,
    new: &str,
    others: impl IntoIterator<Item = &'a str>,
) -> &'a str {
    let (Ok(old), Ok(new)) = (preset(&base.name), preset(new)) else { return &base.name };
    let is_preset = old.name == base.name && *base == Material::of_preset(old, unit);
    let is_free = others.into_iter().all(|other| other != new.name);
    if is_preset && is_free { new.name } else { &base.name }
}

/// The material of the MaterialX document that the keys `file` name, else `base`; none if that is opened later.
fn read_document(
    table: &Table<'_>,
    base: &Material,
    unit: Unit,
    files: &mut NamedFiles,
) -> Result<Option<Material>> {
    let name = table.get("file_material").map(|item| item.name()).transpose()?;
    let length_unit = table.get("file_unit").map(|item| item.word()).transpose()?;
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
    let numbers: Vec<usize> = images.into_iter().map(|image| files.list.add_image(image)).collect();
    material.for_each_image(|image| *image = numbers[*image]);
    Ok(Some(material))
}

fn read_preset(item: &Item<'_>, unit: Unit) -> Result<Material> {
    match preset(item.text()?) {
        Ok(preset) => Ok(Material::of_preset(preset, unit)),
        Err(error) => Err(SceneError { place: Some(item.place()), ..error.into() }),
    }
}
