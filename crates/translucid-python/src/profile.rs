//! `Profile`: reflectance profiles of one material, or of as many as arrays of parameters describe.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use translucid_profile::{
    AlbedoTable, Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Quantity,
    SampledProfile, TableProfile, TabulatedProfile,
};
use translucid_scene::ProfileRow;

use crate::arrays::{Numbers, Rule, array_like, broadcast_shape};
use crate::profile_table::profile_table;
use crate::{long_work, names};

pub(crate) type SharedProfile = Arc<dyn translucid_profile::Profile>;

/// Reflectance profiles R(r) of translucent materials.
///
/// R(r) is the light that leaves a flat surface at the distance r from the point where one unit of flux entered, per
/// area.
/// Parameters are numbers, or arrays that broadcast against each other: an image of albedos makes an image of profiles.
///
/// Parameters
/// ----------
/// model : str, default "normalized-diffusion-refined"
///     One of `translucid.models`.
/// surface_albedo : array_like
///     Surface albedo A, the share of the light that leaves again, in [0, 1].
/// mfp, dmfp : array_like
///     Mean free path in the volume, or diffuse mean free path on the surface, greater than 0: one of both, in any unit of
///     length. Radii are in the same unit.
/// configuration : {"searchlight", "diffuse"}, optional
///     How light enters: as a pencil beam along the normal, or at a point from all directions ("diffuse transmission").
///     By default "diffuse" with an `mfp` and "searchlight" with a `dmfp`, the fits that renderers use.
/// g : array_like, default 0
///     Mean cosine of the phase function, in (-1, 1); models without one take 0 only.
/// eta : array_like, default 1
///     Relative index of refraction, inside over outside; models without a boundary take 1 only.
///
/// Raises
/// ------
/// ValueError
///     If a parameter is outside its range, the model cannot reach the albedo, or shapes do not broadcast. The message
///     says which parameter of which element, its value and what is allowed.
/// TypeError
///     If not one of `mfp` and `dmfp` is given, or an argument is no number.
///
/// Notes
/// -----
/// Energies count light that has entered the medium; what the boundary reflects from outside is not part of it.
/// All methods return finite numbers: R, which grows like 1/r, is the greatest finite number at r = 0.
/// Methods take numbers and arrays of any shape and stride, which broadcast against the profile's own shape, in single
/// or double precision, and return the same precision; they compute in double precision.
/// Models: P. H. Christensen and B. Burley, *Approximate Reflectance Profiles for Efficient Subsurface Scattering*, 2015,
/// and those it compares with.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import translucid
/// >>> jade = translucid.Profile(surface_albedo=0.6, mfp=1.5)
/// >>> jade.eval(np.array([0.5, 1.0, 2.0])).round(5)
/// array([0.06838, 0.02588, 0.00802])
/// >>> round(jade.cdf(jade.quantile(0.5)), 12)
/// 0.5
///
/// An image of albedos, with a mean free path for each channel:
///
/// >>> albedos = np.random.default_rng(1).uniform(0.1, 0.9, (2, 4, 3))
/// >>> skin = translucid.Profile(surface_albedo=albedos, mfp=[2.0, 1.0, 0.5])
/// >>> skin.eval(1.0).shape
/// (2, 4, 3)
#[pyclass(frozen, module = "translucid", weakref)]
pub(crate) struct Profile {
    /// As the call that made it would be written.
    description: String,
    model: Option<Model>,
    configuration: Option<Configuration>,
    /// Names and values of what the profiles were made from.
    parameters: Vec<(&'static str, Vec<f64>)>,
    shape: Vec<usize>,
    /// Each element's place among the different profiles, in C order.
    elements: Vec<u32>,
    profiles: Vec<SharedProfile>,
}

/// The rule of radii.
const RADII: Rule<'_> = Rule::new("r", "at least 0", 0.0, f64::INFINITY);
/// The rule of random numbers and shares.
const SHARES: Rule<'_> = Rule::new("u", "in [0, 1]", 0.0, 1.0);
/// Elements whose profiles are made on a thread of their own, for Ctrl-C.
const MANY: usize = 64;

/// Profiles of many elements, of equal elements one.
struct Many {
    elements: Vec<u32>,
    profiles: Vec<SharedProfile>,
    /// Element that each profile was made for.
    firsts: Vec<usize>,
}

/// Makes the profiles of all elements.
fn make<const N: usize>(
    py: Python<'_>,
    description: String,
    arguments: [(&'static str, &Numbers<'_>); N],
    make_one: impl Fn([f64; N]) -> Result<SharedProfile, ParameterError> + Send + Sync,
) -> PyResult<Profile> {
    let shape = broadcast_shape(&arguments.map(|(name, numbers)| (name, numbers.shape())))?;
    let columns = arguments.map(|(_, numbers)| numbers.broadcast(&shape));
    let count: usize = shape.iter().product();
    let row = |element: usize| -> [f64; N] { std::array::from_fn(|i| columns[i][element]) };
    let make_all = |stop: &AtomicBool| {
        let mut many = Many { elements: Vec::with_capacity(count), profiles: Vec::new(), firsts: Vec::new() };
        let mut known = HashMap::new();
        for element in 0..count {
            if stop.load(Ordering::Relaxed) {
                break;
            }
            let number = match known.entry(row(element).map(f64::to_bits)) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    many.profiles.push(make_one(row(element)).map_err(|error| (error, element))?);
                    many.firsts.push(element);
                    *entry.insert(many.profiles.len() as u32 - 1)
                }
            };
            many.elements.push(number);
        }
        Ok(many)
    };
    if u32::try_from(count).is_err() {
        return Err(PyValueError::new_err(format!("shape {shape:?} has more than 4 billion elements")));
    }
    let made = if count < MANY {
        make_all(&AtomicBool::new(false))
    } else {
        long_work::run(py, make_all, |_| Ok(()))?
    };
    let Many { elements, profiles, firsts } =
        made.map_err(|(error, element)| names::parameter_error(&error, &index_of(element, &shape)))?;
    let parameters = arguments.iter().enumerate();
    let parameters =
        parameters.map(|(i, (name, _))| (*name, firsts.iter().map(|&e| columns[i][e]).collect()));
    let parameters = parameters.collect();
    Ok(Profile { description, model: None, configuration: None, parameters, shape, elements, profiles })
}

/// The index of an element in C order.
pub(crate) fn index_of(mut element: usize, shape: &[usize]) -> Vec<usize> {
    let mut index: Vec<usize> = Vec::with_capacity(shape.len());
    for &n in shape.iter().rev() {
        index.push(element % n);
        element /= n;
    }
    index.reverse();
    index
}

/// A length of one of two kinds.
fn length<'py>(
    mfp: Option<&Bound<'py, PyAny>>,
    dmfp: Option<&Bound<'py, PyAny>>,
) -> PyResult<(&'static str, Numbers<'py>, Parameterization)> {
    match (mfp, dmfp) {
        (Some(mfp), None) => Ok(("mfp", Numbers::extract("mfp", mfp)?, Parameterization::Mfp)),
        (None, Some(dmfp)) => Ok(("dmfp", Numbers::extract("dmfp", dmfp)?, Parameterization::Dmfp)),
        _ => Err(PyTypeError::new_err("give one of mfp and dmfp")),
    }
}

#[pymethods]
impl Profile {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "Python's keywords")]
    #[pyo3(signature = (model="normalized-diffusion-refined", *, surface_albedo, mfp=None, dmfp=None, configuration=None, g=None, eta=None))]
    fn new(
        py: Python<'_>,
        model: &str,
        surface_albedo: &Bound<'_, PyAny>,
        mfp: Option<&Bound<'_, PyAny>>,
        dmfp: Option<&Bound<'_, PyAny>>,
        configuration: Option<&str>,
        g: Option<&Bound<'_, PyAny>>,
        eta: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let model = names::model(model)?;
        let (name, length, parameterization) = length(mfp, dmfp)?;
        let configuration = configuration_or(configuration, parameterization)?;
        let surface_albedo = Numbers::extract("surface_albedo", surface_albedo)?;
        let g = number_or("g", g, 0.0)?;
        let eta = number_or("eta", eta, 1.0)?;
        let description = format!(
            "Profile({:?}, {name}=…, configuration={:?})",
            model.name(),
            names::of_configuration(configuration)
        );
        let arguments = [("surface_albedo", &surface_albedo), (name, &length), ("g", &g), ("eta", &eta)];
        let made = make(py, description, arguments, |[surface_albedo, length, g, eta]| {
            let appearance = Appearance { surface_albedo, length, parameterization, g };
            model.profile(&appearance, configuration, eta).map(SharedProfile::from).map_err(|error| {
                let is_length = matches!(error.parameter, "length" | "transport_mfp");
                ParameterError { parameter: if is_length { name } else { error.parameter }, ..error }
            })
        })?;
        Ok(Self { model: Some(model), configuration: Some(configuration), ..made })
    }

    /// Profiles of media, given by their coefficients.
    ///
    /// Parameters
    /// ----------
    /// sigma_a, sigma_s : array_like
    ///     Absorption and scattering coefficient, at least 0, in the inverse of the unit of radii.
    /// model : str, default "normalized-diffusion-refined"
    ///     One of `translucid.models`.
    /// g : array_like, default 0
    ///     Mean cosine of the phase function, in (-1, 1). Models that know isotropic scattering only get the similar
    ///     isotropic medium, of (1 - g) sigma_s.
    /// eta : array_like, default 1
    ///     Relative index of refraction, inside over outside; models without a boundary take 1 only.
    /// configuration : {"searchlight", "diffuse"}, default "diffuse"
    ///     How light enters.
    ///
    /// Returns
    /// -------
    /// Profile
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a parameter is outside its range or shapes do not broadcast.
    ///
    /// Examples
    /// --------
    /// Marble, by H. W. Jensen et al. 2001, in millimeters:
    ///
    /// >>> marble = translucid.Profile.from_medium([0.0021, 0.0041, 0.0071], [2.19, 2.62, 3.00])
    /// >>> marble.total.round(3)
    /// array([0.931, 0.913, 0.894])
    #[classmethod]
    #[pyo3(signature = (sigma_a, sigma_s, *, model="normalized-diffusion-refined", g=None, eta=None, configuration=None))]
    fn from_medium(
        class: &Bound<'_, PyType>,
        sigma_a: &Bound<'_, PyAny>,
        sigma_s: &Bound<'_, PyAny>,
        model: &str,
        g: Option<&Bound<'_, PyAny>>,
        eta: Option<&Bound<'_, PyAny>>,
        configuration: Option<&str>,
    ) -> PyResult<Self> {
        let model: Model = names::model(model)?;
        let configuration = configuration_or(configuration, Parameterization::Mfp)?;
        let (sigma_a, sigma_s) =
            (Numbers::extract("sigma_a", sigma_a)?, Numbers::extract("sigma_s", sigma_s)?);
        let g = number_or("g", g, 0.0)?;
        let eta = number_or("eta", eta, 1.0)?;
        let description = format!(
            "Profile.from_medium(…, model={:?}, configuration={:?})",
            model.name(),
            names::of_configuration(configuration)
        );
        let arguments = [("sigma_a", &sigma_a), ("sigma_s", &sigma_s), ("g", &g), ("eta", &eta)];
        let made = make(class.py(), description, arguments, |[sigma_a, sigma_s, g, eta]| {
            let medium = Medium::new(sigma_a, sigma_s, g)?;
            model.profile_of_medium(&medium, configuration, eta).map(SharedProfile::from)
        })?;

        // What the media amount to
        let mut parameters = made.parameters;
        let [sigma_a, sigma_s, g] = [0, 1, 2].map(|i| parameters[i].1.iter().copied());
        let mut derived: [Vec<f64>; 3] = Default::default();
        for ((sigma_a, sigma_s), g) in sigma_a.zip(sigma_s).zip(g) {
            let medium = Medium::new(sigma_a, sigma_s, g).map_err(names::value_error)?;
            let values = [medium.surface_albedo(configuration), medium.mfp(), medium.dmfp()];
            derived.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        parameters.extend(["surface_albedo", "mfp", "dmfp"].into_iter().zip(derived));
        Ok(Self { model: Some(model), configuration: Some(configuration), parameters, ..made })
    }

    /// Profiles through samples that somebody measured or simulated.
    ///
    /// Parameters
    /// ----------
    /// r : array_like of shape (n,), or path
    ///     At least four radii, greater than 0, rising; or a CSV file with the columns ``r`` and ``reflectance``, optionally
    ///     ``enclosed`` and ``surface_albedo``, such as `translucid reference` prints.
    /// reflectance : array_like of shape (n,) or (k, n)
    ///     R(r), at least 0, falling towards the end; a row for each of `surface_albedos` where there are several.
    /// enclosed : array_like of the same shape, optional
    ///     Energy within the radii, if it is known; it is then kept.
    /// surface_albedos : array_like of shape (k,), optional
    ///     Surface albedos of the rows, in [0, 1], rising. Between them the profile is interpolated.
    /// surface_albedo : array_like, optional
    ///     Surface albedo of the profiles: of the table only the shape counts then. Needed where it has several rows.
    /// mfp, dmfp : array_like, optional
    ///     Length of the profiles, of which the table's radii are multiples. 1 by default.
    ///
    /// Returns
    /// -------
    /// Profile
    ///     With R behind the last radius falling exponentially.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a number is outside its range, radii or albedos do not rise, or R does not fall towards its end.
    /// TypeError
    ///     If arguments do not fit together.
    ///
    /// Examples
    /// --------
    /// >>> truth = translucid.Profile(surface_albedo=0.8, mfp=1.0)
    /// >>> r = np.geomspace(0.01, 30.0, 200)
    /// >>> measured = translucid.Profile.from_table(r, truth.eval(r))
    /// >>> round(measured.total, 4)
    /// 0.8
    ///
    /// A table for albedos, as a texture needs it:
    ///
    /// >>> albedos = np.array([0.2, 0.5, 0.8])
    /// >>> rows = translucid.Profile(surface_albedo=albedos[:, None], mfp=1.0).eval(r)
    /// >>> table = translucid.Profile.from_table(r, rows, surface_albedos=albedos, surface_albedo=[0.3, 0.6], mfp=2.0)
    /// >>> table.total
    /// array([0.3, 0.6])
    #[classmethod]
    #[pyo3(signature = (r, reflectance=None, *, enclosed=None, surface_albedos=None, surface_albedo=None, mfp=None, dmfp=None))]
    #[expect(clippy::too_many_arguments, reason = "Python's keywords")]
    fn from_table(
        class: &Bound<'_, PyType>,
        r: &Bound<'_, PyAny>,
        reflectance: Option<&Bound<'_, PyAny>>,
        enclosed: Option<&Bound<'_, PyAny>>,
        surface_albedos: Option<&Bound<'_, PyAny>>,
        surface_albedo: Option<&Bound<'_, PyAny>>,
        mfp: Option<&Bound<'_, PyAny>>,
        dmfp: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let table = profile_table(r, reflectance, enclosed, surface_albedos)?;
        if surface_albedo.is_none()
            && mfp.is_none()
            && dmfp.is_none()
            && let [row] = &table.rows[..]
        {
            return Self::of_samples(row);
        }
        let Some(surface_albedo) = surface_albedo else {
            return Err(PyTypeError::new_err("surface_albedo is missing: of a table only the shape counts"));
        };
        let surface_albedo = Numbers::extract("surface_albedo", surface_albedo)?;
        let (name, length) = match (mfp, dmfp) {
            (None, None) => ("mfp", Numbers::One(1.0)),
            _ => length(mfp, dmfp).map(|(name, length, _)| (name, length))?,
        };
        let rows = table.rows.len();
        let table = Arc::new(table.table().map_err(names::value_error)?);
        let description = format!("Profile.from_table(<{rows} rows>, {name}=…)");
        let arguments = [("surface_albedo", &surface_albedo), (name, &length)];
        make(class.py(), description, arguments, |[surface_albedo, length]| {
            // Normalized diffusion takes what a table takes: any albedo in [0, 1], and any length
            let appearance =
                Appearance { surface_albedo, length, parameterization: Parameterization::Mfp, g: 0.0 };
            Model::NormalizedDiffusion.profile(&appearance, Configuration::default(), 1.0).map_err(
                |error| {
                    let is_length = error.parameter != "surface_albedo";
                    ParameterError { parameter: if is_length { name } else { error.parameter }, ..error }
                },
            )?;
            let profile: TableProfile = AlbedoTable::profile_of_shared(&table, surface_albedo, length);
            Ok(Arc::new(profile))
        })
    }

    /// The profiles as tables, whose `cdf`, `quantile` and `sample` take some ten nanoseconds for every model.
    ///
    /// Returns
    /// -------
    /// Profile
    ///     Off by some 1e-5 of the cdf at most.
    ///
    /// Examples
    /// --------
    /// >>> dipole = translucid.Profile("dipole", surface_albedo=0.5, mfp=1.0)
    /// >>> abs(dipole.tabulated().cdf(2.0) - dipole.cdf(2.0)) < 1e-5
    /// True
    fn tabulated(&self, py: Python<'_>) -> PyResult<Self> {
        let profiles = self.profiles.clone();
        let profiles = long_work::run_or_abandon(
            py,
            move |stop| {
                let wanted = profiles.iter().take_while(|_| !stop.load(Ordering::Relaxed));
                wanted.map(|p| Arc::new(TabulatedProfile::new(&**p)) as SharedProfile).collect()
            },
            |_| Ok(()),
        )?;
        let description = format!("{}.tabulated()", self.description);
        let (shape, elements) = (self.shape.clone(), self.elements.clone());
        Ok(Self { description, shape, elements, profiles, parameters: self.parameters.clone(), ..*self })
    }

    /// Reflectance profile R(r), the light that leaves per area.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0, in the unit of the lengths.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     In the inverse square of that unit.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a radius is negative or NaN, or shapes do not broadcast.
    ///
    /// Examples
    /// --------
    /// >>> profile = translucid.Profile("exact", surface_albedo=0.5, mfp=1.0, configuration="searchlight")
    /// >>> round(profile.eval(1.0), 5)
    /// 0.02472
    fn eval<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::Eval)
    }

    /// Probability density of the radius at which light leaves, per length: 2 pi r R(r) / A.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     Density of radii that `sample` draws.
    fn pdf<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::Pdf)
    }

    /// Probability density of the point at which light leaves, per area: R(r) / A.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    fn pdf_area<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::PdfArea)
    }

    /// Share of the light that leaves within r, in [0, 1].
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    fn cdf<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::Cdf)
    }

    /// Energy that leaves within r, which rises to the `total`.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     The integral of R(r') 2 pi r' from 0 to r.
    ///
    /// Examples
    /// --------
    /// >>> profile = translucid.Profile("exact", surface_albedo=0.5, mfp=1.0, configuration="searchlight")
    /// >>> round(profile.enclosed(1.0), 4)
    /// 0.2533
    fn enclosed<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::Enclosed)
    }

    /// Energy that leaves beyond r, `total - enclosed(r)` with the digits of a large r.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    fn beyond<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &RADII, r, Quantity::Beyond)
    }

    /// Radius within which the share u of the light leaves: the inverse of `cdf`.
    ///
    /// Parameters
    /// ----------
    /// u : array_like
    ///     Shares, in [0, 1].
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     In the unit of the lengths; for u = 1 finite.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a share is outside [0, 1] or NaN, or shapes do not broadcast.
    fn quantile<'py>(&self, py: Python<'py>, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &SHARES, u, Quantity::Quantile)
    }

    /// Radii of density `pdf`, one for each random number.
    ///
    /// Parameters
    /// ----------
    /// u : array_like
    ///     Random numbers, uniform on [0, 1).
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     In the unit of the lengths. Need not rise with u, where a sum is sampled term by term.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a number is outside [0, 1] or NaN, or shapes do not broadcast.
    ///
    /// Notes
    /// -----
    /// Models without a closed form search; sample `tabulated()` where there are more than some dozens.
    ///
    /// Examples
    /// --------
    /// >>> profile = translucid.Profile(surface_albedo=0.5, mfp=1.0)
    /// >>> r = profile.sample(np.random.default_rng(7).random(100_000))
    /// >>> bool(abs(np.mean(r < profile.quantile(0.25)) - 0.25) < 0.005)
    /// True
    fn sample<'py>(&self, py: Python<'py>, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.apply(py, &SHARES, u, Quantity::Sample)
    }

    /// Draws the profiles over the radius, with matplotlib.
    ///
    /// Parameters
    /// ----------
    /// r : array_like of shape (n,), optional
    ///     Radii; by default as far as 99.9 % of the light.
    /// quantity : {"eval", "pdf", "pdf_area", "cdf", "enclosed", "beyond"}, default "eval"
    ///     What to draw.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; by default into a new figure.
    /// **line
    ///     Passed on to `Axes.plot`.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (r=None, *, quantity="eval", ax=None, **line))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        r: Option<&Bound<'py, PyAny>>,
        quantity: &str,
        ax: Option<&Bound<'py, PyAny>>,
        line: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plot = slf.py().import("translucid._plot")?;
        plot.call_method("profile", (slf, r, quantity, ax), line)
    }

    /// Energy that leaves altogether, the surface albedo; where a model makes more than there is, greater than 1.
    #[getter]
    fn total<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let totals = self.elements.iter().map(|&i| self.profiles[i as usize].surface_albedo()).collect();
        array_like(py, &[&Numbers::One(0.0)], &self.shape, totals)
    }

    /// Surface albedo that the profiles were made for; None for samples, which have a `total`.
    #[getter]
    fn surface_albedo<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.parameter(py, "surface_albedo")
    }

    /// Mean free path that they were made for; None if they were made for a diffuse one.
    #[getter]
    fn mfp<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.parameter(py, "mfp")
    }

    /// Diffuse mean free path that they were made for; None if they were made for a mean free path in the volume.
    #[getter]
    fn dmfp<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.parameter(py, "dmfp")
    }

    /// Mean cosine of the phase function; None for tables.
    #[getter]
    fn g<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.parameter(py, "g")
    }

    /// Relative index of refraction; None for tables.
    #[getter]
    fn eta<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.parameter(py, "eta")
    }

    /// Name of the model; None for tables.
    #[getter]
    fn model(&self) -> Option<&'static str> {
        self.model.map(Model::name)
    }

    /// How light enters; None for tables.
    #[getter]
    fn configuration(&self) -> Option<&'static str> {
        self.configuration.map(names::of_configuration)
    }

    /// Shape of the arrays of parameters, broadcast against each other.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.shape)
    }

    fn __repr__(&self) -> String {
        let shape = if self.shape.is_empty() { String::new() } else { format!(" of shape {:?}", self.shape) };
        format!("<{}{shape}>", self.description)
    }
}

impl Profile {
    /// One profile that somebody else made.
    pub(crate) fn of_one(description: String, profile: SharedProfile) -> Self {
        Self {
            description,
            model: None,
            configuration: None,
            parameters: Vec::new(),
            shape: Vec::new(),
            elements: vec![0],
            profiles: vec![profile],
        }
    }

    /// The only profile.
    ///
    /// # Errors
    /// There are several.
    pub(crate) fn only(&self) -> PyResult<SharedProfile> {
        match &self.elements[..] {
            [element] => Ok(Arc::clone(&self.profiles[*element as usize])),
            _ => {
                let shape = &self.shape;
                Err(PyValueError::new_err(format!(
                    "the profile has the shape {shape:?}, but must be a single one"
                )))
            }
        }
    }

    fn of_samples(row: &ProfileRow) -> PyResult<Self> {
        let profile = if row.enclosed.is_empty() {
            SampledProfile::new(&row.radii, &row.reflectances)
        } else {
            SampledProfile::from_samples_and_enclosed(&row.radii, &row.reflectances, &row.enclosed)
        };
        let description = format!("Profile.from_table(<{} samples>)", row.radii.len());
        Ok(Self::of_one(description, Arc::new(profile.map_err(names::value_error)?)))
    }

    fn parameter<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some((_, values)) = self.parameters.iter().find(|(known, _)| *known == name) else {
            return Ok(None);
        };
        let values = self.elements.iter().map(|&i| values[i as usize]).collect();
        array_like(py, &[&Numbers::One(0.0)], &self.shape, values).map(Some)
    }

    fn apply<'py>(
        &self,
        py: Python<'py>,
        rule: &Rule<'_>,
        x: &Bound<'py, PyAny>,
        quantity: Quantity,
    ) -> PyResult<Bound<'py, PyAny>> {
        let x = Numbers::extract(rule.name, x)?;
        if self.shape.is_empty() {
            let profile = &self.profiles[0];
            return x.map(py, rule, |from, to| profile.apply(quantity, from, to));
        }
        let shape = broadcast_shape(&[("profile", &self.shape), (rule.name, x.shape())])?;
        let elements = numpy::ndarray::ArrayViewD::from_shape(&self.shape[..], &self.elements);
        let elements = elements.map_err(names::value_error)?;
        x.map_indexed(py, rule, &shape, &elements, |element, from, to| {
            self.profiles[element as usize].apply(quantity, from, to);
        })
    }
}

/// The configuration of a name; without one that for which the parameterization was fitted first.
fn configuration_or(name: Option<&str>, parameterization: Parameterization) -> PyResult<Configuration> {
    match (name, parameterization) {
        (Some(name), _) => names::configuration(name),
        (None, Parameterization::Mfp) => Ok(Configuration::Diffuse),
        (None, Parameterization::Dmfp) => Ok(Configuration::Searchlight),
    }
}

pub(crate) fn number_or<'py>(
    name: &str,
    given: Option<&Bound<'py, PyAny>>,
    default: f64,
) -> PyResult<Numbers<'py>> {
    given.map_or(Ok(Numbers::One(default)), |given| Numbers::extract(name, given))
}
