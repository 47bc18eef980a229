//! A box with rounded edges.

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3};
use translucid_scene::Mesh;

/// A coordinate of a face's grid: where the flat part ends and how far along the rounding, −1 … 1.
#[derive(Clone, Copy)]
struct Station {
    inner: f32,
    bend: f32,
}

/// Stations along an axis of half-length `half`: the rounding, the flat part in `flat` segments, the rounding.
fn stations(half: f32, edge_radius: f32, arc: usize, flat: usize) -> Vec<Station> {
    let inner = half - edge_radius;
    let rounding = if edge_radius > 0.0 { arc } else { 0 };
    // tan maps equal steps to equal angles; the ends are ±1 exactly so that faces meet to the bit.
    let bend =
        |k: usize| if k == rounding { 1.0 } else { libm::tanf(FRAC_PI_4 * k as f32 / rounding as f32) };
    let mut list: Vec<Station> =
        (1..=rounding).rev().map(|k| Station { inner: -inner, bend: -bend(k) }).collect();
    list.extend((0..=flat).map(|k| {
        let inner = if k == flat { inner } else { inner * (2.0 * k as f32 / flat as f32 - 1.0) };
        Station { inner, bend: 0.0 }
    }));
    list.extend((1..=rounding).map(|k| Station { inner, bend: bend(k) }));
    list
}

/// A box about the origin with half-lengths `half`, edges rounded to `edge_radius` by `arc` segments,
/// and `flat` segments along each axis of the flat parts. Texture coordinates cover each face once.
pub(crate) fn rounded_box(half: Vec3, edge_radius: f32, arc: usize, flat: [usize; 3]) -> Mesh {
    let edge_radius = edge_radius.clamp(0.0, 0.999 * half.min_element());
    let axes: Vec<Vec<Station>> =
        (0..3).map(|axis| stations(half[axis], edge_radius, arc, flat[axis])).collect();
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            // (u, v, axis) is right-handed on the positive face; the negative one exchanges u and v.
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let (u, v) = if sign > 0.0 { (u, v) } else { (v, u) };
            push_face(&mut mesh, &axes, [u, v, axis], sign * (half[axis] - edge_radius), edge_radius);
        }
    }
    mesh
}

/// One face: grid of the stations of axes u and v at height `inner` on the third axis.
fn push_face(mesh: &mut Mesh, axes: &[Vec<Station>], [u, v, w]: [usize; 3], inner: f32, edge_radius: f32) {
    let first = mesh.positions.len() as u32;
    let (columns, rows) = (&axes[u], &axes[v]);
    for row in rows {
        for column in columns {
            let (mut center, mut direction) = (Vec3::ZERO, Vec3::ZERO);
            (center[u], center[v], center[w]) = (column.inner, row.inner, inner);
            (direction[u], direction[v], direction[w]) = (column.bend, row.bend, inner.signum());
            let normal = direction.normalize();
            let position = center + edge_radius * normal;
            mesh.positions.push(position);
            mesh.normals.push(normal);
            let half = Vec2::new(columns[0].inner, rows[0].inner).abs() + edge_radius;
            mesh.uvs.push(0.5 * Vec2::new(position[u], position[v]) / half + 0.5);
        }
    }
    let width = columns.len() as u32;
    for y in 0..rows.len() as u32 - 1 {
        for x in 0..width - 1 {
            let a = first + y * width + x;
            mesh.triangles.push([a, a + 1, a + width + 1]);
            mesh.triangles.push([a, a + width + 1, a + width]);
        }
    }
}
