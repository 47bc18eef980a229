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

use crate::table::monotone_cell::{Cell, Knot};

/// Fraction bits of an `f64`.
const FRACTION_BITS: u32 = 52;
/// Shares within a bucket of the guide have this many leading bits of their fraction in common.
const GUIDE_BITS: u32 = 3;
const GUIDE_SHIFT: u32 = FRACTION_BITS - GUIDE_BITS;
/// Complements below this count as this: the exponential's last radius.
const COMPLEMENT_MIN: f64 = f64::MIN_POSITIVE;

/// A distribution of radii x ≥ 0, in a unit near which they lie.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RadialTable {
    /// Exponent bits of the first octave.
    first_octave: u64,
    octaves: Vec<Octave>,
    cells: Vec<Cell>,
    tail: Tail,
    /// Exponent and leading bits of the least share of `guide_within`.
    guide_start: u64,
    guide_within: Vec<u16>,
    guide_beyond: Vec<u16>,
}

/// Where the cells of an octave are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Octave {
    /// Bits of a radius beyond these are within the cell.
    shift: u32,
    /// What the remaining bits exceed the cell's number by.
    base: u64,
}

/// Beyond the last cell: `share` e^{−`rate`(x − `start`)}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Tail {
    pub(crate) start: f64,
    pub(crate) share: f64,
    pub(crate) rate: f64,
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

    pub(crate) fn beyond(&self, x: f64) -> f64 {
        self.share * (-self.rate * (x - self.start)).exp()
    }

    fn quantile_complement(&self, v: f64) -> f64 {
        self.start + (self.share / v).ln().max(0.0).min(1e3) / self.rate
    }
}

impl RadialTable {
    /// Puts cells together: one from 0 to 2^`first_exponent`, then for each octave 2^j of them, the last octave
    /// perhaps not full.
    pub(crate) fn new(first_exponent: i32, bits_of_octaves: &[u32], cells: Vec<Cell>, tail: Tail) -> Self {
        let first_octave = (1023 + i64::from(first_exponent)) as u64;
        let mut next = 1;
        let mut octaves = Vec::with_capacity(bits_of_octaves.len());
        for (i, bits) in bits_of_octaves.iter().enumerate() {
            let base = ((first_octave + i as u64) << bits).wrapping_sub(next);
            octaves.push(Octave { shift: FRACTION_BITS - bits, base });
            next += 1 << bits;
        }
        let guide_start = cells[0].share.min(0.25).max(1e-12).to_bits() >> GUIDE_SHIFT;
        let guide_within = guide_within(&cells, guide_start);
        let guide_beyond = guide_beyond(&cells, tail.share);
        Self { first_octave, octaves, cells, tail, guide_start, guide_within, guide_beyond }
    }

    pub(crate) fn cells(&self) -> &[Cell] {
        &self.cells
    }

    pub(crate) fn tail(&self) -> &Tail {
        &self.tail
    }

    /// Exponent of the first octave, and j of each: it has 2^j cells, the last perhaps fewer.
    pub(crate) fn layout(&self) -> (i32, impl Iterator<Item = u32>) {
        let exponent = self.first_octave as i32 - 1023;
        (exponent, self.octaves.iter().map(|octave| FRACTION_BITS - octave.shift))
    }

    /// Whether the density per area has a limit at r = 0.
    pub(crate) fn is_finite_at_0(&self) -> bool {
        self.cells[0].slope_in == 0.0
    }

    /// The cell of a radius before the tail.
    #[inline(always)]
    fn cell_at(&self, x: f64) -> &Cell {
        let bits = x.to_bits();
        // Before the first octave the number wraps around to one that no octave has
        let octave = (bits >> FRACTION_BITS).wrapping_sub(self.first_octave);
        let index = match self.octaves.get(octave as usize) {
            Some(octave) => (bits >> octave.shift).wrapping_sub(octave.base) as usize,
            None => 0,
        };
        &self.cells[index]
    }

    /// Density per length.
    #[inline(always)]
    pub(crate) fn density(&self, x: f64) -> f64 {
        let x = x.max(0.0);
        if x < self.tail.start { self.cell_at(x).density(x) } else { self.tail.rate * self.tail.beyond(x) }
    }

    /// Share within x.
    #[inline(always)]
    pub(crate) fn within(&self, x: f64) -> f64 {
        let x = x.max(0.0);
        if x < self.tail.start { self.cell_at(x).within(x) } else { 1.0 - self.tail.beyond(x) }
    }

    /// Share beyond x.
    #[inline(always)]
    pub(crate) fn beyond(&self, x: f64) -> f64 {
        let x = x.max(0.0);
        if x < self.tail.start { self.cell_at(x).beyond(x).min(1.0) } else { self.tail.beyond(x) }
    }

    /// Radius within which the share u is, u ∈ [0, 1] or NaN.
    #[inline(always)]
    pub(crate) fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        if u < 0.5 { self.below_median(u) } else { self.above_median(1.0 - u) }
    }

    /// Radius beyond which the share v is.
    #[inline(always)]
    pub(crate) fn quantile_complement(&self, v: f64) -> f64 {
        let v = v.min(1.0).max(0.0);
        if v > 0.5 { self.below_median(1.0 - v) } else { self.above_median(v) }
    }

    #[inline(always)]
    fn below_median(&self, u: f64) -> f64 {
        let bucket = (u.to_bits() >> GUIDE_SHIFT).wrapping_sub(self.guide_start);
        let mut index = self.guide_within.get(bucket as usize).map_or(0, |index| usize::from(*index));
        while let Some(next) = self.cells.get(index + 1)
            && next.within <= u
        {
            index += 1;
        }
        self.cells[index].quantile(u)
    }

    #[inline(always)]
    fn above_median(&self, v: f64) -> f64 {
        if v < self.tail.share {
            return self.tail.quantile_complement(v.max(COMPLEMENT_MIN));
        }
        let bucket = (0.5f64.to_bits() >> GUIDE_SHIFT).wrapping_sub(v.to_bits() >> GUIDE_SHIFT);
        let last = self.cells.len() - 1;
        let mut index = self.guide_beyond.get(bucket as usize).map_or(last, |index| usize::from(*index));
        while v < self.cells[index].beyond && index < last {
            index += 1;
        }
        self.cells[index].quantile_complement(v)
    }
}

/// For the least share of each bucket up to the median: the last cell that begins at or before it.
fn guide_within(cells: &[Cell], start: u64) -> Vec<u16> {
    let end = 0.5f64.to_bits() >> GUIDE_SHIFT;
    let mut index = 0;
    let cell_of = |bucket: u64| {
        let least = f64::from_bits(bucket << GUIDE_SHIFT);
        while index + 1 < cells.len() && cells[index + 1].within <= least {
            index += 1;
        }
        index as u16
    };
    (start..=end).map(cell_of).collect()
}

/// For the greatest complement of each bucket down from the median: the first cell that ends below it.
fn guide_beyond(cells: &[Cell], tail_share: f64) -> Vec<u16> {
    let start = 0.5f64.to_bits() >> GUIDE_SHIFT;
    let end = tail_share.min(0.5).max(1e-12).to_bits() >> GUIDE_SHIFT;
    let mut index = 0;
    let cell_of = |bucket: u64| {
        let greatest = f64::from_bits((bucket + 1) << GUIDE_SHIFT);
        while index + 1 < cells.len() && cells[index].beyond >= greatest {
            index += 1;
        }
        index as u16
    };
    (end..=start).rev().map(cell_of).collect()
}
