//! Kernel of the walk through layers.
//!
//! ```text
//! for each photon of the range, all random numbers from its own stream:
//!     draw where and in which direction it starts in the first layer
//!     loop:
//!         fly an exponential distance, or to the next face if that is nearer:
//!             by chance through it, refracted, into the next layer or out; or reflected, to fly the rest
//!         leave the layer a part of its weight, absorption over extinction
//!         where the weight is small: by chance ended, or given a greater weight
//!         deflect
//! ```
//!
//! Departures of the code from this:
//!
//! 1. Sixteen photons walk at a time in the lanes of vectors, all of them in one layer, whose figures are constants.
//! 2. Every layer has a stack of photons that are about to fly. A group of sixteen takes its photons from a stack and
//!    fills the places of those that leave the layer or end from it. When the stack is empty, the group is put back, and
//!    the layer with the most photons is next.
//! 3. Reflection mirrors the end of the flight, where it then lies inside. Between two faces that both reflect
//!    totally a flight is folded at once, however many reflections it has.
//! 4. At a face to another layer the rest of the flight is forgotten: an exponential distance has no memory.
//! 5. Where several absorptions are asked for, collisions absorb nothing, and each photon has a weight for each of them,
//!    which its way through a layer lowers when it leaves the layer, and now and then; see `many_weights`.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, mask32x16};

use super::grid::{Places, Quantity};
use super::many_weights::{Absorptions, ManyWeights};
use super::medium::{Beyond, Cells, Face, Medium};
use super::tally::Batch;
use crate::walk::Side;
use crate::walk::deflection_table::DeflectionLaw;
use crate::walk::edge_search::EdgeSearch;
use crate::walk::instruction_sets::dispatched;
use crate::walk::lanes::{Floats, FusedMulAdd, Words, circle, complement, exponential, unit};
use crate::walk::photon_source::PhotonSource;
use crate::walk::photons::{BLOCK, Group, Photons, lanes_of};
use crate::walk::random::{Key, LANES, Stream};
use crate::walk::scatter::{
    AnyScatter, Directions, HenyeyGreenstein, Isotropic, Rayleigh, Scatter, Tabulated,
};

/// Weight below which a photon is ended by chance.
const FAINT: f32 = 1e-3;
/// Chance to go on then, with a weight that makes up for it.
const SURVIVAL: f32 = 0.125;
/// Collisions after which a photon is given up.
const MOST_COLLISIONS: u32 = 1 << 24;
/// Faces that a flight meets before its rest is folded between two of them.
const FACES: u32 = 8;
/// Faces that a flight meets before it is given up.
const MOST_FACES: u32 = 100_000;
/// Steps after which a sum of a vector goes into one of double precision.
const STEPS: u32 = 32;
/// Least cosine of refracted light.
const GRAZING: f32 = 1e-6;

/// Constants of a walk.
pub(super) struct Setup {
    pub(super) media: Vec<Medium>,
    /// How each of them deflects.
    pub(super) laws: Vec<DeflectionLaw>,
    pub(super) cells: Cells,
    pub(super) places: Places,
    /// Cosines between angles.
    pub(super) cosines: EdgeSearch,
    pub(super) key: Key,
    pub(super) source: PhotonSource,
    /// Layer in which photons start.
    pub(super) first: usize,
    /// Absorptions that are walked at once, in media without absorption.
    pub(super) absorptions: Option<Absorptions>,
}

/// Walks the photons of a range; nothing if `stop` became true.
pub(super) fn walk(level: Level, setup: &Setup, stop: &AtomicBool, photons: Range<u64>) -> Option<Batch> {
    dispatched!(
        level,
        simd => Walk::new(simd, setup, stop, photons.clone()).run::<false>(),
        narrow => walk_narrow(simd, setup, stop, photons.clone())
    )
}

/// [`walk`] with narrow vectors, and one kernel for all phase functions.
#[cfg(target_arch = "x86_64")]
#[inline(never)]
fn walk_narrow<S: Simd>(simd: S, setup: &Setup, stop: &AtomicBool, photons: Range<u64>) -> Option<Batch> {
    Walk::new(simd, setup, stop, photons).run::<true>()
}

struct Walk<'a, S: Simd> {
    simd: S,
    setup: &'a Setup,
    stop: &'a AtomicBool,
    /// Photons not launched yet.
    waiting: Range<u64>,
    /// Photons about to fly, by layer; `left` counts the collisions to come, `budget` has the bits of the weight, or the
    /// place of several.
    stacks: Vec<Box<Photons>>,
    /// Photons launched that have not ended.
    under_way: usize,
    batch: Batch,
    many: Option<ManyWeights<'a>>,
}

impl<'a, S: Simd> Walk<'a, S> {
    #[inline(always)]
    fn new(simd: S, setup: &'a Setup, stop: &'a AtomicBool, waiting: Range<u64>) -> Self {
        let stacks = setup.media.iter().map(|_| Photons::none()).collect();
        let many = setup.absorptions.as_ref().map(|sets| ManyWeights::new(sets, &setup.places, BLOCK));
        let sums = vec![0.0; if many.is_some() { 0 } else { setup.places.count() }];
        let batch = Batch { photons: waiting.end - waiting.start, collisions: 0, sums };
        Self { simd, setup, stop, waiting, stacks, under_way: 0, batch, many }
    }

    #[inline(always)]
    fn run<const NARROW: bool>(mut self) -> Option<Batch> {
        loop {
            let (mut layer, mut count) = self.fullest();
            if count < LANES && self.launch() {
                (layer, count) = self.fullest();
            }
            if self.stop.load(Ordering::Relaxed) {
                return None;
            }
            if count == 0 {
                let sums = self.many.map_or(self.batch.sums, |many| many.sums);
                return Some(Batch { sums, ..self.batch });
            }
            let setup = self.setup;
            match &setup.laws[layer] {
                DeflectionLaw::Isotropic if !NARROW => self.work(layer, Isotropic),
                DeflectionLaw::Isotropic => self.work(layer, AnyScatter::from(HenyeyGreenstein::new(0.0))),
                DeflectionLaw::HenyeyGreenstein { g } if !NARROW => {
                    self.work(layer, HenyeyGreenstein::new(*g));
                }
                DeflectionLaw::HenyeyGreenstein { g } => {
                    self.work(layer, AnyScatter::from(HenyeyGreenstein::new(*g)));
                }
                DeflectionLaw::Rayleigh => self.work(layer, AnyScatter::from(Rayleigh)),
                DeflectionLaw::Table(table) => self.work(layer, AnyScatter::from(Tabulated(table))),
            }
        }
    }

    fn fullest(&self) -> (usize, usize) {
        let counts = self.stacks.iter().map(|stack| stack.count).enumerate();
        counts.max_by_key(|(_, count)| *count).unwrap_or((0, 0))
    }

    /// Launches as many photons as there is room for; whether there were any.
    #[inline(always)]
    fn launch(&mut self) -> bool {
        let before = self.under_way;
        while self.under_way + LANES <= BLOCK && !self.waiting.is_empty() {
            let simd = self.simd;
            let index = self.waiting.start;
            let count = (self.waiting.end - index).min(LANES as u64);
            self.waiting.start += count;
            let mut streams = Stream::of_16(simd, self.setup.key, index);
            let directions = self.setup.source.directions(simd, &mut streams);
            let zero = Floats::splat(simd, 0.0);
            let left = Words::splat(simd, MOST_COLLISIONS);
            let budget = match &mut self.many {
                Some(many) => Words::from_slice(simd, &many.begin(count as usize)),
                None => Floats::splat(simd, 1.0).bitcast(),
            };
            let group = Group { x: zero, y: zero, z: zero, directions, streams, left, budget };
            push(&mut self.stacks[self.setup.first], &group, count as usize);
            self.under_way += count as usize;
        }
        self.under_way > before
    }

    /// Steps photons of a layer until there are no more to fill the places of those that left it.
    #[inline(always)]
    fn work<P: Scatter>(&mut self, layer: usize, scatter: P) {
        let (simd, medium) = (self.simd, self.setup.media[layer]);
        let stack = &mut self.stacks[layer];
        let present = stack.count.min(LANES);
        stack.count -= present;
        let mut photons = load(simd, stack, stack.count);
        let all = (1u64 << present) - 1;
        let zero = Floats::splat(simd, 0.0);
        let (mut absorbed, mut steps) = (zero, 0);
        loop {
            // Fly
            let flight = exponential(simd, photons.streams.next()) * medium.mfp;
            let start = [photons.x, photons.y, photons.z, photons.directions.z];
            photons.z = flight.fused_mul_add(photons.directions.z, photons.z);
            let crossed = reflect_totally(simd, &medium, &mut photons);
            photons.x = flight.fused_mul_add(photons.directions.x, photons.x);
            photons.y = flight.fused_mul_add(photons.directions.y, photons.y);
            let crossed = crossed.to_bitmask() & all;
            let mut gone =
                if crossed == 0 { 0 } else { self.cross(layer, start, flight, &mut photons, crossed) };

            // Collide
            let collides = all & !gone;
            self.batch.collisions += u64::from(collides.count_ones());
            if let Some(many) = &mut self.many {
                many.fly(collides, photons.budget.to_array(), flight.to_array());
                let due = (photons.left & (STEPS - 1)).simd_eq(1).to_bitmask() & collides;
                if due != 0 {
                    many.absorb(layer, due, photons.budget.to_array(), [0.0; LANES]);
                    gone |= self.roulette_of_many(&mut photons, due);
                }
            }
            if medium.absorbed > 0.0 {
                let weights: Floats<S> = photons.budget.bitcast();
                let mask: mask32x16<S> = mask32x16::from_bitmask(simd, collides);
                let lost = mask.select(weights * medium.absorbed, zero);
                let weights = weights - lost;
                photons.budget = weights.bitcast();
                absorbed += lost;
                if self.setup.places.grid.has_map() {
                    self.deposit(&medium, &photons, lost, mask);
                }
                let faint = weights.simd_lt(FAINT).to_bitmask() & collides;
                if faint != 0 {
                    gone |= self.roulette(&mut photons, faint);
                }
            }
            photons.left -= 1;
            let worn = photons.left.simd_eq(0).to_bitmask() & all & !gone;
            if worn != 0 {
                self.give_up(layer, photons.budget, [0.0; LANES], worn);
                gone |= worn;
            }
            photons.directions = {
                let words = [photons.streams.next(), photons.streams.next()];
                scatter.scatter(simd, photons.directions, words)
            };
            steps += 1;
            if steps % STEPS == 0 {
                self.add_absorbed(layer, absorbed);
                absorbed = zero;
            }

            // Fill the places of those that are gone
            if gone == 0 {
                continue;
            }
            let stack = &mut self.stacks[layer];
            let count = gone.count_ones() as usize;
            if stack.count >= count {
                stack.count -= count;
                let fresh = load(simd, stack, stack.count);
                photons = photons.refill(&fresh, mask32x16::from_bitmask(simd, gone));
            } else {
                let rest = all & !gone;
                let photons = photons.compress(mask32x16::from_bitmask(simd, rest));
                push(stack, &photons, rest.count_ones() as usize);
                break;
            }
        }
        self.add_absorbed(layer, absorbed);
    }

    fn add_absorbed(&mut self, layer: usize, absorbed: Floats<S>) {
        let sum: f64 = absorbed.to_array().iter().map(|value| f64::from(*value)).sum();
        if self.many.is_none() {
            self.batch.sums[self.setup.places.of(Quantity::AbsorbedByLayer).start + layer] += sum;
        }
    }

    /// Counts absorbed light where it is.
    #[inline(always)]
    fn deposit(&mut self, medium: &Medium, photons: &Group<S>, lost: Floats<S>, mask: mask32x16<S>) {
        let (cells, zero) = (&self.setup.cells, Floats::splat(self.simd, 0.0));
        let rings = radius(photons.x, photons.y) * cells.rings_per_unit;
        let depths = (photons.z + medium.top) * cells.depths_per_unit;
        // Lanes without a photon may be anywhere
        let rings: Words<S> = mask.select(rings.min(cells.last_ring), zero).to_int();
        let depths: Words<S> = mask.select(depths.min(cells.last_depth), zero).to_int();
        let indices = rings * (self.setup.places.grid.nz as u32) + depths;
        let sums = &mut self.batch.sums[self.setup.places.of(Quantity::AbsorbedByRingAndDepth)];
        for (index, lost) in indices.to_array().into_iter().zip(lost.to_array()) {
            sums[index as usize] += f64::from(lost);
        }
    }

    /// Ends photons of little weight by chance; which of them.
    #[inline(always)]
    fn roulette(&mut self, photons: &mut Group<S>, faint: u64) -> u64 {
        let simd = self.simd;
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, faint);
        let survives = draw(photons, mask).simd_le(SURVIVAL);
        let weights: Floats<S> = photons.budget.bitcast();
        photons.budget = (mask & survives).select(weights * (1.0 / SURVIVAL), weights).bitcast();
        let ended = faint & !survives.to_bitmask();
        self.under_way -= ended.count_ones() as usize;
        ended
    }

    /// [`roulette`](Self::roulette) of photons with several weights, by the greatest.
    #[inline(never)]
    fn roulette_of_many(&mut self, photons: &mut Group<S>, mask: u64) -> u64 {
        let Some(many) = &mut self.many else { return 0 };
        let faint = many.faint(mask, photons.budget.to_array(), FAINT);
        if faint == 0 {
            return 0;
        }
        let faint_lanes: mask32x16<S> = mask32x16::from_bitmask(self.simd, faint);
        let survives = draw(photons, faint_lanes).simd_le(SURVIVAL).to_bitmask();
        many.scale(faint & survives, photons.budget.to_array(), 1.0 / SURVIVAL);
        let ended = faint & !survives;
        many.end(ended, photons.budget.to_array());
        self.under_way -= ended.count_ones() as usize;
        ended
    }

    /// Gives photons up; those with several weights after one more way in the layer.
    #[cold]
    #[inline(never)]
    fn give_up(&mut self, layer: usize, weights: Words<S>, ways: [f32; LANES], worn: u64) {
        self.under_way -= worn.count_ones() as usize;
        if let Some(many) = &mut self.many {
            many.absorb(layer, worn, weights.to_array(), ways);
            let lost = self.setup.places.of(Quantity::Lost).start;
            lanes_of(worn).for_each(|lane| many.add(weights[lane], lost, 1.0));
            many.end(worn, weights.to_array());
            return;
        }
        let weights: Floats<S> = weights.bitcast();
        let lost = &mut self.batch.sums[self.setup.places.of(Quantity::Lost).start];
        *lost += lanes_of(worn).map(|lane| f64::from(weights[lane])).sum::<f64>();
    }

    /// Takes photons that fly beyond a face from their start, a place and the cosine, to it, and through it or back; which
    /// of them are gone.
    #[inline(always)]
    fn cross(
        &mut self,
        layer: usize,
        [mut x, mut y, mut z, mut uz]: [Floats<S>; 4],
        flight: Floats<S>,
        photons: &mut Group<S>,
        crossed: u64,
    ) -> u64 {
        let (simd, medium) = (self.simd, self.setup.media[layer]);
        let Directions { x: ux, y: uy, .. } = photons.directions;
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, crossed);
        let (mut rest, mut crossing, mut gone) = (flight, mask, 0);
        // Not flight less rest, of which a clear layer would leave nothing
        let mut way = Floats::splat(simd, 0.0);
        for faces in 0.. {
            // Go to the face
            let down = uz.simd_gt(0.0);
            let face = down.select(Floats::splat(simd, medium.thickness), Floats::splat(simd, 0.0));
            let to_face = ((face - z) / uz).max(0.0);
            x = crossing.select(to_face.fused_mul_add(ux, x), x);
            y = crossing.select(to_face.fused_mul_add(uy, y), y);
            z = crossing.select(face, z);
            way += to_face;

            // Pass it or not
            let passes = passes(simd, &medium, photons, uz, down, crossing);
            let (upwards, downwards) = ((passes & !down).to_bitmask(), (passes & down).to_bitmask());
            if let Some(many) = &mut self.many {
                many.absorb(layer, upwards | downwards, photons.budget.to_array(), way.to_array());
            }
            let on_face = Group { x, y, z, directions: Directions { x: ux, y: uy, z: uz }, ..*photons };
            if upwards != 0 {
                self.pass(layer, &medium.above, on_face, upwards);
            }
            if downwards != 0 {
                self.pass(layer, &medium.below, on_face, downwards);
            }
            gone |= upwards | downwards;
            crossing &= !passes;
            if !crossing.any_true() {
                break;
            }

            // Fly the rest of those reflected
            uz = crossing.select(-uz, uz);
            rest = (rest - to_face).max(0.0);
            let mut end = rest.fused_mul_add(uz, z);
            if faces >= FACES {
                let trapped = crossing & medium.traps(uz);
                let ended = match (faces >= MOST_FACES, medium.is_clear()) {
                    (true, _) => crossing,
                    (_, true) => trapped,
                    _ => mask32x16::splat(simd, false),
                };
                if ended.any_true() {
                    // Without an end, and without a collision
                    let clear = Floats::splat(simd, f32::INFINITY);
                    let ways = if medium.is_clear() { clear } else { way };
                    self.give_up(layer, photons.budget, ways.to_array(), ended.to_bitmask());
                    gone |= ended.to_bitmask();
                    crossing &= !ended;
                }
                let (folded, returns) = fold(simd, &medium, uz, rest);
                end = trapped.select(folded, end);
                uz = (trapped & returns).select(-uz, uz);
            }
            let lands = crossing & !are_outside(&medium, end);
            x = lands.select(rest.fused_mul_add(ux, x), x);
            y = lands.select(rest.fused_mul_add(uy, y), y);
            z = lands.select(end, z);
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
    fn pass(&mut self, from: usize, face: &Face, mut photons: Group<S>, through: u64) {
        let simd = self.simd;
        if !face.is_matched() {
            photons.directions = refracted(simd, face, photons.directions);
        }
        match face.beyond {
            Beyond::Layer(layer) => {
                let entry = if layer < from { self.setup.media[layer].thickness } else { 0.0 };
                photons.z = Floats::splat(simd, entry);
                let photons = photons.compress(mask32x16::from_bitmask(simd, through));
                push(&mut self.stacks[layer], &photons, through.count_ones() as usize);
            }
            Beyond::Outside(side) => {
                let radii = radius(photons.x, photons.y);
                self.leave(side, radii, photons.directions.z.abs(), photons.budget, through);
            }
            Beyond::Ground(reflectance) => self.meet_ground(reflectance, photons, through),
        }
    }

    /// Counts photons that leave.
    #[inline(always)]
    fn leave(&mut self, side: Side, radii: Floats<S>, cosines: Floats<S>, budget: Words<S>, through: u64) {
        let weights: Floats<S> = budget.bitcast();
        let cells = match side {
            Side::Reflected => Quantity::ReflectedByRingAndAngle,
            Side::Transmitted => Quantity::TransmittedByRingAndAngle,
        };
        let start = self.setup.places.of(cells).start;
        let angles = self.setup.places.grid.na;
        let rings = (radii * self.setup.cells.rings_per_unit).min(self.setup.cells.last_ring);
        let (rings, cosines, weights) = (rings.to_array(), cosines.to_array(), weights.to_array());
        for lane in lanes_of(through) {
            let angle = if angles == 1 {
                0
            } else {
                angles - 1 - self.setup.cosines.count_up_to(f64::from(cosines[lane]))
            };
            let place = start + rings[lane] as usize * angles + angle;
            match &mut self.many {
                Some(many) => many.add(budget[lane], place, 1.0),
                None => self.batch.sums[place] += f64::from(weights[lane]),
            }
        }
        if let Some(many) = &mut self.many {
            many.end(through, budget.to_array());
        }
        self.under_way -= through.count_ones() as usize;
    }

    /// Lets the ground absorb its part and return the rest of the light.
    #[inline(never)]
    fn meet_ground(&mut self, reflectance: f32, mut photons: Group<S>, through: u64) {
        let simd = self.simd;
        let start = self.setup.places.of(Quantity::Ground).start;
        let budget = photons.budget;
        if let Some(many) = &mut self.many {
            lanes_of(through).for_each(|lane| many.add(budget[lane], start, 1.0 - reflectance));
            many.scale(through, budget.to_array(), reflectance);
        } else {
            let weights: Floats<S> = budget.bitcast();
            let kept = weights * reflectance;
            let absorbed = weights - kept;
            self.batch.sums[start] += lanes_of(through).map(|lane| f64::from(absorbed[lane])).sum::<f64>();
            photons.budget = kept.bitcast();
        }
        if reflectance == 0.0 {
            if let Some(many) = &mut self.many {
                many.end(through, budget.to_array());
            }
            self.under_way -= through.count_ones() as usize;
            return;
        }
        let cosine = unit(photons.streams.next()).sqrt();
        let (x, y) = circle(simd, photons.streams.next());
        let sine = complement(cosine);
        photons.directions = Directions { x: sine * x, y: sine * y, z: -cosine };
        let mut through = through;
        if self.many.is_some() {
            through &= !self.roulette_of_many(&mut photons, through);
        } else {
            let kept: Floats<S> = photons.budget.bitcast();
            let faint = kept.simd_lt(FAINT).to_bitmask() & through;
            if faint != 0 {
                through &= !self.roulette(&mut photons, faint);
            }
        }
        let photons = photons.compress(mask32x16::from_bitmask(simd, through));
        if let Some(stack) = self.stacks.last_mut() {
            push(stack, &photons, through.count_ones() as usize);
        }
    }
}

/// Adds the first lanes to a stack.
#[inline(always)]
fn push<S: Simd>(stack: &mut Photons, photons: &Group<S>, count: usize) {
    photons.store::<AnyScatter<'_>>(stack, stack.count);
    stack.count += count;
}

/// Sixteen photons from a place on, with their directions.
#[inline(always)]
fn load<S: Simd>(simd: S, stack: &Photons, first: usize) -> Group<S> {
    Group::load::<AnyScatter<'_>>(simd, stack, first)
}

/// Distance from the axis.
#[inline(always)]
fn radius<S: Simd>(x: Floats<S>, y: Floats<S>) -> Floats<S> {
    x.fused_mul_add(x, y * y).sqrt()
}

/// Uniform numbers for the photons of a mask; the streams of others stay where they are.
#[inline(always)]
fn draw<S: Simd>(photons: &mut Group<S>, mask: mask32x16<S>) -> Floats<S> {
    let mut streams = photons.streams;
    let drawn = unit(streams.next());
    for (word, after) in photons.streams.0.iter_mut().zip(streams.0) {
        *word = mask.select(after, *word);
    }
    drawn
}

#[inline(always)]
fn are_outside<S: Simd>(medium: &Medium, z: Floats<S>) -> mask32x16<S> {
    z.simd_lt(0.0) | z.simd_gt(medium.thickness)
}

/// Mirrors photons that the face reflects totally, where one reflection brings them inside; those beyond a face that
/// remain.
#[inline(always)]
fn reflect_totally<S: Simd>(simd: S, medium: &Medium, photons: &mut Group<S>) -> mask32x16<S> {
    let (z, uz) = (photons.z, photons.directions.z);
    let (up, down) = (z.simd_lt(0.0), z.simd_gt(medium.thickness));
    let total = (up & medium.above.interface.reflects_totally(uz))
        | (down & medium.below.interface.reflects_totally(uz));
    let mirrored = up.select(-z, Floats::splat(simd, 2.0 * medium.thickness) - z);
    let inside = total & !are_outside(medium, mirrored);
    photons.z = inside.select(mirrored, z);
    photons.directions.z = inside.select(-uz, uz);
    (up | down) & !inside
}

/// Draws which photons of a mask, each on a face, pass it.
#[inline(always)]
fn passes<S: Simd>(
    simd: S,
    medium: &Medium,
    photons: &mut Group<S>,
    uz: Floats<S>,
    down: mask32x16<S>,
    mask: mask32x16<S>,
) -> mask32x16<S> {
    let (above, below) = (&medium.above, &medium.below);
    if above.is_matched() && below.is_matched() {
        return mask;
    }
    let total =
        (down & below.interface.reflects_totally(uz)) | (!down & above.interface.reflects_totally(uz));
    let matched = match (above.is_matched(), below.is_matched()) {
        (true, _) => mask & !down,
        (_, true) => mask & down,
        _ => mask32x16::splat(simd, false),
    };
    let chance = mask & !total & !matched;
    let share = draw(photons, chance);
    let mu = uz.abs();
    let of = |face: &Face| face.interface.reflectance(simd, mu);
    let reflectance = match (above.is_matched(), below.is_matched()) {
        (true, _) => of(below),
        (_, true) => of(above),
        _ => down.select(of(below), of(above)),
    };
    matched | (chance & share.simd_ge(reflectance))
}

/// Depth at the end of a flight from a face between two that reflect it totally, and whether it then goes the other way:
/// a triangle wave.
#[inline(always)]
fn fold<S: Simd>(simd: S, medium: &Medium, uz: Floats<S>, flight: Floats<S>) -> (Floats<S>, mask32x16<S>) {
    let thickness = Floats::splat(simd, medium.thickness);
    let depth = flight * uz.abs();
    let periods = (depth * (0.5 / medium.thickness)).floor();
    let within = (-periods).fused_mul_add(thickness + thickness, depth).max(0.0);
    let returns = within.simd_gt(thickness);
    let travelled = returns.select(thickness + thickness - within, within).max(0.0);
    (uz.simd_gt(0.0).select(travelled, thickness - travelled), returns)
}

/// Directions refracted at a face, by Snell's law.
#[inline(always)]
fn refracted<S: Simd>(simd: S, face: &Face, Directions { x, y, z }: Directions<S>) -> Directions<S> {
    // 1 − η² (1 − μ²), in a form that keeps its digits near perpendicular light
    let squared =
        (z * z).fused_mul_add(face.eta * face.eta, Floats::splat(simd, (1.0 - face.eta) * (1.0 + face.eta)));
    let cosine = squared.max(GRAZING * GRAZING).min(1.0).sqrt();
    Directions { x: x * face.eta, y: y * face.eta, z: z.simd_gt(0.0).select(cosine, -cosine) }
}
