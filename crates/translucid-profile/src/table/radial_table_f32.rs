//! Twin of [`RadialTable`](crate::table::radial_table::RadialTable) in single precision: half the size, the same bits
//! deciding.

use crate::table::monotone_cell::Cell;
use crate::table::radial_table::RadialTable;

/// Fraction bits of an `f32`.
const FRACTION_BITS: u32 = 23;
/// Shares within a bucket of the guide have this many leading bits of their fraction in common.
const GUIDE_BITS: u32 = 3;
const GUIDE_SHIFT: u32 = FRACTION_BITS - GUIDE_BITS;
/// Complements below this count as this: the last radius that a random number gives.
const COMPLEMENT_MIN: f32 = 1.0 / 8_589_934_592.0;

/// Distribution of radii x ≥ 0, in a unit near which they lie.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RadialTableF32 {
    first_octave: u32,
    octaves: Vec<Octave>,
    cells: Vec<CellF32>,
    tail_start: f32,
    tail_share: f32,
    tail_rate: f32,
    guide_start: u32,
    guide_within: Vec<u16>,
    guide_beyond: Vec<u16>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Octave {
    shift: u32,
    base: u32,
}

/// Twin of [`Cell`], which explains it, with polynomials in θ multiplied out.
///
/// Cells begin and end at multiples of powers of two, so that θ is exact, and in [0, 1) without a clamp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct CellF32 {
    start: f32,
    inverse_width: f32,
    /// Q(θ) = 1 + θ (`q`₁ + θ `q`₂).
    q: [f32; 2],
    /// Density times Q²: `n`₀ + θ (`n`₁ + θ `n`₂).
    n: [f32; 3],
    /// Share within the cell times Q: θ (`s`₀ + θ `s`₁).
    s: [f32; 2],
    /// Share beyond, in the cell, times Q: (1 − θ) (`share` + θ `c`).
    c: f32,
    within: f32,
    beyond: f32,
    share: f32,
    slope_in: f32,
    /// w d₁.
    weighted_slope_out: f32,
    weight: f32,
}

impl CellF32 {
    fn new(cell: &Cell) -> Self {
        let Cell { share, weight, inverse_width, .. } = *cell;
        let (d0, d1) = (cell.slope_in.min(1e9), cell.slope_out.min(1e9));
        let outer = weight * d1;
        let q = [d0 + outer - 2.0, 1.0 + weight - d0 - outer];
        let n = [d0, 2.0 * (weight - d0), d0 - 2.0 * weight + weight * outer];
        let s = [d0, weight - d0];
        Self {
            start: cell.start as f32,
            inverse_width: inverse_width as f32,
            q: q.map(|q| q as f32),
            n: n.map(|n| (share * inverse_width * n) as f32),
            s: s.map(|s| (share * s) as f32),
            c: (share * (outer - 1.0)) as f32,
            within: cell.within as f32,
            beyond: cell.beyond as f32,
            share: share as f32,
            slope_in: d0 as f32,
            weighted_slope_out: outer as f32,
            weight: weight as f32,
        }
    }

    /// θ and Q(θ).
    #[inline(always)]
    fn place(&self, x: f32) -> (f32, f32) {
        let theta = (x - self.start) * self.inverse_width;
        (theta, 1.0 + theta * (self.q[0] + theta * self.q[1]))
    }

    #[inline(always)]
    fn density(&self, x: f32) -> f32 {
        let (theta, q) = self.place(x);
        // Rounding may leave less than nothing where the density is 0
        ((self.n[0] + theta * (self.n[1] + theta * self.n[2])) / (q * q)).max(0.0)
    }

    #[inline(always)]
    fn within(&self, x: f32) -> f32 {
        let (theta, q) = self.place(x);
        self.within + theta * (self.s[0] + theta * self.s[1]) / q
    }

    #[inline(always)]
    fn beyond(&self, x: f32) -> f32 {
        let (theta, q) = self.place(x);
        self.beyond + (1.0 - theta) * (self.share + theta * self.c) / q
    }

    #[inline(always)]
    fn quantile(&self, u: f32) -> f32 {
        let s = self.part_of_share(u - self.within);
        self.inverse(s, 1.0 - s)
    }

    #[inline(always)]
    fn quantile_complement(&self, v: f32) -> f32 {
        let rest = self.part_of_share(v - self.beyond);
        self.inverse(1.0 - rest, rest)
    }

    #[inline(always)]
    fn part_of_share(&self, energy: f32) -> f32 {
        (energy / self.share.max(f32::MIN_POSITIVE)).max(0.0).min(1.0)
    }

    #[inline(always)]
    fn inverse(&self, s: f32, rest: f32) -> f32 {
        let b = self.slope_in * rest - self.weighted_slope_out * s;
        let root = (b * b + 4.0 * self.weight * s * rest).sqrt();
        let numerator = if b >= 0.0 { 2.0 * s } else { root - b };
        let other = if b >= 0.0 { b + root } else { 2.0 * self.weight * rest };
        self.start + numerator / ((numerator + other).max(1e-30) * self.inverse_width)
    }
}

impl RadialTableF32 {
    pub(crate) fn new(table: &RadialTable) -> Self {
        let cells: Vec<CellF32> = table.cells().iter().map(CellF32::new).collect();
        let (exponent, bits_of_octaves) = table.layout();
        let first_octave = (127 + exponent) as u32;
        let (mut next, mut octaves) = (1u32, Vec::new());
        for (bits, octave) in bits_of_octaves.zip(first_octave..) {
            octaves.push(Octave { shift: FRACTION_BITS - bits, base: (octave << bits).wrapping_sub(next) });
            next += 1 << bits;
        }
        let tail = table.tail();
        let guide_start = cells[0].share.min(0.25).max(1e-12).to_bits() >> GUIDE_SHIFT;
        Self {
            first_octave,
            octaves,
            tail_start: tail.start as f32,
            tail_share: tail.share as f32,
            tail_rate: tail.rate as f32,
            guide_start,
            guide_within: guide_within(&cells, guide_start),
            guide_beyond: guide_beyond(&cells, tail.share as f32),
            cells,
        }
    }

    #[inline(always)]
    fn cell_at(&self, x: f32) -> &CellF32 {
        let bits = x.to_bits();
        let octave = (bits >> FRACTION_BITS).wrapping_sub(self.first_octave);
        let index = match self.octaves.get(octave as usize) {
            Some(octave) => (bits >> octave.shift).wrapping_sub(octave.base) as usize,
            None => 0,
        };
        &self.cells[index]
    }

    #[inline(always)]
    pub(crate) fn density(&self, x: f32) -> f32 {
        let x = x.max(0.0);
        if x < self.tail_start { self.cell_at(x).density(x) } else { self.tail_rate * self.tail_beyond(x) }
    }

    #[inline(always)]
    pub(crate) fn within(&self, x: f32) -> f32 {
        let x = x.max(0.0);
        if x < self.tail_start { self.cell_at(x).within(x) } else { 1.0 - self.tail_beyond(x) }
    }

    #[inline(always)]
    pub(crate) fn beyond(&self, x: f32) -> f32 {
        let x = x.max(0.0);
        if x < self.tail_start { self.cell_at(x).beyond(x) } else { self.tail_beyond(x) }
    }

    #[inline(never)]
    fn tail_beyond(&self, x: f32) -> f32 {
        self.tail_share * (-self.tail_rate * (x - self.tail_start)).exp()
    }

    #[inline(always)]
    pub(crate) fn quantile(&self, u: f32) -> f32 {
        let u = u.max(0.0).min(1.0);
        if u < 0.5 { self.below_median(u) } else { self.above_median(1.0 - u) }
    }

    #[inline(always)]
    pub(crate) fn quantile_complement(&self, v: f32) -> f32 {
        let v = v.min(1.0).max(0.0);
        if v > 0.5 { self.below_median(1.0 - v) } else { self.above_median(v) }
    }

    #[inline(always)]
    fn below_median(&self, u: f32) -> f32 {
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
    fn above_median(&self, v: f32) -> f32 {
        if v < self.tail_share {
            return self.tail_start
                + (self.tail_share / v.max(COMPLEMENT_MIN)).ln().max(0.0) / self.tail_rate;
        }
        let bucket = (0.5f32.to_bits() >> GUIDE_SHIFT).wrapping_sub(v.to_bits() >> GUIDE_SHIFT);
        let last = self.cells.len() - 1;
        let mut index = self.guide_beyond.get(bucket as usize).map_or(last, |index| usize::from(*index));
        while v < self.cells[index].beyond && index < last {
            index += 1;
        }
        self.cells[index].quantile_complement(v)
    }
}

/// For the least share of each bucket up to the median: the last cell that begins at or before it.
fn guide_within(cells: &[CellF32], start: u32) -> Vec<u16> {
    let end = 0.5f32.to_bits() >> GUIDE_SHIFT;
    let mut index = 0;
    let cell_of = |bucket: u32| {
        let least = f32::from_bits(bucket << GUIDE_SHIFT);
        while index + 1 < cells.len() && cells[index + 1].within <= least {
            index += 1;
        }
        index as u16
    };
    (start..=end).map(cell_of).collect()
}

/// For the greatest complement of each bucket down from the median: the first cell that ends below it.
fn guide_beyond(cells: &[CellF32], tail_share: f32) -> Vec<u16> {
    let start = 0.5f32.to_bits() >> GUIDE_SHIFT;
    let end = tail_share.min(0.5).max(1e-12).to_bits() >> GUIDE_SHIFT;
    let mut index = 0;
    let cell_of = |bucket: u32| {
        let greatest = f32::from_bits((bucket + 1) << GUIDE_SHIFT);
        while index + 1 < cells.len() && cells[index].beyond >= greatest {
            index += 1;
        }
        index as u16
    };
    (end..=start).rev().map(cell_of).collect()
}
