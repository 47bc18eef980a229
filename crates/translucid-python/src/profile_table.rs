//! Profiles from samples: the table of a file, or of arrays.

use std::path::PathBuf;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use translucid_load::load_profile_table;
use translucid_scene::{ProfileRow, ProfileTable};

use crate::arrays::{Any, Numbers, Rule};
use crate::names;

/// The table of a file, or of arrays.
pub(crate) fn profile_table(
    r: &Any<'_>,
    reflectance: Option<&Any<'_>>,
    enclosed: Option<&Any<'_>>,
    surface_albedos: Option<&Any<'_>>,
) -> PyResult<ProfileTable> {
    let Some(reflectance) = reflectance else {
        let Ok(path) = r.extract::<PathBuf>() else {
            return Err(PyTypeError::new_err("reflectance is missing: r is not the path of a file"));
        };
        if enclosed.is_some() || surface_albedos.is_some() {
            return Err(PyTypeError::new_err("enclosed and surface_albedos are columns of the file"));
        }
        return load_profile_table(&path).map_err(names::value_error);
    };
    let r = Numbers::extract("r", r)?;
    let reflectance = Numbers::extract("reflectance", reflectance)?;
    let enclosed = enclosed.map(|object| Numbers::extract("enclosed", object)).transpose()?;
    let [count] = r.shape()[..] else {
        return Err(wrong_shape("r", r.shape(), "one dimension"));
    };
    let rows = match (reflectance.shape(), surface_albedos) {
        ([n], None) if *n == count => 1,
        ([rows, n], Some(_)) if *n == count => *rows,
        (shape, None) => {
            return Err(wrong_shape("reflectance", shape, &format!("the shape ({count},) of r")));
        }
        (shape, Some(_)) => {
            let must = format!("the shape (k, {count}): k surface_albedos, and the radii of r");
            return Err(wrong_shape("reflectance", shape, &must));
        }
    };
    if let Some(enclosed) = enclosed.as_ref().filter(|enclosed| enclosed.shape() != reflectance.shape()) {
        return Err(wrong_shape("enclosed", enclosed.shape(), "the shape of reflectance"));
    }
    let albedos: Vec<Option<f64>> = match surface_albedos {
        None => vec![None],
        Some(albedos) => {
            let albedos = Numbers::extract("surface_albedos", albedos)?;
            if albedos.shape() != [rows] {
                return Err(wrong_shape("surface_albedos", albedos.shape(), &format!("the shape ({rows},)")));
            }
            albedos.require(&Rule::new("surface_albedos", "in [0, 1]", 0.0, 1.0))?;
            let albedos = albedos.broadcast(&[rows]);
            require_rising("surface_albedos", &albedos)?;
            albedos.into_iter().map(Some).collect()
        }
    };
    r.require(&Rule::new("r", "in [1e-100, 1e100]", 1e-100, 1e100))?;
    let radii = r.broadcast(&[count]);
    require_rising("r", &radii)?;
    reflectance.require(&Rule::new("reflectance", "in [0, 1e200]", 0.0, 1e200))?;
    if let Some(enclosed) = &enclosed {
        enclosed.require(&Rule::new("enclosed", "in [0, 1e200]", 0.0, 1e200))?;
    }
    let reflectances = reflectance.broadcast(reflectance.shape());
    let enclosed = enclosed.map(|enclosed| enclosed.broadcast(enclosed.shape()));
    let row = |(i, surface_albedo): (usize, Option<f64>)| {
        let place = i * count..(i + 1) * count;
        ProfileRow {
            surface_albedo,
            radii: radii.clone(),
            reflectances: reflectances[place.clone()].to_vec(),
            enclosed: enclosed.as_ref().map_or(Vec::new(), |enclosed| enclosed[place].to_vec()),
        }
    };
    let table = ProfileTable {
        path: PathBuf::from("from_table"),
        rows: albedos.into_iter().enumerate().map(row).collect(),
    };
    table.table().map_err(|error| PyValueError::new_err(error.message))?;
    Ok(table)
}

/// Refuses numbers of which one is not above the one before.
fn require_rising(name: &str, numbers: &[f64]) -> PyResult<()> {
    match numbers.windows(2).position(|pair| pair[0] >= pair[1]) {
        Some(i) => {
            let (here, before) = (numbers[i + 1], numbers[i]);
            let message = format!("{name}[{}] is {here}, but must be above {before}, the one before", i + 1);
            Err(PyValueError::new_err(message))
        }
        None => Ok(()),
    }
}

fn wrong_shape(name: &str, shape: &[usize], must: &str) -> PyErr {
    PyValueError::new_err(format!("{name} has the shape {shape:?}, but must have {must}"))
}
