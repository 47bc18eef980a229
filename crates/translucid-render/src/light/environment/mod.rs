//! Light from infinity in all directions: one color, or a latitude–longitude image.

mod cells;
mod map;
mod openings;

use std::f32::consts::PI;

use glam::Vec3;
use translucid_law::{Receiver, cosine_hemisphere, luminance, uniform_sphere};
use translucid_scene::Scene;

use crate::ray::Geometry;
pub(crate) use map::EnvironmentMap;
use openings::Openings;

/// See [`translucid_scene::Environment`].
#[derive(Clone, Debug)]
pub(crate) struct Environment {
    pub(crate) sky: Sky,
    openings: Option<Openings>,
}

/// Radiance by direction.
#[derive(Clone, Debug)]
pub(crate) enum Sky {
    /// Equal radiance from everywhere.
    Constant(Vec3),
    /// An image.
    Map(Box<EnvironmentMap>),
}

impl Environment {
    /// None if there is no environment or it is black.
    pub(crate) fn new(scene: &Scene) -> Option<Self> {
        Sky::new(scene).map(|sky| Self { sky, openings: None })
    }

    /// Looks for openings through which it shines into rooms.
    pub(crate) fn look_for_openings(&mut self, geometry: &Geometry) {
        let sky = &self.sky;
        self.openings = Openings::new(geometry, |direction| luminance(sky.radiance(direction)));
    }

    /// Takes the openings of the same sky in the same geometry.
    pub(crate) fn keep_openings(&mut self, old: &mut Self) {
        self.openings = old.openings.take();
    }

    /// Radiance from a direction.
    pub(crate) fn radiance(&self, direction: Vec3) -> Vec3 {
        self.sky.radiance(direction)
    }

    /// The irradiance; 0 only if all of the hemisphere is black.
    pub(crate) fn importance(&self, receiver: &Receiver) -> f32 {
        self.sky.importance(receiver)
    }

    /// Draws a direction.
    pub(crate) fn sample(&self, receiver: &Receiver, v: [f32; 2]) -> Vec3 {
        let Some(openings) = &self.openings else { return self.sky.sample(receiver, v) };
        openings.sample(receiver.point, v).unwrap_or_else(|rest| self.sky.sample(receiver, rest))
    }

    /// Solid-angle density of `sample`.
    pub(crate) fn pdf(&self, receiver: &Receiver, direction: Vec3) -> f32 {
        let open = self.sky.pdf(receiver, direction);
        self.openings.as_ref().map_or(open, |openings| openings.pdf(receiver.point, direction, open))
    }
}

impl Sky {
    /// None if there is no environment or it is black.
    fn new(scene: &Scene) -> Option<Self> {
        let environment = scene.environment.as_ref()?;
        let factor = finite_color(environment.radiance);
        let image = environment.image.and_then(|index| scene.images.get(index));
        match image {
            Some(image) => EnvironmentMap::new(image, factor, environment.world_from_environment)
                .map(|map| Self::Map(Box::new(map))),
            None => (luminance(factor) > 0.0).then_some(Self::Constant(factor)),
        }
    }

    /// Radiance from a direction.
    fn radiance(&self, direction: Vec3) -> Vec3 {
        match self {
            Self::Constant(radiance) => *radiance,
            Self::Map(map) => map.radiance(direction),
        }
    }

    /// The irradiance; 0 only if all of the hemisphere is black.
    fn importance(&self, receiver: &Receiver) -> f32 {
        match self {
            Self::Constant(radiance) => PI * luminance(*radiance),
            Self::Map(map) => map.irradiance(receiver),
        }
    }

    /// Draws a direction.
    ///
    /// One color is drawn with the cosine if there is a normal: that leaves no noise on a matte surface.
    fn sample(&self, receiver: &Receiver, v: [f32; 2]) -> Vec3 {
        match self {
            Self::Constant(_) if receiver.has_normal() => cosine_hemisphere(receiver.normal, v),
            Self::Constant(_) => uniform_sphere(v),
            Self::Map(map) => map.sample(receiver, v),
        }
    }

    /// Solid-angle density of `sample`.
    fn pdf(&self, receiver: &Receiver, direction: Vec3) -> f32 {
        match self {
            Self::Constant(_) if receiver.has_normal() => receiver.cosine(direction) / PI,
            Self::Constant(_) => 1.0 / (4.0 * PI),
            Self::Map(map) => map.pdf(receiver, direction),
        }
    }
}

/// The color with channels that are negative or not finite set to 0.
fn finite_color(color: Vec3) -> Vec3 {
    Vec3::from_array(color.to_array().map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 }))
}
