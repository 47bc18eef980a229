//! `[camera]` and `[[camera]]`.

use std::collections::HashSet;

use translucid_scene::{Camera, Interval, Projection, SceneError};

use super::claim_name;
use super::document::{Item, Table};
use crate::NamedCamera;

/// Most cameras of a scene file.
const MOST_CAMERAS: usize = 65_536;

/// Words of `projection`, and whether they mean an orthographic one.
const PROJECTIONS: [(&str, bool); 2] = [("perspective", false), ("orthographic", true)];

pub(super) const KEYS: &[&str] =
    &["position", "target", "up", "projection", "fov", "width", "shift", "lens_radius", "focus_distance"];

/// Keys of a camera in a scene file, where several have names.
pub(super) const NAMED_KEYS: &[&str] = &[
    "name",
    "position",
    "target",
    "up",
    "projection",
    "fov",
    "width",
    "shift",
    "lens_radius",
    "focus_distance",
];

/// The camera of `[camera]`, or those of each `[[camera]]`.
pub(super) fn read_cameras(item: &Item<'_>) -> Result<Vec<NamedCamera>, SceneError> {
    let tables = item.one_or_more_tables(MOST_CAMERAS)?;
    let is_one = tables.len() == 1;
    let mut names = HashSet::new();
    let mut cameras = Vec::new();
    for table in tables {
        let table = table.allow(NAMED_KEYS)?;
        let name = match table.get("name") {
            None if is_one => String::new(),
            _ => table.require("name")?.name()?,
        };
        claim_name(&table, &name, &mut names)?;
        cameras.push(NamedCamera { name, camera: read_camera(&table)?, of_square: None });
    }
    Ok(cameras)
}

pub(super) fn read_camera(table: &Table<'_>) -> Result<Camera, SceneError> {
    let position = table.require("position")?.vec3(Interval::PLACE)?;
    let target_item = table.require("target")?;
    let target = target_item.vec3(Interval::PLACE)?;
    if target == position {
        return Err(target_item.refuse("a point other than camera.position"));
    }
    let default = Camera::default();
    let up = table.read("up", default.up, |item| item.vec3(Interval::DIRECTION))?;
    let view = Camera { position, target, up, ..default };
    check_up(table, &view)?;
    let distance = position.as_dvec3().distance(target.as_dvec3()) as f32;
    let distance = Interval::REACH.nearest(distance);
    Ok(Camera {
        projection: read_projection(table, default.projection)?,
        shift: table.read("shift", default.shift, |item| item.vec2(Camera::SHIFT))?,
        lens_radius: table.read("lens_radius", default.lens_radius, |item| item.number(Interval::LENGTH))?,
        focus_distance: table.read("focus_distance", distance, |item| item.number(Interval::REACH))?,
        ..view
    })
}

fn read_projection(table: &Table<'_>, default: Projection) -> Result<Projection, SceneError> {
    let is_orthographic = table.read("projection", false, |item| item.word(&PROJECTIONS))?;
    let (name, other) = if is_orthographic { ("orthographic", "fov") } else { ("perspective", "width") };
    if let Some(item) = table.get(other) {
        return Err(
            item.error(format!("{} is not a key of a camera whose projection is {name}", item.path()))
        );
    }
    if is_orthographic {
        return Ok(Projection::Orthographic { width: table.require("width")?.number(Interval::REACH)? });
    }
    let fov = |item: &Item<'_>| Ok(Projection::Perspective { horizontal_fov: item.number(Projection::FOV)? });
    table.read("fov", default, fov)
}

fn check_up(table: &Table<'_>, view: &Camera) -> Result<(), SceneError> {
    if view.has_usable_up() {
        return Ok(());
    }
    match table.get("up") {
        Some(item) => Err(item.refuse(Camera::UP)),
        None => Err(table
            .error(format!("camera.up is [0, 1, 0] by default, but must be {}", Camera::UP))
            .with_help("give camera.up, for example [0, 0, -1]")),
    }
}
