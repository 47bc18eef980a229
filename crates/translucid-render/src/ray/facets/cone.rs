//! Boxes around facets with cones around their normals.

use glam::Vec3;

use super::bounds;
use super::crossing::Facet;

/// A box around facets, and a cone around their normals.
#[derive(Clone, Copy)]
pub(super) struct NormalCone {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
    pub(super) axis: Vec3,
    /// Cosine of the half-angle.
    pub(super) cosine: f32,
}

impl NormalCone {
    /// Around nothing.
    pub(super) const EMPTY: Self =
        Self { low: Vec3::INFINITY, high: Vec3::NEG_INFINITY, axis: Vec3::Z, cosine: 1.0 };

    pub(super) fn around(facets: &[Facet]) -> Self {
        let (low, high) = bounds(facets.iter().flat_map(|facet| facet.vertices));
        let normals = || facets.iter().filter_map(Facet::normal);
        let axis = normals().sum::<Vec3>().normalize_or(Vec3::Z);
        Self { low, high, axis, cosine: normals().map(|normal| normal.dot(axis)).fold(1.0, f32::min) }
    }

    /// Around both.
    pub(super) fn with(&self, other: &Self) -> Self {
        if self.low.x > self.high.x {
            return *other;
        }
        if other.low.x > other.high.x {
            return *self;
        }
        let (low, high) = (self.low.min(other.low), self.high.max(other.high));
        // Around the middle of both axes each cone reaches as far as it is wide, and as its axis is off
        let axis = (self.axis + other.axis).normalize_or(Vec3::Z);
        let cosine = [self, other].map(|cone| cosine_of_sum(cone.cosine, cone.axis.dot(axis)));
        Self { low, high, axis, cosine: cosine[0].min(cosine[1]) }
    }
}

/// Cosine of the sum of two angles in [0°, 180°] by their cosines; −1 from 180° on.
fn cosine_of_sum(a: f32, b: f32) -> f32 {
    if a <= -b {
        return -1.0;
    }
    let sine = |cosine: f32| (1.0 - cosine * cosine).max(0.0).sqrt();
    a * b - sine(a) * sine(b)
}
