//! The door for Python: keyword arguments as values, arrays among them as images.

use std::sync::Arc;

use numpy::{PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use translucid_load::Piece;
use translucid_scene::description::{Content, Entry, Value, image_value};
use translucid_scene::{ColorSpace, Image, Pixels};

use crate::arrays::{Any, Numbers, Rule};
use crate::scene_error::{in_scene, scene_error, wrong};

/// Most values of a list: sixteen are the longest that a key takes, but for [`PLACES`].
const LONGEST_LIST: usize = 64;

/// The key of an object's places, of which there may be many: a list of tables, or an array of matrices.
const PLACES: &str = "transforms";

/// Lists and tables within each other that a value may have.
const DEEPEST: usize = 8;

/// Keyword arguments on their way to a [`Piece`].
pub(crate) struct Keys<'a> {
    piece: Piece,
    /// Number of images that the scene has been given so far: each has a name of its own.
    image_count: &'a mut usize,
}

impl<'a> Keys<'a> {
    /// A piece without keys, of this name in messages.
    pub(crate) fn new(title: &str, image_count: &'a mut usize) -> Self {
        Self { piece: Piece::new(title, Vec::new()), image_count }
    }

    /// Adds a text.
    pub(crate) fn text(mut self, key: &str, value: &str) -> Self {
        self.piece.entries.push(Entry::new(key, value));
        self
    }

    /// Adds all keyword arguments but those that are `None`.
    pub(crate) fn arguments(mut self, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        for (key, value) in keys.into_iter().flatten() {
            let key: String = name_of(&self.piece.title, &key)?;
            if !value.is_none() {
                let value = self.value(&key, &value, 0)?;
                self.piece.entries.push(Entry::new(&key, value));
            }
        }
        Ok(self)
    }

    pub(crate) fn piece(self) -> Piece {
        self.piece
    }

    fn value(&mut self, name: &str, value: &Any<'_>, depth: usize) -> PyResult<Value> {
        if depth > DEEPEST {
            return Err(self.wrong(name, "has too many lists and tables within each other"));
        }
        if let Ok(text) = value.cast::<PyString>() {
            let text = text.to_str().map_err(|_| self.wrong(name, "must be text of Unicode characters"))?;
            Ok(text.into())
        } else if let Ok(flag) = value.cast::<PyBool>() {
            Ok(flag.is_true().into())
        } else if value.is_instance_of::<PyInt>() {
            // `str` refuses thousands of digits
            let digits = value.str().map_err(|_| self.wrong(name, "is an integer that is too large"))?;
            let digits = digits.to_str()?;
            let number = digits.parse().map(Content::Integer);
            let too_large = |_| self.wrong(name, &format!("is {digits:.20}…, which is too large"));
            number.map(Value::from).map_err(too_large)
        } else if let Ok(number) = value.cast::<PyFloat>() {
            Ok(number.value().into())
        } else if let Ok(dict) = value.cast::<PyDict>() {
            self.table(name, dict, depth)
        } else if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
            self.list(name, value, depth)
        } else if value.hasattr("__array__")? {
            self.array(name, value, depth)
        } else if value.hasattr("__fspath__")? {
            let path: std::path::PathBuf = value.extract()?;
            let path =
                path.to_str().ok_or_else(|| self.wrong(name, "must be a path of Unicode characters"))?;
            Ok(path.into())
        } else {
            let kind = value.get_type().name()?;
            let title = &self.piece.title;
            Err(PyTypeError::new_err(format!(
                "{title}: {name} is of type {kind}, but must be a number, a text, a list, a table or an array"
            )))
        }
    }

    fn list(&mut self, name: &str, list: &Any<'_>, depth: usize) -> PyResult<Value> {
        let length = list.len()?;
        if length > LONGEST_LIST && name != PLACES {
            let message =
                format!("has {length} values, but may have {LONGEST_LIST}; an image must be an array");
            return Err(self.wrong(name, &message));
        }
        let elements = list.try_iter()?.enumerate();
        let values: PyResult<Vec<Value>> =
            elements.map(|(i, element)| self.value(&format!("{name}[{i}]"), &element?, depth + 1)).collect();
        Ok(values?.into())
    }

    fn table(&mut self, name: &str, dict: &Bound<'_, PyDict>, depth: usize) -> PyResult<Value> {
        let mut entries = Vec::new();
        for (key, value) in dict {
            let key = name_of(&self.piece.title, &key)?;
            if value.is_none() {
                continue;
            }
            let path = format!("{name}.{key}");
            entries.push(if key == "image" && value.hasattr("__array__")? {
                Entry::new("file", self.image(&path, &value)?)
            } else {
                Entry::new(&key, self.value(&path, &value, depth + 1)?)
            });
        }
        Ok(entries.into())
    }

    /// A scalar, a list of numbers, the sixteen of a matrix, or an image.
    fn array(&mut self, name: &str, value: &Any<'_>, depth: usize) -> PyResult<Value> {
        let array = value.py().import("numpy")?.call_method1("asarray", (value,))?;
        let dimensions: usize = array.getattr("ndim")?.extract()?;
        match dimensions {
            0 | 1 => {
                let size: usize = array.getattr("size")?.extract()?;
                if size > LONGEST_LIST {
                    let message = format!("has {size} values, but may have {LONGEST_LIST}");
                    return Err(self.wrong(name, &message));
                }
                self.value(name, &array.call_method0("tolist")?, depth + 1)
            }
            _ if name == PLACES => self.matrices(&array),
            _ if name == "matrix" => self.value(name, &array.call_method0("ravel")?, depth + 1),
            _ if name == "file" => self.image(name, &array),
            _ => Ok(vec![Entry::new("file", self.image(name, &array)?)].into()),
        }
    }

    /// An array of matrices as places.
    fn matrices(&self, array: &Any<'_>) -> PyResult<Value> {
        let shape: Vec<usize> = array.getattr("shape")?.extract()?;
        if shape.len() != 3 || shape[1..] != [4, 4] {
            let message = format!("has the shape {shape:?}, but an array of places must have (n, 4, 4)");
            return Err(self.wrong(PLACES, &message));
        }
        let numbers: Vec<f64> = Numbers::extract(PLACES, array)?.iter().collect();
        let place = |matrix: &[f64]| Value::from(vec![Entry::new("matrix", Value::list(matrix))]);
        Ok(numbers.chunks_exact(16).map(place).collect::<Vec<_>>().into())
    }

    /// An image, in the place of the path of a file.
    fn image(&mut self, name: &str, array: &Any<'_>) -> PyResult<Value> {
        let image_name = format!("array {} ({}, {name})", *self.image_count, self.piece.title);
        let wrong = |message: String| self.wrong(name, &message);
        let shape: Vec<usize> = array.getattr("shape")?.extract()?;
        let (height, width, channels) = match shape[..] {
            [height, width] => (height, width, 1),
            [height, width, channels @ (1 | 3 | 4)] => (height, width, channels),
            _ => {
                let message = format!(
                    "has the shape {shape:?}, but an image must have (height, width), (height, width, 3) or (height, width, 4)"
                );
                return Err(wrong(message));
            }
        };
        let longest = Image::LONGEST_EDGE;
        if !(1..=longest).contains(&width) || !(1..=longest).contains(&height) {
            return Err(wrong(format!(
                "is {width} pixels wide and {height} high, but both must be in [1, {longest}]"
            )));
        }
        if width * height > Image::MOST_PIXELS {
            return Err(wrong(format!("has {} pixels, but may have {}", width * height, Image::MOST_PIXELS)));
        }
        let pixels = if let Ok(bytes) = array.cast::<PyArrayDyn<u8>>() {
            let bytes = bytes.try_readonly()?;
            Pixels::Byte(four_channels(bytes.as_array().iter().copied(), channels, 255))
        } else {
            let dtype = array.getattr("dtype")?;
            if dtype.getattr("kind")?.extract::<String>()? != "f" {
                let message = format!(
                    "{name} is an image of dtype {dtype}, but must be one of uint8 or of floating-point numbers"
                );
                return Err(PyTypeError::new_err(message));
            }
            let numbers = Numbers::extract(name, array)?;
            let most = f64::from(f32::MAX);
            numbers
                .require(&Rule::new(name, "finite in single precision", -most, most))
                .map_err(|error| in_scene(&self.piece.title, error, array.py()))?;
            Pixels::Float(four_channels(numbers.iter().map(|x| x as f32), channels, 1.0))
        };
        *self.image_count += 1;
        let (width, height) = (width as u32, height as u32);
        // The key that names it says which color space bytes have
        let color_space = ColorSpace::Linear;
        let image = Image { name: image_name, path: None, width, height, color_space, pixels };
        Ok(image_value(Arc::new(image)).into())
    }

    fn wrong(&self, name: &str, message: &str) -> PyErr {
        wrong(&self.piece.title, &format!("{name} {message}"))
    }
}

/// Pixels of red, green, blue and alpha.
fn four_channels<T: Copy>(values: impl Iterator<Item = T>, channels: usize, opaque: T) -> Vec<[T; 4]> {
    let mut values = values;
    let mut pixels = Vec::new();
    while let Some(first) = values.next() {
        let mut next = || values.next().unwrap_or(opaque);
        pixels.push(match channels {
            1 => [first, first, first, opaque],
            3 => [first, next(), next(), opaque],
            _ => [first, next(), next(), next()],
        });
    }
    pixels
}

/// A key as text.
fn name_of(title: &str, key: &Any<'_>) -> PyResult<String> {
    key.extract().map_err(|_| PyTypeError::new_err(format!("{title}: a key is {key}, but must be text")))
}

/// Reads keyword arguments.
pub(crate) fn piece_of(title: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Piece> {
    Ok(Keys::new(title, &mut 0).arguments(keys)?.piece())
}

/// Reads keyword arguments that bring no images.
pub(crate) fn plain_piece_of(title: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Piece> {
    let piece = piece_of(title, keys)?;
    if !piece.has_images() {
        return Ok(piece);
    }
    Err(scene_error(translucid_scene::SceneError::new(format!("{title} takes no images"))))
}

/// Reads keyword arguments of a thing with a name.
pub(crate) fn named_piece_of(title: &str, name: &str, keys: Option<&Bound<'_, PyDict>>) -> PyResult<Piece> {
    Ok(Keys::new(title, &mut 0).text("name", name).arguments(keys)?.piece())
}
