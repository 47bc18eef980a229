//! The point where a ray meets a surface.

use super::triangle::TriangleHit;

/// A point where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    /// Distance along the ray \[L\].
    pub t: f32,
    /// Barycentric coordinates of the triangle's vertices 1 and 2.
    pub barycentric: [f32; 2],
    /// The triangle's number in its tree.
    pub(super) leaf: u32,
    /// Place of its object in the tree over places, if the object shares its mesh with others.
    pub(super) instance: u32,
}

impl Hit {
    /// A hit with an object that does not share its mesh.
    #[inline]
    pub(super) fn alone((hit, leaf): (TriangleHit, u32)) -> Self {
        Self { t: hit.t, barycentric: [hit.b1, hit.b2], leaf, instance: u32::MAX }
    }
}

/// Distance \[L\] that clears rounding errors of points with such a largest coordinate.
pub(crate) fn offset_at(largest: f32) -> f32 {
    largest * 16.0 * f32::EPSILON
}
