//! Exact surface albedo of a half space that scatters isotropically, without a boundary.
//!
//! S. Chandrasekhar, *Radiative Transfer*, 1950, chapter IV: the half space reflects the intensity
//! `α/4 · H(μ) H(μ₀) μ₀/(μ + μ₀)` for unit flux at μ₀, and H has the integral below
//! (after C. Fox 1961 and V. A. Ambartsumian).
//!
//! ```text
//! ln H(ν) = −(ν/π) ∫₀^∞ ln[1 − α atan(t)/t] / (1 + ν²t²) dt
//! searchlight   A = 1 − H(1) √(1−α)
//! diffuse       A = 1 − 2 √(1−α) ∫₀¹ μ H(μ) dμ
//! ```

use std::f64::consts::PI;

use crate::Configuration;
use crate::math::quadrature::{integrate, shared_gauss_legendre};
use crate::math::roots::falling_root;

/// Surface albedo A ∈ [0, 1] of a half space of isotropic scatterers whose refractive index is that of its
/// surroundings, from the single-scattering albedo α.
///
/// It grows from 0 at α = 0 to 1 at α = 1, steeply there: 1 − A ~ √(1 − α).
/// Absolute error below 1e-13.
/// For a forward-scattering medium pass the reduced albedo α', by similarity; see
/// [`Medium::surface_albedo`](crate::Medium::surface_albedo).
/// α is clamped to [0, 1]; NaN counts as 0.
/// Takes tens of microseconds: for textures tabulate it.
///
/// ```
/// use translucid_profile::{Configuration, half_space_surface_albedo};
///
/// let surface_albedo = half_space_surface_albedo(0.9, Configuration::Searchlight);
/// assert!((surface_albedo - 0.41494747913082).abs() < 1e-13);
/// ```
pub fn half_space_surface_albedo(single_scattering_albedo: f64, configuration: Configuration) -> f64 {
    let alpha = single_scattering_albedo.max(0.0).min(1.0);
    (1.0 - kept((1.0 - alpha).sqrt(), configuration)).max(0.0).min(1.0)
}

/// 1 − A, what the half space keeps of the light, from √(1 − α): every digit of either near white.
fn kept(root: f64, configuration: Configuration) -> f64 {
    let h = HFunction::of_absorption(root * root);
    match configuration {
        Configuration::Searchlight => h.eval(1.0) * root,
        Configuration::Diffuse => 2.0 * h.first_moment() * root,
    }
}

/// Single-scattering albedo α ∈ [0, 1] of the half space with surface albedo A: the inverse of
/// [`half_space_surface_albedo`].
///
/// A root finder on √(1 − α), in which A is nearly straight: at most nine evaluations.
/// A comes back to 1e-13 + 3e-16/(1 − A), the second part being the spacing of the numbers α near 1; α itself is
/// good to 1e-12.
/// A is clamped to [0, 1]; NaN counts as 0.
///
/// ```
/// use translucid_profile::{Configuration, half_space_single_scattering_albedo};
///
/// let alpha = half_space_single_scattering_albedo(0.5, Configuration::Searchlight);
/// assert!((alpha - 0.938171938710).abs() < 1e-12);
/// ```
pub fn half_space_single_scattering_albedo(surface_albedo: f64, configuration: Configuration) -> f64 {
    1.0 - half_space_absorption(surface_albedo, configuration)
}

/// 1 − α of the half space with surface albedo A, with the digits that 1 − A has.
pub(crate) fn half_space_absorption(surface_albedo: f64, configuration: Configuration) -> f64 {
    let target = 1.0 - surface_albedo.max(0.0).min(1.0);
    // The ends of the bracket are exact where the target is
    if target == 1.0 || target == 0.0 {
        return target;
    }
    let excess = |root: f64| target - kept(root, configuration);
    // Rounding errors of H
    let root = falling_root(excess, [target, target - 1.0], |_| 2e-15 * target);
    root * root
}

/// Chandrasekhar's H function of one single-scattering albedo, as the samples that its integral needs.
///
/// A half space of isotropic scatterers without a boundary reflects light of unit flux that enters at the cosine μ₀ as the
/// radiance α/(4π) H(μ) H(μ₀)/(μ + μ₀), and returns the part 1 − H(μ₀) √(1−α) of it.
///
/// ```
/// use translucid_profile::{Configuration, HFunction, half_space_surface_albedo};
///
/// let returned = 1.0 - HFunction::new(0.9).eval(1.0) * 0.1f64.sqrt();
/// assert!((returned - half_space_surface_albedo(0.9, Configuration::Searchlight)).abs() < 1e-13);
/// ```
#[derive(Clone, Debug)]
pub struct HFunction {
    /// t and ln[1 − α atan(t)/t] t Δs at equal steps of s = ln t.
    samples: Vec<(f64, f64)>,
    /// Sum of the values at the t so small that no ν matters.
    at_zero: f64,
}

impl HFunction {
    /// Step of the trapezoidal rule in s = ln t.
    ///
    /// In s the integrand falls exponentially at both ends, and its nearest singularities have the imaginary
    /// part π/2 (t on the imaginary axis), so the rule's error is e^{−π²/step} = 7e-18.
    const STEP: f64 = 0.25;
    /// Range of s: at its ends the integrand is below 1e-17.
    const STEPS: std::ops::RangeInclusive<i32> = -168..=168;

    /// The function of a single-scattering albedo α, which is clamped to [0, 1]; NaN counts as 0.
    ///
    /// Takes some microseconds.
    pub fn new(single_scattering_albedo: f64) -> Self {
        Self::of_absorption(1.0 - single_scattering_albedo.max(0.0).min(1.0))
    }

    /// For 1 − α.
    fn of_absorption(absorbed: f64) -> Self {
        let alpha = 1.0 - absorbed;
        let sample = |step: i32| {
            let t = libm::exp(Self::STEP * f64::from(step));
            let log = libm::log(absorbed + alpha * one_minus_atan_over(t));
            (t, log * t * Self::STEP)
        };
        let (small, samples): (Vec<_>, Vec<_>) = Self::STEPS.map(sample).partition(|(t, _)| *t < 1e-9);
        Self { samples, at_zero: small.iter().map(|(_, value)| value).sum() }
    }

    /// H at a cosine in [0, 1], to 1e-13: from 1 on, growing.
    pub fn eval(&self, nu: f64) -> f64 {
        // Four sums at once: the processor need not wait for one addition to begin the next
        let term = |&(t, value): &(f64, f64)| value / (1.0 + (nu * t) * (nu * t));
        let (fours, rest) = self.samples.as_chunks::<4>();
        let mut sums = [self.at_zero, 0.0, 0.0, 0.0];
        for four in fours {
            for (sum, sample) in sums.iter_mut().zip(four) {
                *sum += term(sample);
            }
        }
        let sum = sums.iter().sum::<f64>() + rest.iter().map(term).sum::<f64>();
        libm::exp(-nu / PI * sum)
    }

    /// ∫₀¹ μ H(μ) dμ, with μ = w³ because H has a term μ ln μ.
    fn first_moment(&self) -> f64 {
        let rule = shared_gauss_legendre(24);
        integrate(rule, 0.0, 1.0, |w| {
            let mu = w * w * w;
            mu * self.eval(mu) * 3.0 * w * w
        })
    }
}

/// 1 − atan(t)/t, with every digit for small t.
fn one_minus_atan_over(t: f64) -> f64 {
    if t > 0.3 {
        return 1.0 - libm::atan(t) / t;
    }
    // t²/3 − t⁴/5 + …: the 16th term is below 1e-17 of the first
    let z = t * t;
    (1..=16).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) - z * sum) * z
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Values of an independent solution of the transfer problem, confirmed by Monte Carlo.
    #[test]
    fn surface_albedo_matches_check_values() {
        for (alpha, searchlight, diffuse) in [
            (0.5, 0.11522587770720, 0.14654438069972),
            (0.9, 0.41494747913082, 0.47802448922824),
            (0.99, 0.75272071716030, 0.79456365290203),
        ] {
            let found = half_space_surface_albedo(alpha, Configuration::Searchlight);
            assert!((found - searchlight).abs() < 2e-14, "{alpha}: {found}");
            let found = half_space_surface_albedo(alpha, Configuration::Diffuse);
            assert!((found - diffuse).abs() < 2e-14, "{alpha}: {found}");
        }
    }

    /// Chandrasekhar 1950, chapter V, equation 11: ∫H dμ = (2/α)(1 − √(1−α)).
    #[test]
    fn h_function_has_its_exact_zeroth_moment() {
        let rule = shared_gauss_legendre(40);
        for alpha in [1e-6, 0.1, 0.5, 0.9, 0.999, 1.0 - 1e-9, 1.0] {
            let h = HFunction::of_absorption(1.0 - alpha);
            let found = integrate(rule, 0.0, 1.0, |w| h.eval(w * w * w) * 3.0 * w * w);
            let expected = 2.0 / (1.0 + (1.0f64 - alpha).sqrt());
            assert!((found - expected).abs() < 1e-13, "{alpha}: {found} {expected}");
        }
    }

    /// First order of scattering, A = P₁ α + P₂ α² + O(α³).
    #[test]
    fn surface_albedo_starts_with_the_orders_of_scattering() {
        let orders = [
            (Configuration::Searchlight, (1.0 - std::f64::consts::LN_2) / 2.0, 0.0972733365),
            (Configuration::Diffuse, 0.2045685463, 0.1158020630),
        ];
        for (configuration, first, second) in orders {
            // The third order is below 0.09.
            let alpha = 1e-4;
            let found = half_space_surface_albedo(alpha, configuration);
            let expected = first * alpha + second * alpha * alpha;
            assert!((found - expected).abs() < 0.09 * alpha.powi(3) + 1e-14, "{found:e} {expected:e}");
        }
    }

    #[test]
    fn surface_albedo_rises_from_zero_to_one() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            assert!(half_space_surface_albedo(0.0, configuration).abs() < 1e-14);
            assert_eq!(half_space_surface_albedo(1.0, configuration), 1.0);
            assert_eq!(
                half_space_surface_albedo(f64::NAN, configuration),
                half_space_surface_albedo(0.0, configuration)
            );
            let mut last = -1.0;
            for i in 0..=200 {
                let found = half_space_surface_albedo(f64::from(i) / 200.0, configuration);
                assert!(found > last);
                last = found;
            }
        }
    }

    #[test]
    fn single_scattering_albedo_inverts_surface_albedo() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            assert_eq!(half_space_single_scattering_albedo(1.0, configuration), 1.0);
            for surface_albedo in [0.0, 1e-9, 1e-3, 0.2, 0.5, 0.8, 0.99, 0.999999] {
                let alpha = half_space_single_scattering_albedo(surface_albedo, configuration);
                let back = half_space_surface_albedo(alpha, configuration);
                let allowed = 1e-13 + 3e-16 / (1.0 - surface_albedo).max(1e-16);
                assert!((back - surface_albedo).abs() < allowed, "{surface_albedo}: {alpha} {back}");
            }
            for alpha in [1e-3, 0.1, 0.5, 0.9, 0.99, 0.9999, 1.0 - 1e-6, 1.0 - 1e-10, 1.0 - 1e-15] {
                let surface_albedo = half_space_surface_albedo(alpha, configuration);
                let back = half_space_single_scattering_albedo(surface_albedo, configuration);
                assert!((back - alpha).abs() < 1e-12, "{alpha}: {surface_albedo} {back}");
            }
        }
    }

    /// √(1−α) = (1 − A)/H(1), and with 2∫μH dμ for diffuse light, where at α = 1 H(1) = 2.9078 (S. Chandrasekhar
    /// 1950, table XI) and ∫μH dμ = 2/√3.
    #[test]
    fn absorption_keeps_its_digits_near_white() {
        for complement in [1e-6, 1e-9, 1e-13, 1.0 - 1.0f64.next_down()] {
            let a = 1.0 - complement;
            for (configuration, slope, accuracy) in [
                (Configuration::Searchlight, 2.9078, 2e-5),
                (Configuration::Diffuse, 4.0 / 3f64.sqrt(), 1e-11),
            ] {
                let absorbed = half_space_absorption(a, configuration);
                let ratio = absorbed.sqrt() * slope / (1.0 - a);
                // H falls by some 2√(1−α) of itself
                assert!((ratio - 1.0).abs() < accuracy + 2.0 * complement, "{complement:e}: {ratio}");
            }
        }
    }

    #[test]
    fn root_finder_takes_few_steps() {
        for configuration in [Configuration::Searchlight, Configuration::Diffuse] {
            let near_white = [1e-6, 1e-9, 1e-13];
            for complement in (1..100).map(|i| f64::from(i) / 100.0).chain(near_white) {
                let (a, evaluations) = (1.0 - complement, Cell::new(0));
                let target = 1.0 - a;
                let excess = |root: f64| {
                    evaluations.set(evaluations.get() + 1);
                    target - kept(root, configuration)
                };
                let root = falling_root(excess, [target, target - 1.0], |_| 2e-15 * target);
                assert_eq!(root * root, half_space_absorption(a, configuration), "{a}");
                assert!(evaluations.get() <= 9, "{a}: {}", evaluations.get());
            }
        }
    }
}
