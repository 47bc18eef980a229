//! Exits on their way from the kernel to the caller.

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::lanes::{Floats, Words};
use super::random::LANES;
use super::{PhotonExit, Side};

/// Exits that are handed on at a time.
const EXITS: usize = 1024;

/// Buffered exits, as a structure of arrays.
pub(super) struct ExitBuffer<'a> {
    /// x, y and the cosine.
    floats: [[f32; EXITS + LANES]; 3],
    /// Order, and 1 for those transmitted.
    words: [[u32; EXITS + LANES]; 2],
    count: usize,
    /// Number of exits that have been handed on.
    pub(super) total: u64,
    batch: Vec<PhotonExit>,
    hand_on: &'a mut dyn FnMut(&[PhotonExit]),
}

impl<'a> ExitBuffer<'a> {
    pub(super) fn new(hand_on: &'a mut dyn FnMut(&[PhotonExit])) -> Self {
        let (floats, words) = ([[0.0; EXITS + LANES]; 3], [[0; EXITS + LANES]; 2]);
        Self { floats, words, count: 0, total: 0, batch: Vec::with_capacity(EXITS + LANES), hand_on }
    }

    /// Adds the first `count` lanes.
    #[inline(always)]
    pub(super) fn push<S: Simd>(&mut self, floats: [Floats<S>; 3], words: [Words<S>; 2], count: usize) {
        let places = self.count..self.count + LANES;
        for (array, values) in self.floats.iter_mut().zip(floats) {
            values.store_slice(&mut array[places.clone()]);
        }
        for (array, values) in self.words.iter_mut().zip(words) {
            values.store_slice(&mut array[places.clone()]);
        }
        self.count += count;
        if self.count >= EXITS {
            self.flush();
        }
    }

    /// Hands on what there is.
    #[inline(never)]
    pub(super) fn flush(&mut self) {
        self.batch.clear();
        for i in 0..self.count {
            let [x, y, cos_theta] = self.floats.each_ref().map(|array| array[i]);
            let [order, transmitted] = self.words.each_ref().map(|array| array[i]);
            let side = if transmitted == 0 { Side::Reflected } else { Side::Transmitted };
            self.batch.push(PhotonExit { x, y, cos_theta, order, side });
        }
        self.total += self.count as u64;
        self.count = 0;
        (self.hand_on)(&self.batch);
    }
}
