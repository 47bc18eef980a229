//! Light of a plane of isotropic sources that varies as e^{ikx}, at another depth, and what crosses a plane there.
//!
//! Between two depths lie the optical depth T and the distance D; straight rays of all directions make
//!
//! ```text
//! F_n(T, q) = ∫₁^∞ t^{−n} e^{−Tt} J₀(q √(t² − 1)) dt,     q = kD
//! ```
//!
//! of which ½ F₁ is the fluence and ½ F₂ the flux, and 2 F₃ the flux of a plane that emits by the cosine law. F₀ = e^{−ρ}/ρ with ρ = √(T² + q²) is known (Lipschitz's integral); each
//! other is the integral of the one before over T, so that
//!
//! ```text
//! F₁ = ∫ e^{−ρ'} dy/y,   F₂ = e^{−ρ} − T F₁,   F₃ = ½ (G + T² F₁ − T e^{−ρ}),   G = ∫ ρ' e^{−ρ'} dy/y
//! ```
//!
//! with ρ' = (y + q²/y)/2, from y = T + ρ on: without an oscillation for real k, and bounded for all k in the right upper quadrant.

use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use crate::exact::complex::{exp, ln, sqrt};

/// Gauss–Legendre rules on [0, 1].
#[derive(Clone, Debug)]
pub(super) struct Kernel {
    short: Vec<(f64, f64)>,
    long: Vec<(f64, f64)>,
    far: Vec<(f64, f64)>,
}

/// Exponent behind which nothing is left.
const NEGLIGIBLE: f64 = 30.0;
/// End of the piece in which the integrand is nearly constant in ln y.
const PLATEAU: f64 = 0.6;
/// Size of the first y from which on fewer points do.
const FAR: f64 = 4.0;

impl Kernel {
    pub(super) fn new() -> Self {
        Self { short: unit_rule(8), long: unit_rule(18), far: unit_rule(12) }
    }

    /// F₁, F₂ and F₃ for T ≥ 0, q in the right upper quadrant and T + |q| > 0.
    pub(super) fn eval(&self, depth: f64, q: Complex64) -> [Complex64; 3] {
        let square = q * q;
        let rho = sqrt(depth * depth + square);
        if rho.re > NEGLIGIBLE {
            return [Complex64::ZERO; 3];
        }
        let first = depth + rho;
        let far = rho + NEGLIGIBLE;
        let last = far + sqrt(far * far - square);
        let size = first.norm_sqr().sqrt();
        let [f1, g] = if size < PLATEAU {
            let middle = first * (PLATEAU / size);
            let near = integrals(&self.short, first, middle, square);
            let far = integrals(&self.long, middle, last, square);
            [near[0] + far[0], near[1] + far[1]]
        } else {
            integrals(if size < FAR { &self.long } else { &self.far }, first, last, square)
        };
        let decay = exp(-rho);
        [f1, decay - depth * f1, 0.5 * (g + depth * (depth * f1 - decay))]
    }
}

fn unit_rule(count: usize) -> Vec<(f64, f64)> {
    gauss_legendre(count).into_iter().map(|(x, weight)| (0.5 + 0.5 * x, 0.5 * weight)).collect()
}

/// ∫ e^{−ρ} d ln y and ∫ ρ e^{−ρ} d ln y with ρ = (y + q²/y)/2.
fn integrals(rule: &[(f64, f64)], from: Complex64, to: Complex64, square: Complex64) -> [Complex64; 2] {
    let length = ln(to / from);
    let mut sums = [Complex64::ZERO; 2];
    for (x, weight) in rule {
        let y = from * exp(length * *x);
        let rho = 0.5 * (y + square / y);
        let value = exp(-rho) * *weight;
        sums[0] += value;
        sums[1] += rho * value;
    }
    sums.map(|sum| sum * length)
}

#[cfg(test)]
mod tests {
    use translucid_profile::quadrature::integrate;

    use super::*;
    use crate::exact::macdonald::Macdonald;

    /// By the integral over directions, t = 1/μ.
    #[test]
    fn eval_is_the_integral_over_directions() {
        let (kernel, rule) = (Kernel::new(), gauss_legendre(400));
        for (depth, k) in [(0.3, 0.0), (0.3, 0.3), (2.0, 2.0), (0.05, 0.01), (6.0, 0.1)] {
            let by_directions = |n: i32| {
                integrate(&rule, 0.0, 1.0, |x| {
                    // μ = x³ for grazing directions
                    let mu = x * x * x;
                    let q = k * (1.0 - mu * mu).sqrt() / mu;
                    mu.powi(n - 2) * (-depth / mu).exp() * libm::j0(q) * 3.0 * x * x
                })
            };
            let found = kernel.eval(depth, k.into());
            for (n, found) in [1, 2, 3].into_iter().zip(found) {
                let expected = by_directions(n);
                let off = (found - expected).norm();
                assert!(off < 1e-7, "{depth} {k} {n}: {found} {expected} {off:e}");
            }
        }
    }

    /// Sources in the same plane: F₁ = K₀(q), F₂ = e^{−q}.
    #[test]
    fn sources_beside_each_other_are_a_bessel_function() {
        for q in [1e-4, 0.01, 0.5, 3.0, 20.0].map(|q| Complex64::new(q, 0.4 * q)) {
            let expected = match Macdonald::new(q) {
                Macdonald::Small { k0, .. } => k0,
                Macdonald::Scaled { k0, .. } => k0 * exp(-q),
            };
            let [f1, f2, _] = Kernel::new().eval(0.0, q);
            assert!((f1 - expected).norm() < 1e-7 * expected.norm() + 1e-14, "{q}: {f1} {expected}");
            assert!((f2 - exp(-q)).norm() < 1e-14);
        }
    }

    /// Against rules of more points, in the whole quadrant.
    #[test]
    fn rules_have_points_enough() {
        let kernel = Kernel::new();
        let finer = Kernel { short: unit_rule(30), long: unit_rule(60), far: unit_rule(60) };
        for i in 0..200 {
            let depth = 10f64.powf(-6.0 + 7.5 * f64::from(i % 20) / 20.0);
            let size = 10f64.powf(-6.0 + 7.5 * f64::from(i / 20) / 10.0);
            for angle in [0.0, 0.5, 1.0, 1.5] {
                let q = Complex64::from_polar(size, angle);
                let [found, expected] = [kernel.eval(depth, q), finer.eval(depth, q)];
                let off = (found[0] - expected[0]).norm() / (1e-3 + expected[0].norm());
                assert!(off < 1e-6, "{depth} {q}: {found:?} {expected:?} {off:e}");
            }
        }
    }
}
