//! `translucid.convert`, and `translucid.presets`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyFloat};
use translucid_laboratory::stack::{thin_wall_numbers, wall_slab_numbers};
use translucid_profile::convention::{
    self, ArgumentNames, ColorSpaces, Conversion, Converted, ConvertedNumber, CyclesMaterial, CyclesMethod,
    Role, Setting, System, Unit,
};
use translucid_profile::{InputError, ParameterError};

use crate::arrays::{Any, Numbers, array_like};
use crate::names;

/// System, parameter, channel, value, unit, what is equal, source.
type Row = (&'static str, &'static str, &'static str, f64, String, &'static str, String);
/// Rows and notes.
type Rows = (Vec<Row>, Vec<String>);

fn rows(converted: Converted) -> Rows {
    let row = |number: ConvertedNumber| {
        let ConvertedNumber { system, parameter, channel, value, unit, equal, source, .. } = number;
        (system, parameter, channel, value, unit, equal, source)
    };
    (converted.numbers.into_iter().map(row).collect(), converted.notes)
}

fn fail(error: InputError) -> PyErr {
    names::value_error(error)
}

fn unit(name: &str, text: &str) -> PyResult<Unit> {
    Unit::from_name(text).ok_or_else(|| names::unknown(name, text, &["mm", "cm", "m"]))
}

/// One number or three.
fn values(name: &str, object: &Any<'_>) -> PyResult<Vec<f64>> {
    let numbers = Numbers::extract(name, object)?;
    match numbers.shape() {
        [] | [1 | 3] => Ok(numbers.broadcast(&[numbers.shape().iter().product()])),
        shape => {
            let message = format!("{name} has the shape {shape:?}, but must be one number or three");
            Err(PyValueError::new_err(message))
        }
    }
}

fn settings(argument: &str, system: &str, parameters: &Bound<'_, PyDict>) -> PyResult<Vec<Setting>> {
    let setting = |(name, value): (Any<'_>, Any<'_>)| {
        let name: String = name.extract()?;
        let values = values(&name, &value)?;
        Setting::new(argument, system, &name, values).map_err(fail)
    };
    parameters.iter().map(setting).collect()
}

/// The rows of a conversion and its notes, for `translucid.convert`.
#[pyfunction]
#[pyo3(signature = (source, parameters, surface_albedo, unit, to_unit, to, settings, configuration, color_spaces, slab))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
#[expect(clippy::needless_pass_by_value, reason = "extracted for this call")]
pub(crate) fn _convert(
    py: Python<'_>,
    source: &str,
    parameters: &Bound<'_, PyDict>,
    surface_albedo: Option<&Any<'_>>,
    unit: &str,
    to_unit: Option<&str>,
    to: Vec<String>,
    settings: &Bound<'_, PyDict>,
    configuration: &str,
    color_spaces: Option<(String, String)>,
    slab: Option<(f64, f64, f64)>,
) -> PyResult<Rows> {
    let from = self::settings("source", source, parameters)?;
    let surface_albedo = match surface_albedo {
        Some(object) => values("surface_albedo", object)?,
        None => Vec::new(),
    };
    let mut set = Vec::new();
    for (system, parameters) in settings {
        let (system, parameters): (String, Bound<'_, PyDict>) = (system.extract()?, parameters.extract()?);
        set.extend(self::settings("settings", &system, &parameters)?);
    }
    let to: Vec<&str> = to.iter().map(String::as_str).collect();
    let unit = self::unit("unit", unit)?;
    let conversion = Conversion {
        from: &from,
        surface_albedo: &surface_albedo,
        unit,
        to_unit: to_unit.map_or(Ok(unit), |name| self::unit("to_unit", name))?,
        to: &to,
        set: &set,
        configuration: names::configuration(configuration)?,
        color_space: color_spaces.as_ref().map(|(from, to)| ColorSpaces { from, to }),
        names: ArgumentNames { from: "source", set: "settings", ..ArgumentNames::FIELDS },
    };
    let Some((thickness, g, eta)) = slab else { return Ok(rows(conversion.run().map_err(fail)?)) };
    let (channels, shares) = conversion.material().map_err(fail)?;
    let names = [("thickness", "thin"), ("g", "thin_g"), ("eta", "thin_eta")];
    let mut converted =
        py.detach(|| thin_wall_numbers(&channels, thickness, g, eta)).map_err(|e| renamed(&e, &names))?;
    converted.numbers.extend(shares);
    Ok(rows(converted))
}

/// The rows of the slab of a thin wall and its notes, for `translucid.convert.slab`.
#[pyfunction]
#[pyo3(signature = (color, balance, thickness, g, eta))]
pub(crate) fn _wall_slab(
    py: Python<'_>,
    color: &Any<'_>,
    balance: &Any<'_>,
    thickness: Option<f64>,
    g: f64,
    eta: f64,
) -> PyResult<Rows> {
    let (color, balance) = (values("color", color)?, values("balance", balance)?);
    let found = py.detach(|| wall_slab_numbers(&color, &balance, thickness, g, eta));
    Ok(rows(found.map_err(|error| renamed(&error, &[("thickness", "thin")]))?))
}

/// The error of a parameter, by the name that Python has for it.
fn renamed(error: &ParameterError, names: &[(&str, &str)]) -> PyErr {
    let found = names.iter().find(|(name, _)| *name == error.parameter);
    let name = found.map_or(error.parameter, |&(_, to)| to);
    PyValueError::new_err(error.to_string().replacen(error.parameter, name, 1))
}

/// Every system in the ways that it is told a material: name, title, versions, unit, parameters with their defaults, rule.
#[pyfunction]
pub(crate) fn _conversion_systems<'py>(py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let describe = |system: &System| {
        let described = PyDict::new(py);
        let unit = system.unit.name().unwrap_or("scene");
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
    numbers.into_iter().try_for_each(|(key, number)| keys.set_item(key, number))?;
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
        decimal(self.0.eta)
    }

    /// Perceptual roughness of the surface, by eye.
    #[getter]
    fn roughness(&self) -> f64 {
        decimal(self.0.roughness)
    }

    fn __repr__(&self) -> String {
        format!("<Preset {:?}, {}>", self.0.name, self.0.source)
    }
}

/// The number that is written like one in single precision.
fn decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or_else(|_| f64::from(x))
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
