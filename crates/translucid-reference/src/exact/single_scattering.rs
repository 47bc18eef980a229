//! Light that is scattered once, in real space.
//!
//! It is most of R near r = 0, where it has the pole α/(4πr) ∫ f dσ, and its Hankel transform decays too slowly to
//! be inverted; so it is taken apart. All of it is a Laplace transform, by elementary geometry:
//!
//! ```text
//! R₁(r) = α/(4πr) ∫₁^∞ f(σ) e^{−rσ} dσ            R̂₁(k) = (α/2) ∫₁^∞ f(σ)/√(σ² + k²) dσ
//! ```
//!
//! where rσ is the length of the path from entry to exit.
//!
//! - Pencil along the normal: z and the slant way back √(r² + z²) make σ = (z + √(r² + z²))/r, and
//!   f = 2(σ² − 1)/(σ² + 1)².
//! - Cosine and uniform entry: entry and exit are the foci of spheroidal coordinates σ, τ; integrated over τ ∈ [−1, 1]
//!   and the half turn about the axis, f = (σ² − 1) [L(σ² + 1)/(2σ³) − 1/σ²] with L = ln[(σ + 1)/(σ − 1)], and
//!   f = 1/σ².

use std::f64::consts::PI;

use translucid_profile::ParameterError;

use super::positive_radius;
use crate::{Estimate, Incidence};

/// Directions of entering light for which single scattering has a closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entrance {
    /// A pencil along the normal.
    Normal,
    /// A cosine distribution.
    Cosine,
    /// A distribution uniform in the cosine.
    UniformCosine,
}

impl Entrance {
    pub(crate) fn of(incidence: Incidence) -> Result<Self, ParameterError> {
        match incidence {
            Incidence::Pencil { cos_theta: 1.0 } => Ok(Self::Normal),
            Incidence::Pencil { cos_theta } => {
                let allowed = "1; the mean profile of an oblique pencil is with_boundary's";
                Err(ParameterError::new("cos_theta", cos_theta, allowed))
            }
            Incidence::Cosine => Ok(Self::Cosine),
            Incidence::UniformCosine => Ok(Self::UniformCosine),
        }
    }
}

/// Profile of the light scattered once in the half space, for one albedo and one direction of light.
///
/// Every figure has all its digits without a boundary, for every r: the integrands are positive. With one, f is
/// computed by quadrature, to some 12 digits.
#[derive(Clone, Debug)]
pub struct SingleScattering {
    single_scattering_albedo: f64,
    /// σ − 1 and f dσ, in rising order.
    nodes: Vec<[f64; 2]>,
    accuracy: Accuracy,
}

/// Source of the error of a sum over nodes.
#[derive(Clone, Copy, Debug)]
enum Accuracy {
    /// The nodes are those of a trapezoidal rule, and every other one makes the coarser rule.
    Halving,
    /// Errors are this part of the sum.
    Relative(f64),
}

/// Step of the trapezoidal rule in ln(σ − 1). The integrand is analytic for arguments of σ − 1 up to π/2, beyond
/// which e^{−rσ} grows: the rule's error is e^{−π²/step} = 1e-18.
const STEP: f64 = 0.24;
/// Range of ln(σ − 1): e^{−44} and e^{−40} are parts of the whole that do not count, the former for r up to 1e3,
/// where R₁ is all but zero.
const STEPS: std::ops::RangeInclusive<i32> = -184..=168;

impl SingleScattering {
    pub(crate) fn new(single_scattering_albedo: f64, entrance: Entrance) -> Self {
        let node = |step: i32| {
            let y = libm::exp(f64::from(step) * STEP);
            [y, density(entrance, y) * y * STEP]
        };
        Self { single_scattering_albedo, nodes: STEPS.map(node).collect(), accuracy: Accuracy::Halving }
    }

    /// From nodes σ − 1 and f dσ of any rule, in rising order.
    pub(crate) fn from_nodes(
        single_scattering_albedo: f64,
        nodes: Vec<[f64; 2]>,
        relative_error: f64,
    ) -> Self {
        Self { single_scattering_albedo, nodes, accuracy: Accuracy::Relative(relative_error) }
    }

    /// Surface albedo by single scattering, α P₁.
    pub fn total(&self) -> Estimate {
        self.sum(0.5, f64::INFINITY, |y| 1.0 / (1.0 + y))
    }

    /// Profile R₁(r) \[ℓ⁻²\]; r below the least normal number counts as that number, and R₁ above the greatest number
    /// as that one.
    pub fn eval(&self, r: f64) -> Estimate {
        let r = positive_radius(r);
        let sum = self.sum(libm::exp(-r) / (4.0 * PI), 60.0 / r, |y| libm::exp(-r * y));
        Estimate { value: (sum.value / r).min(f64::MAX), error: (sum.error / r).min(f64::MAX) }
    }

    /// ∫₀^r R₁ 2πr' dr'.
    pub fn enclosed(&self, r: f64) -> Estimate {
        let r = positive_radius(r);
        self.sum(0.5, f64::INFINITY, |y| -libm::expm1(-r * (1.0 + y)) / (1.0 + y))
    }

    /// ∫_r^∞ R₁ 2πr' dr'.
    pub fn beyond(&self, r: f64) -> Estimate {
        let r = positive_radius(r);
        self.sum(0.5 * libm::exp(-r), 60.0 / r, |y| libm::exp(-r * y) / (1.0 + y))
    }

    /// Hankel transform R̂₁(k) = ∫ R₁(r) J₀(kr) 2πr dr for k ≥ 0.
    pub fn hankel(&self, k: f64) -> Estimate {
        self.sum(0.5, f64::INFINITY, |y| 1.0 / libm::hypot(1.0 + y, k))
    }

    /// α `factor` ∫ f(σ) `kernel`(σ − 1) dσ up to the given σ − 1.
    fn sum(&self, factor: f64, y_max: f64, kernel: impl Fn(f64) -> f64) -> Estimate {
        let (mut all, mut half) = (0.0, 0.0);
        for (i, [y, weight]) in self.nodes.iter().enumerate() {
            if *y > y_max {
                break;
            }
            let term = weight * kernel(*y);
            all += term;
            if i % 2 == 0 {
                half += 2.0 * term;
            }
        }
        let factor = factor * self.single_scattering_albedo;
        let relative_error = match self.accuracy {
            // The finer rule's error is the square of the coarser's
            Accuracy::Halving if all > 0.0 => ((half - all) / all).powi(2) + 3e-15,
            Accuracy::Halving => 0.0,
            Accuracy::Relative(error) => error,
        };
        Estimate { value: all * factor, error: all.abs() * factor * relative_error }
    }
}

/// f(σ) for σ = 1 + y.
fn density(entrance: Entrance, y: f64) -> f64 {
    let sigma = 1.0 + y;
    let square = sigma * sigma;
    match entrance {
        Entrance::Normal => 2.0 * (y * (2.0 + y) / (square + 1.0)) / (square + 1.0),
        Entrance::Cosine => y * (2.0 + y) * mean_over_spheroid(sigma, y),
        Entrance::UniformCosine => 1.0 / square,
    }
}

/// L(σ² + 1)/(2σ³) − 1/σ², L = ln[(σ + 1)/(σ − 1)] = 2(1/σ + 1/(3σ³) + …), for σ = 1 + y.
fn mean_over_spheroid(sigma: f64, y: f64) -> f64 {
    let square = sigma * sigma;
    if sigma < 2.0 {
        return libm::log((2.0 + y) / y) * (square + 1.0) / (2.0 * square * sigma) - 1.0 / square;
    }
    // σ⁻⁴ Σ (1/(2n+1) + 1/(2n+3)) σ⁻²ⁿ: the 28th term is below 1e-17
    let inverse = 1.0 / square;
    let coefficient = |n: i32| 1.0 / f64::from(2 * n + 1) + 1.0 / f64::from(2 * n + 3);
    let sum = (0..28).rev().fold(0.0, |sum, n| sum * inverse + coefficient(n));
    sum * inverse * inverse
}

#[cfg(test)]
mod tests {
    use translucid_profile::quadrature::{gauss_legendre, integrate};

    use super::*;

    const ENTRANCES: [Entrance; 3] = [Entrance::Normal, Entrance::Cosine, Entrance::UniformCosine];

    #[test]
    fn total_is_the_first_order_of_scattering() {
        let expected = [0.5 * (1.0 - std::f64::consts::LN_2), 0.2045685463, 0.25];
        for ((entrance, expected), allowed) in ENTRANCES.into_iter().zip(expected).zip([1e-15, 5e-11, 1e-15])
        {
            let total = SingleScattering::new(0.5, entrance).total();
            assert!((total.value / 0.5 - expected).abs() < allowed, "{entrance:?}: {total:?}");
            assert!(total.error < 1e-14);
        }
    }

    /// From the geometry: exit cosine μ after the depth z, in any direction.
    /// enclosed₁(r) = (α/2) ∫₀¹ μ/(1+μ) [1 − exp(−r √((1+μ)/(1−μ)))] dμ.
    #[test]
    fn enclosed_of_a_pencil_matches_the_integral_over_exits() {
        let single = SingleScattering::new(0.8, Entrance::Normal);
        let rule = gauss_legendre(200);
        for r in [1e-3, 0.1, 1.0, 10.0] {
            // μ = 1 − v⁴ for the end at which the exponent is steep
            let expected = 0.4
                * integrate(&rule, 0.0, 1.0, |v| {
                    let mu = 1.0 - v.powi(4);
                    let within = -(-r * ((1.0 + mu) / v.powi(4)).sqrt()).exp_m1();
                    mu / (1.0 + mu) * within * 4.0 * v.powi(3)
                });
            let found = single.enclosed(r).value;
            assert!((found / expected - 1.0).abs() < 1e-12, "{r}: {found} {expected}");
        }
    }

    /// R̂₁ by directions of entry and exit instead of paths: (α/2) ∬ g du' du/(s + s'), s = √(1/u² + k²), where g du'
    /// is what collides: of the pencil δ(s' − 1), of the others 2 du' and du'/(u'² s').
    #[test]
    fn hankel_matches_the_integral_over_directions() {
        let rule = gauss_legendre(60);
        for entrance in ENTRANCES {
            let single = SingleScattering::new(1.0, entrance);
            for k in [0.0, 0.3, 1.0, 4.0] {
                let over = |f: &dyn Fn(f64, f64) -> f64| {
                    integrate(&rule, 0.0, 1.0, |w| {
                        let u = w * w * w;
                        f(u, (1.0 / u).hypot(k)) * 3.0 * w * w
                    })
                };
                let exit = |s: f64| over(&|_, s_out| 1.0 / (s + s_out));
                let expected = match entrance {
                    Entrance::Normal => 0.5 * exit(1.0),
                    Entrance::Cosine => over(&|_, s| exit(s)),
                    Entrance::UniformCosine => 0.5 * over(&|u, s| exit(s) / (u * u * s)),
                };
                let found = single.hankel(k).value;
                assert!((found / expected - 1.0).abs() < 1e-10, "{entrance:?}, k {k}: {found} {expected}");
            }
        }
    }

    /// R₁ = (α/4πr) E₂(r) for the uniform entry, with E₂ from W. Gautschi and W. F. Cahill in Abramowitz and
    /// Stegun 1964, table 5.4.
    #[test]
    fn eval_of_uniform_entry_is_an_exponential_integral() {
        let single = SingleScattering::new(1.0, Entrance::UniformCosine);
        for (r, e2) in [(0.1, 0.7225450), (0.5, 0.3266439), (1.0, 0.1484955)] {
            let found = single.eval(r).value * 4.0 * PI * r;
            assert!((found - e2).abs() < 6e-8, "{r}: {found}");
        }
    }

    #[test]
    fn parts_sum_to_the_whole() {
        for entrance in ENTRANCES {
            let single = SingleScattering::new(0.7, entrance);
            let total = single.total().value;
            for r in [1e-300, 1e-8, 1e-3, 0.1, 1.0, 10.0, 100.0] {
                let sum = single.enclosed(r).value + single.beyond(r).value;
                assert!((sum / total - 1.0).abs() < 1e-14, "{entrance:?}, {r}: {sum} {total}");
            }
            assert_eq!(single.hankel(0.0).value, total);
            // R₁ ~ C/r makes R̂₁ ~ 2πC/k
            let (near, far) = (single.eval(1e-9).value * 1e-9, single.hankel(1e9).value * 1e9);
            assert!((2.0 * PI * near / far - 1.0).abs() < 1e-7, "{entrance:?}: {near} {far}");
        }
    }

    /// Against half the step.
    #[test]
    fn error_is_honest() {
        for entrance in ENTRANCES {
            let single = SingleScattering::new(1.0, entrance);
            let fine: Vec<[f64; 2]> = (2 * STEPS.start()..=2 * STEPS.end())
                .map(|step| {
                    let y = (f64::from(step) * 0.5 * STEP).exp();
                    [y, density(entrance, y) * y * 0.5 * STEP]
                })
                .collect();
            let fine = SingleScattering::from_nodes(1.0, fine, 0.0);
            for r in [1e-12, 1e-6, 1e-3, 0.1, 1.0, 10.0, 100.0, 700.0] {
                let functions =
                    [SingleScattering::eval, SingleScattering::enclosed, SingleScattering::beyond];
                for (which, function) in functions.into_iter().enumerate() {
                    let (found, expected) = (function(&single, r), function(&fine, r));
                    let off = (found.value - expected.value).abs();
                    assert!(
                        off <= found.error + expected.error,
                        "{which}, {entrance:?}, {r}: {found:?} {expected:?}"
                    );
                    assert!(found.relative_error() < 1e-11, "{which}, {entrance:?}, {r}: {found:?}");
                }
            }
        }
    }
}
