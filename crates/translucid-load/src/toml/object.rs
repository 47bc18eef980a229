//! `[[object]]`: a mesh file or a built-in shape with its place and material.

use std::path::PathBuf;

use crate::result::Result;

use glam::{Affine3A, DAffine3, DVec3, EulerRot, Mat3, Quat, Vec3};
use translucid_profile::nearest;
use translucid_scene::description::{Content, Item, Key, Table, Vectors};
use translucid_scene::{Interval, Material, Object, Place, Scene, Unit, WholeInterval};
use translucid_shapes::{ShapeParameterKind, ShapeParameters, shape_names, shape_parameters};

/// Keys of a file or shape, which an object with a mesh at hand does not have.
const GEOMETRY_KEYS: [&str; 3] = ["file", "shape", "unit"];

fn names(keys: &'static [Key]) -> impl Iterator<Item = &'static str> {
    keys.iter().map(|key| key.name)
}

/// Source of an object's geometry.
#[derive(Clone, Debug)]
pub(super) enum GeometryOrigin {
    /// A mesh file, and the unit of its coordinates.
    File { path: PathBuf, unit: Option<Unit> },
    /// A built-in shape.
    Shape { name: String, parameters: ShapeParameters },
    /// A mesh that is at hand.
    Given,
}

/// An object whose geometry is still to be loaded.
#[derive(Clone, Debug)]
pub(super) struct ObjectEntry {
    /// Unique name.
    pub(super) name: String,
    pub(super) geometry: GeometryOrigin,
    /// Where the file or shape is named.
    pub(super) place: Place,
    /// Its places, counted from the scene's origin, at least one; those of `transforms` have a number in the names of what stands there.
    pub(super) places: Vec<DAffine3>,
    pub(super) is_numbered: bool,
    /// Index of the material; the file's own where `None`.
    pub(super) material: Option<usize>,
    /// Name of the set of objects that share subsurface scattering.
    pub(super) subsurface_group: Option<String>,
    /// Whether the mesh stays in its own space.
    pub(super) is_movable: bool,
}

impl ObjectEntry {
    /// A name with the number of its place, if it has one.
    pub(super) fn name_at(&self, name: &str, place: usize) -> String {
        if self.is_numbered { format!("{name}[{place}]") } else { name.to_owned() }
    }
}

/// Reads an object and hands its table back, for messages about its name.
///
/// If the materials are not known yet, that of the object is not looked up.
pub(super) fn read_object<'a>(
    table: Table<'a>,
    materials: Option<&[Material]>,
) -> Result<(ObjectEntry, Table<'a>)> {
    let shape = table.get("shape").map(|item| read_shape_name(&item)).transpose()?;
    let parameters = shape.iter().flat_map(|(_, list)| list.iter().map(|parameter| parameter.name));
    let table = table.allow(&names(Object::KEYS).chain(parameters).collect::<Vec<_>>())?;
    let (geometry, place) = read_geometry(&table, shape)?;
    Ok((read_entry(&table, geometry, place, materials)?, table))
}

/// Reads an object whose mesh is at hand and belongs at this place.
pub(super) fn read_mesh_object(
    table: Table<'_>,
    place: Place,
    materials: &[Material],
) -> Result<ObjectEntry> {
    let keys = names(Object::KEYS).filter(|key| !GEOMETRY_KEYS.contains(key)).chain(["movable"]);
    let table = table.allow(&keys.collect::<Vec<_>>())?;
    let is_movable = table.read("movable", false, Item::flag)?;
    Ok(ObjectEntry { is_movable, ..read_entry(&table, GeometryOrigin::Given, place, Some(materials))? })
}

fn read_entry(
    table: &Table<'_>,
    geometry: GeometryOrigin,
    place: Place,
    materials: Option<&[Material]>,
) -> Result<ObjectEntry> {
    let world_from_object = read_transform(table)?;
    let transforms = table.get("transforms").map(|item| read_transforms(table, &item)).transpose()?;
    let is_numbered = transforms.is_some();
    let mut places: Vec<DAffine3> = match transforms {
        Some(transforms) => transforms.into_iter().map(|place| place * world_from_object).collect(),
        None => vec![world_from_object],
    };
    places.iter_mut().for_each(|place| place.translation -= DVec3::from_array(table.origin()));
    Ok(ObjectEntry {
        name: table.read("name", String::new(), Item::name)?,
        geometry,
        place,
        places,
        is_numbered,
        material: match (table.get("material"), materials) {
            (Some(item), Some(materials)) => Some(read_material_name(&item, materials)?),
            (Some(item), None) => item.text().map(|_| None)?,
            (None, _) => None,
        },
        subsurface_group: table.get("subsurface_group").map(|item| item.name()).transpose()?,
        is_movable: false,
    })
}

/// Another place and another material of an object, as far as they are stated.
pub(super) fn read_change(
    table: &Table<'_>,
    materials: &[Material],
) -> Result<(Option<Affine3A>, Option<usize>)> {
    let is_placed = names(Object::PLACE_KEYS).any(|key| table.get(key).is_some());
    let place = is_placed.then(|| read_transform(table)).transpose()?;
    let material = table.get("material").map(|item| read_material_name(&item, materials)).transpose()?;
    let from_origin = |place: DAffine3| DAffine3 {
        translation: place.translation - DVec3::from_array(table.origin()),
        ..place
    };
    Ok((place.map(|place| from_origin(place).as_affine3a()), material))
}

/// Keys of a change of an object.
pub(super) fn change_keys() -> Vec<&'static str> {
    ["material"].into_iter().chain(names(Object::PLACE_KEYS)).collect()
}

type ShapeList = &'static [translucid_shapes::ShapeParameter];

fn read_shape_name(item: &Item<'_>) -> Result<(String, ShapeList)> {
    let words: Vec<(&str, &str)> = shape_names().into_iter().map(|name| (name, name)).collect();
    let name = item.word_of(&words)?;
    Ok((name.to_owned(), shape_parameters(name).unwrap_or_default()))
}

fn read_geometry(table: &Table<'_>, shape: Option<(String, ShapeList)>) -> Result<(GeometryOrigin, Place)> {
    match (table.get("file"), table.get("shape").zip(shape)) {
        (Some(file), None) => {
            let unit = table.get("unit").map(|item| item.word()).transpose()?;
            Ok((GeometryOrigin::File { path: file.file()?, unit }, file.place()))
        }
        (None, Some((shape, (name, list)))) => {
            if let Some(unit) = table.get("unit") {
                let message = format!("{} is for files; a shape is in the scene's unit", unit.path());
                return Err(unit.error(message));
            }
            let parameters = read_shape_parameters(table, list)?;
            Ok((GeometryOrigin::Shape { name, parameters }, shape.place()))
        }
        (Some(_), Some((shape, _))) => {
            Err(shape.error(format!("{} has both file and shape, but must have one", table.path())))
        }
        (None, None) => Err(table.error(format!("{} needs the key file or shape", table.path()))),
    }
}

fn read_shape_parameters(table: &Table<'_>, list: ShapeList) -> Result<ShapeParameters> {
    let mut parameters = ShapeParameters::new();
    for parameter in list {
        let Some(item) = table.get(parameter.name) else { continue };
        let value = match parameter.kind {
            ShapeParameterKind::Count => {
                item.integer(WholeInterval::new(parameter.min as u64, parameter.max as u64))? as f64
            }
            ShapeParameterKind::Length | ShapeParameterKind::Ratio => {
                item.double(Interval::closed(parameter.min, parameter.max))?
            }
        };
        parameters.set(parameter.name, value);
    }
    Ok(parameters)
}

/// Index of the material of a name.
pub(super) fn read_material_name(item: &Item<'_>, materials: &[Material]) -> Result<usize> {
    let name = item.text()?;
    materials.iter().position(|material| material.name == name).ok_or_else(|| {
        let names = || materials.iter().map(|material| material.name.as_str());
        let error = item.refuse("the name of a material of this scene");
        match nearest(name, names()) {
            Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
            None if materials.is_empty() => error.with_help("the scene has no [[material]]"),
            None => error.with_help(format!("the materials are {}", names().collect::<Vec<_>>().join(", "))),
        }
    })
}

/// `matrix`, or scale, then rotation about x, y, z, then translation.
pub(super) fn read_transform(table: &Table<'_>) -> Result<DAffine3> {
    if let Some(matrix) = table.get("matrix") {
        if let Some(other) = ["translate", "rotate", "scale"].into_iter().find_map(|key| table.get(key)) {
            let message =
                format!("{} has matrix and {}, but must have one of them", table.path(), other.path());
            return Err(other.error(message));
        }
        return read_matrix(&matrix);
    }
    let translation = table.read("translate", DVec3::ZERO, |item| item.double3(Interval::COORDINATE))?;
    let angles = table.read("rotate", Vec3::ZERO, |item| item.vec3(Interval::ANGLE))?;
    let scale = table.read("scale", Vec3::ONE, read_scale)?;
    let [x, y, z] = angles.to_array().map(f32::to_radians);
    // Rz Ry Rx: extrinsic rotations about the fixed axes x, then y, then z.
    let rotation = Quat::from_euler(EulerRot::XYZEx, x, y, z);
    let linear = Affine3A::from_scale_rotation_translation(scale, rotation, Vec3::ZERO).matrix3;
    Ok(DAffine3 { matrix3: Mat3::from(linear).as_dmat3(), translation })
}

/// Places, each by the keys of an object's own.
fn read_transforms(table: &Table<'_>, item: &Item<'_>) -> Result<Vec<DAffine3>> {
    let tables = match item.content() {
        Content::List(array) if array.is_empty() => {
            return Err(item.error(format!("{} is empty, but must have at least one table", item.path())));
        }
        Content::List(_) => table.tables("transforms", Scene::MOST_OBJECTS)?,
        _ => return Err(item.mismatch("an array of tables like { translate = [1, 0, 0] }")),
    };
    let keys: Vec<_> = names(Object::PLACE_KEYS).collect();
    tables.into_iter().map(|place| read_transform(&place.allow(&keys)?)).collect()
}

fn read_scale(item: &Item<'_>) -> Result<Vec3> {
    let scale = match item.content() {
        Content::List(_) => item.vec3(Interval::SCALE)?,
        _ => Vec3::splat(item.number(Interval::SCALE)?),
    };
    if scale.abs().min_element() < 1e-9 {
        return Err(item.refuse("in [-1e9, 1e9] and at least 1e-9 away from zero"));
    }
    Ok(scale)
}

/// Sixteen numbers row by row, the last row 0 0 0 1.
fn read_matrix(item: &Item<'_>) -> Result<DAffine3> {
    let m: [f32; 16] = item.numbers(Interval::COORDINATE)?;
    let numbers = item.array::<16>("numbers")?;
    let mut translation = DVec3::ZERO;
    for axis in 0..3 {
        translation[axis] = numbers[4 * axis + 3].double(Interval::COORDINATE)?;
    }
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        return Err(item.refuse("four rows of four numbers whose last row is 0, 0, 0, 1"));
    }
    let linear = Mat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
    if linear.as_dmat3().determinant() == 0.0 {
        return Err(item.refuse("invertible: its determinant is 0"));
    }
    Ok(DAffine3 { matrix3: linear.as_dmat3(), translation })
}
