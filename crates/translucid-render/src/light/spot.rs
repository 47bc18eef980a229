//! Point light with a cone.

use std::f32::consts::PI;

use glam::Vec3;

use super::LightSample;
use super::bounds::LightBounds;
use super::cone::SpotCone;
use super::receiver::{Receiver, luminance};

/// See [`translucid_scene::Light::Spot`], of radius 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    position: Vec3,
    pub(crate) intensity: Vec3,
    luminance: f32,
    pub(crate) cone: SpotCone,
}

impl Spot {
    /// None if it sheds no light.
    pub(crate) fn new(position: Vec3, intensity: Vec3, cone: SpotCone) -> Option<Self> {
        let luminance = luminance(intensity);
        (luminance > 0.0).then_some(Self { position, intensity, luminance, cone })
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.position
    }

    /// Intensity in a unit direction.
    pub(crate) fn intensity_toward(&self, direction: Vec3) -> Vec3 {
        self.intensity * self.cone.falloff(direction.dot(self.cone.axis))
    }

    /// Emitted power (luminance), not less than the true one.
    pub(crate) fn power(&self) -> f32 {
        2.0 * PI * self.cone.one_minus_cos() * self.luminance
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        LightBounds::cone(self.position, self.position, &self.cone, self.luminance)
    }

    /// The irradiance; 0 only outside the cone and below the horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let offset = self.position - receiver.point;
        let per_distance = 1.0 / offset.length();
        let falloff = self.cone.falloff(-offset.dot(self.cone.axis) * per_distance);
        let cosine = if receiver.has_normal() { receiver.normal.dot(offset) * per_distance } else { 1.0 };
        if falloff <= 0.0 || cosine <= 0.0 {
            return 0.0;
        }
        (self.luminance * falloff * per_distance * per_distance * cosine.min(1.0)).max(f32::MIN_POSITIVE)
    }

    /// The one direction that the light comes from.
    pub(crate) fn sample(&self, point: Vec3) -> Option<LightSample> {
        let offset = self.position - point;
        let distance = offset.length();
        let direction = offset.try_normalize()?;
        let falloff = self.cone.falloff(-direction.dot(self.cone.axis));
        let irradiance = self.intensity * falloff / distance / distance;
        (falloff > 0.0).then(|| LightSample::delta(direction, distance, irradiance))
    }
}
