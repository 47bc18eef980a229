//! Photons under way, as a structure of arrays and as sixteen in registers.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, mask32x16};

use super::lanes::{Floats, Words, exponential};
use super::random::{LANES, Stream};
use super::scatter::{Directions, Scatter};

/// Groups of lanes in a block: enough that a group's stores have long been done when it is loaded again, few
/// enough that the block stays in the first-level cache.
const GROUPS: usize = 32;
/// Photons in a block.
pub(super) const BLOCK: usize = GROUPS * LANES;
/// Places in a structure of photons: a vector may start at the last photon.
const PLACES: usize = BLOCK + LANES;

/// Photons that are about to collide, as a structure of arrays.
#[repr(align(64))]
pub(super) struct Photons {
    x: [f32; PLACES],
    y: [f32; PLACES],
    z: [f32; PLACES],
    /// Directions before the collision; unused where scattering forgets them.
    ux: [f32; PLACES],
    uy: [f32; PLACES],
    uz: [f32; PLACES],
    stream: [[u32; PLACES]; 4],
    /// Collisions that it will yet survive.
    left: [u32; PLACES],
    /// Collisions that it will survive in all.
    budget: [u32; PLACES],
    /// Number of photons, from place 0 on.
    pub(super) count: usize,
}

impl Photons {
    pub(super) fn none() -> Box<Self> {
        let (floats, words) = ([0.0; PLACES], [0; PLACES]);
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
            count: 0,
        })
    }

    /// Copies one photon; `to` and `from` are places in this and the other structure.
    #[inline(always)]
    pub(super) fn copy_from(&mut self, to: usize, photons: &Self, from: usize) {
        self.x[to] = photons.x[from];
        self.y[to] = photons.y[from];
        self.z[to] = photons.z[from];
        self.ux[to] = photons.ux[from];
        self.uy[to] = photons.uy[from];
        self.uz[to] = photons.uz[from];
        for (array, other) in self.stream.iter_mut().zip(&photons.stream) {
            array[to] = other[from];
        }
        self.left[to] = photons.left[from];
        self.budget[to] = photons.budget[from];
    }

    /// Copies one photon to another place.
    #[inline(always)]
    pub(super) fn copy_within(&mut self, to: usize, from: usize) {
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.ux, &mut self.uy, &mut self.uz] {
            array[to] = array[from];
        }
        for array in &mut self.stream {
            array[to] = array[from];
        }
        self.left[to] = self.left[from];
        self.budget[to] = self.budget[from];
    }
}

/// Sixteen photons in registers.
#[derive(Clone, Copy)]
pub(super) struct Group<S: Simd> {
    pub(super) x: Floats<S>,
    pub(super) y: Floats<S>,
    pub(super) z: Floats<S>,
    pub(super) directions: Directions<S>,
    pub(super) streams: Stream<Words<S>>,
    pub(super) left: Words<S>,
    pub(super) budget: Words<S>,
}

impl<S: Simd> Group<S> {
    /// Loads the photons from the place `first` on.
    #[inline(always)]
    pub(super) fn load<P: Scatter>(simd: S, photons: &Photons, first: usize) -> Self {
        let floats = |array| Floats::from_slice(simd, window(array, first));
        let words = |array| Words::from_slice(simd, window(array, first));
        let directions = if P::REMEMBERS {
            Directions { x: floats(&photons.ux), y: floats(&photons.uy), z: floats(&photons.uz) }
        } else {
            let nothing = Floats::splat(simd, 0.0);
            Directions { x: nothing, y: nothing, z: nothing }
        };
        Self {
            x: floats(&photons.x),
            y: floats(&photons.y),
            z: floats(&photons.z),
            directions,
            streams: Stream([
                words(&photons.stream[0]),
                words(&photons.stream[1]),
                words(&photons.stream[2]),
                words(&photons.stream[3]),
            ]),
            left: words(&photons.left),
            budget: words(&photons.budget),
        }
    }

    #[inline(always)]
    pub(super) fn store<P: Scatter>(&self, photons: &mut Photons, first: usize) {
        self.x.store_slice(window_mut(&mut photons.x, first));
        self.y.store_slice(window_mut(&mut photons.y, first));
        self.z.store_slice(window_mut(&mut photons.z, first));
        if P::REMEMBERS {
            self.directions.x.store_slice(window_mut(&mut photons.ux, first));
            self.directions.y.store_slice(window_mut(&mut photons.uy, first));
            self.directions.z.store_slice(window_mut(&mut photons.uz, first));
        }
        for (array, words) in photons.stream.iter_mut().zip(self.streams.0) {
            words.store_slice(window_mut(array, first));
        }
        self.left.store_slice(window_mut(&mut photons.left, first));
        self.budget.store_slice(window_mut(&mut photons.budget, first));
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
    pub(super) fn compress(&self, mask: mask32x16<S>) -> Self {
        self.map(self, |a, _| a.compress(mask), |a, _| a.compress(mask))
    }

    /// Puts the first of other photons, in order, into the lanes of a mask.
    #[inline(always)]
    pub(super) fn refill(&self, fresh: &Self, mask: mask32x16<S>) -> Self {
        self.map(fresh, |a, b| b.expand_merge(mask, a), |a, b| b.expand_merge(mask, a))
    }

    /// Flies without regard to faces.
    #[inline(always)]
    pub(super) fn fly(&mut self, simd: S) {
        let flight = exponential(simd, self.streams.next());
        self.x = flight.mul_add(self.directions.x, self.x);
        self.y = flight.mul_add(self.directions.y, self.y);
        self.z = flight.mul_add(self.directions.z, self.z);
    }
}

/// The sixteen elements of an array from `first` on.
#[inline(always)]
fn window<T>(array: &[T; PLACES], first: usize) -> &[T] {
    &array[first..first + LANES]
}

#[inline(always)]
fn window_mut<T>(array: &mut [T; PLACES], first: usize) -> &mut [T] {
    &mut array[first..first + LANES]
}
