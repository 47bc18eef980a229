//! `translucid.measure`.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::{PyKeyboardInterrupt, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use translucid_load::load_image;
use translucid_measure::{
    Card, Experiment, MeasureError, Measurement, NamedPhoto, Options, Photo, Photographs, Quantity, Remark,
    SceneFit, SceneOptions, Setup, StepEnd, Unknown, spelled,
};
use translucid_render::Session;
use translucid_scene::{ColorSpace, SceneError};

use crate::arrays::{Any, Numbers};
use crate::pictures::Pixels;
use crate::reference::{pool, report, with_progress};
use crate::scene::{picture_options, scene_of, whole_number, whole_numbers};
use crate::scene_error::scene_error;
use crate::{long_work, names};

/// Largest coordinate of a pixel.
const MOST_PIXELS: u32 = 1 << 20;

/// Most samples per pixel.
const MOST_SAMPLES: u64 = 1 << 24;

/// Most threads.
const MOST_THREADS: u64 = 1024;

/// A quantity: channel, name, unit, value, ends of the intervals of 68 % and of 95 %.
type Row = (Option<usize>, &'static str, &'static str, f64, [f64; 2], [f64; 2]);

/// What a measurement found and chose, its notes, and its warnings.
#[derive(Default)]
struct Remarks([Vec<String>; 3]);

impl Remarks {
    fn push(&mut self, remark: &Remark) {
        let kind = match remark {
            Remark::Finding(_) => 0,
            Remark::Note(_) => 1,
            Remark::Warning(_) => 2,
        };
        self.0[kind].push(argument_names(remark.text()));
    }
}

/// A text in which options are called as the arguments are.
fn argument_names(text: &str) -> String {
    spelled(text, str::to_owned)
}

fn exception(MeasureError { message, place, help }: MeasureError) -> PyErr {
    let (message, help) = (argument_names(&message), help.map(|help| argument_names(&help)));
    scene_error(SceneError { message, place, help })
}

fn row(Quantity { channel, name, unit, interval }: Quantity) -> Row {
    // No interval ends farther off than a number can be
    let finite = |ends: [f64; 2]| ends.map(|end| end.clamp(-f64::MAX, f64::MAX));
    (channel, name, unit, interval.value, finite(interval.likely), finite(interval.sure))
}

/// Measures photographs of an edge of light, a spot or a slab; `keys` are the arguments of `translucid.measure`.
#[pyfunction]
pub(crate) fn _measure<'py>(py: Python<'py>, keys: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyDict>> {
    let options = options(keys)?;
    let color_space = color_space(keys)?;
    let photo = |name: &'static str| get(keys, name)?.map(|object| Source::of(name, &object)).transpose();
    let missing = || PyTypeError::new_err("photo is missing");
    let (photo, dark, white) = (photo("photo")?.ok_or_else(missing)?, photo("dark")?, photo("white_photo")?);
    let exposures = match get(keys, "exposure")? {
        None => Vec::new(),
        Some(all) => all.try_iter()?.map(|one| Source::of("exposure", &one?)).collect::<PyResult<_>>()?,
    };
    let (measured, remarks) = long_work::run_or_leave(py, move || {
        let mut remarks = Remarks::default();
        let mut load = |source: Source| source.load(color_space, &mut |remark| remarks.push(&remark));
        let photographs = (|| {
            Ok::<_, MeasureError>(Photographs {
                photo: load(photo)?,
                exposures: exposures.into_iter().map(&mut load).collect::<Result<_, _>>()?,
                dark: dark.map(&mut load).transpose()?,
                white: white.map(&mut load).transpose()?,
            })
        })();
        let measured = photographs.and_then(|photographs| {
            Experiment::new(options)?.measure(photographs, &mut |remark| remarks.push(&remark))
        });
        (measured, remarks)
    })?;
    let measurement = measured.map_err(exception)?;
    let result = result(py, measurement.quantities(), remarks)?;
    figures(&result, &measurement)?;
    Ok(result)
}

/// Fits a material of a scene to a photograph; `keys` are the arguments of `translucid.measure`.
#[pyfunction]
#[pyo3(signature = (keys, progress=None))]
pub(crate) fn _measure_scene<'py>(
    py: Python<'py>,
    keys: &Bound<'py, PyDict>,
    progress: Option<&Any<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let options = scene_options(keys)?;
    let number = |name: &str, least: u64, most: u64| {
        get(keys, name)?.map(|object| whole_number(name, &object, least, most)).transpose()
    };
    let (spp, pool) = (
        number("spp", 1, MOST_SAMPLES)?,
        pool(number("threads", 1, MOST_THREADS)?.map(|threads| threads as usize))?,
    );
    let missing = || PyTypeError::new_err("scene and photo are missing");
    let subsurface = text(keys, "subsurface")?;
    let scene = get(keys, "scene")?.ok_or_else(missing)?;
    let mut scene = scene_of(&scene, picture_options(None, subsurface.as_deref())?)?;
    scene.integrator.samples_per_pixel = spp.map_or(scene.integrator.samples_per_pixel, |spp| spp as u32);
    let photo = Source::of("photo", &get(keys, "photo")?.ok_or_else(missing)?)?;
    let color_space = color_space(keys)?;
    let mut remarks = Remarks::default();
    let fit = pool.install(|| {
        let photo = photo.load(color_space, &mut |remark| remarks.push(&remark))?;
        let pixels = translucid_image::PixelRect::whole([scene.film.width, scene.film.height]);
        Session::require_memory(&scene, pixels, Session::BYTES_PER_PIXEL)?;
        SceneFit::new(&photo, scene, &options)
    });
    let mut fit = fit.map_err(exception)?;
    let (done, total) = (AtomicU64::new(0), AtomicU64::new(1));
    let mut end = Ok(StepEnd::Moved);
    with_progress(py, progress, "measure", "paths", |progress| {
        long_work::run(
            py,
            |stop| {
                let count = |paths: u64, expected: u64| {
                    done.store(paths, Ordering::Relaxed);
                    total.store(expected, Ordering::Relaxed);
                };
                while matches!(end, Ok(StepEnd::Moved)) {
                    end = pool.install(|| fit.step(&count, stop));
                }
            },
            |_| report(progress, done.load(Ordering::Relaxed), total.load(Ordering::Relaxed)),
        )
    })?;
    if end.map_err(exception)? == StepEnd::Stopped {
        return Err(PyKeyboardInterrupt::new_err(()));
    }
    fit.limitations().into_iter().for_each(|limit| remarks.push(&limit));
    let result = result(py, fit.quantities(), remarks)?;
    let guess = fit.guess();
    material(&result, guess.surface_albedo, guess.mfp)?;
    result.set_item("steps", fit.progress().steps)?;
    Ok(result)
}

fn result(py: Python<'_>, quantities: Vec<Quantity>, remarks: Remarks) -> PyResult<Bound<'_, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("rows", quantities.into_iter().map(row).collect::<Vec<Row>>())?;
    let [findings, notes, warnings] = remarks.0;
    result.set_item("findings", findings)?;
    result.set_item("notes", notes)?;
    result.set_item("warnings", warnings)?;
    Ok(result)
}

/// Adds what is known of a fit beside its quantities.
fn figures(result: &Bound<'_, PyDict>, measurement: &Measurement) -> PyResult<()> {
    let channels = measurement.fit.channels.each_ref();
    result.set_item("is_seen", channels.map(|channel| channel.is_seen))?;
    result.set_item("stray_light", channels.map(|channel| channel.stray))?;
    result.set_item("correlation", channels.map(|channel| channel.correlation))?;
    result.set_item("blur", measurement.fit.blur)?;
    result.set_item("misfit", measurement.fit.misfit.sqrt())?;
    material(result, measurement.surface_albedos(), measurement.mfps())
}

fn material(result: &Bound<'_, PyDict>, surface_albedo: [f64; 3], mfp: [f64; 3]) -> PyResult<()> {
    let material = PyDict::new(result.py());
    material.set_item("subsurface_weight", 1.0)?;
    material.set_item("subsurface_color", surface_albedo)?;
    material.set_item("subsurface_radius", 1.0)?;
    material.set_item("subsurface_radius_scale", mfp)?;
    result.set_item("material", material)
}

/// A photograph before it is read.
enum Source {
    File(PathBuf),
    Pixels(NamedPhoto),
}

impl Source {
    fn of(name: &str, object: &Any<'_>) -> PyResult<Self> {
        if object.is_instance_of::<PyString>() || object.hasattr("__fspath__")? {
            return Ok(Self::File(object.extract()?));
        }
        let pixels = Pixels::extract(name, object)?.require_color(name)?;
        let view = pixels.view();
        let (height, width, _) = view.dim();
        let photo = Photo::from_fn(width, height, |x, y| [0, 1, 2].map(|c| view[[y, x, c]]));
        Ok(Self::Pixels(NamedPhoto { name: name.to_owned(), photo }))
    }

    fn load(self, color_space: ColorSpace, say: &mut dyn FnMut(Remark)) -> Result<NamedPhoto, MeasureError> {
        match self {
            Self::Pixels(photo) => Ok(photo),
            Self::File(path) => {
                let mut warnings = Vec::new();
                let image = load_image(&path, color_space, &mut warnings)?;
                warnings.iter().for_each(|warning| say(Remark::Warning(warning.to_string())));
                Ok(NamedPhoto::from_image(path.display().to_string(), &image, say))
            }
        }
    }
}

fn scene_options(keys: &Bound<'_, PyDict>) -> PyResult<SceneOptions> {
    let unknowns: Vec<String> = match get(keys, "fit")? {
        Some(one) if one.is_instance_of::<PyString>() => vec![one.extract()?],
        Some(all) => all.extract().map_err(|_| PyTypeError::new_err("fit must be names of parameters"))?,
        None => return Err(PyTypeError::new_err("fit is missing: the parameters to find in the scene")),
    };
    Ok(SceneOptions {
        unknowns: Unknown::of_names(&unknowns).map_err(exception)?,
        material: text(keys, "material")?,
        region: rectangle(keys, "region")?,
        seed: get(keys, "seed")?.map_or(Ok(0), |seed| whole_number("seed", &seed, 0, u64::MAX))?,
    })
}

fn options(keys: &Bound<'_, PyDict>) -> PyResult<Options> {
    let word = |name: &str, known: &[&str]| -> PyResult<Option<usize>> {
        let Some(text) = text(keys, name)? else { return Ok(None) };
        let found = known.iter().position(|word| *word == text);
        found.map(Some).ok_or_else(|| names::unknown(name, &text, known))
    };
    Ok(Options {
        setup: [Setup::Edge, Setup::Spot, Setup::Slab]
            [word("setup", &["edge", "spot", "slab"])?.unwrap_or(0)],
        thickness: numbers::<1>(keys, "thickness")?.map(|[x]| x),
        mm_per_pixel: numbers::<1>(keys, "mm_per_pixel")?.map(|[x]| x),
        ruler: numbers(keys, "ruler")?,
        white: rectangle(keys, "white")?,
        white_reflectance: channels(keys, "white_reflectance")?,
        white_tolerance: numbers::<1>(keys, "white_tolerance")?.map(|[x]| x),
        surface_albedo: channels(keys, "surface_albedo")?,
        region: rectangle(keys, "region")?,
        edge: numbers(keys, "edge")?,
        center: numbers(keys, "center")?,
        card: word("card", &["hidden", "visible"])?.map(|i| [Card::Hidden, Card::Visible][i]),
        configuration: text(keys, "configuration")?.map(|name| names::configuration(&name)).transpose()?,
        incidence: numbers::<1>(keys, "incidence")?.map(|[x]| x),
        eta: numbers::<1>(keys, "eta")?.map_or(1.0, |[x]| x),
        g: numbers::<1>(keys, "g")?.map_or(0.0, |[x]| x),
    })
}

/// An argument that is given.
fn get<'py>(keys: &Bound<'py, PyDict>, name: &str) -> PyResult<Option<Any<'py>>> {
    Ok(keys.get_item(name)?.filter(|object| !object.is_none()))
}

fn text(keys: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<String>> {
    let wrong = |object: &Any<'_>| PyTypeError::new_err(format!("{name} is {object}, but must be a text"));
    get(keys, name)?.map(|object| object.extract().map_err(|_| wrong(&object))).transpose()
}

fn color_space(keys: &Bound<'_, PyDict>) -> PyResult<ColorSpace> {
    let is_linear = get(keys, "linear")?.map_or(Ok(false), |linear| linear.is_truthy())?;
    Ok(if is_linear { ColorSpace::Linear } else { ColorSpace::Srgb })
}

fn rectangle(keys: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<[usize; 4]>> {
    let must_be = "four numbers, x0, y0, x1, y1";
    let edges = get(keys, name)?.map(|object| whole_numbers(name, &object, must_be, [0, MOST_PIXELS]));
    Ok(edges.transpose()?.map(|edges| edges.map(|edge: u32| edge as usize)))
}

/// All numbers of an argument.
fn all_numbers(keys: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<Vec<f64>>> {
    let Some(object) = get(keys, name)? else { return Ok(None) };
    Ok(Some(Numbers::extract(name, &object)?.iter().collect()))
}

/// One number, or one for each channel.
fn channels(keys: &Bound<'_, PyDict>, name: &str) -> PyResult<Vec<f64>> {
    all_numbers(keys, name).map(Option::unwrap_or_default)
}

/// So many numbers.
fn numbers<const N: usize>(keys: &Bound<'_, PyDict>, name: &str) -> PyResult<Option<[f64; N]>> {
    let Some(numbers) = all_numbers(keys, name)? else { return Ok(None) };
    let count = numbers.len();
    let wrong = |_| PyValueError::new_err(format!("{name} has {count} numbers, but must have {N}"));
    numbers.try_into().map(Some).map_err(wrong)
}
