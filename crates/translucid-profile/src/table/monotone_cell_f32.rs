//! A cell of a tabulated cdf in single precision: [`Cell`], which explains it, with polynomials in θ multiplied out.

use crate::table::monotone_cell::{Cell, RadialCell};

/// Twin of [`Cell`].
///
/// Cells begin and end at multiples of powers of two, so that θ is exact, and in [0, 1) without a clamp.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct CellF32 {
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
    /// All numbers, in the order of the fields.
    pub(crate) fn words(&self) -> [f32; 16] {
        let Self { start, inverse_width, q, n, s, c, within, beyond, share, .. } = *self;
        let Self { slope_in, weighted_slope_out, weight, .. } = *self;
        let shape = [start, inverse_width, q[0], q[1], n[0], n[1], n[2], s[0], s[1], c];
        let rest = [within, beyond, share, slope_in, weighted_slope_out, weight];
        std::array::from_fn(|i| if i < shape.len() { shape[i] } else { rest[i - shape.len()] })
    }

    /// θ and Q(θ).
    #[inline(always)]
    fn place(&self, x: f32) -> (f32, f32) {
        let theta = (x - self.start) * self.inverse_width;
        (theta, 1.0 + theta * (self.q[0] + theta * self.q[1]))
    }

    #[inline(always)]
    fn part_of_share(&self, energy: f32) -> f32 {
        (energy / self.share.max(f32::MIN_POSITIVE)).max(0.0).min(1.0)
    }

    /// x of the share s of the cell's energy, given beside 1 − s.
    #[inline(always)]
    fn inverse(&self, s: f32, rest: f32) -> f32 {
        let b = self.slope_in * rest - self.weighted_slope_out * s;
        let root = (b * b + 4.0 * self.weight * s * rest).sqrt();
        let numerator = if b >= 0.0 { 2.0 * s } else { root - b };
        let other = if b >= 0.0 { b + root } else { 2.0 * self.weight * rest };
        self.start + numerator / ((numerator + other).max(1e-30) * self.inverse_width)
    }
}

impl From<&Cell> for CellF32 {
    fn from(cell: &Cell) -> Self {
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
}

impl RadialCell<f32> for CellF32 {
    #[inline(always)]
    fn shares(&self) -> [f32; 3] {
        [self.within, self.share, self.beyond]
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
}
