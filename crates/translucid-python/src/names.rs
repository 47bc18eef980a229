//! Names of models, configurations and units, as the command spells them.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use translucid_profile::{Configuration, Model, ParameterError};

/// A parameter outside its range is a `ValueError`.
pub(crate) fn value_error(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// `ValueError` of a name that is none of those there are.
pub(crate) fn unknown(parameter: &str, name: &str, known: &[&str]) -> PyErr {
    let known = known.join(", ");
    PyValueError::new_err(format!("{parameter} is {name:?}, but must be one of {known}"))
}

pub(crate) fn model(name: &str) -> PyResult<Model> {
    Model::from_name(name).ok_or_else(|| unknown("model", name, &Model::ALL.map(Model::name)))
}

pub(crate) fn configuration(name: &str) -> PyResult<Configuration> {
    match name {
        "searchlight" => Ok(Configuration::Searchlight),
        "diffuse" => Ok(Configuration::Diffuse),
        _ => Err(unknown("configuration", name, &["searchlight", "diffuse"])),
    }
}

pub(crate) fn of_configuration(configuration: Configuration) -> &'static str {
    match configuration {
        Configuration::Searchlight => "searchlight",
        Configuration::Diffuse => "diffuse",
    }
}

/// An error of the library, and of many elements which it was.
pub(crate) fn parameter_error(error: &ParameterError, index: &[usize]) -> PyErr {
    let place = if index.is_empty() { String::new() } else { format!(" (at index {index:?})") };
    value_error(format!("{error}{place}"))
}
