//! A node of the tree: eight boxes, tested together.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::ray::Ray;

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
    /// Line at which a node starts, or `LEAF` and the line at which a block starts.
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
    inverse: Vec3,
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
        Self {
            origin: ray.origin,
            inverse: Vec3::new(inverse(d.x), inverse(d.y), inverse(d.z)),
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
    pub(super) fn meet(&self, node: &Node, t_max: f32) -> Met {
        let max = |a: f32, b: f32| if a > b { a } else { b };
        let min = |a: f32, b: f32| if a < b { a } else { b };
        let mut met = Met { mask: 0, near: [0.0; WIDTH] };
        for lane in 0..WIDTH {
            let distance = |plane: usize, axis: usize| {
                (node.bounds[plane][lane] - self.origin[axis]) * self.inverse[axis]
            };
            let [ax, ay, az] = [0, 1, 2].map(|axis| distance(self.near[axis], axis));
            let [bx, by, bz] = [0, 1, 2].map(|axis| distance(self.far()[axis], axis));
            let near = max(max(ax, ay), max(az, 0.0));
            let far = min(min(min(bx, by), bz) * WIDEN, t_max);
            met.near[lane] = near;
            met.mask |= u32::from(near <= far) << lane;
        }
        met
    }

    /// Tests eight boxes with one instruction for each step.
    ///
    /// It has no `target_feature` of its own, with which it could not be told to always become part of its caller: calls
    /// cost a fifth of all rays per second.
    ///
    /// # Safety
    /// The processor must have AVX2.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) unsafe fn meet_avx2(&self, node: &Node, t_max: f32) -> Met {
        use std::arch::x86_64::{
            __m256, _CMP_LE_OQ, _mm256_cmp_ps, _mm256_max_ps as max, _mm256_min_ps as min,
            _mm256_movemask_ps, _mm256_mul_ps, _mm256_set1_ps, _mm256_setzero_ps, _mm256_sub_ps,
        };
        let plane = |plane: usize| -> __m256 { bytemuck::cast(node.bounds[plane]) };
        // SAFETY: AVX2 is there by this function's own condition; the instructions touch no memory.
        unsafe {
            let [x, y, z] = self.origin.to_array().map(|x| _mm256_set1_ps(x));
            let [inverse_x, inverse_y, inverse_z] = self.inverse.to_array().map(|x| _mm256_set1_ps(x));
            let ax = _mm256_mul_ps(_mm256_sub_ps(plane(self.near[0]), x), inverse_x);
            let ay = _mm256_mul_ps(_mm256_sub_ps(plane(self.near[1]), y), inverse_y);
            let az = _mm256_mul_ps(_mm256_sub_ps(plane(self.near[2]), z), inverse_z);
            let far = self.far();
            let bx = _mm256_mul_ps(_mm256_sub_ps(plane(far[0]), x), inverse_x);
            let by = _mm256_mul_ps(_mm256_sub_ps(plane(far[1]), y), inverse_y);
            let bz = _mm256_mul_ps(_mm256_sub_ps(plane(far[2]), z), inverse_z);
            let near = max(max(ax, ay), max(az, _mm256_setzero_ps()));
            let far = _mm256_mul_ps(min(min(bx, by), bz), _mm256_set1_ps(WIDEN));
            let far = min(far, _mm256_set1_ps(t_max));
            let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far));
            Met { mask: mask as u32, near: bytemuck::cast(near) }
        }
    }
}

/// Widens the far distance: three roundings of a relative 2⁻²⁴ each on either side
/// [Ize 2013, "Robust BVH Ray Traversal"].
const WIDEN: f32 = 1.0 + 4.0 * f32::EPSILON;
