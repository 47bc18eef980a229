//! The cone that a spot shines into.

use glam::Vec3;

use crate::words::words;

/// A cone whose light falls, between two angles from its axis, by the smooth step 3x² − 2x³ in the cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotCone {
    /// Unit axis.
    pub axis: Vec3,
    /// Cosine of the angle up to which the light is even.
    pub cos_inner: f32,
    /// Cosine of the angle from which on there is none; below −1 where it shines to all sides.
    pub cos_outer: f32,
}

words!(SpotCone { axis, cos_inner, cos_outer });

impl SpotCone {
    /// By half-angles \[degrees\]; none if it holds no direction.
    pub fn new(axis: Vec3, inner_angle: f32, outer_angle: f32) -> Option<Self> {
        let axis = axis.try_normalize()?;
        let cos = |degrees: f32| libm::cos(f64::from(degrees).to_radians()) as f32;
        let is_everywhere = outer_angle >= 180.0;
        // A point light is bright all around, whatever its inner angle.
        let (cos_inner, cos_outer) =
            if is_everywhere { (-1.0, -2.0) } else { (cos(inner_angle), cos(outer_angle)) };
        (outer_angle > 0.0).then_some(Self { axis, cos_inner, cos_outer })
    }

    /// Share of the light on the axis at the cosine of an angle from it.
    #[inline]
    pub fn falloff(&self, cos: f32) -> f32 {
        if cos >= self.cos_inner {
            return 1.0;
        }
        // Between equal angles there is no falloff
        let width = self.cos_inner - self.cos_outer;
        if cos <= self.cos_outer || width <= 0.0 {
            return 0.0;
        }
        let x = ((cos - self.cos_outer) / width).clamp(0.0, 1.0);
        // A NaN fails the comparison
        if x > 0.0 { x * x * (3.0 - 2.0 * x) } else { 0.0 }
    }

    /// Solid angle over 2π, at most 2.
    #[inline]
    pub fn one_minus_cos(&self) -> f32 {
        1.0 - self.cos_outer.max(-1.0)
    }
}
