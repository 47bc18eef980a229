//! Point light with a cone.

use std::f32::consts::PI;

use glam::Vec3;

use super::LightSample;
use super::bounds::LightBounds;
use super::receiver::{Receiver, luminance};

/// See [`translucid_scene::Light::Spot`].
///
/// Between the two angles the intensity falls by the smooth step 3x² − 2x³ in the cosine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    position: Vec3,
    direction: Vec3,
    intensity: Vec3,
    luminance: f32,
    cos_inner: f32,
    cos_outer: f32,
}

impl Spot {
    /// None if it sheds no light.
    pub(crate) fn new(
        position: Vec3,
        direction: Vec3,
        intensity: Vec3,
        inner_angle: f32,
        outer_angle: f32,
    ) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let cos = |degrees: f32| f64::from(degrees).to_radians().cos() as f32;
        let is_point = outer_angle >= 180.0;
        // A point light is bright all around, whatever its inner angle.
        let (cos_inner, cos_outer) =
            if is_point { (-1.0, -2.0) } else { (cos(inner_angle), cos(outer_angle)) };
        let valid = luminance(intensity) > 0.0 && outer_angle > 0.0;
        let luminance = luminance(intensity);
        valid.then_some(Self { position, direction, intensity, luminance, cos_inner, cos_outer })
    }

    pub(crate) fn position(&self) -> Vec3 {
        self.position
    }

    /// Intensity in a unit direction.
    pub(crate) fn intensity_toward(&self, direction: Vec3) -> Vec3 {
        self.intensity * self.falloff(direction.dot(self.direction))
    }

    /// Emitted power (luminance), not less than the true one.
    pub(crate) fn power(&self) -> f32 {
        2.0 * PI * (1.0 - self.cos_outer.max(-1.0)) * luminance(self.intensity)
    }

    pub(crate) fn bounds(&self) -> LightBounds {
        let (place, strength) = (self.position, luminance(self.intensity));
        if self.cos_outer <= -1.0 {
            return LightBounds::everywhere(place, place, strength);
        }
        let theta_o = self.cos_inner.acos();
        let theta_e = (self.cos_outer.acos() - theta_o).max(0.0);
        LightBounds::cone(place, self.direction, theta_o, theta_e, strength)
    }

    /// The irradiance; 0 only outside the cone and below the horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let offset = self.position - receiver.point;
        let per_distance = 1.0 / offset.length();
        let falloff = self.falloff(-offset.dot(self.direction) * per_distance);
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
        let falloff = self.falloff(-direction.dot(self.direction));
        let irradiance = self.intensity * falloff / distance / distance;
        (falloff > 0.0).then(|| LightSample::delta(direction, distance, irradiance))
    }

    fn falloff(&self, cos: f32) -> f32 {
        if cos >= self.cos_inner {
            return 1.0;
        }
        let x = ((cos - self.cos_outer) / (self.cos_inner - self.cos_outer)).clamp(0.0, 1.0);
        // The quotient of two zeros: no falloff between equal angles.
        if x.is_nan() { 0.0 } else { x * x * (3.0 - 2.0 * x) }
    }
}
