//! Sculpted shapes: a distance function and a color in natural size, meshed and scaled to order.

use glam::Vec3;

use super::surface_nets::{Solid, mesh_solid};
use crate::Mesh;
use crate::shapes::parameters::{ShapeParameter, Values};

/// A solid from two functions.
pub(in crate::shapes) struct Sculpture<D, C> {
    /// Two opposite corners of a box that contains it.
    pub(in crate::shapes) bounds: [Vec3; 2],
    /// Signed distance.
    pub(in crate::shapes) distance: D,
    /// Color from point and normal.
    pub(in crate::shapes) color: C,
}

impl<D: Fn(Vec3) -> f32 + Sync, C: Fn(Vec3, Vec3) -> Vec3 + Sync> Solid for Sculpture<D, C> {
    fn bounds(&self) -> [Vec3; 2] {
        self.bounds
    }

    fn distance(&self, p: Vec3) -> f32 {
        (self.distance)(p)
    }

    fn color(&self, p: Vec3, n: Vec3) -> Vec3 {
        (self.color)(p, n)
    }
}

/// Fineness of the mesh.
pub(in crate::shapes) const fn detail(default: f64) -> ShapeParameter {
    ShapeParameter::count("detail", "grid cells along the longest side", default, 32.0, 512.0)
}

/// Overall height.
pub(in crate::shapes) const fn height(default: f64) -> ShapeParameter {
    ShapeParameter::length("height", "height over all", default)
}

/// Meshes a solid with the parameter `detail`, scales it to `height` and stands it on y = 0.
pub(in crate::shapes) fn sculpt(solid: &impl Solid, values: &Values) -> Mesh {
    let mut mesh = mesh_solid(solid, values.count("detail"));
    stand(&mut mesh, values.get("height"));
    mesh
}

/// Scales a mesh to a height and stands it on y = 0.
pub(in crate::shapes) fn stand(mesh: &mut Mesh, height: f32) {
    let ys = || mesh.positions.iter().map(|p| p.y);
    let (low, high) = (ys().fold(f32::MAX, f32::min), ys().fold(f32::MIN, f32::max));
    let scale = height / (high - low);
    for position in &mut mesh.positions {
        *position = scale * (*position - Vec3::new(0.0, low, 0.0));
    }
}

/// A color from its 8-bit sRGB notation, linear.
pub(in crate::shapes) fn srgb(code: u32) -> Vec3 {
    let channel = |shift: u32| {
        let value = (code >> shift & 0xff) as f32 / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(channel(16), channel(8), channel(0))
}
