//! Light that comes to a collision through a smooth boundary, refracted.
//!
//! No straight line joins a collision to a light there. The boundary consists of flat facets, each of which the light
//! crosses on its way to the collision in one place at most; the body finds [all of them](crate::ray::Body::crossings). One
//! is drawn in proportion to the light that would come through if nothing were in the way, with per channel
//!
//! ```text
//! L = p(ω) e^{−σ_t d} (1 − F) E / (η² s)
//! ```
//!
//! where E / s is the irradiance of the light behind the facet: s is the growth of its spread between the light (or the
//! facet's outside, where it is parallel) and the collision. η² is left out of all radiance inside, and so stands here.

use super::flight::STRETCH;
use super::random::WalkRandom;
use super::state::Walk;
use crate::ray::Crossing;
use crate::subsurface::entry_point::entry_bsdf;
use crate::surface::bsdf::fresnel_dielectric;
use crate::world::{Layer, PathState, ShadowMedium, World, power_heuristic, weighed};

impl Walk<'_> {
    /// Adds light from one sampled light, refracted by the boundary and scattered at a collision.
    pub(super) fn add_refracted_light(
        &self,
        world: &World,
        path: &mut PathState,
        u: [f32; 4],
        random: &mut WalkRandom,
    ) {
        let choice = random.next_1d();
        let Some(light) = world.lights.sample_refracted(self.at.position, u[0], [u[1], u[2]]) else { return };
        let flights = self.flights.stretched(STRETCH);
        let reach = flights.sample(self.throughput, u[3]);
        let mut chosen = ChosenCrossing { crossing: None, total: 0.0, choice };
        let objects = &world.scene.objects;
        self.body.crossings(objects, (self.at, reach), light.beyond, self.eta, |crossing| {
            chosen.offer(crossing, self.let_in(&crossing) / crossing.spread);
        });
        let Some((crossing, share)) =
            chosen.crossing.map(|(crossing, weight)| (crossing, weight / chosen.total))
        else {
            return;
        };
        let Some(hit) = self.body.end_at(self.at, &crossing) else { return };
        let point = world.surface_point(&hit);
        let Some(sample) = world.lights.at_refraction(&light, self.at.position, point.position) else {
            return;
        };
        let phase = self.phase.pdf(self.direction.dot(crossing.direction));
        let mis = light.pdf().map_or(1.0, |pdf| power_heuristic(pdf, phase));
        let geometry = phase * self.let_in(&crossing) / (self.eta * self.eta * crossing.spread * share);
        let soft = !world.scene.integrator.caustics;
        let medium = ShadowMedium { absorption: path.absorption, soft, random: choice };
        let received = weighed(world.unoccluded(&point, &sample, medium), mis * geometry / sample.pdf);
        let throughput = self.flights.pass_stretched(&flights, self.throughput, crossing.distance);
        let throughput = self.past_shells(throughput, (crossing.direction, crossing.distance), random);
        path.add_to(
            path.layer_after(Layer::Subsurface),
            received * entry_bsdf(world, &point).tint() * throughput,
        );
    }

    /// Share of light that the boundary lets in.
    fn let_in(&self, crossing: &Crossing) -> f32 {
        1.0 - fresnel_dielectric(crossing.cosine, self.eta.recip())
    }
}

/// One of the crossings that were offered, drawn in proportion to their weights.
struct ChosenCrossing {
    /// The crossing and its weight.
    crossing: Option<(Crossing, f32)>,
    total: f32,
    /// A random number in [0, 1); each choice leaves a new one.
    choice: f32,
}

impl ChosenCrossing {
    fn offer(&mut self, crossing: Crossing, weight: f32) {
        // A NaN fails the comparison
        if !(weight > 0.0 && weight.is_finite()) {
            return;
        }
        self.total += weight;
        let share = weight / self.total;
        if self.choice < share {
            self.choice /= share;
            self.crossing = Some((crossing, weight));
        } else {
            self.choice = (self.choice - share) / (1.0 - share);
        }
    }
}
