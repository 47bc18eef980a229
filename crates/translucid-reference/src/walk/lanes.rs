//! Functions of random words that a walk needs, in 16 single-precision lanes.
//!
//! Each function turns one word per lane into one variate, without a branch, and with the same operations on
//! every instruction set: the bits are the same everywhere. A multiply-add is fused ([`FusedMulAdd`]).
//!
//! A word's last bit is set before use: the odd numbers are the midpoints of 2³¹ cells, so that u is never 0,
//! its mean is exactly ½, and the logarithm reaches to 22 mean free paths.
//!
//! The polynomials interpolate in Chebyshev nodes; `coefficients_interpolate_in_chebyshev_nodes` computes them
//! anew.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, SimdInto, f32x16, i32x16, u32x16};

/// 16 numbers.
pub(crate) type Floats<S> = f32x16<S>;
/// 16 words.
pub(crate) type Words<S> = u32x16<S>;

/// Multiplies and adds with one rounding.
///
/// That is an instruction of AVX2, AVX-512 and NEON, and a few dozen of plain SSE: there it is a function that is called, or
/// the kernel for SSE2 would be six times as much code, and most of what the compiler does for this crate.
pub(crate) trait FusedMulAdd<S: Simd>: Sized {
    /// `self` · `factor` + `term`.
    fn fused_mul_add(self, factor: impl SimdInto<Self, S>, term: impl SimdInto<Self, S>) -> Self;
}

impl<S: Simd> FusedMulAdd<S> for Floats<S> {
    #[inline(always)]
    fn fused_mul_add(self, factor: impl SimdInto<Self, S>, term: impl SimdInto<Self, S>) -> Self {
        let simd = self.simd;
        if is_narrow(simd) {
            return called_mul_add(self, factor.simd_into(simd), term.simd_into(simd));
        }
        self.mul_add_precise(factor, term)
    }
}

#[inline(never)]
fn called_mul_add<S: Simd>(a: Floats<S>, b: Floats<S>, c: Floats<S>) -> Floats<S> {
    a.mul_add_precise(b, c)
}

/// Returns whether the vectors of an instruction set are so narrow, and its instructions so few, that sixteen lanes are much code:
/// it has no fused multiply-add, and moves single lanes faster than it compresses and expands vectors.
#[inline(always)]
pub(crate) fn is_narrow<S: Simd>(simd: S) -> bool {
    let level = simd.level();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if matches!(level, fearless_simd::Level::Sse2(_) | fearless_simd::Level::Sse4_2(_)) {
        return true;
    }
    level.is_fallback()
}

/// ln(1 + t)/t on [√½ − 1, √2 − 1]: worst relative error 3.0e-8.
const LOG: [f32; 9] = [
    0.9999999741310671,
    -0.4999999638212397,
    0.33334193286134783,
    -0.2500135218548881,
    0.1995593335838607,
    -0.16577992896965354,
    0.1497740128027745,
    -0.14269258205143867,
    0.08533313081257721,
];

/// sin(π√q/4)/√q on [0, 1]: worst relative error 3.4e-9.
const SIN: [f32; 4] =
    [0.7853981609766182, -0.0807454347081001, 0.0024900068014893353, -3.595429072327398e-05];

/// cos(π√q/4) on [0, 1]: worst error 2.8e-8.
const COS: [f32; 4] = [0.9999999723284945, -0.3084242518553739, 0.015849910706411854, -0.000318877474892356];

/// Evaluates a polynomial by Horner's rule.
#[inline(always)]
pub(crate) fn polynomial<S: Simd, const N: usize>(
    simd: S,
    x: Floats<S>,
    coefficients: [f32; N],
) -> Floats<S> {
    let mut value = Floats::splat(simd, coefficients[N - 1]);
    for i in (0..N - 1).rev() {
        value = value.fused_mul_add(x, coefficients[i]);
    }
    value
}

/// Evaluates a polynomial of degree 8 by Estrin's scheme: pairs, pairs of pairs, so that no step waits for
/// eight before it.
#[inline(always)]
fn polynomial_8<S: Simd>(simd: S, x: Floats<S>, c: [f32; 9]) -> Floats<S> {
    let pair = |i: usize| x.fused_mul_add(c[i + 1], Floats::splat(simd, c[i]));
    let x2 = x * x;
    let x4 = x2 * x2;
    let low = x2.fused_mul_add(pair(2), pair(0));
    let high = x2.fused_mul_add(pair(6), pair(4));
    x4.fused_mul_add(x4.fused_mul_add(c[8], high), low)
}

/// Uniform in (0, 1].
#[inline(always)]
pub(crate) fn unit<S: Simd>(word: Words<S>) -> Floats<S> {
    (word | 1).to_float::<Floats<S>>() * (1.0 / 4294967296.0)
}

/// Uniform in [−1, 1], symmetric.
#[inline(always)]
pub(crate) fn signed<S: Simd>(word: Words<S>) -> Floats<S> {
    (word | 1).bitcast::<i32x16<S>>().to_float::<Floats<S>>() * (1.0 / 2147483648.0)
}

/// Exponential with mean 1, in [0, 22.2]: −ln u.
///
/// u = 2^−k (1 + t) with 1 + t in [√½, √2) gives k ln 2 − ln(1 + t): no digit is lost where u is near 1.
#[inline(always)]
pub(crate) fn exponential<S: Simd>(simd: S, word: Words<S>) -> Floats<S> {
    const SQRT_HALF: u32 = 0x3f35_04f3;
    // Split 2³² u into a power of two and a factor around 1
    let bits: Words<S> = (word | 1).to_float::<Floats<S>>().bitcast();
    let above = bits - SQRT_HALF;
    let factor: Floats<S> = ((above & 0x007f_ffff) + SQRT_HALF).bitcast();
    let k = (32 - (above >> 23)).bitcast::<i32x16<S>>().to_float::<Floats<S>>();

    let t = factor - 1.0;
    k.fused_mul_add(std::f32::consts::LN_2, -(t * polynomial_8(simd, t, LOG)))
}

/// Uniform on the unit circle.
///
/// 30 bits turn by up to an eighth of the circle, one exchanges the coordinates, one changes both signs.
/// (Not the turn by the word's fraction of 2π, which needs more steps for the same distribution.)
#[inline(always)]
pub(crate) fn circle<S: Simd>(simd: S, word: Words<S>) -> (Floats<S>, Floats<S>) {
    let t = signed(word << 2);
    let q = t * t;
    let sine = t * polynomial(simd, q, SIN);
    let cosine = polynomial(simd, q, COS);
    let exchange = (word & 0x4000_0000).simd_eq(0x4000_0000);
    let sign = word & 0x8000_0000;
    let x = exchange.select(sine, cosine);
    let y = exchange.select(cosine, sine);
    ((x.bitcast::<Words<S>>() ^ sign).bitcast(), (y.bitcast::<Words<S>>() ^ sign).bitcast())
}

/// √(1 − x²) for |x| ≤ 1.
#[inline(always)]
pub(crate) fn complement<S: Simd>(x: Floats<S>) -> Floats<S> {
    // A fused product leaves at most a rounding below 0
    (-x).fused_mul_add(x, 1.0).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    /// Words that reach every corner: small, large, powers of two, and many between.
    fn words() -> Vec<u32> {
        let mut words: Vec<u32> = (0..4096).flat_map(|i| [i, u32::MAX - i, i << 20]).collect();
        words.extend((0..32).flat_map(|k| [1u32 << k, (1u32 << k).wrapping_sub(1), 3 << k]));
        words.extend((0..1_000_000u32).map(|i| i.wrapping_mul(2_654_435_769)));
        words.resize(words.len().next_multiple_of(16), 0);
        words
    }

    /// One of the functions for all words.
    #[inline(always)]
    fn map<S: Simd, T>(simd: S, words: &[u32], f: impl Fn(S, Words<S>) -> [T; 16]) -> Vec<T> {
        words.chunks_exact(16).flat_map(|chunk| f(simd, Words::from_slice(simd, chunk))).collect()
    }

    fn u(word: u32) -> f64 {
        f64::from(word | 1) / 4294967296.0
    }

    #[test]
    fn exponential_is_minus_the_logarithm() {
        let words = words();
        let found =
            dispatch!(Level::new(), simd => map(simd, &words, |simd, w| exponential(simd, w).to_array()));
        for (&word, &found) in words.iter().zip(&found) {
            let exact = -u(word).ln();
            // Two units in the last place, and the word is rounded to 24 bits: 6e-8 of u
            let error = (f64::from(found) - exact).abs();
            assert!(error < 2.4e-7 * exact + 6e-8, "{word:#x}: {found} {exact}");
            assert!(found >= 0.0);
        }
    }

    /// The bias of the lanes: all lengths off by 5e-9, seen in moments over words that lie evenly.
    #[test]
    fn exponential_has_its_moments() {
        let words: Vec<u32> = (0..1 << 20).map(|i| (i << 12) + (1 << 11)).collect();
        let found =
            dispatch!(Level::new(), simd => map(simd, &words, |simd, w| exponential(simd, w).to_array()));
        for power in 1..=3 {
            let mean =
                |x: &mut dyn Iterator<Item = f64>| x.map(|x| x.powi(power)).sum::<f64>() / words.len() as f64;
            let found = mean(&mut found.iter().map(|&x| f64::from(x)));
            let exact = mean(&mut words.iter().map(|&w| -u(w).ln()));
            assert!((found / exact - 1.0).abs() < 1e-8 * f64::from(power), "power {power}: {found} {exact}");
        }
    }

    #[test]
    fn circle_is_the_point_that_its_word_says() {
        let words = words();
        let x = dispatch!(Level::new(), simd => map(simd, &words, |simd, w| circle(simd, w).0.to_array()));
        let y = dispatch!(Level::new(), simd => map(simd, &words, |simd, w| circle(simd, w).1.to_array()));
        for ((&word, &x), &y) in words.iter().zip(&x).zip(&y) {
            let eighth = f64::from(((word << 2) | 1).cast_signed()) / 2147483648.0;
            let (sine, cosine) = (eighth * std::f64::consts::FRAC_PI_4).sin_cos();
            let sign = if word >> 31 == 1 { -1.0 } else { 1.0 };
            let (exact_x, exact_y) = if word >> 30 & 1 == 1 { (sine, cosine) } else { (cosine, sine) };
            let error = (f64::from(x) - sign * exact_x).abs().max((f64::from(y) - sign * exact_y).abs());
            assert!(error < 1.2e-7, "{word:#x}: {x} {y}");
        }
    }

    #[test]
    fn uniforms_stay_in_their_intervals() {
        let words = words();
        let units = dispatch!(Level::new(), simd => map(simd, &words, |_, w| unit(w).to_array()));
        let signs = dispatch!(Level::new(), simd => map(simd, &words, |_, w| signed(w).to_array()));
        for ((&word, &unit), &signed) in words.iter().zip(&units).zip(&signs) {
            assert!(unit > 0.0 && unit <= 1.0 && (f64::from(unit) - u(word)).abs() < 3.1e-8);
            let exact = f64::from((word | 1).cast_signed()) / 2147483648.0;
            assert!(signed.abs() <= 1.0 && (f64::from(signed) - exact).abs() < 3.1e-8);
        }
    }

    #[test]
    fn complement_is_a_number_at_both_ends() {
        let words = words();
        let pairs = dispatch!(Level::new(), simd => map(simd, &words, |_, w| {
            complement(signed(w)).to_array()
        }));
        for (&word, &found) in words.iter().zip(&pairs) {
            let x = f64::from((word | 1).cast_signed() as f32 * (1.0 / 2147483648.0));
            assert!((f64::from(found) - (1.0 - x * x).sqrt()).abs() < 1e-7, "{word:#x}: {found}");
        }
    }

    /// Monomial coefficients of the polynomial through f at the N Chebyshev nodes of [a, b].
    fn interpolate<const N: usize>(f: impl Fn(f64) -> f64, a: f64, b: f64) -> [f64; N] {
        // Divided differences
        let node = |k: usize| {
            0.5 * (a + b) + 0.5 * (b - a) * (std::f64::consts::PI * (k as f64 + 0.5) / N as f64).cos()
        };
        let mut differences: [f64; N] = std::array::from_fn(|k| f(node(k)));
        for order in 1..N {
            for i in (order..N).rev() {
                differences[i] = (differences[i] - differences[i - 1]) / (node(i) - node(i - order));
            }
        }

        // Expand Newton's form
        let mut monomials = [0.0; N];
        for i in (0..N).rev() {
            let before = monomials;
            for power in 0..N {
                let shifted = if power == 0 { differences[i] } else { before[power - 1] };
                monomials[power] = shifted - node(i) * before[power];
            }
        }
        monomials
    }

    #[test]
    fn coefficients_interpolate_in_chebyshev_nodes() {
        use std::f64::consts::{FRAC_PI_4, SQRT_2};
        let log = interpolate::<9>(|t| t.ln_1p() / t, SQRT_2 / 2.0 - 1.0, SQRT_2 - 1.0);
        let sin = interpolate::<4>(|q| (FRAC_PI_4 * q.sqrt()).sin() / q.sqrt(), 0.0, 1.0);
        let cos = interpolate::<4>(|q| (FRAC_PI_4 * q.sqrt()).cos(), 0.0, 1.0);
        assert_eq!(log.map(|c| c as f32), LOG);
        assert_eq!(sin.map(|c| c as f32), SIN);
        assert_eq!(cos.map(|c| c as f32), COS);
    }
}
