//! Photons under way, as a structure of arrays and as sixteen in registers.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, mask32x16};

use super::lanes::{Floats, FusedMulAdd, Words};
use super::random::{LANES, Stream};
use super::scatter::{Directions, Scatter};

/// Groups of lanes in a block: enough that a group's stores have long been done when it is loaded again, few
/// enough that the block stays in the first-level cache.
const GROUPS: usize = 32;
/// Photons in a block.
pub(crate) const BLOCK: usize = GROUPS * LANES;
/// Places in a structure of photons: a vector may start at the last photon.
const PLACES: usize = BLOCK + LANES;

/// Photons, as a structure of arrays.
#[repr(align(64))]
pub(crate) struct Photons {
    /// x, y and z, then the direction, unused where scattering forgets it.
    floats: [[f32; PLACES]; 6],
    /// Random stream, collisions that the photon will yet survive, and what else it carries.
    words: [[u32; PLACES]; 6],
    /// Number of photons, from place 0 on.
    pub(crate) count: usize,
}

impl Photons {
    pub(crate) fn none() -> Box<Self> {
        Box::new(Self { floats: [[0.0; PLACES]; 6], words: [[0; PLACES]; 6], count: 0 })
    }

    /// Copies one photon to another place.
    #[inline(always)]
    pub(crate) fn copy_within(&mut self, to: usize, from: usize) {
        self.floats.iter_mut().for_each(|array| array[to] = array[from]);
        self.words.iter_mut().for_each(|array| array[to] = array[from]);
    }
}

/// Sixteen photons in registers.
#[derive(Clone, Copy)]
pub(crate) struct Group<S: Simd> {
    pub(crate) x: Floats<S>,
    pub(crate) y: Floats<S>,
    pub(crate) z: Floats<S>,
    pub(crate) directions: Directions<S>,
    pub(crate) streams: Stream<Words<S>>,
    pub(crate) left: Words<S>,
    pub(crate) budget: Words<S>,
}

impl<S: Simd> Group<S> {
    /// Loads the photons from the place `first` on.
    #[inline(always)]
    pub(crate) fn load<P: Scatter>(simd: S, photons: &Photons, first: usize) -> Self {
        let places = first..first + LANES;
        let float = |i: usize| Floats::from_slice(simd, &photons.floats[i][places.clone()]);
        let word = |i: usize| Words::from_slice(simd, &photons.words[i][places.clone()]);
        let direction = |i: usize| if P::REMEMBERS { float(i) } else { Floats::splat(simd, 0.0) };
        Self {
            x: float(0),
            y: float(1),
            z: float(2),
            directions: Directions { x: direction(3), y: direction(4), z: direction(5) },
            streams: Stream([word(0), word(1), word(2), word(3)]),
            left: word(4),
            budget: word(5),
        }
    }

    #[inline(always)]
    pub(crate) fn store<P: Scatter>(&self, photons: &mut Photons, first: usize) {
        let places = first..first + LANES;
        let Directions { x: ux, y: uy, z: uz } = self.directions;
        let floats = [self.x, self.y, self.z, ux, uy, uz];
        let count = if P::REMEMBERS { 6 } else { 3 };
        for (array, values) in photons.floats.iter_mut().zip(floats).take(count) {
            values.store_slice(&mut array[places.clone()]);
        }
        let [a, b, c, d] = self.streams.0;
        for (array, values) in photons.words.iter_mut().zip([a, b, c, d, self.left, self.budget]) {
            values.store_slice(&mut array[places.clone()]);
        }
    }

    /// Applies a permutation of lanes to everything.
    #[inline(always)]
    fn map(
        &self,
        other: &Self,
        floats: impl Fn(Floats<S>, Floats<S>) -> Floats<S>,
        words: impl Fn(Words<S>, Words<S>) -> Words<S>,
    ) -> Self {
        let (u, v) = (self.directions, other.directions);
        let (s, t) = (self.streams.0, other.streams.0);
        Self {
            x: floats(self.x, other.x),
            y: floats(self.y, other.y),
            z: floats(self.z, other.z),
            directions: Directions { x: floats(u.x, v.x), y: floats(u.y, v.y), z: floats(u.z, v.z) },
            streams: Stream([words(s[0], t[0]), words(s[1], t[1]), words(s[2], t[2]), words(s[3], t[3])]),
            left: words(self.left, other.left),
            budget: words(self.budget, other.budget),
        }
    }

    /// Moves the photons of a mask to the first lanes, in order.
    #[inline(always)]
    pub(crate) fn compress(&self, mask: mask32x16<S>) -> Self {
        self.map(self, |a, _| a.compress(mask), |a, _| a.compress(mask))
    }

    /// Puts the first of other photons, in order, into the lanes of a mask.
    #[inline(always)]
    pub(crate) fn refill(&self, fresh: &Self, mask: mask32x16<S>) -> Self {
        self.map(fresh, |a, b| b.expand_merge(mask, a), |a, b| b.expand_merge(mask, a))
    }

    /// Moves along the directions.
    #[inline(always)]
    pub(crate) fn advance(&mut self, flight: Floats<S>) {
        self.x = flight.fused_mul_add(self.directions.x, self.x);
        self.y = flight.fused_mul_add(self.directions.y, self.y);
        self.z = flight.fused_mul_add(self.directions.z, self.z);
    }
}

/// The lanes of a mask, in order.
#[inline(always)]
pub(crate) fn lanes_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
