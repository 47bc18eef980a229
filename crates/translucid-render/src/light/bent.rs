//! Light that comes to a point by a way that a surface bends.
//!
//! A light is drawn as for a straight way. That says which place of it to look at, and with what density; how it shines
//! from there is asked once the way is known. Lights that no ray can meet are found in no other way, and whether they
//! shine toward the bend cannot be told from the point: these are drawn by their power alone.

use glam::Vec3;

use super::distribution::Discrete;
use super::emitters::{Emitters, PlacedLight};
use super::receiver::Receiver;
use super::{LightSample, LightSet};
use crate::ray::Beyond;

/// Share of the draws that goes to lights that no ray can meet, where there are others.
const UNMET_SHARE: f32 = 0.5;

/// Lights that no ray can meet, by their power.
#[derive(Clone, Debug)]
pub(super) struct Unmet {
    lights: Vec<usize>,
    by_power: Discrete,
    /// Whether there are no others.
    is_all: bool,
}

/// A light drawn for a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BentLight {
    light: usize,
    /// Where it comes from.
    pub(crate) beyond: Beyond,
    /// On the straight way.
    sample: LightSample,
    /// Share of such draws.
    share: f32,
}

impl Unmet {
    /// `None` where there are no such lights.
    pub(super) fn new(emitters: &Emitters, cross_section: f32) -> Option<Self> {
        let is_unmet = |&light: &usize| emitters.sources.get(light).is_some_and(PlacedLight::is_unmet);
        let lights: Vec<usize> = (0..emitters.len()).filter(is_unmet).collect();
        let by_power =
            Discrete::new(lights.iter().map(|&light| emitters.power(light, cross_section).into()))?;
        Some(Self { is_all: lights.len() == emitters.len(), lights, by_power })
    }
}

impl BentLight {
    /// Solid-angle density on a straight way, selection included \[1/sr\]; `None` where no path can meet the light.
    pub(crate) fn pdf(&self) -> Option<f32> {
        (!self.sample.is_delta).then_some(self.sample.pdf)
    }
}

impl LightSet {
    /// Draws a light and a place of it by `u` and `v`, all in [0, 1), for a point that its light may reach bent.
    pub(crate) fn sample_bent(&self, point: Vec3, u: f32, v: [f32; 2]) -> Option<BentLight> {
        let share = self.unmet.as_ref().map_or(0.0, |unmet| if unmet.is_all { 1.0 } else { UNMET_SHARE });
        if u < share {
            return self.sample_unmet(point, u / share, share);
        }
        let receiver = Receiver { point, normal: Vec3::ZERO };
        let u = (u - share) / (1.0 - share);
        let (light, probability) = self.selection.choose(&self.emitters, &receiver, u.into())?;
        let sample = self.sample_of(&receiver, (light, probability), v).filter(|sample| !sample.is_delta)?;
        let beyond = if sample.distance.is_finite() {
            Beyond::At(point + sample.direction * sample.distance)
        } else {
            Beyond::Along(sample.direction)
        };
        Some(BentLight { light, beyond, sample, share: 1.0 - share })
    }

    /// Draws a light that no ray can meet.
    fn sample_unmet(&self, point: Vec3, u: f32, share: f32) -> Option<BentLight> {
        let unmet = self.unmet.as_ref()?;
        let choice = unmet.by_power.sample(u.into());
        let light = unmet.lights[choice.index];
        let (beyond, distance) = match &self.emitters.sources[light] {
            PlacedLight::Spot(spot) => (Beyond::At(spot.position()), spot.position().distance(point)),
            PlacedLight::Beam(beam) => (Beyond::Along(beam.toward()), f32::INFINITY),
            PlacedLight::Distant(distant) => {
                (Beyond::Along(distant.sample_direction().direction), f32::INFINITY)
            }
            _ => return None,
        };
        let sample = LightSample::delta(Vec3::ZERO, distance, Vec3::ZERO);
        Some(BentLight { light, beyond, sample, share: share * choice.probability as f32 })
    }

    /// The light toward a place where its way bends, on the way to a point.
    ///
    /// Over the spread of light behind the bend, radiance / pdf is the irradiance on a surface at the point that faces it,
    /// or of what is no delta light that times the density of the place.
    pub(crate) fn toward_bend(&self, bent: &BentLight, point: Vec3, bend: Vec3) -> Option<LightSample> {
        let sample = match bent.beyond {
            Beyond::Along(direction) => match &self.emitters.sources.get(bent.light) {
                Some(PlacedLight::Beam(beam)) => beam.sample(bend)?,
                Some(PlacedLight::Distant(light)) if bent.sample.is_delta => light.sample_direction(),
                _ => LightSample { direction, ..bent.sample },
            },
            Beyond::At(place) => {
                let (direction, distance) = (place - bend).normalize_and_length();
                match self.emitters.sources.get(bent.light) {
                    Some(PlacedLight::Spot(spot)) => {
                        LightSample::delta(direction, distance, spot.intensity_toward(-direction))
                    }
                    _ => {
                        let normal = self.emitters.normal_at(bent.light, place)?;
                        let straight = place - point;
                        // cos θ over cos θ / d² of the straight way: densities are then those of places on the light
                        let cosines = -direction.dot(normal) / -straight.normalize_or_zero().dot(normal);
                        let pdf = bent.sample.pdf / (straight.length_squared() * cosines.max(0.0));
                        LightSample { direction, distance, pdf, ..bent.sample }
                    }
                }
            }
        };
        let sample = LightSample { pdf: sample.pdf * bent.share, ..sample };
        sample.is_usable().then_some(sample)
    }
}
