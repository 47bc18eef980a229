//! Point light with a cone, which no ray meets.

use std::f32::consts::PI;

use glam::Vec3;

use crate::cone::SpotCone;
use crate::elementary::{is_zero_vector, unit_or};
use crate::receiver::{LightDraw, Receiver, luminance};
use crate::words::words;

/// A point that shines into a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpotLight {
    /// Where it is.
    pub position: Vec3,
    /// Intensity on the axis.
    pub intensity: Vec3,
    /// Luminance of that.
    pub luminance: f32,
    /// The cone.
    pub cone: SpotCone,
}

words!(SpotLight { position, intensity, luminance, cone });

impl SpotLight {
    /// A light of this intensity on the axis; none if it sheds no light.
    pub fn new(position: Vec3, intensity: Vec3, cone: SpotCone) -> Option<Self> {
        let luminance = luminance(intensity);
        (luminance > 0.0).then_some(Self { position, intensity, luminance, cone })
    }

    /// Emitted power (luminance), not less than the true one.
    pub fn power(&self) -> f32 {
        2.0 * PI * self.cone.one_minus_cos() * self.luminance
    }

    /// Intensity in a unit direction.
    #[inline]
    pub fn intensity_toward(&self, direction: Vec3) -> Vec3 {
        self.intensity * self.cone.falloff(direction.dot(self.cone.axis))
    }

    /// The irradiance; 0 only outside the cone and below the horizon.
    #[inline]
    pub fn importance(&self, receiver: &Receiver) -> f32 {
        let offset = self.position - receiver.point;
        if is_zero_vector(offset) {
            return 0.0;
        }
        let per_distance = 1.0 / offset.length();
        let falloff = self.cone.falloff(-offset.dot(self.cone.axis) * per_distance);
        let cosine = if receiver.has_normal() { receiver.normal.dot(offset) * per_distance } else { 1.0 };
        if falloff <= 0.0 || cosine <= 0.0 {
            return 0.0;
        }
        (self.luminance * falloff * per_distance * per_distance * cosine.min(1.0)).max(f32::MIN_POSITIVE)
    }

    /// The one direction that the light comes from.
    #[inline]
    pub fn draw(&self, point: Vec3) -> LightDraw {
        let offset = self.position - point;
        let direction = unit_or(offset, Vec3::ZERO);
        let falloff = self.cone.falloff(-direction.dot(self.cone.axis));
        if is_zero_vector(direction) || falloff <= 0.0 {
            return LightDraw::none();
        }
        let distance = offset.length();
        LightDraw { direction, distance, radiance: self.intensity * falloff / distance / distance, pdf: 1.0 }
    }
}
