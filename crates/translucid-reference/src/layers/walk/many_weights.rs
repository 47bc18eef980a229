//! Photons with a weight for each of several absorptions.
//!
//! In media that differ in absorption alone, photons go the same ways: the weight of one that has gone the ways L_i in the
//! layers is Π e^{−σ_a,i L_i}. A way counts when the photon leaves its layer, or after some collisions; what a weight loses
//! by it the layer has absorbed. So one walk serves all absorptions, with the errors of each and no others.

use super::grid::{Places, Quantity};
use crate::walk::photons::lanes_of;
use crate::walk::random::LANES;

/// Absorption coefficients in units of the walk, layer by layer, each with those of all sets.
pub(super) struct Absorptions {
    pub(super) sets: usize,
    pub(super) coefficients: Vec<f32>,
}

/// Weights of all photons under way.
pub(super) struct ManyWeights<'a> {
    absorptions: &'a Absorptions,
    /// Way in the present layer that does not count yet, by photon.
    ways: Vec<f32>,
    /// By photon, then set.
    weights: Vec<f32>,
    /// Places without a photon.
    free: Vec<u32>,
    /// Quantities of a set, and where layers' absorption begins among them.
    count: usize,
    by_layer: usize,
    /// Counts by set, then quantity.
    pub(super) sums: Vec<f64>,
}

impl<'a> ManyWeights<'a> {
    /// Room for so many photons.
    pub(super) fn new(absorptions: &'a Absorptions, places: &Places, photons: usize) -> Self {
        let mut sums = vec![0.0; absorptions.sets * places.count()];
        if places.grid.has_map() {
            // Ways end at faces, so it is not known where in a layer light was absorbed
            for sums in sums.chunks_exact_mut(places.count()) {
                sums[places.of(Quantity::AbsorbedByRingAndDepth)].fill(f64::NAN);
            }
        }
        Self {
            absorptions,
            ways: vec![0.0; photons],
            weights: vec![0.0; photons * absorptions.sets],
            free: (0..photons as u32).rev().collect(),
            count: places.count(),
            by_layer: places.of(Quantity::AbsorbedByLayer).start,
            sums,
        }
    }

    /// Places of so many new photons.
    pub(super) fn begin(&mut self, count: usize) -> [u32; LANES] {
        let mut places = [0; LANES];
        for place in &mut places[..count] {
            *place = self.free.pop().unwrap_or_default();
            self.ways[*place as usize] = 0.0;
            self.of(*place).fill(1.0);
        }
        places
    }

    /// Lets photons go, whose weights have been counted.
    pub(super) fn end(&mut self, mask: u64, places: [u32; LANES]) {
        self.free.extend(lanes_of(mask).map(|lane| places[lane]));
    }

    fn of(&mut self, place: u32) -> &mut [f32] {
        let sets = self.absorptions.sets;
        &mut self.weights[place as usize * sets..][..sets]
    }

    /// Adds flights within a layer.
    #[inline(always)]
    pub(super) fn fly(&mut self, mask: u64, places: [u32; LANES], flights: [f32; LANES]) {
        lanes_of(mask).for_each(|lane| self.ways[places[lane] as usize] += flights[lane]);
    }

    /// Lets a layer absorb along the ways so far and one more each.
    pub(super) fn absorb(&mut self, layer: usize, mask: u64, places: [u32; LANES], ways: [f32; LANES]) {
        let sets = self.absorptions.sets;
        let coefficients = &self.absorptions.coefficients[layer * sets..][..sets];
        for lane in lanes_of(mask) {
            let place = places[lane] as usize;
            let way = std::mem::take(&mut self.ways[place]) + ways[lane];
            let weights = &mut self.weights[place * sets..][..sets];
            for (set, (weight, coefficient)) in weights.iter_mut().zip(coefficients).enumerate() {
                if *coefficient > 0.0 {
                    // With every digit where it is little
                    let absorbed = *weight * -libm::expm1f(-coefficient * way);
                    self.sums[set * self.count + self.by_layer + layer] += f64::from(absorbed);
                    *weight -= absorbed;
                }
            }
        }
    }

    /// Adds a part of a photon's weights to a quantity.
    pub(super) fn add(&mut self, place: u32, quantity: usize, part: f32) {
        let sets = self.absorptions.sets;
        let weights = &self.weights[place as usize * sets..][..sets];
        for (weight, sums) in weights.iter().zip(self.sums.chunks_exact_mut(self.count)) {
            sums[quantity] += f64::from(part * weight);
        }
    }

    /// Multiplies the weights of photons.
    pub(super) fn scale(&mut self, mask: u64, places: [u32; LANES], factor: f32) {
        for lane in lanes_of(mask) {
            self.of(places[lane]).iter_mut().for_each(|weight| *weight *= factor);
        }
    }

    /// Photons whose weights are all below a limit.
    pub(super) fn faint(&mut self, mask: u64, places: [u32; LANES], limit: f32) -> u64 {
        let is_faint = |lane: &usize| self.of(places[*lane]).iter().all(|weight| *weight < limit);
        lanes_of(mask).filter(is_faint).fold(0, |faint, lane| faint | 1 << lane)
    }
}
