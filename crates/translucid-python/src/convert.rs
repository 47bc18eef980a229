//! Systems of `translucid.convert`, and `translucid.presets`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyFloat};
use translucid_profile::convention::{self, CyclesMaterial, CyclesMethod, Role, System, Unit};
use translucid_profile::{InputError, ParameterError};

use crate::arrays::{Any, Numbers, array_like};
use crate::names;

fn fail(error: InputError) -> PyErr {
    names::value_error(error)
}

/// Every system in the ways that it is told a material: name, title, versions, unit, parameters with their defaults, rule.
#[pyfunction]
pub(crate) fn _conversion_systems<'py>(py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let describe = |system: &System| {
        let described = PyDict::new(py);
        let unit = system.unit.map_or("scene", Unit::name);
        let parameters = PyDict::new(py);
        for parameter in system.parameters {
            let default = match parameter.role {
                Role::Factor { default, .. } | Role::Setting { default, .. } => Some(default),
                _ => None,
            };
            parameters.set_item(parameter.name, default)?;
        }
        described.set_item("name", system.name)?;
        described.set_item("title", system.title)?;
        described.set_item("version", system.version)?;
        described.set_item("unit", unit)?;
        described.set_item("parameters", parameters)?;
        described.set_item("rule", system.formula)?;
        Ok(described)
    };
    System::ALL.iter().map(describe).collect()
}

/// The keys of a material that looks like that of a method of Cycles, the surface albedos of its media for colors, and their mean
/// free paths for a radius of 1, one where the color does not change it.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "extracted for this call")]
pub(crate) fn _cycles_material<'py>(
    py: Python<'py>,
    method: &str,
    version: Vec<u32>,
    colors: &Any<'py>,
    ior: f64,
    anisotropy: f64,
    alpha: f64,
) -> PyResult<(Bound<'py, PyDict>, Any<'py>, Any<'py>)> {
    // Numbers as Python writes them
    let wrong = |error: ParameterError| {
        let (value, requirement) = (PyFloat::new(py, error.value), error.requirement());
        PyValueError::new_err(format!("{} is {value}, but must be {requirement}", error.parameter))
    };
    let method = CyclesMethod::named(&version, method).map_err(fail)?;
    let material = CyclesMaterial::new(method, &version, ior, anisotropy, alpha).map_err(wrong)?;
    let (names, numbers) = material.keys();
    let keys = names.into_py_dict(py)?;
    for (key, number) in numbers {
        // A count
        let is_whole = key == "subsurface_flights";
        if is_whole { keys.set_item(key, number as u32)? } else { keys.set_item(key, number)? }
    }
    let colors = Numbers::extract("base_color", colors)?;
    let numbers = colors.broadcast(colors.shape());
    let (albedos, mfps) = py.detach(|| material.media(&numbers)).map_err(wrong)?;
    let shape = if mfps.len() == numbers.len() { colors.shape() } else { &[] };
    let mfps = array_like(py, &[&colors], shape, mfps)?;
    Ok((keys, array_like(py, &[&colors], colors.shape(), albedos)?, mfps))
}

/// A named translucent material: measured, with its source, or chosen by eye.
///
/// Numbers are for red, green and blue. Made by `translucid.presets`.
///
/// Notes
/// -----
/// Measured media are converted by similarity: the mean free path is 1/(sigma_a + sigma_s'), the surface albedo that of
/// the index-matched half space under diffuse light.
///
/// Examples
/// --------
/// >>> skin = translucid.presets["skin1"]
/// >>> skin.mfp.round(4), skin.eta
/// (array([1.2953, 0.9524, 0.6711]), 1.3)
/// >>> skin.source
/// 'measured: Jensen et al. 2001, figure 5'
#[pyclass(frozen, module = "translucid")]
pub(crate) struct Preset(&'static convention::Preset);

#[pymethods]
impl Preset {
    /// Name as scene files and the command write it.
    #[getter]
    fn name(&self) -> &'static str {
        self.0.name
    }

    /// Where the numbers come from.
    #[getter]
    fn source(&self) -> &'static str {
        self.0.source
    }

    /// Surface albedo, in [0, 1]; array of shape (3,).
    #[getter]
    fn surface_albedo<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        array_like(py, &[&Numbers::One(0.0)], &[3], self.0.surface_albedo().to_vec())
    }

    /// Mean free path in millimeters; array of shape (3,).
    #[getter]
    fn mfp<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        array_like(py, &[&Numbers::One(0.0)], &[3], self.0.mfp_in_millimeters().to_vec())
    }

    /// Index of refraction of the surface.
    #[getter]
    fn eta(&self) -> f64 {
        self.0.eta
    }

    /// Perceptual roughness of the surface, by eye.
    #[getter]
    fn roughness(&self) -> f64 {
        self.0.roughness
    }

    /// Weight of a clear coat, in [0, 1], by eye.
    #[getter]
    fn coat(&self) -> f64 {
        self.0.coat[0]
    }

    /// Perceptual roughness of the coat, by eye.
    #[getter]
    fn coat_roughness(&self) -> f64 {
        self.0.coat[1]
    }

    /// Kind of substance, such as stone or food.
    #[getter]
    fn group(&self) -> &'static str {
        self.0.group.name()
    }

    fn __repr__(&self) -> String {
        format!("<Preset {:?}, {}>", self.0.name, self.0.source)
    }
}

/// The preset of a name; case, spaces and hyphens do not matter.
#[pyfunction]
pub(crate) fn _preset(name: &str) -> PyResult<Preset> {
    convention::preset(name).map(Preset).map_err(fail)
}

/// Names of all presets.
#[pyfunction]
pub(crate) fn _preset_names() -> Vec<&'static str> {
    convention::presets().iter().map(|preset| preset.name).collect()
}
