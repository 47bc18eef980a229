//! Triangles, and other things, to be sorted into a hierarchy.

use bytemuck::Pod;
use glam::{Vec3, Vec3A};
use obvhs::Boundable;
use obvhs::aabb::Aabb;

use super::simd::LANES;

/// The content of a tree's leaf; its size is a multiple of a cache line's.
pub(crate) trait Block: Pod + Default + Send + Sync {
    /// Things that there is room for.
    const LANES: usize;

    /// Sets where the numbers of its things begin among those of the tree.
    fn set_first(&mut self, _first: u32) {}
}

/// A thing to be put into a tree.
pub(crate) trait PrimitiveSource: Boundable + Sync {
    /// The block that holds it in the tree.
    type Block: Block;

    /// Its needs in a block; `None` if it needs a whole block.
    fn needs(&self) -> Option<BlockNeeds>;

    /// A point of it.
    fn place(&self) -> Vec3;

    /// Puts it into a lane of a block whose lower lanes are filled, and returns its number.
    fn put(&self, block: &mut Self::Block, lane: usize) -> u32;
}

/// Corners that a block has room for.
pub(crate) const CORNERS: usize = LANES;

/// The needs of things that are in a block together.
#[derive(Clone, Copy)]
pub(crate) struct BlockNeeds {
    object: u32,
    things: usize,
    corner_count: usize,
    /// Corners that are not there have a number that no corner has.
    corners: [u32; CORNERS],
}

impl BlockNeeds {
    /// The needs of a triangle with corners of an object.
    pub(crate) fn triangle(object: u32, corners: [u32; 3]) -> Self {
        let mut needs = Self { object, things: 1, corner_count: 0, corners: [u32::MAX; CORNERS] };
        corners.into_iter().for_each(|corner| needs.add(corner));
        needs
    }

    /// The needs of both, if a block with so many lanes has room for them.
    pub(super) fn with(mut self, other: &Self, lanes: usize) -> Option<Self> {
        self.things += other.things;
        if self.object != other.object || self.things > lanes {
            return None;
        }
        other.corners[..other.corner_count].iter().for_each(|&corner| self.add(corner));
        (self.corner_count <= CORNERS).then_some(self)
    }

    /// Adds a corner that is not yet there; beyond the room it is only counted.
    #[inline(always)]
    fn add(&mut self, corner: u32) {
        // Without branches, and with all places at once: which are taken is hard to foresee.
        let is_known = self.corners.iter().fold(false, |is_known, &other| is_known | (other == corner));
        let place = &mut self.corners[self.corner_count.min(CORNERS - 1)];
        *place = if is_known { *place } else { corner };
        self.corner_count += usize::from(!is_known);
    }
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
        // The box test rounds: a little room keeps it from culling triangles that the triangle test would hit.
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
