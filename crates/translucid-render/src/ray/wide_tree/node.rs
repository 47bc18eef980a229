//! A node of the tree: eight boxes, tested together.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::ray::Ray;
use crate::ray::eight::{Eight, Vectors};

/// Children of a node.
pub(super) const WIDTH: usize = 8;

/// Marks a child that is a block.
pub(super) const LEAF: u32 = 1 << 31;

/// Marks a child that is not there.
pub(super) const EMPTY: u32 = u32::MAX;

/// Eight boxes with what is in them. An empty child's box is inside out, so no ray meets it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct Node {
    /// Lower x, y, z, then upper x, y, z.
    pub(super) bounds: [[f32; WIDTH]; 6],
    /// By how many lines a child starts after this node, with `LEAF` if it is a block.
    pub(super) children: [u32; WIDTH],
    /// Fills the last cache line.
    pub(super) unused: [u32; WIDTH],
}

impl Node {
    /// A node without children.
    pub(super) const EMPTY: Self = Self {
        bounds: [
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
            [f32::NEG_INFINITY; WIDTH],
        ],
        children: [EMPTY; WIDTH],
        unused: [0; WIDTH],
    };
}

/// The boxes that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Met {
    /// A bit for each.
    pub(super) mask: u32,
    /// Distances at which the ray enters them, 0 from inside.
    pub(super) near: [f32; WIDTH],
}

/// A ray as the box test wants it.
#[derive(Clone, Copy)]
pub(super) struct SlabRay {
    origin: Vec3,
    /// One over the direction, for distances at which the ray enters, and widened for those at which it leaves.
    inverse: Vec3,
    widened: Vec3,
    /// Indices of each axis' near planes among a node's bounds.
    near: [usize; 3],
}

impl SlabRay {
    #[inline(always)]
    pub(super) fn new(ray: &Ray) -> Self {
        // A finite stand-in for 1/0 keeps 0·∞ out of the test.
        let inverse = |d: f32| if d.abs() < 1e-18 { 1e18_f32.copysign(d) } else { 1.0 / d };
        let near = |d: f32, axis: usize| if d.is_sign_negative() { axis + 3 } else { axis };
        let d = ray.direction;
        let inverse = Vec3::new(inverse(d.x), inverse(d.y), inverse(d.z));
        Self {
            origin: ray.origin,
            inverse,
            widened: inverse * WIDEN,
            near: [near(d.x, 0), near(d.y, 1), near(d.z, 2)],
        }
    }

    /// Indices of each axis' far planes.
    #[inline(always)]
    fn far(&self) -> [usize; 3] {
        [3 - self.near[0], 5 - self.near[1], 7 - self.near[2]]
    }

    /// Tests the ray against eight boxes.
    #[inline(always)]
    pub(super) fn meet<V: Vectors>(&self, vectors: V, node: &Node, t_max: f32) -> Met {
        // Without closures: the compiler would not make vector instructions part of them.
        let (ox, ix) = (vectors.splat(self.origin.x), vectors.splat(self.inverse.x));
        let (oy, iy) = (vectors.splat(self.origin.y), vectors.splat(self.inverse.y));
        let (oz, iz) = (vectors.splat(self.origin.z), vectors.splat(self.inverse.z));
        let [x, y, z] = self.near;
        let ax = (vectors.load(&node.bounds[x]) - ox) * ix;
        let ay = (vectors.load(&node.bounds[y]) - oy) * iy;
        let az = (vectors.load(&node.bounds[z]) - oz) * iz;
        let [x, y, z] = self.far();
        let (wx, wy) = (vectors.splat(self.widened.x), vectors.splat(self.widened.y));
        let wz = vectors.splat(self.widened.z);
        let bx = (vectors.load(&node.bounds[x]) - ox) * wx;
        let by = (vectors.load(&node.bounds[y]) - oy) * wy;
        let bz = (vectors.load(&node.bounds[z]) - oz) * wz;
        let near = ax.greater(ay).greater(az.greater(vectors.splat(0.0)));
        let far = bx.lesser(by).lesser(bz.lesser(vectors.splat(t_max)));
        Met { mask: near.is_at_most(far), near: near.to_array() }
    }
}

/// Widens the far distance: three roundings of a relative 2⁻²⁴ each on either side, and one of the product with this
/// [Ize 2013, "Robust BVH Ray Traversal"].
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;
