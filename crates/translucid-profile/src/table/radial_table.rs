//! A tabulated distribution of radii: from a radius or a share to its cell in a few operations.
//!
//! Cells divide octaves: between 2^k and 2^{k+1} lie 2^j cells of equal width, as many as that octave needs.
//! The number of a cell is then what the bits of a radius say, its exponent and the first j bits of its fraction;
//! no logarithm is taken and nothing is searched.
//! The first cell begins at 0, and beyond the last one the energy falls exponentially.
//!
//! From a share to a cell leads a guide table over the share's bits, below the median those of u, above it those
//! of 1 − u, whose cell is at most a few before the one sought (H.-C. Chen and Y. Asau 1974, *On generating random
//! variates from an empirical distribution*).

use crate::table::monotone_cell::{Knot, RadialCell};
use crate::table::monotone_cell_f32::CellF32;
use crate::table::precision::{Number, Precision};

/// Shares within a bucket of the guide have this many leading bits of their fraction in common.
const GUIDE_BITS: u32 = 3;

/// A distribution of radii x ≥ 0, in a unit near which they lie.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RadialTable<T: Precision = f64> {
    /// Exponent bits of the first octave.
    first_octave: u32,
    octaves: Vec<Octave>,
    cells: Vec<T::Cell>,
    tail: Tail<T>,
    /// Exponent and leading bits of the least share of `guide_within`.
    guide_start: u32,
    guide_within: Vec<u16>,
    guide_beyond: Vec<u16>,
}

/// Where the cells of an octave are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Octave {
    /// Bits of a radius beyond these are within the cell.
    shift: u32,
    /// Excess of the remaining bits over the cell's number.
    base: u32,
}

/// Beyond the last cell: `share` e^{−`rate`(x − `start`)}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tail<T = f64> {
    pub(crate) start: T,
    pub(crate) share: T,
    pub(crate) rate: T,
}

impl Tail {
    /// The tail that goes on from a knot with its density.
    pub(crate) fn new(knot: &Knot) -> Self {
        Self::with_density(knot.x, knot.beyond, knot.density)
    }

    /// The tail from a radius with what is beyond and the density there.
    pub(crate) fn with_density(start: f64, share: f64, density: f64) -> Self {
        let rate = density / share;
        let sane = rate * start > 1e-3 && rate * start < 1e9;
        Self { start, share, rate: if sane { rate } else { 1.0 / start } }
    }
}

impl<T: Number> Tail<T> {
    #[inline(always)]
    pub(crate) fn beyond(&self, x: T) -> T {
        self.share * ((self.start - x) * self.rate).exp()
    }

    #[inline(always)]
    fn quantile_complement(&self, v: T) -> T {
        self.start + (self.share / v).ln().max(T::ZERO) / self.rate
    }
}

impl RadialTable {
    /// Whether the density per area has a limit at r = 0.
    pub(crate) fn is_finite_at_0(&self) -> bool {
        self.cells[0].slope_in == 0.0
    }
}

impl From<&RadialTable> for RadialTable<f32> {
    fn from(table: &RadialTable) -> Self {
        let octave_bits: Vec<u32> =
            table.octaves.iter().map(|octave| f64::FRACTION_BITS - octave.shift).collect();
        let Tail { start, share, rate } = table.tail;
        let tail = Tail { start: start as f32, share: share as f32, rate: rate as f32 };
        let first_exponent = table.first_octave as i32 - f64::EXPONENT_BIAS;
        Self::new(first_exponent, &octave_bits, table.cells.iter().map(Into::into).collect(), tail)
    }
}

impl RadialTable<f32> {
    /// The table for a shader, which finds the cell of a share by halving: exponent bits of the first octave, numbers of octaves
    /// and cells, start, share and rate of the tail; of each octave shift and base; the [words](CellF32::words) of each cell.
    ///
    /// Whole numbers stand as floating-point ones, which hold them exactly; a base may be below 0.
    pub(crate) fn words(&self) -> Vec<f32> {
        let Self { first_octave, octaves, cells, tail, .. } = self;
        let counts = [*first_octave as usize, octaves.len(), cells.len()].map(|count| count as f32);
        let octaves =
            octaves.iter().flat_map(|octave| [octave.shift as f32, octave.base.cast_signed() as f32]);
        let cells = cells.iter().flat_map(CellF32::words);
        counts.into_iter().chain([tail.start, tail.share, tail.rate]).chain(octaves).chain(cells).collect()
    }
}

impl<T: Precision> RadialTable<T> {
    const GUIDE_SHIFT: u32 = T::FRACTION_BITS - GUIDE_BITS;

    /// Puts cells together: one from 0 to 2^`first_exponent`, then for each octave 2^j of them, the last octave
    /// perhaps not full.
    pub(crate) fn new(first_exponent: i32, octave_bits: &[u32], cells: Vec<T::Cell>, tail: Tail<T>) -> Self {
        let first_octave = (T::EXPONENT_BIAS + first_exponent) as u32;
        let mut next = 1;
        let mut octaves = Vec::with_capacity(octave_bits.len());
        for (bits, octave) in octave_bits.iter().zip(first_octave..) {
            octaves
                .push(Octave { shift: T::FRACTION_BITS - bits, base: (octave << bits).wrapping_sub(next) });
            next += 1 << bits;
        }
        let [_, head, _] = cells[0].shares();
        let guide_start = Self::bucket(head.min(T::nearest(0.25)).max(T::nearest(1e-12)));
        let guide_within = Self::guide_within(&cells, guide_start);
        let guide_beyond = Self::guide_beyond(&cells, tail.share);
        Self { first_octave, octaves, cells, tail, guide_start, guide_within, guide_beyond }
    }

    /// The cell of a radius before the tail.
    #[inline(always)]
    fn cell_at(&self, x: T) -> &T::Cell {
        // Before the first octave the number wraps around to one that no octave has
        let octave = x.leading_bits(T::FRACTION_BITS).wrapping_sub(self.first_octave);
        let index = match self.octaves.get(octave as usize) {
            Some(octave) => x.leading_bits(octave.shift).wrapping_sub(octave.base) as usize,
            None => 0,
        };
        &self.cells[index]
    }

    /// Density per length.
    #[inline(always)]
    pub(crate) fn density(&self, x: T) -> T {
        let x = x.max(T::ZERO);
        if x < self.tail.start { self.cell_at(x).density(x) } else { self.tail.rate * self.beyond_in_tail(x) }
    }

    /// Share within x.
    #[inline(always)]
    pub(crate) fn within(&self, x: T) -> T {
        let x = x.max(T::ZERO);
        if x < self.tail.start { self.cell_at(x).within(x) } else { T::ONE - self.beyond_in_tail(x) }
    }

    /// Share beyond x.
    #[inline(always)]
    pub(crate) fn beyond(&self, x: T) -> T {
        let x = x.max(T::ZERO);
        if x < self.tail.start { self.cell_at(x).beyond(x) } else { self.beyond_in_tail(x) }
    }

    #[inline(never)]
    fn beyond_in_tail(&self, x: T) -> T {
        self.tail.beyond(x)
    }

    /// Radius within which the share u is, u ∈ [0, 1] or NaN.
    #[inline(always)]
    pub(crate) fn quantile(&self, u: T) -> T {
        let u = u.max(T::ZERO).min(T::ONE);
        if u < T::HALF { self.below_median(u) } else { self.above_median(T::ONE - u) }
    }

    /// Radius beyond which the share v is.
    #[inline(always)]
    pub(crate) fn quantile_complement(&self, v: T) -> T {
        let v = v.min(T::ONE).max(T::ZERO);
        if v > T::HALF { self.below_median(T::ONE - v) } else { self.above_median(v) }
    }

    #[inline(always)]
    fn below_median(&self, u: T) -> T {
        let bucket = Self::bucket(u).wrapping_sub(self.guide_start);
        let mut index = self.guide_within.get(bucket as usize).map_or(0, |index| usize::from(*index));
        while let Some(next) = self.cells.get(index + 1)
            && next.shares()[0] <= u
        {
            index += 1;
        }
        self.cells[index].quantile(u)
    }

    #[inline(always)]
    fn above_median(&self, v: T) -> T {
        if v < self.tail.share {
            return self.tail.quantile_complement(v.max(T::COMPLEMENT_MIN));
        }
        let bucket = Self::bucket(T::HALF).wrapping_sub(Self::bucket(v));
        let last = self.cells.len() - 1;
        let mut index = self.guide_beyond.get(bucket as usize).map_or(last, |index| usize::from(*index));
        while v < self.cells[index].shares()[2] && index < last {
            index += 1;
        }
        self.cells[index].quantile_complement(v)
    }

    /// Exponent and leading bits of a share.
    #[inline(always)]
    fn bucket(share: T) -> u32 {
        share.leading_bits(Self::GUIDE_SHIFT)
    }

    /// For the least share of each bucket up to the median: the last cell that begins at or before it.
    fn guide_within(cells: &[T::Cell], start: u32) -> Vec<u16> {
        let mut index = 0;
        let cell_of = |bucket: u32| {
            let least = T::from_leading_bits(bucket, Self::GUIDE_SHIFT);
            while index + 1 < cells.len() && cells[index + 1].shares()[0] <= least {
                index += 1;
            }
            index as u16
        };
        (start..=Self::bucket(T::HALF)).map(cell_of).collect()
    }

    /// For the greatest complement of each bucket down from the median: the first cell that ends below it.
    fn guide_beyond(cells: &[T::Cell], tail_share: T) -> Vec<u16> {
        let end = Self::bucket(tail_share.min(T::HALF).max(T::nearest(1e-12)));
        let mut index = 0;
        let cell_of = |bucket: u32| {
            let greatest = T::from_leading_bits(bucket + 1, Self::GUIDE_SHIFT);
            while index + 1 < cells.len() && cells[index].shares()[2] >= greatest {
                index += 1;
            }
            index as u16
        };
        (end..=Self::bucket(T::HALF)).rev().map(cell_of).collect()
    }
}
