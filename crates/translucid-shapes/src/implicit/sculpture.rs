//! Sculpted shapes: a distance function and a color in natural size, meshed and scaled to order.

use glam::Vec3;
use rayon::prelude::*;
use translucid_scene::{Mesh, SRGB_TABLE};

use super::surface_nets::mesh_solid;
use crate::parameters::{ShapeParameter, Values};

/// Fineness of the mesh.
pub(crate) const fn detail(default: f64) -> ShapeParameter {
    ShapeParameter::count("detail", default, 32.0, 512.0)
}

/// Overall height.
pub(crate) const fn height(default: f64) -> ShapeParameter {
    ShapeParameter::length("height", default)
}

/// Meshes a solid with the parameter `detail`, scales it to `height` and stands it on y = 0.
///
/// The solid lies within a box of two opposite corners; `distance` is as [`mesh_solid`] takes it, and `color` the linear
/// color of a surface point with its outward normal.
pub(crate) fn sculpt(
    bounds: [Vec3; 2],
    distance: impl Fn(Vec3) -> f32 + Sync,
    color: impl Fn(Vec3, Vec3) -> Vec3 + Sync,
    values: &Values,
) -> Mesh {
    let mut mesh = mesh_solid(bounds, &distance, values.count("detail"));
    let points = mesh.positions.par_iter().zip(mesh.normals.par_iter());
    mesh.colors = points.map(|(&p, &n)| color(p, n).clamp(Vec3::ZERO, Vec3::ONE)).collect();
    stand(&mut mesh, values.get("height"));
    mesh
}

/// Scales a mesh to a height and stands it on y = 0.
pub(crate) fn stand(mesh: &mut Mesh, height: f32) {
    let ys = || mesh.positions.iter().map(|p| p.y);
    let (low, high) = (ys().fold(f32::MAX, f32::min), ys().fold(f32::MIN, f32::max));
    let scale = height / (high - low);
    for position in &mut mesh.positions {
        *position = scale * (*position - Vec3::new(0.0, low, 0.0));
    }
}

/// A color from its 8-bit sRGB notation, linear.
pub(crate) fn srgb(code: u32) -> Vec3 {
    let channel = |shift: u32| SRGB_TABLE[(code >> shift & 0xff) as usize];
    Vec3::new(channel(16), channel(8), channel(0))
}
