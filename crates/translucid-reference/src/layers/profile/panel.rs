//! Light that grows along a ray through a panel of depths.
//!
//! With the complex extinction σ = σ_t + i k sin θ cos φ a ray of the cosine μ takes sources S up by
//!
//! ```text
//! I(z) = e^{−σ(z − a)/μ} I(a) + (1/μ) ∫_a^z e^{−σ(z − z')/μ} S(z') dz'
//! ```
//!
//! S is a polynomial through the panel's Gauss–Legendre nodes, so that grazing and quickly varying rays are as exact as any.
//! The integrals J_n of e^{−s(x − x')} P_n(x') from −1 to x obey
//!
//! ```text
//! s (J_{n+1} − J_{n−1}) + (2n + 1) J_n = P_{n+1}(x) − P_{n−1}(x)
//! ```
//!
//! which is solved upwards for large s, and as a system for small s, where that would lose all digits.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8};
use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use crate::exact::complex::exp;

/// Nodes on [−1, 1] with polynomials there.
#[derive(Clone, Debug)]
pub(super) struct PanelRule {
    pub(super) nodes: Vec<(f64, f64)>,
    /// (2n + 1)/2 w_p P_n(x_p) by n, then p.
    projection: Vec<f64>,
    /// P_{n+1}(x) − P_{n−1}(x) by node, the end last, then n.
    slopes: Vec<Vec<f64>>,
}

/// Real and imaginary parts at a panel's nodes, then at its end; zeros fill them up to whole vectors.
pub(super) type Column = [[f64; ROWS]; 2];

/// Most nodes of a panel, and one more.
const ROWS: usize = 8;

/// What sources at the nodes, and light that comes into the panel, do to the nodes and the panel's end.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    /// By node of the source.
    sources: Vec<Column>,
    /// e^{−σ(z − a)/μ}.
    pub(super) passed: Column,
}

impl Panel {
    /// Light at the nodes and the end from what arrives and from sources, real parts first.
    #[inline(always)]
    pub(super) fn light<S: Simd>(&self, simd: S, arriving: Complex64, sources: [&[f64]; 2]) -> Column {
        let mut light = times(simd, &self.passed, arriving.re, arriving.im);
        for (column, (re, im)) in self.sources.iter().zip(sources[0].iter().zip(sources[1])) {
            let [a, b] = times(simd, column, *re, *im);
            light = [light[0] + a, light[1] + b];
        }
        [light[0].to_array(), light[1].to_array()]
    }
}

/// A column times a complex number.
#[inline(always)]
fn times<S: Simd>(simd: S, [re, im]: &Column, a: f64, b: f64) -> [f64x8<S>; 2] {
    let [re, im] = [f64x8::from_slice(simd, re), f64x8::from_slice(simd, im)];
    [re * a - im * b, re * b + im * a]
}

/// Terms of the system of small s beyond the polynomials of a panel.
const BEYOND: usize = 16;

impl PanelRule {
    pub(super) fn new(count: usize) -> Self {
        let nodes = gauss_legendre(count);
        let polynomials = |x: f64| legendre(x, count + BEYOND + 2);
        let mut projection = vec![0.0; count * count];
        for (p, (x, weight)) in nodes.iter().enumerate() {
            for (n, value) in polynomials(*x)[..count].iter().enumerate() {
                projection[n * count + p] = 0.5 * (2 * n + 1) as f64 * weight * value;
            }
        }
        let ends = nodes.iter().map(|(x, _)| *x).chain([1.0]);
        let slopes = ends.map(|x| {
            let values = polynomials(x);
            (0..count + BEYOND + 1)
                .map(|n| values[n + 1] - if n == 0 { 0.0 } else { values[n - 1] })
                .collect()
        });
        Self { slopes: slopes.collect(), projection, nodes }
    }

    /// Panel of the thickness h for a ray of the extinction σ.
    pub(super) fn panel(&self, thickness: f64, extinction: Complex64, cosine: f64) -> Panel {
        let count = self.nodes.len();
        let half = 0.5 * thickness / cosine;
        let s = extinction * half;
        let system = System::new(s, count);
        let mut sources = vec![[[0.0; ROWS]; 2]; count];
        let mut passed = [[0.0; ROWS]; 2];
        let mut integrals = vec![Complex64::ZERO; count + BEYOND + 1];
        for (row, slopes) in self.slopes.iter().enumerate() {
            let x = self.nodes.get(row).map_or(1.0, |node| node.0);
            let decay = exp(-s * (1.0 + x));
            system.integrals(x, decay, slopes, &mut integrals);
            for (integral, projection) in integrals.iter().zip(self.projection.chunks_exact(count)) {
                let scaled = *integral * half;
                for (column, factor) in sources.iter_mut().zip(projection) {
                    column[0][row] += scaled.re * factor;
                    column[1][row] += scaled.im * factor;
                }
            }
            (passed[0][row], passed[1][row]) = (decay.re, decay.im);
        }
        Panel { sources, passed }
    }
}

/// Equations of the J_n for one s.
struct System {
    s: Complex64,
    count: usize,
    /// Inverse pivots from n = 1 on, for small s.
    pivots: Option<Vec<Complex64>>,
}

impl System {
    fn new(s: Complex64, count: usize) -> Self {
        let limit = count as f64;
        let pivots = (s.norm_sqr() < limit * limit).then(|| {
            let mut before = Complex64::ZERO;
            let pivot = |n: usize| {
                before = ((2 * n + 1) as f64 + s * s * before).inv();
                before
            };
            (1..count + BEYOND).map(pivot).collect()
        });
        Self { s, count, pivots }
    }

    /// J₀ … into `integrals`.
    fn integrals(&self, x: f64, decay: Complex64, slopes: &[f64], integrals: &mut [Complex64]) {
        let s = self.s;
        let way = 1.0 + x;
        integrals[0] = if s.norm_sqr() * way * way < 1e-8 {
            let t = s * way;
            way * (1.0 - t * (0.5 - t / 6.0 * (1.0 - 0.25 * t)))
        } else {
            (1.0 - decay) / s
        };
        match &self.pivots {
            None => {
                let inverse = s.inv();
                integrals[1] = (x + decay - integrals[0]) * inverse;
                for n in 1..self.count - 1 {
                    integrals[n + 1] =
                        integrals[n - 1] + (slopes[n] - (2 * n + 1) as f64 * integrals[n]) * inverse;
                }
            }
            Some(pivots) => {
                // −s J_{n−1} + (2n + 1) J_n + s J_{n+1} = slope, by elimination
                let last = pivots.len();
                let mut right = slopes[1] + s * integrals[0];
                integrals[1] = right;
                for n in 2..=last {
                    right = slopes[n] + s * pivots[n - 2] * right;
                    integrals[n] = right;
                }
                let mut next = Complex64::ZERO;
                for n in (1..=last).rev() {
                    next = (integrals[n] - s * next) * pivots[n - 1];
                    integrals[n] = next;
                }
            }
        }
    }
}

/// P₀ … of x.
fn legendre(x: f64, count: usize) -> Vec<f64> {
    let mut values = vec![1.0, x];
    for l in 1..count.max(2) - 1 {
        let order = l as f64;
        values.push(((2.0 * order + 1.0) * x * values[l] - order * values[l - 1]) / (order + 1.0));
    }
    values
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    /// Polynomials as sources, by a fine rule.
    #[test]
    fn panel_is_the_integral_along_the_ray() {
        let (rule, fine) = (PanelRule::new(6), gauss_legendre(200));
        let polynomial = |x: f64| 1.0 + x - 2.0 * x * x + 0.5 * x * x * x * x * x;
        for extinction in [
            Complex64::new(1e-7, 0.0),
            Complex64::new(0.3, 2.0),
            Complex64::new(5.0, 3.0),
            Complex64::new(1.0, 5.9),
            Complex64::new(40.0, 100.0),
        ] {
            let panel = rule.panel(1.0, extinction, 0.5);
            let values: Vec<f64> = rule.nodes.iter().map(|(x, _)| polynomial(*x)).collect();
            let [re, im] =
                dispatch!(Level::new(), simd => panel.light(simd, Complex64::ZERO, [&values, &[0.0; 6]]));
            for row in 0..7 {
                let x = rule.nodes.get(row).map_or(1.0, |node| node.0);
                let found = Complex64::new(re[row], im[row]);
                let expected: Complex64 = fine
                    .iter()
                    .map(|(y, weight)| {
                        let way = 0.5 * (1.0 + x) * (1.0 + y);
                        exp(-extinction * way) * polynomial(x - way) * (0.5 * (1.0 + x) * weight)
                    })
                    .sum();
                assert!((found - expected).norm() < 1e-10, "{extinction} {row}: {found} {expected}");
            }
        }
    }
}
