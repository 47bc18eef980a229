//! The walk between clear surfaces, from the one that the camera sees to the one that light enters.

use glam::Vec3;

use super::Walks;
use super::flight::{FIRST_STRETCH, STRETCH};
use super::random::WalkRandom;
use super::shared::{LightNumbers, SharedWalk, WalkContinuation};
use super::state::Walk;
use crate::light::LightSample;
use crate::ray::{FlightEnd, Hit, Ray, SurfacePoint};
use crate::sampling::Sampler;
use crate::subsurface::entry_point::entry_bsdf;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::transport::Tracer;
use crate::surface::bsdf::{fresnel_dielectric, refract};
use crate::world::{BlockPlace, Layer, MisOrigin, PathState, ShadowMedium, World, power_heuristic, weighed};

/// Sets of four numbers that a walk takes from the sampler; the rest of a vertex's sets are the surface's.
const STRATIFIED: u32 = 5;

impl Walks {
    /// Leaves the surface through the volume below, where the light of this path may end; false where it is over.
    pub(super) fn scatter_clear<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        place: Option<BlockPlace>,
        sampler: &mut Sampler,
    ) -> bool {
        let normal = exit.point.geometric_normal * exit.side;
        let (toward, eta) = (path.ray.direction, self.medium.eta);
        let direction = if eta == 1.0 { Some(toward) } else { refract(-toward, normal, eta) };
        let Some(direction) = direction else { return false };
        let mut random = WalkRandom::new(sampler, STRATIFIED);
        let Some(mut walk) = Walk::enter(world, path, exit, &self.medium, direction) else { return false };
        let entered = walk.throughput.element_sum();
        let [flight, ..] = random.next_4d(sampler);
        let mut onward = ThroughClear { world, exit, random, entered };
        let place = place.filter(|_| eta == 1.0 && !is_last(world, path));
        let Some(place) =
            place.and_then(|place| walk.shared_place(tracer, self, path, sampler, (exit, place)))
        else {
            return onward.finish(&mut walk, path, sampler, flight);
        };
        let of_light = LightNumbers::AtCollision(onward.random.next_4d(sampler));
        let of_flight = onward.random.next_4d(sampler);
        let sharing = SharedWalk { world, exit, place, of_first: flight, of_light, of_flight };
        let end = walk.share(tracer, path, sampler, &sharing, &mut onward);
        end.is_some_and(|hit| walk.leave(world, path, exit, &hit))
    }
}

/// The continuation of walks that leave through a clear surface.
struct ThroughClear<'s, 'a> {
    world: &'a World,
    exit: &'s ExitPoint<'s>,
    random: WalkRandom,
    /// Sum of the throughput below which walks may end at random.
    entered: f32,
}

impl<'a> WalkContinuation<'a> for ThroughClear<'_, 'a> {
    /// With three the means of regions in the test `sharing` are 1.11 to 1.16 times as uncertain as without sharing.
    const GENERATIONS: usize = 2;
    /// With 0.8 the means of regions in the test `sharing` are too uncertain.
    const LEANING: f32 = 0.4;

    fn survival(&self, walk: &Walk<'a>) -> f32 {
        walk.survival(self.entered)
    }

    fn turn(&mut self, walk: &mut Walk<'a>, path: &mut PathState, sampler: &mut Sampler) -> Option<f32> {
        walk.collide(self.world, path, (&mut self.random, sampler), self.entered)
    }

    fn finish(
        &mut self,
        walk: &mut Walk<'a>,
        path: &mut PathState,
        sampler: &mut Sampler,
        flight: f32,
    ) -> bool {
        walk.wander(self.world, path, self.exit, (&mut self.random, sampler), self.entered, flight)
    }

    fn number(&mut self) -> f32 {
        self.random.next_1d()
    }
}

/// Returns `true` if a path may not be scattered any more.
pub(super) fn is_last(world: &World, path: &PathState) -> bool {
    let integrator = &world.scene.integrator;
    path.depth >= integrator.max_depth || path.diffuse_depth >= integrator.max_diffuse_depth
}

impl Walk<'_> {
    /// Flies from collision to collision, first by the number `flight`; true if the path goes on outside.
    fn wander(
        &mut self,
        world: &World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        (random, sampler): (&mut WalkRandom, &mut Sampler),
        entered: f32,
        mut flight: f32,
    ) -> bool {
        while self.events < self.most_events {
            match self.advance(flight, random) {
                Some(hit) if self.eta == 1.0 => return self.leave(world, path, exit, &hit),
                Some(hit) => {
                    let u = random.next_4d(sampler);
                    if !self.is_reflected(&hit, u[0]) {
                        return self.leave(world, path, exit, &hit);
                    }
                    flight = u[1];
                }
                None => match self.collide(world, path, (random, sampler), entered) {
                    Some(next) => flight = next,
                    None => return false,
                },
            }
        }
        false
    }

    /// Adds light at a collision and draws the direction in which the walk goes on; returns a number for the flight's
    /// length, or `None` where the walk ends.
    fn collide(
        &mut self,
        world: &World,
        path: &mut PathState,
        (random, sampler): (&mut WalkRandom, &mut Sampler),
        entered: f32,
    ) -> Option<f32> {
        if is_last(world, path) {
            return None;
        }
        let of_light = random.next_4d(sampler);
        if self.eta == 1.0 {
            let distance = self.add_light_at_collision(world, path, of_light, random);
            self.media.weigh(path.sample.radiance(), distance);
        } else {
            self.add_refracted_light(world, path, of_light, random);
        }
        let u = random.next_4d(sampler);
        if !self.survives(entered, u[3]) {
            return None;
        }
        self.scatter([u[0], u[1]]);
        Some(u[2])
    }

    /// Goes on outside, where the walk has met the body's end.
    pub(super) fn leave(&self, world: &World, path: &mut PathState, exit: &ExitPoint<'_>, hit: &Hit) -> bool {
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
        let is_refracted = self.eta != 1.0;
        let origin =
            MisOrigin { point: self.start_of_flight(), normal: Vec3::ZERO, pdf: self.pdf, is_refracted };
        path.diffuse_depth += u32::from(self.has_scattered);
        path.soft |= self.has_scattered && !world.scene.integrator.caustics;
        path.scatter(Layer::Subsurface, Ray::new(point.ray_origin(direction), direction), weight, origin);
        path.throughput != Vec3::ZERO
    }

    /// Adds light from one sampled light, scattered at the first collision, whose depth is drawn for this light alone.
    ///
    /// The light has come as far again through the body, more or less: depths are drawn as both ways weaken it, and every
    /// light is looked at.
    pub(super) fn add_light_at_first_collision(&self, world: &World, path: &mut PathState, u: [f32; 4]) {
        let drawn = self.flights.stretched(FIRST_STRETCH);
        let length = drawn.sample(self.throughput, u[3]);
        let FlightEnd::Inside(at) = self.body.fly(self.at, self.direction, (length - self.skipped).max(0.0))
        else {
            return;
        };
        let throughput = self.flights.collide_stretched(&drawn, self.throughput, length) * self.alpha;
        let collided = Self { at, throughput, ..*self };
        let Some(light) = world.lights.sample(at.position, Vec3::ZERO, u[0], [u[1], u[2]]) else {
            return;
        };
        collided.add_light(world, path, &light, f32::INFINITY, |distance| {
            self.flights.transmit(throughput, distance)
        });
    }

    /// Adds light from one sampled light, scattered at a collision.
    ///
    /// Most collisions are so deep that this light, too, would be scattered again: a flight toward it is drawn as the
    /// walk's own are, but longer, and only if it gets out of the body the way to the light is looked at. Returns the light's way
    /// through the body.
    fn add_light_at_collision(
        &self,
        world: &World,
        path: &mut PathState,
        u: [f32; 4],
        random: &mut WalkRandom,
    ) -> f32 {
        let flights = self.flights.stretched(STRETCH);
        let length = flights.sample(self.throughput, u[3]);
        // A light is not even chosen where no flight gets out
        if self.body.surely_holds(self.at, length) {
            return 0.0;
        }
        let Some(light) = world.lights.sample(self.at.position, Vec3::ZERO, u[0], [u[1], u[2]]) else {
            return 0.0;
        };
        self.add_light(world, path, &light, length, |distance| {
            let throughput = self.flights.pass_stretched(&flights, self.throughput, distance);
            self.past_shells(throughput, (light.direction, distance), random)
        })
    }

    /// Adds the light of a sample, scattered at a collision, if the body ends before such a `length` in its direction; its
    /// `throughput` is that of a walk that has come to the end. Returns the distance.
    fn add_light(
        &self,
        world: &World,
        path: &mut PathState,
        light: &LightSample,
        length: f32,
        throughput: impl FnOnce(f32) -> Vec3,
    ) -> f32 {
        let end = self.body.fly(self.at, light.direction, length);
        let FlightEnd::Boundary { distance, hit } = end else { return 0.0 };
        // The walk does not see lights inside the body
        if distance >= light.distance {
            return 0.0;
        }
        let phase = self.phase.pdf(self.direction.dot(light.direction));
        let mis = if light.is_delta { 1.0 } else { power_heuristic(light.pdf, phase) };
        let point = world.surface_point(&hit);
        let weight = self.entering(world, &point, light.direction) * phase;
        let throughput = throughput(distance) * weight;
        let beyond = LightSample { distance: light.distance - distance, ..*light };
        let soft = !world.scene.integrator.caustics;
        let medium =
            ShadowMedium { absorption: path.absorption, soft, random: self.at.position.element_sum() };
        let received = weighed(world.unoccluded(&point, &beyond, medium), mis / light.pdf);
        path.add_to(path.layer_after(Layer::Subsurface), received * throughput);
        distance
    }

    /// Factor of the surface on a radiance that enters from a direction; see the head of the module.
    fn entering(&self, world: &World, point: &SurfacePoint, direction: Vec3) -> Vec3 {
        if self.eta == 1.0 {
            world.entering(point, direction, self.side)
        } else {
            entry_bsdf(world, point).tint()
        }
    }

    /// Draws whether the boundary reflects the walk back inside, and moves it there.
    fn is_reflected(&mut self, hit: &Hit, u: f32) -> bool {
        let normal = self.body.normal(hit);
        let cosine = self.direction.dot(normal);
        if u >= fresnel_dielectric(cosine, self.eta.recip()) {
            return false;
        }
        self.direction = (self.direction - normal * (2.0 * cosine)).normalize();
        self.at = self.body.reflected(hit);
        // Lights are joined to collisions only
        self.pdf = f32::INFINITY;
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
