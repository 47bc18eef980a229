//! `translucid.reference`: plane layers.

use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use translucid_desk::{Ask, LAYERS, stated_layers};
use translucid_profile::Configuration;
use translucid_reference::layers::{Grid, LayersTally, Quantity};
use translucid_reference::walk::Control;
use translucid_reference::{Estimate, Incidence};
use translucid_scene::Warning;
use translucid_words::{Cell, Provenance};

use crate::arrays::{Any, Numbers, Rule, array_like};
use crate::ask::{Said, answer, column};
use crate::photons::Photons;
use crate::reference::{pool, report, with_progress};
use crate::scene_error::warn;
use crate::{long_work, names};

const ANGLE: Rule<'_> = Rule::new("incidence_angle", "in [0, 90)", 0.0, 90.0_f64.next_down());

/// Passes on what the answer warns of.
fn warn_of(py: Python<'_>, messages: Vec<String>) -> PyResult<()> {
    let warnings = messages.into_iter().map(|message| Warning { message, place: None });
    warn(py, &warnings.collect::<Vec<_>>())
}

/// Media or a ground above and below layers.
struct Ends<'a, 'py> {
    eta_above: Option<&'a Any<'py>>,
    eta_below: Option<&'a Any<'py>>,
    ground_reflectance: Option<&'a Any<'py>>,
}

/// Paths of a document of layers, and what a caller calls them.
const RENAMED: [(&str, &str); 4] = [
    ("layers.layer[", "layers["),
    ("layers.above.eta", "eta_above"),
    ("layers.below.eta", "eta_below"),
    ("layers.below.reflectance", "ground_reflectance"),
];

/// Layers and what is around them, as a file states them.
fn document<'py>(py: Python<'py>, layers: &Any<'py>, ends: &Ends<'_, 'py>) -> PyResult<Any<'py>> {
    if ends.eta_above.or(ends.eta_below).or(ends.ground_reflectance).is_none() {
        return Ok(layers.clone());
    }
    let document = PyDict::new(py);
    document.set_item("layer", layers)?;
    let [above, below] = [PyDict::new(py), PyDict::new(py)];
    for (table, key, value) in [
        (&above, "eta", ends.eta_above),
        (&below, "eta", ends.eta_below),
        (&below, "reflectance", ends.ground_reflectance),
    ] {
        value.map_or(Ok(()), |value| table.set_item(key, value))?;
    }
    for (key, table) in [("above", above), ("below", below)] {
        if !table.is_empty() {
            document.set_item(key, table)?;
        }
    }
    Ok(document.into_any())
}

/// How light arrives: as a beam along the normal unless something else is said, as in the command.
fn incidence(configuration: Option<&str>, angle: Option<&Any<'_>>) -> PyResult<Incidence> {
    let Some(angle) = angle else {
        return match configuration {
            Some(name) => names::configuration(name).map(Incidence::from),
            None => Ok(Incidence::NORMAL),
        };
    };
    if configuration.map(names::configuration).transpose()? == Some(Configuration::Diffuse) {
        return Err(PyValueError::new_err(
            "incidence_angle belongs to a beam, but configuration is \"diffuse\"",
        ));
    }
    let degrees = Numbers::extract(ANGLE.name, angle)?.single(&ANGLE)?;
    Ok(Incidence::Pencil { cos_theta: degrees.to_radians().cos() })
}

/// Makes a tuple with names of `translucid.reference`.
fn named<'py>(py: Python<'py>, class: &str, fields: Vec<Any<'py>>) -> PyResult<Any<'py>> {
    py.import("translucid.reference")?.getattr(class)?.call1(PyTuple::new(py, fields)?)
}

/// What plane layers reflect, transmit and absorb, to 1e-6.
///
/// Parameters
/// ----------
/// layers : list of dict
///     Layers from top to bottom.
///     Each has `scattering` and `absorption`, coefficients in any one inverse unit, or `surface_albedo` and `mfp`: the
///     share of diffuse light that an endless layer of its medium would return without a boundary, and its mean free path.
///     `thickness` may be left out in the last layer, which is endless then.
///     `g`, 0 by default, is the mean cosine of Henyey's and Greenstein's phase function, in (-1, 1); in its place
///     `moments` are Legendre moments 1, 2, ... of another, and `phase_function` is one as in `walk`.
///     `eta` is the index of refraction, 1 by default, in [0.1, 10].
///     All but these two may be arrays, such as one value per wavelength.
/// eta_above : array_like, default 1
///     Index of refraction of the medium that light comes from.
/// eta_below : array_like, optional
///     Index of refraction of the clear medium below; 1 by default if the last layer ends.
/// ground_reflectance : array_like, optional
///     In its place, the part of light that a ground in contact with the last layer returns by the cosine law, in [0, 1].
/// configuration : {"searchlight", "diffuse"}, optional
///     How light arrives: as a beam along the normal by default, from all directions, or with an `incidence_angle` as a
///     tilted beam.
/// incidence_angle : float, optional
///     Angle of a beam above, in degrees from the normal, in [0, 90).
/// tolerance : float, default 1e-6
///     Error below which no finer rule is tried, in [1e-12, 0.1]: many layers of many indices of refraction take minutes to
///     1e-6, and a third of that or less to 0.01.
/// threads : int, optional
///     Number of threads; by default one per processor.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the parts done and the parts in all, and an exception ends the
///     call; True for a bar.
///
/// Returns
/// -------
/// LayersTotals
///     Parts of the light that arrives, of the shape to which all arguments broadcast; they sum to 1.
///
/// Raises
/// ------
/// ValueError
///     If a layer lacks a key, a parameter is outside its range, or shapes do not broadcast.
/// TypeError
///     If an argument is no number.
///
/// Notes
/// -----
/// Discrete directions in each layer (S. Chandrasekhar 1950, *Radiative Transfer*), joined by adding (H. C. van de Hulst
/// 1963, *A new look at multiple scattering*). Three layers take about a millisecond.
///
/// Examples
/// --------
/// >>> epidermis = dict(thickness=0.1, scattering=20.0, absorption=[0.5, 1.5], g=0.8, eta=1.4)
/// >>> dermis = dict(scattering=15.0, absorption=0.1, g=0.8, eta=1.4)
/// >>> totals = translucid.reference.layers([epidermis, dermis])
/// >>> totals.diffuse_reflectance.round(5)
/// array([0.35308, 0.23448])
/// >>> totals.absorbed.shape
/// (2, 2)
#[pyfunction]
#[pyo3(signature = (layers, *, eta_above=None, eta_below=None, ground_reflectance=None, configuration=None, incidence_angle=None, tolerance=None, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn layers<'py>(
    py: Python<'py>,
    layers: &Any<'py>,
    eta_above: Option<&Any<'py>>,
    eta_below: Option<&Any<'py>>,
    ground_reflectance: Option<&Any<'py>>,
    configuration: Option<&str>,
    incidence_angle: Option<&Any<'py>>,
    tolerance: Option<&Any<'py>>,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Any<'py>> {
    let ends = Ends { eta_above, eta_below, ground_reflectance };
    let mut arguments = vec![("layers", document(py, layers, &ends)?)];
    let optional = [
        ("configuration", configuration.map(|name| name.into_pyobject(py).map(Bound::into_any)).transpose()?),
        ("incidence_angle", incidence_angle.cloned()),
        ("tolerance", tolerance.cloned()),
    ];
    arguments.extend(optional.into_iter().filter_map(|(name, value)| Some((name, value?))));
    let said = Said::new(&LAYERS.keys(), &arguments)?;
    let answer = answer(py, &LAYERS, &said, threads, progress, &RENAMED)?;
    warn_of(py, answer.warnings)?;
    let table = &answer.tables[0];
    let last = table.columns.len() - 2;
    let layers = last - 4;
    let absorbed = (0..table.rows.len()).flat_map(|row| (4..last).map(move |column| (row, column)));
    let number = |(row, column): (usize, usize)| match &table.rows[row][column] {
        Cell::Number(number) => *number,
        Cell::Word(_) => f64::NAN,
    };
    let mut fields = (0..4).map(|i| column(py, &said, table, i, true)).collect::<PyResult<Vec<_>>>()?;
    fields.push(said.array(py, &[layers], absorbed.map(number).collect())?);
    fields.push(column(py, &said, table, last, true)?);
    fields.push(column(py, &said, table, last + 1, true)?);
    named(py, "LayersTotals", fields)
}

/// Light R(r) and T(r) that plane layers return and let through around a beam along the normal.
///
/// Light that was never scattered is no part of it.
///
/// Parameters
/// ----------
/// r : array_like
///     Distances from the beam, at least 0, in the unit of the layers' thickness.
/// layers : list of dict
///     Layers from top to bottom, as in `layers`.
/// eta_above, eta_below, ground_reflectance : array_like, optional
///     What is above and below, as in `layers`.
/// tolerance : float, default 1e-4
///     Error to aim at, in [1e-4, 0.1]: from 0.005 on a stack is solved two to six times faster.
///     The errors returned are estimates in either case.
/// threads : int, optional
///     Number of threads; by default one per processor.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the parts done and the parts in all, and an exception ends the
///     call; True for a bar.
///
/// Returns
/// -------
/// LayersProfile
///     Light per area and its numerical error, of the shape to which r and all else broadcast.
///     A stack takes some seconds; more radii cost little.
///
/// Raises
/// ------
/// ValueError
///     If a layer lacks a key, a parameter is outside its range, layers have no exact profile, or shapes do not broadcast.
/// TypeError
///     If an argument is no number.
///
/// Examples
/// --------
/// >>> coat = dict(thickness=0.1, scattering=50.0, absorption=0.1)
/// >>> wood = dict(scattering=10.0, absorption=1.0)
/// >>> profile = translucid.reference.layers_profile([0.01, 0.1, 1.0], [coat, wood])
/// >>> bool((profile.reflectance_error < 1e-4 * profile.reflectance).all())
/// True
#[pyfunction]
#[pyo3(signature = (r, layers, *, eta_above=None, eta_below=None, ground_reflectance=None, tolerance=None, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn layers_profile<'py>(
    py: Python<'py>,
    r: &Any<'py>,
    layers: &Any<'py>,
    eta_above: Option<&Any<'py>>,
    eta_below: Option<&Any<'py>>,
    ground_reflectance: Option<&Any<'py>>,
    tolerance: Option<&Any<'py>>,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Any<'py>> {
    let ends = Ends { eta_above, eta_below, ground_reflectance };
    let mut arguments = vec![("layers", document(py, layers, &ends)?), ("r", r.clone())];
    arguments.extend(tolerance.map(|tolerance| ("tolerance", tolerance.clone())));
    let said = Said::new(&LAYERS.keys(), &arguments)?;
    let answer = answer(py, &LAYERS, &said, threads, progress, &RENAMED)?;
    warn_of(py, answer.warnings)?;
    let columns = (1..5).map(|i| column(py, &said, &answer.tables[0], i, true)).collect::<PyResult<Vec<_>>>();
    named(py, "LayersProfile", columns?)
}

/// Walks photons through plane layers.
///
/// Parameters
/// ----------
/// photons : int
///     How many.
/// layers : list of dict
///     Layers from top to bottom, as in `layers`, each of numbers.
/// eta_above, eta_below, ground_reflectance : float, optional
///     What is above and below, as in `layers`.
/// absorptions : array_like, optional
///     Coefficients in place of the layers' own, a row for each set and a column for each layer: the same photons serve all
///     sets, with a weight for each, in less time than one after the other.
/// dr, dz : float, default 1
///     Width of rings and height of depths in which light is counted, in the unit of the layers' thickness.
/// nr, nz : int, default 1
///     Number of both; the last of each also counts what is beyond it.
/// configuration : {"searchlight", "diffuse"}, optional
///     How light arrives, as in `layers`.
/// incidence_angle : float, optional
///     Angle of a beam above, in degrees from the normal, in [0, 90).
/// seed : int, default 0
///     Same seed, same bits, for any number of threads.
/// threads : int, optional
///     Number of threads; by default one per processor.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the photons done and the photons in all, and an exception ends the call; True for a bar.
///
/// Returns
/// -------
/// LayersWalk, or a list of them with `absorptions`
///     Parts of the light that arrives, and densities, each with its standard error.
///     With `absorptions` errors of different sets go together, `absorption` is not a number unless there is one cell, and
///     specular light is what the first face reflects.
///
/// Raises
/// ------
/// ValueError
///     If a layer lacks a key, a parameter is outside its range, or moments make a phase function negative at some angle.
/// TypeError
///     If an argument is no number, or an array.
///
/// Notes
/// -----
/// Counts and cells are those of MCML (L. Wang, S. L. Jacques and L. Zheng 1995, *Comput. Methods Programs Biomed.* 47).
///
/// Examples
/// --------
/// >>> slab = dict(thickness=0.02, scattering=90.0, absorption=10.0, g=0.75)
/// >>> walk = translucid.reference.layers_walk(100_000, [slab], nr=10, dr=0.01)
/// >>> value, error = walk.reflected
/// >>> bool(abs(value - 0.09739) < 4 * error)
/// True
/// >>> walk.r[:3].round(3).tolist(), walk.reflectance[0].shape
/// ([0.005, 0.015, 0.025], (10,))
#[pyfunction]
#[pyo3(signature = (photons, layers, *, eta_above=None, eta_below=None, ground_reflectance=None, absorptions=None, dr=1.0, nr=1, dz=1.0, nz=1, configuration=None, incidence_angle=None, seed=0, threads=None, progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn layers_walk<'py>(
    py: Python<'py>,
    photons: &Any<'py>,
    layers: &Any<'py>,
    eta_above: Option<&Any<'py>>,
    eta_below: Option<&Any<'py>>,
    ground_reflectance: Option<&Any<'py>>,
    absorptions: Option<&Any<'py>>,
    dr: f64,
    nr: usize,
    dz: f64,
    nz: usize,
    configuration: Option<&str>,
    incidence_angle: Option<&Any<'py>>,
    #[pyo3(from_py_with = crate::photons::seed)] seed: u64,
    threads: Option<usize>,
    progress: Option<&Any<'py>>,
) -> PyResult<Any<'py>> {
    let Photons::Count(seed, photons) = Photons::extract(photons, seed)? else {
        return Err(PyTypeError::new_err("photons must be a whole number: layers are walked in one go"));
    };
    let incidence = incidence(configuration, incidence_angle)?;
    let ends = Ends { eta_above, eta_below, ground_reflectance };
    let arguments = [("layers", document(py, layers, &ends)?)];
    let said = Said::new(&LAYERS.keys(), &arguments)?;
    if let Some((name, shape)) = said.first_array() {
        let message = format!("{name} must be one number for a walk, but is an array of shape {shape:?}");
        return Err(PyTypeError::new_err(message));
    }
    let layers = stated_layers(&Provenance::part(""), said.entries()).map_err(|error| {
        let message = RENAMED.iter().fold(error.message, |text, (path, name)| text.replace(path, name));
        PyValueError::new_err(message)
    })?;
    warn_of(py, layers.warnings())?;
    let sets = absorptions.map(|argument| absorption_sets(argument, layers.layers().len())).transpose()?;
    let grid = Grid { dr, nr, dz, nz, na: 1 };
    let (pool, done) = (pool(threads)?, AtomicU64::new(0));
    let mut outcome = None;
    with_progress(py, progress, "walk", "photons", |progress| {
        long_work::run(
            py,
            |stop| {
                let count = |count: u64| done.store(count, Ordering::Relaxed);
                let control = Control { stop, progress: &count, ..Control::default() };
                outcome = Some(pool.install(|| match &sets {
                    Some(sets) => layers.walk_absorptions(sets, incidence, grid, photons, seed, &control),
                    None => layers.walk(incidence, grid, photons, seed, &control).map(|tally| vec![tally]),
                }));
            },
            |_| report(progress, done.load(Ordering::Relaxed), photons),
        )
    })?;
    let Some(tallies) = outcome.transpose().map_err(names::value_error)? else {
        return Err(PyValueError::new_err("nothing was walked"));
    };
    let results = tallies.iter().map(|tally| walked(py, tally)).collect::<PyResult<Vec<Any<'py>>>>()?;
    match sets {
        Some(_) => PyList::new(py, results).map(Bound::into_any),
        None => Ok(results.into_iter().next().unwrap_or_else(|| py.None().into_bound(py))),
    }
}

/// Coefficients of all layers by set.
fn absorption_sets(argument: &Any<'_>, layers: usize) -> PyResult<Vec<Vec<f64>>> {
    let numbers = Numbers::extract("absorptions", argument)?;
    let shape = numbers.shape().to_vec();
    if shape.len() != 2 || shape[1] != layers || shape[0] == 0 {
        return Err(PyValueError::new_err(format!(
            "absorptions has the shape {shape:?}, but must have a row for each walk and a column for each of {layers} layers"
        )));
    }
    Ok(numbers.broadcast(&shape).chunks_exact(layers).map(<[f64]>::to_vec).collect())
}

fn walked<'py>(py: Python<'py>, tally: &LayersTally) -> PyResult<Any<'py>> {
    let grid = *tally.grid();
    let one = |quantity| {
        let Estimate { value, error } = tally.total(quantity);
        (value, error).into_pyobject(py).map(Bound::into_any)
    };
    let many = |shape: &[usize], estimates: Vec<Estimate>| {
        let (values, errors): (Vec<f64>, Vec<f64>) =
            estimates.into_iter().map(|estimate| (estimate.value, estimate.error)).unzip();
        let pair = (array_like(py, &[], shape, values)?, array_like(py, &[], shape, errors)?);
        pair.into_pyobject(py).map(Bound::into_any)
    };
    let centers = |count: usize, step: f64| {
        array_like(py, &[], &[count], (0..count).map(|i| (i as f64 + 0.5) * step).collect())
    };
    let rings = |of: fn(&LayersTally, usize) -> Estimate| (0..grid.nr).map(|ring| of(tally, ring)).collect();
    let per_volume = |(place, Estimate { value, error }): (usize, Estimate)| {
        let volume = grid.ring_area(place / grid.nz) * grid.dz;
        Estimate { value: value / volume, error: error / volume }
    };
    let by_layer: Vec<Estimate> = tally.all(Quantity::AbsorbedByLayer).collect();
    let map = tally.all(Quantity::AbsorbedByRingAndDepth).enumerate().map(per_volume).collect();
    let fields = vec![
        tally.specular().into_pyobject(py)?.into_any(),
        one(Quantity::Reflected)?,
        one(Quantity::Transmitted)?,
        many(&[by_layer.len()], by_layer)?,
        one(Quantity::Ground)?,
        one(Quantity::Lost)?,
        centers(grid.nr, grid.dr)?,
        centers(grid.nz, grid.dz)?,
        many(&[grid.nr], rings(LayersTally::reflectance))?,
        many(&[grid.nr], rings(LayersTally::transmittance))?,
        many(&[grid.nr, grid.nz], map)?,
    ];
    named(py, "LayersWalk", fields)
}
