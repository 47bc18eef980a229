//! Profiles of one element, or of as many as arrays of parameters describe.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use translucid_profile::ParameterError;

use crate::arrays::{Numbers, broadcast_shape};
use crate::long_work;

pub(crate) type SharedProfile = Arc<dyn translucid_profile::Profile>;

/// Elements whose profiles are made on a thread of their own, for Ctrl-C.
const MANY: usize = 64;

/// Profiles of all elements of a shape, of equal elements one.
#[derive(Clone)]
pub(crate) struct Profiles {
    pub(crate) shape: Vec<usize>,
    /// Each element's place among the different profiles, in C order.
    pub(crate) elements: Vec<u32>,
    /// The different profiles.
    pub(crate) different: Vec<SharedProfile>,
    /// Names of what they were made from, and the value for each different profile.
    pub(crate) parameters: Vec<(&'static str, Vec<f64>)>,
}

impl Profiles {
    /// Makes the profiles of all elements.
    pub(crate) fn new<const N: usize>(
        py: Python<'_>,
        arguments: [(&'static str, &Numbers<'_>); N],
        make_one: impl Fn([f64; N]) -> Result<SharedProfile, ParameterError> + Send + Sync,
    ) -> PyResult<Self> {
        let shape = broadcast_shape(&arguments.map(|(name, numbers)| (name, numbers.shape())))?;
        let (names, columns) =
            (arguments.map(|(name, _)| name), arguments.map(|(_, numbers)| numbers.broadcast(&shape)));
        let count: usize = shape.iter().product();
        let row = |element: usize| -> [f64; N] { std::array::from_fn(|i| columns[i][element]) };
        let make_all = |stop: &AtomicBool| {
            let (mut elements, mut different) = (Vec::with_capacity(count), Vec::new());
            let mut parameters = names.map(|name| (name, Vec::new()));
            let mut known = HashMap::new();
            for element in 0..count {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let number = match known.entry(row(element).map(f64::to_bits)) {
                    Entry::Occupied(entry) => *entry.get(),
                    Entry::Vacant(entry) => {
                        different.push(make_one(row(element)).map_err(|error| (error, element))?);
                        parameters.iter_mut().zip(row(element)).for_each(|((_, values), x)| values.push(x));
                        *entry.insert(different.len() as u32 - 1)
                    }
                };
                elements.push(number);
            }
            Ok((elements, different, parameters.to_vec()))
        };
        if u32::try_from(count).is_err() {
            return Err(PyValueError::new_err(format!("shape {shape:?} has more than 4 billion elements")));
        }
        let made = if count < MANY {
            make_all(&AtomicBool::new(false))
        } else {
            long_work::run(py, make_all, |_| Ok(()))?
        };
        let (elements, different, parameters) = made
            .map_err(|(error, element)| crate::names::parameter_error(&error, &index_of(element, &shape)))?;
        Ok(Self { shape, elements, different, parameters })
    }

    /// One profile that somebody else made.
    pub(crate) fn of_one(profile: SharedProfile) -> Self {
        Self { shape: Vec::new(), elements: vec![0], different: vec![profile], parameters: Vec::new() }
    }

    /// The only profile.
    ///
    /// # Errors
    /// There are several.
    pub(crate) fn only(&self) -> PyResult<SharedProfile> {
        match &self.elements[..] {
            [element] => Ok(Arc::clone(&self.different[*element as usize])),
            _ => {
                let shape = &self.shape;
                Err(PyValueError::new_err(format!(
                    "the profile has the shape {shape:?}, but must be a single one"
                )))
            }
        }
    }

    /// The values of a parameter, one for each different profile.
    pub(crate) fn parameter(&self, name: &str) -> Option<&[f64]> {
        self.parameters.iter().find(|(known, _)| *known == name).map(|(_, values)| &values[..])
    }

    /// Something of each element, from what each different profile has of it.
    pub(crate) fn of_elements(&self, values: &[f64]) -> Vec<f64> {
        self.elements.iter().map(|&element| values[element as usize]).collect()
    }
}

/// The index of an element in C order.
pub(crate) fn index_of(mut element: usize, shape: &[usize]) -> Vec<usize> {
    let mut index: Vec<usize> = Vec::with_capacity(shape.len());
    for &n in shape.iter().rev() {
        index.push(element % n);
        element /= n;
    }
    index.reverse();
    index
}
