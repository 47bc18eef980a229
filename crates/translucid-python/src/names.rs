//! Names of models, configurations and units, as the command spells them, and what of a scene has a name.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use translucid_profile::{Configuration, Model, ParameterError};
use translucid_scene::{Object, SceneError};

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
    let known = Configuration::WORDS.map(|(word, _)| word);
    Configuration::from_name(name).ok_or_else(|| unknown("configuration", name, &known))
}

/// An error of the library, and of many elements which it was.
pub(crate) fn parameter_error(error: &ParameterError, index: &[usize]) -> PyErr {
    let place = if index.is_empty() { String::new() } else { format!(" (at index {index:?})") };
    value_error(format!("{error}{place}"))
}

/// The numbers of the objects of a name, or of the mesh that several `name[…]` are of.
pub(crate) fn all_of_object(name: &str, objects: &[Object]) -> Result<Vec<usize>, SceneError> {
    let is_of_it =
        |other: &str| other.strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with('['));
    let found: Vec<usize> = (0..objects.len()).filter(|&index| is_of_it(&objects[index].name)).collect();
    if found.is_empty() {
        index_of("object", name, objects.iter().map(|object| object.name.as_str()))?;
    }
    Ok(found)
}

/// The number of a thing of a name.
pub(crate) fn index_of<'a>(
    thing: &str,
    name: &str,
    mut names: impl Iterator<Item = &'a str> + Clone,
) -> Result<usize, SceneError> {
    let all = names.clone();
    names.position(|other| other == name).ok_or_else(|| {
        let all: Vec<&str> = all.collect();
        SceneError::new(format!("there is no {thing} {name:?}"))
            .with_help(format!("there are {}", all.join(", ")))
    })
}
