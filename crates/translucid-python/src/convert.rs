//! Systems of `translucid.convert`, and `translucid.presets`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use translucid_profile::convention::{self, CyclesWalk, Role, SurfaceAlbedo, System};
use translucid_profile::{Configuration, InputError, ParameterError};

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

/// Surface albedos of the media that Cycles' random walks make of colors, those before Blender 5.2 if `is_legacy`, and transport
/// mean free paths of the skin mode for a radius of 1, in order.
#[pyfunction]
#[expect(clippy::needless_pass_by_value, reason = "extracted for this call")]
pub(crate) fn _cycles_walks(
    py: Python<'_>,
    colors: Vec<f64>,
    g: f64,
    skin_ior: f64,
    is_legacy: bool,
) -> PyResult<(Vec<f64>, Vec<f64>)> {
    py.detach(|| {
        let walk = if is_legacy { CyclesWalk::legacy(g) } else { CyclesWalk::new(g) };
        let skin = System::named("cycles-skin").next();
        let mfp = |&color: &f64| {
            let Some(skin) = skin else { return Ok(1.0) };
            let albedo = SurfaceAlbedo::gray(color)?;
            Ok(skin.read(&[1.0, 1.0, skin_ior], albedo, Configuration::Diffuse)?.mfp())
        };
        let lengths: Result<Vec<f64>, ParameterError> = colors.iter().map(mfp).collect();
        Ok((colors.iter().map(|&color| walk.surface_albedo_of_medium(color)).collect(), lengths?))
    })
    .map_err(|error: ParameterError| PyValueError::new_err(error.to_string()))
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
