//! Least-squares fits of a medium's coefficients to a measured or simulated table, with their uncertainties.

use std::cell::RefCell;
use std::rc::Rc;

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector};
use translucid_profile::{ParameterError, require};

use crate::least_squares::{Residuals, least_squares};
use crate::medium_grid::MediumGrid;
use crate::{Errors, Estimate, Sample};

/// Profile R(r) \[ℓ⁻²\] of a medium over r \[ℓ\].
pub type MediumProfile = Box<dyn Fn(f64) -> f64>;

/// Single-scattering albedo and mean free path fitted to samples, and the second similarity parameter γ with them.
///
/// The medium is anything that has one profile for each single-scattering albedo, in units of its mean free path:
///
/// ```text
/// R(r) = f_α(r/ℓ)/ℓ²,     σ_a = (1 − α)/ℓ,     σ_s = α/ℓ
/// ```
///
/// With γ, α is the reduced single-scattering albedo α', ℓ the transport mean free path ℓ*, and σ_s is σ'_s.
#[derive(Clone, Debug)]
pub struct MediumFit {
    /// ln α/(1 − α), ln ℓ, and γ if it is fitted.
    parameters: Vec<f64>,
    covariance: DMatrix<f64>,
    chi_square: f64,
    degrees_of_freedom: usize,
    residuals: Vec<f64>,
}

/// Finds the profile of α and γ.
type Solve<'a> = dyn Fn(f64, f64) -> MediumProfile + 'a;

/// γ at which a fit starts, and how far beyond its range a fit may go.
const GAMMA_START: f64 = 1.0 + 0.85 / 1.5;
const BEYOND: f64 = 0.1;

/// Most samples: of each the profile is asked some hundred times.
const MOST_SAMPLES: usize = 2000;

/// Single-scattering albedos from which a fit may start.
const STARTS: [f64; 6] = [0.3, 0.7, 0.9, 0.97, 0.99, 0.998];

/// Mean free paths from which a fit may start, log-spaced.
const LENGTHS: i32 = 24;

/// About so many samples judge where a fit starts.
const THINNED: usize = 12;

/// Radii between which a profile is interpolated to find where a fit starts.
const START_RADII: u16 = 64;

/// How far beyond the radii of the samples a fit may start, as a factor's logarithm: ten times.
const MARGIN: f64 = 2.3;

/// Steps that a descent usually takes.
const USUAL_STEPS: usize = 8;

impl MediumFit {
    /// Fits the medium whose profiles `solve` finds, each by α in (0, 1).
    ///
    /// [`Errors::Relative`] are taken for shares of what the fit has, as in [`SampleFits`](crate::SampleFits).
    ///
    /// # Errors
    /// There are fewer than three samples or more than 2000, one is not what [`Sample`] says, or none is greater than 0.
    pub fn new(
        samples: &[Sample],
        errors: Errors,
        solve: &dyn Fn(f64) -> MediumProfile,
    ) -> Result<Self, ParameterError> {
        Self::fit(samples, errors, None, &|alpha, _| solve(alpha))
    }

    /// Fits the medium and its γ to the profiles of a grid.
    ///
    /// Known errors are enlarged by those of the grid ([`MediumGrid::error`]).
    /// γ may come out beyond [`MediumGrid::GAMMA`] by up to 3 standard errors. Where its standard error is greater than that
    /// of a guess within this range ([`gamma_is_determined`](Self::gamma_is_determined)), its value means nothing.
    ///
    /// # Errors
    /// There are fewer than four samples, they ask for a γ far beyond the range or an albedo below the grid's, or lie at radii
    /// beyond it; and what [`new`](Self::new) refuses.
    pub fn with_gamma(
        samples: &[Sample],
        errors: Errors,
        grid: &MediumGrid<'_>,
    ) -> Result<Self, ParameterError> {
        let count = samples.len();
        require(count > 3, "number of samples", count as f64, "in [4, 2000] with gamma")?;
        let fit = Self::fit(samples, errors, Some(GAMMA_START), &|alpha, gamma| {
            let row = grid.row(alpha, gamma);
            Box::new(move |r| row.eval(r))
        })?;
        let (alpha, mfp) = (fit.single_scattering_albedo().value, fit.mfp().value);
        let is_solved = alpha >= MediumGrid::LEAST_ALBEDO;
        require(is_solved, "reduced single-scattering albedo", alpha, "at least 0.02 with gamma")?;
        for sample in samples {
            let r = sample.r / mfp;
            let allowed = "in [0.05, 20] with gamma: leave such samples out";
            require(MediumGrid::has_radius(r), "r over the transport mean free path", r, allowed)?;
        }
        if let Some(Estimate { value, error }) = fit.gamma().filter(|_| fit.gamma_is_determined()) {
            let [low, high] = MediumGrid::GAMMA;
            // At least what the grid's own error does to γ
            let farthest = (3.0 * error).clamp(0.03, 0.99 * BEYOND);
            let is_near = value > low - farthest && value < high + farthest;
            require(
                is_near,
                "gamma",
                value,
                "in [1, 1.85]: the samples ask for more or less than is solved",
            )?;
        }
        Ok(fit)
    }

    fn fit(
        samples: &[Sample],
        errors: Errors,
        gamma: Option<f64>,
        solve: &Solve<'_>,
    ) -> Result<Self, ParameterError> {
        let count = samples.len();
        require((3..=MOST_SAMPLES).contains(&count), "number of samples", count as f64, "in [3, 2000]")?;
        for sample in samples {
            require((1e-100..=1e100).contains(&sample.r), "r", sample.r, "in [1e-100, 1e100]")?;
            require(
                sample.reflectance.abs() <= 1e200,
                "reflectance",
                sample.reflectance,
                "in [-1e200, 1e200]",
            )?;
            require((1e-250..=1e250).contains(&sample.error), "error", sample.error, "in [1e-250, 1e250]")?;
        }
        let greatest = samples.iter().map(|sample| sample.reflectance).fold(0.0, f64::max);
        require(greatest > 0.0, "greatest reflectance", greatest, "greater than 0")?;

        let start = Problem::start(samples, gamma, solve);
        let first = Self::descend(samples, errors, &start, solve);
        if errors == Errors::Known && gamma.is_none() {
            return Ok(first);
        }
        let mfp = first.mfp().value;
        let weigh = |(sample, residual): (&Sample, &f64)| {
            let error = match errors {
                Errors::Known => {
                    libm::hypot(sample.error, MediumGrid::error(sample.r / mfp) * sample.reflectance)
                }
                Errors::Relative => {
                    let fitted = sample.reflectance + residual * sample.error;
                    fitted.clamp(0.5 * sample.reflectance, 2.0 * sample.reflectance)
                }
            };
            Sample { error: error.max(1e-250), ..*sample }
        };
        let weighed: Vec<Sample> = samples.iter().zip(&first.residuals).map(weigh).collect();
        let second = Self::descend(&weighed, errors, &first.parameters, solve);
        let again = |((residual, weighed), sample): ((&f64, &Sample), &Sample)| {
            residual * weighed.error / sample.error
        };
        let residuals = second.residuals.iter().zip(&weighed).zip(samples).map(again).collect();
        Ok(Self { residuals, ..second })
    }

    /// About how often a fit of so many samples asks profiles for a value, to tell how much of it is done.
    pub fn usual_evaluations(samples: usize, errors: Errors) -> u64 {
        let starts = STARTS.len() * usize::from(START_RADII);
        // At every step the residuals and their slopes, twice by each of two parameters
        let descents = if errors == Errors::Known { 1 } else { 2 };
        (starts + descents * USUAL_STEPS * 5 * samples) as u64
    }

    fn descend(samples: &[Sample], errors: Errors, start: &[f64], solve: &Solve<'_>) -> Self {
        let problem = Problem::new(samples, solve);
        let descend =
            |start: &[f64]| least_squares(LevenbergMarquardt::new().with_patience(20), start, &problem);
        let mut found = descend(start);
        if found.get(2).is_some_and(|gamma| within(*gamma) != *gamma) {
            // A step went where γ has no effect any more: once more from the last place where it has
            found[2] = within(found[2]);
            found = descend(&found);
        }
        let residuals = problem.residuals(&found);
        let chi_square = residuals.iter().map(|r| r * r).sum::<f64>();
        let degrees_of_freedom = samples.len() - start.len();
        let jacobian = problem.jacobian(&found);
        let factor = match errors {
            Errors::Known => 1.0,
            Errors::Relative => chi_square / degrees_of_freedom as f64,
        };
        let normal = jacobian.transpose() * &jacobian;
        let size = start.len();
        // The samples give no error to a parameter that has no effect on them
        let covariance = normal
            .try_inverse()
            .map_or(DMatrix::from_element(size, size, f64::INFINITY), |inverse| inverse * factor);
        let parameters =
            [&found[..2], &found[2..].iter().map(|gamma| within(*gamma)).collect::<Vec<_>>()].concat();
        Self { parameters, covariance, chi_square, degrees_of_freedom, residuals }
    }

    /// Single-scattering albedo.
    pub fn single_scattering_albedo(&self) -> Estimate {
        let alpha = logistic(self.parameters[0]);
        Estimate { value: alpha, error: alpha * (1.0 - alpha) * self.error([1.0, 0.0, 0.0]) }
    }

    /// Mean free path ℓ \[L\].
    pub fn mfp(&self) -> Estimate {
        self.exponential(libm::exp(self.parameters[1]), [0.0, 1.0, 0.0])
    }

    /// Absorption coefficient σ_a \[L⁻¹\].
    pub fn sigma_a(&self) -> Estimate {
        let alpha = logistic(self.parameters[0]);
        self.exponential(logistic(-self.parameters[0]) / self.mfp().value, [-alpha, -1.0, 0.0])
    }

    /// Scattering coefficient σ_s \[L⁻¹\].
    pub fn sigma_s(&self) -> Estimate {
        let alpha = logistic(self.parameters[0]);
        self.exponential(alpha / self.mfp().value, [1.0 - alpha, -1.0, 0.0])
    }

    /// Any function of the single-scattering albedo.
    pub fn of_albedo(&self, function: impl Fn(f64) -> f64) -> Estimate {
        let at = |step: f64| function(logistic(self.parameters[0] + step));
        let slope = (at(1e-3) - at(-1e-3)) / 2e-3;
        Estimate { value: at(0.0), error: slope.abs() * self.error([1.0, 0.0, 0.0]) }
    }

    /// Second similarity parameter γ = (1 − χ₂)/(1 − χ₁) of the phase function, if it is fitted.
    pub fn gamma(&self) -> Option<Estimate> {
        let value = *self.parameters.get(2)?;
        Some(Estimate { value, error: self.error([0.0, 0.0, 1.0]) })
    }

    /// Whether the samples say more of γ than that it is in [`MediumGrid::GAMMA`]; no if it is not fitted.
    pub fn gamma_is_determined(&self) -> bool {
        let [low, high] = MediumGrid::GAMMA;
        self.gamma().is_some_and(|gamma| gamma.error < (high - low) / 12.0_f64.sqrt())
    }

    /// Any function of the reduced single-scattering albedo and γ, where γ is fitted.
    pub fn of_albedo_and_gamma(&self, function: impl Fn(f64, f64) -> f64) -> Option<Estimate> {
        let gamma = *self.parameters.get(2)?;
        let at = |step: f64, other: f64| function(logistic(self.parameters[0] + step), gamma + other);
        let slope = |up: f64, down: f64| (up - down) / 0.02;
        let along_albedo = slope(at(0.01, 0.0), at(-0.01, 0.0));
        let along_gamma = slope(at(0.0, 0.01), at(0.0, -0.01));
        Some(Estimate { value: at(0.0, 0.0), error: self.error([along_albedo, 0.0, along_gamma]) })
    }

    /// Correlations of σ_a, σ_s and γ, in this order, where γ is fitted.
    pub fn correlations(&self) -> Option<[[f64; 3]; 3]> {
        self.gamma()?;
        let alpha = logistic(self.parameters[0]);
        let gradients = [[-alpha, -1.0, 0.0], [1.0 - alpha, -1.0, 0.0], [0.0, 0.0, 1.0]];
        let element = |a: [f64; 3], b: [f64; 3]| self.covariance_of(a, b) / (self.error(a) * self.error(b));
        Some(gradients.map(|a| gradients.map(|b| element(a, b))))
    }

    /// A value whose logarithm changes with the parameters by a gradient.
    fn exponential(&self, value: f64, gradient: [f64; 3]) -> Estimate {
        Estimate { value, error: value * self.error(gradient) }
    }

    /// Covariance of two values by their gradients.
    fn covariance_of(&self, a: [f64; 3], b: [f64; 3]) -> f64 {
        let [a, b] = [a, b].map(|of| DVector::from_column_slice(&of[..self.parameters.len()]));
        a.dot(&(&self.covariance * b))
    }

    fn error(&self, gradient: [f64; 3]) -> f64 {
        let variance = self.covariance_of(gradient, gradient);
        if variance >= 0.0 { variance.sqrt() } else { f64::INFINITY }
    }

    /// Σ ((R_fit − R)/error)², where errors hold the grid's with γ.
    pub fn chi_square(&self) -> f64 {
        self.chi_square
    }

    /// Samples less parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        self.degrees_of_freedom
    }

    /// (R_fit − R)/error of each sample.
    pub fn residuals(&self) -> &[f64] {
        &self.residuals
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// Distance of the medium from the samples, by ln α/(1 − α), ln ℓ and γ.
struct Problem<'a> {
    samples: &'a [Sample],
    solve: &'a Solve<'a>,
    /// The profile that was solved last, by ln α/(1 − α) and γ: residuals and their derivatives need the same one.
    solved: RefCell<Option<([f64; 2], Rc<MediumProfile>)>>,
}

impl<'a> Problem<'a> {
    /// Farthest that ln α/(1 − α) goes.
    const MOST: f64 = 16.0;
    /// Steps of numeric slopes.
    const STEP: f64 = 1e-3;

    fn new(samples: &'a [Sample], solve: &'a Solve<'a>) -> Self {
        Self { samples, solve, solved: RefCell::default() }
    }

    fn solve(&self, logit: f64, gamma: f64) -> MediumProfile {
        (self.solve)(logistic(logit.clamp(-Self::MOST, Self::MOST)), gamma)
    }

    fn profile(&self, [logit, gamma]: [f64; 2]) -> Rc<MediumProfile> {
        let mut solved = self.solved.borrow_mut();
        match &*solved {
            Some((of, profile)) if *of == [logit, gamma] => Rc::clone(profile),
            _ => {
                let profile = Rc::new(self.solve(logit, gamma));
                *solved = Some(([logit, gamma], Rc::clone(&profile)));
                profile
            }
        }
    }

    /// The best of a few single-scattering albedos and many mean free paths.
    fn start(samples: &[Sample], gamma: Option<f64>, solve: &Solve<'_>) -> Vec<f64> {
        let ends = samples.iter().fold([f64::MAX, 0.0f64], |[low, high], s| [low.min(s.r), high.max(s.r)]);
        let [low, high] = ends.map(libm::log);
        let thinned: Vec<Sample> = samples.iter().step_by(samples.len().div_ceil(THINNED)).copied().collect();
        let start = |logit: f64, ln_mfp: f64| [logit, ln_mfp].into_iter().chain(gamma).collect::<Vec<f64>>();
        let mut best = (f64::INFINITY, start(0.0, 0.5 * (low + high)));
        for alpha in STARTS {
            let profile = Self::interpolated(&solve(alpha, gamma.unwrap_or(1.0)), high - low + MARGIN);
            let interpolated = |_: f64, _: f64| -> MediumProfile { Box::new(profile.clone()) };
            let problem = Problem::new(&thinned, &interpolated);
            for i in 0..=LENGTHS {
                let ln_mfp = low - MARGIN + (high - low + 2.0 * MARGIN) * f64::from(i) / f64::from(LENGTHS);
                let parameters = start(libm::log(alpha / (1.0 - alpha)), ln_mfp);
                let cost = problem.residuals(&parameters).iter().map(|r| r * r).sum::<f64>();
                if cost < best.0 {
                    best = (cost, parameters);
                }
            }
        }
        best.1
    }

    /// A profile over |ln r| up to a limit, linear in ln R over ln r between a few radii: a start may be off by some percent.
    fn interpolated(profile: &MediumProfile, limit: f64) -> impl Fn(f64) -> f64 + Clone + use<> {
        let step = 2.0 * limit / f64::from(START_RADII - 1);
        let ln_value =
            |i: u16| libm::log(profile(libm::exp(f64::from(i) * step - limit)).max(f64::MIN_POSITIVE));
        let ln_values: Rc<[f64]> = (0..START_RADII).map(ln_value).collect();
        move |r| {
            let place = ((libm::log(r) + limit) / step).clamp(0.0, f64::from(START_RADII - 1));
            let i = (place as usize).min(ln_values.len() - 2);
            libm::exp(ln_values[i] + (place - i as f64) * (ln_values[i + 1] - ln_values[i]))
        }
    }

    fn values(&self, profile: &MediumProfile, ln_mfp: f64) -> Vec<f64> {
        let mfp = libm::exp(ln_mfp.clamp(-300.0, 300.0));
        let residual = |sample: &Sample| {
            let value = (profile(sample.r / mfp) / mfp / mfp - sample.reflectance) / sample.error;
            if value.is_nan() { 0.0 } else { value.clamp(-1e150, 1e150) }
        };
        self.samples.iter().map(residual).collect()
    }
}

impl Residuals for Problem<'_> {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        self.values(&self.profile([parameters[0], gamma_of(parameters)]), parameters[1])
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let [logit, ln_mfp, gamma] = [parameters[0], parameters[1], gamma_of(parameters)];
        let profile = self.profile([logit, gamma]);
        let along_length = [1.0, -1.0].map(|sign| self.values(&profile, ln_mfp + sign * Self::STEP));
        let along_albedo =
            [1.0, -1.0].map(|sign| self.values(&self.solve(logit + sign * Self::STEP, gamma), ln_mfp));
        let mut pairs = vec![along_albedo, along_length];
        if parameters.len() > 2 {
            let along_gamma =
                [1.0, -1.0].map(|sign| self.values(&self.solve(logit, gamma + sign * Self::STEP), ln_mfp));
            pairs.push(along_gamma);
        }
        DMatrix::from_fn(self.samples.len(), pairs.len(), |i, j| {
            let [up, down] = &pairs[j];
            (up[i] - down[i]) / (2.0 * Self::STEP)
        })
    }
}

/// γ of the parameters, as far as profiles reach; isotropic scattering's where it is not fitted.
fn gamma_of(parameters: &[f64]) -> f64 {
    parameters.get(2).map_or(1.0, |gamma| within(*gamma))
}

/// γ no farther beyond the range than profiles are continued.
fn within(gamma: f64) -> f64 {
    let [low, high] = MediumGrid::GAMMA;
    gamma.clamp(low - BEYOND, high + BEYOND)
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::rc::Rc;

    use translucid_reference::Incidence;
    use translucid_reference::exact::HalfSpace;
    use translucid_testing::{SplitMix, power};

    use super::*;

    fn half_space(alpha: f64) -> MediumProfile {
        let half_space = HalfSpace::new(alpha, Incidence::NORMAL).unwrap();
        Box::new(move |r| half_space.eval(r).value)
    }

    fn normal(random: &mut SplitMix) -> f64 {
        (-2.0 * libm::log(1.0 - random.uniform())).sqrt()
            * libm::cos(std::f64::consts::TAU * random.uniform())
    }

    /// Samples of a half space with noise of a share of R.
    fn samples(alpha: f64, mfp: f64, noise: f64, seed: u64) -> Vec<Sample> {
        let (profile, mut random) = (half_space(alpha), SplitMix(seed));
        let sample = |i: i32| {
            let r = 0.3 * mfp * libm::exp(0.1 * f64::from(i));
            let truth = profile(r / mfp) / mfp / mfp;
            Sample {
                r,
                reflectance: truth * (1.0 + noise * normal(&mut random)),
                error: noise.max(1e-6) * truth,
            }
        };
        (0..40).map(sample).collect()
    }

    #[test]
    fn new_gives_back_the_medium() {
        for (alpha, mfp) in [(0.4, 3.0), (0.9, 0.01), (0.998, 0.5)] {
            let fit = MediumFit::new(&samples(alpha, mfp, 0.0, 1), Errors::Known, &half_space).unwrap();
            assert!((fit.mfp().value / mfp - 1.0).abs() < 1e-4, "{:?}", fit.mfp());
            assert!((fit.sigma_a().value * mfp / (1.0 - alpha) - 1.0).abs() < 1e-3, "{:?}", fit.sigma_a());
            assert!((fit.sigma_s().value * mfp / alpha - 1.0).abs() < 1e-3, "{:?}", fit.sigma_s());
        }
    }

    #[test]
    fn usual_evaluations_are_about_those_of_a_fit() {
        for (count, errors) in [(9, Errors::Known), (40, Errors::Known), (40, Errors::Relative)] {
            let done = Rc::new(Cell::new(0_u64));
            let counted = |alpha: f64| -> MediumProfile {
                let (profile, done) = (half_space(alpha), Rc::clone(&done));
                Box::new(move |r| {
                    done.set(done.get() + 1);
                    profile(r)
                })
            };
            let samples = &samples(0.9, 0.7, 0.05, 3)[..count];
            MediumFit::new(samples, errors, &counted).unwrap();
            let usual = MediumFit::usual_evaluations(count, errors);
            assert!((usual / 2..2 * usual).contains(&done.get()), "{} of {usual}", done.get());
        }
    }

    /// χ² of two coefficients over their standard errors, within 4 standard deviations of what it is if the two err together.
    #[test]
    fn errors_are_those_of_the_noise() {
        for errors in [Errors::Known, Errors::Relative] {
            let (mut chi_square, count) = (0.0_f64, power(40));
            for seed in 0..count {
                let mut samples = samples(0.9, 0.7, 0.05, seed);
                if errors == Errors::Relative {
                    samples.iter_mut().for_each(|s| s.error = s.reflectance);
                }
                let fit = MediumFit::new(&samples, errors, &half_space).unwrap();
                for (estimate, truth) in [(fit.sigma_a(), 0.1 / 0.7), (fit.mfp(), 0.7)] {
                    chi_square += ((estimate.value - truth) / estimate.error).powi(2);
                }
            }
            let off = chi_square - 2.0 * count as f64;
            assert!(off.abs() < 4.0 * (8.0 * count as f64).sqrt(), "{errors:?}: {chi_square} of {count}");
        }
    }

    #[test]
    fn new_refuses_what_is_no_table() {
        let good = samples(0.9, 1.0, 0.0, 1);
        let fails = |samples: &[Sample]| MediumFit::new(samples, Errors::Known, &half_space).is_err();
        assert!(fails(&good[..2]) && !fails(&good[..3]));
        assert!(fails(&vec![good[0]; 2001]));
        assert!(fails(&[Sample { r: f64::NAN, ..good[0] }, good[1], good[2]]));
        assert!(fails(&[Sample { error: 0.0, ..good[0] }, good[1], good[2]]));
        assert!(fails(&good[..5].iter().map(|s| Sample { reflectance: -1.0, ..*s }).collect::<Vec<_>>()));
    }
}
