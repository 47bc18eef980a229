//! Kernel of the walk.
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
//! Departures of the code from this:
//!
//! 1. Sixteen photons walk at a time, in single precision, in the lanes of vectors ([`super::lanes`]).
//! 2. Photons live in a block, a structure of arrays with 32 such groups. A group steps in registers until one
//!    of its photons reaches a face or its last collision. Then exits are compressed into a buffer, and fresh
//!    photons expanded into the lanes that came free, so that none idles and nothing is done lane by lane.
//! 3. Fresh photons come from a pool that vectors fill too, their first flight included. Half of all photons at
//!    an albedo of ½ end there.
//! 4. Near the end of the range, when the pool is dry, the block's last photon fills the gap: the block shrinks
//!    and stays dense, however long the last photon lives.
//! 5. Absorption is not drawn at each collision, but once per photon as a geometric number: the collision that
//!    absorbs is known beforehand, and no lane scatters in vain.
//! 6. Reflection mirrors the end of the flight at the face, no flight is cut in two. Total reflection does not
//!    end a group's stay in registers.
//!
//! CPU times in ns at albedo ½ per photon and at 0.9 and 0.999 per collision, isotropic and index-matched, on an EPYC of
//! 2022 with AVX-512, as `cargo bench -p translucid-reference --bench walk -- 'g=0 eta=1 '` prints them:
//!
//! | | ½ | 0.9 | 0.999 |
//! |---|---|---|---|
//! | `kernel`: the widest instructions, here AVX-512 | 6.0 | 2.62 | 1.44 |
//! | `AVX2` | 9.3 | 4.65 | 2.20 |
//! | `baseline`: SSE2, multiply-adds called, refills one photon at a time, one kernel for all phase functions | 62 | 32.8 | 31.6 |
//! | `scalar f64`: the twin in double precision | 92 | 51.2 | 47.8 |

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, mask32x16};

use super::boundary::{Boundary, Ray};
use super::deflection_table::DeflectionLaw;
use super::exit_buffer::ExitBuffer;
use super::instruction_sets::dispatched;
use super::lanes::{Floats, FusedMulAdd, Words, exponential, is_narrow, unit};
use super::photon_exit::{PhotonCounts, PhotonExit, Side};
use super::photon_source::PhotonSource;
use super::photons::{BLOCK, Group, Photons, lanes_of};
use super::problem::Problem;
use super::random::{Key, LANES, Stream};
use super::scatter::{AnyScatter, Directions, HenyeyGreenstein, Isotropic, Rayleigh, Scatter, Tabulated};

/// Walks the photons of a range; once `stop` is true, it launches no more and ends with the last of those under way.
///
/// Every random number is a function of (seed, photon index): any partition of the range gives the same exits,
/// in another order. `reference_albedo` is the probability of surviving a collision, in [0, 1]; at 1 in a half
/// space the mean number of collisions is infinite. Each photon ends as one exit or as absorbed; one that
/// survives 2³² − 1 collisions counts as absorbed. Of a walk that was stopped, the photons launched are the first of
/// the range.
pub(crate) fn trace_until(
    stop: &AtomicBool,
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut impl FnMut(&[PhotonExit]),
) -> PhotonCounts {
    trace_at_level(Level::new(), stop, problem, reference_albedo, seed, photons, exits)
}

/// [`trace_until`] the end.
#[cfg(test)]
pub(crate) fn trace(
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut impl FnMut(&[PhotonExit]),
) -> PhotonCounts {
    trace_until(&AtomicBool::new(false), problem, reference_albedo, seed, photons, exits)
}

/// [`trace_until`] with a choice of instruction set.
pub(crate) fn trace_at_level(
    level: Level,
    stop: &AtomicBool,
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut dyn FnMut(&[PhotonExit]),
) -> PhotonCounts {
    let setup = Setup {
        key: Key::new(seed),
        source: PhotonSource::new(problem),
        boundary: Boundary::new(problem),
        collisions_per_unit: mean_per_unit(reference_albedo),
    };
    match problem.law() {
        DeflectionLaw::Isotropic => walk(level, Isotropic, setup, stop, photons, exits),
        DeflectionLaw::HenyeyGreenstein { g } => {
            walk(level, HenyeyGreenstein::new(*g), setup, stop, photons, exits)
        }
        DeflectionLaw::Rayleigh => walk(level, Rayleigh, setup, stop, photons, exits),
        DeflectionLaw::Table(table) => walk(level, Tabulated(table), setup, stop, photons, exits),
    }
}

/// Walks by one phase function. The kernel is compiled apart for each, for media with and without a reflecting
/// boundary, and for each instruction set.
fn walk<'a, P: Scatter + Into<AnyScatter<'a>>>(
    level: Level,
    scatter: P,
    setup: Setup,
    stop: &AtomicBool,
    photons: Range<u64>,
    exits: &mut dyn FnMut(&[PhotonExit]),
) -> PhotonCounts {
    if setup.boundary.matched {
        dispatched!(
            level,
            simd => Walk::<_, _, true>::new(simd, scatter, setup, stop, photons, exits).run(),
            narrow => walk_narrow::<_, true>(simd, scatter.into(), setup, stop, photons, exits)
        )
    } else {
        dispatched!(
            level,
            simd => Walk::<_, _, false>::new(simd, scatter, setup, stop, photons, exits).run(),
            narrow => walk_narrow::<_, false>(simd, scatter.into(), setup, stop, photons, exits)
        )
    }
}

/// [`walk`] with narrow vectors: sixteen lanes of them are so much code that one kernel has to do for all phase functions.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn walk_narrow<S: Simd, const MATCHED: bool>(
    simd: S,
    scatter: AnyScatter<'_>,
    setup: Setup,
    stop: &AtomicBool,
    photons: Range<u64>,
    exits: &mut dyn FnMut(&[PhotonExit]),
) -> PhotonCounts {
    Walk::<_, _, MATCHED>::new(simd, scatter, setup, stop, photons, exits).run()
}

/// −1/ln α: the number of collisions survived is the whole part of this times an exponential variate.
#[allow(clippy::manual_clamp, reason = "`clamp` passes NaN on")]
fn mean_per_unit(reference_albedo: f64) -> f32 {
    // A NaN absorbs at once
    let log = libm::log(reference_albedo.max(0.0).min(1.0));
    (-1.0 / log).min(1e30) as f32
}

/// Constants of a walk.
#[derive(Clone, Copy)]
struct Setup {
    key: Key,
    source: PhotonSource,
    boundary: Boundary,
    collisions_per_unit: f32,
}

/// State of a walk; `MATCHED`: η = 1.
struct Walk<'a, S: Simd, P: Scatter, const MATCHED: bool> {
    simd: S,
    scatter: P,
    setup: Setup,
    /// Set to true, it has no more photons launched.
    stop: &'a AtomicBool,
    /// Photons not launched yet.
    waiting: Range<u64>,
    /// Launched photons that wait for a place.
    pool: Box<Photons>,
    /// Photons under way.
    block: Box<Photons>,
    exits: ExitBuffer<'a>,
    absorbed: u64,
    /// Collisions survived.
    scattered: u64,
}

impl<'a, S: Simd, P: Scatter, const MATCHED: bool> Walk<'a, S, P, MATCHED> {
    fn new(
        simd: S,
        scatter: P,
        setup: Setup,
        stop: &'a AtomicBool,
        waiting: Range<u64>,
        exits: &'a mut dyn FnMut(&[PhotonExit]),
    ) -> Self {
        Self {
            simd,
            scatter,
            setup,
            stop,
            waiting,
            pool: Photons::none(),
            block: Photons::none(),
            exits: ExitBuffer::new(exits),
            absorbed: 0,
            scattered: 0,
        }
    }

    #[inline(always)]
    fn run(mut self) -> PhotonCounts {
        let first = self.waiting.start;
        self.fill_block();
        while self.block.count > 0 {
            let mut first = 0;
            while first < self.block.count {
                self.advance(first);
                first += LANES;
            }
        }
        self.exits.flush();
        let launched = self.waiting.start - first;
        debug_assert_eq!(launched, self.exits.total + self.absorbed);
        PhotonCounts { launched, absorbed: self.absorbed, collisions: self.scattered + self.absorbed }
    }

    /// Fills the block's free places.
    fn fill_block(&mut self) {
        while self.block.count < BLOCK && self.pool_holds(1) {
            self.pool.count -= 1;
            let (to, from) = (self.block.count, self.pool.count);
            self.block.copy_from(to, &self.pool, from);
            self.block.count += 1;
        }
    }

    /// Steps a group until one of its photons reaches a face or its last collision, then sees to those.
    #[inline(always)]
    fn advance(&mut self, first: usize) {
        let (simd, boundary) = (self.simd, self.setup.boundary);
        let present = (self.block.count - first).min(LANES);
        let present_mask = (1u64 << present) - 1;

        let mut photons = Group::load::<P>(simd, &self.block, first);
        let (crossed, last) = loop {
            let words = [photons.streams.next(), photons.streams.next()];
            photons.directions = self.scatter.scatter(simd, photons.directions, words);
            photons.fly(simd);
            photons.left -= 1;
            self.scattered += present as u64;
            let mut crossed = boundary.are_outside(photons.z);
            if !MATCHED {
                crossed = reflect_totally(simd, &boundary, &mut photons, crossed);
            }
            let crossed = crossed.to_bitmask() & present_mask;
            let last = photons.left.simd_eq(0).to_bitmask() & present_mask;
            if crossed | last != 0 {
                break (crossed, last);
            }
        };
        let (left, mut photons) = self.cross(photons, crossed);
        let ended = left | last;
        self.absorbed += u64::from((last & !left).count_ones());

        // Fill the places of those that ended
        let count = ended.count_ones() as usize;
        if self.pool_holds(count) && !is_narrow(simd) {
            self.pool.count -= count;
            let fresh = Group::load::<P>(simd, &self.pool, self.pool.count);
            photons = photons.refill(&fresh, mask32x16::from_bitmask(simd, ended));
            photons.store::<P>(&mut self.block, first);
        } else {
            photons.store::<P>(&mut self.block, first);
            self.fill_one_by_one(first, ended);
        }
    }

    /// Lets photons beyond a face out or reflects them: which of them left, and the group with the others
    /// inside.
    #[inline(always)]
    fn cross(&mut self, mut photons: Group<S>, crossed: u64) -> (u64, Group<S>) {
        let (simd, boundary) = (self.simd, self.setup.boundary);
        if MATCHED {
            if P::REMEMBERS && crossed == 0 {
                return (0, photons);
            }
            self.leave(&photons, crossed);
            return (crossed, photons);
        }
        if crossed == 0 {
            return (0, photons);
        }

        // Draw where chance decides: a stream whose photon does not ask stays where it is
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, crossed);
        let chance = mask & !boundary.interface.reflects_totally(photons.directions.z);
        let mut streams = photons.streams;
        let share = unit(streams.next());
        for (word, after) in photons.streams.0.iter_mut().zip(streams.0) {
            *word = chance.select(after, *word);
        }
        let reflectance = boundary.interface.reflectance(simd, photons.directions.z.abs());
        let passes = chance & share.simd_ge(reflectance);
        let left = passes.to_bitmask();
        self.leave(&photons, left);

        // Mirror the others
        let reflected = mask & !passes;
        photons.z = reflected.select(boundary.mirrored(simd, photons.z), photons.z);
        photons.directions.z = reflected.select(-photons.directions.z, photons.directions.z);
        let outside = (reflected & boundary.are_outside(photons.z)).to_bitmask();
        if outside == 0 {
            return (left, photons);
        }
        let later = self.cross_again_one_by_one(&mut photons, outside, reflectance);
        (left | later, photons)
    }

    /// Lets photons out, each at the face that it is beyond.
    #[inline(always)]
    fn leave(&mut self, photons: &Group<S>, left: u64) {
        let simd = self.simd;
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, left);
        let transmitted = photons.z.simd_ge(0.0);
        let face =
            transmitted.select(Floats::splat(simd, self.setup.boundary.thickness), Floats::splat(simd, 0.0));
        let Directions { x: ux, y: uy, z: uz } = photons.directions;
        let beyond = (photons.z - face) / uz;
        let places =
            [(-beyond).fused_mul_add(ux, photons.x), (-beyond).fused_mul_add(uy, photons.y), uz.abs()];
        let order = photons.budget - photons.left;
        let transmitted = transmitted.select(Words::splat(simd, 1), Words::splat(simd, 0));
        if !is_narrow(simd) {
            self.exits.push(
                places.map(|place| place.compress(mask)),
                [order, transmitted].map(|words| words.compress(mask)),
                left.count_ones() as usize,
            );
        } else {
            for lane in lanes_of(left) {
                self.exits.push_one(places.map(|place| place[lane]), [order[lane], transmitted[lane]]);
            }
        }
    }

    /// Sees to photons whose flight meets more than one face: which of them left.
    #[inline(never)]
    fn cross_again_one_by_one(
        &mut self,
        photons: &mut Group<S>,
        outside: u64,
        reflectance: Floats<S>,
    ) -> u64 {
        let mut left = 0;
        for lane in lanes_of(outside) {
            let directions = &mut photons.directions;
            let mut ray = Ray {
                x: photons.x[lane],
                y: photons.y[lane],
                z: photons.z[lane],
                ux: directions.x[lane],
                uy: directions.y[lane],
                uz: directions.z[lane],
            };
            let mut stream = Stream(photons.streams.0.map(|words| words[lane]));
            let share = (stream.next() | 1) as f32 * (1.0 / 4294967296.0);
            for (words, word) in photons.streams.0.iter_mut().zip(stream.0) {
                words[lane] = word;
            }
            if let Some(side) = self.setup.boundary.cross_again(&mut ray, share, reflectance[lane]) {
                let order = photons.budget[lane] - photons.left[lane];
                let transmitted = u32::from(side == Side::Transmitted);
                self.exits.push_one([ray.x, ray.y, ray.uz.abs()], [order, transmitted]);
                left |= 1 << lane;
            }
            photons.z[lane] = ray.z;
            directions.z[lane] = ray.uz;
        }
        left
    }

    /// Fills places with what fresh photons there are, then with the block's last.
    ///
    /// From the highest lane down, so that the block's last photon is never one that ended.
    #[inline(never)]
    fn fill_one_by_one(&mut self, first: usize, mut ended: u64) {
        while ended != 0 {
            let lane = ended.ilog2() as usize;
            ended ^= 1 << lane;
            if self.pool.count > 0 {
                self.pool.count -= 1;
                self.block.copy_from(first + lane, &self.pool, self.pool.count);
            } else {
                self.block.count -= 1;
                self.block.copy_within(first + lane, self.block.count);
            }
        }
    }

    /// Returns whether so many photons are in the pool, after launching if need be.
    #[inline(always)]
    fn pool_holds(&mut self, count: usize) -> bool {
        if self.pool.count < count && !self.waiting.is_empty() {
            self.launch();
        }
        self.pool.count >= count
    }

    /// Fills the pool up.
    #[inline(never)]
    fn launch(&mut self) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || {
                // At low albedos the pool stays empty: a walk is stopped here or not at all
                while self.pool.count <= BLOCK - LANES
                    && !self.waiting.is_empty()
                    && !self.stop.load(Ordering::Relaxed)
                {
                    self.launch_group();
                }
            },
        );
    }

    /// Walks sixteen photons up to their first collision and adds those that survive it to the pool.
    #[inline(always)]
    fn launch_group(&mut self) {
        let Setup { key, source, boundary, collisions_per_unit } = self.setup;
        let simd = self.simd;
        let index = self.waiting.start;
        let count = (self.waiting.end - index).min(LANES as u64);
        self.waiting.start += count;

        // Draw number of collisions, direction and position
        let mut streams = Stream::of_16(simd, key, index);
        let tries = exponential(simd, streams.next()).max(1e-10) * collisions_per_unit;
        let budget: Words<S> = tries.min(4_294_967_040.0).to_int();
        let directions = source.directions(simd, &mut streams);
        let (x, y) = source.positions(simd, &mut streams);

        // Fly to the first collision, or through a slab
        let z = Floats::splat(simd, 0.0);
        let mut photons = Group { x, y, z, directions, streams, left: budget, budget };
        photons.fly(simd);
        let mut inside = (1 << count) - 1;
        let crossed = boundary.are_outside(photons.z).to_bitmask() & inside;
        if crossed != 0 {
            let (left, others) = self.cross(photons, crossed);
            photons = others;
            inside &= !left;
        }

        // Keep those that survive it
        let survive = budget.simd_gt(0).to_bitmask() & inside;
        self.absorbed += u64::from((inside & !survive).count_ones());
        let end = self.pool.count;
        if !is_narrow(simd) {
            let survivors = photons.compress(mask32x16::from_bitmask(simd, survive));
            survivors.store::<P>(&mut self.pool, end);
        } else {
            photons.store::<P>(&mut self.pool, end);
            for (to, from) in lanes_of(survive).enumerate() {
                self.pool.copy_within(end + to, end + from);
            }
        }
        self.pool.count += survive.count_ones() as usize;
    }
}

/// Mirrors photons that the face reflects totally, where one reflection brings them inside; the photons beyond
/// a face that remain.
#[inline(always)]
fn reflect_totally<S: Simd>(
    simd: S,
    boundary: &Boundary,
    photons: &mut Group<S>,
    crossed: mask32x16<S>,
) -> mask32x16<S> {
    let uz = photons.directions.z;
    let mirrored = boundary.mirrored(simd, photons.z);
    let inside = crossed & boundary.interface.reflects_totally(uz) & !boundary.are_outside(mirrored);
    photons.z = inside.select(mirrored, photons.z);
    photons.directions.z = inside.select(-uz, uz);
    crossed & !inside
}

#[cfg(test)]
mod laws;
