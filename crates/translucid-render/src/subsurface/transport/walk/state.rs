//! A walk under way: from flight to flight through the volume.

use glam::Vec3;
use translucid_law::HenyeyGreenstein;

use super::among_shells::AmongShells;
use super::common_medium::Media;
use super::flight::Flights;
use super::tilt::Tilt;
use crate::ray::{Body, FlightEnd, Hit, Inside};
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::parameters::Subsurface;
use crate::surface::WalkMedium;
use crate::world::{PathState, World};

/// Share of the light that entered below which walks end at random.
///
/// A greater value makes the means of regions less certain where walks share.
const ROULETTE_BELOW: f32 = 0.25;

/// A walk under way.
#[derive(Clone, Copy)]
pub(super) struct Walk<'a> {
    pub(super) body: Body<'a>,
    /// Side of the surface that the body is on.
    pub(super) side: f32,
    /// Flights to collisions; where there are shells, those through the least dense of all media.
    pub(super) flights: Flights,
    pub(super) shells: Option<AmongShells<'a>>,
    pub(super) phase: HenyeyGreenstein,
    /// Tilt of directions after collisions, where scattering is isotropic.
    pub(super) tilt: Tilt,
    /// Single-scattering albedo per channel.
    pub(super) alpha: Vec3,
    /// The media in which light along the walk is weighed.
    pub(super) media: Media,
    /// Relative index of the boundary, 1 without one.
    pub(super) eta: f32,
    pub(super) at: Inside,
    pub(super) direction: Vec3,
    pub(super) throughput: Vec3,
    /// Collisions and reflections inside.
    pub(super) events: u32,
    /// Number of these after which the walk is given up.
    pub(super) most_events: u32,
    /// There was a collision.
    pub(super) has_scattered: bool,
    /// Solid-angle density of the direction without its tilt, infinite where it was not drawn at a collision.
    pub(super) pdf: f32,
    /// Way from the surface to the point below it where the walk began \[L\], 0 after the first flight.
    pub(super) skipped: f32,
}

impl<'a> Walk<'a> {
    /// Begins in a direction below the surface that the camera sees; `None` if there is no way in.
    pub(super) fn enter(
        world: &'a World,
        path: &PathState,
        exit: &ExitPoint<'_>,
        medium: &'a WalkMedium,
        direction: Vec3,
    ) -> Option<Self> {
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let (point, side) = (exit.point, exit.side);
        let body = Body::below(&world.scene, &world.geometry, point, side);
        let (at, skipped) = body.enter(point, direction)?;
        // Channels of length 0 are a matter of the surface
        let scatters = length.cmpgt(Vec3::ZERO);
        let sigma_t = Vec3::select(scatters, length.recip().min(Vec3::MAX), Vec3::ZERO);
        let throughput = Vec3::select(scatters, path.throughput, Vec3::ZERO);
        let sum = throughput.element_sum();
        let shells = medium.shells(&body, &world.scene.objects, (surface_albedo, length), point.offset);
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            body,
            side,
            flights: Flights::new(shells.map_or(sigma_t, |shells| shells.least())),
            shells: shells.map(|shells| AmongShells::new(shells, at.position)),
            phase: HenyeyGreenstein::new(medium.g),
            tilt: Tilt::NONE,
            alpha: medium.single_scattering_albedo(surface_albedo),
            media: Media::ONE,
            eta: medium.eta,
            at,
            direction,
            throughput,
            events: 0,
            most_events: medium.most_flights,
            has_scattered: false,
            pdf: f32::INFINITY,
            skipped,
        })
    }

    /// Goes to the next collision, or to the body's end that comes before it.
    pub(super) fn fly(&mut self, u: f32) -> Option<Hit> {
        let length = self.flights.sample(self.throughput, u);
        let skipped = std::mem::take(&mut self.skipped);
        self.events += 1;
        match self.body.fly(self.at, self.direction, (length - skipped).max(0.0)) {
            FlightEnd::Boundary { distance, hit } => {
                self.throughput = self.flights.pass(self.throughput, distance + skipped);
                self.media.pass(distance + skipped);
                Some(hit)
            }
            FlightEnd::Inside(at) => {
                self.throughput = self.flights.collide(self.throughput, length) * self.alpha;
                self.media.collide(length);
                self.has_scattered = true;
                self.at = at;
                None
            }
        }
    }

    /// Draws the direction after a collision.
    pub(super) fn scatter(&mut self, u: [f32; 2]) {
        let direction = if self.tilt == Tilt::NONE {
            self.phase.sample(self.direction, u)
        } else {
            let direction = self.tilt.sample(u);
            self.throughput /= self.tilt.factor(direction.to_array(), 1.0);
            direction
        };
        self.pdf = self.phase.pdf(self.direction.dot(direction));
        self.direction = direction;
    }

    /// Ends walks at random that have less left than the light that `entered`, and those that are lost.
    pub(super) fn survives(&mut self, entered: f32, u: f32) -> bool {
        let sum = self.throughput.element_sum();
        if sum <= 0.0 || self.body.is_lost(&self.at) {
            return false;
        }
        let survival = self.survival(entered);
        self.throughput /= survival;
        u < survival
    }

    /// Probability with which a walk goes on that is not lost.
    pub(super) fn survival(&self, entered: f32) -> f32 {
        (self.throughput.element_sum() / (ROULETTE_BELOW * entered)).min(1.0)
    }
}
