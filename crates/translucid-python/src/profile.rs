//! `Profile`: reflectance profiles of one material, or of as many as arrays of parameters describe.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};
use translucid_fit::{Burley, Exponential, Family, Gaussian, Mixture};
use translucid_profile::{
    AlbedoTable, Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Quantity,
    SampledProfile, TableProfile, TabulatedProfile,
};
use translucid_scene::{ProfileRow, ProfileTable};

use crate::arrays::{Any, Numbers, Rule, array_like, broadcast_shape};
use crate::profile_pickle::{Origin, Row, table_of_rows};
use crate::profile_table::profile_table;
use crate::profiles::{Profiles, SharedProfile};
use crate::{long_work, names};

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
    profiles: Profiles,
    /// What a pickle holds.
    origin: Origin,
}

/// The rule of radii.
const RADII: Rule<'_> = Rule::new("r", "at least 0", 0.0, f64::INFINITY);
/// The rule of random numbers and shares.
const SHARES: Rule<'_> = Rule::new("u", "in [0, 1]", 0.0, 1.0);
/// A length of one of two kinds.
fn length<'py>(
    mfp: Option<&Any<'py>>,
    dmfp: Option<&Any<'py>>,
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
        surface_albedo: &Any<'_>,
        mfp: Option<&Any<'_>>,
        dmfp: Option<&Any<'_>>,
        configuration: Option<&str>,
        g: Option<&Any<'_>>,
        eta: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let model = names::model(model)?;
        let (name, length, parameterization) = length(mfp, dmfp)?;
        let configuration = configuration_or(configuration, parameterization)?;
        let surface_albedo = Numbers::extract("surface_albedo", surface_albedo)?;
        let g = number_or("g", g, 0.0)?;
        let eta = number_or("eta", eta, 1.0)?;
        let arguments = [("surface_albedo", &surface_albedo), (name, &length), ("g", &g), ("eta", &eta)];
        let profiles = Profiles::new(py, arguments, |[surface_albedo, length, g, eta]| {
            let appearance = Appearance { surface_albedo, length, parameterization, g };
            model.profile(&appearance, configuration, eta).map(SharedProfile::from).map_err(|error| {
                let is_length = matches!(error.parameter, "length" | "transport_mfp");
                ParameterError { parameter: if is_length { name } else { error.parameter }, ..error }
            })
        })?;
        let stated = stated(&profiles, &["surface_albedo", name]);
        let description =
            format!("Profile({:?}, {stated}, configuration={:?})", model.name(), configuration.name());
        Ok(Self::of_model(description, model, configuration, profiles))
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
        sigma_a: &Any<'_>,
        sigma_s: &Any<'_>,
        model: &str,
        g: Option<&Any<'_>>,
        eta: Option<&Any<'_>>,
        configuration: Option<&str>,
    ) -> PyResult<Self> {
        let model: Model = names::model(model)?;
        let configuration = configuration_or(configuration, Parameterization::Mfp)?;
        let (sigma_a, sigma_s) =
            (Numbers::extract("sigma_a", sigma_a)?, Numbers::extract("sigma_s", sigma_s)?);
        let g = number_or("g", g, 0.0)?;
        let eta = number_or("eta", eta, 1.0)?;
        let arguments = [("sigma_a", &sigma_a), ("sigma_s", &sigma_s), ("g", &g), ("eta", &eta)];
        let mut profiles = Profiles::new(class.py(), arguments, |[sigma_a, sigma_s, g, eta]| {
            let medium = Medium::new(sigma_a, sigma_s, g)?;
            model.profile_of_medium(&medium, configuration, eta).map(SharedProfile::from)
        })?;

        let stated = stated(&profiles, &["sigma_a", "sigma_s"]);
        let (name, configured) = (model.name(), configuration.name());
        let description =
            format!("Profile.from_medium({stated}, model={name:?}, configuration={configured:?})");
        // What the media amount to
        let [sigma_a, sigma_s, g] = [0, 1, 2].map(|i| profiles.parameters[i].1.iter().copied());
        let mut derived: [Vec<f64>; 3] = Default::default();
        for ((sigma_a, sigma_s), g) in sigma_a.zip(sigma_s).zip(g) {
            let medium = Medium::new(sigma_a, sigma_s, g).map_err(names::value_error)?;
            let values = [medium.surface_albedo(configuration), medium.mfp(), medium.dmfp()];
            derived.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
        }
        profiles.parameters.extend(["surface_albedo", "mfp", "dmfp"].into_iter().zip(derived));
        Ok(Self::of_model(description, model, configuration, profiles))
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
        r: &Any<'_>,
        reflectance: Option<&Any<'_>>,
        enclosed: Option<&Any<'_>>,
        surface_albedos: Option<&Any<'_>>,
        surface_albedo: Option<&Any<'_>>,
        mfp: Option<&Any<'_>>,
        dmfp: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        let table = profile_table(r, reflectance, enclosed, surface_albedos)?;
        Self::of_table(class.py(), table, surface_albedo, mfp, dmfp)
    }

    /// As `from_table`, of the rows of a pickle.
    #[classmethod]
    #[pyo3(signature = (rows, *, surface_albedo=None, mfp=None, dmfp=None))]
    fn _from_rows(
        class: &Bound<'_, PyType>,
        rows: Vec<Row<'_>>,
        surface_albedo: Option<&Any<'_>>,
        mfp: Option<&Any<'_>>,
        dmfp: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        Self::of_table(class.py(), table_of_rows(rows)?, surface_albedo, mfp, dmfp)
    }

    /// The profile of a fit, of a pickle: the energy, weights and scales of its terms.
    #[classmethod]
    fn _from_fit(
        class: &Bound<'_, PyType>,
        family: &str,
        total: f64,
        terms: Vec<(f64, f64)>,
    ) -> PyResult<Self> {
        let profile = profile_of_fit(family, total, &terms)?;
        Self::of_fit(class.py(), family, profile, terms)
    }

    /// The call that makes it again, for pickles.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Any<'py>, Bound<'py, PyTuple>)> {
        let this = slf.get();
        Ok((this.origin.call(&slf.get_type(), &this.profiles)?, PyTuple::empty(slf.py())))
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    /// Itself: nothing of it ever changes.
    fn __deepcopy__(slf: Py<Self>, _memo: &Any<'_>) -> Py<Self> {
        slf
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
    fn tabulated(slf: &Bound<'_, Self>) -> PyResult<Self> {
        let (py, this) = (slf.py(), slf.get());
        let profiles = this.profiles.different.clone();
        let tables = long_work::run_or_abandon(
            py,
            move |stop| {
                let wanted = profiles.iter().take_while(|_| !stop.load(Ordering::Relaxed));
                wanted.map(|p| Arc::new(TabulatedProfile::new(&**p)) as SharedProfile).collect()
            },
            |_| Ok(()),
        )?;
        Ok(Self {
            description: format!("{}.tabulated()", this.description),
            profiles: Profiles { different: tables, ..this.profiles.clone() },
            origin: Origin::Call(slf.getattr("tabulated")?.unbind()),
            ..*this
        })
    }

    /// Reflectance profile R(r), the light that leaves per area.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0, in the unit of the lengths.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
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
    #[pyo3(signature = (r, *, out=None))]
    fn eval<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::Eval)
    }

    /// Probability density of the radius at which light leaves, per length: 2 pi r R(r) / A.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    ///     Density of radii that `sample` draws.
    #[pyo3(signature = (r, *, out=None))]
    fn pdf<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::Pdf)
    }

    /// Probability density of the point at which light leaves, per area: R(r) / A.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    #[pyo3(signature = (r, *, out=None))]
    fn pdf_area<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::PdfArea)
    }

    /// Share of the light that leaves within r, in [0, 1].
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    #[pyo3(signature = (r, *, out=None))]
    fn cdf<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::Cdf)
    }

    /// Energy that leaves within r, which rises to the `total`.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
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
    #[pyo3(signature = (r, *, out=None))]
    fn enclosed<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::Enclosed)
    }

    /// Energy that leaves beyond r, `total - enclosed(r)` with the digits of a large r.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii, at least 0.
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
    ///
    /// Returns
    /// -------
    /// float or ndarray
    #[pyo3(signature = (r, *, out=None))]
    fn beyond<'py>(&self, py: Python<'py>, r: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &RADII, r, out, Quantity::Beyond)
    }

    /// Radius within which the share u of the light leaves: the inverse of `cdf`.
    ///
    /// Parameters
    /// ----------
    /// u : array_like
    ///     Shares, in [0, 1].
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
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
    #[pyo3(signature = (u, *, out=None))]
    fn quantile<'py>(&self, py: Python<'py>, u: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &SHARES, u, out, Quantity::Quantile)
    }

    /// Radii of density `pdf`, one for each random number.
    ///
    /// Parameters
    /// ----------
    /// u : array_like
    ///     Random numbers, uniform on [0, 1).
    /// out : ndarray, optional
    ///     Array of the result's shape and dtype to put it into.
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
    #[pyo3(signature = (u, *, out=None))]
    fn sample<'py>(&self, py: Python<'py>, u: &Any<'py>, out: Option<&Any<'py>>) -> PyResult<Any<'py>> {
        self.apply(py, &SHARES, u, out, Quantity::Sample)
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
        r: Option<&Any<'py>>,
        quantity: &str,
        ax: Option<&Any<'py>>,
        line: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Any<'py>> {
        let plot = slf.py().import("translucid._plot")?;
        plot.call_method("profile", (slf, r, quantity, ax), line)
    }

    /// Energy that leaves altogether, the surface albedo; where a model makes more than there is, greater than 1.
    #[getter]
    fn total<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        let totals: Vec<f64> =
            self.profiles.different.iter().map(|profile| profile.surface_albedo()).collect();
        let totals = self.profiles.of_elements(&totals);
        array_like(py, &[&Numbers::One(0.0)], &self.profiles.shape, totals)
    }

    /// Surface albedo that the profiles were made for; None for samples, which have a `total`.
    #[getter]
    fn surface_albedo<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        self.parameter(py, "surface_albedo")
    }

    /// Mean free path that they were made for; None if they were made for a diffuse one.
    #[getter]
    fn mfp<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        self.parameter(py, "mfp")
    }

    /// Diffuse mean free path that they were made for; None if they were made for a mean free path in the volume.
    #[getter]
    fn dmfp<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        self.parameter(py, "dmfp")
    }

    /// Mean cosine of the phase function; None for tables.
    #[getter]
    fn g<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
        self.parameter(py, "g")
    }

    /// Relative index of refraction; None for tables.
    #[getter]
    fn eta<'py>(&self, py: Python<'py>) -> PyResult<Option<Any<'py>>> {
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
        self.configuration.map(Configuration::name)
    }

    /// Shape of the arrays of parameters, broadcast against each other.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.profiles.shape)
    }

    fn __repr__(&self) -> String {
        let shape = &self.profiles.shape;
        let shape = if shape.is_empty() { String::new() } else { format!(" of shape {shape:?}") };
        format!("<{}{shape}>", self.description)
    }
}

/// Parameters with their values, or the ranges of these.
fn stated(profiles: &Profiles, names: &[&str]) -> String {
    let shown = |name: &&str| {
        let values = profiles.parameter(name).unwrap_or_default();
        let (low, high) = values
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)));
        if low < high { format!("{name}={low}…{high}") } else { format!("{name}={low}") }
    };
    names.iter().map(shown).collect::<Vec<_>>().join(", ")
}

/// Families of fits.
pub(crate) const FAMILIES: [&str; 3] = ["normalized-diffusion", "exponentials", "gaussians"];

/// The sum of a family's terms.
pub(crate) fn profile_of_fit(family: &str, total: f64, terms: &[(f64, f64)]) -> PyResult<SharedProfile> {
    fn shared<F: Family + 'static>(total: f64, terms: &[(f64, f64)]) -> PyResult<SharedProfile> {
        Ok(Arc::new(Mixture::<F>::new(total, terms).map_err(names::value_error)?))
    }
    match family {
        "exponentials" => shared::<Exponential>(total, terms),
        "gaussians" => shared::<Gaussian>(total, terms),
        "normalized-diffusion" => shared::<Burley>(total, terms),
        _ => Err(names::unknown("family", family, &FAMILIES)),
    }
}

impl Profile {
    /// One profile that somebody else made.
    pub(crate) fn of_one(description: String, profile: SharedProfile, origin: Origin) -> Self {
        let profiles = Profiles::of_one(profile);
        Self { description, model: None, configuration: None, profiles, origin }
    }

    /// The profile of a fit, with the weights and scales of its terms.
    pub(crate) fn of_fit(
        py: Python<'_>,
        family: &str,
        profile: SharedProfile,
        terms: Vec<(f64, f64)>,
    ) -> PyResult<Self> {
        let function = py.get_type::<Self>().getattr("_from_fit")?;
        let arguments = (function, family, profile.surface_albedo(), terms);
        let call = py.import("functools")?.getattr("partial")?.call1(arguments)?;
        Ok(Self::of_one(format!("fit of {family}"), profile, Origin::Call(call.unbind())))
    }

    /// The only profile.
    ///
    /// # Errors
    /// There are several.
    pub(crate) fn only(&self) -> PyResult<SharedProfile> {
        self.profiles.only()
    }

    fn of_model(description: String, model: Model, configuration: Configuration, profiles: Profiles) -> Self {
        let origin = Origin::Parameters(model, configuration);
        Self { description, model: Some(model), configuration: Some(configuration), profiles, origin }
    }

    /// Profiles of a table: of its parameters if there are any, else the table's own.
    fn of_table(
        py: Python<'_>,
        table: ProfileTable,
        surface_albedo: Option<&Any<'_>>,
        mfp: Option<&Any<'_>>,
        dmfp: Option<&Any<'_>>,
    ) -> PyResult<Self> {
        if surface_albedo.is_none()
            && mfp.is_none()
            && dmfp.is_none()
            && let [row] = &table.rows[..]
        {
            let (description, profile) = of_samples(row)?;
            return Ok(Self::of_one(description, profile, Origin::Table(table)));
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
        let shared = Arc::new(table.table().map_err(names::value_error)?);
        let description = format!("Profile.from_table(<{rows} rows>, {name}=…)");
        let arguments = [("surface_albedo", &surface_albedo), (name, &length)];
        let profiles = Profiles::new(py, arguments, |[surface_albedo, length]| {
            // Normalized diffusion takes what a table takes: any albedo in [0, 1], and any length
            let appearance =
                Appearance { surface_albedo, length, parameterization: Parameterization::Mfp, g: 0.0 };
            Model::NormalizedDiffusion.profile(&appearance, Configuration::default(), 1.0).map_err(
                |error| {
                    let is_length = error.parameter != "surface_albedo";
                    ParameterError { parameter: if is_length { name } else { error.parameter }, ..error }
                },
            )?;
            let profile: TableProfile = AlbedoTable::profile_of_shared(&shared, surface_albedo, length);
            Ok(Arc::new(profile))
        })?;
        Ok(Self { description, model: None, configuration: None, profiles, origin: Origin::Table(table) })
    }

    fn parameter<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Option<Any<'py>>> {
        let Some(values) = self.profiles.parameter(name) else { return Ok(None) };
        let values = self.profiles.of_elements(values);
        array_like(py, &[&Numbers::One(0.0)], &self.profiles.shape, values).map(Some)
    }

    fn apply<'py>(
        &self,
        py: Python<'py>,
        rule: &Rule<'_>,
        x: &Any<'py>,
        out: Option<&Any<'py>>,
        quantity: Quantity,
    ) -> PyResult<Any<'py>> {
        let x = Numbers::extract(rule.name, x)?;
        let Profiles { shape: own, elements, different, .. } = &self.profiles;
        if own.is_empty() {
            return x.map(py, rule, out, |from, to| different[0].apply(quantity, from, to));
        }
        let shape = broadcast_shape(&[("profile", own), (rule.name, x.shape())])?;
        let elements = numpy::ndarray::ArrayViewD::from_shape(&own[..], elements);
        let elements = elements.map_err(names::value_error)?;
        x.map_indexed(py, rule, out, &shape, &elements, |element, from, to| {
            different[element as usize].apply(quantity, from, to);
        })
    }
}

/// The profile through samples, and how it is described.
fn of_samples(row: &ProfileRow) -> PyResult<(String, SharedProfile)> {
    let profile = if row.enclosed.is_empty() {
        SampledProfile::new(&row.radii, &row.reflectances)
    } else {
        SampledProfile::from_samples_and_enclosed(&row.radii, &row.reflectances, &row.enclosed)
    };
    let description = format!("Profile.from_table(<{} samples>)", row.radii.len());
    Ok((description, Arc::new(profile.map_err(names::value_error)?)))
}

/// The configuration of a name; without one that for which the parameterization was fitted first.
fn configuration_or(name: Option<&str>, parameterization: Parameterization) -> PyResult<Configuration> {
    name.map_or(Ok(parameterization.usual_configuration()), names::configuration)
}

pub(crate) fn number_or<'py>(name: &str, given: Option<&Any<'py>>, default: f64) -> PyResult<Numbers<'py>> {
    given.map_or(Ok(Numbers::One(default)), |given| Numbers::extract(name, given))
}
