//! The arithmetic of normalized diffusion for d = ⅓, alone or in a loop.
//!
//! With t = r/3d, x = e^−t and y = 1 − x:
//!
//! ```text
//! density of t        ¾ x (1 + x²)
//! beyond t            (x³ + 3x)/4
//! within t            (y³ − 3y² + 6y)/4
//! quantile            t = −ln x with x³ + 3x = 4(1 − u), so x = 2 sinh(asinh(2 − 2u)/3)
//! ```
//!
//! 1. The cubic's closed form loses digits where the result is near 0 and costs two slow functions.
//!    A short polynomial and one step of Halley's iteration (E. Halley 1694; cubic convergence) reach the
//!    same root to rounding.
//! 2. Below the median the unknown is y, above it x: neither end of the range loses a digit.
//! 3. Both halves run through the same instructions with other coefficients, so a loop has no branch.

use crate::math::elementary::{Double, exp_negative, negative_log, polynomial};

/// Density of t = r/3d.
#[inline(always)]
pub(crate) fn density(t: f64) -> f64 {
    let (x, _) = exp_negative::<Double>(t);
    0.75 * x * (1.0 + x * x)
}

/// Share within t.
#[inline(always)]
pub(crate) fn within(t: f64) -> f64 {
    let (_, y) = exp_negative::<Double>(t);
    0.25 * y * (6.0 + y * (y - 3.0))
}

/// Share beyond t.
#[inline(always)]
pub(crate) fn beyond(t: f64) -> f64 {
    let (x, _) = exp_negative::<Double>(t);
    0.25 * x * (3.0 + x * x)
}

/// The t within which the share u lies, for u and its complement 1 − u, neither below the least normal number.
#[inline(always)]
pub(crate) fn quantile(u: f64, complement: f64) -> f64 {
    // Solve w³ + 3b w² + a w = 4v for w = y below the median, w = x above it
    let below = u < complement;
    let v = if below { u } else { complement };
    let (a, b) = if below { (6.0, -1.0) } else { (3.0, 0.0) };
    let w = halley_step(v * root_start(below, v), a, b, 4.0 * v);

    // Take the logarithm of the one root from both
    let other = 1.0 - w;
    let (x, y) = if below { (other, w) } else { (w, other) };
    negative_log(x, y)
}

/// Start for the root of the cubic for v ∈ [0, ½], divided by v: below the median that of
/// 1 − 2 sinh(asinh(2 − 2v)/3), above it that of 2 sinh(asinh(2v)/3).
#[inline(always)]
fn root_start(below: bool, v: f64) -> f64 {
    polynomial(&select(below, &LOWER_START_7, &UPPER_START_7), v)
}

/// Interpolates the upper root, divided by v, at 7 Chebyshev nodes of [0, ½]; relative error 9.6e-7.
/// The test `starts_interpolate_the_closed_form` generates this and the three below.
const UPPER_START_7: [f64; 7] = [
    1.333334667377,
    -0.000264753174,
    -0.781116505208,
    -0.120348233635,
    2.203447830642,
    -2.794490533996,
    1.208069000754,
];
/// Interpolates as [`UPPER_START_7`] at 3 nodes; relative error 2.1e-3.
pub(crate) const UPPER_START_3: [f64; 3] = [1.335729962834, -0.084045038434, -0.415636555539];
/// Interpolates the lower root, divided by v, at 7 Chebyshev nodes of [0, ½]; relative error 6.7e-8.
const LOWER_START_7: [f64; 7] = [
    0.666666624525,
    0.222230458705,
    0.098505670234,
    0.044179572342,
    -0.005445474776,
    0.039452466490,
    -0.061855209920,
];
/// Interpolates as [`LOWER_START_7`] at 3 nodes; relative error 2.6e-4.
pub(crate) const LOWER_START_3: [f64; 3] = [0.666836310006, 0.216112787158, 0.131340762512];

/// One of two coefficient sets, chosen number by number: a branch here would keep a loop from being vectorized.
#[inline(always)]
fn select<const N: usize>(first: bool, a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    std::array::from_fn(|i| if first { a[i] } else { b[i] })
}

/// One step of Halley's iteration w − f f'/(f'² − f f''/2) for f = w³ + 3b w² + a w − right.
#[inline(always)]
fn halley_step(w: f64, a: f64, b: f64, right: f64) -> f64 {
    let f = w * (a + w * (w + 3.0 * b)) - right;
    let third_slope = w * (w + 2.0 * b) + a / 3.0;
    let sixth_curvature = w + b;
    w - f * third_slope / (3.0 * third_slope * third_slope - f * sixth_curvature)
}

/// Mixture sampling with one number: with probability ¼ the exponential of rate 3, otherwise that of rate 1.
#[inline(always)]
pub(crate) fn sample(u: f64) -> f64 {
    let narrow = u < 0.25;
    let rescaled = if narrow { 4.0 * u } else { (u - 0.25) * (4.0 / 3.0) };
    // The greatest u below 1 may round up to 1.
    let rescaled = rescaled.min(1.0 - f64::EPSILON / 2.0);
    let width = if narrow { 1.0 / 3.0 } else { 1.0 };
    width * negative_log(1.0 - rescaled, rescaled)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Above the median the closed form, polished by a Newton step; below it, where the closed form loses its
    /// digits, six Newton steps from the slope at 0.
    fn slow_quantile(u: f64, complement: f64) -> f64 {
        if complement <= 0.5 {
            let x = 2.0 * ((2.0 * complement).asinh() / 3.0).sinh();
            return -(x - (x * (3.0 + x * x) - 4.0 * complement) / (3.0 * (1.0 + x * x))).ln();
        }
        let step = |y: f64| y - (y * (6.0 + y * (y - 3.0)) - 4.0 * u) / (3.0 * (2.0 + y * (y - 2.0)));
        -(-(0..6).fold(2.0 / 3.0 * u, |y, _| step(y))).ln_1p()
    }

    fn worst_of_quantile() -> f64 {
        let mut worst = 0.0f64;
        for i in 1..200_000 {
            let v = 0.5 * (-f64::from(i) / 300.0).exp();
            if v > 1e-280 {
                worst = worst.max((quantile(v, 1.0 - v) / slow_quantile(v, 1.0 - v) - 1.0).abs());
                worst = worst.max((quantile(1.0 - v, v) / slow_quantile(1.0 - v, v) - 1.0).abs());
            }
            let v = f64::from(i) / 400_000.0;
            worst = worst.max((quantile(1.0 - v, v) / slow_quantile(1.0 - v, v) - 1.0).abs());
            let v = v + 1e-9;
            worst = worst.max((quantile(v, 1.0 - v) / slow_quantile(v, 1.0 - v) - 1.0).abs());
        }
        worst
    }

    /// Polynomial of n terms through f(v)/v at the Chebyshev nodes of [0, ½], by Newton's divided differences.
    fn chebyshev_interpolant(n: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let node = |k: usize| 0.25 + 0.25 * (std::f64::consts::PI * (k as f64 + 0.5) / n as f64).cos();
        let mut differences: Vec<f64> = (0..n).map(|k| f(node(k)) / node(k)).collect();
        for order in 1..n {
            for k in (order..n).rev() {
                differences[k] = (differences[k] - differences[k - 1]) / (node(k) - node(k - order));
            }
        }
        let mut coefficients = vec![0.0; n];
        for k in (0..n).rev() {
            for i in (1..n).rev() {
                coefficients[i] = coefficients[i - 1] - node(k) * coefficients[i];
            }
            coefficients[0] = differences[k] - node(k) * coefficients[0];
        }
        coefficients
    }

    fn upper_root(v: f64) -> f64 {
        2.0 * ((2.0 * v).asinh() / 3.0).sinh()
    }

    fn lower_root(v: f64) -> f64 {
        1.0 - upper_root(1.0 - v)
    }

    #[test]
    fn starts_interpolate_the_closed_form() {
        let check = |found: &[f64], f: fn(f64) -> f64, worst_stated: f64| {
            let expected = chebyshev_interpolant(found.len(), f);
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9, "{found} is not {expected} of {expected:?}");
            }
            let value = |v: f64| found.iter().rev().fold(0.0, |sum, c| sum * v + c) * v;
            let worst = (1..=1000).map(|i| f64::from(i) / 2000.0).map(|v| (value(v) / f(v) - 1.0).abs());
            let worst = worst.fold(0.0, f64::max);
            assert!(worst < worst_stated, "{worst:e} against {worst_stated:e}");
        };
        check(&UPPER_START_7, upper_root, 9.6e-7);
        check(&UPPER_START_3, upper_root, 2.1e-3);
        check(&LOWER_START_7, lower_root, 6.7e-8);
        check(&LOWER_START_3, lower_root, 2.6e-4);
    }

    #[test]
    fn quantile_equals_the_closed_form() {
        let worst = worst_of_quantile();
        assert!(worst < 2e-15, "{worst:e}");
    }

    #[test]
    fn quantile_is_continuous_at_the_median() {
        let before = quantile(0.5 - f64::EPSILON / 4.0, 0.5 + f64::EPSILON / 4.0);
        let after = quantile(0.5, 0.5);
        assert!((after / before - 1.0).abs() < 1e-15, "{before} {after}");
    }
}
