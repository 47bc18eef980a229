//! Zeros of the dispersion function, and its regular part.
//!
//! In a medium of isotropic scatterers a plane wave of wave number K is attenuated by scattering as the function
//!
//! ```text
//! Λ(K) = 1 − α atan(K)/K
//! ```
//!
//! says, where K² = k² + t², k lateral and t in depth (K. M. Case and P. F. Zweifel 1967, *Linear Transport
//! Theory*, chapter 4). Its zeros are K = ±i k₀, the wave that decays as slowly as any can; it has branch points at
//! K = ±i. What is left without them,
//!
//! ```text
//! Λ(K) = (K² + k₀²)/(K² + 1) · Λ̃(K),
//! ```
//!
//! has no zero, tends to 1 and is smooth on the scale of √(K² + 1).

use num_complex::Complex64;

use super::complex::{ln, ln_1p, sqrt};

/// Below this size of K² and k₀² power series do.
const SERIES_MAX: f64 = 0.1;
/// Terms of the series: the next is below `SERIES_MAX`^17/35 = 3e-19.
const SERIES_TERMS: i32 = 17;

/// The dispersion function of one single-scattering albedo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dispersion {
    /// α.
    pub(crate) single_scattering_albedo: f64,
    /// k₀ ∈ [0, 1]: the slowest decay per mean free path, with α atanh(k₀)/k₀ = 1.
    pub(crate) k0: f64,
    /// 1 − k₀², with every digit where k₀ is close to 1.
    pub(crate) one_minus_k0_squared: f64,
}

impl Dispersion {
    /// For α ∈ (0, 1].
    pub(crate) fn new(single_scattering_albedo: f64) -> Self {
        let alpha = single_scattering_albedo;
        if alpha < 0.8 {
            let gap = gap_to_one(alpha);
            Self { single_scattering_albedo, k0: 1.0 - gap, one_minus_k0_squared: gap * (2.0 - gap) }
        } else {
            let k0_squared = square_of_zero(alpha);
            Self { single_scattering_albedo, k0: k0_squared.sqrt(), one_minus_k0_squared: 1.0 - k0_squared }
        }
    }

    /// ln Λ̃ for the wave number K given as K² + k₀², whose digits count where Λ is close to its zero.
    pub(crate) fn ln_regular_part(&self, k_squared_plus_k0_squared: Complex64) -> Complex64 {
        let Self { single_scattering_albedo: alpha, k0, one_minus_k0_squared } = *self;
        let from_zero = k_squared_plus_k0_squared;
        let from_branch = from_zero + one_minus_k0_squared;
        let k0_squared = k0 * k0;
        let minus_k_squared = k0_squared - from_zero;

        // Divide by K² + k₀² before subtracting where both are small
        if k0_squared < SERIES_MAX && minus_k_squared.norm_sqr() < SERIES_MAX * SERIES_MAX {
            let slope = divided_difference_of_series(k0_squared, minus_k_squared);
            return ln(slope * from_branch * alpha);
        }
        let kappa = sqrt(minus_k_squared);
        let k_is_small = minus_k_squared.norm_sqr() < SERIES_MAX * SERIES_MAX;
        // atanh κ = ½ ln[(1+κ)²/(1−κ²)], where 1 − κ² = K² + 1 is known better than 1 − κ
        if !k_is_small && k0_squared > 0.05 && from_zero.norm_sqr() < (0.25 * one_minus_k0_squared).powi(2) {
            // atanh k₀/k₀ − atanh κ/κ from k₀ − κ = (K² + k₀²)/(k₀ + κ)
            let difference = from_zero / (kappa + k0);
            let atanh_difference =
                0.5 * ln_1p(from_zero / one_minus_k0_squared) - ln_1p(-difference / (1.0 + k0));
            let atanh = k0 / alpha - atanh_difference;
            let value = alpha * (atanh_difference / k0 - atanh * difference / (k0 * kappa));
            return if from_zero.norm_sqr() > 0.0 {
                ln(value / from_zero * from_branch)
            } else {
                // The slope of Λ in K² at its zero
                ln(from_branch * ((alpha / one_minus_k0_squared - 1.0) / (2.0 * k0_squared)))
            };
        }
        let atanh_ratio = if k_is_small {
            atanh_ratio_series(minus_k_squared)
        } else {
            let one_plus = 1.0 + kappa;
            0.5 * ln(one_plus * one_plus / from_branch) / kappa
        };
        // Λ̃ − 1, which is small for large K
        let excess = (one_minus_k0_squared - alpha * atanh_ratio * from_branch) / from_zero;
        ln_1p(excess)
    }
}

/// 1 − k₀ for α < 0.8, by Newton's iteration on its logarithm, in which the equation is nearly straight.
fn gap_to_one(alpha: f64) -> f64 {
    let alpha = alpha.max(1e-3); // where the gap is far below the least number
    let mut ln_gap = std::f64::consts::LN_2 - 2.0 / alpha;
    for _ in 0..20 {
        let gap = libm::exp(ln_gap);
        let value = ln_gap - libm::log(2.0 - gap) + 2.0 * (1.0 - gap) / alpha;
        let slope = 1.0 + gap / (2.0 - gap) - 2.0 * gap / alpha;
        ln_gap -= value / slope;
    }
    libm::exp(ln_gap)
}

/// k₀² for α ≥ 0.8, by Newton's iteration from above on α(atanh(√y)/√y − 1) = 1 − α, whose left side is convex.
fn square_of_zero(alpha: f64) -> f64 {
    let mut y = (3.0 * (1.0 - alpha) / alpha).min(0.9);
    for _ in 0..12 {
        let (value, slope) = atanh_ratio_minus_1(y);
        y = (y - (alpha * value - (1.0 - alpha)) / (alpha * slope)).max(0.0);
    }
    y
}

/// atanh(√y)/√y − 1 and its slope in y, for y ∈ [0, 1).
fn atanh_ratio_minus_1(y: f64) -> (f64, f64) {
    if y < SERIES_MAX {
        let (mut value, mut slope) = (0.0, 0.0);
        for n in (1..=SERIES_TERMS).rev() {
            let coefficient = 1.0 / f64::from(2 * n + 1);
            slope = slope * y + f64::from(n) * coefficient;
            value = value * y + coefficient;
        }
        return (value * y, slope);
    }
    let ratio = libm::atanh(y.sqrt()) / y.sqrt();
    (ratio - 1.0, (1.0 / (1.0 - y) - ratio) / (2.0 * y))
}

/// φ(y) = atanh(√y)/√y = Σ yⁿ/(2n+1) for small y.
fn atanh_ratio_series(y: Complex64) -> Complex64 {
    (0..=SERIES_TERMS).rev().fold(Complex64::ZERO, |sum, n| sum * y + 1.0 / f64::from(2 * n + 1))
}

/// [φ(a) − φ(b)]/(a − b) of φ(y) = atanh(√y)/√y = Σ yⁿ/(2n+1), for small a and b.
fn divided_difference_of_series(a: f64, b: Complex64) -> Complex64 {
    // (aⁿ − bⁿ)/(a − b) = dₙ with dₙ₊₁ = a dₙ + bⁿ; from the top: Σ cₙ dₙ by Horner in both
    let mut value = Complex64::ZERO;
    let mut tail = 0.0;
    for n in (1..=SERIES_TERMS).rev() {
        // tail = Σ_{m ≥ n} cₘ a^{m−n}
        tail = tail * a + 1.0 / f64::from(2 * n + 1);
        value = value * b + tail;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn k0_is_the_zero() {
        for alpha in [0.05, 0.1, 0.3, 0.5, 0.7, 0.79, 0.81, 0.9, 0.99, 0.9999, 1.0 - 1e-12] {
            let dispersion = Dispersion::new(alpha);
            let k0 = dispersion.k0;
            // atanh k₀ from 1 − k₀², so that no digit is lost near 1
            let near_1 = 0.5 * ((1.0 + k0) * (1.0 + k0) / dispersion.one_minus_k0_squared).ln();
            let atanh = if k0 > 0.9 { near_1 } else { k0.atanh() };
            let off = alpha * atanh / k0 - 1.0;
            assert!(off.abs() < 1e-14, "{alpha}: {off:e}");
        }
        assert_eq!(Dispersion::new(1.0).k0, 0.0);
        // 1 − k₀ → 2e^{−2/α}
        let gap = Dispersion::new(0.02).one_minus_k0_squared / 2.0;
        assert!((gap / (2.0 * (-100f64).exp()) - 1.0).abs() < 1e-12, "{gap:e}");
        assert_eq!(Dispersion::new(1e-320).one_minus_k0_squared, 0.0);
    }

    /// The ways to compute Λ̃ agree where they meet, and with the definition where that has its digits.
    #[test]
    fn regular_part_is_continuous() {
        for alpha in [0.1, 0.5, 0.8, 0.9, 0.94, 0.95, 0.965, 0.967, 0.99, 1.0] {
            let dispersion = Dispersion::new(alpha);
            let k0_squared = dispersion.k0 * dispersion.k0;
            for i in -12..=60 {
                for j in 0..=8 {
                    let modulus = 10f64.powf(0.1 * f64::from(i));
                    let from_zero = Complex64::from_polar(modulus, f64::from(j) * 0.3);
                    let k_squared = from_zero - k0_squared;
                    let k = k_squared.sqrt();
                    let lambda = 1.0 - alpha * k.atan() / k;
                    let expected = (lambda * (k_squared + 1.0) / from_zero).ln();
                    let found = dispersion.ln_regular_part(from_zero);
                    let allowed = 1e-14 + 2e-15 / lambda.norm();
                    assert!((found - expected).norm() < allowed, "{alpha} {from_zero}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn regular_part_is_smooth_at_the_zero() {
        for alpha in [0.1, 0.3, 0.5, 0.8, 0.9, 0.96, 0.97, 0.99, 0.9999] {
            let dispersion = Dispersion::new(alpha);
            let at = |part: f64| {
                dispersion.ln_regular_part(Complex64::from_polar(part * dispersion.one_minus_k0_squared, 1.0))
            };
            let (zero, near, twice) = (at(0.0), at(1e-6), at(2e-6));
            assert!((at(1e-14) - zero).norm() < 1e-12, "{alpha}");
            assert!((twice - 2.0 * near + zero).norm() < 1e-10, "{alpha}: {zero} {near} {twice}");
        }
    }
}
