//! Photons with weights, of which every collision leaves a part in its layer.
//!
//! A photon of little weight is by chance ended or given a greater weight. Where several absorptions are asked for,
//! collisions absorb nothing, and each photon has a weight for each of them, which its way through a layer lowers when it
//! leaves the layer, and now and then; see `many_weights`.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, mask32x16};

use super::grid::{Places, Quantity};
use super::many_weights::{Absorptions, ManyWeights};
use super::medium::Cells;
use super::tally::Batch;
use crate::walk::boundary::{Face, Medium, draw};
use crate::walk::deflection_table::DeflectionLaw;
use crate::walk::edge_search::EdgeSearch;
use crate::walk::kernel::{self, Tally, Walked};
use crate::walk::lanes::{Floats, FusedMulAdd, Words};
use crate::walk::photon_source::PhotonSource;
use crate::walk::photons::{BLOCK, Group, lanes_of};
use crate::walk::random::{Key, LANES, Stream};

/// Weight below which a photon is ended by chance.
const FAINT: f32 = 1e-3;
/// Chance to go on then, with a weight that makes up for it.
const SURVIVAL: f32 = 0.125;
/// Collisions after which a photon is given up.
const MOST_COLLISIONS: u32 = 1 << 24;
/// Collisions after which a way through a layer counts, where there are several absorptions.
const STEPS: u32 = 32;

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
    let Setup { media, laws, key, source, first, .. } = setup;
    let constants = kernel::Setup { media, laws, key: *key, source: *source, first: *first };
    let number = photons.end - photons.start;
    let weights = Weights::new(setup);
    let Walked { tally, collisions, .. } =
        kernel::walk::<_, false>(level, &constants, stop, photons, weights);
    let is_whole = !stop.load(Ordering::Relaxed);
    is_whole.then(|| Batch { photons: number, collisions, sums: tally.into_sums() })
}

/// Weights and what they left; a photon's `budget` has the bits of its weight, or the place of several.
struct Weights<'a> {
    setup: &'a Setup,
    /// Sums by quantity.
    sums: Vec<f64>,
    /// Weight that each layer absorbed, lane by lane.
    absorbed: Vec<[f64; LANES]>,
    many: Option<ManyWeights<'a>>,
}

impl<'a> Weights<'a> {
    fn new(setup: &'a Setup) -> Self {
        let many = setup.absorptions.as_ref().map(|sets| ManyWeights::new(sets, &setup.places, BLOCK));
        let sums = vec![0.0; setup.places.count()];
        Self { setup, sums, absorbed: vec![[0.0; LANES]; setup.media.len()], many }
    }

    fn into_sums(mut self) -> Vec<f64> {
        let layers = self.setup.places.of(Quantity::AbsorbedByLayer);
        for (sum, lanes) in self.sums[layers].iter_mut().zip(&self.absorbed) {
            *sum = lanes.iter().sum();
        }
        self.many.map_or(self.sums, |many| many.sums)
    }

    /// Counts absorbed light where it is.
    #[inline(always)]
    fn deposit<S: Simd>(
        &mut self,
        simd: S,
        medium: &Medium,
        photons: &Group<S>,
        lost: Floats<S>,
        mask: mask32x16<S>,
    ) {
        let (cells, zero) = (&self.setup.cells, Floats::splat(simd, 0.0));
        let rings = radius(photons) * cells.rings_per_unit;
        let depths = (photons.z + medium.top) * cells.depths_per_unit;
        // Lanes without a photon may be anywhere
        let rings: Words<S> = mask.select(rings.min(cells.last_ring), zero).to_int();
        let depths: Words<S> = mask.select(depths.min(cells.last_depth), zero).to_int();
        let indices = rings * (self.setup.places.grid.nz as u32) + depths;
        let sums = &mut self.sums[self.setup.places.of(Quantity::AbsorbedByRingAndDepth)];
        for (index, lost) in indices.to_array().into_iter().zip(lost.to_array()) {
            sums[index as usize] += f64::from(lost);
        }
    }

    /// Ends photons of little weight by chance; which of them.
    #[inline(always)]
    fn roulette<S: Simd>(simd: S, photons: &mut Group<S>, mask: u64) -> u64 {
        let weights: Floats<S> = photons.budget.bitcast();
        let faint = weights.simd_lt(FAINT).to_bitmask() & mask;
        if faint == 0 {
            return 0;
        }
        let mask: mask32x16<S> = mask32x16::from_bitmask(simd, faint);
        let survives = draw(photons, mask).simd_le(SURVIVAL);
        photons.budget = (mask & survives).select(weights * (1.0 / SURVIVAL), weights).bitcast();
        faint & !survives.to_bitmask()
    }

    /// [`roulette`](Self::roulette) of photons with several weights, by the greatest.
    #[inline(never)]
    fn roulette_of_many<S: Simd>(&mut self, simd: S, photons: &mut Group<S>, mask: u64) -> u64 {
        let Some(many) = &mut self.many else { return 0 };
        let faint = many.faint(mask, photons.budget.to_array(), FAINT);
        if faint == 0 {
            return 0;
        }
        let faint_lanes: mask32x16<S> = mask32x16::from_bitmask(simd, faint);
        let survives = draw(photons, faint_lanes).simd_le(SURVIVAL).to_bitmask();
        many.scale(faint & survives, photons.budget.to_array(), 1.0 / SURVIVAL);
        let ended = faint & !survives;
        many.end(ended, photons.budget.to_array());
        ended
    }
}

impl Tally for Weights<'_> {
    const WEIGHTS: bool = true;

    #[inline(always)]
    fn start<S: Simd>(&mut self, simd: S, _: &mut Stream<Words<S>>, count: usize) -> [Words<S>; 2] {
        let budget = match &mut self.many {
            Some(many) => Words::from_slice(simd, &many.begin(count)),
            None => Floats::splat(simd, 1.0).bitcast(),
        };
        [Words::splat(simd, MOST_COLLISIONS - 1), budget]
    }

    #[inline(always)]
    fn collide<S: Simd>(
        &mut self,
        simd: S,
        layer: usize,
        photons: &mut Group<S>,
        flight: Floats<S>,
        mask: u64,
    ) -> u64 {
        let medium = &self.setup.media[layer];
        let mut gone = 0;
        if let Some(many) = &mut self.many {
            many.fly(mask, photons.budget.to_array(), flight.to_array());
            let due = (photons.left & (STEPS - 1)).simd_eq(0).to_bitmask() & mask;
            if due != 0 {
                many.absorb(layer, due, photons.budget.to_array(), [0.0; LANES]);
                gone = self.roulette_of_many(simd, photons, due);
            }
        } else if medium.absorbed > 0.0 {
            let weights: Floats<S> = photons.budget.bitcast();
            let lanes: mask32x16<S> = mask32x16::from_bitmask(simd, mask);
            let lost = lanes.select(weights * medium.absorbed, Floats::splat(simd, 0.0));
            photons.budget = (weights - lost).bitcast();
            for (sum, lost) in self.absorbed[layer].iter_mut().zip(lost.to_array()) {
                *sum += f64::from(lost);
            }
            if self.setup.places.grid.has_map() {
                self.deposit(simd, medium, photons, lost, lanes);
            }
            gone = Self::roulette(simd, photons, mask);
        }
        let worn = photons.left.simd_eq(0).to_bitmask() & mask & !gone;
        if worn != 0 {
            self.give_up(layer, photons, Floats::splat(simd, 0.0), worn);
        }
        gone | worn
    }

    #[inline(always)]
    fn travel<S: Simd>(&mut self, layer: usize, photons: &Group<S>, ways: Floats<S>, mask: u64) {
        if let Some(many) = &mut self.many {
            many.absorb(layer, mask, photons.budget.to_array(), ways.to_array());
        }
    }

    #[inline(always)]
    fn leave<S: Simd>(&mut self, simd: S, face: &Face, down: mask32x16<S>, photons: &Group<S>, mask: u64) {
        let weights: Floats<S> = photons.budget.bitcast();
        let downwards = down.to_bitmask() & mask != 0;
        let cells =
            if downwards { Quantity::TransmittedByRingAndAngle } else { Quantity::ReflectedByRingAndAngle };
        let start = self.setup.places.of(cells).start;
        let angles = self.setup.places.grid.na;
        let rings = (radius(photons) * self.setup.cells.rings_per_unit).min(self.setup.cells.last_ring);
        let cosines = face.refracted(simd, photons.directions).z.abs();
        let (rings, cosines, weights) = (rings.to_array(), cosines.to_array(), weights.to_array());
        for lane in lanes_of(mask) {
            let angle = if angles == 1 {
                0
            } else {
                angles - 1 - self.setup.cosines.count_up_to(f64::from(cosines[lane]))
            };
            let place = start + rings[lane] as usize * angles + angle;
            match &mut self.many {
                Some(many) => many.add(photons.budget[lane], place, 1.0),
                None => self.sums[place] += f64::from(weights[lane]),
            }
        }
        if let Some(many) = &mut self.many {
            many.end(mask, photons.budget.to_array());
        }
    }

    #[inline(never)]
    fn meet_ground<S: Simd>(&mut self, simd: S, reflectance: f32, photons: &mut Group<S>, mask: u64) -> u64 {
        let start = self.setup.places.of(Quantity::Ground).start;
        let budget = photons.budget.to_array();
        if let Some(many) = &mut self.many {
            lanes_of(mask).for_each(|lane| many.add(budget[lane], start, 1.0 - reflectance));
            many.scale(mask, budget, reflectance);
            if reflectance == 0.0 {
                many.end(mask, budget);
                return 0;
            }
            return mask & !self.roulette_of_many(simd, photons, mask);
        }
        let weights: Floats<S> = photons.budget.bitcast();
        let kept = weights * reflectance;
        let absorbed = (weights - kept).to_array();
        self.sums[start] += lanes_of(mask).map(|lane| f64::from(absorbed[lane])).sum::<f64>();
        photons.budget = kept.bitcast();
        if reflectance == 0.0 { 0 } else { mask & !Self::roulette(simd, photons, mask) }
    }

    #[cold]
    #[inline(never)]
    fn give_up<S: Simd>(&mut self, layer: usize, photons: &Group<S>, ways: Floats<S>, mask: u64) {
        let lost = self.setup.places.of(Quantity::Lost).start;
        if let Some(many) = &mut self.many {
            let places = photons.budget.to_array();
            many.absorb(layer, mask, places, ways.to_array());
            lanes_of(mask).for_each(|lane| many.add(places[lane], lost, 1.0));
            many.end(mask, places);
            return;
        }
        let weights: Floats<S> = photons.budget.bitcast();
        self.sums[lost] += lanes_of(mask).map(|lane| f64::from(weights[lane])).sum::<f64>();
    }
}

/// Distance from the axis.
#[inline(always)]
fn radius<S: Simd>(photons: &Group<S>) -> Floats<S> {
    photons.x.fused_mul_add(photons.x, photons.y * photons.y).sqrt()
}
