//! The photons of a walk, as a caller names them: how many, or which.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyRange};
use translucid_reference::walk::PhotonRange;

use crate::arrays::Any;
use crate::scene::whole_number;

/// Photons to be walked.
pub(crate) enum Photons {
    /// Seed, and how many.
    Count(u64, u64),
    Range(PhotonRange),
}

/// The seed of a walk.
pub(crate) fn seed(argument: &Any<'_>) -> PyResult<u64> {
    whole_number("seed", argument, 0, u64::MAX)
}

impl Photons {
    pub(crate) fn extract(object: &Any<'_>, seed: u64) -> PyResult<Self> {
        if object.is_instance_of::<PyRange>() {
            let part = |name: &str| object.getattr(name)?.extract::<i128>();
            let wrong = || PyValueError::new_err("photons must be a range of step 1 within [0, 2**63)");
            let [start, stop, step] =
                [part("start"), part("stop"), part("step")].map(|x| x.map_err(|_| wrong()));
            let (start, stop, step) = (start?, stop?, step?);
            let is_good = step == 1 && start >= 0 && stop >= start && stop < 1 << 63;
            if !is_good {
                return Err(wrong());
            }
            return Ok(Self::Range(PhotonRange { seed, start: start as u64, end: stop as u64 }));
        }
        let is_number = object.is_instance_of::<PyFloat>() || object.is_instance_of::<PyInt>();
        if object.is_instance_of::<PyBool>() || !is_number && !object.hasattr("__index__")? {
            return Err(PyTypeError::new_err(
                "photons must be a whole number, such as 1e7, or a range of them",
            ));
        }
        let wrong = || {
            let shown = object.repr().map(|text| text.to_string()).unwrap_or_default();
            PyValueError::new_err(format!("photons is {shown}, but must be a whole number in [0, 2**63)"))
        };
        let count = match object.cast::<PyFloat>() {
            Ok(number) => {
                let number = number.value();
                let is_good = number >= 0.0 && number < 2.0_f64.powi(63) && number.fract() == 0.0;
                if is_good { number as u64 } else { return Err(wrong()) }
            }
            Err(_) => object.extract::<u64>().map_err(|_| wrong())?,
        };
        if count < 1 << 63 { Ok(Self::Count(seed, count)) } else { Err(wrong()) }
    }

    pub(crate) fn count(&self) -> u64 {
        match self {
            Self::Count(_, count) => *count,
            Self::Range(range) => range.len(),
        }
    }
}
