//! Numbers from Python and back: one number, or NumPy arrays of any shape and stride, in single or double precision.

use numpy::ndarray::{ArrayViewD, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyTuple};

/// Elements that are converted at a time where a function cannot read an array in its place.
const CHUNK: usize = 1024;

/// Elements from which on other Python threads may run meanwhile.
const LONG: usize = 4096;

/// The numbers of an argument, in their place.
pub(crate) enum Numbers<'py> {
    /// A number of Python, or of NumPy in double precision.
    One(f64),
    /// An array in double precision.
    Double(PyReadonlyArrayDyn<'py, f64>),
    /// An array in single precision.
    Single(PyReadonlyArrayDyn<'py, f32>),
}

/// A precision of NumPy's that is computed with in double precision.
pub(crate) trait Real: Element + Copy + Send + Sync {
    fn to_f64(self) -> f64;
    fn from_f64(x: f64) -> Self;
}

impl Real for f64 {
    fn to_f64(self) -> f64 {
        self
    }
    fn from_f64(x: f64) -> Self {
        x
    }
}

impl Real for f32 {
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn from_f64(x: f64) -> Self {
        x as f32
    }
}

impl<'py> Numbers<'py> {
    /// The numbers of an argument: floats of 4 and 8 bytes in machine order as they lie, everything else that NumPy makes
    /// numbers of as a copy.
    ///
    /// # Errors
    /// `TypeError` if NumPy makes no real numbers of it, `ValueError` if rows are of unequal length.
    pub(crate) fn extract(name: &str, object: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(number) = object.cast::<PyFloat>() {
            return Ok(Self::One(number.value()));
        }
        if object.is_exact_instance_of::<PyInt>() {
            let too_large = |_| PyValueError::new_err(format!("{name} is an integer that is too large"));
            return object.extract().map(Self::One).map_err(too_large);
        }
        if let Some(numbers) = Self::in_place(object)? {
            return Ok(numbers);
        }
        let numpy = object.py().import("numpy")?;
        let array = numpy.call_method1("asarray", (object,)).map_err(|error| {
            PyValueError::new_err(format!("{name} must be a number or an array of numbers: {error}"))
        })?;
        let dtype = array.getattr("dtype")?;
        let (kind, size): (String, usize) =
            (dtype.getattr("kind")?.extract()?, dtype.getattr("itemsize")?.extract()?);
        let precision = match kind.as_str() {
            "f" if size <= 4 => "float32",
            "f" | "i" | "u" => "float64",
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "{name} must be real numbers, but is of dtype {dtype}"
                )));
            }
        };
        let array = array.call_method1("astype", (precision,))?;
        Self::in_place(&array)?.ok_or_else(|| PyTypeError::new_err(format!("{name} must be real numbers")))
    }

    fn in_place(object: &Bound<'py, PyAny>) -> PyResult<Option<Self>> {
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>() {
            return Ok(Some(Self::Double(array.try_readonly()?)));
        }
        if let Ok(array) = object.cast::<PyArrayDyn<f32>>() {
            return Ok(Some(Self::Single(array.try_readonly()?)));
        }
        Ok(None)
    }

    /// The shape; of one number empty.
    pub(crate) fn shape(&self) -> &[usize] {
        match self {
            Self::One(_) => &[],
            Self::Double(array) => array.shape(),
            Self::Single(array) => array.shape(),
        }
    }

    /// All numbers in C order.
    pub(crate) fn iter(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        fn all<'a, T: Real>(view: ArrayViewD<'a, T>) -> Box<dyn Iterator<Item = f64> + 'a> {
            Box::new(view.into_iter().map(|x| x.to_f64()))
        }
        match self {
            Self::One(x) => Box::new(std::iter::once(*x)),
            Self::Double(array) => all(array.as_array()),
            Self::Single(array) => all(array.as_array()),
        }
    }

    /// All numbers in C order, as if the array had a shape that it can be broadcast to.
    pub(crate) fn broadcast(&self, shape: &[usize]) -> Vec<f64> {
        fn all<T: Real>(view: &ArrayViewD<'_, T>, shape: &[usize]) -> Vec<f64> {
            let view = view.broadcast(IxDyn(shape)).expect("`broadcast_shape` has found that it can be");
            view.iter().map(|x| x.to_f64()).collect()
        }
        match self {
            Self::One(x) => vec![*x; shape.iter().product()],
            Self::Double(array) => all(&array.as_array(), shape),
            Self::Single(array) => all(&array.as_array(), shape),
        }
    }

    /// Passes on if all numbers are in a range; `allowed` says what the range is, worded to follow "must be".
    pub(crate) fn require(
        &self,
        name: &str,
        allowed: &str,
        is_allowed: impl Fn(f64) -> bool,
    ) -> PyResult<()> {
        fn first<T: Real>(
            view: &ArrayViewD<'_, T>,
            is_allowed: impl Fn(f64) -> bool,
        ) -> Option<(Vec<usize>, f64)> {
            // Most arrays are good: look without asking where
            let is_good = match view.as_slice_memory_order() {
                Some(slice) => slice.iter().fold(true, |good, x| good & is_allowed(x.to_f64())),
                None => view.iter().all(|x| is_allowed(x.to_f64())),
            };
            if is_good {
                return None;
            }
            let bad = view.indexed_iter().find(|(_, x)| !is_allowed(x.to_f64()));
            bad.map(|(index, x)| (numpy::ndarray::Dimension::slice(&index).to_vec(), x.to_f64()))
        }
        let bad = match self {
            Self::One(x) => (!is_allowed(*x)).then(|| (Vec::new(), *x)),
            Self::Double(array) => first(&array.as_array(), is_allowed),
            Self::Single(array) => first(&array.as_array(), is_allowed),
        };
        bad.map_or(Ok(()), |(index, x)| {
            let place = if index.is_empty() { String::new() } else { format!("{index:?}") };
            Err(PyValueError::new_err(format!("{name}{place} is {x}, but must be {allowed}")))
        })
    }

    /// Applies a function of slices: a number gives a number, an array an array of its shape and precision.
    pub(crate) fn map(
        &self,
        py: Python<'py>,
        f: impl Fn(&[f64], &mut [f64]) + Send + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        match self {
            Self::One(x) => {
                let mut y = [0.0];
                f(&[*x], &mut y);
                Ok(PyFloat::new(py, y[0]).into_any())
            }
            Self::Double(array) => {
                let Ok(from) = array.as_slice() else { return map_in_chunks(py, &array.as_array(), f) };
                let out = PyArrayDyn::<f64>::zeros(py, array.shape(), false);
                {
                    let mut out = out.readwrite();
                    let out = out.as_slice_mut().expect("zeros are contiguous");
                    detach_if_long(py, from.len(), || f(from, out));
                }
                scalar_if_0d(out)
            }
            Self::Single(array) => map_in_chunks(py, &array.as_array(), f),
        }
    }
}

fn map_in_chunks<'py, T: Real>(
    py: Python<'py>,
    view: &ArrayViewD<'_, T>,
    f: impl Fn(&[f64], &mut [f64]) + Send + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let out = PyArrayDyn::<T>::zeros(py, view.shape(), false);
    {
        let mut out = out.readwrite();
        let out = out.as_slice_mut().expect("zeros are contiguous");
        detach_if_long(py, out.len(), || {
            let (mut from, mut to) = ([0.0; CHUNK], [0.0; CHUNK]);
            let mut numbers = view.iter();
            for out in out.chunks_mut(CHUNK) {
                let n = out.len();
                from.iter_mut().zip(numbers.by_ref().take(n)).for_each(|(x, number)| *x = number.to_f64());
                f(&from[..n], &mut to[..n]);
                out.iter_mut().zip(&to).for_each(|(out, y)| *out = T::from_f64(*y));
            }
        });
    }
    scalar_if_0d(out)
}

fn detach_if_long(py: Python<'_>, elements: usize, work: impl FnOnce() + Send) {
    if elements < LONG { work() } else { py.detach(work) }
}

/// A result without dimensions is a scalar, as NumPy's own functions return it.
fn scalar_if_0d<T: Real>(out: Bound<'_, PyArrayDyn<T>>) -> PyResult<Bound<'_, PyAny>> {
    if out.ndim() == 0 { out.get_item(PyTuple::empty(out.py())) } else { Ok(out.into_any()) }
}

/// The shape to which all can be broadcast, by NumPy's rule.
///
/// # Errors
/// `ValueError` that names the arguments and their shapes.
pub(crate) fn broadcast_shape(arguments: &[(&str, &[usize])]) -> PyResult<Vec<usize>> {
    let dimensions = arguments.iter().map(|(_, shape)| shape.len()).max().unwrap_or(0);
    let mut result = vec![1; dimensions];
    for (_, shape) in arguments {
        for (all, &one) in result[dimensions - shape.len()..].iter_mut().zip(*shape) {
            if *all == 1 {
                *all = one;
            } else if one != 1 && one != *all {
                let shapes: Vec<String> =
                    arguments.iter().map(|(name, shape)| format!("{name} {shape:?}")).collect();
                let shapes = shapes.join(", ");
                return Err(PyValueError::new_err(format!("shapes cannot be broadcast together: {shapes}")));
            }
        }
    }
    Ok(result)
}

/// An array of these numbers in C order, single precision if that is what all arrays among the arguments have.
pub(crate) fn array_like<'py>(
    py: Python<'py>,
    arguments: &[&Numbers<'py>],
    shape: &[usize],
    numbers: Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let is_single = arguments.iter().any(|numbers| matches!(numbers, Numbers::Single(_)))
        && !arguments.iter().any(|numbers| matches!(numbers, Numbers::Double(_)));
    if is_single {
        let numbers = numbers.into_iter().map(|x| x as f32).collect();
        shaped(numpy::PyArray1::<f32>::from_vec(py, numbers), shape)
    } else {
        shaped(numpy::PyArray1::<f64>::from_vec(py, numbers), shape)
    }
}

fn shaped<'py, T: Real>(
    array: Bound<'py, numpy::PyArray1<T>>,
    shape: &[usize],
) -> PyResult<Bound<'py, PyAny>> {
    scalar_if_0d(array.reshape(IxDyn(shape))?)
}
