//! The walk that ends at a diffuse surface, which light enters from any direction.
//!
//! The direction in which the walk meets the surface does not matter. So it samples a light once, where it ends, and not at
//! each collision.

use glam::Vec3;
use translucid_scene::WalkSurface;

use super::Walks;
use super::random::WalkRandom;
use super::shared::{LightNumbers, MOST_GENERATIONS, SharedWalk, WalkContinuation};
use super::state::Walk;
use crate::ray::Hit;
use crate::sampling::{Frame, Reserved, Sampler};
use crate::subsurface::entry_point::EntryPoint;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::kernel::DirectionalWeight;
use crate::subsurface::transport::Tracer;
use crate::surface::bsdf::{Ggx, refract, sample_cosine};
use crate::surface::{self, WalkMedium};
use crate::world::{BlockPlace, PathState, World};

/// Sets of four numbers that a walk takes from the sampler; the rest of a vertex's sets are the surface's, here and at the
/// walk's end.
const STRATIFIED: u32 = 3;

impl Walks {
    /// Leaves the surface through the volume below, and goes on where light enters it; false where the path is over.
    pub(super) fn scatter_diffuse<'a, T: Tracer<'a>>(
        &'a self,
        tracer: &mut T,
        world: &'a World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
        place: Option<BlockPlace>,
        sampler: &mut Sampler,
    ) -> bool {
        let at_the_end = [sampler.reserve(), sampler.reserve()];
        let mut random = WalkRandom::new(sampler, STRATIFIED);
        let u = random.next_4d(sampler);
        let direction = self.medium.direction_below(world, path, exit, [u[0], u[1]]);
        let walk = direction.and_then(|direction| Walk::enter(world, path, exit, &self.medium, direction));
        let Some(mut walk) = walk else { return false };
        let entered = walk.throughput.element_sum();
        let mut onward = ToMatteEnd { world, random, at_the_end, entered };
        let Some(place) =
            place.and_then(|place| walk.shared_place(tracer, self, path, sampler, (exit, place)))
        else {
            return onward.finish(&mut walk, path, sampler, u[2]);
        };
        let of_flight = onward.random.next_4d(sampler);
        let of_first = u[2];
        let of_light = LightNumbers::AtSurface(at_the_end);
        let sharing = SharedWalk { world, exit, place, of_first, of_light, of_flight };
        let end = walk.share(tracer, path, sampler, &sharing, &mut onward);
        end.is_some_and(|hit| onward.enter(&walk, path, &hit))
    }
}

impl WalkMedium {
    /// Direction in which the view goes on below the surface; `None` if it does not.
    pub(super) fn direction_below(
        &self,
        world: &World,
        path: &PathState,
        exit: &ExitPoint<'_>,
        u: [f32; 2],
    ) -> Option<Vec3> {
        let frame = Frame::from_normal(exit.normal * exit.side);
        let refracted = |u: [f32; 2], roughness: f32| {
            if self.eta == 1.0 {
                return Some(path.ray.direction);
            }
            let wo = frame.to_local(-path.ray.direction);
            let facet = Ggx::from_roughness(roughness).sample_visible(wo, u);
            Some(frame.to_world(refract(wo, facet, self.eta)?))
        };
        let diffuse = |u: [f32; 2]| -frame.to_world(sample_cosine(u));
        let direction = match self.surface {
            WalkSurface::Diffuse => diffuse(u),
            WalkSurface::Skin if u[0] < 0.5 => diffuse([2.0 * u[0], u[1]]),
            WalkSurface::Skin => refracted([2.0 * u[0] - 1.0, u[1]], 1.0)?,
            WalkSurface::Clear | WalkSurface::Rough => {
                let (_, material) = world.material(exit.point);
                let surface = surface::parameters_at(&world.scene, material, exit.point);
                refracted(u, surface.specular_roughness)?
            }
        };
        // Where the shading normal leads outside, the mirror image leads as far in
        let outward = exit.point.geometric_normal * exit.side;
        let out = direction.dot(outward).max(0.0);
        Some((direction - outward * (2.0 * out)).normalize())
    }
}

/// The way of walks to where light enters through a matte surface.
struct ToMatteEnd<'a> {
    world: &'a World,
    random: WalkRandom,
    at_the_end: [Reserved; 2],
    /// Sum of the throughput below which walks may end at random.
    entered: f32,
}

impl ToMatteEnd<'_> {
    /// Goes on where light enters at the walk's end; false where the path is over.
    fn enter(&self, walk: &Walk<'_>, path: &mut PathState, hit: &Hit) -> bool {
        path.throughput = walk.throughput;
        let entry = EntryPoint::new(self.world, self.world.surface_point(hit), walk.side);
        entry.enter(path, &DirectionalWeight::Radial, self.at_the_end)
    }
}

impl<'a> WalkContinuation<'a> for ToMatteEnd<'a> {
    const GENERATIONS: usize = MOST_GENERATIONS;
    /// It pays where light comes from the side of the camera, and costs little where it comes from behind.
    const LEANING: f32 = 0.8;

    fn survival(&self, walk: &Walk<'a>) -> f32 {
        walk.survival(self.entered)
    }

    fn turn(&mut self, walk: &mut Walk<'a>, _path: &mut PathState, sampler: &mut Sampler) -> Option<f32> {
        walk.turn((&mut self.random, sampler), self.entered)
    }

    fn finish(
        &mut self,
        walk: &mut Walk<'a>,
        path: &mut PathState,
        sampler: &mut Sampler,
        flight: f32,
    ) -> bool {
        let end = walk.find_end((&mut self.random, sampler), self.entered, flight);
        end.is_some_and(|hit| self.enter(walk, path, &hit))
    }

    fn number(&mut self) -> f32 {
        self.random.next_1d()
    }
}

impl Walk<'_> {
    /// Flies from collision to collision, first by the number `flight`, to where the body ends.
    fn find_end(
        &mut self,
        (random, sampler): (&mut WalkRandom, &mut Sampler),
        entered: f32,
        mut flight: f32,
    ) -> Option<Hit> {
        while self.events < self.most_events {
            if let Some(hit) = self.advance(flight, random) {
                return Some(hit);
            }
            flight = self.turn((random, sampler), entered)?;
        }
        None
    }

    /// Draws the direction in which the walk goes on after a collision; returns a number for the flight's length, or
    /// `None` where the walk ends.
    fn turn(&mut self, (random, sampler): (&mut WalkRandom, &mut Sampler), entered: f32) -> Option<f32> {
        let u = random.next_4d(sampler);
        if !self.survives(entered, u[3]) {
            return None;
        }
        self.scatter([u[0], u[1]]);
        Some(u[2])
    }
}
