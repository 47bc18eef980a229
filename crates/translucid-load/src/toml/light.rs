//! `[[light]]` and `[environment]`.

use glam::{DVec3, Mat3, Vec3};
use translucid_scene::{ColorSpace, Environment, Interval, Light, SceneError};

use super::document::{Item, Table};
use super::input::{FileList, read_constant_color};

pub(super) const RECTANGLE_KEYS: &[&str] =
    &["type", "center", "target", "direction", "up", "size", "edge_x", "edge_y", "radiance", "visible"];
pub(super) const SPHERE_KEYS: &[&str] = &["type", "center", "radius", "radiance", "visible"];
pub(super) const DISTANT_KEYS: &[&str] =
    &["type", "direction", "unit_direction", "angular_radius", "irradiance"];
pub(super) const SPOT_KEYS: &[&str] = &[
    "type",
    "position",
    "target",
    "direction",
    "unit_direction",
    "radius",
    "intensity",
    "inner_angle",
    "outer_angle",
    "visible",
];
pub(super) const POINT_KEYS: &[&str] = &["type", "position", "radius", "intensity", "visible"];
pub(super) const BEAM_KEYS: &[&str] =
    &["type", "origin", "target", "direction", "unit_direction", "radius", "power"];
pub(super) const ENVIRONMENT_KEYS: &[&str] = &["radiance", "file", "rotation", "matrix", "visible"];

type Reader = fn(&Table<'_>) -> Result<Light, SceneError>;

/// Type, keys and reader of every light.
pub(super) const TYPES: [(&str, (&[&str], Reader)); 7] = [
    ("rectangle", (RECTANGLE_KEYS, read_rectangle)),
    ("ellipse", (RECTANGLE_KEYS, read_ellipse)),
    ("sphere", (SPHERE_KEYS, read_sphere)),
    ("distant", (DISTANT_KEYS, read_distant)),
    ("spot", (SPOT_KEYS, read_spot)),
    ("point", (POINT_KEYS, read_point)),
    ("beam", (BEAM_KEYS, read_beam)),
];

pub(super) fn read_light(table: Table<'_>) -> Result<Light, SceneError> {
    let (keys, read) = table.require("type")?.word(&TYPES)?;
    read(&table.allow(keys)?)
}

fn read_rectangle(table: &Table<'_>) -> Result<Light, SceneError> {
    let center = read_point_of(table, "center")?;
    let [edge_x, edge_y] = match (table.get("edge_x"), table.get("edge_y")) {
        (None, None) => read_placement(table, center)?,
        _ => read_edges(table)?,
    };
    Ok(Light::Rectangle {
        center,
        edge_x,
        edge_y,
        radiance: read_light_color(table, "radiance")?,
        visible: table.read("visible", true, Item::boolean)?,
    })
}

/// The ellipse in a rectangle.
fn read_ellipse(table: &Table<'_>) -> Result<Light, SceneError> {
    let rectangle = read_rectangle(table)?;
    let Light::Rectangle { center, edge_x, edge_y, radiance, visible } = rectangle else {
        return Ok(rectangle);
    };
    Ok(Light::Ellipse { center, edge_x, edge_y, radiance, visible })
}

/// Edges of a rectangle about `center` by its direction, `up` and size.
fn read_placement(table: &Table<'_>, center: Vec3) -> Result<[Vec3; 2], SceneError> {
    let normal = read_direction(table, center)?;
    let up = table.read("up", DVec3::Y, read_unit_vector)?;
    let [width, height] = table.require("size")?.numbers(Interval::REACH)?;
    // A rectangle that faces along `up` has its edges along x and z.
    let across = up.cross(normal).try_normalize().filter(|_| up.cross(normal).length() > 1e-6);
    let across = across.unwrap_or_else(|| normal.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X));
    Ok([(across * f64::from(width)).as_vec3(), (normal.cross(across) * f64::from(height)).as_vec3()])
}

fn read_edges(table: &Table<'_>) -> Result<[Vec3; 2], SceneError> {
    let (x, y) = (table.require("edge_x")?, table.require("edge_y")?);
    let edges = [x.vec3(Interval::PLACE)?, y.vec3(Interval::PLACE)?];
    if let Some(other) = ["target", "direction", "up", "size"].into_iter().find_map(|key| table.get(key)) {
        let message = format!("{} has edge_x and {}, but must have one of them", table.path(), other.path());
        return Err(other.error(message));
    }
    Light::check_edges(edges[0], edges[1])
        .map_err(|error| y.error(format!("{}, {}", table.path(), error.message)))?;
    Ok(edges)
}

fn read_sphere(table: &Table<'_>) -> Result<Light, SceneError> {
    Ok(Light::Sphere {
        center: read_point_of(table, "center")?,
        radius: table.require("radius")?.number(Interval::REACH)?,
        radiance: read_light_color(table, "radiance")?,
        visible: table.read("visible", true, Item::boolean)?,
    })
}

fn read_distant(table: &Table<'_>) -> Result<Light, SceneError> {
    Ok(Light::Distant {
        direction: match table.get("unit_direction") {
            Some(item) => read_exact_direction(&item, table.get("direction"))?,
            None => read_unit_vector(&table.require("direction")?)?.as_vec3(),
        },
        angular_radius: table.read("angular_radius", 0.0, |item| item.number(Light::ANGULAR_RADIUS))?,
        irradiance: read_light_color(table, "irradiance")?,
    })
}

fn read_spot(table: &Table<'_>) -> Result<Light, SceneError> {
    let position = read_point_of(table, "position")?;
    let outer_angle = table.read("outer_angle", 45.0, |item| item.number(Light::OUTER_ANGLE))?;
    let inner_range = Light::inner_angle_within(outer_angle);
    Ok(Light::Spot {
        position,
        direction: read_single_direction(table, position)?,
        radius: table.read("radius", 0.0, |item| item.number(Light::SPOT_RADIUS))?,
        visible: table.read("visible", true, Item::boolean)?,
        intensity: read_light_color(table, "intensity")?,
        inner_angle: table.read("inner_angle", 0.8 * outer_angle, |item| item.number(inner_range))?,
        outer_angle,
    })
}

/// A spot without an edge.
fn read_point(table: &Table<'_>) -> Result<Light, SceneError> {
    Ok(Light::Spot {
        position: read_point_of(table, "position")?,
        direction: Vec3::NEG_Y,
        radius: table.read("radius", 0.0, |item| item.number(Light::SPOT_RADIUS))?,
        visible: table.read("visible", true, Item::boolean)?,
        intensity: read_light_color(table, "intensity")?,
        inner_angle: 0.0,
        outer_angle: 180.0,
    })
}

fn read_beam(table: &Table<'_>) -> Result<Light, SceneError> {
    let origin = read_point_of(table, "origin")?;
    Ok(Light::Beam {
        origin,
        direction: read_single_direction(table, origin)?,
        radius: table.require("radius")?.number(Interval::REACH)?,
        power: read_light_color(table, "power")?,
    })
}

/// Reads an environment; without a file it has what it does not say from `base`, if there is one.
pub(super) fn read_environment(
    table: &Table<'_>,
    base: Option<Environment>,
    images: &mut FileList,
) -> Result<Environment, SceneError> {
    let named = table.get("file");
    let is_removed = base.is_some() && named.as_ref().is_some_and(Item::is_none);
    let file = named.filter(|_| !is_removed);
    // With an image of its own, or without that of the base, it is a new one
    let base = base.filter(|_| file.is_none() && !is_removed);
    if base.is_none() && file.is_none() {
        table.require("radiance")?;
    }
    let base = base.unwrap_or_default();
    Ok(Environment {
        radiance: table.read("radiance", base.radiance, |item| read_constant_color(item, Interval::LIGHT))?,
        image: match file {
            Some(item) => Some(images.image(&item, ColorSpace::Srgb)?),
            None => base.image,
        },
        world_from_environment: read_rotation(table, base.world_from_environment)?,
        visible: table.read("visible", base.visible, Item::boolean)?,
    })
}

/// `rotation` about y, or any as `matrix`: nine numbers row by row.
fn read_rotation(table: &Table<'_>, base: Mat3) -> Result<Mat3, SceneError> {
    match (table.get("rotation"), table.get("matrix")) {
        (None, None) => Ok(base),
        (Some(angle), None) => Ok(Mat3::from_rotation_y(angle.number(Interval::ANGLE)?.to_radians())),
        (None, Some(item)) => {
            let matrix = Mat3::from_cols_array(&item.numbers(Interval::DIRECTION)?).transpose();
            if Environment::is_rotation(matrix) {
                Ok(matrix)
            } else {
                Err(item.refuse("a rotation, row by row"))
            }
        }
        (Some(_), Some(item)) => {
            let path = table.path();
            Err(item.error(format!("{path} has both rotation and matrix, but must have one")))
        }
    }
}

fn read_light_color(table: &Table<'_>, key: &'static str) -> Result<Vec3, SceneError> {
    read_constant_color(&table.require(key)?, Interval::LIGHT)
}

fn read_point_of(table: &Table<'_>, key: &'static str) -> Result<Vec3, SceneError> {
    table.require(key)?.vec3(Interval::PLACE)
}

/// Unit vector along `direction`, or from a point to `target`: exactly one of them is given.
fn read_direction(table: &Table<'_>, from: Vec3) -> Result<DVec3, SceneError> {
    match (table.get("direction"), table.get("target")) {
        (Some(direction), None) => read_unit_vector(&direction),
        (None, Some(target)) => {
            let to = target.vec3(Interval::PLACE)?.as_dvec3() - from.as_dvec3();
            to.try_normalize().ok_or_else(|| target.refuse("a point other than the light's own"))
        }
        (Some(direction), Some(_)) => {
            Err(direction.error(format!("{} has both direction and target, but must have one", table.path())))
        }
        (None, None) => Err(table.error(format!("{} needs the key target or direction", table.path()))),
    }
}

/// As [`read_direction`], in single precision, or a `unit_direction`.
fn read_single_direction(table: &Table<'_>, from: Vec3) -> Result<Vec3, SceneError> {
    match table.get("unit_direction") {
        Some(item) => read_exact_direction(&item, table.get("direction").or_else(|| table.get("target"))),
        None => read_direction(table, from).map(|direction| direction.as_vec3()),
    }
}

/// A direction that is taken as it is, in place of another key.
fn read_exact_direction(item: &Item<'_>, other: Option<Item<'_>>) -> Result<Vec3, SceneError> {
    let direction = item.vec3(Interval::DIRECTION)?;
    if let Some(other) = other {
        let message = format!("{} and {} are given, but only one of them must be", item.path(), other.path());
        return Err(other.error(message));
    }
    Light::check_unit("", direction).map_err(|_| item.refuse("a vector of length 1"))?;
    Ok(direction)
}

fn read_unit_vector(item: &Item<'_>) -> Result<DVec3, SceneError> {
    let direction = item.vec3(Interval::DIRECTION)?.as_dvec3();
    direction.try_normalize().ok_or_else(|| item.refuse("a direction that is not zero"))
}
