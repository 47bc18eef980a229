//! All lights of a scene, by number: first those that are placed as lights, then the triangles that emit.

use glam::Vec3;
use translucid_law::{BeamLight, DistantLight, Receiver, SphereLight, SpotCone, SpotLight, luminance};
use translucid_scene::{Light, Scene};

use super::LightSample;
use super::bounds::LightBounds;
use super::ellipse::Ellipse;
use super::environment::Environment;
use super::rectangle::Rectangle;
use super::triangle::{EmissiveTriangle, emitting};
use crate::ray::LightOrigin;

/// Any light but a triangle.
#[derive(Clone, Debug)]
pub(crate) enum PlacedLight {
    Rectangle(Rectangle),
    Ellipse(Ellipse),
    Sphere(SphereLight),
    Distant(DistantLight),
    Spot(SpotLight),
    Beam(BeamLight),
    Environment(Environment),
}

impl PlacedLight {
    /// None if the light can shed no light.
    pub(crate) fn new(light: &Light) -> Option<Self> {
        match *light {
            Light::Rectangle { center, edge_x, edge_y, radiance, visible } => {
                Rectangle::new(center, edge_x, edge_y, radiance, visible).map(Self::Rectangle)
            }
            Light::Sphere { center, radius, radiance, visible } => {
                SphereLight::new(center, radius, radiance, visible).map(Self::Sphere)
            }
            Light::Distant { direction, angular_radius, irradiance } => {
                DistantLight::new(direction, angular_radius, irradiance).map(Self::Distant)
            }
            Light::Ellipse { center, edge_x, edge_y, radiance, visible } => {
                Ellipse::new(center, edge_x, edge_y, radiance, visible).map(Self::Ellipse)
            }
            Light::Spot { position, direction, radius, intensity, inner_angle, outer_angle, visible } => {
                let cone = SpotCone::new(direction, inner_angle, outer_angle)?;
                match radius {
                    0.0 => SpotLight::new(position, intensity, cone).map(Self::Spot),
                    _ => SphereLight::of_spot(position, radius, intensity, cone, visible).map(Self::Sphere),
                }
            }
            Light::Beam { origin, direction, radius, power } => {
                BeamLight::new(origin, direction, radius, power).map(Self::Beam)
            }
        }
    }

    /// Returns `true` if light comes from infinity in directions that paths can meet by chance.
    pub(crate) fn is_infinite(&self) -> bool {
        match self {
            Self::Distant(light) => light.is_disc(),
            _ => matches!(self, Self::Environment(_)),
        }
    }

    /// Returns `true` if no ray can meet it.
    pub(crate) fn is_delta(&self) -> bool {
        self.delta_origin().is_some()
    }

    /// Where the light of a delta light comes from, which no ray can meet; none of others.
    pub(crate) fn delta_origin(&self) -> Option<LightOrigin> {
        match self {
            Self::Spot(light) => Some(LightOrigin::At(light.position)),
            Self::Beam(light) => Some(LightOrigin::Along(-light.direction)),
            Self::Distant(light) if !light.is_disc() => Some(LightOrigin::Along(light.direction)),
            Self::Rectangle(_)
            | Self::Ellipse(_)
            | Self::Sphere(_)
            | Self::Distant(_)
            | Self::Environment(_) => None,
        }
    }

    /// A delta light as seen from a point: its intensity if it comes from a place, else the irradiance on a surface that
    /// faces it.
    pub(crate) fn delta_sample(&self, point: Vec3) -> Option<LightSample> {
        match self {
            Self::Spot(light) => {
                let (direction, distance) = (light.position - point).normalize_and_length();
                Some(LightSample::delta(direction, distance, light.intensity_toward(-direction)))
            }
            Self::Beam(light) => LightSample::of_delta(light.draw(point)),
            Self::Distant(light) if !light.is_disc() => Some(LightSample::at_infinity(light)),
            Self::Rectangle(_)
            | Self::Ellipse(_)
            | Self::Sphere(_)
            | Self::Distant(_)
            | Self::Environment(_) => None,
        }
    }

    /// Returns `true` if it is a surface that rays meet.
    pub(crate) fn is_surface(&self) -> bool {
        matches!(self, Self::Rectangle(_) | Self::Ellipse(_) | Self::Sphere(_))
    }

    /// Distance along a ray, from its origin in its direction, to the surface, and the radiance that it sends back along
    /// it; `counts` decides by whether the camera sees the light.
    #[inline]
    pub(crate) fn intersect(
        &self,
        (origin, direction): (Vec3, Vec3),
        counts: impl Fn(bool) -> bool,
    ) -> Option<(f32, Vec3)> {
        match self {
            Self::Rectangle(shape) if counts(shape.visible) => {
                Some((shape.intersect(origin, direction)?, shape.radiance))
            }
            Self::Ellipse(shape) if counts(shape.visible()) => {
                Some((shape.intersect(origin, direction)?, shape.radiance()))
            }
            Self::Sphere(shape) if counts(shape.visible) => {
                let t = shape.distance(origin, direction);
                (t >= 0.0).then(|| (t, shape.radiance_toward(-direction)))
            }
            _ => None,
        }
    }

    /// Solid-angle density with which a light that is a surface is sampled toward a place on it.
    #[inline]
    pub(crate) fn pdf(&self, point: Vec3, place: Vec3) -> f32 {
        match self {
            Self::Rectangle(light) => light.pdf(point, place),
            Self::Ellipse(light) => light.pdf(point, place),
            Self::Sphere(light) => light.pdf(point, place),
            _ => 0.0,
        }
    }

    /// Estimate of the irradiance (luminance) at a point; 0 only if the light cannot contribute.
    #[inline]
    fn importance(&self, receiver: &Receiver) -> f32 {
        match self {
            Self::Rectangle(light) => light.importance(receiver),
            Self::Ellipse(light) => light.importance(receiver),
            Self::Sphere(light) => light.importance(receiver),
            Self::Distant(light) => light.importance(receiver),
            Self::Spot(light) => light.importance(receiver),
            Self::Beam(light) => light.importance(receiver),
            Self::Environment(light) => light.importance(receiver),
        }
    }

    /// See [`Emitters::power`].
    fn power(&self, cross_section: f32) -> f32 {
        match self {
            Self::Rectangle(light) => light.power(),
            Self::Ellipse(light) => light.power(),
            Self::Sphere(light) => light.power(),
            Self::Distant(light) => luminance(light.irradiance) * cross_section,
            Self::Spot(light) => light.power(),
            Self::Beam(light) => light.power,
            Self::Environment(light) => {
                let everywhere = Receiver { point: Vec3::ZERO, normal: Vec3::ZERO };
                4.0 * light.importance(&everywhere) * cross_section
            }
        }
    }

    /// Its bounds; none at infinity.
    pub(crate) fn bounds(&self) -> Option<LightBounds> {
        match self {
            Self::Rectangle(light) => Some(light.bounds()),
            Self::Ellipse(light) => Some(light.bounds()),
            Self::Sphere(light) => {
                let (low, high) = (light.center - light.radius, light.center + light.radius);
                Some(match light.has_cone {
                    false => LightBounds::everywhere(low, high, light.strength()),
                    true => LightBounds::cone(low, high, &light.cone, light.strength()),
                })
            }
            Self::Spot(light) => {
                Some(LightBounds::cone(light.position, light.position, &light.cone, light.luminance))
            }
            Self::Distant(_) | Self::Beam(_) | Self::Environment(_) => None,
        }
    }
}

/// All lights that shine.
#[derive(Clone, Debug)]
pub(crate) struct Emitters {
    pub(crate) sources: Vec<PlacedLight>,
    /// By their primitive's number.
    pub(crate) triangles: Vec<EmissiveTriangle>,
}

impl Emitters {
    pub(crate) fn new(scene: &Scene, triangles: Vec<EmissiveTriangle>) -> Self {
        let mut sources: Vec<PlacedLight> = scene.lights.iter().filter_map(PlacedLight::new).collect();
        sources.extend(Environment::new(scene).map(PlacedLight::Environment));
        Self { sources, triangles: emitting(triangles) }
    }

    pub(crate) fn len(&self) -> usize {
        self.sources.len() + self.triangles.len()
    }

    /// The triangle of a primitive, with its number among the lights.
    pub(crate) fn of_primitive(&self, primitive: u64) -> Option<(usize, &EmissiveTriangle)> {
        let found = self.triangles.binary_search_by_key(&primitive, |triangle| triangle.primitive);
        found.ok().map(|index| (self.sources.len() + index, &self.triangles[index]))
    }

    /// Estimate of the irradiance (luminance) that a light brings; 0 only if it cannot contribute.
    #[inline]
    pub(crate) fn importance(&self, light: usize, receiver: &Receiver) -> f32 {
        match self.sources.get(light) {
            Some(source) => source.importance(receiver),
            None => self.triangles[light - self.sources.len()].importance(receiver),
        }
    }

    /// Power (luminance) that a scene of this cross section \[L²\] receives from a light at most.
    pub(crate) fn power(&self, light: usize, cross_section: f32) -> f32 {
        match self.sources.get(light) {
            Some(source) => source.power(cross_section),
            None => self.triangles[light - self.sources.len()].power(),
        }
    }

    /// Radiance of a light with a surface in a unit direction, if it depends on the direction.
    pub(crate) fn radiance_toward(&self, light: usize, direction: Vec3) -> Option<Vec3> {
        match self.sources.get(light) {
            Some(PlacedLight::Sphere(light)) => Some(light.radiance_toward(direction)),
            _ => None,
        }
    }

    /// Unit normal at a place on the surface of a light.
    pub(crate) fn normal_at(&self, light: usize, place: Vec3) -> Option<Vec3> {
        match self.sources.get(light) {
            Some(PlacedLight::Rectangle(light)) => Some(light.normal()),
            Some(PlacedLight::Ellipse(light)) => Some(light.normal()),
            Some(PlacedLight::Sphere(light)) => (place - light.center).try_normalize(),
            Some(
                PlacedLight::Distant(_)
                | PlacedLight::Spot(_)
                | PlacedLight::Beam(_)
                | PlacedLight::Environment(_),
            ) => None,
            None => self.triangles[light - self.sources.len()].normal(),
        }
    }

    /// Place and emission of a light; `None` for lights at infinity and beams.
    pub(crate) fn bounds(&self, light: usize) -> Option<LightBounds> {
        let bounds = match self.sources.get(light) {
            Some(source) => source.bounds(),
            None => Some(self.triangles[light - self.sources.len()].bounds()),
        };
        bounds.filter(LightBounds::is_finite)
    }

    /// Draws a direction toward a light that is not infinite; the selection is not in its density.
    #[inline]
    pub(crate) fn sample(&self, light: usize, point: Vec3, v: [f32; 2]) -> Option<LightSample> {
        match self.sources.get(light) {
            Some(PlacedLight::Rectangle(light)) => light.sample(point, v),
            Some(PlacedLight::Ellipse(light)) => light.sample(point, v),
            Some(PlacedLight::Sphere(light)) => LightSample::of(light.draw(point, v)),
            Some(PlacedLight::Spot(light)) => LightSample::of_delta(light.draw(point)),
            Some(PlacedLight::Beam(light)) => LightSample::of_delta(light.draw(point)),
            Some(PlacedLight::Distant(light)) if !light.is_disc() => Some(LightSample::at_infinity(light)),
            Some(PlacedLight::Distant(_) | PlacedLight::Environment(_)) => None,
            None => self.triangles[light - self.sources.len()].sample(point, v),
        }
    }
}
