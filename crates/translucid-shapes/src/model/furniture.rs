//! A table top of wooden boards.

use glam::Vec3;
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::smoothstep;
use crate::implicit::noise::{fractal_noise, noise};
use crate::implicit::sculpture::srgb;
use crate::parameters::{ShapeParameter, Values};
use crate::primitive::rounded_box::rounded_box;

pub(crate) const TABLE_TOP: &[ShapeParameter] = &[
    ShapeParameter::length("width", 120.0), // Along x, the direction of the grain
    ShapeParameter::length("depth", 50.0),
    ShapeParameter::length("thickness", 3.0), // Downward from y = 0
    ShapeParameter::length_or_zero("edge_radius", 0.4),
    ShapeParameter::count("boards", 4.0, 1.0, 64.0),
    ShapeParameter::count("detail", 480.0, 8.0, 4096.0), // Grid cells across the grain
    ShapeParameter::count("seed", 1.0, 0.0, 65535.0),
];

pub(crate) fn table_top(values: &Values) -> Result<Mesh, SceneError> {
    let size = Vec3::new(values.get("width"), values.get("thickness"), values.get("depth"));
    let (detail, boards, seed) = (values.count("detail"), values.get("boards"), values.count("seed") as u32);
    // The grain is long: it needs few cells along x.
    let flat = [(detail / 8).max(1), 1, detail];
    let mut mesh = rounded_box(0.5 * size, values.get("edge_radius"), 4, flat);
    let board = size.z / boards;
    // The pattern is that of boards 13 wide, whatever the unit.
    mesh.colors = mesh.positions.iter().map(|p| wood(*p * (13.0 / board), 0.5 * boards, seed)).collect();
    mesh.positions.iter_mut().for_each(|p| p.y -= 0.5 * size.y);
    Ok(mesh)
}

/// Color of oiled walnut: year rings about an axis below each board, fibers, pores, joints.
fn wood(p: Vec3, half_boards: f32, seed: u32) -> Vec3 {
    // The outer boards go on over the edge.
    let across = (p.z / 13.0 + half_boards).clamp(0.02, 2.0 * half_boards - 0.02);
    let (board, within) = (across.floor(), across - across.floor());
    let chance = |k: f32| 0.5 + 0.5 * noise(Vec3::new(7.3 * board + 0.5, k, 0.5), seed);
    // Each board is cut from another place of the trunk.
    let q = Vec3::new(
        p.x + 300.0 * chance(1.5),
        p.y - 9.0 - 9.0 * chance(3.5),
        13.0 * (within - 0.2 - 0.6 * chance(5.5)),
    );
    let bow = 2.2 * noise(Vec3::new(0.018 * q.x, 0.5, 3.0 * board), seed + 1)
        + 0.35 * noise(Vec3::new(0.09 * q.x, 0.2 * q.z, 0.5), seed + 2);
    let rings = (0.9
        * (libm::hypotf(q.y, q.z + bow)
            + 0.25 * noise(Vec3::new(0.12 * q.x, 0.8 * q.y, 0.8 * q.z), seed + 3)))
    .rem_euclid(1.0);
    let late = smoothstep(0.35, 0.92, rings) * smoothstep(1.0, 0.94, rings);
    let fibers = fractal_noise(Vec3::new(0.22 * q.x, 5.0 * q.y, 5.0 * q.z), 3, seed + 4);
    let pores = smoothstep(0.35, 0.75, noise(Vec3::new(0.5 * q.x, 9.0 * q.y, 9.0 * q.z), seed + 8));
    let early = srgb(0x94643e).lerp(srgb(0x7d5030), chance(9.5));
    let color = early.lerp(srgb(0x4a2c18), (0.62 * late + 0.3 * fibers + 0.08).clamp(0.0, 1.0));
    let color = color * (0.82 + 0.32 * chance(11.5)) * (1.0 - 0.35 * pores);
    let joint = smoothstep(0.012, 0.004, within.min(1.0 - within));
    color * (1.0 - 0.85 * joint)
}
