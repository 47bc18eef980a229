//! The walk itself, from the surface that the camera sees to the surface that light enters.

use glam::Vec3;

use super::flight::Flights;
use super::phase_function::HenyeyGreenstein;
use super::random::WalkRandom;
use crate::light::LightSample;
use crate::ray::{Body, FlightEnd, Geometry, Hit, Inside, Ray, SurfacePoint};
use crate::sampling::Sampler;
use crate::subsurface::entry_point::entry_bsdf;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::parameters::Subsurface;
use crate::surface::WalkMedium;
use crate::surface::bsdf::{fresnel_dielectric, refract};
use crate::world::{Layer, Origin, PathState, ShadowMedium, World, power_heuristic, weighed};

/// Flights after which a walk is given up.
///
/// Only media that absorb next to nothing get there. As A = 1 − (4/√3) √(1 − α) + … near white, the share of light that
/// is still inside a white half space after n collisions is (4/√3)/√(πn): 0.5 %, whose mean number of collisions is
/// infinite. With absorption e^{−n(1 − α)} of that is left: below 0.15 % at A = 0.99, nothing at 0.95.
const MOST_EVENTS: u32 = 1 << 16;

/// Share of the light that entered below which walks end at random.
const ROULETTE_BELOW: f32 = 1.0;

/// A walk under way.
struct Walk<'a> {
    body: Body<'a>,
    /// Side of the surface that the body is on.
    side: f32,
    flights: Flights,
    phase: HenyeyGreenstein,
    /// Single-scattering albedo per channel.
    alpha: Vec3,
    /// Relative index of the boundary, 1 without one.
    eta: f32,
    at: Inside,
    direction: Vec3,
    throughput: Vec3,
    /// Collisions and reflections inside.
    events: u32,
    /// Whether there was a collision.
    has_scattered: bool,
    /// Solid-angle density of the direction, infinite before it was drawn at a collision.
    pdf: f32,
    /// Way from the surface to the point below it where the walk began \[L\], 0 after the first flight.
    skipped: f32,
}

impl WalkMedium {
    /// Leaves the surface through the volume below, where the light of this path may end; false where it is over.
    pub(in crate::subsurface::transport) fn scatter(
        &self,
        world: &World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        sampler: &mut Sampler,
    ) -> bool {
        let mut random = WalkRandom::new(sampler);
        let Some(mut walk) = Walk::enter(&world.geometry, path, exit, self) else { return false };
        let entered = walk.throughput.element_sum();
        let mut flight = random.next_4d()[0];
        while walk.events < MOST_EVENTS {
            match walk.fly(flight) {
                Some(hit) if walk.eta == 1.0 => return walk.leave(world, path, exit, &hit),
                Some(hit) => {
                    let u = random.next_4d();
                    if !walk.is_reflected(&hit, u[0]) {
                        return walk.leave(world, path, exit, &hit);
                    }
                    flight = u[1];
                }
                None if is_last(world, path) => return false,
                None => {
                    if walk.eta == 1.0 {
                        walk.add_light_at_collision(world, path, random.next_4d());
                    }
                    let u = random.next_4d();
                    if !walk.survives(entered, u[3]) {
                        return false;
                    }
                    walk.scatter([u[0], u[1]]);
                    flight = u[2];
                }
            }
        }
        false
    }
}

/// Whether a path may not be scattered any more.
fn is_last(world: &World, path: &PathState) -> bool {
    let integrator = &world.scene.integrator;
    path.depth >= integrator.max_depth || path.diffuse_depth >= integrator.max_diffuse_depth
}

impl<'a> Walk<'a> {
    /// Goes on outside, where the walk has met the body's end.
    fn leave(&self, world: &World, path: &mut PathState, exit: &ExitPoint<'_>, hit: &Hit) -> bool {
        let point = world.surface_point(hit);
        let Some(direction) = self.direction_outside(hit) else { return false };
        let weight = self.entering(world, &point, direction);
        path.throughput = self.throughput;
        if self.eta == 1.0 && !self.has_scattered {
            // Nothing has happened to the light, which lights could be sampled for where shadow rays pass, too
            if !world.is_passed_by_shadow_rays(exit.point, path.soft) {
                path.origin.pdf = f32::INFINITY;
            }
            return path.pass(&point, weight);
        }
        let origin = Origin { point: self.at.position, normal: Vec3::ZERO, pdf: self.pdf };
        path.diffuse_depth += u32::from(self.has_scattered);
        path.soft |= self.has_scattered && !world.scene.integrator.caustics;
        path.scatter(Layer::Subsurface, Ray::new(point.ray_origin(direction), direction), weight, origin);
        path.throughput != Vec3::ZERO
    }

    /// Adds light from one sampled light, scattered at a collision.
    ///
    /// Most collisions are so deep that this light, too, would be scattered again: a flight toward it is drawn as the
    /// walk's own are, and only if it gets out of the body the way to the light is looked at.
    fn add_light_at_collision(&self, world: &World, path: &mut PathState, u: [f32; 4]) {
        let Some(light) = world.lights.sample(self.at.position, Vec3::ZERO, u[0], [u[1], u[2]]) else {
            return;
        };
        let length = self.flights.sample(self.throughput, u[3]);
        let end = self.body.fly(self.at, light.direction, length);
        let FlightEnd::Boundary { distance, hit } = end else { return };
        // What shines inside the body is no part of what the walk sees
        if distance >= light.distance {
            return;
        }
        let phase = self.phase.pdf(self.direction.dot(light.direction));
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, phase) };
        let point = world.surface_point(&hit);
        let weight = self.entering(world, &point, light.direction) * phase;
        let throughput = self.flights.pass(self.throughput, distance) * weight;
        let beyond = LightSample { distance: light.distance - distance, ..light };
        let medium = ShadowMedium { absorption: path.absorption, soft: !world.scene.integrator.caustics };
        let received = weighed(world.unoccluded(&point, &beyond, medium), mis / light.pdf);
        path.add_to(path.layer_after(Layer::Subsurface), received * throughput);
    }

    /// Factor of the surface on a radiance that enters from a direction; see the head of the module.
    fn entering(&self, world: &World, point: &SurfacePoint, direction: Vec3) -> Vec3 {
        if self.eta == 1.0 {
            world.entering(point, direction, self.side)
        } else {
            entry_bsdf(world, point).tint()
        }
    }

    /// Begins below the surface that the camera sees; `None` if there is no way in.
    fn enter(
        geometry: &'a Geometry,
        path: &PathState,
        exit: &ExitPoint<'_>,
        medium: &WalkMedium,
    ) -> Option<Self> {
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let (point, side) = (exit.point, exit.side);
        let toward = path.ray.direction;
        let normal = point.geometric_normal * side;
        let direction = if medium.eta == 1.0 { toward } else { refract(-toward, normal, medium.eta)? };
        let body = Body::below(geometry, point, side);
        let (at, skipped) = body.enter(point, direction)?;
        // Channels of length 0 are a matter of the surface
        let scatters = length.cmpgt(Vec3::ZERO);
        let sigma_t = Vec3::select(scatters, length.recip(), Vec3::ZERO);
        let throughput = Vec3::select(scatters, path.throughput, Vec3::ZERO);
        let sum = throughput.element_sum();
        (sum > 0.0 && sum.is_finite()).then(|| Self {
            body,
            side,
            flights: Flights::new(sigma_t),
            phase: HenyeyGreenstein::new(medium.g),
            alpha: medium.single_scattering_albedo(surface_albedo),
            eta: medium.eta,
            at,
            direction,
            throughput,
            events: 0,
            has_scattered: false,
            pdf: f32::INFINITY,
            skipped,
        })
    }

    /// Goes to the next collision, or to the body's end that comes before it.
    fn fly(&mut self, u: f32) -> Option<Hit> {
        let length = self.flights.sample(self.throughput, u);
        let skipped = std::mem::take(&mut self.skipped);
        self.events += 1;
        match self.body.fly(self.at, self.direction, (length - skipped).max(0.0)) {
            FlightEnd::Boundary { distance, hit } => {
                self.throughput = self.flights.pass(self.throughput, distance + skipped);
                Some(hit)
            }
            FlightEnd::Inside(at) => {
                self.throughput = self.flights.collide(self.throughput, length) * self.alpha;
                self.has_scattered = true;
                self.at = at;
                None
            }
        }
    }

    /// Draws the direction after a collision.
    fn scatter(&mut self, u: [f32; 2]) {
        let direction = self.phase.sample(self.direction, u);
        if self.eta == 1.0 {
            self.pdf = self.phase.pdf(self.direction.dot(direction));
        }
        self.direction = direction;
    }

    /// Ends walks at random that have less left than the light that `entered`, and those that are lost.
    fn survives(&mut self, entered: f32, u: f32) -> bool {
        let sum = self.throughput.element_sum();
        if sum <= 0.0 || self.body.is_lost(&self.at) {
            return false;
        }
        if sum >= ROULETTE_BELOW * entered {
            return true;
        }
        let survival = sum / entered;
        self.throughput /= survival;
        u < survival
    }

    /// Whether the boundary sends the walk back inside, to where it then is.
    fn is_reflected(&mut self, hit: &Hit, u: f32) -> bool {
        let normal = self.body.normal(hit);
        let cosine = self.direction.dot(normal);
        if u >= fresnel_dielectric(cosine, self.eta.recip()) {
            return false;
        }
        self.direction = (self.direction - normal * (2.0 * cosine)).normalize();
        self.at = self.body.reflected(hit);
        true
    }

    /// Direction on the other side of the boundary.
    fn direction_outside(&self, hit: &Hit) -> Option<Vec3> {
        if self.eta == 1.0 {
            return Some(self.direction);
        }
        refract(-self.direction, -self.body.normal(hit), self.eta.recip())
    }
}
