//! Parallel beam of finite radius, which no ray meets.

use std::f32::consts::PI;

use glam::Vec3;

use crate::receiver::{LightDraw, Receiver, luminance};
use crate::words::words;

/// Light that travels in one direction through a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamLight {
    /// Center of the disk.
    pub origin: Vec3,
    /// Direction of travel.
    pub direction: Vec3,
    /// Radius of the disk.
    pub radius: f32,
    /// Irradiance on a surface that faces the beam.
    pub irradiance: Vec3,
    /// Power (luminance).
    pub power: f32,
}

words!(BeamLight { origin, direction, radius, irradiance, power });

impl BeamLight {
    /// A beam of a power; none if it has no size or sheds no light.
    pub fn new(origin: Vec3, direction: Vec3, radius: f32, power: Vec3) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let irradiance = power / (PI * radius) / radius;
        let valid = radius > 0.0 && irradiance.is_finite() && luminance(irradiance) > 0.0;
        valid.then(|| Self { origin, direction, radius, irradiance, power: luminance(power) })
    }

    /// The irradiance.
    #[inline]
    pub fn importance(&self, receiver: &Receiver) -> f32 {
        let light = self.draw(receiver.point);
        luminance(light.radiance) * receiver.cosine(light.direction)
    }

    /// The one direction that the light comes from, if the point is within the beam.
    #[inline]
    pub fn draw(&self, point: Vec3) -> LightDraw {
        let offset = point - self.origin;
        let along = offset.dot(self.direction);
        let across = (offset - self.direction * along).length();
        if along > 0.0 && across <= self.radius {
            return LightDraw {
                direction: -self.direction,
                distance: along,
                radiance: self.irradiance,
                pdf: 1.0,
            };
        }
        LightDraw::none()
    }
}
