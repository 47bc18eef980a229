//! The half space that explains a table best.

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::sync::atomic::{AtomicU64, Ordering};

use translucid_fit::{Errors, Estimate, MediumFit, MediumGrid, MediumProfile, Sample};
use translucid_profile::{Configuration, ParameterError};
use translucid_reference::exact::HalfSpace;
use translucid_reference::layers::{Ground, Layer, Layers, LayersError, LayersProfile};
use translucid_reference::walk::{Control, PhaseFunction};
use translucid_reference::{Incidence, specular_reflectance};
use translucid_scene::{Place, SceneError};

use super::FitArguments;
use crate::failure::Failure;
use crate::interrupt;
use crate::model::ConfigurationName;
use crate::progress::{Meter, Unit};

/// A medium with what is printed of it.
pub(super) struct HalfSpaceFit {
    pub(super) fit: MediumFit,
    pub(super) parameters: Vec<(&'static str, Estimate)>,
    pub(super) warnings: Vec<String>,
}

/// Parameters whose correlations are printed where gamma is fitted.
pub(super) const CORRELATED: [&str; 3] = ["sigma_a", "sigma_s_prime", "gamma"];

/// The part of the error that is not printed, as `docs/guide/numbers.md` has it.
pub(super) const ASSUMPTION: &str = "  standard errors leave out that of the higher moments, which are assumed: \
     other phase functions shift gamma by some\n  0.05 from 0.5 transport mean free paths on, by 0.2 nearer, and sigma_a by some 10 %\n";

/// Fits the half space, with its second similarity parameter if the arguments say so.
pub(super) fn fit(
    arguments: &FitArguments,
    path: &Path,
    samples: &[Sample],
    errors: Errors,
) -> Result<HalfSpaceFit, Failure> {
    let configuration =
        Configuration::from(arguments.configuration.unwrap_or(ConfigurationName::Searchlight));
    let incidence = Incidence::from(configuration);
    let solve = |alpha: f64| HalfSpace::with_boundary(alpha, arguments.eta, incidence);
    // What is refused is so for every albedo
    solve(0.5).map_err(|error| Failure::input(error.to_string()))?;
    let entering = 1.0 - specular_reflectance(incidence, arguments.eta);
    interrupt::catch("\nstopping; nothing is written")?;
    let refused = |error: ParameterError| SceneError::at(Place::file(path), error.to_string());
    if arguments.gamma {
        let fit = fit_with_gamma(arguments.eta, samples, errors)?.map_err(refused)?;
        let total = |alpha: f64, gamma: f64| {
            let totals =
                layers(alpha, gamma, arguments.eta).ok().and_then(|layers| layers.totals(incidence).ok());
            totals.map_or(f64::NAN, |totals| totals.diffuse_reflectance / entering)
        };
        let extra = fit.of_albedo_and_gamma(total).into_iter().map(|albedo| ("surface_albedo", albedo));
        let gamma = fit.gamma().into_iter().map(|gamma| ("gamma", gamma));
        let parameters = extra.chain(coefficients(&fit)).chain(gamma).collect();
        let warnings = warning(&fit).into_iter().collect();
        return Ok(HalfSpaceFit { fit, parameters, warnings });
    }
    let evaluations = Rc::new(Evaluations::new(MediumFit::usual_evaluations(samples.len(), errors)));
    let profile = |alpha: f64| -> MediumProfile {
        if evaluations.are_stopped() {
            return Box::new(|_| 0.0);
        }
        let Ok(half_space) = solve(alpha) else { return Box::new(|_| 0.0) };
        let evaluations = Rc::clone(&evaluations);
        Box::new(move |r| evaluations.count(0.0, || entering * half_space.eval(r).value))
    };
    let fit = MediumFit::new(samples, errors, &profile);
    let fit = evaluations.finish(fit)?.map_err(refused)?;
    let total = |alpha: f64| solve(alpha).map_or(f64::NAN, |half_space| half_space.total().value);
    let parameters =
        [("surface_albedo", fit.of_albedo(total))].into_iter().chain(coefficients(&fit)).collect();
    Ok(HalfSpaceFit { fit, parameters, warnings: Vec::new() })
}

fn coefficients(fit: &MediumFit) -> [(&'static str, Estimate); 3] {
    [("mfp", fit.mfp()), ("sigma_a", fit.sigma_a()), ("sigma_s_prime", fit.sigma_s())]
}

/// Tolerance of the profiles between which a fit interpolates.
const TOLERANCE: f64 = 5e-3;
/// Profiles that a fit usually needs.
const USUAL_PROFILES: u64 = 29;

/// Fits with gamma to profiles that are solved as they are needed.
fn fit_with_gamma(
    eta: f64,
    samples: &[Sample],
    errors: Errors,
) -> Result<Result<MediumFit, ParameterError>, Failure> {
    let evaluations = Evaluations::new(USUAL_PROFILES);
    let fault = Cell::new(None);
    let node = |alpha: f64, gamma: f64| -> Box<dyn Fn(f64) -> Estimate> {
        match evaluations.count(Ok(None), || profile(alpha, gamma, eta)) {
            Ok(Some(profile)) => Box::new(move |r| {
                let found = profile.reflectance(r);
                Estimate { value: found.value, error: found.error }
            }),
            other => {
                fault.set(fault.take().or(other.err()));
                Box::new(|_| Estimate { value: 0.0, error: 0.0 })
            }
        }
    };
    let fit = evaluations.finish(MediumFit::with_gamma(samples, errors, &MediumGrid::new(&node)))?;
    fault.take().map_or(Ok(fit), |error| Err(Failure::work(error.to_string())))
}

/// The half space of a reduced single-scattering albedo and gamma, in transport mean free paths.
fn layers(alpha: f64, gamma: f64, eta: f64) -> Result<Layers, LayersError> {
    let phase_function =
        PhaseFunction::TwoTerm { weight: MediumGrid::weight(gamma), g1: MediumGrid::PEAK, g2: 0.0 };
    let scattering = alpha / (1.0 - phase_function.mean_cosine());
    let layer = Layer::new(scattering, 1.0 - alpha, f64::INFINITY).with_phase_function(phase_function);
    Layers::new(1.0, vec![layer.with_eta(eta)], Ground::None)
}

fn profile(alpha: f64, gamma: f64, eta: f64) -> Result<Option<LayersProfile>, LayersError> {
    layers(alpha, gamma, eta)?.profile_within(TOLERANCE, &Control::default())
}

/// Warning that gamma is open, or outside of what is solved.
fn warning(fit: &MediumFit) -> Option<String> {
    let Estimate { value, error } = fit.gamma()?;
    let [low, high] = MediumGrid::GAMMA;
    if !fit.gamma_is_determined() {
        let of_error =
            if error.is_finite() { format!(": its standard error is {error:.2}") } else { String::new() };
        return Some(format!("gamma is not determined by these radii{of_error}"));
    }
    let far = (2.0 * error).max(0.03);
    let is_inside = (low - far..=high + far).contains(&value);
    (!is_inside).then(|| format!("gamma is outside [{low}, {high}], where profiles are solved"))
}

/// Count of the reflectances or profiles that a fit has asked for, which take nearly all of its time.
///
/// Once the fit is to stop all reflectances are 0, and it ends at once.
struct Evaluations {
    meter: Meter,
    done: AtomicU64,
    /// Number of them that such a fit usually asks for.
    usual: u64,
}

impl Evaluations {
    fn new(usual: u64) -> Self {
        Self { meter: Meter::new(Unit::Parts), done: AtomicU64::new(0), usual }
    }

    /// The value of one more, or another once the fit is to stop.
    fn count<T>(&self, stopped: T, value: impl FnOnce() -> T) -> T {
        if self.are_stopped() {
            return stopped;
        }
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        // A fit that takes longer is never quite done before its end
        self.meter.update(done, self.usual.max(done + done / 20));
        value()
    }

    /// The end of a fit, unless it was stopped.
    fn finish<T>(&self, fit: T) -> Result<T, Failure> {
        self.meter.finish();
        if self.are_stopped() {
            return Err(Failure::interrupted("nothing was written: repeat the command"));
        }
        Ok(fit)
    }

    fn are_stopped(&self) -> bool {
        interrupt::STOP.load(Ordering::Relaxed)
    }
}
