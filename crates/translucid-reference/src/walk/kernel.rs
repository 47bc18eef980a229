//! Kernel of the walks through a half space, a slab and layers.
//!
//! ```text
//! for each photon of the range, all random numbers from its own stream:
//!     draw where and in which direction it starts in the first layer
//!     loop:
//!         fly an exponential distance, or to the next face if that is nearer:
//!             by chance through it, refracted, into the next layer or out; or reflected, to fly the rest
//!         collide: end, or lose a part of its weight, as the tally has it
//!         deflect
//! ```
//!
//! Departures of the code from this:
//!
//! 1. Sixteen photons walk at a time, in single precision, in the lanes of vectors ([`super::lanes`]), all of them in one
//!    layer, whose figures are constants.
//! 2. The photons of a layer live in a block, a structure of arrays with up to 32 such groups. A group steps in registers
//!    until some of its photons are out or at their end. Then the block's last photons are expanded into the lanes that came
//!    free, so that none idles and nothing is done lane by lane: the block shrinks and stays dense, however long the last
//!    photon lives.
//! 3. Photons are launched when half of all places are free. Those without weights, of which many end at their first
//!    collision, fly there before they join the block, and lie in it about to deflect; others about to fly.
//! 4. At a face to another layer the rest of the flight is forgotten: an exponential distance has no memory. The layer with
//!    the most photons is next.
//! 5. Reflection mirrors the end of a flight, where it then lies inside; where the reflection is total that ends no group's
//!    stay in registers. Between two faces that both reflect totally a flight is folded at once, however many reflections it
//!    has.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, mask32x16};

use super::boundary::{Beyond, Face, Medium};
use super::deflection_table::DeflectionLaw;
use super::instruction_sets::dispatched;
use super::lanes::{Floats, FusedMulAdd, Words, circle, complement, exponential, is_narrow, unit};
use super::photon_source::PhotonSource;
use super::photons::{BLOCK, Group, Photons, lanes_of};
use super::random::{Key, LANES, Stream};
use super::scatter::{AnyScatter, Directions, HenyeyGreenstein, Isotropic, Rayleigh, Scatter, Tabulated};

/// Faces that a flight meets before its rest is folded between two of them.
const FACES: u32 = 8;
/// Faces that a flight meets before it is given up.
const MOST_FACES: u32 = 100_000;

/// Constants of a walk.
pub(crate) struct Setup<'a> {
    pub(crate) media: &'a [Medium],
    /// How each of them deflects.
    pub(crate) laws: &'a [DeflectionLaw],
    pub(crate) key: Key,
    pub(crate) source: PhotonSource,
    /// Layer in which photons start.
    pub(crate) first: usize,
}

/// Fates of photons: masks with a bit for each lane.
pub(crate) trait Tally {
    /// True where every collision changes photons, and there may be several layers; otherwise there is one, whose mean free
    /// path is the unit of length and whose faces are alike, and only `left` counts.
    const WEIGHTS: bool;

    /// Draws `left`, the collisions that photons will survive, and `budget`, what else they carry.
    fn start<S: Simd>(&mut self, simd: S, streams: &mut Stream<Words<S>>, count: usize) -> [Words<S>; 2];

    /// Lets photons collide after a flight in a layer: which of them end.
    fn collide<S: Simd>(
        &mut self,
        simd: S,
        layer: usize,
        photons: &mut Group<S>,
        flight: Floats<S>,
        mask: u64,
    ) -> u64;

    /// Lets photons out through a face that they are on, or its like on the other side, their directions those inside.
    fn leave<S: Simd>(&mut self, simd: S, face: &Face, down: mask32x16<S>, photons: &Group<S>, mask: u64);

    /// Notes what photons have flown in a layer that they leave.
    fn travel<S: Simd>(&mut self, _layer: usize, _photons: &Group<S>, _ways: Floats<S>, _mask: u64) {}

    /// Lets the ground absorb its part: which photons it returns.
    fn meet_ground<S: Simd>(
        &mut self,
        _simd: S,
        _reflectance: f32,
        _photons: &mut Group<S>,
        _mask: u64,
    ) -> u64 {
        0
    }

    /// Gives photons up, after one more way in a layer.
    fn give_up<S: Simd>(&mut self, layer: usize, photons: &Group<S>, ways: Floats<S>, mask: u64);
}

/// A tally after a walk, with the number of photons launched, the first of the range, and of collisions.
pub(crate) struct Walked<T> {
    pub(crate) tally: T,
    pub(crate) launched: u64,
    pub(crate) collisions: u64,
}

/// Walks the photons of a range; `MATCHED`: there is one layer, and all light gets through its faces.
///
/// Once `stop` is true it launches no more photons and ends with the last of those under way, or at once where they have
/// weights.
pub(crate) fn walk<T: Tally, const MATCHED: bool>(
    level: Level,
    setup: &Setup<'_>,
    stop: &AtomicBool,
    photons: Range<u64>,
    tally: T,
) -> Walked<T> {
    dispatched!(
        level,
        simd => Walk::<_, T, MATCHED>::new(simd, setup, stop, photons, tally).run::<false>(),
        narrow => walk_narrow::<_, T, MATCHED>(simd, setup, stop, photons, tally)
    )
}

/// [`walk`] with narrow vectors: sixteen lanes of them are so much code that one kernel has to do for all phase functions.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn walk_narrow<S: Simd, T: Tally, const MATCHED: bool>(
    simd: S,
    setup: &Setup<'_>,
    stop: &AtomicBool,
    photons: Range<u64>,
    tally: T,
) -> Walked<T> {
    Walk::<_, T, MATCHED>::new(simd, setup, stop, photons, tally).run::<true>()
}

struct Walk<'a, S: Simd, T, const MATCHED: bool> {
    simd: S,
    setup: &'a Setup<'a>,
    stop: &'a AtomicBool,
    /// Photons not launched yet.
    waiting: Range<u64>,
    /// Photons of each layer: about to fly where they have weights, otherwise about to deflect.
    blocks: Vec<Box<Photons>>,
    tally: T,
    collisions: u64,
}

impl<'a, S: Simd, T: Tally, const MATCHED: bool> Walk<'a, S, T, MATCHED> {
    #[inline(always)]
    fn new(simd: S, setup: &'a Setup<'a>, stop: &'a AtomicBool, waiting: Range<u64>, tally: T) -> Self {
        let blocks = setup.media.iter().map(|_| Photons::none()).collect();
        Self { simd, setup, stop, waiting, blocks, tally, collisions: 0 }
    }

    #[inline(always)]
    fn run<const NARROW: bool>(mut self) -> Walked<T> {
        let first = self.waiting.start;
        while !(T::WEIGHTS && self.stop.load(Ordering::Relaxed)) {
            if 2 * self.under_way() <= BLOCK && !self.waiting.is_empty() {
                self.fill();
            }
            let counts = self.blocks.iter().map(|block| block.count).enumerate();
            let (layer, count) = counts.max_by_key(|(_, count)| *count).unwrap_or_default();
            if count == 0 {
                break;
            }
            match &self.setup.laws[layer] {
                law if NARROW => self.round(layer, AnyScatter::from(law)),
                DeflectionLaw::Isotropic => self.round(layer, Isotropic),
                DeflectionLaw::HenyeyGreenstein { g } => self.round(layer, HenyeyGreenstein::new(*g)),
                DeflectionLaw::Rayleigh => self.round(layer, Rayleigh),
                DeflectionLaw::Table(table) => self.round(layer, Tabulated(table)),
            }
        }
        Walked { tally: self.tally, launched: self.waiting.start - first, collisions: self.collisions }
    }

    fn under_way(&self) -> usize {
        self.blocks.iter().map(|block| block.count).sum()
    }

    /// Launches photons while there is room, with some to spare for those that a step moves.
    #[inline(never)]
    fn fill(&mut self) {
        let simd = self.simd;
        simd.vectorize(
            #[inline(always)]
            || {
                // At low albedos the block stays empty: a walk is stopped here or not at all
                while self.under_way() + 2 * LANES <= BLOCK
                    && !self.waiting.is_empty()
                    && !self.stop.load(Ordering::Relaxed)
                {
                    self.launch();
                }
            },
        );
    }

    /// Launches sixteen photons; those without weights fly to their first collision.
    #[inline(always)]
    fn launch(&mut self) {
        let (simd, Setup { key, source, first: layer, .. }) = (self.simd, self.setup);
        let index = self.waiting.start;
        let count = (self.waiting.end - index).min(LANES as u64);
        self.waiting.start += count;
        let mask = (1u64 << count) - 1;
        let mut streams = Stream::of_16(simd, *key, index);
        let [left, budget] = self.tally.start(simd, &mut streams, count as usize);
        let directions = source.directions(simd, &mut streams);
        let (x, y) = source.positions(simd, &mut streams);
        let z = Floats::splat(simd, 0.0);
        let mut photons = Group { x, y, z, directions, streams, left, budget };
        if T::WEIGHTS {
            return push::<_, AnyScatter<'_>>(simd, &mut self.blocks[*layer], &photons, mask);
        }
        let medium = self.setup.media[*layer];
        let flown = self.fly(&medium, &mut photons);
        let crossed = flown.crossed.to_bitmask() & mask;
        let gone = if crossed == 0 { 0 } else { self.cross(*layer, &medium, &flown, &mut photons, crossed) };
        let stays = mask & !gone & !self.collide(*layer, &flown, &mut photons, mask & !gone);
        let block = &mut self.blocks[*layer];
        match self.setup.laws[*layer] {
            DeflectionLaw::Isotropic => push::<_, Isotropic>(simd, block, &photons, stays),
            _ => push::<_, AnyScatter<'_>>(simd, block, &photons, stays),
        }
    }

    /// Steps groups of a layer one after the other; the last photons fill the places of others until there are no others.
    #[inline(always)]
    fn round<P: Scatter>(&mut self, layer: usize, scatter: P) {
        let medium = self.setup.media[layer];
        let mut first = 0;
        loop {
            self.advance(layer, &medium, scatter, first);
            first += LANES;
            if first + 2 * LANES > self.blocks[layer].count {
                break;
            }
        }
    }

    /// Steps a group, and fills the places of those that ended or left the layer.
    #[inline(always)]
    fn advance<P: Scatter>(&mut self, layer: usize, medium: &Medium, scatter: P, first: usize) {
        let simd = self.simd;
        let block = &mut self.blocks[layer];
        let present = (block.count - first).min(LANES);
        let mask = (1u64 << present) - 1;
        let mut photons = Self::load::<P>(simd, block, first);
        if present < LANES {
            // The ground may return photons to these places
            block.count = first;
        }
        let mut steps = 0;
        let gone = loop {
            let (flown, crossed) = loop {
                if !T::WEIGHTS {
                    deflect(simd, scatter, &mut photons);
                }
                let flown = self.fly(medium, &mut photons);
                let crossed = flown.crossed.to_bitmask() & mask;
                let last = photons.left.simd_eq(0).to_bitmask() & mask;
                if T::WEIGHTS || crossed | last != 0 {
                    break (flown, crossed);
                }
                steps += 1;
            };
            // A group of isotropic scatterers seldom gets by without a crossing: not worth a branch
            let mut gone = if crossed == 0 && (P::REMEMBERS || !MATCHED) {
                0
            } else {
                self.cross(layer, medium, &flown, &mut photons, crossed)
            };
            gone |= self.collide(layer, &flown, &mut photons, mask & !gone);
            if T::WEIGHTS {
                deflect(simd, scatter, &mut photons);
            }
            // Without weights the loop within is twice as fast if this one has no second turn
            if !T::WEIGHTS || gone != 0 {
                break gone;
            }
        };
        self.collisions += steps * present as u64;

        let count = gone.count_ones() as usize;
        let block = &mut self.blocks[layer];
        if present < LANES {
            let rest = photons.compress(mask32x16::from_bitmask(simd, mask & !gone));
            Self::store::<P>(&rest, block, block.count);
            block.count += present - count;
        } else if block.count >= first + LANES + count && !is_narrow(simd) {
            block.count -= count;
            let fresh = Self::load::<P>(simd, block, block.count);
            let photons = photons.refill(&fresh, mask32x16::from_bitmask(simd, gone));
            Self::store::<P>(&photons, block, first);
        } else {
            Self::store::<P>(&photons, block, first);
            fill_one_by_one(block, first, gone);
        }
    }

    /// Loads photons, whose directions matter if they are about to fly.
    #[inline(always)]
    fn load<P: Scatter>(simd: S, block: &Photons, first: usize) -> Group<S> {
        if T::WEIGHTS {
            Group::load::<AnyScatter<'_>>(simd, block, first)
        } else {
            Group::load::<P>(simd, block, first)
        }
    }

    #[inline(always)]
    fn store<P: Scatter>(photons: &Group<S>, block: &mut Photons, first: usize) {
        if T::WEIGHTS {
            photons.store::<AnyScatter<'_>>(block, first);
        } else {
            photons.store::<P>(block, first);
        }
    }

    /// Flies without regard to faces, but for one that reflects totally.
    #[inline(always)]
    fn fly(&self, medium: &Medium, photons: &mut Group<S>) -> Flown<S> {
        let simd = self.simd;
        let start = [photons.x, photons.y, photons.z];
        let mut flight = exponential(simd, photons.streams.next());
        if T::WEIGHTS {
            flight *= medium.mfp;
        }
        photons.advance(flight);
        let crossed = if MATCHED {
            medium.are_outside(photons.z)
        } else {
            let (z, uz) = (photons.z, photons.directions.z);
            let total = if T::WEIGHTS {
                medium.reflects_totally(z, uz)
            } else {
                medium.above.interface.reflects_totally(uz)
            };
            medium.mirror(simd, photons, total)
        };
        Flown { start, flight, crossed }
    }

    /// Lets photons of a mask collide: which of them end.
    #[inline(always)]
    fn collide(&mut self, layer: usize, flown: &Flown<S>, photons: &mut Group<S>, mask: u64) -> u64 {
        self.collisions += u64::from(mask.count_ones());
        self.tally.collide(self.simd, layer, photons, flown.flight, mask)
    }

    /// Takes photons that have flown beyond a face to it, and through it or back; which of them are gone.
    #[inline(always)]
    fn cross(
        &mut self,
        layer: usize,
        medium: &Medium,
        flown: &Flown<S>,
        photons: &mut Group<S>,
        crossed: u64,
    ) -> u64 {
        let simd = self.simd;
        let zero = Floats::splat(simd, 0.0);
        let Directions { x: ux, y: uy, z: mut uz } = photons.directions;
        // A place on the way, and what is left of it there: in one layer its end, which is known; but the end may be far
        // away, or nowhere, where a layer is thin or clear
        let ([mut x, mut y, mut z], mut rest) =
            if T::WEIGHTS { (flown.start, flown.flight) } else { ([photons.x, photons.y, photons.z], zero) };
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, crossed);
        let (mut crossing, mut gone) = (mask, 0);
        // Not flight less rest, of which a clear layer would leave nothing
        let mut way = zero;
        for faces in 0.. {
            // Go to the face
            let down = uz.simd_gt(0.0);
            let face = down.select(Floats::splat(simd, medium.thickness), zero);
            let to_face = (face - z) / uz;
            let [x_there, y_there] = [to_face.fused_mul_add(ux, x), to_face.fused_mul_add(uy, y)];
            way += to_face;

            // Pass it or not
            let passes = if T::WEIGHTS {
                medium.passes(simd, photons, uz, down, crossing)
            } else {
                medium.above.passes(simd, photons, uz, crossing)
            };
            let left = if MATCHED { crossed } else { passes.to_bitmask() };
            let directions = Directions { x: ux, y: uy, z: uz };
            let there = Group { x: x_there, y: y_there, z: face, directions, ..*photons };
            if T::WEIGHTS {
                self.tally.travel(layer, photons, way, left);
                for (face, towards) in [(&medium.above, !down), (&medium.below, down)] {
                    let through = (passes & towards).to_bitmask();
                    if through != 0 {
                        self.pass(layer, face, down, there, through);
                    }
                }
            } else {
                self.tally.leave(simd, &medium.above, down, &there, left);
            }
            if MATCHED {
                return left;
            }
            gone |= left;
            crossing &= !passes;
            if T::WEIGHTS && !crossing.any_true() {
                break;
            }

            // Fly the rest of those reflected
            uz = crossing.select(-uz, uz);
            rest = (rest - to_face).max(0.0);
            let mut end = if T::WEIGHTS { rest.fused_mul_add(uz, face) } else { face + face - z };
            if faces >= FACES {
                let (trapped, folded, returns) = medium.fold(simd, uz, rest);
                let ended = match (faces >= MOST_FACES, medium.is_clear()) {
                    (true, _) => crossing,
                    (_, true) => crossing & trapped,
                    _ => mask32x16::splat(simd, false),
                };
                if ended.any_true() {
                    // Without an end, and without a collision
                    let clear = Floats::splat(simd, f32::INFINITY);
                    let ways = if medium.is_clear() { clear } else { way };
                    self.tally.give_up(layer, photons, ways, ended.to_bitmask());
                    gone |= ended.to_bitmask();
                    crossing &= !ended;
                }
                end = trapped.select(folded, end);
                uz = (crossing & trapped & returns).select(-uz, uz);
            }
            let lands = crossing & !medium.are_outside(end);
            if T::WEIGHTS {
                x = lands.select(rest.fused_mul_add(ux, x_there), crossing.select(x_there, x));
                y = lands.select(rest.fused_mul_add(uy, y_there), crossing.select(y_there, y));
                z = lands.select(end, crossing.select(face, z));
            } else {
                z = crossing.select(end, z);
                rest = zero;
            }
            crossing &= !lands;
            if !crossing.any_true() {
                break;
            }
        }
        photons.x = mask.select(x, photons.x);
        photons.y = mask.select(y, photons.y);
        photons.z = mask.select(z, photons.z);
        photons.directions.z = mask.select(uz, photons.directions.z);
        gone
    }

    /// Lets photons on a face of a layer through it.
    #[inline(always)]
    fn pass(&mut self, from: usize, face: &Face, down: mask32x16<S>, mut photons: Group<S>, through: u64) {
        let simd = self.simd;
        match face.beyond {
            Beyond::Outside => self.tally.leave(simd, face, down, &photons, through),
            Beyond::Layer(layer) => {
                photons.directions = face.refracted(simd, photons.directions);
                let entry = if layer < from { self.setup.media[layer].thickness } else { 0.0 };
                photons.z = Floats::splat(simd, entry);
                self.arrive(layer, &photons, through);
            }
            Beyond::Ground(reflectance) => {
                let cosine = unit(photons.streams.next()).sqrt();
                let (x, y) = circle(simd, photons.streams.next());
                let sine = complement(cosine);
                photons.directions = Directions { x: sine * x, y: sine * y, z: -cosine };
                let returned = self.tally.meet_ground(simd, reflectance, &mut photons, through);
                self.arrive(from, &photons, returned);
            }
        }
    }

    #[inline(always)]
    fn arrive(&mut self, layer: usize, photons: &Group<S>, mask: u64) {
        push::<_, AnyScatter<'_>>(self.simd, &mut self.blocks[layer], photons, mask);
    }
}

/// A flight, its direction apart.
struct Flown<S: Simd> {
    start: [Floats<S>; 3],
    flight: Floats<S>,
    /// Photons that have flown beyond a face.
    crossed: mask32x16<S>,
}

#[inline(always)]
fn deflect<S: Simd, P: Scatter>(simd: S, scatter: P, photons: &mut Group<S>) {
    let words = [photons.streams.next(), photons.streams.next()];
    photons.directions = scatter.scatter(simd, photons.directions, words);
    photons.left -= 1;
}

/// Adds the lanes of a mask to photons.
#[inline(always)]
fn push<S: Simd, P: Scatter>(simd: S, photons: &mut Photons, group: &Group<S>, mask: u64) {
    let end = photons.count;
    if is_narrow(simd) {
        group.store::<P>(photons, end);
        lanes_of(mask).enumerate().for_each(|(to, from)| photons.copy_within(end + to, end + from));
    } else {
        group.compress(mask32x16::from_bitmask(simd, mask)).store::<P>(photons, end);
    }
    photons.count += mask.count_ones() as usize;
}

/// Fills places of a group with the block's last photons.
///
/// From the highest lane down, so that the block's last photon is never one that ended.
#[inline(never)]
fn fill_one_by_one(block: &mut Photons, first: usize, mut ended: u64) {
    while ended != 0 {
        let lane = ended.ilog2() as usize;
        ended ^= 1 << lane;
        block.count -= 1;
        block.copy_within(first + lane, block.count);
    }
}
