//! Modified Bessel functions K₀ and K₁ (Macdonald's) for complex arguments in the right half plane.
//!
//! - |z| ≤ 3: power series, M. Abramowitz and I. A. Stegun 1964, 9.6.11–9.6.13.
//! - beyond: the continued fraction CF2 of N. M. Temme 1975, *On the numerical evaluation of the modified Bessel
//!   function of the third kind*, J. Comput. Phys. 19, evaluated by Steed's method.
//! - |z| ≥ 18: Hankel's asymptotic series, Abramowitz and Stegun 9.7.2.

use num_complex::Complex64;

use super::complex::{ln, sqrt};

/// Euler's constant γ.
const EULER_GAMMA: f64 = 0.577_215_664_901_532_9;
/// End of the power series: there K is a difference of numbers a hundred times as large, which costs two digits;
/// the continued fraction takes sixteen steps.
const SERIES_MAX: f64 = 3.0;
/// Terms of the power series: 1.5³⁰/15!² = 1e-19.
const SERIES_TERMS: usize = 15;
/// From here on the asymptotic series reaches 1e-16 before it diverges.
const ASYMPTOTIC_MIN: f64 = 18.0;

/// K₀(z) and K₁(z), with the exponential that they share left out or not.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Macdonald {
    /// K₀(z) and K₁(z) − 1/z, for small z.
    Small {
        /// K₀(z).
        k0: Complex64,
        /// K₁(z) − 1/z.
        k1_minus_pole: Complex64,
    },
    /// e^z K₀(z) and e^z K₁(z).
    Scaled {
        /// e^z K₀(z).
        k0: Complex64,
        /// e^z K₁(z).
        k1: Complex64,
    },
}

impl Macdonald {
    /// For Re z > 0; relative error below 1e-13, at |z| = 3, and mostly 1e-15.
    #[inline(always)]
    pub(crate) fn new(z: Complex64) -> Self {
        let square = z.norm_sqr();
        if square <= SERIES_MAX * SERIES_MAX {
            series(z)
        } else if square < ASYMPTOTIC_MIN * ASYMPTOTIC_MIN {
            continued_fraction(z)
        } else {
            asymptotic(z)
        }
    }
}

/// Taylor series of e^{z₀} K₀(z₀ + δ) for real z₀ > 0: cheaper than the rest for many z close to each other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MacdonaldNear {
    z0: f64,
    coefficients: [f64; TAYLOR_TERMS],
}

/// 0.08¹⁵ = 4e-17 and 0.4¹⁵/15! = 8e-19.
const TAYLOR_TERMS: usize = 15;

impl MacdonaldNear {
    pub(crate) fn new(z0: f64) -> Self {
        let (k0, k1) = match Macdonald::new(z0.into()) {
            Macdonald::Small { k0, k1_minus_pole } => {
                ((k0 * libm::exp(z0)).re, (k1_minus_pole.re + 1.0 / z0) * libm::exp(z0))
            }
            Macdonald::Scaled { k0, k1 } => (k0.re, k1.re),
        };
        let mut c = [0.0; TAYLOR_TERMS];
        (c[0], c[1]) = (k0, -k1);
        // z y'' + y' − z y = 0
        for n in 0..TAYLOR_TERMS - 2 {
            let (low, order) = (if n > 0 { c[n - 1] } else { 0.0 }, n as f64);
            let sum = z0 * c[n] + low - (order + 1.0) * (order + 1.0) * c[n + 1];
            c[n + 2] = sum / (z0 * (order + 2.0) * (order + 1.0));
        }
        Self { z0, coefficients: c }
    }

    /// Greatest |δ| for which the series has its digits.
    pub(crate) fn reach(&self) -> f64 {
        (0.08 * self.z0).min(0.4)
    }

    /// e^{z₀} K₀(z₀ + δ) and e^{z₀} K₁(z₀ + δ).
    #[inline(always)]
    pub(crate) fn eval(&self, delta: Complex64) -> (Complex64, Complex64) {
        let (mut value, mut slope) = (Complex64::ZERO, Complex64::ZERO);
        // For the next term to be below 1e-16
        let part = delta.norm_sqr() / (self.z0 * self.z0).min(1.0);
        let terms = if part < 1e-8 {
            5
        } else if part < 1e-4 {
            9
        } else {
            TAYLOR_TERMS
        };
        for c in self.coefficients[..terms].iter().rev() {
            slope = slope * delta + value;
            value = value * delta + c;
        }
        (value, -slope)
    }
}

/// Coefficients of (z/2)^{2n} in I₀, in K₀ + (ln(z/2) + γ) I₀, in I₁/(z/2) and in the corresponding part of K₁.
const SERIES: [[f64; 4]; SERIES_TERMS] = series_coefficients();

const fn series_coefficients() -> [[f64; 4]; SERIES_TERMS] {
    let mut table = [[0.0; 4]; SERIES_TERMS];
    let (mut square_factorial, mut harmonic) = (1.0, 0.0);
    let mut n = 0;
    while n < SERIES_TERMS {
        let next = (n + 1) as f64;
        let i1 = 1.0 / (square_factorial * next);
        table[n] = [
            1.0 / square_factorial,
            harmonic / square_factorial,
            i1,
            i1 * (harmonic + 0.5 / next), // ½ (Hₙ + Hₙ₊₁)
        ];
        harmonic += 1.0 / next;
        square_factorial *= next * next;
        n += 1;
    }
    table
}

#[inline(always)]
fn series(z: Complex64) -> Macdonald {
    let half = 0.5 * z;
    let square = half * half;
    let size = square.norm_sqr();
    let terms = if size < 1e-8 {
        4
    } else if size < 1e-4 {
        6
    } else if size < 0.06 {
        9
    } else if size < 1.0 {
        12
    } else {
        SERIES_TERMS
    };
    let mut sums = [Complex64::ZERO; 4];
    for coefficients in SERIES[..terms].iter().rev() {
        for (sum, coefficient) in sums.iter_mut().zip(coefficients) {
            *sum = *sum * square + coefficient;
        }
    }
    let log = ln(half) + EULER_GAMMA;
    Macdonald::Small { k0: sums[1] - log * sums[0], k1_minus_pole: half * (log * sums[2] - sums[3]) }
}

#[inline(always)]
fn continued_fraction(z: Complex64) -> Macdonald {
    let mut b = 2.0 * (1.0 + z);
    let mut d = b.inv();
    let (mut h, mut h_change) = (d, d);
    let (mut q_before, mut q) = (Complex64::ZERO, Complex64::ONE);
    let (mut a, mut c) = (-0.25, 0.25);
    let mut q_sum = Complex64::new(0.25, 0.0);
    let mut s = 1.0 + q_sum * h_change;
    for i in 2..200 {
        a -= f64::from(2 * (i - 1));
        c *= -a / f64::from(i);
        (q_before, q) = (q, (q_before - b * q) / a);
        q_sum += c * q;
        b += 2.0;
        d = (b + a * d).inv();
        h_change *= b * d - 1.0;
        h += h_change;
        let s_change = q_sum * h_change;
        s += s_change;
        if s_change.norm_sqr() < 1e-31 * s.norm_sqr() {
            break;
        }
    }
    let k0 = sqrt(std::f64::consts::FRAC_PI_2 / z) / s;
    Macdonald::Scaled { k0, k1: k0 * (z + 0.5 - 0.25 * h) / z }
}

#[inline(always)]
fn asymptotic(z: Complex64) -> Macdonald {
    let inverse = 0.125 * z.inv();
    let (mut term_0, mut term_1) = (Complex64::ONE, Complex64::ONE);
    let (mut k0, mut k1) = (term_0, term_1);
    for n in 1..30 {
        let odd = f64::from((2 * n - 1) * (2 * n - 1));
        let step = inverse / f64::from(n);
        term_0 *= -odd * step;
        term_1 *= (4.0 - odd) * step;
        k0 += term_0;
        k1 += term_1;
        if term_1.norm_sqr() < 1e-34 {
            break;
        }
    }
    let factor = sqrt(std::f64::consts::FRAC_PI_2 / z);
    Macdonald::Scaled { k0: factor * k0, k1: factor * k1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against D. E. Amos's algorithm 644, as the crate complex-bessel ports it.
    #[test]
    fn macdonald_agrees_with_amos() {
        for i in -60..120 {
            let modulus = 10f64.powf(f64::from(i) / 20.0);
            for j in -6..=6 {
                let z = Complex64::from_polar(modulus, f64::from(j) * std::f64::consts::PI / 24.0);
                let amos = |order: f64| complex_bessel::besselk_scaled(order, z).expect("in range");
                let (k0, k1) = match Macdonald::new(z) {
                    Macdonald::Small { k0, k1_minus_pole } => {
                        (k0 * z.exp(), (k1_minus_pole + z.inv()) * z.exp())
                    }
                    Macdonald::Scaled { k0, k1 } => (k0, k1),
                };
                for (found, expected) in [(k0, amos(0.0)), (k1, amos(1.0))] {
                    let off = (found - expected).norm() / expected.norm();
                    let allowed = if (2.0..3.01).contains(&modulus) { 1e-13 } else { 2e-14 };
                    assert!(off < allowed, "{z}: {found} {expected} {off:e}");
                }
            }
        }
    }

    #[test]
    fn taylor_series_agrees_with_the_functions() {
        for i in -120..=120 {
            let z0 = 10f64.powf(f64::from(i) / 20.0);
            let near = MacdonaldNear::new(z0);
            for j in -6..=6 {
                for part in [0.0, 0.1, 1.0] {
                    let angle = f64::from(j) * std::f64::consts::PI / 24.0;
                    let delta = Complex64::from_polar(part * near.reach(), angle);
                    let z = z0 + delta;
                    let (k0, k1) = match Macdonald::new(z) {
                        Macdonald::Small { k0, k1_minus_pole } => {
                            (k0 * z0.exp(), (k1_minus_pole + z.inv()) * z0.exp())
                        }
                        Macdonald::Scaled { k0, k1 } => (k0 * (-delta).exp(), k1 * (-delta).exp()),
                    };
                    let found = near.eval(delta);
                    for (found, expected) in [(found.0, k0), (found.1, k1)] {
                        let off = (found - expected).norm() / expected.norm();
                        assert!(off < 2e-13, "{z0} {delta}: {found} {expected} {off:e}");
                    }
                }
            }
        }
    }
}
