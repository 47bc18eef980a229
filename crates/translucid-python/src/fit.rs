//! `translucid.fit` and `translucid.fit_scaling`.

use std::sync::Arc;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use translucid_fit::{
    Burley, Errors, Estimate, Exponential, Family, Gaussian, Sample, SampleFit, SampleFits, ScalingFit,
    ScalingPolynomial, Target, l1_error,
};
use translucid_profile::{ParameterError, Parameterization};

use crate::arrays::{Any, Numbers, Rule, array_like};
use crate::profile::{FAMILIES, Profile, profile_of_fit};
use crate::profiles::SharedProfile;
use crate::{long_work, names};

/// Least error of a sample.
const LEAST_ERROR: f64 = 1e-250;
/// Most samples.
const MOST_SAMPLES: usize = 1_000_000;
/// Terms where their number is not said.
const TERMS: usize = 2;

/// A sum fitted to samples or to a profile, with the uncertainties of its parameters.
///
/// R(r) = A (weights[0] K(r; scales[0]) + …), where each K has the energy 1.
/// Made by `fit`.
#[pyclass(frozen, module = "translucid")]
pub(crate) struct Fit {
    family: &'static str,
    total: Estimate,
    weights: Vec<Estimate>,
    scales: Vec<Estimate>,
    /// χ², degrees of freedom and residuals of samples; of a profile its L1 distance.
    quality: Quality,
    profile: SharedProfile,
    /// Weights and scales of the profile.
    terms: Vec<(f64, f64)>,
}

enum Quality {
    Samples { chi_square: f64, degrees_of_freedom: usize, is_singular: bool, residuals: Vec<f64> },
    Profile { l1_error: f64 },
}

/// A fit as far as it needs no interpreter.
type Fitted = Result<Fit, ParameterError>;

impl Fit {
    fn of_samples<F: Family + 'static>(family: &'static str, samples: &[Sample], fit: &SampleFit<F>) -> Self {
        Self {
            family,
            total: fit.total(),
            weights: fit.weights().to_vec(),
            scales: fit.scales().to_vec(),
            quality: Quality::Samples {
                chi_square: fit.chi_square(),
                degrees_of_freedom: fit.degrees_of_freedom(),
                is_singular: fit.is_singular(),
                residuals: fit.residuals(samples),
            },
            profile: Arc::new(fit.mixture().clone()),
            terms: fit.mixture().terms().collect(),
        }
    }

    fn of_profile<F: Family + 'static>(
        family: &'static str,
        profile: &dyn translucid_profile::Profile,
        terms: usize,
    ) -> Fitted {
        let mixture = Target::new(profile)?.fit::<F>(terms)?.swap_remove(terms - 1).mixture;
        let certain = |values: &[f64]| values.iter().map(|&value| Estimate { value, error: 0.0 }).collect();
        Ok(Self {
            family,
            total: Estimate { value: profile.surface_albedo(), error: 0.0 },
            weights: certain(mixture.weights()),
            scales: certain(mixture.scales()),
            quality: Quality::Profile { l1_error: l1_error(&mixture, profile, f64::INFINITY) },
            terms: mixture.terms().collect(),
            profile: Arc::new(mixture),
        })
    }
}

/// A value and its error.
type Pair = (f64, f64);

/// χ², degrees of freedom, whether it is singular, and residuals.
type SampleQuality = (f64, usize, bool, Vec<f64>);

/// A fit as pickles have it: the family; total, weights and scales; the quality of one of samples, or the L1 distance of another;
/// the energy of the profile and its terms.
type State = (String, Pair, Vec<Pair>, Vec<Pair>, Option<SampleQuality>, f64, f64, Vec<Pair>);

fn numbers<'py>(py: Python<'py>, numbers: impl Iterator<Item = f64>) -> PyResult<Any<'py>> {
    // What nothing limits is as large as can be
    let numbers: Vec<f64> = numbers.map(|x| x.min(f64::MAX)).collect();
    array_like(py, &[&Numbers::One(0.0)], &[numbers.len()], numbers)
}

#[pymethods]
impl Fit {
    /// Name of the family: "normalized-diffusion", "exponentials" or "gaussians".
    #[getter]
    fn family(&self) -> &'static str {
        self.family
    }

    /// Surface albedo A, the energy of all terms; above 1 where the samples say so.
    #[getter]
    fn surface_albedo(&self) -> f64 {
        self.total.value
    }

    /// Its standard error.
    #[getter]
    fn surface_albedo_error(&self) -> f64 {
        self.total.error.min(f64::MAX)
    }

    /// Shares of the energy, of sum 1, one for each term.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        numbers(py, self.weights.iter().map(|weight| weight.value))
    }

    /// Their standard errors.
    #[getter]
    fn weight_errors<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        numbers(py, self.weights.iter().map(|weight| weight.error))
    }

    /// Lengths of the terms, rising, in the unit of r: d of normalized diffusion, 1/rate of an exponential, the standard
    /// deviation of a Gaussian.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        numbers(py, self.scales.iter().map(|scale| scale.value))
    }

    /// Their standard errors; as large as a number can be where the samples do not determine one.
    #[getter]
    fn scale_errors<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        numbers(py, self.scales.iter().map(|scale| scale.error))
    }

    /// Sum of the squares of (fit - reflectance)/error; None for a fit to a profile.
    #[getter]
    fn chi_square(&self) -> Option<f64> {
        match self.quality {
            Quality::Samples { chi_square, .. } => Some(chi_square),
            Quality::Profile { .. } => None,
        }
    }

    /// Samples less parameters; None for a fit to a profile.
    #[getter]
    fn degrees_of_freedom(&self) -> Option<usize> {
        match self.quality {
            Quality::Samples { degrees_of_freedom, .. } => Some(degrees_of_freedom),
            Quality::Profile { .. } => None,
        }
    }

    /// (fit - reflectance)/error of each sample, without errors in units of the reflectance; None for a profile.
    #[getter]
    fn residuals<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        match &self.quality {
            Quality::Samples { residuals, .. } => numbers(py, residuals.iter().copied()).map(Some),
            Quality::Profile { .. } => Ok(None),
        }
    }

    /// Area-weighted L1 distance from the profile, relative to its energy; None for a fit to samples.
    #[getter]
    fn l1_error(&self) -> Option<f64> {
        match self.quality {
            Quality::Samples { .. } => None,
            Quality::Profile { l1_error } => Some(l1_error.min(f64::MAX)),
        }
    }

    /// Names of the parameters whose standard error exceeds a third of the value: the samples do not determine them.
    #[getter]
    fn undetermined(&self) -> Vec<String> {
        let is_open = |estimate: &&Estimate| !estimate.is_determined();
        let mut open = Vec::new();
        if is_open(&&self.total) {
            open.push(String::from("surface_albedo"));
        }
        for (name, estimates) in [("weights", &self.weights), ("scales", &self.scales)] {
            let of_name = estimates.iter().enumerate().filter(|(_, estimate)| is_open(estimate));
            open.extend(of_name.map(|(i, _)| format!("{name}[{i}]")));
        }
        if let Quality::Samples { is_singular: true, .. } = self.quality
            && open.is_empty()
        {
            open.push(String::from("some combination of parameters"));
        }
        open
    }

    /// The call that makes it again, for pickles.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Any<'py>, (State,))> {
        let this = slf.get();
        let pair = |estimate: &Estimate| (estimate.value, estimate.error);
        let pairs = |estimates: &[Estimate]| estimates.iter().map(pair).collect();
        let (of_samples, l1_error) = match &this.quality {
            Quality::Samples { chi_square, degrees_of_freedom, is_singular, residuals } => {
                (Some((*chi_square, *degrees_of_freedom, *is_singular, residuals.clone())), 0.0)
            }
            Quality::Profile { l1_error } => (None, *l1_error),
        };
        let state = (
            this.family.to_owned(),
            pair(&this.total),
            pairs(&this.weights),
            pairs(&this.scales),
            of_samples,
            l1_error,
            this.profile.surface_albedo(),
            this.terms.clone(),
        );
        Ok((slf.get_type().getattr("_from_state")?, (state,)))
    }

    #[staticmethod]
    fn _from_state(state: State) -> PyResult<Self> {
        let (family, total, weights, scales, of_samples, l1_error, energy, terms) = state;
        let profile = profile_of_fit(&family, energy, &terms)?;
        let family = FAMILIES.into_iter().find(|known| *known == family).unwrap_or(FAMILIES[0]);
        let estimate = |(value, error): Pair| Estimate { value, error };
        let estimates = |pairs: Vec<Pair>| pairs.into_iter().map(estimate).collect();
        let quality = match of_samples {
            Some((chi_square, degrees_of_freedom, is_singular, residuals)) => {
                Quality::Samples { chi_square, degrees_of_freedom, is_singular, residuals }
            }
            None => Quality::Profile { l1_error },
        };
        let (total, weights, scales) = (estimate(total), estimates(weights), estimates(scales));
        Ok(Self { family, total, weights, scales, quality, profile, terms })
    }

    /// The fitted sum, to evaluate and to sample.
    #[getter]
    fn profile(&self, py: Python<'_>) -> PyResult<Profile> {
        Profile::of_fit(py, self.family, Arc::clone(&self.profile), self.terms.clone())
    }

    fn __repr__(&self) -> String {
        let Estimate { value, error } = self.total;
        let mut text = format!("<Fit of {}: surface_albedo {value:.6} ± {error:.1e}", self.family);
        for (weight, scale) in self.weights.iter().zip(&self.scales) {
            let (w, s) = (weight.value, scale.value);
            text += &format!("; weight {w:.4} ± {:.1e}, scale {s:.5} ± {:.1e}", weight.error, scale.error);
        }
        text + ">"
    }
}

/// Fits a sum of profiles to samples, or to another profile.
///
/// Parameters
/// ----------
/// r : array_like of shape (n,), or Profile
///     Radii of the samples, in [1e-100, 1e100]; or the profile that the sum is fitted to.
/// reflectance : array_like of shape (n,), optional
///     R(r) of the samples; with errors noise may make it negative.
/// error : array_like of shape (n,) or float, optional
///     Standard errors of the reflectance, greater than 0. Without them every sample has the same relative error, as
///     large as the residuals are.
/// family : {"exponentials", "gaussians", "normalized-diffusion"}, default "exponentials"
///     What is summed: exponentials over r, Gaussians, or Burley's profile, of which there is one.
/// terms : int, default 2
///     Number of terms, 1 to 8.
///
/// Returns
/// -------
/// Fit
///     With `surface_albedo`, `weights`, `scales`, their standard errors, and the fitted `profile`.
///
/// Raises
/// ------
/// ValueError
///     If there are not more samples than parameters (two for each term), a number is outside its range, or shapes
///     differ.
/// TypeError
///     If an argument is no number, or the reflectance is missing.
///
/// See Also
/// --------
/// fit_scaling : The talk's s(A).
///
/// Notes
/// -----
/// Samples: least squares of (fit - reflectance)/error; standard errors in linear approximation.
/// A profile: least squares weighted by r squared.
///
/// Examples
/// --------
/// >>> truth = translucid.Profile("normalized-diffusion", surface_albedo=0.7, mfp=2.0)
/// >>> r = np.linspace(0.4, 12.0, 30)
/// >>> found = translucid.fit(r, truth.eval(r), 0.01 * truth.eval(r), terms=2)
/// >>> round(found.surface_albedo, 4), bool(found.surface_albedo_error < 0.01)
/// (0.7, True)
/// >>> (found.scales[1] / found.scales[0]).round(3)
/// np.float64(3.0)
#[pyfunction]
#[pyo3(signature = (r, reflectance=None, error=None, *, family="exponentials", terms=None))]
pub(crate) fn fit(
    py: Python<'_>,
    r: &Any<'_>,
    reflectance: Option<&Any<'_>>,
    error: Option<&Any<'_>>,
    family: &str,
    terms: Option<&Any<'_>>,
) -> PyResult<Fit> {
    let Some(&family) = FAMILIES.iter().find(|known| **known == family) else {
        return Err(names::unknown("family", family, &FAMILIES));
    };
    let terms = match terms {
        None if family == "normalized-diffusion" => 1,
        None => TERMS,
        Some(object) => {
            let rule = Rule::new("terms", "in 1..=8", 1.0, 8.0);
            let terms = Numbers::extract("terms", object)?.single(&rule)?;
            if terms.fract() != 0.0 || family == "normalized-diffusion" && terms != 1.0 {
                let allowed =
                    if family == "normalized-diffusion" { "1 for this family" } else { "a whole number" };
                return Err(PyValueError::new_err(format!("terms is {terms}, but must be {allowed}")));
            }
            terms as usize
        }
    };
    let fitted: Fitted = if let Ok(profile) = r.cast::<Profile>() {
        if reflectance.is_some() || error.is_some() {
            return Err(PyTypeError::new_err("reflectance and error belong to samples, but r is a Profile"));
        }
        let profile = profile.get().only()?;
        let work = move || match family {
            "exponentials" => Fit::of_profile::<Exponential>(family, &*profile, terms),
            "gaussians" => Fit::of_profile::<Gaussian>(family, &*profile, terms),
            _ => Fit::of_profile::<Burley>(family, &*profile, 1),
        };
        long_work::run_or_leave(py, work)?
    } else {
        let Some(reflectance) = reflectance else {
            return Err(PyTypeError::new_err("reflectance is missing: r is not a Profile"));
        };
        let (samples, errors) = samples(r, reflectance, error)?;
        let work = move || fit_samples(family, &samples, errors, terms);
        long_work::run_or_leave(py, work)?
    };
    fitted.map_err(names::value_error)
}

fn fit_samples(family: &'static str, samples: &[Sample], errors: Errors, terms: usize) -> Fitted {
    if errors == Errors::Relative {
        // Burley's profile has one term; the sums that it is weighed with have the usual number
        let terms = if family == "normalized-diffusion" { TERMS } else { terms };
        let fits = SampleFits::new(samples, errors, terms)?;
        return Ok(match family {
            "exponentials" => Fit::of_samples(family, samples, &fits.exponentials),
            "gaussians" => Fit::of_samples(family, samples, &fits.gaussians),
            _ => Fit::of_samples(family, samples, &fits.burley),
        });
    }
    Ok(match family {
        "exponentials" => {
            Fit::of_samples(family, samples, &SampleFit::<Exponential>::new(samples, errors, terms)?)
        }
        "gaussians" => Fit::of_samples(family, samples, &SampleFit::<Gaussian>::new(samples, errors, terms)?),
        _ => Fit::of_samples(family, samples, &SampleFit::<Burley>::new(samples, errors, 1)?),
    })
}

/// The samples of a call, in the ranges that the fit has.
fn samples(r: &Any<'_>, reflectance: &Any<'_>, error: Option<&Any<'_>>) -> PyResult<(Vec<Sample>, Errors)> {
    let r = Numbers::extract("r", r)?;
    let reflectance = Numbers::extract("reflectance", reflectance)?;
    let error = error.map(|object| Numbers::extract("error", object)).transpose()?;
    let [count] = r.shape()[..] else {
        let shape = r.shape();
        return Err(PyValueError::new_err(format!("r has the shape {shape:?}, but must have one dimension")));
    };
    if count > MOST_SAMPLES {
        return Err(PyValueError::new_err(format!(
            "r has {count} samples, but at most {MOST_SAMPLES} are fitted"
        )));
    }
    if reflectance.shape() != [count] {
        let shape = reflectance.shape();
        return Err(PyValueError::new_err(format!(
            "reflectance has the shape {shape:?}, but must have that of r, [{count}]"
        )));
    }
    r.require(&Rule::new("r", "in [1e-100, 1e100]", 1e-100, 1e100))?;
    // Without errors, those in proportion to R
    let rule = match error {
        Some(_) => Rule::new("reflectance", "in [-1e200, 1e200]", -1e200, 1e200),
        None => Rule::new("reflectance", "in (0, 1e200] where there are no errors", f64::MIN_POSITIVE, 1e200),
    };
    reflectance.require(&rule)?;
    let (radii, reflectances) = (r.broadcast(&[count]), reflectance.broadcast(&[count]));
    let (errors, kind) = match &error {
        None => (reflectances.clone(), Errors::Relative),
        Some(error) => {
            error.require(&Rule::new("error", "in [1e-250, 1e250]", LEAST_ERROR, 1e250))?;
            if !matches!(error.shape(), [] | [1]) && error.shape() != [count] {
                let shape = error.shape();
                return Err(PyValueError::new_err(format!(
                    "error has the shape {shape:?}, but must have that of r, [{count}]"
                )));
            }
            (error.broadcast(&[count]), Errors::Known)
        }
    };
    let all = radii.iter().zip(&reflectances).zip(&errors);
    let sample = |((&r, &reflectance), &error): ((&f64, &f64), &f64)| Sample {
        r,
        reflectance,
        error: error.max(LEAST_ERROR),
    };
    Ok((all.map(sample).collect(), kind))
}

/// Scales s(A) that bring normalized diffusion closest to the exact half space, and the polynomial through them.
///
/// The width of the profile is d = length/s(A).
///
/// Parameters
/// ----------
/// configuration : {"searchlight", "diffuse"}, default "searchlight"
///     How light enters.
/// parameter : {"mfp", "dmfp"}, default "mfp"
///     The length that s divides: the mean free path, or the diffuse one.
/// surface_albedo : array_like of shape (n,), optional
///     Surface albedos to fit, in (0, 1], below 1 with a dmfp; by default those of the talk, 0.01, 0.02, … 0.99.
/// max_radius : float, optional
///     Greatest radius that counts in the error, in mean free paths, at least 0.001; by default all count.
///
/// Returns
/// -------
/// dict
///     ``surface_albedo``, ``s`` and ``error``, arrays of shape (n,), the error being the area-weighted L1 distance;
///     ``coefficients`` of s = constant - slope A + factor abs(A - center)**power and ``mean_error`` with them;
///     ``talk_coefficients`` and ``talk_mean_error``, those of Christensen and Burley; ``formula`` as text.
///
/// Raises
/// ------
/// ValueError
///     If a name is not known, or a number is outside its range.
///
/// Examples
/// --------
/// >>> found = translucid.fit_scaling("searchlight", "mfp", surface_albedo=[0.2, 0.5, 0.8])
/// >>> found["s"].round(3)
/// array([2.973, 1.595, 0.954])
#[pyfunction]
#[pyo3(signature = (configuration="searchlight", parameter="mfp", *, surface_albedo=None, max_radius=None))]
pub(crate) fn fit_scaling<'py>(
    py: Python<'py>,
    configuration: &str,
    parameter: &str,
    surface_albedo: Option<&Any<'py>>,
    max_radius: Option<&Any<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let configuration = names::configuration(configuration)?;
    let parameterization = match parameter {
        "mfp" => Parameterization::Mfp,
        "dmfp" => Parameterization::Dmfp,
        _ => return Err(names::unknown("parameter", parameter, &["mfp", "dmfp"])),
    };
    let r_max = match max_radius {
        None => f64::INFINITY,
        Some(object) => {
            let rule = Rule::new("max_radius", "at least 0.001 mean free paths", 1e-3, f64::INFINITY);
            Numbers::extract("max_radius", object)?.single(&rule)?
        }
    };
    let albedos: Vec<f64> = match surface_albedo {
        None => (1..=99).map(|percent| f64::from(percent) / 100.0).collect(),
        Some(object) => {
            let albedos = Numbers::extract("surface_albedo", object)?;
            let most = if parameterization == Parameterization::Mfp { 1.0 } else { 1.0_f64.next_down() };
            let allowed = "in (0, 1], and below 1 with a dmfp";
            albedos.require(&Rule::new("surface_albedo", allowed, f64::MIN_POSITIVE, most))?;
            let count = albedos.shape().iter().product();
            if albedos.shape().len() > 1 || !(1..=10_000).contains(&count) {
                let shape = albedos.shape();
                return Err(PyValueError::new_err(format!(
                    "surface_albedo has the shape {shape:?}, but must have one dimension and 1 to 10000 numbers"
                )));
            }
            albedos.broadcast(&[count])
        }
    };
    let work = move || {
        let fit = ScalingFit::new(parameterization, configuration, &albedos, r_max)?;
        let talk = ScalingPolynomial::talk(parameterization, configuration);
        let fitted = if albedos.len() > 3 { fit.polynomial(&talk) } else { talk };
        let mean = |s: &ScalingPolynomial| fit.errors(|a| s.eval(a), r_max).mean;
        let points = fit.points().iter().map(|point| [point.surface_albedo, point.s, point.error]).collect();
        let (fitted_error, talk_error) = (mean(&fitted), mean(&talk));
        Ok::<(Vec<[f64; 3]>, _, _), ParameterError>((points, (fitted, fitted_error), (talk, talk_error)))
    };
    let found = long_work::run_or_leave(py, work)?;
    let (points, fitted, talk) = found.map_err(names::value_error)?;

    let result = PyDict::new(py);
    for (i, name) in ["surface_albedo", "s", "error"].into_iter().enumerate() {
        result.set_item(name, numbers(py, points.iter().map(|point| point[i]))?)?;
    }
    for (prefix, (form, mean)) in [("", fitted), ("talk_", talk)] {
        // Three points or fewer determine no polynomial
        if prefix.is_empty() && points.len() <= 3 {
            result.set_item("coefficients", py.None())?;
            result.set_item("mean_error", py.None())?;
            result.set_item("formula", py.None())?;
            continue;
        }
        let coefficients = PyDict::new(py);
        let ScalingPolynomial { constant, slope, factor, center, power } = form;
        for (name, value) in
            [("constant", constant), ("slope", slope), ("factor", factor), ("center", center)]
        {
            coefficients.set_item(name, value)?;
        }
        coefficients.set_item("power", power)?;
        result.set_item(format!("{prefix}coefficients"), coefficients)?;
        result.set_item(format!("{prefix}mean_error"), mean)?;
        result.set_item(format!("{prefix}formula"), form.to_string())?;
    }
    Ok(result)
}
