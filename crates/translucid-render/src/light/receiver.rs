//! The point that receives light.

use glam::Vec3;

/// A point and the side from which it takes light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Receiver {
    pub(crate) point: Vec3,
    /// Unit normal of the hemisphere that matters, or zero: all directions matter.
    pub(crate) normal: Vec3,
}

impl Receiver {
    /// Returns `true` if only the hemisphere about the normal matters.
    pub(crate) fn has_normal(&self) -> bool {
        self.normal != Vec3::ZERO
    }

    /// Cosine of a direction to the normal, 0 below the horizon; 1 without a normal.
    pub(crate) fn cosine(&self, direction: Vec3) -> f32 {
        if self.has_normal() { self.normal.dot(direction).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Bound from above, in [0, 1], on the cosine of any direction to the ball of a radius whose center is at
    /// `to_center` from the point; 0 only if the ball is below the horizon.
    pub(crate) fn cosine_to_cone(&self, to_center: Vec3, radius: f32) -> f32 {
        if !self.has_normal() {
            return 1.0;
        }
        let highest = self.normal.dot(to_center) + radius;
        if highest <= 0.0 { 0.0 } else { (highest / to_center.length()).min(1.0) }
    }
}

/// Luminance of a linear Rec. 709 color; 0 only for black.
pub(crate) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
