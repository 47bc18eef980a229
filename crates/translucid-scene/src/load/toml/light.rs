//! `[[light]]` and `[environment]`.

use glam::{DVec3, Mat3, Vec3};

use super::document::{Item, Table};
use super::input::{FileList, read_constant_color};
use crate::interval::Interval;
use crate::{ColorSpace, Environment, Light, SceneError};

pub(super) const RECTANGLE_KEYS: &[&str] =
    &["type", "center", "target", "direction", "up", "size", "radiance", "visible"];
pub(super) const SPHERE_KEYS: &[&str] = &["type", "center", "radius", "radiance", "visible"];
pub(super) const DISTANT_KEYS: &[&str] = &["type", "direction", "angular_radius", "irradiance"];
pub(super) const SPOT_KEYS: &[&str] =
    &["type", "position", "target", "direction", "intensity", "inner_angle", "outer_angle"];
pub(super) const POINT_KEYS: &[&str] = &["type", "position", "intensity"];
pub(super) const BEAM_KEYS: &[&str] = &["type", "origin", "target", "direction", "radius", "power"];
pub(super) const ENVIRONMENT_KEYS: &[&str] = &["radiance", "file", "rotation", "visible"];

type Reader = fn(&Table<'_>) -> Result<Light, SceneError>;

/// Type, keys and reader of every light.
pub(super) const TYPES: [(&str, (&[&str], Reader)); 6] = [
    ("rectangle", (RECTANGLE_KEYS, read_rectangle)),
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
    let normal = read_direction(table, center)?;
    let up = table.read("up", DVec3::Y, read_unit_vector)?;
    let [width, height] = table.require("size")?.numbers(Interval::REACH)?;
    // A rectangle that faces along `up` has its edges along x and z.
    let across = up.cross(normal).try_normalize().filter(|_| up.cross(normal).length() > 1e-6);
    let across = across.unwrap_or_else(|| normal.cross(DVec3::Z).try_normalize().unwrap_or(DVec3::X));
    Ok(Light::Rectangle {
        center,
        edge_x: (across * f64::from(width)).as_vec3(),
        edge_y: (normal.cross(across) * f64::from(height)).as_vec3(),
        radiance: read_light_color(table, "radiance")?,
        visible: table.read("visible", true, Item::boolean)?,
    })
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
        direction: read_unit_vector(&table.require("direction")?)?.as_vec3(),
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
        direction: read_direction(table, position)?.as_vec3(),
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
        intensity: read_light_color(table, "intensity")?,
        inner_angle: 0.0,
        outer_angle: 180.0,
    })
}

fn read_beam(table: &Table<'_>) -> Result<Light, SceneError> {
    let origin = read_point_of(table, "origin")?;
    Ok(Light::Beam {
        origin,
        direction: read_direction(table, origin)?.as_vec3(),
        radius: table.require("radius")?.number(Interval::REACH)?,
        power: read_light_color(table, "power")?,
    })
}

pub(super) fn read_environment(table: &Table<'_>, images: &mut FileList) -> Result<Environment, SceneError> {
    let file = table.get("file");
    if file.is_none() {
        table.require("radiance")?;
    }
    let image = file.map(|item| images.image(&item, ColorSpace::Srgb)).transpose()?;
    let rotation = table.read("rotation", 0.0, |item| item.number(Interval::ANGLE))?;
    Ok(Environment {
        radiance: table.read("radiance", Vec3::ONE, |item| read_constant_color(item, Interval::LIGHT))?,
        image,
        world_from_environment: Mat3::from_rotation_y(rotation.to_radians()),
        visible: table.read("visible", true, Item::boolean)?,
    })
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

fn read_unit_vector(item: &Item<'_>) -> Result<DVec3, SceneError> {
    let direction = item.vec3(Interval::DIRECTION)?.as_dvec3();
    direction.try_normalize().ok_or_else(|| item.refuse("a direction that is not zero"))
}
