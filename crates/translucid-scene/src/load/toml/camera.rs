//! `[camera]`.

use glam::Vec3;

use super::document::Table;
use super::interval::Interval;
use crate::{Camera, SceneError};

pub(super) const KEYS: &[&str] = &["position", "target", "up", "fov", "lens_radius", "focus_distance"];

/// Sine of the smallest angle between `up` and the viewing direction.
const LEAST_SINE: f64 = 1e-4;

pub(super) fn read_camera(table: &Table<'_>) -> Result<Camera, SceneError> {
    let position = table.require("position")?.vec3(Interval::COORDINATE)?;
    let target_item = table.require("target")?;
    let target = target_item.vec3(Interval::COORDINATE)?;
    if target == position {
        return Err(target_item.refuse("a point other than camera.position"));
    }
    let up = table.read("up", Vec3::Y, |item| item.vec3(Interval::DIRECTION))?;
    check_up(table, target - position, up)?;
    let distance = position.as_dvec3().distance(target.as_dvec3()) as f32;
    Ok(Camera {
        position,
        target,
        up,
        horizontal_fov: table.read("fov", 40.0, |item| item.number(Interval::open(0.0, 180.0)))?,
        lens_radius: table.read("lens_radius", 0.0, |item| item.number(Interval::LENGTH))?,
        focus_distance: table
            .read("focus_distance", distance, |item| item.number(Interval::POSITIVE_LENGTH))?,
    })
}

/// `up` must span the image plane's vertical with the viewing direction.
fn check_up(table: &Table<'_>, view: Vec3, up: Vec3) -> Result<(), SceneError> {
    let sine = up.as_dvec3().normalize_or_zero().cross(view.as_dvec3().normalize_or_zero()).length();
    if sine > LEAST_SINE {
        return Ok(());
    }
    let must_be = "a direction that is not parallel to the viewing direction";
    match table.get("up") {
        Some(item) => Err(item.refuse(must_be)),
        None => Err(table
            .error(format!("camera.up is [0, 1, 0] by default, but must be {must_be}"))
            .with_help("give camera.up, for example [0, 0, -1]")),
    }
}
