//! Sums of Gaussians, the profile of real-time skin, fitted to the exact half space.
//!
//! E. d'Eon and D. Luebke, *Advanced Techniques for Realistic Real-Time Skin Rendering*, 2007 (GPU Gems 3, chapter 14):
//! a Gaussian is separable, and convolved with another it is one again, so a sum of a few blurs a texture or a screen
//! cheaply. They fitted dipoles; these are fitted to the exact solution for g = 0 and η = 1.

mod coefficients;

use std::f64::consts::PI;

use crate::error::{ParameterError, require, require_fraction};
use crate::medium::appearance::half_space_mfp;
use crate::model::sum_of_gaussians::coefficients::{DIFFUSE, INTERVALS, ROW, SEARCHLIGHT};
use crate::profile::methods_of;
use crate::{Configuration, Parameterization, Profile};

/// A profile that is a sum of K ≤ 6 Gaussians.
///
/// ```text
/// R(r) = A Σ w_k e^{−r²/2v_k} / (2πv_k),      w_k ≥ 0,   Σ w_k = 1
/// ```
///
/// R is finite at r = 0, where a real medium's profile grows like 1/r: near r = 0 the sum stays behind, the less the
/// more terms it has.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an infinity.
///
/// ```
/// use translucid_profile::{Configuration, Parameterization, Profile, SumOfGaussians};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let (mfp, searchlight) = (Parameterization::Mfp, Configuration::Searchlight);
/// let gaussians = SumOfGaussians::new(0.5, 2.0, mfp, searchlight, SumOfGaussians::DEFAULT_TERMS)?;
/// assert!((gaussians.surface_albedo() - 0.5).abs() < 1e-15);
/// let blurs: Vec<(f64, f64)> = gaussians.weights().iter().copied().zip(gaussians.variances()).collect();
/// assert_eq!(blurs.len(), 6);
/// let r = gaussians.sample(0.7); // one random number in, one radius out
/// assert!((gaussians.eval(r) / gaussians.pdf_area(r) - 0.5).abs() < 1e-15); // sampling is exact
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumOfGaussians {
    total: f64,
    terms: usize,
    weights: [f64; Self::MAX_TERMS],
    /// Square roots of the variances: lengths, which leave no range where variances would.
    deviations: [f64; Self::MAX_TERMS],
}

impl SumOfGaussians {
    /// Most Gaussians in a sum.
    pub const MAX_TERMS: usize = 6;

    /// Default number of Gaussians in a sum: six, as E. d'Eon and D. Luebke 2007 took for skin.
    pub const DEFAULT_TERMS: usize = 6;

    /// Makes the sum of `terms` ∈ 1..=6 Gaussians for a surface albedo A ∈ [0, 1] and a length \[L\], mean free path or
    /// diffuse mean free path as the parameterization says.
    ///
    /// Weights and variances are interpolated between least-squares fits to the exact half space (isotropic
    /// scattering, no change of index). The generated `coefficients.rs` lists the errors of the fits; six terms
    /// have an error ∫|R − R_exact| 2πr dr/A of 4.6 % (searchlight) or 4.2 % (diffuse) on average over A, and 10 % at
    /// A = 1. Interpolation adds 0.001 % at most.
    /// The diffuse mean free path becomes a mean free path by the exact relation between A and the
    /// single-scattering albedo.
    ///
    /// # Errors
    /// A parameter is outside its range, the mean free path is not in [1e-150, 1e150], or the surface albedo is 1 with
    /// a dmfp.
    pub fn new(
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        configuration: Configuration,
        terms: usize,
    ) -> Result<Self, ParameterError> {
        require_terms(terms)?;
        let mfp = half_space_mfp(surface_albedo, length, parameterization, configuration)?;
        let [weights, ln_deviations] = interpolate(surface_albedo, configuration, terms);
        let deviations = ln_deviations.map(|ln_deviation| mfp * libm::exp(ln_deviation));
        Ok(Self { total: surface_albedo, terms, weights: normalized(weights), deviations })
    }

    /// Makes the sum of given Gaussians: up to 6 weights, at least 0 and of sum 1, as many variances \[L²\], and the
    /// energy of all.
    ///
    /// # Errors
    /// `total` is not in [0, 1], a variance not in [1e-300, 1e300], a weight negative, their sum off 1 by more than
    /// 1e-6, or there are no terms, too many, or not as many weights as variances.
    pub fn from_terms(weights: &[f64], variances: &[f64], total: f64) -> Result<Self, ParameterError> {
        let total = require_fraction("total", total)?;
        let terms = require_terms(weights.len())?;
        require(variances.len() == terms, "variances", variances.len() as f64, "as many as weights")?;
        for weight in weights {
            require(*weight >= 0.0, "weight", *weight, "at least 0")?;
        }
        let sum: f64 = weights.iter().sum();
        require((sum - 1.0).abs() <= 1e-6, "sum of weights", sum, "1 to 1e-6")?;
        for variance in variances {
            require((1e-300..=1e300).contains(variance), "variance", *variance, "in [1e-300, 1e300]")?;
        }
        let mut sum_of_gaussians =
            Self { total, terms, weights: [0.0; Self::MAX_TERMS], deviations: [1.0; Self::MAX_TERMS] };
        sum_of_gaussians.weights[..terms].copy_from_slice(weights);
        sum_of_gaussians.weights = normalized(sum_of_gaussians.weights);
        for (deviation, variance) in sum_of_gaussians.deviations.iter_mut().zip(variances) {
            *deviation = variance.sqrt();
        }
        Ok(sum_of_gaussians)
    }

    /// Surface albedo A = ∫ R 2πr dr, dimensionless.
    pub fn surface_albedo(&self) -> f64 {
        self.total
    }

    /// Weights w_k, at least 0 and of sum 1.
    pub fn weights(&self) -> &[f64] {
        &self.weights[..self.terms]
    }

    /// Variances v_k \[L²\] of the Gaussians in x and in y, in the order of the weights; [`new`](Self::new) has them
    /// rise. Mean r² of a term is 2v_k.
    pub fn variances(&self) -> impl Iterator<Item = f64> + '_ {
        self.standard_deviations().iter().map(|deviation| deviation * deviation)
    }

    /// Standard deviations √v_k \[L\] in x and in y, in the order of the weights.
    pub fn standard_deviations(&self) -> &[f64] {
        &self.deviations[..self.terms]
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]. It does not depend on A.
    pub fn pdf(&self, r: f64) -> f64 {
        self.sum(|deviation| {
            let x = ratio(r, deviation);
            x * gaussian(x) / deviation
        })
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\], at most `f64::MAX`. It does not depend on A.
    pub fn pdf_area(&self, r: f64) -> f64 {
        let density = self.sum(|deviation| gaussian(ratio(r, deviation)) / deviation / deviation);
        (density / (2.0 * PI)).min(f64::MAX)
    }

    /// Share of the energy that leaves within r: Σ w_k (1 − e^{−r²/2v_k}), exact for small r too.
    pub fn cdf(&self, r: f64) -> f64 {
        let share = self.sum(|deviation| {
            let x = ratio(r, deviation);
            -libm::expm1(-0.5 * x * x)
        });
        share.min(1.0)
    }

    /// Share of the energy that leaves beyond r: Σ w_k e^{−r²/2v_k}, exact for large r too.
    pub fn complementary_cdf(&self, r: f64) -> f64 {
        self.sum(|deviation| gaussian(ratio(r, deviation))).min(1.0)
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\].
    ///
    /// With probability w_k it is √(−2v_k ln(1 − u')), where u' is u rescaled; so it is not monotone in u.
    /// u is clamped to [0, 1]; NaN counts as 0.
    pub fn sample(&self, u: f64) -> f64 {
        // Pick a term, and make what is left of u a random number of its own
        let mut left = u.max(0.0).min(1.0);
        let mut chosen = (1.0, self.deviations[0]);
        for (weight, deviation) in self.weights().iter().zip(&self.deviations) {
            if *weight > 0.0 {
                chosen = (*weight, *deviation);
                if left < *weight {
                    break;
                }
                left -= weight;
            }
        }
        // Where rounding leaves more than the last weight, u was 1 or next to it
        let (weight, deviation) = chosen;
        let complement = ((weight - left) / weight).min(1.0).max(f64::MIN_POSITIVE);
        deviation * (-2.0 * libm::log(complement)).sqrt()
    }

    /// Σ w_k f(√v_k).
    fn sum(&self, f: impl Fn(f64) -> f64) -> f64 {
        let terms = self.weights().iter().zip(&self.deviations);
        terms.map(|(weight, deviation)| if *weight > 0.0 { weight * f(*deviation) } else { 0.0 }).sum()
    }
}

impl Profile for SumOfGaussians {
    methods_of!(|own| own; pdf, pdf_area, cdf, complementary_cdf, sample);

    fn eval_times_r(&self, r: f64) -> f64 {
        self.total * (self.pdf(r) / (2.0 * PI))
    }

    /// R(r) \[L⁻²\], A Σ w_k/(2πv_k) at r = 0 and at most `f64::MAX`.
    fn eval(&self, r: f64) -> f64 {
        (self.total * self.pdf_area(r)).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.total * self.cdf(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.total * self.complementary_cdf(r)
    }

    fn surface_albedo(&self) -> f64 {
        self.total
    }

    /// Mean radius √(π/2) Σ w_k √v_k \[L\].
    fn scale(&self) -> f64 {
        (0.5 * PI).sqrt() * self.sum(|deviation| deviation)
    }

    fn samples_directly(&self) -> bool {
        true
    }
}

/// r in standard deviations, so bounded that its square is a number; beyond the bound a Gaussian is 0.
fn ratio(r: f64, deviation: f64) -> f64 {
    (r.max(0.0) / deviation).min(1e150)
}

/// e^{−x²/2}.
fn gaussian(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

fn require_terms(terms: usize) -> Result<usize, ParameterError> {
    require((1..=SumOfGaussians::MAX_TERMS).contains(&terms), "terms", terms as f64, "in 1..=6")?;
    Ok(terms)
}

/// Weights and logarithms of the standard deviations in mean free paths.
fn interpolate(
    surface_albedo: f64,
    configuration: Configuration,
    terms: usize,
) -> [[f64; SumOfGaussians::MAX_TERMS]; 2] {
    let nodes = match configuration {
        Configuration::Searchlight => &SEARCHLIGHT,
        Configuration::Diffuse => &DIFFUSE,
    };
    // Nodes are evenly spaced in 1 − √(1 − A): close to each other near A = 1, where much changes
    let position = (1.0 - (1.0 - surface_albedo).sqrt()) * INTERVALS as f64;
    let first = (position as usize).saturating_sub(1).min(INTERVALS - 3);
    let shares = lagrange(position - first as f64);
    let value = |index: usize| (0..4).map(|i| shares[i] * nodes[first + i][index]).sum::<f64>();

    // Fits of fewer terms come first, two numbers for each term
    let start = terms * (terms - 1);
    debug_assert!(start + 2 * terms <= ROW);
    let of_terms = |start: usize| std::array::from_fn(|k| if k < terms { value(start + k) } else { 0.0 });
    [of_terms(start), of_terms(start + terms)]
}

/// Lagrange's cubic weights of the nodes 0, 1, 2, 3 at x.
fn lagrange(x: f64) -> [f64; 4] {
    let [a, b, c, d] = [x, x - 1.0, x - 2.0, x - 3.0];
    [-b * c * d / 6.0, a * c * d / 2.0, -a * b * d / 2.0, a * b * c / 6.0]
}

/// Weights over their sum.
fn normalized(weights: [f64; SumOfGaussians::MAX_TERMS]) -> [f64; SumOfGaussians::MAX_TERMS] {
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
    const ALBEDOS: [f64; 9] = [0.0, 1e-12, 0.03, 0.2, 0.5, 0.8, 0.97, 0.99999, 1.0];

    fn from_mfp(surface_albedo: f64, mfp: f64, configuration: Configuration, terms: usize) -> SumOfGaussians {
        SumOfGaussians::new(surface_albedo, mfp, Parameterization::Mfp, configuration, terms).unwrap()
    }

    #[test]
    fn weights_are_shares_and_variances_rise() {
        for configuration in CONFIGURATIONS {
            for terms in 1..=6 {
                for i in 0..=1000 {
                    let gaussians = from_mfp(f64::from(i) / 1000.0, 1.0, configuration, terms);
                    assert_eq!(gaussians.weights().len(), terms);
                    assert!((gaussians.weights().iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    // No term is idle anywhere: none was clamped
                    assert!(gaussians.weights().iter().all(|weight| *weight > 0.03));
                    assert!(gaussians.standard_deviations().is_sorted());
                }
            }
        }
    }

    /// A cubic through four nodes changes its nodes at each of them.
    #[test]
    fn interpolation_is_continuous_in_albedo() {
        for configuration in CONFIGURATIONS {
            for i in 1..INTERVALS {
                let root = 1.0 - i as f64 / INTERVALS as f64;
                let at = |root: f64| from_mfp(1.0 - root * root, 1.0, configuration, 6);
                let [before, after] = [at(root + 1e-9), at(root - 1e-9)];
                for k in 0..6 {
                    assert!((before.weights()[k] - after.weights()[k]).abs() < 1e-8);
                    let ratio = before.standard_deviations()[k] / after.standard_deviations()[k];
                    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}");
                }
            }
        }
    }

    #[test]
    fn lagrange_reproduces_cubics() {
        for x in [0.0, 0.3, 1.0, 1.7, 2.5, 3.0] {
            for power in 0..=3 {
                let nodes = lagrange(x).into_iter().zip([0.0f64, 1.0, 2.0, 3.0]);
                let found: f64 = nodes.map(|(share, node)| share * node.powi(power)).sum();
                assert!((found - x.powi(power)).abs() < 1e-13);
            }
        }
    }

    /// Equally spaced random numbers make samples whose counts are the cdf but for one in each term.
    #[test]
    fn sample_has_the_density() {
        let count = 100_000;
        for configuration in CONFIGURATIONS {
            for terms in [1, 2, 6] {
                let gaussians = from_mfp(0.7, 2.0, configuration, terms);
                let samples = |i: u32| gaussians.sample((f64::from(i) + 0.5) / f64::from(count));
                let mut radii: Vec<f64> = (0..count).map(samples).collect();
                radii.sort_by(f64::total_cmp);
                for (i, r) in radii.iter().enumerate().step_by(977) {
                    let share = (i as f64 + 0.5) / f64::from(count);
                    let allowed = (terms as f64 + 0.5) / f64::from(count);
                    assert!((gaussians.cdf(*r) - share).abs() < allowed, "{terms} {r}: {share}");
                }
            }
        }
    }

    #[test]
    fn sample_stays_finite_at_the_ends() {
        let gaussians = from_mfp(0.5, 1.0, Configuration::Searchlight, 6);
        for u in [0.0, 1.0, 1.0 - f64::EPSILON / 2.0, -1.0, 2.0, f64::NAN, f64::INFINITY] {
            let r = gaussians.sample(u);
            assert!(r.is_finite() && r >= 0.0, "{u}: {r}");
        }
        assert_eq!(gaussians.sample(0.0), 0.0);
        // An empty term is never drawn, wherever it stands
        let holes =
            SumOfGaussians::from_terms(&[0.0, 0.5, 0.0, 0.5, 0.0], &[1e99, 1.0, 1e99, 4.0, 1e99], 1.0);
        let holes = holes.unwrap();
        assert!((0..=1000).all(|i| holes.sample(f64::from(i) / 1000.0) < 100.0));
    }

    #[test]
    fn dmfp_is_the_exact_one() {
        for configuration in CONFIGURATIONS {
            for a in [0.0, 1e-6, 0.2, 0.6, 0.99, 0.9998] {
                let (dmfp, mfp) = (Parameterization::Dmfp, Parameterization::Mfp);
                let alpha = crate::half_space_single_scattering_albedo(a, configuration);
                let medium = crate::Medium::from_dmfp(alpha, 3.0, 0.0).unwrap();
                let found = SumOfGaussians::new(a, 3.0, dmfp, configuration, 4).unwrap();
                let expected = SumOfGaussians::new(a, medium.mfp(), mfp, configuration, 4).unwrap();
                for (found, expected) in found.variances().zip(expected.variances()) {
                    assert!((found / expected - 1.0).abs() < 1e-6, "{a}: {found} {expected}");
                }
            }
        }
    }

    /// √(1−α) = (1 − A)/H(1) in the searchlight configuration, with H(1) = 2.9078 at α = 1 (S. Chandrasekhar
    /// 1950, table XI).
    #[test]
    fn dmfp_reaches_its_limit_near_white() {
        for complement in [1e-4, 1e-6, 1e-9, 1e-15] {
            let a = 1.0 - complement;
            let mfp = half_space_mfp(a, 1.0, Parameterization::Dmfp, Configuration::Searchlight).unwrap();
            let expected = 3f64.sqrt() * (1.0 - a) / 2.9078;
            assert!((mfp / expected - 1.0).abs() < 3e-4, "{complement:e}: {mfp:e} {expected:e}");
        }
        assert!(half_space_mfp(1.0, 1.0, Parameterization::Dmfp, Configuration::Searchlight).is_err());
    }

    #[test]
    fn values_stay_finite_at_extremes() {
        for a in ALBEDOS {
            for length in [1e-149, 1e-100, 1.0, 1e100, 1e149] {
                let gaussians = from_mfp(a, length, Configuration::Diffuse, 6);
                for r in [0.0, -1.0, f64::NAN, 1e-300, length, 1e3 * length, 1e300, f64::INFINITY] {
                    let values = [
                        gaussians.eval(r),
                        gaussians.eval_times_r(r),
                        gaussians.pdf(r),
                        gaussians.pdf_area(r),
                        gaussians.enclosed(r),
                        gaussians.beyond(r),
                    ];
                    assert!(values.iter().all(|value| *value >= 0.0 && value.is_finite()), "{a} {r}");
                    assert!((gaussians.enclosed(r) + gaussians.beyond(r) - a).abs() < 1e-15);
                }
                assert!(gaussians.scale() > 0.0 && gaussians.scale().is_finite());
            }
        }
    }

    #[test]
    fn parameters_are_checked() {
        let new = |a, length, terms| {
            SumOfGaussians::new(a, length, Parameterization::Mfp, Configuration::Diffuse, terms)
        };
        for (a, length, terms) in [
            (-0.1, 1.0, 6),
            (1.1, 1.0, 6),
            (f64::NAN, 1.0, 6),
            (0.5, 0.0, 6),
            (0.5, -1.0, 6),
            (0.5, f64::NAN, 6),
            (0.5, f64::INFINITY, 6),
            (0.5, 1.0, 0),
            (0.5, 1.0, 7),
        ] {
            assert!(new(a, length, terms).is_err(), "{a} {length} {terms}");
        }
        let dmfp =
            |a, length| SumOfGaussians::new(a, length, Parameterization::Dmfp, Configuration::Diffuse, 6);
        for (a, length) in [(1.0, 1.0), (0.5, 0.0), (0.5, f64::NAN), (f64::NAN, 1.0), (1.5, 1.0)] {
            assert!(dmfp(a, length).is_err(), "{a} {length}");
        }
        let terms = SumOfGaussians::from_terms;
        assert!(terms(&[0.4, 0.6], &[1.0, 2.0], 0.5).is_ok());
        assert!(terms(&[], &[], 0.5).is_err());
        assert!(terms(&[0.1; 10], &[1.0; 10], 0.5).is_err());
        assert!(terms(&[1.0], &[1.0, 2.0], 0.5).is_err());
        assert!(terms(&[1.2, -0.2], &[1.0, 2.0], 0.5).is_err());
        assert!(terms(&[0.4, 0.5], &[1.0, 2.0], 0.5).is_err());
        assert!(terms(&[f64::NAN, 0.5], &[1.0, 2.0], 0.5).is_err());
        assert!(terms(&[0.4, 0.6], &[1.0, 0.0], 0.5).is_err());
        assert!(terms(&[0.4, 0.6], &[1.0, f64::NAN], 0.5).is_err());
        assert!(terms(&[1.0], &[1.0], 1.5).is_err());
    }
}
