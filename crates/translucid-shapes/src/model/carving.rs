//! An abstract carving in the manner of the twentieth century: a hollow oval, pierced, with thin walls.

use glam::{Quat, Vec3};
use translucid_scene::{Mesh, SceneError};

use super::bust::marble;
use crate::implicit::distance::{carve, ellipsoid};
use crate::implicit::sculpture::{detail, height, sculpt};
use crate::parameters::{ShapeParameter, Values};

pub(crate) const CARVING: &[ShapeParameter] = &[
    height(24.0),
    detail(256.0),
    ShapeParameter::count("seed", 1.0, 0.0, 65535.0),
    ShapeParameter::ratio("veins", 0.5, 0.0, 1.0), // Their strength
];

/// Turn about y for each unit of height: the hollow winds around the form.
const TWIST: f32 = 0.085;

fn form(p: Vec3) -> f32 {
    let q = Quat::from_rotation_y(TWIST * p.y) * p;
    let lean = Vec3::new(q.x + 0.10 * q.y, q.y, q.z);
    let oval = ellipsoid(lean, Vec3::new(4.3 - 0.10 * q.y, 6.6, 3.5 - 0.06 * q.y));
    let hollow = ellipsoid(q - Vec3::new(0.5, 0.7, 1.3), Vec3::new(3.45, 5.2, 4.15));
    let shell = carve(oval, hollow, 0.35);
    let window =
        ellipsoid(Quat::from_rotation_z(0.5) * (q - Vec3::new(-0.7, 1.7, -2.2)), Vec3::new(1.25, 1.9, 3.0));
    let mouth = ellipsoid(q - Vec3::new(3.6, -1.7, -0.6), Vec3::new(2.6, 1.15, 1.3));
    0.85 * carve(carve(shell, window, 0.45), mouth, 0.45)
}

pub(crate) fn carving(values: &Values) -> Result<Mesh, SceneError> {
    let (seed, veins) = (values.count("seed") as u32, values.get("veins"));
    let color = move |p: Vec3, _: Vec3| marble(p, seed, veins);
    let bounds = [Vec3::new(-6.2, -7.0, -5.2), Vec3::new(6.2, 7.0, 5.2)];
    Ok(sculpt(bounds, form, color, values))
}
