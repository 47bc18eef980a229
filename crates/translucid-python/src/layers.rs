//! `translucid.reference`: plane layers.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use pyo3::exceptions::{PyMemoryError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyMapping, PyTuple};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, Parameterization};
use translucid_reference::layers::{Grid, Ground, Layer, Layers, LayersError, LayersTally, Quantity, Totals};
use translucid_reference::walk::{Control, PhaseFunction};
use translucid_reference::{Estimate, Incidence};

use crate::arrays::{Any, Numbers, Rule, array_like, broadcast_shape};
use crate::phase_function::phase_function;
use crate::photons::Photons;
use crate::reference::{pool, report, with_progress};
use crate::{long_work, names};

const RADII: Rule<'_> = Rule::new("r", "greater than 0", f64::MIN_POSITIVE, f64::MAX);
const ANGLE: Rule<'_> = Rule::new("incidence_angle", "in [0, 89.99]", 0.0, 89.99);
/// Inversions by the bits of g: each takes some 0.1 s.
type Inversions = HashMap<u64, AlbedoInversion>;

/// Keys of a layer that have a number each.
const KEYS: [&str; 7] = ["thickness", "scattering", "absorption", "surface_albedo", "mfp", "g", "eta"];
/// Keys of a layer that have a phase function in the place of g.
const PHASE_FUNCTIONS: [&str; 2] = ["moments", "phase_function"];
/// Numbers that a call returns of each stack, beside what each layer absorbs.
const RESULTS: usize = 6;
/// Error of totals beyond which they are none.
const HOPELESS: f64 = 1e-2;

/// What a call says about layers, with arrays wherever it has them.
struct Stacks<'py> {
    /// Names as messages tell them, and numbers.
    arguments: Vec<(String, Numbers<'py>)>,
    layers: Vec<LayerKeys>,
    eta_above: usize,
    below: Below,
}

/// Places of a layer's numbers among all arguments, in the order of [`KEYS`], and its phase function where g is none.
struct LayerKeys {
    places: [Option<usize>; KEYS.len()],
    phase_function: Option<PhaseFunction>,
}

/// Where the number is that tells what is below, if any does.
enum Below {
    Unsaid,
    Eta(usize),
    Reflectance(usize),
}

impl<'py> Stacks<'py> {
    fn read(layers: &Any<'py>, ends: &Ends<'_, 'py>) -> PyResult<Self> {
        let one_layer = |_: PyErr| {
            PyTypeError::new_err("layers must be a list of dicts, one for each layer from top to bottom")
        };
        let items: Vec<Any<'py>> = layers.try_iter().map_err(one_layer)?.collect::<PyResult<_>>()?;
        let mut all = Self { arguments: Vec::new(), layers: Vec::new(), eta_above: 0, below: Below::Unsaid };
        all.eta_above = match ends.eta_above {
            Some(eta) => all.add("eta_above".into(), eta)?,
            None => all.keep("eta_above".into(), Numbers::One(1.0)),
        };
        all.below = match (ends.eta_below, ends.ground_reflectance) {
            (None, None) => Below::Unsaid,
            (Some(eta), None) => Below::Eta(all.add("eta_below".into(), eta)?),
            (None, Some(part)) => Below::Reflectance(all.add("ground_reflectance".into(), part)?),
            _ => return Err(PyTypeError::new_err("give one of eta_below and ground_reflectance at most")),
        };
        for (number, item) in items.iter().enumerate() {
            let layer = item.cast::<PyMapping>().map_err(|_| {
                let kind = item.get_type();
                PyTypeError::new_err(format!("layers[{number}] must be a dict, but is {kind}"))
            })?;
            let keys = all.read_layer(layer, number)?;
            all.layers.push(keys);
        }
        Ok(all)
    }

    fn read_layer(&mut self, layer: &Bound<'py, PyMapping>, number: usize) -> PyResult<LayerKeys> {
        let mut keys = LayerKeys { places: [None; KEYS.len()], phase_function: None };
        for item in layer.items()?.iter() {
            let (key, value): (Any<'py>, Any<'py>) = item.extract()?;
            let key: String = key.extract().map_err(|_| {
                let key = key.repr().map_or_else(|_| String::from("of no text"), |text| text.to_string());
                PyTypeError::new_err(format!("layers[{number}] has the key {key}, but keys are words"))
            })?;
            let name = format!("layers[{number}][{key:?}]");
            if PHASE_FUNCTIONS.contains(&key.as_str()) {
                let known = if key == PHASE_FUNCTIONS[0] {
                    let moments = Numbers::extract(&name, &value)?;
                    if moments.shape().len() != 1 {
                        return Err(PyValueError::new_err(format!("{name} must be a list of numbers")));
                    }
                    PhaseFunction::Moments(moments.broadcast(moments.shape()).into())
                } else {
                    phase_function(&name, Some(&value), 0.0)?
                };
                if keys.phase_function.replace(known).is_some() {
                    let message = format!("layers[{number}] may have one of moments and phase_function");
                    return Err(PyTypeError::new_err(message));
                }
                continue;
            }
            let Some(place) = KEYS.iter().position(|known| *known == key) else {
                let known = [&KEYS[..], &PHASE_FUNCTIONS].concat().join(", ");
                let message = format!("layers[{number}] has no key {key:?}, but may have {known}");
                return Err(PyValueError::new_err(message));
            };
            keys.places[place] = Some(self.add(name, &value)?);
        }
        let [_, scattering, absorption, surface_albedo, mfp, g, _] = keys.places.map(|place| place.is_some());
        match (scattering, absorption, surface_albedo, mfp) {
            (true, true, false, false) | (false, false, true, true) => {}
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "layers[{number}] needs scattering and absorption, or surface_albedo and mfp"
                )));
            }
        }
        if g && keys.phase_function.is_some() {
            let message = format!("layers[{number}] may have one of g and moments, or g and phase_function");
            return Err(PyTypeError::new_err(message));
        }
        if surface_albedo && keys.phase_function.is_some() {
            return Err(PyTypeError::new_err(format!(
                "layers[{number}] has a surface_albedo, which is known for Henyey's and Greenstein's phase function alone: \
                 give scattering and absorption beside moments or phase_function"
            )));
        }
        Ok(keys)
    }

    fn add(&mut self, name: String, value: &Any<'py>) -> PyResult<usize> {
        let numbers = Numbers::extract(&name, value)?;
        Ok(self.keep(name, numbers))
    }

    fn keep(&mut self, name: String, numbers: Numbers<'py>) -> usize {
        self.arguments.push((name, numbers));
        self.arguments.len() - 1
    }

    fn shape(&self) -> PyResult<Vec<usize>> {
        let shapes: Vec<(&str, &[usize])> =
            self.arguments.iter().map(|(name, numbers)| (name.as_str(), numbers.shape())).collect();
        let shape = broadcast_shape(&shapes)?;
        // Columns of arguments, of bits, and of results: asked for and given back, as none could only end the process
        let bytes = size_of::<f64>() * (2 * shapes.len() + 2 * RESULTS);
        let needed =
            shape.iter().try_fold(bytes, |bytes, count| bytes.checked_mul(*count)).unwrap_or(usize::MAX);
        match Vec::<u8>::new().try_reserve_exact(needed) {
            Ok(()) => Ok(shape),
            Err(_) => {
                Err(PyMemoryError::new_err(format!("arguments broadcast to {shape:?}, too many for memory")))
            }
        }
    }

    /// The different stacks of all elements, and which of them each element has.
    fn build(&self, shape: &[usize]) -> PyResult<(Vec<Layers>, Vec<usize>)> {
        let columns: Vec<Vec<f64>> =
            self.arguments.iter().map(|(_, numbers)| numbers.broadcast(shape)).collect();
        let own = self.arguments.len()
            - usize::from(self.arguments.last().is_some_and(|(name, _)| name == RADII.name));
        let (mut known, mut stacks, mut places) = (HashMap::new(), Vec::new(), Vec::new());
        let mut inversions = Inversions::new();
        for element in 0..shape.iter().product() {
            let bits: Vec<u64> = columns[..own].iter().map(|column| column[element].to_bits()).collect();
            let next = stacks.len();
            let place = *known.entry(bits).or_insert(next);
            if place == next {
                let values: Vec<f64> = columns.iter().map(|column| column[element]).collect();
                let stack = self.stack(&values, &mut inversions).map_err(|error| {
                    let index = crate::profiles::index_of(element, shape);
                    let place =
                        if index.is_empty() { String::new() } else { format!(" (at index {index:?})") };
                    names::value_error(format!("{error}{place}"))
                })?;
                stacks.push(stack);
            }
            places.push(place);
        }
        Ok((stacks, places))
    }

    fn stack(&self, values: &[f64], inversions: &mut Inversions) -> Result<Layers, LayersError> {
        let mut layers = Vec::with_capacity(self.layers.len());
        for (number, keys) in self.layers.iter().enumerate() {
            let within = |error: ParameterError| LayersError { layer: Some(number), error };
            let [thickness, scattering, absorption, surface_albedo, mfp, g, eta] =
                keys.places.map(|place| place.map(|place| values[place]));
            let (thickness, g) = (thickness.unwrap_or(f64::INFINITY), g.unwrap_or(0.0));
            let layer = match (scattering.zip(absorption), surface_albedo.zip(mfp)) {
                (_, Some((albedo, mfp))) => {
                    let inversion = match inversions.entry(g.to_bits()) {
                        Entry::Occupied(known) => known.into_mut(),
                        Entry::Vacant(place) => place
                            .insert(AlbedoInversion::new(g, 1.0, Configuration::Diffuse).map_err(within)?),
                    };
                    Layer::from_surface_albedo(inversion, albedo, mfp, Parameterization::Mfp, thickness)
                        .map_err(within)?
                }
                (coefficients, None) => {
                    let (scattering, absorption) = coefficients.unwrap_or_default();
                    Layer::new(scattering, absorption, thickness).with_g(g)
                }
            };
            let layer = layer.with_eta(eta.unwrap_or(1.0));
            layers.push(match &keys.phase_function {
                Some(phase_function) => layer.with_phase_function(phase_function.clone()),
                None => layer,
            });
        }
        let is_endless = layers.last().is_some_and(|layer| layer.thickness == f64::INFINITY);
        let ground = match self.below {
            Below::Eta(place) => Ground::Medium { eta: values[place] },
            Below::Reflectance(place) => Ground::Lambertian { reflectance: values[place] },
            Below::Unsaid if is_endless => Ground::None,
            Below::Unsaid => Ground::AIR,
        };
        Layers::new(values[self.eta_above], layers, ground)
    }

    /// Numbers in the shape and precision of the arguments.
    fn array(&self, py: Python<'py>, shape: &[usize], numbers: Vec<f64>) -> PyResult<Any<'py>> {
        let arguments: Vec<&Numbers<'py>> = self.arguments.iter().map(|(_, numbers)| numbers).collect();
        array_like(py, &arguments, shape, numbers)
    }
}

/// What is above and below layers.
struct Ends<'a, 'py> {
    eta_above: Option<&'a Any<'py>>,
    eta_below: Option<&'a Any<'py>>,
    ground_reflectance: Option<&'a Any<'py>>,
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

/// Error at which no finer rule is needed, at least `least`.
fn tolerance(argument: Option<&Any<'_>>, least: f64, default: f64) -> PyResult<f64> {
    let allowed = format!("in [{least:e}, 0.1]");
    let rule = Rule::new("tolerance", &allowed, least, 0.1);
    argument.map_or(Ok(default), |argument| Numbers::extract(rule.name, argument)?.single(&rule))
}

/// Parts that the work on a stack counts as.
const PARTS: u64 = 1000;

/// Solves every stack on all threads, with progress; the first error names no element, as it is the light's.
fn solve<T: Send + 'static>(
    py: Python<'_>,
    stacks: Vec<Layers>,
    threads: Option<usize>,
    progress: Option<&Any<'_>>,
    one: impl Fn(&Layers, &Control<'_>) -> Result<Option<T>, String> + Send + Sync + 'static,
) -> PyResult<Vec<T>> {
    let (done, pool, total) = (Arc::new(AtomicU64::new(0)), pool(threads)?, PARTS * stacks.len() as u64);
    let counter = Arc::clone(&done);
    let work = move |stop: &AtomicBool| {
        pool.install(|| {
            let solve = |layers: &Layers| {
                let counted = AtomicU64::new(0);
                // Threads may come in another order than their counts
                let count = |part: u64| {
                    let before = counted.fetch_max(part, Ordering::Relaxed);
                    counter.fetch_add(part.saturating_sub(before), Ordering::Relaxed);
                };
                // Nobody waits for what is left out
                let control = Control { stop, progress: &count, ..Control::default() };
                let solved = one(layers, &control)?.ok_or_else(String::new);
                count(PARTS);
                solved
            };
            stacks.par_iter().map(solve).collect::<Result<Vec<T>, String>>()
        })
    };
    with_progress(py, progress, "layers", "part", |progress| {
        let solved = long_work::run_or_abandon(py, work, |_| {
            report(progress, done.load(Ordering::Relaxed).min(total.saturating_sub(1)), total)
        })?;
        report(progress, total, total)?;
        solved.map_err(PyValueError::new_err)
    })
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
///     Angle of a beam above, in degrees from the normal, in [0, 89.99].
/// tolerance : float, default 1e-6
///     Error below which no finer rule is tried, in [1e-12, 0.1]: many layers of many indices of refraction take minutes to
///     1e-6, and a third of that or less to 0.01.
/// threads : int, optional
///     Number of threads; by default one per processor.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the parts done and the parts in all, a thousand for each stack, and an exception ends the
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
///     If a parameter is outside its range, or shapes do not broadcast.
/// TypeError
///     If a layer lacks a key, or an argument is no number.
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
    let incidence = incidence(configuration, incidence_angle)?;
    let arguments = Stacks::read(layers, &Ends { eta_above, eta_below, ground_reflectance })?;
    let shape = arguments.shape()?;
    let (stacks, places) = arguments.build(&shape)?;
    let tolerance = self::tolerance(tolerance, 1e-12, 1e-6)?;
    let one = move |layers: &Layers, control: &Control<'_>| {
        let totals =
            layers.totals_within(tolerance, incidence, control).map_err(|error| error.to_string())?;
        match totals {
            Some(totals) if totals.error > HOPELESS.max(tolerance) => {
                Err("layers have no exact solution: their coefficients are too far apart".into())
            }
            totals => Ok(totals),
        }
    };
    let totals = solve(py, stacks, threads, progress, one)?;
    let column = |of: fn(&Totals) -> f64| {
        arguments.array(py, &shape, places.iter().map(|place| of(&totals[*place])).collect())
    };
    let absorbed = places.iter().flat_map(|place| totals[*place].absorbed.iter().copied()).collect();
    let by_layer: Vec<usize> = [&shape[..], &[arguments.layers.len()]].concat();
    let fields = vec![
        column(|totals| totals.specular_reflectance)?,
        column(|totals| totals.diffuse_reflectance)?,
        column(|totals| totals.collimated_transmittance)?,
        column(|totals| totals.diffuse_transmittance)?,
        arguments.array(py, &by_layer, absorbed)?,
        column(|totals| totals.absorbed_by_ground)?,
        column(|totals| totals.error)?,
    ];
    named(py, "LayersTotals", fields)
}

/// Light R(r) and T(r) that plane layers return and let through around a beam along the normal.
///
/// Light that was never scattered is no part of it.
///
/// Parameters
/// ----------
/// r : array_like
///     Distances from the beam, greater than 0, in the unit of the layers' thickness.
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
///     Called now and then with the parts done and the parts in all, a thousand for each stack, and an exception ends the
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
///     If a parameter is outside its range, layers have no exact profile, or shapes do not broadcast.
/// TypeError
///     If a layer lacks a key, or an argument is no number.
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
    let radii = Numbers::extract(RADII.name, r)?;
    radii.require(&RADII)?;
    let mut arguments = Stacks::read(layers, &Ends { eta_above, eta_below, ground_reflectance })?;
    let radii_place = arguments.keep(RADII.name.into(), radii);
    let shape = arguments.shape()?;
    let (stacks, places) = arguments.build(&shape)?;
    let tolerance = self::tolerance(tolerance, 1e-4, 1e-4)?;
    let profiles = solve(py, stacks, threads, progress, move |layers: &Layers, control: &Control<'_>| {
        let profile = layers.profile_within(tolerance, control);
        profile.map_err(|error| format!("layers have no exact profile: {error}"))
    })?;
    let radii = arguments.arguments[radii_place].1.broadcast(&shape);
    let mut columns = [const { Vec::new() }; 4];
    for (place, r) in places.iter().zip(&radii) {
        let (reflected, transmitted) = (profiles[*place].reflectance(*r), profiles[*place].transmittance(*r));
        let row = [reflected.value, reflected.error, transmitted.value, transmitted.error];
        columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let fields: PyResult<Vec<Any<'py>>> =
        columns.into_iter().map(|column| arguments.array(py, &shape, column)).collect();
    named(py, "LayersProfile", fields?)
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
///     Angle of a beam above, in degrees from the normal, in [0, 89.99].
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
///     If a parameter is outside its range, or moments make a phase function negative at some angle.
/// TypeError
///     If a layer lacks a key, or an argument is no number.
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
    let arguments = Stacks::read(layers, &Ends { eta_above, eta_below, ground_reflectance })?;
    if let Some((name, numbers)) = arguments.arguments.iter().find(|(_, numbers)| !numbers.shape().is_empty())
    {
        let shape = numbers.shape();
        return Err(PyTypeError::new_err(format!(
            "{name} must be one number for a walk, but is an array of shape {shape:?}"
        )));
    }
    let layers = arguments.build(&[])?.0.swap_remove(0);
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
