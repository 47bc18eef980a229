//! Deflection by any phase function, in 16 lanes: its inverse cumulative distribution as a table.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use fearless_simd::Simd;
use fearless_simd::prelude::*;

use super::lanes::{Floats, FusedMulAdd, Words};
use crate::phase_function::PhaseFunction;

/// Bits of a word that choose a cell.
const BITS: u32 = 14;
const CELLS: usize = 1 << BITS;

/// Versines 1 − cos θ between cells of equal probability, in which the versine is uniform.
///
/// Moments are right to 1e-6, to 3e-6 where p spans five orders of magnitude, and to 6e-5, the probability of a cell, where
/// p is 0 over a wide range of angles.
#[derive(PartialEq)]
pub(crate) struct DeflectionTable {
    /// Least versine of each cell.
    starts: [f32; CELLS],
    /// Versine from its start to its end.
    widths: [f32; CELLS],
}

/// How angles of deflection are drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum DeflectionLaw {
    Isotropic,
    HenyeyGreenstein {
        g: f64,
    },
    Rayleigh,
    /// Any other phase function.
    Table(Arc<DeflectionTable>),
}

impl DeflectionLaw {
    /// Law of a phase function that is fit [for a walk](PhaseFunction::check_for_walk).
    pub(crate) fn new(phase_function: &PhaseFunction) -> Self {
        match phase_function {
            PhaseFunction::HenyeyGreenstein { g: 0.0 } => Self::Isotropic,
            PhaseFunction::HenyeyGreenstein { g } => Self::HenyeyGreenstein { g: *g },
            PhaseFunction::Rayleigh => Self::Rayleigh,
            other => Self::Table(Arc::new(DeflectionTable::new(other))),
        }
    }
}

impl DeflectionTable {
    fn new(phase_function: &PhaseFunction) -> Self {
        let mut edges = vec![0.0];
        for cell in 1..CELLS {
            let least = edges[cell - 1];
            edges.push(versine_of(phase_function, cell as f64 / CELLS as f64, least));
        }
        edges.push(2.0);
        Self {
            starts: std::array::from_fn(|cell| edges[cell] as f32),
            widths: std::array::from_fn(|cell| (edges[cell + 1] - edges[cell]) as f32),
        }
    }
    /// The versine of a word, which chooses the cell by its first bits and the place in it by the others.
    #[inline(always)]
    pub(crate) fn versine<S: Simd>(&self, simd: S, word: Words<S>) -> Floats<S> {
        let cells = (word >> (32 - BITS)).to_array();
        let starts = Floats::from_fn(simd, |i| self.starts[cells[i] as usize & (CELLS - 1)]);
        let widths = Floats::from_fn(simd, |i| self.widths[cells[i] as usize & (CELLS - 1)]);
        let place = ((word << BITS) | (1 << (BITS - 1))).to_float::<Floats<S>>() * (1.0 / 4294967296.0);
        place.fused_mul_add(widths, starts).min(2.0)
    }
}

impl fmt::Debug for DeflectionTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeflectionTable").finish_non_exhaustive()
    }
}

/// Versine from `least` on below which deflections have a probability, by Newton's steps within a shrinking interval.
fn versine_of(phase_function: &PhaseFunction, probability: f64, least: f64) -> f64 {
    let (mut low, mut high) = (least, 2.0);
    let mut versine = 0.5 * (low + high);
    for _ in 0..200 {
        let excess = 1.0 - phase_function.cdf(1.0 - versine) - probability;
        if excess < 0.0 {
            low = versine;
        } else {
            high = versine;
        }
        let next = versine - excess / (2.0 * PI * phase_function.eval(1.0 - versine));
        // Also where there is no slope; by ratios as long as the interval spans orders of magnitude
        let middle = if high > 4.0 * low && low > 0.0 { (low * high).sqrt() } else { 0.5 * (low + high) };
        let next = if next > low && next < high { next } else { middle };
        if (next - versine).abs() <= 1e-12 * next {
            break;
        }
        versine = next;
    }
    versine
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;
    use crate::phase_table::PhaseTable;

    /// Cosines of words that lie evenly.
    fn cosines(phase_function: &PhaseFunction) -> Vec<f64> {
        #[inline(always)]
        fn map<S: Simd>(simd: S, table: &DeflectionTable) -> Vec<f64> {
            let words: Vec<u32> = (0..1 << 20).map(|i| (i << 12) + (1 << 11)).collect();
            let versines =
                words.chunks_exact(16).map(|chunk| table.versine(simd, Words::from_slice(simd, chunk)));
            versines
                .flat_map(|versines| versines.to_array().map(|versine| 1.0 - f64::from(versine)))
                .collect()
        }
        let table = DeflectionTable::new(phase_function);
        dispatch!(Level::new(), simd => map(simd, &table))
    }

    #[test]
    fn versines_have_the_moments_and_the_distribution() {
        let mie_like = |i: i32| {
            // A peak, a smooth flank, and a glory, which spans five orders of magnitude
            let x = f64::from(i) / 500.0 - 1.0;
            [x, libm::exp(12.0 * (x - 1.0)) + 1e-4 + 1e-3 * libm::exp(-40.0 * (x + 1.0))]
        };
        let table = PhaseTable::new((0..=1000).map(mie_like).collect()).unwrap();
        let gap = PhaseTable::new(vec![[-1.0, 1.0], [-0.5, 0.0], [0.5, 0.0], [1.0, 1.0]]).unwrap();
        for (phase_function, tolerance) in [
            (PhaseFunction::HenyeyGreenstein { g: 0.95 }, 1e-6),
            (PhaseFunction::HenyeyGreenstein { g: -0.8 }, 1e-6),
            (PhaseFunction::Rayleigh, 1e-6),
            (PhaseFunction::TwoTerm { weight: 0.9, g1: 0.9, g2: -0.4 }, 1e-6),
            (PhaseFunction::Moments([0.0, 0.1].into()), 1e-6),
            (PhaseFunction::Table(Arc::new(table)), 3e-6),
            (PhaseFunction::Table(Arc::new(gap)), 1.0 / CELLS as f64),
        ] {
            let mut found = cosines(&phase_function);
            for l in 1..=20usize {
                let legendre = |x: f64| {
                    let (mut before, mut now) = (1.0, x);
                    for n in 1..l {
                        let n = n as f64;
                        (before, now) = (now, ((2.0 * n + 1.0) * x * now - n * before) / (n + 1.0));
                    }
                    now
                };
                let moment = found.iter().map(|x| legendre(*x)).sum::<f64>() / found.len() as f64;
                let expected = phase_function.moment(l);
                assert!((moment - expected).abs() < tolerance, "{phase_function:?} {l}: {moment} {expected}");
            }
            found.sort_by(f64::total_cmp);
            for (i, cosine) in found.iter().enumerate().step_by(1 << 10) {
                let expected = (i as f64 + 0.5) / found.len() as f64;
                let cdf = phase_function.cdf(*cosine);
                assert!(
                    (cdf - expected).abs() < 0.3 / CELLS as f64,
                    "{phase_function:?} {cosine}: {cdf} {expected}"
                );
            }
        }
    }
}
