//! A node of the tree: eight boxes, tested together.

use bytemuck::{Pod, Zeroable};
use glam::Vec4;

use crate::ray::Ray;
use crate::ray::simd::{F32x8, SimdToken};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Marks a child that is a block.
pub(super) const LEAF: u32 = 1 << 31;

/// Marks a child that is not there.
pub(super) const EMPTY: u32 = u32::MAX;

/// Eight boxes with their children. An empty child's box is inside out, so no ray meets it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct WideNode {
    /// Lower x, upper x, lower y, upper y, lower z, upper z.
    pub(super) bounds: [[f32; WIDTH]; 6],
    /// By how many words a child starts after this node, with `LEAF` if it is a block.
    pub(super) children: [u32; WIDTH],
    /// Fills the last cache line.
    pub(super) unused: [u32; WIDTH],
}

impl WideNode {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [EMPTY; WIDTH],
        unused: [0; WIDTH],
    };
}

/// The boxes that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BoxHits {
    /// A bit for each.
    pub(super) mask: u32,
    /// Distances at which the ray enters them, 0 from inside.
    pub(super) near: [f32; WIDTH],
}

/// A ray as the box test wants it.
#[derive(Clone, Copy)]
pub(super) struct SlabRay {
    origin: Vec4,
    /// One over the direction, for distances at which the ray enters, and widened for those at which it leaves.
    inverse: Vec4,
    widened: Vec4,
    /// Index of each axis' near planes among a node's bounds.
    near: [usize; 3],
}

impl SlabRay {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        let down = ray.down() as usize;
        Self {
            origin: ray.start(),
            inverse: ray.inverse(),
            widened: ray.inverse() * WIDEN,
            near: [down & 1, 2 + (down >> 1 & 1), 4 + (down >> 2 & 1)],
        }
    }

    /// Tests the ray against eight boxes.
    #[inline(always)]
    pub(super) fn meet<V: SimdToken>(&self, vectors: V, node: &WideNode, t_max: f32) -> BoxHits {
        // Without closures: the compiler would not make vector instructions part of them.
        let (ox, ix) = (vectors.splat(self.origin.x), vectors.splat(self.inverse.x));
        let (oy, iy) = (vectors.splat(self.origin.y), vectors.splat(self.inverse.y));
        let (oz, iz) = (vectors.splat(self.origin.z), vectors.splat(self.inverse.z));
        let [x, y, z] = self.near;
        let ax = (vectors.load(&node.bounds[x]) - ox) * ix;
        let ay = (vectors.load(&node.bounds[y]) - oy) * iy;
        let az = (vectors.load(&node.bounds[z]) - oz) * iz;
        let (wx, wy) = (vectors.splat(self.widened.x), vectors.splat(self.widened.y));
        let wz = vectors.splat(self.widened.z);
        let bx = (vectors.load(&node.bounds[x ^ 1]) - ox) * wx;
        let by = (vectors.load(&node.bounds[y ^ 1]) - oy) * wy;
        let bz = (vectors.load(&node.bounds[z ^ 1]) - oz) * wz;
        // Negative distances, which bits put into the wrong order, lie behind the ray all the same.
        let near = ax.greater_bits(ay).greater_bits(az.greater_bits(vectors.splat(0.0)));
        let far = bx.lesser_bits(by).lesser_bits(bz.lesser_bits(vectors.splat(t_max)));
        BoxHits { mask: near.is_below_bits(far), near: near.to_array() }
    }
}

/// Widens the far distance: three roundings of a relative 2⁻²⁴ each on either side, and one of the product with this
/// [Ize 2013, "Robust BVH Ray Traversal"].
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;
