//! Triangles, and other things, on their way into a hierarchy.

use bytemuck::Pod;
use glam::{Vec3, Vec3A};
use obvhs::Boundable;
use obvhs::aabb::Aabb;

/// What a leaf of a tree holds: as long as some cache lines.
pub(crate) trait Block: Pod + Default {
    /// Things that there is room for.
    const LANES: usize;
}

/// Where what is in a tree comes from.
pub(crate) trait PrimitiveSource: Boundable {
    /// What holds it in the tree.
    type Block: Block;

    /// Puts it into a lane.
    fn put(&self, block: &mut Self::Block, lane: usize);
}

/// A triangle to be sorted into the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Primitive {
    pub(crate) vertices: [Vec3; 3],
    pub(crate) object: u32,
    pub(crate) triangle: u32,
    pub(crate) group: u32,
}

impl Boundable for Primitive {
    fn aabb(&self) -> Aabb {
        let [a, b, c] = self.vertices.map(Vec3A::from);
        // The box test rounds: a little room keeps it from culling what the triangle test would hit.
        // It differs between triangles, since the builder takes quadratic time over equal boxes.
        let jitter = (self.triangle.wrapping_mul(0x9e37_79b9) >> 28) as f32;
        let room = a.abs().max(b.abs()).max(c.abs()).max_element() * (4.0 + jitter) * f32::EPSILON;
        Aabb::new(a.min(b).min(c) - room, a.max(b).max(c) + room)
    }
}

impl Primitive {
    /// The geometric normal, counter-clockwise, twice the area long.
    pub(crate) fn normal(&self) -> Vec3 {
        let [a, b, c] = self.vertices;
        (b - a).cross(c - a)
    }

    /// The point at barycentric coordinates of vertices 1 and 2.
    pub(crate) fn point(&self, [b1, b2]: [f32; 2]) -> Vec3 {
        let [a, b, c] = self.vertices;
        a + (b - a) * b1 + (c - a) * b2
    }
}
