//! Light from a direction, or from a disc of the sky.

use std::f32::consts::PI;

use glam::Vec3;

use crate::directions::{one_minus_cos, uniform_cone, uniform_cone_pdf};
use crate::receiver::{Receiver, luminance};
use crate::words::words;

/// Discs of a smaller angular radius \[degrees\] are sampled as one direction: single-precision directions lie 3e-6 degrees apart,
/// and a disc needs many of them.
const LEAST_ANGULAR_RADIUS: f32 = 0.01;

/// A part of the sky, or one direction, that shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistantLight {
    /// Unit vector toward the light.
    pub direction: Vec3,
    /// Irradiance on a surface that faces it.
    pub irradiance: Vec3,
    /// sin² of the disc's angular radius; 0 of one direction.
    pub sin2: f32,
    /// 1 − cos of it.
    pub one_minus_cos: f32,
}

words!(DistantLight { direction, irradiance, sin2, one_minus_cos });

impl DistantLight {
    /// A disc of an angular radius \[degrees\]; none if it sheds no light.
    pub fn new(direction: Vec3, angular_radius: f32, irradiance: Vec3) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let is_disc = angular_radius >= LEAST_ANGULAR_RADIUS;
        let angle = if is_disc { f64::from(angular_radius.min(90.0)).to_radians() } else { 0.0 };
        let sin = libm::sin(angle) as f32;
        let light = Self { direction, irradiance, sin2: sin * sin, one_minus_cos: one_minus_cos(sin * sin) };
        (luminance(irradiance) > 0.0).then_some(light)
    }

    /// Returns `true` if it fills a solid angle.
    #[inline]
    pub fn is_disc(&self) -> bool {
        self.sin2 > 0.0
    }

    /// Estimate of the irradiance; 0 only below the horizon.
    #[inline]
    pub fn importance(&self, receiver: &Receiver) -> f32 {
        luminance(self.irradiance) * receiver.cosine_to_cone(self.direction, self.sin2.sqrt())
    }

    /// Draws a direction of the disc.
    #[inline]
    pub fn direction_of_disc(&self, v: [f32; 2]) -> Vec3 {
        uniform_cone(self.direction, self.one_minus_cos, v)
    }

    /// Radiance from a direction: E/(π sin² α) within the disc.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if !self.covers(direction) {
            return Vec3::ZERO;
        }
        self.irradiance / (PI * self.sin2)
    }

    /// Solid-angle density of [`direction_of_disc`](Self::direction_of_disc).
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> f32 {
        if !self.covers(direction) {
            return 0.0;
        }
        uniform_cone_pdf(self.one_minus_cos)
    }

    /// Tests the chord, whose square is 2(1 − cos θ): a cosine is not exact enough for the rim of the sun.
    #[inline]
    fn covers(&self, direction: Vec3) -> bool {
        let chord = direction - self.direction;
        self.is_disc() && chord.dot(chord) <= 2.0 * self.one_minus_cos
    }
}
