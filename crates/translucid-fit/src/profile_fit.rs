//! Least-squares fits of mixtures to a reference profile.
//!
//! The norm is the energy that differs per logarithm of the radius, squared and summed:
//!
//! ```text
//! ∫ (r² R_fit − r² R)² dr/r  =  ∫ (R_fit − R)² r³ dr
//! ```
//!
//! Every octave of radii counts alike, and the unit of length does not count.
//! A weight r in place of r³, with which E. d'Eon and D. Luebke, *Advanced Techniques for Realistic Real-Time Skin
//! Rendering*, 2007 (GPU Gems 3, chapter 14), fitted Gaussians to dipoles, is not possible here: a dipole is finite at
//! r = 0, but the profile of a real medium grows like 1/r, and ∫ (R_fit − R)² r dr is infinite whatever the Gaussians.
//! r² is possible, but draws terms to radii where there is hardly any energy: six Gaussians then have an
//! [L1 error](crate::l1_error) of 8.0 % at A = 0.5 (searchlight) and 17.5 % at A = 1, where r³ leaves 4.0 % and 10.4 %;
//! r⁴ leaves 5.4 % and 17.8 %.

use std::marker::PhantomData;

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector};
use translucid_profile::{ParameterError, Profile, require};

use crate::least_squares::{Residuals, least_squares};
use crate::{Family, Mixture};

/// A fitted mixture and what it leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit<F> {
    /// The mixture; its total is the reference's.
    pub mixture: Mixture<F>,
    /// √(∫ (R_fit − R)² r³ dr / ∫ R² r³ dr), dimensionless.
    pub residual: f64,
}

/// Best mixtures of 1, 2, … `terms` members of a family.
///
/// The search for K terms starts from the best K − 1 with each of them split in two, with a narrower and a wider one
/// added, and from three ladders of scales; the best end is kept. It is deterministic, and K terms are never worse than
/// K − 1.
///
/// # Errors
/// The reference has no energy, or `terms` is not in 1..=16.
pub fn fit<F: Family>(reference: &dyn Profile, terms: usize) -> Result<Vec<Fit<F>>, ParameterError> {
    Target::new(reference)?.fit(terms)
}

/// A reference profile as the residuals see it.
#[derive(Clone, Debug)]
pub struct Target {
    total: f64,
    scale: f64,
    points: Vec<Point>,
}

/// One residual: weight (r R_fit − `times_r`), in units of the reference's scale and total.
#[derive(Clone, Copy, Debug)]
struct Point {
    r: f64,
    weight: f64,
    times_r: f64,
}

impl Target {
    /// Step of the trapezoidal rule in ln r: a Gaussian is analytic and bounded for imaginary parts below π/4, which
    /// makes the rule's error some e^{−2π·(π/4)/step} = 5e-15.
    const STEP: f64 = 0.15;
    /// Range of steps about the reference's scale: 1e-9 to 1e4 times it.
    const STEPS: std::ops::RangeInclusive<i32> = -138..=62;

    /// Evaluates the reference at 201 radii.
    ///
    /// # Errors
    /// The reference has no energy.
    pub fn new(reference: &dyn Profile) -> Result<Self, ParameterError> {
        let (total, scale) = (reference.surface_albedo(), reference.scale());
        require(total > 0.0 && total.is_finite(), "total", total, "greater than 0")?;
        let point = |step: i32| {
            let r = libm::exp(Self::STEP * f64::from(step));
            Point {
                r,
                weight: Self::STEP.sqrt() * r,
                times_r: reference.eval_times_r(r * scale) * (scale / total),
            }
        };
        let mut points: Vec<Point> = Self::STEPS.map(point).collect();
        // Have the residuals' squares sum to the square of the relative one
        let norm = points.iter().map(|p| (p.weight * p.times_r).powi(2)).sum::<f64>().sqrt();
        points.iter_mut().for_each(|p| p.weight /= norm);
        Ok(Self { total, scale, points })
    }

    /// Best mixtures of 1, 2, … `terms` members, as [`fit`].
    ///
    /// # Errors
    /// `terms` is not in 1..=16.
    pub fn fit<F: Family>(&self, terms: usize) -> Result<Vec<Fit<F>>, ParameterError> {
        require((1..=16).contains(&terms), "terms", terms as f64, "in 1..=16")?;
        let mut fits: Vec<Fit<F>> = Vec::with_capacity(terms);
        for _ in 0..terms {
            let next = self.extend(fits.last());
            fits.push(next);
        }
        Ok(fits)
    }

    /// The nearest optimum to a mixture.
    pub fn refine<F: Family>(&self, start: &Mixture<F>) -> Fit<F> {
        self.descend(&self.scaled(start))
    }

    /// The residual of a mixture of the reference's total, as in [`Fit`].
    pub fn residual<F: Family>(&self, mixture: &Mixture<F>) -> f64 {
        Problem::<F>::new(self).norm(&parameters_of(&self.scaled(mixture)))
    }

    /// Weights, and scales in units of the reference's.
    fn scaled<F: Family>(&self, mixture: &Mixture<F>) -> Vec<(f64, f64)> {
        mixture.terms().map(|(weight, scale)| (weight, scale / self.scale)).collect()
    }

    /// The best fit with one term more.
    fn extend<F: Family>(&self, fewer: Option<&Fit<F>>) -> Fit<F> {
        let starts = match fewer {
            None => [0.1, 1.0].map(|factor| vec![(1.0, factor / F::MEAN_RADIUS)]).to_vec(),
            Some(fewer) => {
                let terms = self.scaled(&fewer.mixture);
                let ladders = [4.0, 8.0, 16.0].map(|ratio| ladder::<F>(terms.len() + 1, ratio));
                extensions(&terms).into_iter().chain(ladders).collect()
            }
        };
        let fits = starts.iter().map(|start| self.descend(start));
        fits.min_by(|a, b| a.residual.total_cmp(&b.residual)).expect("there are starts")
    }

    /// Follows the residual down from a start in units of the reference's scale.
    fn descend<F: Family>(&self, start: &[(f64, f64)]) -> Fit<F> {
        let problem = Problem::<F>::new(self);
        let search = LevenbergMarquardt::new().with_patience(200);
        let found = least_squares(search, &parameters_of(start), &problem);
        let terms = terms_of(&found).into_iter().map(|(weight, scale)| (weight, scale * self.scale));
        Fit { mixture: Mixture::sorted(self.total, terms.collect()), residual: problem.norm(&found) }
    }
}

/// Terms with one more: each split in two, and one added at either end.
pub(crate) fn extensions(terms: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let split = |index: usize, factor: f64| {
        let mut more = terms.to_vec();
        let (weight, scale) = more[index];
        more[index] = (0.5 * weight, scale / factor);
        more.push((0.5 * weight, scale * factor));
        more
    };
    let added = |weight: f64, scale: f64| {
        let mut more: Vec<_> = terms.iter().map(|(w, scale)| (w * (1.0 - weight), *scale)).collect();
        more.push((weight, scale));
        more
    };
    let (least, greatest) = (terms[0].1, terms[terms.len() - 1].1);
    let mut starts: Vec<_> = (0..terms.len()).map(|index| split(index, 1.7)).collect();
    starts.push(added(0.1, 0.2 * least));
    starts.push(added(0.1, 3.0 * greatest));
    // Split into equals: where nothing else is better, this is not worse
    starts.push(split(0, 1.0));
    starts
}

/// Equal weights and scales whose last is twice the reference's, the others falling to its 1/`ratio`^…
fn ladder<F: Family>(terms: usize, ratio: f64) -> Vec<(f64, f64)> {
    let scale = |k: usize| 2.0 / F::MEAN_RADIUS * ratio.powi(-(k as i32));
    (0..terms).map(|k| (1.0, scale(k))).collect()
}

/// Parameters of the optimizer: logits of the weights, then logarithms of the scales, so that no constraint is left.
fn parameters_of(terms: &[(f64, f64)]) -> Vec<f64> {
    let logits = terms.iter().map(|(weight, _)| libm::log(weight.max(1e-12)));
    logits.chain(terms.iter().map(|(_, scale)| libm::log(*scale))).collect()
}

/// Weights and scales of the optimizer's parameters.
fn terms_of(parameters: &[f64]) -> Vec<(f64, f64)> {
    let (logits, ln_scales) = parameters.split_at(parameters.len() / 2);
    let greatest = logits.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
    let weights: Vec<f64> = logits.iter().map(|logit| libm::exp(logit - greatest)).collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().zip(ln_scales).map(|(weight, ln_scale)| (weight / sum, libm::exp(*ln_scale))).collect()
}

/// Distance of a family's mixtures from the reference, by the optimizer's parameters.
struct Problem<'a, F> {
    target: &'a Target,
    family: PhantomData<F>,
}

impl<'a, F: Family> Problem<'a, F> {
    fn new(target: &'a Target) -> Self {
        Self { target, family: PhantomData }
    }

    fn norm(&self, parameters: &[f64]) -> f64 {
        DVector::from_vec(self.residuals(parameters)).norm()
    }
}

impl<F: Family> Residuals for Problem<'_, F> {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let terms = terms_of(parameters);
        let value = |r: f64| terms.iter().map(|(w, s)| w / s * F::times_r(r / s)).sum::<f64>();
        self.target.points.iter().map(|p| p.weight * (value(p.r) - p.times_r)).collect()
    }

    /// ∂/∂logit_k = w_k (K_k − Σ w K),  ∂/∂ln s_k = −w_k (φ + xφ')/s_k.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let terms = terms_of(parameters);
        let mut jacobian = DMatrix::zeros(self.target.points.len(), 2 * terms.len());
        for (row, point) in self.target.points.iter().enumerate() {
            let kernels: Vec<f64> = terms.iter().map(|(_, s)| F::times_r(point.r / s) / s).collect();
            let value: f64 = terms.iter().zip(&kernels).map(|((w, _), kernel)| w * kernel).sum();
            for (k, ((w, s), kernel)) in terms.iter().zip(&kernels).enumerate() {
                let x = point.r / s;
                jacobian[(row, k)] = point.weight * w * (kernel - value);
                jacobian[(row, terms.len() + k)] = -point.weight * w * (kernel + x * F::slope(x) / s);
            }
        }
        jacobian
    }
}
