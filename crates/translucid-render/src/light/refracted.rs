//! Light that reaches a point refracted at a surface.
//!
//! A light is drawn as for a straight path. This gives a place of the light and its density; the radiance from there is
//! evaluated once the refracted path is known. Delta lights are found in no other way, and the point does not determine
//! whether they shine toward the refraction: these are drawn by their power alone.

use glam::Vec3;
use translucid_law::Receiver;

use super::distribution::Discrete;
use super::emitters::{Emitters, PlacedLight};
use super::{LightSample, LightSet};
use crate::ray::LightOrigin;

/// Share of the draws that goes to delta lights, where there are others.
const DELTA_SHARE: f32 = 0.5;

/// Least solid-angle density of light samples \[1/sr\] for which a refracted path is sought.
///
/// Seeking one takes several times as long as walking on, and paths meet lights larger than a few degrees by chance.
const LEAST_DENSITY: f32 = 2.0;

/// Density with which a light is sampled on a refracted path, by its solid-angle density on a straight one.
pub(crate) fn refracted_pdf(pdf: f32) -> f32 {
    if pdf < LEAST_DENSITY { 0.0 } else { pdf }
}

/// Delta lights, which no ray can meet, by their power.
#[derive(Clone, Debug)]
pub(super) struct DeltaLights {
    lights: Vec<usize>,
    by_power: Discrete,
    /// There are no others.
    is_all: bool,
}

/// A light drawn for a point that it may reach refracted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RefractedLight {
    light: usize,
    /// Where it comes from.
    pub(crate) beyond: LightOrigin,
    /// The sample on the straight path.
    sample: LightSample,
    /// Share of such draws.
    share: f32,
}

impl DeltaLights {
    /// `None` where there are no such lights.
    pub(super) fn new(emitters: &Emitters, cross_section: f32) -> Option<Self> {
        let is_delta = |&light: &usize| emitters.sources.get(light).is_some_and(PlacedLight::is_delta);
        let lights: Vec<usize> = (0..emitters.len()).filter(is_delta).collect();
        let by_power =
            Discrete::new(lights.iter().map(|&light| emitters.power(light, cross_section).into()))?;
        Some(Self { is_all: lights.len() == emitters.len(), lights, by_power })
    }
}

impl RefractedLight {
    /// Solid-angle density on a straight path, selection included \[1/sr\]; `None` where no path can meet the light.
    pub(crate) fn pdf(&self) -> Option<f32> {
        (!self.sample.is_delta).then_some(self.sample.pdf)
    }
}

impl LightSet {
    /// Draws a light and a place of it by `u` and `v`, all in [0, 1), for a point that it may reach refracted; `None` if paths
    /// meet the light by chance often enough.
    pub(crate) fn sample_refracted(&self, point: Vec3, u: f32, v: [f32; 2]) -> Option<RefractedLight> {
        let share = self.delta.as_ref().map_or(0.0, |delta| if delta.is_all { 1.0 } else { DELTA_SHARE });
        if u < share {
            return self.sample_delta(point, u / share, share);
        }
        let receiver = Receiver { point, normal: Vec3::ZERO };
        let u = (u - share) / (1.0 - share);
        let (light, probability) = self.selection.choose(&self.emitters, &receiver, u.into())?;
        let sample = self
            .sample_of(&receiver, (light, probability), v)
            .filter(|sample| !sample.is_delta && refracted_pdf(sample.pdf) > 0.0)?;
        let beyond = if sample.distance.is_finite() {
            LightOrigin::At(point + sample.direction * sample.distance)
        } else {
            LightOrigin::Along(sample.direction)
        };
        Some(RefractedLight { light, beyond, sample, share: 1.0 - share })
    }

    /// Draws a delta light.
    fn sample_delta(&self, point: Vec3, u: f32, share: f32) -> Option<RefractedLight> {
        let delta = self.delta.as_ref()?;
        let choice = delta.by_power.sample(u.into());
        let light = delta.lights[choice.index];
        let beyond = self.emitters.sources[light].delta_origin()?;
        let distance = match beyond {
            LightOrigin::At(place) => place.distance(point),
            LightOrigin::Along(_) => f32::INFINITY,
        };
        let sample = LightSample::delta(Vec3::ZERO, distance, Vec3::ZERO);
        Some(RefractedLight { light, beyond, sample, share: share * choice.probability as f32 })
    }

    /// The light as seen from the point `bend` where it is refracted toward a point.
    ///
    /// Over the spread of light behind the refraction, radiance / pdf is the irradiance on a surface at the point that faces
    /// it; for lights that are no delta lights, times the density of the place.
    pub(crate) fn at_refraction(
        &self,
        refracted: &RefractedLight,
        point: Vec3,
        bend: Vec3,
    ) -> Option<LightSample> {
        let sample = match refracted.beyond {
            _ if refracted.sample.is_delta => {
                self.emitters.sources.get(refracted.light)?.delta_sample(bend)?
            }
            LightOrigin::Along(direction) => LightSample { direction, ..refracted.sample },
            LightOrigin::At(place) => {
                let (direction, distance) = (place - bend).normalize_and_length();
                let normal = self.emitters.normal_at(refracted.light, place)?;
                let straight = place - point;
                // cos θ over cos θ / d² of the straight path: densities are then those of places on the light
                let cosines = -direction.dot(normal) / -straight.normalize_or_zero().dot(normal);
                let pdf = refracted.sample.pdf / (straight.length_squared() * cosines.max(0.0));
                let radiance = self.emitters.radiance_toward(refracted.light, -direction);
                let radiance = radiance.unwrap_or(refracted.sample.radiance);
                LightSample { direction, distance, pdf, radiance, ..refracted.sample }
            }
        };
        let sample = LightSample { pdf: sample.pdf * refracted.share, ..sample };
        sample.is_usable().then_some(sample)
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;

    use translucid_scene::{Light, Scene};

    use super::*;
    use crate::light::EmissiveTriangle;

    /// Drawn for one point and seen from a bend on the way to it, each kind of light shines on the bend as its solid angle,
    /// or its intensity, implies.
    #[test]
    fn light_at_a_bend_is_that_of_the_light_as_seen_from_there() {
        let (point, bend) = (Vec3::new(0.1, 0.2, -1.0), Vec3::new(-0.3, 0.1, 0.5));
        let center = Vec3::new(0.2, -0.1, 4.0);
        let (edge_x, edge_y) = (Vec3::new(0.3, 0.0, 0.1), Vec3::new(0.0, -0.2, 0.0));
        let (radiance, visible) = (Vec3::ONE, true);
        let corners = [center, center + edge_x, center + edge_y];
        let [a, b, c] = corners.map(|corner| (corner - bend).normalize());
        // [A. Van Oosterom & J. Strackee 1983]
        let solid_angle = 2.0 * (a.dot(b.cross(c)).abs() / (1.0 + a.dot(b) + b.dot(c) + c.dot(a))).atan();
        let parallelogram = [center - 0.5 * edge_x - 0.5 * edge_y, edge_x, edge_y];
        let of_rectangle = {
            let [corner, x, y] = parallelogram;
            let n = 200_u16;
            let at = |i: u16, j: u16| {
                corner + x * ((f32::from(i) + 0.5) / 200.0) + y * ((f32::from(j) + 0.5) / 200.0)
            };
            let area = x.cross(y) / 40_000.0;
            let seen =
                |place: Vec3| (place - bend).normalize().dot(area).abs() / place.distance_squared(bend);
            (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| seen(at(i, j))).sum::<f32>()
        };
        let sphere =
            |radius: f32| 2.0 * PI * (1.0 - (1.0 - radius * radius / bend.distance_squared(center)).sqrt());
        let near_axis = (bend - center).normalize() * 1e-4;
        let spot = |radius, outer_angle| Light::Spot {
            position: center,
            direction: near_axis,
            radius,
            intensity: Vec3::ONE,
            inner_angle: 1.0,
            outer_angle,
            visible,
        };
        let intensity = bend.distance_squared(center).recip();
        let triangle = vec![EmissiveTriangle { vertices: corners, radiance, primitive: 0 }];
        let cases = [
            ("rectangle", Some(Light::Rectangle { center, edge_x, edge_y, radiance, visible }), of_rectangle),
            ("sphere", Some(Light::Sphere { center, radius: 0.2, radiance, visible }), sphere(0.2)),
            // The point is outside its cone, the bend is not
            ("spot", Some(spot(0.0, 2.0)), intensity),
            (
                "ellipse",
                Some(Light::Ellipse { center, edge_x, edge_y, radiance, visible }),
                0.25 * PI * of_rectangle,
            ),
            ("spot with a radius", Some(spot(0.01, 60.0)), intensity),
            ("triangle", None, solid_angle),
        ];
        for (name, light, expected) in cases {
            let emissive = if light.is_none() { triangle.clone() } else { Vec::new() };
            let scene = Scene { lights: light.into_iter().collect(), environment: None, ..Scene::default() };
            let lights = LightSet::new(&scene, emissive, (Vec3::splat(-2.0), Vec3::splat(2.0)));
            let n = 1 << 14;
            let shine = |i: u32| {
                let u = sobol_burley::sample_4d(i, 0, 3);
                let refracted = lights.sample_refracted(point, u[0], [u[1], u[2]])?;
                let sample = lights.at_refraction(&refracted, point, bend)?;
                Some(sample.radiance.x / (sample.pdf * sample.distance * sample.distance))
            };
            let mean = (0..n).filter_map(shine).sum::<f32>() / n as f32;
            assert!((mean / expected - 1.0).abs() < 5e-3, "{name}: {mean} {expected}");
        }
    }

    #[test]
    fn beams_shine_where_their_way_bends() {
        let beam =
            |radius| Light::Beam { origin: Vec3::Z * 9.0, direction: Vec3::NEG_Z, radius, power: Vec3::ONE };
        let scene = Scene { lights: vec![beam(0.5)], environment: None, ..Scene::default() };
        let lights = LightSet::new(&scene, Vec::new(), (Vec3::splat(-2.0), Vec3::splat(2.0)));
        let refracted =
            lights.sample_refracted(Vec3::X * 1.5, 0.3, [0.5; 2]).expect("drawn by its power alone");
        let bend = |x: f32| lights.at_refraction(&refracted, Vec3::X * 1.5, Vec3::new(x, 0.0, 1.0));
        assert_eq!(refracted.beyond, LightOrigin::Along(Vec3::Z));
        assert!(bend(0.6).is_none());
        let sample = bend(0.4).expect("in the beam");
        assert_eq!((sample.distance, sample.pdf), (8.0, 1.0));
        assert!((sample.radiance.x * PI * 0.25 - 1.0).abs() < 1e-6);
    }
}
