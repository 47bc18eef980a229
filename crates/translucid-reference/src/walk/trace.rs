//! The walk's kernel.
//!
//! ```text
//! for each photon of the range, all random numbers from its own stream:
//!     draw how many collisions it will survive, where and in which direction it starts
//!     loop:
//!         fly an exponential distance
//!         beyond a face: by chance out through it, which is an exit, or reflected back inside
//!         had it used up its collisions: absorbed
//!         deflect
//! ```
//!
//! How the code departs from this:
//!
//! 1. Sixteen photons walk at a time, in single precision, in the lanes of vectors ([`super::lanes`]).
//! 2. Photons live in a block, a structure of arrays with 32 such groups. A group steps in registers until one
//!    of its photons ends; then it is stored, the ended photons are looked at one by one, and each place is
//!    taken by a fresh photon, so that no lane idles.
//! 3. Fresh photons come from a pool that is filled by vectors too, their first flight included. Half of all
//!    photons at an albedo of ½ end there.
//! 4. Near the end of the range, when the pool is dry, the block's last photon fills the gap: the block shrinks
//!    and stays dense, however long the last photon lives.
//! 5. Absorption is not drawn at each collision, but once per photon as a geometric number: the collision that
//!    absorbs is known beforehand, and no lane flies to it in vain.
//! 6. Reflection mirrors the end of the flight at the face, no flight is cut in two; total reflection of the
//!    half space is done in the lanes.

use std::ops::Range;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};

use super::boundary::{Boundary, Ray};
use super::lanes::{Floats, Words, exponential};
use super::random::{Key, LANES, Stream};
use super::scatter::{Directions, Scatter, WithScatter, with_scatter};
use super::sources::Source;
use super::{Exit, PhotonCounts, Problem};

/// Groups of lanes in a block: enough that a group's stores have long been done when it is loaded again, few
/// enough that the block stays in the first-level cache.
const GROUPS: usize = 32;
/// Photons in a block.
const BLOCK: usize = GROUPS * LANES;
/// Exits that are handed on at a time.
const EXITS: usize = 1024;

/// Walks the photons of a range.
///
/// Every random number is a function of (seed, photon index): any partition of the range gives the same exits,
/// in another order. `reference_albedo` is the probability of surviving a collision, in [0, 1]; at 1 in a half
/// space the mean number of collisions is infinite. Each photon ends as one exit or as absorbed; one that
/// survives 2³² − 1 collisions counts as absorbed.
pub(crate) fn trace(
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut impl FnMut(&[Exit]),
) -> PhotonCounts {
    trace_at_level(Level::new(), problem, reference_albedo, seed, photons, exits)
}

/// [`trace`] with a choice of instruction set.
pub(crate) fn trace_at_level(
    level: Level,
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut dyn FnMut(&[Exit]),
) -> PhotonCounts {
    struct Run<'a> {
        level: Level,
        setup: Setup,
        photons: Range<u64>,
        exits: &'a mut dyn FnMut(&[Exit]),
    }
    impl WithScatter for Run<'_> {
        type Output = PhotonCounts;
        fn run<P: Scatter>(self, scatter: P) -> PhotonCounts {
            let Self { level, setup, photons, exits } = self;
            dispatch!(level, simd => Walk::new(simd, scatter, setup, photons, exits).run())
        }
    }
    let setup = Setup {
        key: Key::new(seed),
        source: Source::new(problem),
        boundary: Boundary::new(problem),
        collisions_per_unit: mean_per_unit(reference_albedo),
    };
    with_scatter(problem.parameters().phase_function, Run { level, setup, photons, exits })
}

/// −1/ln α: the number of collisions survived is the whole part of this times an exponential variate.
fn mean_per_unit(reference_albedo: f64) -> f32 {
    let log = reference_albedo.max(0.0).min(1.0).ln();
    (-1.0 / log).min(1e30) as f32
}

/// What does not change on the way.
#[derive(Clone, Copy)]
struct Setup {
    key: Key,
    source: Source,
    boundary: Boundary,
    collisions_per_unit: f32,
}

/// Photons that are about to collide, as a structure of arrays.
#[repr(align(64))]
struct Photons {
    x: [[f32; LANES]; GROUPS],
    y: [[f32; LANES]; GROUPS],
    z: [[f32; LANES]; GROUPS],
    ux: [[f32; LANES]; GROUPS],
    uy: [[f32; LANES]; GROUPS],
    uz: [[f32; LANES]; GROUPS],
    stream: [[[u32; LANES]; GROUPS]; 4],
    /// Collisions that it will yet survive.
    left: [[u32; LANES]; GROUPS],
    /// Collisions that it will survive in all.
    budget: [[u32; LANES]; GROUPS],
}

/// One of them.
#[derive(Clone, Copy)]
struct Photon {
    ray: Ray,
    stream: Stream<u32>,
    left: u32,
    budget: u32,
}

impl Photons {
    fn new() -> Box<Self> {
        let (floats, words) = ([[0.0; LANES]; GROUPS], [[0; LANES]; GROUPS]);
        Box::new(Self {
            x: floats,
            y: floats,
            z: floats,
            ux: floats,
            uy: floats,
            uz: floats,
            stream: [words; 4],
            left: words,
            budget: words,
        })
    }

    #[inline(always)]
    fn get(&self, index: usize) -> Photon {
        let (group, lane) = (index / LANES % GROUPS, index % LANES);
        Photon {
            ray: Ray {
                x: self.x[group][lane],
                y: self.y[group][lane],
                z: self.z[group][lane],
                ux: self.ux[group][lane],
                uy: self.uy[group][lane],
                uz: self.uz[group][lane],
            },
            stream: Stream([
                self.stream[0][group][lane],
                self.stream[1][group][lane],
                self.stream[2][group][lane],
                self.stream[3][group][lane],
            ]),
            left: self.left[group][lane],
            budget: self.budget[group][lane],
        }
    }

    #[inline(always)]
    fn set(&mut self, index: usize, photon: &Photon) {
        let (group, lane) = (index / LANES % GROUPS, index % LANES);
        self.x[group][lane] = photon.ray.x;
        self.y[group][lane] = photon.ray.y;
        self.z[group][lane] = photon.ray.z;
        self.ux[group][lane] = photon.ray.ux;
        self.uy[group][lane] = photon.ray.uy;
        self.uz[group][lane] = photon.ray.uz;
        for (array, word) in self.stream.iter_mut().zip(photon.stream.0) {
            array[group][lane] = word;
        }
        self.left[group][lane] = photon.left;
        self.budget[group][lane] = photon.budget;
    }
}

/// A group of photons in registers.
#[derive(Clone, Copy)]
struct Group<S: Simd> {
    x: Floats<S>,
    y: Floats<S>,
    z: Floats<S>,
    directions: Directions<S>,
    streams: Stream<Words<S>>,
    left: Words<S>,
}

impl<S: Simd> Group<S> {
    #[inline(always)]
    fn load(simd: S, photons: &Photons, group: usize) -> Self {
        let floats = |array: &[[f32; LANES]; GROUPS]| Floats::load_array(simd, array[group]);
        let words = |array: &[[u32; LANES]; GROUPS]| Words::load_array(simd, array[group]);
        Self {
            x: floats(&photons.x),
            y: floats(&photons.y),
            z: floats(&photons.z),
            directions: Directions { x: floats(&photons.ux), y: floats(&photons.uy), z: floats(&photons.uz) },
            streams: Stream([
                words(&photons.stream[0]),
                words(&photons.stream[1]),
                words(&photons.stream[2]),
                words(&photons.stream[3]),
            ]),
            left: words(&photons.left),
        }
    }

    #[inline(always)]
    fn store(&self, photons: &mut Photons, group: usize) {
        self.x.store_array(&mut photons.x[group]);
        self.y.store_array(&mut photons.y[group]);
        self.z.store_array(&mut photons.z[group]);
        self.directions.x.store_array(&mut photons.ux[group]);
        self.directions.y.store_array(&mut photons.uy[group]);
        self.directions.z.store_array(&mut photons.uz[group]);
        for (array, words) in photons.stream.iter_mut().zip(self.streams.0) {
            words.store_array(&mut array[group]);
        }
        self.left.store_array(&mut photons.left[group]);
    }

    /// Flies without regard to faces.
    #[inline(always)]
    fn fly(&mut self, simd: S) {
        let flight = exponential(simd, self.streams.next());
        self.x = flight.mul_add(self.directions.x, self.x);
        self.y = flight.mul_add(self.directions.y, self.y);
        self.z = flight.mul_add(self.directions.z, self.z);
    }
}

struct Walk<'a, S: Simd, P: Scatter> {
    simd: S,
    scatter: P,
    setup: Setup,
    /// Photons not launched yet.
    waiting: Range<u64>,
    /// Launched photons that wait for a place, and the places in `pool` where they are.
    pool: Box<Photons>,
    pooled: Vec<u16>,
    block: Box<Photons>,
    /// Photons in the block.
    alive: usize,
    buffer: Vec<Exit>,
    exits: &'a mut dyn FnMut(&[Exit]),
    counts: PhotonCounts,
}

impl<'a, S: Simd, P: Scatter> Walk<'a, S, P> {
    fn new(
        simd: S,
        scatter: P,
        setup: Setup,
        waiting: Range<u64>,
        exits: &'a mut dyn FnMut(&[Exit]),
    ) -> Self {
        let launched = waiting.end.saturating_sub(waiting.start);
        Self {
            simd,
            scatter,
            setup,
            waiting,
            pool: Photons::new(),
            pooled: Vec::with_capacity(BLOCK),
            block: Photons::new(),
            alive: 0,
            buffer: Vec::with_capacity(EXITS),
            exits,
            counts: PhotonCounts { launched, ..PhotonCounts::default() },
        }
    }

    #[inline(always)]
    fn run(mut self) -> PhotonCounts {
        while self.alive < BLOCK {
            let Some(photon) = self.fresh() else { break };
            self.block.set(self.alive, &photon);
            self.alive += 1;
        }
        while self.alive > 0 {
            let mut group = 0;
            while group * LANES < self.alive {
                self.advance(group);
                group += 1;
            }
        }
        (self.exits)(&self.buffer);
        self.counts
    }

    /// Steps a group until one of its photons reaches a face or its last collision, then sees to those.
    #[inline(always)]
    fn advance(&mut self, group: usize) {
        let (simd, boundary) = (self.simd, self.setup.boundary);
        let (top, bottom) = (Floats::splat(simd, 0.0), Floats::splat(simd, boundary.thickness));
        let present = self.alive - group * LANES;
        let present = if present >= LANES { 0xffff } else { (1u64 << present) - 1 };

        let mut photons = Group::load(simd, &self.block, group);
        let (ended, crossed) = loop {
            let words = [photons.streams.next(), photons.streams.next()];
            photons.directions = self.scatter.scatter(simd, photons.directions, words);
            photons.fly(simd);
            photons.left -= 1;
            let crossed = photons.z.simd_lt(top) | photons.z.simd_gt(bottom);
            let last = photons.left.simd_eq(0);
            let ended = (crossed | last).to_bitmask() & present;
            if ended != 0 {
                break (ended, crossed.to_bitmask());
            }
        };
        photons.store(&mut self.block, group);
        self.settle(group, ended, crossed);
    }

    /// Looks at the photons of a group that ended a flight beyond a face or at their last collision.
    ///
    /// From the highest lane down, so that the block's last photon, which fills a gap, is never one of those.
    #[inline(always)]
    fn settle(&mut self, group: usize, mut ended: u64, crossed: u64) {
        while ended != 0 {
            let lane = ended.ilog2() as usize;
            ended ^= 1 << lane;
            let index = group * LANES + lane;
            let mut photon = self.block.get(index);
            if crossed >> lane & 1 == 1 {
                let order = photon.budget - photon.left;
                let out = self.cross(&mut photon, order);
                if !out && photon.left > 0 {
                    self.block.set(index, &photon);
                    continue;
                }
                if !out {
                    self.absorb(photon.budget);
                }
            } else {
                self.absorb(photon.budget);
            }
            self.replace(index);
        }
    }

    /// Sees to a photon beyond a face; whether it left.
    #[inline(always)]
    fn cross(&mut self, photon: &mut Photon, order: u32) -> bool {
        let Some(side) = self.setup.boundary.cross(&mut photon.ray, &mut photon.stream) else {
            return false;
        };
        let Ray { x, y, uz, .. } = photon.ray;
        self.buffer.push(Exit { x, y, cos_theta: uz.abs(), order, side });
        self.counts.collisions += u64::from(order);
        if self.buffer.len() == EXITS {
            (self.exits)(&self.buffer);
            self.buffer.clear();
        }
        true
    }

    #[inline(always)]
    fn absorb(&mut self, budget: u32) {
        self.counts.absorbed += 1;
        self.counts.collisions += u64::from(budget) + 1;
    }

    /// Gives the place of a photon that ended to a fresh one, or to the block's last.
    #[inline(always)]
    fn replace(&mut self, index: usize) {
        if let Some(photon) = self.fresh() {
            self.block.set(index, &photon);
        } else {
            self.alive -= 1;
            let last = self.block.get(self.alive);
            self.block.set(index, &last);
        }
    }

    /// The next photon that has a collision to survive.
    #[inline(always)]
    fn fresh(&mut self) -> Option<Photon> {
        while self.pooled.is_empty() && !self.waiting.is_empty() {
            self.launch();
        }
        self.pooled.pop().map(|place| self.pool.get(usize::from(place)))
    }

    /// Fills the pool: photons up to their first collision.
    fn launch(&mut self) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || {
                for group in 0..GROUPS {
                    if self.waiting.is_empty() {
                        break;
                    }
                    self.launch_group(group);
                }
            },
        );
    }

    #[inline(always)]
    fn launch_group(&mut self, group: usize) {
        let Setup { key, source, boundary, collisions_per_unit } = self.setup;
        let simd = self.simd;
        let first = self.waiting.start;
        let count = (self.waiting.end - first).min(LANES as u64);
        self.waiting.start += count;

        // Draw number of collisions, direction and position
        let mut streams = Stream::of_16(simd, key, first);
        let tries = exponential(simd, streams.next()).max(1e-10) * collisions_per_unit;
        let budget: Words<S> = tries.min(4_294_967_040.0).to_int();
        let directions = source.directions(simd, &mut streams);
        let (x, y) = source.positions(simd, &mut streams);

        // Fly to the first collision
        let z = Floats::splat(simd, 0.0);
        let mut photons = Group { x, y, z, directions, streams, left: budget };
        photons.fly(simd);
        photons.store(&mut self.pool, group);
        budget.store_array(&mut self.pool.budget[group]);

        // See who is still there
        let crossed = photons.z.simd_gt(Floats::splat(simd, boundary.thickness)).to_bitmask();
        for lane in 0..count as usize {
            let index = group * LANES + lane;
            if crossed >> lane & 1 == 1 {
                let mut photon = self.pool.get(index);
                if self.cross(&mut photon, 0) {
                    continue;
                }
                self.pool.set(index, &photon);
            }
            if self.pool.budget[group][lane] == 0 {
                self.absorb(0);
            } else {
                self.pooled.push(index as u16);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Parameters, PhaseFunction, Side};
    use super::*;
    use crate::Entry;

    fn problems() -> Vec<Problem> {
        let hg = |g| PhaseFunction::HenyeyGreenstein { g };
        let parameters = Parameters::default();
        [
            parameters,
            Parameters { eta: 1.4, entry: Entry::Cosine, spot_radius: 0.5, ..parameters },
            Parameters { eta: 0.8, phase_function: hg(-0.5), ..parameters },
            Parameters { thickness: 0.3, phase_function: hg(0.9), eta: 1.5, ..parameters },
            Parameters { thickness: 1e-3, entry: Entry::UniformCosine, ..parameters },
            Parameters { phase_function: PhaseFunction::Rayleigh, thickness: 5.0, ..parameters },
        ]
        .map(|parameters| Problem::new(parameters).unwrap())
        .to_vec()
    }

    /// Exits in an order that does not depend on the walk, and the counts.
    fn exits(
        problem: &Problem,
        albedo: f64,
        seed: u64,
        ranges: &[Range<u64>],
    ) -> (Vec<[u32; 5]>, PhotonCounts) {
        let mut found = Vec::new();
        let mut counts = PhotonCounts::default();
        for range in ranges {
            let part = trace(problem, albedo, seed, range.clone(), &mut |exits| {
                found.extend(exits.iter().map(|exit| {
                    let side = u32::from(exit.side == Side::Transmitted);
                    [exit.order, exit.x.to_bits(), exit.y.to_bits(), exit.cos_theta.to_bits(), side]
                }));
            });
            counts.launched += part.launched;
            counts.absorbed += part.absorbed;
            counts.collisions += part.collisions;
        }
        found.sort_unstable();
        (found, counts)
    }

    #[test]
    #[allow(clippy::single_range_in_vec_init, reason = "one range is one of the partitions")]
    fn exits_do_not_depend_on_the_partition() {
        for problem in problems() {
            let whole = exits(&problem, 0.95, 11, &[5..4005]);
            assert_eq!(whole.0.len() as u64 + whole.1.absorbed, 4000);
            let parts = exits(&problem, 0.95, 11, &[5..6, 3000..3001, 6..700, 3001..4005, 700..3000, 9..9]);
            assert_eq!(whole, parts);
            let other = exits(&problem, 0.95, 12, &[5..4005]);
            assert_ne!(whole, other);
        }
    }

    #[test]
    fn every_photon_ends_as_exit_or_absorbed() {
        for problem in problems() {
            for albedo in [0.0, 0.3, 0.9, 0.999] {
                let range = u64::MAX - 3000..u64::MAX - 1000;
                let (found, counts) = exits(&problem, albedo, 3, std::slice::from_ref(&range));
                assert_eq!(counts.launched, 2000);
                assert_eq!(found.len() as u64 + counts.absorbed, 2000);
                let orders: u64 = found.iter().map(|exit| u64::from(exit[0])).sum();
                assert!(counts.collisions >= orders + counts.absorbed);
                if albedo == 0.0 {
                    assert!(found.iter().all(|exit| exit[0] == 0));
                    assert_eq!(counts.collisions, counts.absorbed);
                }
            }
        }
    }

    #[test]
    fn nothing_comes_of_nothing() {
        for problem in problems() {
            assert_eq!(exits(&problem, 0.9, 1, &[]), (vec![], PhotonCounts::default()));
            let reversed = Range { start: 7, end: 3 };
            assert_eq!(exits(&problem, 0.9, 1, std::slice::from_ref(&reversed)).0, Vec::<[u32; 5]>::new());
        }
    }

    /// Without absorption everything leaves a slab.
    #[test]
    fn slab_without_absorption_keeps_nothing() {
        for problem in problems().into_iter().filter(|p| p.parameters().thickness.is_finite()) {
            let (found, counts) = exits(&problem, 1.0, 1, std::slice::from_ref(&(0..3000)));
            assert_eq!((found.len(), counts.absorbed), (3000, 0));
        }
    }

    /// R of the exact half space (physics.md §3): |z| < 4 each, false alarm 6e-5 each.
    #[test]
    fn totals_are_exact() {
        let half_space = Parameters::default();
        let cosine = Parameters { entry: Entry::Cosine, ..half_space };
        for (parameters, albedo, exact) in [
            (half_space, 0.5, 0.11522587770720),
            (half_space, 0.9, 0.41494747913082),
            (half_space, 0.99, 0.75272071716030),
            (cosine, 0.9, 0.47802448922824),
            (Parameters { eta: 1.4, ..half_space }, 0.9, 0.25775574627),
        ] {
            let photons = 200_000;
            let counts = trace(&Problem::new(parameters).unwrap(), albedo, 2, 0..photons, &mut |_| {});
            let found = 1.0 - counts.absorbed as f64 / photons as f64;
            let z = (found - exact) / (exact * (1.0 - exact) / photons as f64).sqrt();
            assert!(z.abs() < 4.0, "{parameters:?} {albedo}: {found} {exact}, z = {z}");
        }
    }
}
