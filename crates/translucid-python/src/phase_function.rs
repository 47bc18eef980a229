//! Phase functions as arguments: words, or arrays of cosines and values.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use translucid_reference::walk::{PhaseFunction, PhaseTable};
use translucid_scene::Warning;

use crate::arrays::{Any, Numbers, array_like};
use crate::names;
use crate::scene_error::warn;

/// The phase function of an argument: words that the command knows, too, or rows of a cosine and a value.
pub(crate) fn phase_function(name: &str, value: Option<&Any<'_>>, g: f64) -> PyResult<PhaseFunction> {
    let Some(value) = value else { return Ok(PhaseFunction::HenyeyGreenstein { g }) };
    if let Ok(text) = value.extract::<String>() {
        let found = PhaseFunction::parse(&text, g).map_err(PyValueError::new_err)?;
        return found.ok_or_else(|| names::unknown(name, &text, &PhaseFunction::WORDS));
    }
    let numbers = Numbers::extract(name, value)?;
    let [count, 2] = *numbers.shape() else {
        let message = format!("{name} must be a text or rows of a cosine and a value, of the shape (n, 2)");
        return Err(PyValueError::new_err(message));
    };
    if g != 0.0 {
        return Err(PyValueError::new_err(format!("g is {g}, but the table {name} states the mean cosine")));
    }
    let rows = numbers.broadcast(&[count, 2]).as_chunks().0.to_vec();
    let table = PhaseTable::new(rows).map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    let warnings =
        table.warning().map(|warning| Warning { message: format!("{name}: {warning}"), place: None });
    warn(value.py(), warnings.as_slice())?;
    Ok(PhaseFunction::Table(Arc::new(table)))
}

/// The value from which [`phase_function`] makes it again, and its g.
pub(crate) fn as_argument<'py>(py: Python<'py>, phase_function: &PhaseFunction) -> PyResult<(Any<'py>, f64)> {
    Ok(match phase_function {
        PhaseFunction::HenyeyGreenstein { g } => (phase_function.name().into_pyobject(py)?.into_any(), *g),
        PhaseFunction::Table(table) => {
            let rows = table.rows();
            (array_like(py, &[&Numbers::One(0.0)], &[rows.len(), 2], rows.concat())?, 0.0)
        }
        other => (other.to_string().into_pyobject(py)?.into_any(), 0.0),
    })
}
