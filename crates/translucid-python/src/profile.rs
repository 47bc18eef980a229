//! `Profile`: reflectance profiles of one material, or of as many as arrays of parameters describe.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyType;
use translucid_profile::{
    Appearance, Configuration, Medium, Model, ParameterError, Parameterization, Quantity, SampledProfile,
    TabulatedProfile,
};

use crate::arrays::{Numbers, array_like, broadcast_shape};
use crate::names;

type SharedProfile = Arc<dyn translucid_profile::Profile>;

/// Reflectance profiles: the light that leaves around the point where it entered.
#[pyclass(frozen, module = "translucid", weakref)]
pub(crate) struct Profile {
    /// As the call that made it would be written.
    description: String,
    shape: Vec<usize>,
    /// Each element's place among the different profiles, in C order.
    elements: Vec<u32>,
    profiles: Vec<SharedProfile>,
}

/// The rule of radii.
fn require_radii(r: &Numbers<'_>) -> PyResult<()> {
    r.require("r", "at least 0", |r| r >= 0.0)
}

/// The rule of random numbers and shares.
fn require_shares(u: &Numbers<'_>) -> PyResult<()> {
    u.require("u", "in [0, 1]", |u| (0.0..=1.0).contains(&u))
}

/// Makes the profiles of all elements, of equal elements one.
fn make<const N: usize>(
    description: String,
    arguments: [(&str, &Numbers<'_>); N],
    make_one: impl Fn([f64; N]) -> Result<SharedProfile, ParameterError>,
) -> PyResult<Profile> {
    let shape = broadcast_shape(&arguments.map(|(name, numbers)| (name, numbers.shape())))?;
    let columns = arguments.map(|(_, numbers)| numbers.broadcast(&shape));
    let count: usize = shape.iter().product();
    let (mut known, mut profiles) = (HashMap::new(), Vec::new());
    let mut elements = Vec::with_capacity(count);
    for element in 0..count {
        let parameters: [f64; N] = std::array::from_fn(|i| columns[i][element]);
        let number = match known.entry(parameters.map(f64::to_bits)) {
            Entry::Occupied(entry) => *entry.get(),
            Entry::Vacant(entry) => {
                let index = || index_of(element, &shape);
                profiles
                    .push(make_one(parameters).map_err(|error| names::parameter_error(&error, &index()))?);
                let too_many = |_| PyValueError::new_err("more than 4 billion different profiles");
                *entry.insert(u32::try_from(profiles.len() - 1).map_err(too_many)?)
            }
        };
        elements.push(number);
    }
    Ok(Profile { description, shape, elements, profiles })
}

/// The index of an element in C order.
fn index_of(mut element: usize, shape: &[usize]) -> Vec<usize> {
    let mut index: Vec<usize> = Vec::with_capacity(shape.len());
    for &n in shape.iter().rev() {
        index.push(element % n);
        element /= n;
    }
    index.reverse();
    index
}

#[pymethods]
impl Profile {
    #[new]
    #[pyo3(signature = (model="normalized-diffusion-refined", *, surface_albedo, mfp=None, dmfp=None, configuration=None, g=None, eta=None))]
    fn new(
        model: &str,
        surface_albedo: &Bound<'_, PyAny>,
        mfp: Option<&Bound<'_, PyAny>>,
        dmfp: Option<&Bound<'_, PyAny>>,
        configuration: Option<&str>,
        g: Option<&Bound<'_, PyAny>>,
        eta: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let model = names::model(model)?;
        let (name, length, parameterization) = match (mfp, dmfp) {
            (Some(mfp), None) => ("mfp", mfp, Parameterization::Mfp),
            (None, Some(dmfp)) => ("dmfp", dmfp, Parameterization::Dmfp),
            _ => return Err(PyTypeError::new_err("give one of mfp and dmfp")),
        };
        let configuration = configuration_or(configuration, parameterization)?;
        let surface_albedo = Numbers::extract("surface_albedo", surface_albedo)?;
        let length = Numbers::extract(name, length)?;
        let g = number_or("g", g, 0.0)?;
        let eta = number_or("eta", eta, 1.0)?;
        let description = format!(
            "Profile({:?}, {name}=…, configuration={:?})",
            model.name(),
            configuration_name(configuration)
        );
        let arguments = [("surface_albedo", &surface_albedo), (name, &length), ("g", &g), ("eta", &eta)];
        make(description, arguments, |[surface_albedo, length, g, eta]| {
            let appearance = Appearance { surface_albedo, length, parameterization, g };
            model.profile(&appearance, configuration, eta).map(SharedProfile::from).map_err(|error| {
                let is_length = matches!(error.parameter, "length" | "transport_mfp");
                ParameterError { parameter: if is_length { name } else { error.parameter }, ..error }
            })
        })
    }

    /// The profile of a medium.
    #[classmethod]
    #[pyo3(signature = (sigma_a, sigma_s, *, model="normalized-diffusion-refined", g=None, eta=None, configuration=None))]
    fn from_medium(
        _class: &Bound<'_, PyType>,
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
            configuration_name(configuration)
        );
        let arguments = [("sigma_a", &sigma_a), ("sigma_s", &sigma_s), ("g", &g), ("eta", &eta)];
        make(description, arguments, |[sigma_a, sigma_s, g, eta]| {
            let medium = Medium::new(sigma_a, sigma_s, g)?;
            model.profile_of_medium(&medium, configuration, eta).map(SharedProfile::from)
        })
    }

    /// The profile of samples.
    #[classmethod]
    fn from_table(
        _class: &Bound<'_, PyType>,
        r: &Bound<'_, PyAny>,
        reflectance: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let (r, reflectance) = (Numbers::extract("r", r)?, Numbers::extract("reflectance", reflectance)?);
        for (name, numbers) in [("r", &r), ("reflectance", &reflectance)] {
            if numbers.shape().len() != 1 {
                let shape = numbers.shape();
                return Err(PyValueError::new_err(format!(
                    "{name} must have one dimension, but has the shape {shape:?}"
                )));
            }
        }
        let (radii, reflectances) = (r.broadcast(r.shape()), reflectance.broadcast(reflectance.shape()));
        if radii.len() != reflectances.len() {
            let (radii, reflectances) = (radii.len(), reflectances.len());
            let message =
                format!("r has {radii} numbers, reflectance {reflectances}: there must be as many of both");
            return Err(PyValueError::new_err(message));
        }
        let profile = SampledProfile::new(&radii, &reflectances).map_err(names::value_error)?;
        let description = format!("Profile.from_table(<{} samples>)", radii.len());
        Ok(Self { description, shape: Vec::new(), elements: vec![0], profiles: vec![Arc::new(profile)] })
    }

    /// The profiles as tables.
    fn tabulated(&self) -> Self {
        let table =
            |profile: &SharedProfile| -> SharedProfile { Arc::new(TabulatedProfile::new(&**profile)) };
        let description = format!("{}.tabulated()", self.description);
        let (shape, elements) = (self.shape.clone(), self.elements.clone());
        Self { description, shape, elements, profiles: self.profiles.iter().map(table).collect() }
    }

    fn eval<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::Eval)
    }

    fn pdf<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::Pdf)
    }

    fn pdf_area<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::PdfArea)
    }

    fn cdf<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::Cdf)
    }

    fn enclosed<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::Enclosed)
    }

    fn beyond<'py>(&self, py: Python<'py>, r: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_radii(py, r, Quantity::Beyond)
    }

    fn quantile<'py>(&self, py: Python<'py>, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_shares(py, u, Quantity::Quantile)
    }

    fn sample<'py>(&self, py: Python<'py>, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.of_shares(py, u, Quantity::Sample)
    }

    #[getter]
    fn total<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let totals = self.elements.iter().map(|&i| self.profiles[i as usize].surface_albedo()).collect();
        array_like(py, &[&Numbers::One(0.0)], &self.shape, totals)
    }

    #[getter]
    fn shape(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(pyo3::types::PyTuple::new(py, &self.shape)?.into_any().unbind())
    }

    fn __repr__(&self) -> String {
        let shape = if self.shape.is_empty() { String::new() } else { format!(" of shape {:?}", self.shape) };
        format!("<{}{shape}>", self.description)
    }
}

impl Profile {
    fn of_radii<'py>(
        &self,
        py: Python<'py>,
        r: &Bound<'py, PyAny>,
        quantity: Quantity,
    ) -> PyResult<Bound<'py, PyAny>> {
        let r = Numbers::extract("r", r)?;
        require_radii(&r)?;
        self.of(py, "r", &r, quantity)
    }

    fn of_shares<'py>(
        &self,
        py: Python<'py>,
        u: &Bound<'py, PyAny>,
        quantity: Quantity,
    ) -> PyResult<Bound<'py, PyAny>> {
        let u = Numbers::extract("u", u)?;
        require_shares(&u)?;
        self.of(py, "u", &u, quantity)
    }

    fn of<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        x: &Numbers<'py>,
        quantity: Quantity,
    ) -> PyResult<Bound<'py, PyAny>> {
        if self.shape.is_empty() {
            let profile = &self.profiles[0];
            return x.map(py, |from, to| profile.apply(quantity, from, to));
        }
        let shape = broadcast_shape(&[("profile", &self.shape), (name, x.shape())])?;
        let from = x.broadcast(&shape);
        let elements = numpy::ndarray::ArrayViewD::from_shape(&self.shape[..], &self.elements)
            .map_err(names::value_error)?;
        let elements = elements.broadcast(&shape[..]).expect("`broadcast_shape` has found that it can be");
        let to = py.detach(|| {
            let mut to = vec![0.0; from.len()];
            for ((&element, from), to) in elements.iter().zip(from.chunks(1)).zip(to.chunks_mut(1)) {
                self.profiles[element as usize].apply(quantity, from, to);
            }
            to
        });
        array_like(py, &[x], &shape, to)
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

fn configuration_name(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Searchlight => "searchlight",
        Configuration::Diffuse => "diffuse",
    }
}

fn number_or<'py>(name: &str, given: Option<&Bound<'py, PyAny>>, default: f64) -> PyResult<Numbers<'py>> {
    given.map_or(Ok(Numbers::One(default)), |given| Numbers::extract(name, given))
}
