//! Rows of numbers as a structure of arrays.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f32x16, u32x16};

use super::lanes::{Floats, Words};
use super::random::LANES;

/// Rows of `F` numbers and `W` words, a vector for each column; behind the last row there is room for a group of lanes.
pub(super) struct Columns<const F: usize, const W: usize> {
    floats: [Vec<f32>; F],
    words: [Vec<u32>; W],
    /// Number of rows.
    pub(super) len: usize,
}

impl<const F: usize, const W: usize> Columns<F, W> {
    /// Columns with room for so many rows.
    pub(super) fn new(capacity: usize) -> Self {
        Self {
            floats: std::array::from_fn(|_| vec![0.0; capacity + LANES]),
            words: std::array::from_fn(|_| vec![0; capacity + LANES]),
            len: 0,
        }
    }

    /// Appends all rows of others.
    pub(super) fn append(&mut self, other: &Self) {
        let (to, from) = (self.len..self.len + other.len, 0..other.len);
        for (column, others) in self.floats.iter_mut().zip(&other.floats) {
            column[to.clone()].copy_from_slice(&others[from.clone()]);
        }
        for (column, others) in self.words.iter_mut().zip(&other.words) {
            column[to.clone()].copy_from_slice(&others[from.clone()]);
        }
        self.len += other.len;
    }

    /// Writes sixteen rows from the one given on.
    #[inline(always)]
    pub(super) fn put<S: Simd>(&mut self, row: usize, floats: [Floats<S>; F], words: [Words<S>; W]) {
        let rows = row..row + LANES;
        for (column, values) in self.floats.iter_mut().zip(floats) {
            values.store_slice(&mut column[rows.clone()]);
        }
        for (column, values) in self.words.iter_mut().zip(words) {
            values.store_slice(&mut column[rows.clone()]);
        }
    }

    /// Reads sixteen rows from the one given on.
    #[inline(always)]
    pub(super) fn get<S: Simd>(&self, simd: S, row: usize) -> ([Floats<S>; F], [Words<S>; W]) {
        let rows = row..row + LANES;
        let floats = std::array::from_fn(|i| f32x16::from_slice(simd, &self.floats[i][rows.clone()]));
        let words = std::array::from_fn(|i| u32x16::from_slice(simd, &self.words[i][rows.clone()]));
        (floats, words)
    }

    /// Sets all columns of the rows behind the last to 0, up to a whole group of lanes.
    #[inline(always)]
    pub(super) fn clear_end(&mut self) {
        let end = self.len..self.len.next_multiple_of(LANES);
        self.floats.iter_mut().for_each(|column| column[end.clone()].fill(0.0));
        self.words.iter_mut().for_each(|column| column[end.clone()].fill(0));
    }
}
