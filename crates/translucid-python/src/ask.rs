//! Questions of the desk: keyword arguments to values, answers to arrays.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyDict, PyFloat, PyInt, PyMapping, PyString};
use translucid_desk::{Answer, Ask, Control, QUESTIONS, Unanswered};
use translucid_words::{Cell, Content, DataTable, Described, Entry, Error, Kind, Object, Provenance, Value};

use crate::arrays::{Any, Numbers, array_like, broadcast_shape};
use crate::long_work;
use crate::reference::{pool, report, with_progress};

/// Steps in which progress is told.
const STEPS: u64 = 1000;

/// Arguments of a caller, with arrays wherever numbers may vary.
pub(crate) struct Said<'py> {
    entries: Vec<Entry>,
    /// Arrays by their places among the values.
    arrays: Vec<(String, Numbers<'py>)>,
    shape: Vec<usize>,
}

impl<'py> Said<'py> {
    /// Reads the arguments that are not `None`.
    pub(crate) fn new(keys: &[Described], arguments: &[(&str, Any<'py>)]) -> PyResult<Self> {
        let mut said = Self { entries: Vec::new(), arrays: Vec::new(), shape: Vec::new() };
        for (name, value) in arguments.iter().filter(|(_, value)| !value.is_none()) {
            let kind = keys.iter().find(|key| key.name == *name).map(|key| &key.kind);
            let value = said.value(name, value, kind)?;
            said.entries.push(Entry::new(name, value));
        }
        let shapes: Vec<(&str, &[usize])> =
            said.arrays.iter().map(|(name, numbers)| (name.as_str(), numbers.shape())).collect();
        said.shape = broadcast_shape(&shapes)?;
        said.require_memory()?;
        let columns: Vec<Arc<[f64]>> =
            said.arrays.iter().map(|(_, numbers)| numbers.broadcast(&said.shape).into()).collect();
        said.entries.iter_mut().for_each(|entry| fill(&mut entry.value, &columns));
        Ok(said)
    }

    /// Values by their keys.
    pub(crate) fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// The first argument that is an array, and its shape.
    pub(crate) fn first_array(&self) -> Option<(&str, &[usize])> {
        let array = self.arrays.iter().find(|(_, numbers)| !numbers.shape().is_empty());
        array.map(|(name, numbers)| (name.as_str(), numbers.shape()))
    }

    /// Numbers in the shape and precision of the arguments, with more axes behind.
    pub(crate) fn array(&self, py: Python<'py>, more: &[usize], numbers: Vec<f64>) -> PyResult<Any<'py>> {
        let arguments: Vec<&Numbers<'py>> = self.arrays.iter().map(|(_, numbers)| numbers).collect();
        array_like(py, &arguments, &[&self.shape, more].concat(), numbers)
    }

    /// Asks for the memory that all arrays take and gives it back, as none could only end the process.
    fn require_memory(&self) -> PyResult<()> {
        let bytes = size_of::<f64>() * 4 * (self.arrays.len() + 8);
        let needed = self.shape.iter().try_fold(bytes, |bytes, count| bytes.checked_mul(*count));
        Vec::<u8>::new().try_reserve_exact(needed.unwrap_or(usize::MAX)).map_err(|_| {
            let shape = &self.shape;
            PyMemoryError::new_err(format!("arguments broadcast to {shape:?}, too many for memory"))
        })
    }

    /// A value; an array where numbers may vary is kept, and a place is left for it.
    fn value(&mut self, name: &str, value: &Any<'py>, kind: Option<&Kind>) -> PyResult<Value> {
        if let Ok(text) = value.cast::<PyString>() {
            return Ok(text.to_str()?.into());
        }
        if let Ok(flag) = value.cast::<PyBool>() {
            return Ok(flag.is_true().into());
        }
        if value.hasattr("__fspath__")? {
            let path: PathBuf = value.extract()?;
            let not_text = || PyValueError::new_err(format!("{name} must be a path of Unicode characters"));
            return Ok(path.to_str().ok_or_else(not_text)?.into());
        }
        if let Ok(table) = value.cast::<PyMapping>() {
            return self.table(name, table, kind);
        }
        match kind {
            Some(Kind::Document(_) | Kind::Table(_) | Kind::Tables(..) | Kind::Words(_) | Kind::Texts(_)) => {
                let form = match kind {
                    Some(Kind::Document(_)) => "a list of dicts, a dict, or the path of a file",
                    Some(Kind::Table(_)) => "a dict",
                    Some(Kind::Tables(..)) => "a list of dicts",
                    _ => "a text or a list of them",
                };
                let list =
                    value.try_iter().map_err(|_| PyTypeError::new_err(format!("{name} must be {form}")))?;
                let own = kind.map(|kind| Kind::Table(keys_of_elements(kind).to_vec()));
                let read = |(i, item): (usize, PyResult<Any<'py>>)| {
                    self.value(&format!("{name}[{i}]"), &item?, own.as_ref())
                };
                list.enumerate().map(read).collect::<PyResult<Vec<Value>>>().map(Value::from)
            }
            Some(Kind::Varied(_)) => {
                let numbers = Numbers::extract(name, value)?;
                if let Numbers::One(number) = numbers {
                    return Ok(number.into());
                }
                let place = Arc::new(self.arrays.len());
                self.arrays.push((name.to_owned(), numbers));
                Ok(Object { name: name.to_owned(), data: place }.into())
            }
            // A word may be one of digits
            Some(Kind::Word(_)) if value.is_instance_of::<PyInt>() => Ok(value.str()?.to_str()?.into()),
            _ => plain(name, value),
        }
    }

    fn table(&mut self, name: &str, table: &Bound<'py, PyMapping>, kind: Option<&Kind>) -> PyResult<Value> {
        let keys: &[Described] = match kind {
            Some(Kind::Document(keys) | Kind::Table(keys)) => keys,
            _ => &[],
        };
        let mut entries = Vec::new();
        for item in table.items()?.iter() {
            let (key, value): (Any<'py>, Any<'py>) = item.extract()?;
            let key: String = key.extract().map_err(|_| {
                let key = key.repr().map_or_else(|_| String::from("of no text"), |text| text.to_string());
                PyTypeError::new_err(format!("{name} has the key {key}, but keys are words"))
            })?;
            if value.is_none() {
                continue;
            }
            let kind = keys.iter().find(|known| known.name == key).map(|known| &known.kind);
            let value = self.value(&format!("{name}.{key}"), &value, kind)?;
            entries.push(Entry::new(&key, value));
        }
        Ok(entries.into())
    }
}

/// Puts arrays in the places that were left for them.
fn fill(value: &mut Value, columns: &[Arc<[f64]>]) {
    match &mut value.content {
        Content::List(values) => values.iter_mut().for_each(|value| fill(value, columns)),
        Content::Table(entries) => entries.iter_mut().for_each(|entry| fill(&mut entry.value, columns)),
        Content::Object(object) => {
            if let Some(place) = object.data.downcast_ref::<usize>() {
                value.content = Content::Numbers(Arc::clone(&columns[*place]));
            }
        }
        _ => {}
    }
}

/// The keys of the tables in a list; those of a document are the tables of its first such key.
fn keys_of_elements(kind: &Kind) -> &[Described] {
    match kind {
        Kind::Tables(keys, _) => keys,
        Kind::Document(keys) => {
            keys.iter().map(|key| keys_of_elements(&key.kind)).find(|keys| !keys.is_empty()).unwrap_or(&[])
        }
        _ => &[],
    }
}

/// A number or an array of numbers that all elements share.
fn plain(name: &str, value: &Any<'_>) -> PyResult<Value> {
    if value.is_instance_of::<PyInt>() {
        let digits = value.str()?;
        let number = digits.to_str()?.parse::<i128>().map(Content::Integer);
        return number
            .map(Value::from)
            .map_err(|_| PyValueError::new_err(format!("{name} is an integer that is too large")));
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(number.value().into());
    }
    match Numbers::extract(name, value)? {
        Numbers::One(number) => Ok(number.into()),
        numbers if numbers.shape().len() == 1 => Ok(Value::list(&numbers.broadcast(numbers.shape()))),
        numbers => Ok(Content::Numbers(numbers.broadcast(numbers.shape()).into()).into()),
    }
}

/// The question of a name.
pub(crate) fn question(name: &str) -> PyResult<&'static dyn Ask> {
    let found = QUESTIONS.into_iter().find(|question| question.name() == name);
    found.ok_or_else(|| PyValueError::new_err(format!("there is no question {name:?}")))
}

/// The answer to a question, while Python looks after signals; `renamed` are paths and what the caller calls them.
pub(crate) fn answer(
    py: Python<'_>,
    question: &'static dyn Ask,
    said: &Said<'_>,
    threads: Option<usize>,
    progress: Option<&Any<'_>>,
    renamed: &[(&str, &str)],
) -> PyResult<Answer> {
    let wrong = |error: Error| {
        let path = error.place.as_ref().map(|place| place.path.as_os_str());
        let is_in_file = path.is_some_and(|path| !path.is_empty());
        let error = Error { place: error.place.filter(|_| is_in_file), ..error };
        let name = |text: String, (path, name): &(&str, &str)| text.replace(path, name);
        PyValueError::new_err(renamed.iter().fold(error.to_string(), name))
    };
    let prepared = question.read(&Provenance::part(""), said.entries()).map_err(wrong)?;
    let (pool, done) = (pool(threads)?, Arc::new(AtomicU64::new(0)));
    let call = format!("translucid.{}", question.name());
    let counter = Arc::clone(&done);
    with_progress(py, progress, question.name(), "part", |progress| {
        let work = move |stop: &std::sync::atomic::AtomicBool| {
            let count = |part: f64| _ = counter.fetch_max((part * STEPS as f64) as u64, Ordering::Relaxed);
            pool.install(|| prepared.answer(&Control { call: &call, stop, progress: &count }))
        };
        let answer = long_work::run_or_abandon(py, work, |_| {
            report(progress, done.load(Ordering::Relaxed).min(STEPS - 1), STEPS)
        })?;
        report(progress, STEPS, STEPS)?;
        answer.map_err(|reason| match reason {
            Unanswered::Input(error) => wrong(error),
            Unanswered::Work(error) => wrong(error),
            Unanswered::Stopped => PyRuntimeError::new_err("the work was stopped"),
        })
    })
}

/// A column of the first table: numbers as an array, in the arguments' shape where there is a row for each element, or words
/// as a list.
pub(crate) fn column<'py>(
    py: Python<'py>,
    said: &Said<'py>,
    table: &DataTable,
    column: usize,
    is_by_element: bool,
) -> PyResult<Any<'py>> {
    if table.rows.iter().any(|row| matches!(row.get(column), Some(Cell::Word(_)))) {
        let word = |row: &Vec<Cell>| match row.get(column) {
            Some(Cell::Word(word)) => word.clone(),
            _ => String::new(),
        };
        return Ok(table.rows.iter().map(word).collect::<Vec<String>>().into_pyobject(py)?.into_any());
    }
    let numbers = table.numbers(column);
    if is_by_element {
        return said.array(py, &[], numbers);
    }
    array_like(py, &[], &[numbers.len()], numbers)
}

/// Answers the question of a name: columns of its first table, its text, files, notes and warnings.
#[pyfunction]
#[pyo3(signature = (name, arguments, threads=None, progress=None))]
pub(crate) fn _ask<'py>(
    py: Python<'py>,
    name: &str,
    arguments: &Bound<'py, PyDict>,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let question = question(name)?;
    let keys = question.keys();
    let arguments: HashMap<String, Any<'py>> = arguments.extract()?;
    let mut arguments: Vec<(&str, Any<'py>)> =
        arguments.iter().map(|(name, value)| (name.as_str(), value.clone())).collect();
    arguments.sort_by_key(|(name, _)| keys.iter().position(|key| key.name == *name));
    let said = Said::new(&keys, &arguments)?;
    let answer = answer(py, question, &said, threads, progress, &[])?;
    let (found, columns) = (PyDict::new(py), PyDict::new(py));
    if let Some(table) = answer.tables.first() {
        for (i, named) in table.columns.iter().enumerate() {
            columns.set_item(&*named.name, column(py, &said, table, i, question.about().is_by_element)?)?;
        }
    }
    found.set_item("columns", columns)?;
    let files = PyDict::new(py);
    for file in &answer.files {
        files.set_item(&file.name, PyBytes::new(py, &file.bytes))?;
    }
    found.set_item("files", files)?;
    found.set_item("text", &answer.text)?;
    found.set_item("notes", [&answer.notes[..], &answer.remarks].concat())?;
    found.set_item("warnings", &answer.warnings)?;
    Ok(found)
}

/// Wrong questions of every question, for tests: its name, what is said, and the key whose value is wrong.
#[pyfunction]
pub(crate) fn _wrong_questions(
    py: Python<'_>,
) -> PyResult<Vec<(&'static str, Bound<'_, PyDict>, &'static str)>> {
    let mut all = Vec::new();
    for question in QUESTIONS {
        for wrong in translucid_desk::wrong::wrong(question) {
            let said = PyDict::new(py);
            wrong.said.iter().try_for_each(|entry| said.set_item(&entry.key, object(py, &entry.value)?))?;
            all.push((question.name(), said, wrong.key));
        }
    }
    Ok(all)
}

/// A value as an object of Python's.
fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Any<'py>> {
    Ok(match &value.content {
        Content::Flag(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        Content::Integer(n) => n.into_pyobject(py)?.into_any(),
        Content::Float(x) => PyFloat::new(py, *x).into_any(),
        Content::Text(text) => PyString::new(py, text).into_any(),
        Content::List(list) => {
            list.iter().map(|value| object(py, value)).collect::<PyResult<Vec<_>>>()?.into_pyobject(py)?
        }
        Content::Table(entries) => {
            let table = PyDict::new(py);
            entries.iter().try_for_each(|entry| table.set_item(&entry.key, object(py, &entry.value)?))?;
            table.into_any()
        }
        Content::Numbers(_) | Content::Object(_) | Content::Other(_) => py.None().into_bound(py),
    })
}
