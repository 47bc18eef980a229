//! Kernels whose mixtures are profiles.

use std::f64::consts::PI;
use std::fmt::Debug;

/// A family of radial kernels of unit energy that differ in their scale s \[L\] only.
///
/// ```text
/// r K_s(r) = φ(r/s) / s,      2π ∫₀^∞ φ(x) dx = 1
/// ```
///
/// Everything here is a function of x = r/s ≥ 0.
pub trait Family: Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// φ(x).
    fn times_r(x: f64) -> f64;

    /// Slope φ'(x).
    fn slope(x: f64) -> f64;

    /// Energy within x, with the digits of a small x.
    fn within(x: f64) -> f64;

    /// Energy beyond x, with the digits of a large x.
    fn beyond(x: f64) -> f64;

    /// Mean radius of the energy in units of the scale.
    const MEAN_RADIUS: f64;
}

/// Gaussians of variance s²: K(r) = e^{−r²/2s²} / (2πs²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gaussian;

impl Family for Gaussian {
    fn times_r(x: f64) -> f64 {
        x * libm::exp(-0.5 * x * x) / (2.0 * PI)
    }

    fn slope(x: f64) -> f64 {
        if x > 1e3 { 0.0 } else { (1.0 - x * x) * libm::exp(-0.5 * x * x) / (2.0 * PI) }
    }

    fn within(x: f64) -> f64 {
        -libm::expm1(-0.5 * x * x)
    }

    fn beyond(x: f64) -> f64 {
        libm::exp(-0.5 * x * x)
    }

    /// √(π/2)
    const MEAN_RADIUS: f64 = 1.253_314_137_315_500_3;
}

/// Exponentials over r of rate 1/s: K(r) = e^{−r/s} / (2πsr).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exponential;

impl Family for Exponential {
    fn times_r(x: f64) -> f64 {
        libm::exp(-x) / (2.0 * PI)
    }

    fn slope(x: f64) -> f64 {
        -libm::exp(-x) / (2.0 * PI)
    }

    fn within(x: f64) -> f64 {
        -libm::expm1(-x)
    }

    fn beyond(x: f64) -> f64 {
        libm::exp(-x)
    }

    const MEAN_RADIUS: f64 = 1.0;
}

/// Normalized diffusion of width d = s: K(r) = (e^{−r/s} + e^{−r/3s}) / (8πsr), whose fit of one term is s(A).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Burley;

impl Family for Burley {
    fn times_r(x: f64) -> f64 {
        (libm::exp(-x) + libm::exp(-x / 3.0)) / (8.0 * PI)
    }

    fn slope(x: f64) -> f64 {
        -(libm::exp(-x) + libm::exp(-x / 3.0) / 3.0) / (8.0 * PI)
    }

    fn within(x: f64) -> f64 {
        -0.25 * libm::expm1(-x) - 0.75 * libm::expm1(-x / 3.0)
    }

    fn beyond(x: f64) -> f64 {
        0.25 * libm::exp(-x) + 0.75 * libm::exp(-x / 3.0)
    }

    const MEAN_RADIUS: f64 = 2.5;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫₀^∞ f dx by the trapezoidal rule in ln x.
    fn integral(f: impl Fn(f64) -> f64) -> f64 {
        (-500..=80).map(|i| (0.07 * f64::from(i)).exp()).map(|x| 0.07 * x * f(x)).sum()
    }

    fn obeys_its_laws<F: Family>() {
        assert!((2.0 * PI * integral(F::times_r) - 1.0).abs() < 1e-12);
        assert!((2.0 * PI * integral(|x| x * F::times_r(x)) / F::MEAN_RADIUS - 1.0).abs() < 1e-12);
        // By the midpoint rule
        assert!((F::within(1e-9) / (2e-9 * PI * F::times_r(0.5e-9)) - 1.0).abs() < 1e-8);
        for x in [0.01, 0.3, 1.0, 2.5, 7.0] {
            assert!((F::within(x) + F::beyond(x) - 1.0).abs() < 1e-15);
            let h = 1e-5 * x;
            // Whichever of the two has the digits
            let energy = |y: f64| if x < 1.0 { F::within(y) } else { -F::beyond(y) };
            let density = (energy(x + h) - energy(x - h)) / (2.0 * h);
            assert!((density / (2.0 * PI * F::times_r(x)) - 1.0).abs() < 1e-6, "{x}");
            let slope = (F::times_r(x + h) - F::times_r(x - h)) / (2.0 * h);
            assert!((slope - F::slope(x)).abs() < 1e-6, "{x}: {slope} {}", F::slope(x));
        }
        for x in [0.0, 1e200, f64::INFINITY] {
            let values = [F::within(x), F::beyond(x), F::slope(x)];
            assert!(values.iter().all(|value| value.is_finite()), "{x}: {values:?}");
        }
    }

    #[test]
    fn families_obey_their_laws() {
        obeys_its_laws::<Gaussian>();
        obeys_its_laws::<Exponential>();
        obeys_its_laws::<Burley>();
    }
}
