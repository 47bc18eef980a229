//! Exponential and logarithm without branches or tables, so that loops over them become vector code.
//!
//! The standard library's `exp` and `ln` are calls into the platform's library: no compiler vectorizes
//! them, and their last digit depends on the platform.
//! These two cost the same alone, several times less in a loop, and give the same bits everywhere.
//! The exponential comes in two lengths of polynomial, [`Double`] for `f64` and [`Single`] for results that will be
//! rounded to `f32`.

/// ln 2 to 32 bits: its product with an exponent is exact.
const LN_2_HIGH: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
/// ln 2 − [`LN_2_HIGH`].
const LN_2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// 1.5·2⁵²: adding it rounds a number to an integer that then stands in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;
/// The fraction bits of an `f64`.
const FRACTION: u64 = (1 << 52) - 1;
/// Arguments beyond this give 0: e^−708 is the last whole power of e that is a normal number.
const GREATEST_EXPONENT: f64 = 708.0;

/// Lengths of the exponential's polynomial.
pub(crate) trait Accuracy {
    /// (e^g − 1 − g) / g² for |g| ≤ ½ ln 2.
    fn exp_tail(g: f64) -> f64;
}

/// The polynomial for results in double precision.
pub(crate) struct Double;

/// The polynomial for results that are rounded to single precision: truncation below 1e-9.
pub(crate) struct Single;

impl Accuracy for Double {
    #[inline(always)]
    fn exp_tail(g: f64) -> f64 {
        polynomial(&INVERSE_FACTORIALS, g)
    }
}

impl Accuracy for Single {
    #[inline(always)]
    fn exp_tail(g: f64) -> f64 {
        polynomial(const { &leading::<7, 12>(&INVERSE_FACTORIALS) }, g)
    }
}

/// 1/n! from n = 2: twelve terms leave 4e-18, seven leave 2e-10 of the value at the ends.
const INVERSE_FACTORIALS: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5_040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// 1/n for odd n from 3, the coefficients of (atanh(s)/s − 1) / z in z = s² ≤ 0.0295: ten terms leave 7e-18 of the value
/// at the ends.
const INVERSE_ODDS: [f64; 10] = [
    1.0 / 3.0,
    1.0 / 5.0,
    1.0 / 7.0,
    1.0 / 9.0,
    1.0 / 11.0,
    1.0 / 13.0,
    1.0 / 15.0,
    1.0 / 17.0,
    1.0 / 19.0,
    1.0 / 21.0,
];

/// The first N of M coefficients.
const fn leading<const N: usize, const M: usize>(all: &[f64; M]) -> [f64; N] {
    let mut first = [0.0; N];
    let mut i = 0;
    while i < N {
        first[i] = all[i];
        i += 1;
    }
    first
}

/// Σ cᵢ xⁱ, even and odd terms apart: half the latency of one Horner chain.
#[inline(always)]
pub(crate) fn polynomial<const N: usize>(c: &[f64; N], x: f64) -> f64 {
    let z = x * x;
    let (mut high, mut low) = (c[N - 1], c[N - 2]);
    let mut i = N - 2;
    while i >= 2 {
        high = high * z + c[i - 1];
        low = low * z + c[i - 2];
        i -= 2;
    }
    // An odd count leaves one term over, which belongs to the chain that began highest.
    if N % 2 == 1 { (high * z + c[0]) + x * low } else { low + x * high }
}

/// e^−t and 1 − e^−t for t ≥ 0, each to full relative accuracy; (0, 1) for t > 708.
#[inline(always)]
pub(crate) fn exp_negative<P: Accuracy>(t: f64) -> (f64, f64) {
    // Split t = k ln 2 − g with |g| ≤ ½ ln 2
    let bounded = t.min(GREATEST_EXPONENT);
    let rounded = bounded * std::f64::consts::LOG2_E + ROUND;
    let k = rounded - ROUND;
    let g = (k * LN_2_HIGH - bounded) + k * LN_2_LOW;

    // Take e^g − 1 and scale by 2^−k
    let e = g + g * g * P::exp_tail(g);
    let scale = f64::from_bits((1023u64 << 52).wrapping_sub(rounded.to_bits() << 52));
    let x = if t > GREATEST_EXPONENT { 0.0 } else { scale + scale * e };
    (x, if k == 0.0 { 0.0 - e } else { 1.0 - x })
}

/// −ln x for a normal number x ≤ 1 given beside y = 1 − x, whose digits count where x is near 1.
#[inline(always)]
pub(crate) fn negative_log(x: f64, y: f64) -> f64 {
    // Split x = 2^k m with m ∈ [√½, √2)
    let root_half = std::f64::consts::FRAC_1_SQRT_2.to_bits();
    let biased = x.to_bits().wrapping_add(1.0f64.to_bits() - root_half);
    let m = f64::from_bits((biased & FRACTION) + root_half);
    let two_52 = 4_503_599_627_370_496.0f64;
    let k = f64::from_bits((biased >> 52) | two_52.to_bits()) - (two_52 + 1023.0);

    // ln(1 + f) = 2 atanh(s) with s = f/(2 + f), as f − s (f − …), where the rounding of s weighs little
    let f = if k == 0.0 { -y } else { m - 1.0 };
    let s = f / (2.0 + f);
    let z = s * s;
    let log_m = f - s * (f - 2.0 * z * polynomial(&INVERSE_ODDS, z));
    0.0 - (k * LN_2_HIGH + (log_m + k * LN_2_LOW))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Worst relative error of e^−t and of 1 − e^−t over t ∈ (0, 700].
    fn worst_of_exp<P: Accuracy>() -> (f64, f64) {
        let mut worst = (0.0f64, 0.0f64);
        for i in 0..200_000 {
            let t = 700.0 * (f64::from(i) / 1e4 - 20.0).exp().min(1.0);
            let (x, y) = exp_negative::<P>(t);
            worst.0 = worst.0.max((x / (-t).exp() - 1.0).abs());
            worst.1 = worst.1.max((y / -(-t).exp_m1() - 1.0).abs());
        }
        worst
    }

    #[test]
    fn exp_negative_agrees_with_the_platform() {
        let (x, y) = worst_of_exp::<Double>();
        assert!(x < 4.5e-16 && y < 4.5e-16, "{x:e} {y:e}");
        let (x, y) = worst_of_exp::<Single>();
        assert!(x < 3e-10 && y < 9e-10, "{x:e} {y:e}");
    }

    #[test]
    fn exp_negative_ends_in_zero() {
        assert_eq!(exp_negative::<Double>(f64::INFINITY), (0.0, 1.0));
        assert_eq!(exp_negative::<Double>(709.0), (0.0, 1.0));
        assert!(exp_negative::<Double>(708.0).0 > 0.0);
        assert_eq!(exp_negative::<Double>(0.0), (1.0, 0.0));
    }

    /// Worst relative error of −ln x over x = 1 − y for y from 1e-18 and x from 1e-300.
    fn worst_of_log() -> f64 {
        let mut worst = 0.0f64;
        for i in 1..200_000 {
            let y = (-f64::from(i) / 5e3).exp();
            worst = worst.max((negative_log(1.0 - y, y) / -(-y).ln_1p() - 1.0).abs());
            let x = (-f64::from(i) / 300.0).exp();
            if x > 1e-300 && x < 0.5 {
                worst = worst.max((negative_log(x, 1.0 - x) / -x.ln() - 1.0).abs());
            }
        }
        worst
    }

    #[test]
    fn negative_log_agrees_with_the_platform() {
        let worst = worst_of_log();
        assert!(worst < 5e-16, "{worst:e}");
        assert_eq!(negative_log(1.0, 0.0).to_bits(), 0);
    }
}
