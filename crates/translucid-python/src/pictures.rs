//! Pictures as arrays: tone mapping, PNG, OpenEXR.

use std::path::PathBuf;

use numpy::ndarray::{ArrayView1, ArrayView3, ArrayViewD, Axis, Ix3};
use numpy::{IntoPyArray, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use translucid_image::{
    DisplayTransform, Picture, PictureChannel, Precision, ToneMapping, display_from_linear,
};
use translucid_load::load_exr;
use translucid_scene::Film;

use crate::arrays::Any;
use crate::long_work;
use crate::names;
use crate::scene_error::scene_error;

/// Most channels of a layer in a file.
const MOST_CHANNELS: usize = 4;

/// A picture as single-precision numbers of shape (height, width, channels).
pub(crate) struct Pixels<'py> {
    array: numpy::PyReadonlyArrayDyn<'py, f32>,
}

impl<'py> Pixels<'py> {
    /// The pixels of an argument; single precision as it lies, everything else as a copy.
    pub(crate) fn extract(name: &str, object: &Any<'py>) -> PyResult<Self> {
        let array = match object.cast::<PyArrayDyn<f32>>() {
            Ok(array) => array.clone(),
            Err(_) => {
                // It refuses what is not of real numbers, with a message that names the argument
                let numbers = crate::arrays::Numbers::extract(name, object)?;
                let numpy = object.py().import("numpy")?;
                drop(numbers);
                let array = numpy.call_method1("asarray", (object, "float32"))?;
                array.cast_into::<PyArrayDyn<f32>>()?
            }
        };
        let array = if array.ndim() == 2 {
            let [height, width] = [array.shape()[0], array.shape()[1]];
            array.reshape(numpy::ndarray::IxDyn(&[height, width, 1]))?
        } else {
            array
        };
        let shape = array.shape();
        let longest = 1 << 20;
        let is_picture = matches!(shape, [height, width, channels]
            if (1..=longest).contains(height) && (1..=longest).contains(width) && (1..=MOST_CHANNELS).contains(channels));
        if !is_picture {
            let message = format!(
                "{name} has the shape {shape:?}, but must have (height, width) or (height, width, channels) with 1 to {MOST_CHANNELS} channels"
            );
            return Err(PyValueError::new_err(message));
        }
        Ok(Self { array: array.try_readonly()? })
    }

    pub(crate) fn view(&self) -> ArrayView3<'_, f32> {
        let view: ArrayViewD<'_, f32> = self.array.as_array();
        view.into_dimensionality::<Ix3>().expect("a picture has three dimensions")
    }

    /// Refuses pictures without color.
    pub(crate) fn require_color(self, name: &str) -> PyResult<Self> {
        match self.array.shape()[2] {
            3 | 4 => Ok(self),
            channels => Err(PyValueError::new_err(format!(
                "{name} has {channels} channels, but must have 3 (red, green, blue) or 4 (and coverage)"
            ))),
        }
    }
}

/// The way to a display of these arguments.
fn display_transform(exposure: f64, tone_mapping: &str) -> PyResult<DisplayTransform> {
    let film = Film { exposure: exposure as f32, ..Film::default() };
    film.validate().map_err(|_| {
        PyValueError::new_err(format!("exposure is {exposure}, but must be a number of stops in [-100, 100]"))
    })?;
    let known = ToneMapping::WORDS.map(|(name, _)| name);
    let tone_mapping = ToneMapping::from_name(tone_mapping)
        .ok_or_else(|| names::unknown("tone_mapping", tone_mapping, &known))?;
    Ok(DisplayTransform { exposure: film.exposure, tone_mapping })
}

/// The picture of an array of colors, with coverage if there are four channels.
fn picture_of<'a>(view: &ArrayView3<'a, f32>) -> Picture<'a> {
    let view = *view;
    let (height, width, channels) = view.dim();
    let list = ["R", "G", "B", "A"][..channels].iter().map(|name| PictureChannel::single(name)).collect();
    Picture::new([width as u32, height as u32], list, move |y, values| {
        let row = view.index_axis(Axis(0), y as usize);
        values.iter_mut().zip(row.iter()).for_each(|(value, x)| *value = f64::from(*x));
    })
}

/// Display values of linear radiance, as the command's PNG files have them.
///
/// Parameters
/// ----------
/// array : array_like, shape (H, W, 3) or (H, W, 4)
///     Linear Rec. 709 radiance, multiplied by the coverage that a fourth channel is. NaN counts as 0.
/// exposure : float
///     Exposure in stops, in [-100, 100].
/// tone_mapping : {'neutral', 'agx', 'srgb'}
///     Khronos PBR Neutral, AgX, or clipped sRGB.
/// dtype : {'uint8', 'float32'}
///     Codes in 0 … 255, dithered so that smooth gradients have no steps; or sRGB-encoded values in [0, 1].
///
/// Returns
/// -------
/// numpy.ndarray
///     Of the same shape; the color is not multiplied by the coverage.
///
/// Raises
/// ------
/// ValueError
///     The array has another shape, or a value is not allowed.
///
/// Examples
/// --------
/// >>> translucid.tonemap(np.full((1, 1, 3), 0.18), tone_mapping="srgb", dtype="float32").round(4)
/// array([[[0.4614, 0.4614, 0.4614]]], dtype=float32)
#[pyfunction]
#[pyo3(signature = (array, *, exposure=0.0, tone_mapping="neutral", dtype="uint8"))]
pub(crate) fn tonemap<'py>(
    py: Python<'py>,
    array: &Any<'py>,
    exposure: f64,
    tone_mapping: &str,
    dtype: &str,
) -> PyResult<Any<'py>> {
    let display = display_transform(exposure, tone_mapping)?;
    let pixels = Pixels::extract("array", array)?.require_color("array")?;
    let view = pixels.view();
    let (height, width, channels) = view.dim();
    let shape = [height, width, channels];
    match dtype {
        "uint8" => {
            let codes = py.detach(|| {
                picture_of(&view).display_codes(display).map(|codes| match channels {
                    4 => codes,
                    _ => {
                        codes.as_chunks::<4>().0.iter().flat_map(|code| [code[0], code[1], code[2]]).collect()
                    }
                })
            });
            Ok(codes.map_err(names::value_error)?.into_pyarray(py).reshape(shape)?.into_any())
        }
        "float32" => {
            let values: Vec<f32> = py.detach(|| {
                let factor = display.exposure.exp2();
                let lanes = view.lanes(Axis(2));
                lanes
                    .into_iter()
                    .flat_map(|pixel| {
                        display_pixel(&pixel, factor, display.tone_mapping).into_iter().take(channels)
                    })
                    .collect()
            });
            Ok(values.into_pyarray(py).reshape(shape)?.into_any())
        }
        _ => Err(names::unknown("dtype", dtype, &["uint8", "float32"])),
    }
}

/// Display values of a pixel, and its coverage; 1 if it states none.
fn display_pixel(pixel: &ArrayView1<'_, f32>, factor: f32, tone_mapping: ToneMapping) -> [f32; 4] {
    let alpha = pixel.get(3).map_or(1.0, |alpha| if alpha.is_nan() { 0.0 } else { alpha.clamp(0.0, 1.0) });
    let scale = if alpha == 0.0 { 0.0 } else { factor / alpha };
    let [r, g, b] = display_from_linear(tone_mapping, [0, 1, 2].map(|c| pixel[c] * scale));
    [r, g, b, alpha]
}

/// The bytes of a PNG file of a picture.
#[pyfunction]
#[pyo3(signature = (array, *, exposure=0.0, tone_mapping="neutral"))]
pub(crate) fn png_bytes<'py>(
    py: Python<'py>,
    array: &Any<'py>,
    exposure: f64,
    tone_mapping: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let display = display_transform(exposure, tone_mapping)?;
    let pixels = Pixels::extract("array", array)?.require_color("array")?;
    let view = pixels.view();
    let mut bytes = Vec::new();
    py.detach(|| picture_of(&view).write_png(&mut bytes, display)).map_err(names::value_error)?;
    Ok(PyBytes::new(py, &bytes))
}

/// Writes a picture as an OpenEXR file.
///
/// The file is written beside its target and then takes its place: there is never half of one.
///
/// Parameters
/// ----------
/// path : path-like
///     The file.
/// picture : array_like or dict of array_like
///     An array of shape (H, W), (H, W, 1), (H, W, 3) or (H, W, 4): the channels Y, RGB or RGBA. Or layers by their
///     names, all of the same height and width: ``'radiance'`` becomes the channels RGB, ``'alpha'`` A, any other
///     ``name.R``, ``name.G`` …, ``normal.X`` …, ``depth.Z``, and a single channel that of the layer's name.
/// half : list of str
///     Layers that are written with 16 bits in place of 32.
///
/// Raises
/// ------
/// ValueError
///     A layer has another shape, or a name that no channel can have.
/// OSError
///     The file cannot be written.
///
/// Notes
/// -----
/// NaN becomes 0, infinity the greatest finite number.
#[pyfunction]
#[pyo3(signature = (path, picture, *, half=None))]
#[expect(clippy::needless_pass_by_value, reason = "as a path is taken from Python")]
pub(crate) fn write_exr(
    py: Python<'_>,
    path: PathBuf,
    picture: &Any<'_>,
    half: Option<Vec<String>>,
) -> PyResult<()> {
    let half = half.unwrap_or_default();
    let mut layers = Vec::new();
    if let Ok(dict) = picture.cast::<PyDict>() {
        for (name, array) in dict {
            let name: String = name.extract().map_err(|_| {
                PyTypeError::new_err(format!("a layer is called {name}, but must be called by a text"))
            })?;
            layers.push((name.clone(), Pixels::extract(&name, &array)?));
        }
    } else {
        layers.push((String::new(), Pixels::extract("picture", picture)?));
    }
    let Some((first, size)) = layers.first().map(|(name, pixels)| (name, pixels.view().dim())) else {
        return Err(PyValueError::new_err("picture has no layers, but must have at least one"));
    };
    let (height, width, _) = size;
    if let Some((name, other)) =
        layers.iter().find(|(_, other)| (other.view().dim().0, other.view().dim().1) != (height, width))
    {
        let (other_height, other_width, _) = other.view().dim();
        return Err(PyValueError::new_err(format!(
            "{name} has {other_width}x{other_height} pixels, but {first} has {width}x{height}"
        )));
    }
    if let Some(unknown) = half.iter().find(|name| layers.iter().all(|(layer, _)| layer != *name)) {
        return Err(PyValueError::new_err(format!("half names {unknown:?}, but there is no such layer")));
    }
    let mut channels = Vec::new();
    for (name, pixels) in &layers {
        let precision = if half.contains(name) { Precision::Half } else { Precision::Single };
        let names = channel_names(name, pixels.view().dim().2);
        channels.extend(names.into_iter().map(|name| PictureChannel { name, precision }));
    }
    let views: Vec<_> = layers.iter().map(|(_, pixels)| pixels.view()).collect();
    let count = channels.len();
    let saved = py.detach(|| {
        let fill_row = |y: u32, values: &mut [f64]| {
            for (x, pixel) in values.chunks_exact_mut(count).enumerate() {
                let all = views.iter().flat_map(|view| {
                    (0..view.dim().2).map(move |channel| f64::from(view[[y as usize, x, channel]]))
                });
                pixel.iter_mut().zip(all).for_each(|(value, x)| *value = x);
            }
        };
        let software = concat!("translucid ", env!("CARGO_PKG_VERSION"));
        let picture = Picture::new([width as u32, height as u32], channels, fill_row);
        picture.with_metadata(software, Vec::new()).save_exr(&path)
    });
    saved.map_err(|error| PyOSError::new_err(error.to_string()))
}

/// Names of the channels of a layer; that of an array alone is empty.
fn channel_names(layer: &str, count: usize) -> Vec<String> {
    let components = match (layer, count) {
        ("alpha", 1) => return vec![String::from("A")],
        ("depth", 1) => return vec![String::from("depth.Z")],
        ("", 1) => return vec![String::from("Y")],
        (_, 1) => return vec![layer.to_owned()],
        ("normal", 3) => ["X", "Y", "Z", "A"],
        (_, 2) => ["X", "Y", "", ""],
        _ => ["R", "G", "B", "A"],
    };
    let prefix = if matches!(layer, "" | "radiance") { String::new() } else { format!("{layer}.") };
    components[..count].iter().map(|component| format!("{prefix}{component}")).collect()
}

/// A channel of a layer: component and values.
type Channel = (String, Vec<f32>);

/// Reads all layers of an OpenEXR file.
///
/// Parameters
/// ----------
/// path : path-like
///     The file, of scan lines or tiles, uncompressed or with ZIP, ZIPS, RLE, PIZ, PXR24, B44 or DWA compression, in one
///     part or several.
///
/// Returns
/// -------
/// dict of numpy.ndarray
///     Layers of shape (H, W, channels), float32, as `write_exr` takes them: the channels R, G, B are ``'radiance'``,
///     A is ``'alpha'``, those with a common name before a dot the layer of that name; any other is a layer of its own.
///     Layers are called alike whether they are in one part or several. The pixels are those of the smallest window
///     around the data windows of all parts, 0 outside of a part's own.
///
/// Raises
/// ------
/// SceneError
///     The file cannot be read, is damaged, has another compression or deep data, or more than 32768 pixels along an
///     edge.
#[pyfunction]
pub(crate) fn read_exr(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let file = long_work::run_or_leave(py, move || load_exr(&path))?.map_err(scene_error)?;
    let [width, height] = file.size;
    let mut layers: Vec<(String, Vec<Channel>)> = Vec::new();
    for (name, values) in file.channels {
        let (layer, component) = match (name.rsplit_once('.'), name.as_str()) {
            (Some((layer, component)), _) => (layer, component),
            (None, "R" | "G" | "B") => ("radiance", name.as_str()),
            (None, "A") => ("alpha", "A"),
            (None, other) => (other, ""),
        };
        let channel = (component.to_owned(), values);
        match layers.iter_mut().find(|(other, _)| other == layer) {
            Some((_, channels)) => channels.push(channel),
            None => layers.push((layer.to_owned(), vec![channel])),
        }
    }
    let dict = PyDict::new(py);
    for (name, mut channels) in layers {
        // Cryptomatte's are r, g, b, a
        let order =
            |component: &str| "RGBXYZUVWA".find(&component.to_ascii_uppercase()).unwrap_or(usize::MAX);
        channels.sort_by_key(|(component, _)| order(component));
        let count = channels.len();
        let values = py.detach(|| {
            if count == 1 {
                return channels.pop().map(|(_, values)| values).unwrap_or_default();
            }
            let mut values = vec![0.0; width * height * count];
            for (c, (_, channel)) in channels.iter().enumerate() {
                values.iter_mut().skip(c).step_by(count).zip(channel).for_each(|(value, x)| *value = *x);
            }
            values
        });
        dict.set_item(name, values.into_pyarray(py).reshape([height, width, count])?)?;
    }
    Ok(dict)
}
