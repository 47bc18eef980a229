//! How a profile is made again, from a pickle.
//!
//! It is made by the calls that users have, or by others that check as much: a pickle that was damaged is an exception.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyType};
use translucid_profile::{Configuration, Model};
use translucid_scene::{ProfileRow, ProfileTable};

use crate::arrays::{Any, Numbers, array_like};
use crate::names;
use crate::profiles::Profiles;

/// What a profile was made of.
pub(crate) enum Origin {
    /// Its parameters, those of a model or of media.
    Parameters(Model, Configuration),
    /// A table, and its parameters if it has any.
    Table(ProfileTable),
    /// A call without arguments, which makes it again.
    Call(Py<PyAny>),
}

/// A row of a table: surface albedo, radii, reflectances and energies.
pub(crate) type Row<'py> = (Option<f64>, Any<'py>, Any<'py>, Any<'py>);

impl Origin {
    /// A call without arguments that makes profiles of a class again.
    pub(crate) fn call<'py>(&self, class: &Bound<'py, PyType>, profiles: &Profiles) -> PyResult<Any<'py>> {
        let py = class.py();
        let keywords = PyDict::new(py);
        let partial = |function: Any<'py>, argument: Option<Any<'py>>| {
            let partial = py.import("functools")?.getattr("partial")?;
            match argument {
                Some(argument) => partial.call((function, argument), Some(&keywords)),
                None => partial.call((function,), Some(&keywords)),
            }
        };
        match self {
            Self::Call(call) => Ok(call.bind(py).clone()),
            Self::Parameters(model, configuration) => {
                keywords.set_item("model", model.name())?;
                keywords.set_item("configuration", configuration.name())?;
                let is_medium = profiles.parameter("sigma_a").is_some();
                // Of media the other parameters follow
                let count = if is_medium { 4 } else { profiles.parameters.len() };
                set_parameters(&keywords, profiles, count)?;
                partial(
                    if is_medium { class.getattr("from_medium")? } else { class.clone().into_any() },
                    None,
                )
            }
            Self::Table(table) => {
                let array = |numbers: &[f64]| {
                    array_like(py, &[&Numbers::One(0.0)], &[numbers.len()], numbers.to_vec())
                };
                let rows = PyList::empty(py);
                for ProfileRow { surface_albedo, radii, reflectances, enclosed } in &table.rows {
                    rows.append((*surface_albedo, array(radii)?, array(reflectances)?, array(enclosed)?))?;
                }
                set_parameters(&keywords, profiles, profiles.parameters.len())?;
                partial(class.getattr("_from_rows")?, Some(rows.into_any()))
            }
        }
    }
}

/// Puts the first of the parameters into keyword arguments. Those that all elements share are numbers, but for the
/// first, which has the shape.
fn set_parameters(keywords: &Bound<'_, PyDict>, profiles: &Profiles, count: usize) -> PyResult<()> {
    for (i, (name, values)) in profiles.parameters.iter().take(count).enumerate() {
        match values[..] {
            [value, ref others @ ..] if i > 0 && others.iter().all(|x| x.to_bits() == value.to_bits()) => {
                keywords.set_item(name, value)?;
            }
            _ => {
                let values = profiles.of_elements(values);
                let array = array_like(keywords.py(), &[&Numbers::One(0.0)], &profiles.shape, values)?;
                keywords.set_item(name, array)?;
            }
        }
    }
    Ok(())
}

/// The table of the rows of a pickle.
///
/// # Errors
/// They are no rows of a table.
pub(crate) fn table_of_rows(rows: Vec<Row<'_>>) -> PyResult<ProfileTable> {
    let numbers = |name: &str, object: &Any<'_>| -> PyResult<Vec<f64>> {
        let numbers = Numbers::extract(name, object)?;
        Ok(numbers.iter().collect())
    };
    let row = |(surface_albedo, radii, reflectances, enclosed): Row<'_>| {
        Ok(ProfileRow {
            surface_albedo,
            radii: numbers("radii", &radii)?,
            reflectances: numbers("reflectances", &reflectances)?,
            enclosed: numbers("enclosed", &enclosed)?,
        })
    };
    let rows = rows.into_iter().map(row).collect::<PyResult<_>>()?;
    let table = ProfileTable { path: "from_table".into(), rows };
    table.validate().map_err(names::value_error)?;
    Ok(table)
}
