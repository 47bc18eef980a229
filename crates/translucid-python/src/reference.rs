//! `translucid.reference`: the exact half space.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use rayon::iter::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};
use translucid_profile::ParameterError;
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace, single_scattering_albedo};
use translucid_reference::{Estimate, Incidence};

use crate::arrays::{Any, Numbers, Rule, array_like, broadcast_shape};
use crate::profile::number_or;
use crate::{long_work, names};

const RADII: Rule<'_> = Rule::new("r", "at least 0", 0.0, f64::INFINITY);
const MFP: Rule<'_> = Rule::new("mfp", "in [1e-100, 1e100]", 1e-100, 1e100);
const AZIMUTH: Rule<'_> = Rule::new("azimuth", "finite", f64::MIN, f64::MAX);
const ANGLE: Rule<'_> = Rule::new("incidence_angle", "in [0, 90)", 0.0, 90.0_f64.next_down());
const THREADS: std::ops::RangeInclusive<usize> = 1..=1024;

/// Value and error, each an array.
pub(crate) type Pair<'py> = (Any<'py>, Any<'py>);

/// How light enters, from the words of a call.
pub(crate) fn incidence(
    configuration: Option<&str>,
    incidence_angle: Option<&Any<'_>>,
    eta: f64,
) -> PyResult<Incidence> {
    let configuration = configuration.map(names::configuration).transpose()?;
    let Some(angle) = incidence_angle else {
        return Ok(configuration.map_or(Incidence::Cosine, Incidence::from));
    };
    if configuration == Some(translucid_profile::Configuration::Diffuse) {
        return Err(PyValueError::new_err(
            "incidence_angle belongs to a beam, but configuration is \"diffuse\"",
        ));
    }
    let degrees = Numbers::extract("incidence_angle", angle)?.single(&ANGLE)?;
    let cos_theta = degrees.to_radians().cos();
    if eta < 1.0 && (eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta <= 0.0 {
        let limit = eta.asin().to_degrees();
        return Err(PyValueError::new_err(format!(
            "incidence_angle is {degrees}, but must be below asin(eta) = {limit:.4}: no light enters beyond"
        )));
    }
    Ok(Incidence::Pencil { cos_theta })
}

/// The threads that a call may use.
pub(crate) fn pool(threads: Option<usize>) -> PyResult<rayon::ThreadPool> {
    if let Some(threads) = threads.filter(|threads| !THREADS.contains(threads)) {
        return Err(PyValueError::new_err(format!("threads is {threads}, but must be in [1, 1024]")));
    }
    rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build().map_err(|error| {
        pyo3::exceptions::PyRuntimeError::new_err(format!("cannot start the threads: {error}"))
    })
}

/// Works with the callback that a `progress` argument asks for: a function, a bar, or nothing.
pub(crate) fn with_progress<'py, T>(
    py: Python<'py>,
    progress: Option<&Any<'py>>,
    description: &str,
    unit: &str,
    work: impl FnOnce(Option<&Any<'py>>) -> PyResult<T>,
) -> PyResult<T> {
    let Some(progress) = progress else { return work(None) };
    let manager =
        py.import("translucid._progress")?.call_method1("reporter", (progress, description, unit))?;
    let callback = manager.call_method0("__enter__")?;
    let result = work(Some(&callback).filter(|callback| !callback.is_none()));
    manager.call_method1("__exit__", (py.None(), py.None(), py.None()))?;
    result
}

/// Calls back with how much of the work is done, if anybody wants to know.
pub(crate) fn report(progress: Option<&Any<'_>>, done: u64, total: u64) -> PyResult<()> {
    progress.map_or(Ok(()), |progress| progress.call1((done, total)).map(drop))
}

/// One of two albedos, by the name it was given.
pub(crate) fn albedo<'py>(
    surface_albedo: Option<&Any<'py>>,
    single_scattering_albedo: Option<&Any<'py>>,
) -> PyResult<(Rule<'static>, Numbers<'py>)> {
    let (rule, object) = match (surface_albedo, single_scattering_albedo) {
        (Some(object), None) => (Rule::new("surface_albedo", "in (0, 1]", f64::MIN_POSITIVE, 1.0), object),
        (None, Some(object)) => {
            (Rule::new("single_scattering_albedo", "in (0, 1]", f64::MIN_POSITIVE, 1.0), object)
        }
        _ => return Err(PyTypeError::new_err("give one of surface_albedo and single_scattering_albedo")),
    };
    let numbers = Numbers::extract(rule.name, object)?;
    numbers.require(&rule)?;
    Ok((rule, numbers))
}

/// A figure of the solution.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Asked {
    Reflectance,
    Enclosed,
    Beyond,
    Total,
}

/// The solution of one albedo and boundary.
enum Solution {
    /// Around the normal, or its mean over all directions.
    Radial(HalfSpace),
    /// Reflectance of a tilted beam, in directions.
    Directed(Box<ObliqueHalfSpace>),
}

impl Solution {
    fn new(alpha: f64, eta: f64, incidence: Incidence, is_directed: bool) -> Result<Self, ParameterError> {
        match incidence {
            Incidence::Pencil { cos_theta } if is_directed => ObliqueHalfSpace::new(alpha, eta, cos_theta)
                .map(|solution| Self::Directed(Box::new(solution))),
            _ => HalfSpace::with_boundary(alpha, eta, incidence).map(Self::Radial),
        }
    }

    /// At a radius in mean free paths and an azimuth in radians.
    fn at(&self, asked: Asked, r: f64, azimuth: f64) -> Estimate {
        match (self, asked) {
            (Self::Radial(solution), Asked::Reflectance) => solution.eval(r),
            (Self::Radial(solution), Asked::Enclosed) => solution.enclosed(r),
            (Self::Radial(solution), Asked::Beyond) => solution.beyond(r),
            (Self::Radial(solution), Asked::Total) => solution.total(),
            (Self::Directed(solution), Asked::Reflectance) => solution.eval(r, azimuth),
            (Self::Directed(solution), Asked::Enclosed) => solution.enclosed(r),
            (Self::Directed(solution), Asked::Beyond) => solution.beyond(r),
            (Self::Directed(solution), Asked::Total) => solution.total(),
        }
    }
}

/// A question with all its arguments in one shape.
struct Question {
    asked: Asked,
    r: Vec<f64>,
    mfp: Vec<f64>,
    azimuth: Vec<f64>,
    /// Place of each element's solution.
    solutions: Vec<usize>,
    /// Albedo, relative index and the first element of each solution.
    wanted: Vec<(f64, f64, usize)>,
    is_surface_albedo: bool,
    incidence: Incidence,
    is_directed: bool,
}

impl Question {
    /// Solves and evaluates on all threads of the pool, counting solutions and elements; nothing where it was stopped.
    fn answer(&self, done: &AtomicU64, stop: &AtomicBool) -> Result<Vec<Estimate>, (ParameterError, usize)> {
        let solve = |&(albedo, eta, first): &(f64, f64, usize)| {
            if stop.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let alpha = if self.is_surface_albedo {
                single_scattering_albedo(albedo, eta, self.incidence)
            } else {
                Ok(albedo)
            };
            let solution =
                alpha.and_then(|alpha| Solution::new(alpha, eta, self.incidence, self.is_directed));
            done.fetch_add(1, Ordering::Relaxed);
            solution.map(Some).map_err(|error| (error, first))
        };
        let solutions: Result<Vec<Option<Solution>>, _> = self.wanted.par_iter().map(solve).collect();
        let solutions = solutions?;
        let element = |i: usize| match &solutions[self.solutions[i]] {
            Some(solution) if !stop.load(Ordering::Relaxed) => {
                let mfp = self.mfp[i];
                let Estimate { value, error } = solution.at(self.asked, self.r[i] / mfp, self.azimuth[i]);
                done.fetch_add(1, Ordering::Relaxed);
                let unit = if self.asked == Asked::Reflectance { mfp } else { 1.0 };
                let per_area = |x: f64| (x / unit / unit).min(f64::MAX);
                Estimate { value: per_area(value), error: per_area(error) }
            }
            _ => Estimate::ZERO,
        };
        Ok((0..self.r.len()).into_par_iter().map(element).collect())
    }
}

struct Words<'a, 'py> {
    surface_albedo: Option<&'a Any<'py>>,
    single_scattering_albedo: Option<&'a Any<'py>>,
    configuration: Option<&'a str>,
    mfp: Option<&'a Any<'py>>,
    eta: Option<&'a Any<'py>>,
    incidence_angle: Option<&'a Any<'py>>,
    azimuth: Option<&'a Any<'py>>,
    threads: Option<usize>,
    progress: Option<&'a Any<'py>>,
}

fn ask<'py>(
    py: Python<'py>,
    asked: Asked,
    r: Option<&Any<'py>>,
    words: &Words<'_, 'py>,
) -> PyResult<Pair<'py>> {
    // Read the arguments
    let r = number_or("r", r, 1.0)?;
    r.require(&RADII)?;
    let (rule, albedo) = albedo(words.surface_albedo, words.single_scattering_albedo)?;
    let mfp = number_or("mfp", words.mfp, 1.0)?;
    mfp.require(&MFP)?;
    let eta = number_or("eta", words.eta, 1.0)?;
    eta.require(&Rule::new("eta", "in [0.5, 3]", 0.5, 3.0))?;
    let azimuth = number_or("azimuth", words.azimuth, 0.0)?;
    azimuth.require(&AZIMUTH)?;
    if words.azimuth.is_some() && words.incidence_angle.is_none() {
        return Err(PyTypeError::new_err("azimuth needs an incidence_angle"));
    }

    // Let all have one shape, and find the different solutions
    let arguments = [("r", &r), (rule.name, &albedo), ("mfp", &mfp), ("eta", &eta), ("azimuth", &azimuth)];
    let shape = broadcast_shape(&arguments.map(|(name, numbers)| (name, numbers.shape())))?;
    let [r_all, albedos, mfps, etas, azimuths] = arguments.map(|(_, numbers)| numbers.broadcast(&shape));
    let least_eta = etas.iter().copied().fold(3.0, f64::min);
    let incidence = incidence(words.configuration, words.incidence_angle, least_eta)?;
    let mut known = HashMap::new();
    let mut wanted = Vec::new();
    let solutions: Vec<usize> = (0..r_all.len())
        .map(|i| {
            *known.entry((albedos[i].to_bits(), etas[i].to_bits())).or_insert_with(|| {
                wanted.push((albedos[i], etas[i], i));
                wanted.len() - 1
            })
        })
        .collect();
    let question = Question {
        asked,
        r: r_all,
        mfp: mfps,
        azimuth: azimuths.iter().map(|degrees| (degrees % 360.0) / 180.0 * PI).collect(),
        solutions,
        wanted,
        is_surface_albedo: rule.name == "surface_albedo",
        incidence,
        is_directed: words.azimuth.is_some() && asked == Asked::Reflectance,
    };

    // Solve
    let total = (question.wanted.len() + question.r.len()) as u64;
    let (done, pool) = (Arc::new(AtomicU64::new(0)), pool(words.threads)?);
    let counter = Arc::clone(&done);
    let answer = with_progress(py, words.progress, "exact", "step", |progress| {
        let answer = long_work::run_or_abandon(
            py,
            move |stop| pool.install(|| question.answer(&counter, stop)),
            |_| report(progress, done.load(Ordering::Relaxed).min(total.saturating_sub(1)), total),
        )?;
        report(progress, total, total)?;
        Ok(answer)
    })?;
    let estimates = answer.map_err(|(error, element)| {
        let index = crate::profiles::index_of(element, &shape);
        names::parameter_error(&error, &index)
    })?;
    let (values, errors) = estimates.iter().map(|estimate| (estimate.value, estimate.error)).unzip();
    let numbers = arguments.map(|(_, numbers)| numbers);
    Ok((array_like(py, &numbers, &shape, values)?, array_like(py, &numbers, &shape, errors)?))
}

/// Reflectance profile of the exact half space of isotropic scatterers, with an estimate of its numerical error.
///
/// Parameters
/// ----------
/// r : array_like
///     Radii, at least 0, in the unit of `mfp`.
/// surface_albedo, single_scattering_albedo : array_like
///     Share of the light that leaves again, or share of a collision that is scattered, in (0, 1]: one of both.
/// configuration : {"diffuse", "searchlight"}, optional
///     How light enters: from all directions by default, as a beam along the normal, or with an `incidence_angle` as a
///     tilted beam.
/// mfp : array_like, default 1
///     Mean free path, in [1e-100, 1e100].
/// eta : array_like, default 1
///     Relative index of refraction, inside over outside, in [0.5, 3].
/// incidence_angle : float, optional
///     Angle of a beam outside, in degrees from the normal, in [0, 90).
/// azimuth : array_like, optional
///     Direction from the entry, in degrees from where the tilted beam points to; by default the mean over all.
/// threads : int, optional
///     Number of threads; by default one per processor.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the steps done and the steps in all, and an exception ends the call; True for a bar.
///
/// Returns
/// -------
/// value, error : float or ndarray
///     R(r) per unit of flux that has entered, and an estimate of its greatest numerical error, of the shape to which r,
///     albedo, mfp, eta and azimuth broadcast.
///
/// Raises
/// ------
/// ValueError
///     If a parameter is outside its range, a beam is totally reflected, or shapes do not broadcast.
/// TypeError
///     If not one of both albedos is given, or an argument is no number.
///
/// Notes
/// -----
/// G. B. Rybicki 1971, *J. Quant. Spectrosc. Radiat. Transfer* 11; with a boundary an integral equation over directions.
/// The error is some 1e-10 of the value without a boundary, 1e-8 with one of eta in [1.1, 2], and grows to 1e-4 towards
/// eta = 1. A solution takes milliseconds, with a boundary 0.7 s of one core.
///
/// Examples
/// --------
/// >>> value, error = translucid.reference.exact(
/// ...     [0.1, 1.0], single_scattering_albedo=0.9, configuration="searchlight")
/// >>> value
/// array([0.56107803, 0.02121765])
/// >>> bool((error < 1e-9 * value).all())
/// True
#[pyfunction]
#[pyo3(signature = (r, *, surface_albedo=None, single_scattering_albedo=None, configuration=None, mfp=None, eta=None, incidence_angle=None, azimuth=None, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn exact<'py>(
    py: Python<'py>,
    r: &Any<'py>,
    surface_albedo: Option<&Any<'py>>,
    single_scattering_albedo: Option<&Any<'py>>,
    configuration: Option<&str>,
    mfp: Option<&Any<'py>>,
    eta: Option<&Any<'py>>,
    incidence_angle: Option<&Any<'py>>,
    azimuth: Option<&Any<'py>>,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Pair<'py>> {
    let words = Words {
        surface_albedo,
        single_scattering_albedo,
        configuration,
        mfp,
        eta,
        incidence_angle,
        azimuth,
        threads,
        progress,
    };
    ask(py, Asked::Reflectance, Some(r), &words)
}

macro_rules! energy {
    ($(#[$attribute:meta])* $name:ident, $asked:expr) => {
        $(#[$attribute])*
        #[pyfunction]
        #[pyo3(signature = (r, *, surface_albedo=None, single_scattering_albedo=None, configuration=None, mfp=None, eta=None, incidence_angle=None, threads=None, progress=None))]
        #[expect(clippy::too_many_arguments, reason = "Python's keywords")]
        pub(crate) fn $name<'py>(
            py: Python<'py>,
            r: &Any<'py>,
            surface_albedo: Option<&Any<'py>>,
            single_scattering_albedo: Option<&Any<'py>>,
            configuration: Option<&str>,
            mfp: Option<&Any<'py>>,
            eta: Option<&Any<'py>>,
            incidence_angle: Option<&Any<'py>>,
            threads: Option<usize>,
            progress: Option<&Any<'py>>,
        ) -> PyResult<Pair<'py>> {
            let words = Words {
                surface_albedo,
                single_scattering_albedo,
                configuration,
                mfp,
                eta,
                incidence_angle,
                azimuth: None,
                threads,
                progress,
            };
            ask(py, $asked, Some(r), &words)
        }
    };
}

energy! {
    /// Energy of the exact half space that leaves within r, the integral of R(r') 2 pi r'.
    ///
    /// Parameters, exceptions and notes are those of `exact`, without an azimuth: energies are over all directions.
    ///
    /// Returns
    /// -------
    /// value, error : float or ndarray
    ///     A part of the unit of flux that has entered, with the digits of a small r.
    ///
    /// Examples
    /// --------
    /// >>> value, error = translucid.reference.exact_enclosed(
    /// ...     [0.1, 1.0, 5.0], surface_albedo=0.5, configuration="searchlight")
    /// >>> value.round(6)
    /// array([0.041267, 0.253274, 0.474759])
    exact_enclosed, Asked::Enclosed
}

energy! {
    /// Energy of the exact half space that leaves beyond r, with the digits of a large r.
    ///
    /// Parameters, exceptions and notes are those of `exact`, without an azimuth: energies are over all directions.
    ///
    /// Returns
    /// -------
    /// value, error : float or ndarray
    ///     A part of the unit of flux that has entered.
    exact_beyond, Asked::Beyond
}

/// Surface albedo of the exact half space: all the energy that leaves.
///
/// Parameters
/// ----------
/// single_scattering_albedo : array_like
///     Share of a collision that is scattered, in (0, 1].
/// configuration : {"diffuse", "searchlight"}, optional
///     How light enters, as in `exact`.
/// eta : array_like, default 1
///     Relative index of refraction, in [0.5, 3].
/// incidence_angle : float, optional
///     Angle of a beam outside, in degrees from the normal, in [0, 90).
///
/// Returns
/// -------
/// value, error : float or ndarray
///
/// Raises
/// ------
/// ValueError
///     If a parameter is outside its range, or shapes do not broadcast.
///
/// Examples
/// --------
/// >>> value, error = translucid.reference.exact_total([0.5, 0.9, 0.99])
/// >>> value
/// array([0.14654438, 0.47802449, 0.79456365])
#[pyfunction]
#[pyo3(signature = (single_scattering_albedo, *, configuration=None, eta=None, incidence_angle=None, threads=None, progress=None))]
pub(crate) fn exact_total<'py>(
    py: Python<'py>,
    single_scattering_albedo: &Any<'py>,
    configuration: Option<&str>,
    eta: Option<&Any<'py>>,
    incidence_angle: Option<&Any<'py>>,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Pair<'py>> {
    let words = Words {
        surface_albedo: None,
        single_scattering_albedo: Some(single_scattering_albedo),
        configuration,
        mfp: None,
        eta,
        incidence_angle,
        azimuth: None,
        threads,
        progress,
    };
    ask(py, Asked::Total, None, &words)
}
