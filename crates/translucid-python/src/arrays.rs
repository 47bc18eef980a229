//! Numbers from Python and back: one number, or NumPy arrays of any shape and stride, in single or double precision.

use std::ops::Range;
use std::time::{Duration, Instant};

use numpy::ndarray::iter::Iter;
use numpy::ndarray::{ArrayViewD, Axis, Ix4, IxDyn};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt, PyTuple};

/// An object of Python's, whatever its type.
pub(crate) type Any<'py> = Bound<'py, PyAny>;

/// Elements that are converted at a time where a function cannot read an array in its place.
const CHUNK: usize = 1024;

/// Most elements that are done while other Python threads wait.
const SHORT: usize = 256;

/// Time between two looks at signals.
const BLOCK_TIME: Duration = Duration::from_millis(30);

/// The numbers of an argument, in their place.
pub(crate) enum Numbers<'py> {
    /// A number of Python, or of NumPy in double precision.
    One(f64),
    /// An array in double precision.
    Double(PyReadonlyArrayDyn<'py, f64>),
    /// An array in single precision.
    Single(PyReadonlyArrayDyn<'py, f32>),
}

/// Tells whether all elements lie where the machine reads them: those of packed records and of bytes need not.
pub(crate) fn is_aligned<T: Element>(array: &Bound<'_, PyArrayDyn<T>>) -> bool {
    let step = size_of::<T>();
    (array.data() as usize).is_multiple_of(step)
        && array.strides().iter().all(|stride| stride % step as isize == 0)
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
    /// The nearest finite number.
    fn from_f64(x: f64) -> Self {
        x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32
    }
}

impl<'py> Numbers<'py> {
    /// The numbers of an argument: floats of 4 and 8 bytes in machine order as they lie, everything else that NumPy makes
    /// numbers of as a copy.
    ///
    /// # Errors
    /// `TypeError` if NumPy makes no real numbers of it, `ValueError` if rows are of unequal length.
    pub(crate) fn extract(name: &str, object: &Any<'py>) -> PyResult<Self> {
        if let Ok(number) = object.cast::<PyFloat>() {
            return Ok(Self::One(number.value()));
        }
        if object.is_exact_instance_of::<PyInt>() {
            let too_large = |_| PyValueError::new_err(format!("{name} is an integer that is too large"));
            return object.extract().map(Self::One).map_err(too_large);
        }
        if object.get_type().name()? == "MaskedArray" {
            return Err(PyTypeError::new_err(format!(
                "{name} has a mask, which would be ignored: fill or compress it"
            )));
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

    fn in_place(object: &Any<'py>) -> PyResult<Option<Self>> {
        match (object.cast::<PyArrayDyn<f64>>(), object.cast::<PyArrayDyn<f32>>()) {
            (Ok(array), _) if is_aligned(array) => Ok(Some(Self::Double(array.try_readonly()?))),
            (_, Ok(array)) if is_aligned(array) => Ok(Some(Self::Single(array.try_readonly()?))),
            _ => Ok(None),
        }
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

    /// Passes on if all numbers keep a rule.
    pub(crate) fn require(&self, rule: &Rule<'_>) -> PyResult<()> {
        fn first<T: Real>(view: &ArrayViewD<'_, T>, rule: &Rule<'_>) -> Option<(Vec<usize>, f64)> {
            // Most arrays are good: look without asking where
            let is_good = match view.as_slice_memory_order() {
                Some(slice) => slice.iter().fold(true, |good, x| good & rule.allows(x.to_f64())),
                None => view.iter().all(|x| rule.allows(x.to_f64())),
            };
            if is_good {
                return None;
            }
            let bad = view.indexed_iter().find(|(_, x)| !rule.allows(x.to_f64()));
            bad.map(|(index, x)| (numpy::ndarray::Dimension::slice(&index).to_vec(), x.to_f64()))
        }
        let bad = match self {
            Self::One(x) => (!rule.allows(*x)).then(|| (Vec::new(), *x)),
            Self::Double(array) => first(&array.as_array(), rule),
            Self::Single(array) => first(&array.as_array(), rule),
        };
        bad.map_or(Ok(()), |(index, x)| {
            let Rule { name, allowed, .. } = rule;
            let place = if index.is_empty() { String::new() } else { format!("{index:?}") };
            Err(PyValueError::new_err(format!("{name}{place} is {x}, but must be {allowed}")))
        })
    }

    /// The only number.
    ///
    /// # Errors
    /// There are several, or it breaks the rule.
    pub(crate) fn single(&self, rule: &Rule<'_>) -> PyResult<f64> {
        if self.shape().iter().product::<usize>() != 1 {
            let (name, shape) = (rule.name, self.shape());
            return Err(PyTypeError::new_err(format!(
                "{name} must be one number, but is an array of shape {shape:?}"
            )));
        }
        self.require(rule)?;
        Ok(self.broadcast(&[1])[0])
    }

    /// Applies a function of slices to numbers that keep a rule: a number gives a number, an array an array of its shape
    /// and precision, which may be that of an argument `out`.
    pub(crate) fn map(
        &self,
        py: Python<'py>,
        rule: &Rule<'_>,
        out: Option<&Any<'py>>,
        f: impl Fn(&[f64], &mut [f64]) + Send + Sync,
    ) -> PyResult<Any<'py>> {
        match self {
            Self::One(x) => {
                self.require(rule)?;
                let mut y = [0.0];
                f(&[*x], &mut y);
                if out.is_none() {
                    return Ok(PyFloat::new(py, y[0]).into_any());
                }
                let memory = Memory::new(py, &[], Order::C, out, &[])?;
                memory.write(|to| {
                    to.copy_from_slice(&y);
                    Ok(())
                })
            }
            Self::Double(array) => {
                let Ok(from) = array.as_slice() else { return self.map_with(py, rule, out, array, &f) };
                let order = if array.is_c_contiguous() { Order::C } else { Order::Fortran };
                let memory = Memory::new(py, array.shape(), order, out, &[array.as_any()])?;
                let mut is_good = true;
                memory.write(|out| {
                    in_blocks(py, from.len(), |block| {
                        let chunks = from[block.clone()].chunks(CHUNK).zip(out[block].chunks_mut(CHUNK));
                        for (from, out) in chunks {
                            // While the numbers are in the first-level cache
                            is_good &= from.iter().fold(true, |good, x| good & rule.allows(*x));
                            f(from, out);
                        }
                    })?;
                    if is_good { Ok(()) } else { self.require(rule) }
                })
            }
            Self::Single(array) => self.map_with(py, rule, out, array, &f),
        }
    }

    fn map_with<T: Real>(
        &self,
        py: Python<'py>,
        rule: &Rule<'_>,
        out: Option<&Any<'py>>,
        array: &PyReadonlyArrayDyn<'py, T>,
        f: &(impl Fn(&[f64], &mut [f64]) + Send + Sync),
    ) -> PyResult<Any<'py>> {
        let view = array.as_array();
        let memory = Memory::<T>::new(py, view.shape(), Order::C, out, &[array.as_any()])?;
        let mut chunks = Chunks::new(&view, rule);
        memory.write(|out| {
            fill(py, out, &mut chunks, |chunks, n, to| f(chunks.next(n), to))?;
            if chunks.is_good { Ok(()) } else { self.require(rule) }
        })
    }

    /// Applies a function of an index and slices to numbers that keep a rule, the indices and the numbers broadcast to a
    /// shape; the result may be in the memory of an argument `out`.
    pub(crate) fn map_indexed(
        &self,
        py: Python<'py>,
        rule: &Rule<'_>,
        out: Option<&Any<'py>>,
        shape: &[usize],
        indices: &ArrayViewD<'_, u32>,
        f: impl Fn(u32, &[f64], &mut [f64]) + Send + Sync,
    ) -> PyResult<Any<'py>> {
        self.require(rule)?;
        let known = "`broadcast_shape` has found that it can be";
        let indices = indices.broadcast(IxDyn(shape)).expect(known);
        fn all<'py, T: Real>(
            py: Python<'py>,
            view: &ArrayViewD<'_, T>,
            memory: Memory<'py, T>,
            shape: &[usize],
            indices: &ArrayViewD<'_, u32>,
            f: impl Fn(u32, &[f64], &mut [f64]) + Send + Sync,
        ) -> PyResult<Any<'py>> {
            let view = view.broadcast(IxDyn(shape)).expect("`broadcast_shape` has found that it can be");
            // Known to be good, and as often as it is repeated
            let anything = Rule::new("", "", f64::NEG_INFINITY, f64::INFINITY);
            let mut state = (Chunks::new(&view, &anything), Elements::new(indices), [0; CHUNK]);
            memory.write(|out| {
                fill(py, out, &mut state, |(chunks, indices, wanted), n, to| {
                    let from = chunks.next(n);
                    indices.read(&mut wanted[..n], |index| index);
                    let mut start = 0;
                    for run in wanted[..n].chunk_by(|a, b| a == b) {
                        let end = start + run.len();
                        f(run[0], &from[start..end], &mut to[start..end]);
                        start = end;
                    }
                })
            })
        }
        match self {
            Self::One(x) => {
                let memory = Memory::new(py, shape, Order::C, out, &[])?;
                all(py, &numpy::ndarray::arr0(*x).into_dyn().view(), memory, shape, &indices, f)
            }
            Self::Double(array) => {
                let memory = Memory::new(py, shape, Order::C, out, &[array.as_any()])?;
                all(py, &array.as_array(), memory, shape, &indices, f)
            }
            Self::Single(array) => {
                let memory = Memory::new(py, shape, Order::C, out, &[array.as_any()])?;
                all(py, &array.as_array(), memory, shape, &indices, f)
            }
        }
    }
}

/// Range that the numbers of an argument must be in.
pub(crate) struct Rule<'a> {
    /// Name of the argument.
    pub(crate) name: &'a str,
    /// The range, worded to follow "must be".
    pub(crate) allowed: &'a str,
    /// The least number.
    pub(crate) low: f64,
    /// The greatest.
    pub(crate) high: f64,
}

impl<'a> Rule<'a> {
    pub(crate) const fn new(name: &'a str, allowed: &'a str, low: f64, high: f64) -> Self {
        Self { name, allowed, low, high }
    }

    #[inline(always)]
    fn allows(&self, x: f64) -> bool {
        (x >= self.low) & (x <= self.high)
    }
}

/// Elements in C order that are read a chunk at a time: an array's of any number of dimensions one by one take tens of
/// nanoseconds each.
enum Elements<'a, T> {
    Slice(std::slice::Iter<'a, T>),
    Four(Iter<'a, T, Ix4>),
    Any(Iter<'a, T, IxDyn>),
}

impl<'a, T: Copy> Elements<'a, T> {
    fn new(view: &ArrayViewD<'a, T>) -> Self {
        if let Some(slice) = view.to_slice() {
            return Self::Slice(slice.iter());
        }
        let mut view = view.clone();
        while view.ndim() < 4 {
            view.insert_axis_inplace(Axis(0));
        }
        match view.clone().into_dimensionality::<Ix4>() {
            Ok(view) => Self::Four(view.into_iter()),
            Err(_) => Self::Any(view.into_iter()),
        }
    }

    /// Reads as many of the next elements as there is room for.
    fn read<U>(&mut self, to: &mut [U], convert: impl Fn(T) -> U) {
        match self {
            Self::Slice(elements) => to.iter_mut().zip(elements).for_each(|(to, x)| *to = convert(*x)),
            Self::Four(elements) => to.iter_mut().zip(elements).for_each(|(to, x)| *to = convert(*x)),
            Self::Any(elements) => to.iter_mut().zip(elements).for_each(|(to, x)| *to = convert(*x)),
        }
    }
}

/// Numbers in double precision, a chunk at a time.
struct Chunks<'a, T> {
    elements: Elements<'a, T>,
    buffer: [f64; CHUNK],
    rule: &'a Rule<'a>,
    /// Whether all so far kept the rule.
    is_good: bool,
}

impl<'a, T: Real> Chunks<'a, T> {
    fn new(view: &ArrayViewD<'a, T>, rule: &'a Rule<'a>) -> Self {
        Self { elements: Elements::new(view), buffer: [0.0; CHUNK], rule, is_good: true }
    }

    /// The next `n` numbers, at most [`CHUNK`].
    fn next(&mut self, n: usize) -> &[f64] {
        let buffer = &mut self.buffer[..n];
        self.elements.read(buffer, T::to_f64);
        self.is_good &= buffer.iter().fold(true, |good, x| good & self.rule.allows(*x));
        buffer
    }
}

/// Order of the elements of an array that lie one behind the other.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Order {
    C,
    Fortran,
}

/// Memory of a result: a new array, or what the caller has given as `out`.
struct Memory<'py, T: Element> {
    /// Elements one behind the other, and none of them of an argument that the result is made of.
    array: Bound<'py, PyArrayDyn<T>>,
    /// The argument `out`; results are copied there where it is another array.
    out: Option<Bound<'py, PyArrayDyn<T>>>,
}

impl<'py, T: Real> Memory<'py, T> {
    /// Memory for a result that is made of the elements of some arrays.
    ///
    /// # Errors
    /// `out` is no array of the result's shape and precision, or read-only.
    fn new(
        py: Python<'py>,
        shape: &[usize],
        order: Order,
        out: Option<&Any<'py>>,
        sources: &[&Any<'py>],
    ) -> PyResult<Self> {
        let fresh = || PyArrayDyn::zeros(py, shape, order == Order::Fortran);
        let Some(given) = out else { return Ok(Self { array: fresh(), out: None }) };
        let Ok(out) = given.cast::<PyArrayDyn<T>>() else {
            let found = match given.getattr("dtype") {
                Ok(dtype) => format!("dtype {dtype}"),
                Err(_) => format!("type {}", given.get_type().name()?),
            };
            let must_be = T::get_dtype(py);
            return Err(PyTypeError::new_err(format!(
                "out is of {found}, but must be an array of the result's dtype, {must_be}"
            )));
        };
        if out.shape() != shape {
            let found = out.shape();
            return Err(PyValueError::new_err(format!(
                "out has the shape {found:?}, but must have that of the result, {shape:?}"
            )));
        }
        if !out.getattr("flags")?.getattr("writeable")?.is_truthy()? {
            return Err(PyValueError::new_err("out is read-only"));
        }
        let numpy = py.import("numpy")?;
        let overlaps =
            |source: &&Any<'py>| numpy.call_method1("may_share_memory", (out, *source))?.is_truthy();
        let is_in_order = match order {
            Order::C => out.is_c_contiguous(),
            Order::Fortran => out.is_fortran_contiguous(),
        };
        let mut is_apart = is_in_order && is_aligned(out);
        for source in sources {
            is_apart = is_apart && !overlaps(source)?;
        }
        let array = if is_apart { out.clone() } else { fresh() };
        Ok(Self { array, out: Some(out.clone()) })
    }

    /// Has the elements written, and returns the array; without dimensions a scalar, as NumPy's own functions do.
    fn write(self, work: impl FnOnce(&mut [T]) -> PyResult<()>) -> PyResult<Any<'py>> {
        {
            let in_use = |_| PyValueError::new_err("out is in use by another call");
            let mut array = self.array.try_readwrite().map_err(in_use)?;
            work(array.as_slice_mut()?)?;
        }
        let Some(out) = self.out else { return scalar_if_0d(self.array) };
        if !out.is(&self.array) {
            self.array.copy_to(&out)?;
        }
        Ok(out.into_any())
    }
}

/// Computes elements in order, at most [`CHUNK`] at a time.
fn fill<T: Real, S: Send>(
    py: Python<'_>,
    out: &mut [T],
    state: &mut S,
    next: impl Fn(&mut S, usize, &mut [f64]) + Send + Sync,
) -> PyResult<()> {
    let mut to = [0.0; CHUNK];
    in_blocks(py, out.len(), |block| {
        for out in out[block].chunks_mut(CHUNK) {
            next(state, out.len(), &mut to[..out.len()]);
            out.iter_mut().zip(&to).for_each(|(out, y)| *out = T::from_f64(*y));
        }
    })
}

/// Works through elements in order, with the interpreter detached where there are many, and looks after signals.
fn in_blocks(py: Python<'_>, elements: usize, mut work: impl FnMut(Range<usize>) + Send) -> PyResult<()> {
    if elements <= SHORT {
        work(0..elements);
        return Ok(());
    }
    let (mut start, mut size) = (0, SHORT);
    while start < elements {
        let (end, begun) = (elements.min(start.saturating_add(size)), Instant::now());
        py.detach(|| work(start..end));
        // Slow models take milliseconds for few elements, closed forms nanoseconds for each
        let speed_up = BLOCK_TIME.as_secs_f64() / begun.elapsed().as_secs_f64().max(1e-9);
        size = ((size as f64 * speed_up.clamp(0.25, 4.0)) as usize).max(16);
        start = end;
        py.check_signals()?;
    }
    Ok(())
}

/// A result without dimensions is a scalar, as NumPy's own functions return it.
fn scalar_if_0d<T: Real>(out: Bound<'_, PyArrayDyn<T>>) -> PyResult<Any<'_>> {
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

/// An array of these numbers in C order, single precision if that is what all arrays among the arguments have; of numbers
/// a number.
pub(crate) fn array_like<'py>(
    py: Python<'py>,
    arguments: &[&Numbers<'py>],
    shape: &[usize],
    numbers: Vec<f64>,
) -> PyResult<Any<'py>> {
    if arguments.iter().all(|numbers| matches!(numbers, Numbers::One(_)))
        && let ([], [number]) = (shape, &numbers[..])
    {
        return Ok(PyFloat::new(py, *number).into_any());
    }
    let is_single = arguments.iter().any(|numbers| matches!(numbers, Numbers::Single(_)))
        && !arguments.iter().any(|numbers| matches!(numbers, Numbers::Double(_)));
    if is_single {
        let numbers = numbers.into_iter().map(f32::from_f64).collect();
        shaped(&numpy::PyArray1::<f32>::from_vec(py, numbers), shape)
    } else {
        shaped(&numpy::PyArray1::<f64>::from_vec(py, numbers), shape)
    }
}

fn shaped<'py, T: Real>(array: &Bound<'py, numpy::PyArray1<T>>, shape: &[usize]) -> PyResult<Any<'py>> {
    scalar_if_0d(array.reshape(IxDyn(shape))?)
}
