//! Light from a direction, or from a disc of the sky.

use std::f32::consts::PI;

use glam::Vec3;

use super::LightSample;
use super::directions::{uniform_cone, uniform_cone_pdf};
use super::receiver::{Receiver, luminance};
use super::sphere::one_minus_cos;

/// Discs of a smaller angular radius [degrees] are sampled as one direction: single-precision directions
/// lie 3e-6 degrees apart, and a disc needs many of them.
const LEAST_ANGULAR_RADIUS: f32 = 0.01;

/// See [`translucid_scene::Light::Distant`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distant {
    pub(crate) direction: Vec3,
    pub(crate) irradiance: Vec3,
    pub(crate) disc: Option<SkyDisc>,
}

/// The part of the sky that a distant light fills.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SkyDisc {
    pub(crate) sin2: f32,
    pub(crate) one_minus_cos: f32,
}

impl Distant {
    /// None if it sheds no light.
    pub(crate) fn new(direction: Vec3, angular_radius: f32, irradiance: Vec3) -> Option<Self> {
        let direction = direction.try_normalize()?;
        let disc = (angular_radius >= LEAST_ANGULAR_RADIUS).then(|| {
            let sin = libm::sin(f64::from(angular_radius.min(90.0)).to_radians()) as f32;
            SkyDisc { sin2: sin * sin, one_minus_cos: one_minus_cos(sin * sin) }
        });
        (luminance(irradiance) > 0.0).then_some(Self { direction, irradiance, disc })
    }

    /// Returns `true` if it fills a solid angle.
    pub(crate) fn is_disc(&self) -> bool {
        self.disc.is_some()
    }

    /// Irradiance (luminance) on a surface that faces the light.
    pub(crate) fn greatest_irradiance(&self) -> f32 {
        luminance(self.irradiance)
    }

    /// Estimate of the irradiance; 0 only below the horizon.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        let sin = self.disc.map_or(0.0, |disc| disc.sin2.sqrt());
        luminance(self.irradiance) * receiver.cosine_to_cone(self.direction, sin)
    }

    /// The one direction that the light comes from, if it is no disc.
    pub(crate) fn sample_direction(&self) -> LightSample {
        LightSample::delta(self.direction, f32::INFINITY, self.irradiance)
    }

    /// Draws a direction of the disc, if it is one.
    pub(crate) fn sample_disc(&self, v: [f32; 2]) -> Option<Vec3> {
        self.disc.map(|disc| uniform_cone(self.direction, disc.one_minus_cos, v))
    }

    /// Radiance from a direction: E/(π sin² α) within the disc.
    pub(crate) fn radiance(&self, direction: Vec3) -> Vec3 {
        match self.disc {
            Some(disc) if self.covers(&disc, direction) => self.irradiance / (PI * disc.sin2),
            _ => Vec3::ZERO,
        }
    }

    /// Solid-angle density of `sample_disc`.
    pub(crate) fn pdf(&self, direction: Vec3) -> f32 {
        match self.disc {
            Some(disc) if self.covers(&disc, direction) => uniform_cone_pdf(disc.one_minus_cos),
            _ => 0.0,
        }
    }

    /// Tests the chord, whose square is 2(1 − cos θ): a cosine is not exact enough for the rim of the sun.
    fn covers(&self, disc: &SkyDisc, direction: Vec3) -> bool {
        (direction - self.direction).length_squared() <= 2.0 * disc.one_minus_cos
    }
}
