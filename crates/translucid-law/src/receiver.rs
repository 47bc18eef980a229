//! The point that receives light, and light that was drawn for it.

use glam::Vec3;

use crate::elementary::is_zero_vector;

/// A point and the side from which it takes light.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Where it is.
    pub point: Vec3,
    /// Unit normal of the hemisphere that matters, or zero: all directions matter.
    pub normal: Vec3,
}

impl Receiver {
    /// Returns `true` if only the hemisphere about the normal matters.
    #[inline]
    pub fn has_normal(&self) -> bool {
        !is_zero_vector(self.normal)
    }

    /// Cosine of a direction to the normal, 0 below the horizon; 1 without a normal.
    #[inline]
    pub fn cosine(&self, direction: Vec3) -> f32 {
        if self.has_normal() { self.normal.dot(direction).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Bound from above, in [0, 1], on the cosine of any direction to the ball of a radius whose center is at
    /// `to_center` from the point; 0 only if the ball is below the horizon.
    #[inline]
    pub fn cosine_to_cone(&self, to_center: Vec3, radius: f32) -> f32 {
        if !self.has_normal() {
            return 1.0;
        }
        let highest = self.normal.dot(to_center) + radius;
        if highest <= 0.0 {
            return 0.0;
        }
        (highest / to_center.length()).min(1.0)
    }
}

/// A direction toward a light that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightDraw {
    /// Unit direction toward the light.
    pub direction: Vec3,
    /// Distance to the light \[L\].
    pub distance: f32,
    /// Radiance from the direction; of a light that no ray meets the irradiance on a surface that faces it.
    pub radiance: Vec3,
    /// Solid-angle density \[1/sr\], of a light that no ray meets 1; 0 where there is no direction.
    pub pdf: f32,
}

impl LightDraw {
    /// No direction.
    #[inline]
    pub fn none() -> Self {
        Self { direction: Vec3::ZERO, distance: 0.0, radiance: Vec3::ZERO, pdf: 0.0 }
    }
}

/// Luminance of a linear Rec. 709 color; 0 only for black.
#[inline]
pub fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
