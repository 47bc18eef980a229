//! The walk through a half space or a slab, whose photons end as exits or are absorbed.
//!
//! Absorption is not drawn at each collision, but once per photon as a geometric number: the collision that absorbs is known
//! beforehand, and no lane of the [kernel](super::kernel) scatters in vain.
//!
//! CPU times in ns at albedo ½ per photon and at 0.9 and 0.999 per collision, isotropic and index-matched, on an EPYC of
//! 2022 with AVX-512, as `cargo bench -p translucid-reference --bench walk -- 'g=0 eta=1 '` prints them:
//!
//! | | ½ | 0.9 | 0.999 |
//! |---|---|---|---|
//! | `kernel`: the widest instructions, here AVX-512 | 6.0 | 2.62 | 1.44 |
//! | `AVX2` | 9.3 | 4.65 | 2.20 |
//! | `baseline`: SSE2, multiply-adds called, refills one photon at a time, one kernel for all phase functions | 62 | 32.8 | 31.6 |

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, mask32x16};

use super::boundary::{Beyond, Face, Medium};
use super::exit_buffer::ExitBuffer;
use super::kernel::{Setup, Tally, Walked, walk};
use super::lanes::{Floats, Words, exponential};
use super::photon_exit::{PhotonCounts, PhotonExit};
use super::photon_source::PhotonSource;
use super::photons::Group;
use super::problem::Problem;
use super::random::{Key, Stream};

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
    let parameters = problem.parameters();
    let face = Face::new(parameters.eta, Beyond::Outside);
    // A slab thinner than single precision can say is the thinnest it can say
    let thickness = (parameters.thickness as f32).max(f32::MIN_POSITIVE);
    let medium = Medium { mfp: 1.0, thickness, top: 0.0, absorbed: 0.0, above: face, below: face };
    let setup = Setup {
        media: &[medium],
        laws: std::slice::from_ref(problem.law()),
        key: Key::new(seed),
        source: PhotonSource::new(problem),
        first: 0,
    };
    let tally = Exits {
        collisions_per_unit: mean_per_unit(reference_albedo),
        buffer: ExitBuffer::new(exits),
        absorbed: 0,
    };
    let Walked { mut tally, launched, collisions } = match face.is_matched() {
        true => walk::<_, true>(level, &setup, stop, photons, tally),
        false => walk::<_, false>(level, &setup, stop, photons, tally),
    };
    tally.buffer.flush();
    debug_assert_eq!(launched, tally.buffer.total + tally.absorbed);
    PhotonCounts { launched, absorbed: tally.absorbed, collisions }
}

/// −1/ln α: the number of collisions survived is the whole part of this times an exponential variate.
#[allow(clippy::manual_clamp, reason = "`clamp` passes NaN on")]
fn mean_per_unit(reference_albedo: f64) -> f32 {
    // A NaN absorbs at once
    let log = libm::log(reference_albedo.max(0.0).min(1.0));
    (-1.0 / log).min(1e30) as f32
}

/// Exits, and photons that were absorbed; a photon's `budget` are the collisions that it survives in all.
struct Exits<'a> {
    collisions_per_unit: f32,
    buffer: ExitBuffer<'a>,
    absorbed: u64,
}

impl Tally for Exits<'_> {
    const WEIGHTS: bool = false;

    #[inline(always)]
    fn start<S: Simd>(&mut self, simd: S, streams: &mut Stream<Words<S>>, _: usize) -> [Words<S>; 2] {
        let tries = exponential(simd, streams.next()).max(1e-10) * self.collisions_per_unit;
        [tries.min(4_294_967_040.0).to_int(); 2]
    }

    #[inline(always)]
    fn collide<S: Simd>(&mut self, _: S, _: usize, photons: &mut Group<S>, _: Floats<S>, mask: u64) -> u64 {
        let last = photons.left.simd_eq(0).to_bitmask() & mask;
        self.absorbed += u64::from(last.count_ones());
        last
    }

    #[inline(always)]
    fn leave<S: Simd>(&mut self, simd: S, _: &Face, down: mask32x16<S>, photons: &Group<S>, mask: u64) {
        let lanes: mask32x16<S> = mask32x16::from_bitmask(simd, mask);
        let side = down.select(Words::splat(simd, 1), Words::splat(simd, 0));
        let order = photons.budget - photons.left;
        self.buffer.push(
            [photons.x, photons.y, photons.directions.z.abs()].map(|place| place.compress(lanes)),
            [order, side].map(|words| words.compress(lanes)),
            mask.count_ones() as usize,
        );
    }

    #[cold]
    fn give_up<S: Simd>(&mut self, _: usize, _: &Group<S>, _: Floats<S>, mask: u64) {
        self.absorbed += u64::from(mask.count_ones());
    }
}

#[cfg(test)]
mod laws;
