//! `SceneError`: what is wrong with a scene, and where.

use std::path::Path;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use translucid_scene::{Place, Warning};

pyo3::create_exception!(
    translucid,
    SceneError,
    PyValueError,
    "A scene that cannot be used.\n\nAttributes\n----------\nmessage : str\n    What is wrong, with the value found and the values allowed.\npath : str or None\n    The file that is wrong, if it is one.\nline : int or None\n    Its line, counted from 1.\npart : str or None\n    The part of the scene or file: ``material skin``.\nhelp : str or None\n    Advice, if there is any.\n"
);

/// The exception of an error.
pub(crate) fn scene_error(error: translucid_scene::SceneError) -> PyErr {
    Python::attach(|py| {
        let exception = SceneError::new_err(error.to_string());
        let translucid_scene::SceneError { message, place, help } = error;
        let (value, place) = (exception.value(py), place.as_ref());
        let path = place.map(|place| place.path.display().to_string()).filter(|path| !path.is_empty());
        let set = || {
            value.setattr("message", message)?;
            value.setattr("path", path)?;
            value.setattr("line", place.and_then(|place| place.line))?;
            value.setattr("part", place.and_then(|place| place.part.clone()))?;
            value.setattr("help", help)
        };
        match set() {
            Ok(()) => exception,
            Err(failure) => failure,
        }
    })
}

/// The exception of something wrong in a part of a scene.
pub(crate) fn wrong(part: &str, message: &str) -> PyErr {
    scene_error(translucid_scene::SceneError::at(Place::part(Path::new(""), part), message))
}

/// A value that is wrong, as an error of the scene; errors of other types stay what they are.
pub(crate) fn in_scene(title: &str, error: PyErr, py: Python<'_>) -> PyErr {
    if error.is_instance_of::<PyValueError>(py) { wrong(title, &error.value(py).to_string()) } else { error }
}

/// Says what was repaired or left out, as `UserWarning`s.
pub(crate) fn warn(py: Python<'_>, warnings: &[Warning]) -> PyResult<()> {
    let category = py.get_type::<pyo3::exceptions::PyUserWarning>();
    warnings.iter().try_for_each(|warning| {
        let text = std::ffi::CString::new(warning.to_string().replace('\0', "?"))?;
        PyErr::warn(py, &category, &text, 1)
    })
}
