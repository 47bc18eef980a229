//! Flights of a walk through a body with [shells](crate::surface::Shells) of other media.
//!
//! A flight is drawn by the greatest extinction coefficient σ̂ of each channel, as [`Flights`] draws it. At its end the walk
//! collides with the medium there with the probability Σ T_c σ_c/σ̂_c / Σ T_c, else it flies on, and with both its throughput is
//! that of the balance heuristic over all channels: T_c is multiplied with the channel's own probability over that of all
//! [Kutz et al. 2017, "Spectral and Decomposition Tracking for Rendering Heterogeneous Volumes"].

use glam::Vec3;
use translucid_law::HenyeyGreenstein;

use super::among_shells::AmongShells;
use super::flight::Flights;
use super::random::WalkRandom;
use super::state::Walk;
use crate::ray::{FlightEnd, Hit};

impl Walk<'_> {
    /// Goes to the next collision, or to the body's end that comes before it, first by the number `u`.
    pub(super) fn advance(&mut self, mut u: f32, random: &mut WalkRandom) -> Option<Hit> {
        let Some(AmongShells { shells, place, start }) = &mut self.shells else { return self.fly(u) };
        *start = self.at.position;
        let mut skipped = std::mem::take(&mut self.skipped);
        self.events += 1;
        loop {
            let flight = shells.flight(*place);
            let flights = Flights::new(flight.sigma_t);
            let length = flights.sample(self.throughput, u);
            let reached = length.min(flight.limit);
            let (before, way) = (self.at.position, (reached - skipped).max(0.0));
            match self.body.fly(self.at, self.direction, way) {
                FlightEnd::Boundary { distance, hit } => {
                    self.throughput = flights.pass(self.throughput, distance + skipped);
                    *place = shells.at_surface();
                    return Some(hit);
                }
                FlightEnd::Inside(at) => self.at = at,
            }
            skipped = (skipped - reached).max(0.0);
            *place = shells.place(&self.body, self.at.position);
            if length > flight.limit {
                self.throughput = flights.pass(self.throughput, flight.limit);
            } else {
                self.throughput = flights.collide(self.throughput, length);
                let (medium, part) = match flight.medium {
                    Some(medium) => (medium, Vec3::ONE),
                    None => shells.medium_and_part(*place),
                };
                let share = self.throughput.dot(part) / self.throughput.element_sum();
                if flight.medium.is_some() || random.next_1d() < share {
                    self.throughput *= medium.alpha * part / share;
                    self.phase = HenyeyGreenstein::new(medium.g);
                    self.has_scattered = true;
                    return None;
                }
                self.throughput *= (1.0 - part) / (1.0 - share);
            }
            // A NaN, too, is the end, and a step that rounding has swallowed, which would be taken for ever
            let is_lit = self.throughput.element_sum() > 0.0;
            let is_stuck = length > flight.limit && way > 0.0 && self.at.position == before;
            if !is_lit || is_stuck || self.body.is_lost(&self.at) {
                self.throughput = Vec3::ZERO;
                return None;
            }
            u = random.next_1d();
        }
    }

    /// Point at which the direction was drawn that the walk has come to a surface in.
    pub(super) fn start_of_flight(&self) -> Vec3 {
        self.shells.as_ref().map_or(self.at.position, |among| among.start)
    }

    /// Throughput at the end of a way from a collision, for that of a way through the least dense medium.
    pub(super) fn past_shells(
        &self,
        throughput: Vec3,
        (direction, distance): (Vec3, f32),
        random: &mut WalkRandom,
    ) -> Vec3 {
        let Some(AmongShells { shells, .. }) = &self.shells else { return throughput };
        let way = (self.at.position, direction, distance);
        throughput * shells.transmittance_beyond_least(&self.body, way, || random.next_1d())
    }
}
