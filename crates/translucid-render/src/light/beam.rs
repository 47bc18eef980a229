//! Parallel beam of finite radius.

use std::f32::consts::PI;

use glam::Vec3;

use super::LightSample;
use super::receiver::{Receiver, luminance};

/// See [`translucid_scene::Light::Beam`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beam {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) radius: f32,
    pub(crate) irradiance: Vec3,
    power: f32,
}

impl Beam {
    /// None if it has no size or sheds no light.
    pub(crate) fn new(origin: Vec3, direction: Vec3, radius: f32, power: Vec3) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let irradiance = power / (PI * radius) / radius;
        let valid = radius > 0.0 && irradiance.is_finite() && luminance(irradiance) > 0.0;
        valid.then(|| Self { origin, direction, radius, irradiance, power: luminance(power) })
    }

    /// Direction that the light comes from.
    pub(crate) fn toward(&self) -> Vec3 {
        -self.direction
    }

    /// Power (luminance).
    pub(crate) fn power(&self) -> f32 {
        self.power
    }

    /// The irradiance.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        self.sample(receiver.point)
            .map_or(0.0, |light| luminance(light.radiance) * receiver.cosine(light.direction))
    }

    /// The one direction that the light comes from, if the point is within the beam.
    pub(crate) fn sample(&self, point: Vec3) -> Option<LightSample> {
        let offset = point - self.origin;
        let distance = offset.dot(self.direction);
        let across = (offset - self.direction * distance).length();
        let lit = distance > 0.0 && across <= self.radius;
        lit.then(|| LightSample::delta(-self.direction, distance, self.irradiance))
    }
}
