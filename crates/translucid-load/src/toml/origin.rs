//! The origin of the scene of a file: near what its camera looks at.

use glam::{DAffine3, DVec3};
use translucid_scene::description::{Table, Vectors};
use translucid_scene::{Interval, Scene};

use super::object::read_transform;
use crate::origin::origin_near;

/// The origin for the first camera, or where there is none for the objects' places. What is wrong in the file is reported when
/// it is read.
pub(super) fn of_scene_file(root: &Table<'_>) -> DVec3 {
    of_camera(root).or_else(|| of_places(root)).unwrap_or_default()
}

fn of_camera(root: &Table<'_>) -> Option<DVec3> {
    let tables = root.get("camera")?.one_or_more_tables(usize::MAX).ok()?;
    let camera = tables.first()?;
    let [position, target] = ["position", "target"].map(|key| camera.get(key));
    let [position, target] =
        [position?.double3(Interval::PLACE).ok()?, target?.double3(Interval::PLACE).ok()?];
    Some(origin_near(target, position.distance(target)))
}

fn of_places(root: &Table<'_>) -> Option<DVec3> {
    let objects = root.tables("object", Scene::MOST_OBJECTS).ok()?;
    let places: Vec<DAffine3> = objects.iter().filter_map(|object| read_transform(object).ok()).collect();
    let corners =
        |least: fn(DVec3, DVec3) -> DVec3| places.iter().map(|place| place.translation).reduce(least);
    let (low, high) = (corners(DVec3::min)?, corners(DVec3::max)?);
    // How large shapes and files are is not known yet
    const LARGEST: f64 = 64.0;
    let scale = places.iter().map(|place| libm::cbrt(place.matrix3.determinant().abs())).fold(0.0, f64::max);
    Some(origin_near(0.5 * (low + high), (0.5 * (high - low).max_element()).max(LARGEST * scale)))
}
