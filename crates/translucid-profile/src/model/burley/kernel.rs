//! The arithmetic of normalized diffusion for d = ⅓, shared by both precisions, alone or in a loop.
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

use crate::math::elementary::{Accuracy, exp_negative, negative_log};

/// Density of t = r/3d.
#[inline(always)]
pub(crate) fn density<P: Accuracy>(t: f64) -> f64 {
    let (x, _) = exp_negative::<P>(t);
    0.75 * x * (1.0 + x * x)
}

/// Share within t.
#[inline(always)]
pub(crate) fn within<P: Accuracy>(t: f64) -> f64 {
    let (_, y) = exp_negative::<P>(t);
    0.25 * y * (6.0 + y * (y - 3.0))
}

/// Share beyond t.
#[inline(always)]
pub(crate) fn beyond<P: Accuracy>(t: f64) -> f64 {
    let (x, _) = exp_negative::<P>(t);
    0.25 * x * (3.0 + x * x)
}

/// The t within which the share u lies, for u and its complement 1 − u, neither below the least normal number.
#[inline(always)]
pub(crate) fn quantile<P: Accuracy>(u: f64, complement: f64) -> f64 {
    // Solve w³ + 3b w² + a w = 4v for w = y below the median, w = x above it
    let below = u < complement;
    let v = if below { u } else { complement };
    let (a, b) = if below { (6.0, -1.0) } else { (3.0, 0.0) };
    let w = halley_step(v * P::root_start(below, v), a, b, 4.0 * v);

    // Take the logarithm of the one root from both
    let other = 1.0 - w;
    let (x, y) = if below { (other, w) } else { (w, other) };
    negative_log::<P>(x, y)
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
pub(crate) fn sample<P: Accuracy>(u: f64) -> f64 {
    let narrow = u < 0.25;
    let rescaled = if narrow { 4.0 * u } else { (u - 0.25) * (4.0 / 3.0) };
    // The greatest u below 1 may round up to 1.
    let rescaled = rescaled.min(1.0 - f64::EPSILON / 2.0);
    let width = if narrow { 1.0 / 3.0 } else { 1.0 };
    width * negative_log::<P>(1.0 - rescaled, rescaled)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elementary::{Double, Single};

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

    fn worst_of_quantile<P: Accuracy>() -> f64 {
        let mut worst = 0.0f64;
        for i in 1..200_000 {
            let v = 0.5 * (-f64::from(i) / 300.0).exp();
            if v > 1e-280 {
                worst = worst.max((quantile::<P>(v, 1.0 - v) / slow_quantile(v, 1.0 - v) - 1.0).abs());
                worst = worst.max((quantile::<P>(1.0 - v, v) / slow_quantile(1.0 - v, v) - 1.0).abs());
            }
            let v = f64::from(i) / 400_000.0;
            worst = worst.max((quantile::<P>(1.0 - v, v) / slow_quantile(1.0 - v, v) - 1.0).abs());
            let v = v + 1e-9;
            worst = worst.max((quantile::<P>(v, 1.0 - v) / slow_quantile(v, 1.0 - v) - 1.0).abs());
        }
        worst
    }

    #[test]
    fn quantile_equals_the_closed_form() {
        let worst = worst_of_quantile::<Double>();
        assert!(worst < 2e-15, "{worst:e}");
        let worst = worst_of_quantile::<Single>();
        assert!(worst < 1e-8, "{worst:e}");
    }

    #[test]
    fn quantile_is_continuous_at_the_median() {
        let before = quantile::<Double>(0.5 - f64::EPSILON / 4.0, 0.5 + f64::EPSILON / 4.0);
        let after = quantile::<Double>(0.5, 0.5);
        assert!((after / before - 1.0).abs() < 1e-15, "{before} {after}");
    }
}
