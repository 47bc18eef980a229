//! `translucid.reference`: walks of photons and their tables.

use std::ffi::CString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, TryLockError};

use pyo3::exceptions::{
    PyKeyboardInterrupt, PyOSError, PyRuntimeError, PyTypeError, PyUserWarning, PyValueError,
};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyDict, PyRange, PyType};
use translucid_gpu::Choice;
use translucid_profile::ParameterError;
use translucid_reference::walk::{
    AtAlbedo, Control, Device, Layout, Parameters, PilotError, Problem, Region, Side, TableError,
    WhiteTable as Table,
};
use translucid_reference::{Estimate, Incidence};

use crate::arrays::{Any, Numbers, Rule, array_like, broadcast_shape};
use crate::photons::Photons;
use crate::profile::{Profile, number_or};
use crate::profile_pickle::Origin;
use crate::reference::{Pair, albedo, incidence, pool, report, with_progress};
use crate::{long_work, names, phase_function};

/// Most radii of a table, each with three edges of rings.
const MOST_RADII: usize = 8000;
/// Lowest albedo at which photons walk: those that survive tell of lower ones, too.
const LOWEST_REFERENCE: f64 = 0.5;

/// Photons that left a medium, counted over place and order of scattering: one walk, every albedo.
///
/// Made by `walk`, `WhiteTable.load`, and by adding tables.
/// Counts are whole numbers: a table depends on its photons alone, not on threads or on the sequence in which parts of it
/// were walked, on one machine or on many.
/// Lengths are mean free paths.
///
/// Notes
/// -----
/// E. Alerstam, S. Andersson-Engels and T. Svensson 2008, *White Monte Carlo for time-resolved photon migration*,
/// *J. Biomed. Opt.* 13, 041304.
/// Files are those that `translucid reference --table` writes and reads, NPZ archives that `numpy.load` opens, too.
///
/// Examples
/// --------
/// >>> import translucid
/// >>> table = translucid.reference.walk(
/// ...     20_000, radii=[0.5, 1.0], single_scattering_albedo=0.9, configuration="searchlight")
/// >>> table += translucid.reference.walk(
/// ...     range(20_000, 40_000), radii=[0.5, 1.0], single_scattering_albedo=0.9, configuration="searchlight")
/// >>> table.photons
/// 40000
/// >>> value, error = table.total(single_scattering_albedo=0.9)
/// >>> exact, _ = translucid.reference.exact_total(0.9, configuration="searchlight")
/// >>> bool(abs(value - exact) < 4 * error)
/// True
#[pyclass(frozen, module = "translucid.reference", name = "WhiteTable", weakref)]
pub(crate) struct WhiteTable {
    table: Mutex<Arc<Table>>,
    /// Held while photons walk.
    walking: Mutex<()>,
}

impl WhiteTable {
    fn new(table: Table) -> Self {
        Self { table: Mutex::new(Arc::new(table)), walking: Mutex::default() }
    }

    fn get(&self) -> Arc<Table> {
        Arc::clone(&self.table.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn set(&self, table: Table) {
        *self.table.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(table);
    }

    /// Walks more photons, which the table holds even where an exception ends the walk.
    fn extend(
        &self,
        py: Python<'_>,
        photons: &Photons,
        threads: Option<usize>,
        device: &str,
        progress: Option<&Any<'_>>,
    ) -> PyResult<()> {
        let choice = Choice::open(device).map_err(PyValueError::new_err)?;
        if let (None, Some(note)) = (&choice.device, &choice.note) {
            let text = CString::new(note.as_str())
                .map_err(|_| PyValueError::new_err("a device's name holds a NUL"))?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
        }
        let _walking = match self.walking.try_lock() {
            Ok(guard) => guard,
            Err(TryLockError::Poisoned(guard)) => guard.into_inner(),
            Err(TryLockError::WouldBlock) => {
                return Err(PyRuntimeError::new_err("another thread is walking photons of this table"));
            }
        };
        let (pool, done, total) = (pool(threads)?, AtomicU64::new(0), photons.count());
        let mut table = (*self.get()).clone();
        let mut outcome = Ok(0);
        let waited = with_progress(py, progress, "walk", "photons", |progress| {
            long_work::run(
                py,
                |stop| {
                    let progress = |count: u64| done.store(count, Ordering::Relaxed);
                    let device = choice.device.as_deref().map(|device| device as &dyn Device);
                    let control = Control { stop, progress: &progress, device, ..Control::default() };
                    outcome = pool.install(|| match *photons {
                        Photons::Count(seed, count) => table.run(seed, count, &control),
                        Photons::Range(range) => table.run_range(range, &control),
                    });
                },
                |_| report(progress, done.load(Ordering::Relaxed), total),
            )
        });
        self.set(table);
        waited?;
        outcome.map(drop).map_err(table_error)
    }
}

fn table_error(error: TableError) -> PyErr {
    match error {
        TableError::Unreadable { .. } => PyOSError::new_err(error.to_string()),
        error => names::value_error(error),
    }
}

/// Walks photons through a half space or a slab.
///
/// Parameters
/// ----------
/// photons : int or range, default 10_000_000
///     How many; or which of the seed's photons, for machines that share the work. 0 makes an empty table to `run`.
/// radii : array_like of shape (n,), optional
///     Radii at which R(r) is wanted: each gets a narrow ring inside and one outside, as in the command.
/// edges : array_like of shape (n,), optional
///     Radii between wide rings, rising, in place of `radii`; without either only totals are known.
/// surface_albedo, single_scattering_albedo : array_like, optional
///     Albedos that will be asked for, in (0, 1): the walk takes place at the highest. One of both.
/// reference_albedo : float, optional
///     Single-scattering albedo to walk at, in (0, 0.999999], in place of those: the table serves all below. 0.999 by
///     default.
/// configuration : {"diffuse", "searchlight"}, optional
///     How light enters: from all directions by default, as a beam along the normal, or with an `incidence_angle` as a
///     tilted beam.
/// g : float, default 0
///     Mean cosine of Henyey's and Greenstein's phase function, in (-1, 1).
/// phase_function : str or array_like of shape (n, 2), default "henyey-greenstein"
///     Distribution of the angle of scattering: "henyey-greenstein", "rayleigh", "two-term:W,G1,G2" for parts W and 1 - W of
///     two of Henyey's and Greenstein's, "moments:X1,X2,..." for Legendre moments from the first on; or rows of a cosine,
///     rising from -1 to 1, and a value in any scale, linear between them.
/// eta : float, default 1
///     Relative index of refraction, inside over outside, in [0.1, 10].
/// thickness : float, optional
///     Thickness of a slab, in mean free paths; by default a half space.
/// spot_radius : float, default 0
///     Radius of the disc over which light enters evenly, in mean free paths.
/// incidence_angle : float, optional
///     Angle of a beam outside, in degrees from the normal, in [0, 90).
/// sectors : int, default 1
///     Sectors of a half circle into which rings are cut, for an azimuth, in [1, 720].
/// seed : int, default 0
///     Seed of the random numbers, in [0, 2**64).
/// threads : int, optional
///     Number of threads; by default one per processor. The table does not depend on it.
/// device : str, default "cpu"
///     Who walks: "cpu", "gpu" for the best graphics processor, "auto" for that or else the CPU, or a part of a name that
///     `translucid devices` lists. All graphics processors walk the same photons, and the CPU others, which are not added to
///     them in one table.
/// progress : callable, bool or "tqdm", optional
///     Called now and then with the photons done and the photons in all, and an exception ends the walk; True for a bar.
///
/// Returns
/// -------
/// WhiteTable
///
/// Raises
/// ------
/// ValueError
///     If a parameter is outside its range, or no albedo makes the surface albedo.
/// TypeError
///     If an argument is no number, or too many albedos are given.
/// KeyboardInterrupt
///     At Ctrl-C; `WhiteTable.run` keeps the photons that were done.
///
/// Examples
/// --------
/// >>> import translucid
/// >>> table = translucid.reference.walk(
/// ...     1e5, radii=[1.0], single_scattering_albedo=0.9, configuration="searchlight")
/// >>> value, error = table.eval(1.0, single_scattering_albedo=0.9)
/// >>> bool(abs(value - 2.1217649785e-2) < 4 * error)
/// True
#[pyfunction]
#[pyo3(signature = (photons=None, *, radii=None, edges=None, surface_albedo=None, single_scattering_albedo=None, reference_albedo=None, configuration=None, g=None, phase_function=None, eta=None, thickness=None, spot_radius=None, incidence_angle=None, sectors=1, seed=0, threads=None, device="cpu", progress=None))]
#[expect(clippy::too_many_arguments, reason = "Python's keywords")]
pub(crate) fn walk(
    py: Python<'_>,
    photons: Option<&Any<'_>>,
    radii: Option<&Any<'_>>,
    edges: Option<&Any<'_>>,
    surface_albedo: Option<&Any<'_>>,
    single_scattering_albedo: Option<&Any<'_>>,
    reference_albedo: Option<&Any<'_>>,
    configuration: Option<&str>,
    g: Option<&Any<'_>>,
    phase_function: Option<&Any<'_>>,
    eta: Option<&Any<'_>>,
    thickness: Option<&Any<'_>>,
    spot_radius: Option<&Any<'_>>,
    incidence_angle: Option<&Any<'_>>,
    sectors: u32,
    #[pyo3(from_py_with = crate::photons::seed)] seed: u64,
    threads: Option<usize>,
    device: &str,
    progress: Option<&Any<'_>>,
) -> PyResult<WhiteTable> {
    // Geometry, boundary and light
    let any = |name: &'static str| Rule::new(name, "a number", f64::NEG_INFINITY, f64::INFINITY);
    let one = |name: &'static str, given, default| number_or(name, given, default)?.single(&any(name));
    let g = one("g", g, 0.0)?;
    let phase_function = phase_function::phase_function("phase_function", phase_function, g)?;
    let eta = one("eta", eta, 1.0)?;
    let thickness = one("thickness", thickness, f64::INFINITY)?;
    let spot_radius = one("spot_radius", spot_radius, 0.0)?;
    let incidence = incidence(configuration, incidence_angle, eta)?;
    let problem = Problem::new(Parameters { phase_function, eta, thickness, incidence, spot_radius });
    let problem = problem.map_err(names::value_error)?;
    let layout = layout(radii, edges, sectors)?;
    let photons = match photons {
        Some(photons) => Photons::extract(photons, seed)?,
        None => Photons::Count(seed, 10_000_000),
    };

    // The albedo to walk at
    let given = [surface_albedo, single_scattering_albedo, reference_albedo].iter().flatten().count();
    if given > 1 {
        let message = "give at most one of surface_albedo, single_scattering_albedo and reference_albedo";
        return Err(PyTypeError::new_err(message));
    }
    let reference_albedo = if surface_albedo.is_some() || single_scattering_albedo.is_some() {
        let (rule, albedos) = albedo(surface_albedo, single_scattering_albedo)?;
        let albedos = albedos.broadcast(albedos.shape());
        let highest = if rule.name == "surface_albedo" {
            highest_of_surface(py, &problem, &albedos, seed, threads)?
        } else {
            albedos.iter().copied().fold(0.0, f64::max)
        };
        if highest > Table::HIGHEST_REFERENCE_ALBEDO {
            let (name, most) = (rule.name, Table::HIGHEST_REFERENCE_ALBEDO);
            return Err(PyValueError::new_err(format!(
                "{name} needs a single-scattering albedo of {highest}, but a walk goes up to {most}; \
                 the exact solution has no such limit"
            )));
        }
        highest.max(LOWEST_REFERENCE)
    } else {
        one("reference_albedo", reference_albedo, 0.999)?
    };

    let table = WhiteTable::new(Table::new(problem, layout, reference_albedo).map_err(names::value_error)?);
    table.extend(py, &photons, threads, device, progress)?;
    Ok(table)
}

fn layout(radii: Option<&Any<'_>>, edges: Option<&Any<'_>>, sectors: u32) -> PyResult<Layout> {
    let list = |name: &'static str, object: &Any<'_>| {
        let numbers = Numbers::extract(name, object)?;
        let count: usize = numbers.shape().iter().product();
        if numbers.shape().len() > 1 || count > MOST_RADII {
            let shape = numbers.shape();
            return Err(PyValueError::new_err(format!(
                "{name} has the shape {shape:?}, but must have one dimension and at most {MOST_RADII} radii"
            )));
        }
        numbers.require(&Rule::new(name, "in [1e-15, 1e15]", 1e-15, 1e15))?;
        Ok(numbers.broadcast(&[count]))
    };
    match (radii, edges) {
        (Some(_), Some(_)) => Err(PyTypeError::new_err("give one of radii and edges")),
        (Some(radii), None) => {
            Layout::around_in_sectors(&list("radii", radii)?, sectors).map_err(names::value_error)
        }
        (None, Some(edges)) => Layout::new(&list("edges", edges)?, sectors).map_err(names::value_error),
        (None, None) => Layout::new(&[], sectors).map_err(names::value_error),
    }
}

/// The highest single-scattering albedo that surface albedos need, exactly or by a short walk.
fn highest_of_surface(
    py: Python<'_>,
    problem: &Problem,
    albedos: &[f64],
    seed: u64,
    threads: Option<usize>,
) -> PyResult<f64> {
    let highest = albedos.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    if let Some(alpha) = problem.solved_single_scattering_albedo(highest).map_err(names::value_error)? {
        return Ok(alpha);
    }
    let pool = pool(threads)?;
    let search = |stop: &AtomicBool| {
        let control = Control { stop, ..Control::default() };
        pool.install(|| problem.pilot(highest, seed, &control))
    };
    long_work::run(py, search, |_| Ok(()))?.map_err(|error| match error {
        PilotError::Stopped => PyKeyboardInterrupt::new_err(()),
        PilotError::OutOfReach => PyValueError::new_err(format!(
            "surface_albedo has {highest}, which takes a single-scattering albedo above {}, where a walk ends",
            Table::HIGHEST_REFERENCE_ALBEDO
        )),
        PilotError::OutsideSlab { least, most } => PyValueError::new_err(format!(
            "surface_albedo has {highest}, but this slab reflects from {least:.4} to {most:.4}"
        )),
        PilotError::Table(error) => table_error(error),
    })
}

/// Where on a table, from the words of a call.
struct Place {
    side: Side,
    azimuth: Option<f64>,
}

fn side(table: &Table, name: &str) -> PyResult<Side> {
    match name {
        "reflected" => Ok(Side::Reflected),
        "transmitted" if table.problem().parameters().thickness.is_finite() => Ok(Side::Transmitted),
        "transmitted" => {
            Err(PyValueError::new_err("side is \"transmitted\", but a half space has no far side"))
        }
        _ => Err(names::unknown("side", name, &["reflected", "transmitted"])),
    }
}

/// The table's single-scattering albedo of an albedo that was given by name.
fn alpha(table: &Table, rule: &Rule<'_>, albedo: f64) -> Result<f64, ParameterError> {
    if rule.name != "surface_albedo" {
        return Ok(albedo);
    }
    match table.problem().solved_single_scattering_albedo(albedo)? {
        Some(alpha) => Ok(alpha),
        None => table.single_scattering_albedo(albedo).map(|found| found.value),
    }
}

impl WhiteTable {
    /// Figures at albedos and radii that broadcast.
    fn figures<'py>(
        &self,
        py: Python<'py>,
        r: Option<&Any<'py>>,
        albedos: [Option<&Any<'py>>; 2],
        figure: impl Fn(&AtAlbedo<'_>, f64) -> Result<Estimate, ParameterError>,
    ) -> PyResult<Pair<'py>> {
        let table = self.get();
        let r = number_or("r", r, 1.0)?;
        r.require(&Rule::new("r", "in [1e-15, 1e15]", 1e-15, 1e15))?;
        let (rule, albedo) = albedo(albedos[0], albedos[1])?;
        let shape = broadcast_shape(&[("r", r.shape()), (rule.name, albedo.shape())])?;
        let (radii, albedos) = (r.broadcast(&shape), albedo.broadcast(&shape));
        let (mut values, mut errors) = (vec![0.0; radii.len()], vec![0.0; radii.len()]);
        // Elements in the order of their albedos: a view of the table is made for each once
        let mut order: Vec<usize> = (0..radii.len()).collect();
        order.sort_by(|&a, &b| albedos[a].total_cmp(&albedos[b]));
        for group in order.chunk_by(|&a, &b| albedos[a] == albedos[b]) {
            py.check_signals()?;
            let fail = |error: ParameterError, i: usize| {
                names::parameter_error(&error, &crate::profiles::index_of(i, &shape))
            };
            let alpha = alpha(&table, &rule, albedos[group[0]]).map_err(|error| fail(error, group[0]))?;
            let at = table.at_albedo(alpha).map_err(|error| fail(error, group[0]))?;
            for &i in group {
                let Estimate { value, error } = figure(&at, radii[i]).map_err(|error| fail(error, i))?;
                // Of few photons nothing is known: as large as can be
                (values[i], errors[i]) = (value, error.min(f64::MAX));
            }
        }
        let numbers = [&r, &albedo];
        Ok((array_like(py, &numbers, &shape, values)?, array_like(py, &numbers, &shape, errors)?))
    }
}

#[pymethods]
impl WhiteTable {
    /// Walks more photons, in place.
    ///
    /// Where an exception or Ctrl-C ends the walk, the table holds the photons that were done.
    ///
    /// Parameters
    /// ----------
    /// photons : int or range
    ///     How many more of the seed's photons, the first that the table does not hold; or which.
    /// seed : int, default 0
    ///     Seed of the random numbers.
    /// threads : int, optional
    ///     Number of threads; by default one per processor.
    /// device : str, default "cpu"
    ///     Who walks, as in `walk`.
    /// progress : callable, bool or "tqdm", optional
    ///     Called now and then with the photons done and the photons in all; True for a bar.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the table holds one of a range already, or photons that another kind of machine walked.
    #[pyo3(signature = (photons, *, seed=0, threads=None, device="cpu", progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        photons: &Any<'_>,
        #[pyo3(from_py_with = crate::photons::seed)] seed: u64,
        threads: Option<usize>,
        device: &str,
        progress: Option<&Any<'_>>,
    ) -> PyResult<()> {
        self.extend(py, &Photons::extract(photons, seed)?, threads, device, progress)
    }

    /// Reflectance R(r), or transmittance per area, with its standard error.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii of `walk(radii=…)`, in mean free paths.
    /// surface_albedo, single_scattering_albedo : array_like
    ///     Albedos up to the one of the walk; one of both. They broadcast against r.
    /// side : {"reflected", "transmitted"}, default "reflected"
    ///     Face of a slab at which light leaves.
    /// azimuth : float, optional
    ///     Direction from the entry in degrees, from where a tilted beam points to: of the `sectors` that holds it.
    ///
    /// Returns
    /// -------
    /// value, error : float or ndarray
    ///     Means over the two rings around r per unit of flux that has entered, and their standard errors.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If there are no rings around a radius, or an albedo is above that of the walk.
    ///
    /// Notes
    /// -----
    /// Rings are min(r/50, 0.05 mean free paths) wide, or a third of the distance to the next radius: off by 1e-3 at most.
    #[pyo3(signature = (r, *, surface_albedo=None, single_scattering_albedo=None, side="reflected", azimuth=None))]
    fn eval<'py>(
        &self,
        py: Python<'py>,
        r: &Any<'py>,
        surface_albedo: Option<&Any<'py>>,
        single_scattering_albedo: Option<&Any<'py>>,
        side: &str,
        azimuth: Option<&Any<'py>>,
    ) -> PyResult<Pair<'py>> {
        let finite = Rule::new("azimuth", "finite", f64::MIN, f64::MAX);
        let azimuth =
            azimuth.map(|object| Numbers::extract("azimuth", object)?.single(&finite)).transpose()?;
        let place = Place { side: self::side(&self.get(), side)?, azimuth };
        self.figures(py, Some(r), [surface_albedo, single_scattering_albedo], |at, r| {
            let found = match place.azimuth {
                Some(degrees) => at.at_radius_and_azimuth(place.side, r, degrees.to_radians()),
                None => at.at_radius(place.side, r),
            };
            Ok(found?.reflectance)
        })
    }

    /// Energy that leaves within r, with its standard error.
    ///
    /// Parameters
    /// ----------
    /// r : array_like
    ///     Radii between rings of the table, in mean free paths.
    /// surface_albedo, single_scattering_albedo : array_like
    ///     Albedos up to the one of the walk; one of both.
    /// side : {"reflected", "transmitted"}, default "reflected"
    ///     Face of a slab at which light leaves.
    ///
    /// Returns
    /// -------
    /// value, error : float or ndarray
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If a radius is none of the table's, or an albedo is above that of the walk.
    #[pyo3(signature = (r, *, surface_albedo=None, single_scattering_albedo=None, side="reflected"))]
    fn enclosed<'py>(
        &self,
        py: Python<'py>,
        r: &Any<'py>,
        surface_albedo: Option<&Any<'py>>,
        single_scattering_albedo: Option<&Any<'py>>,
        side: &str,
    ) -> PyResult<Pair<'py>> {
        let table = self.get();
        let side = self::side(&table, side)?;
        let edges = table.layout().radii();
        self.figures(py, Some(r), [surface_albedo, single_scattering_albedo], |at, r| {
            let nearest = edges.iter().position(|edge| (edge - r).abs() <= 1e-9 * r);
            let allowed = "one of the radii between the table's rings";
            nearest.map(|edge| at.enclosed(side, edge)).ok_or_else(|| ParameterError::new("r", r, allowed))
        })
    }

    /// Energy that leaves through a face, for the one of entry the surface albedo, with its standard error.
    ///
    /// Parameters
    /// ----------
    /// surface_albedo, single_scattering_albedo : array_like
    ///     Albedos up to the one of the walk; one of both.
    /// side : {"reflected", "transmitted"}, default "reflected"
    ///     Face of a slab at which light leaves.
    ///
    /// Returns
    /// -------
    /// value, error : float or ndarray
    #[pyo3(signature = (*, surface_albedo=None, single_scattering_albedo=None, side="reflected"))]
    fn total<'py>(
        &self,
        py: Python<'py>,
        surface_albedo: Option<&Any<'py>>,
        single_scattering_albedo: Option<&Any<'py>>,
        side: &str,
    ) -> PyResult<Pair<'py>> {
        let side = self::side(&self.get(), side)?;
        self.figures(py, None, [surface_albedo, single_scattering_albedo], |at, _| Ok(at.total(side)))
    }

    /// Mean reflectances over all rings, with their standard errors.
    ///
    /// Parameters
    /// ----------
    /// surface_albedo, single_scattering_albedo : float
    ///     Albedo up to the one of the walk; one of both.
    /// side : {"reflected", "transmitted"}, default "reflected"
    ///     Face of a slab at which light leaves.
    ///
    /// Returns
    /// -------
    /// value, error : ndarray of shape (n,)
    ///     One for each of the n radii between rings: the ring inside it, the first from the center. Light beyond the last
    ///     radius is not among them.
    #[pyo3(signature = (*, surface_albedo=None, single_scattering_albedo=None, side="reflected"))]
    fn rings<'py>(
        &self,
        py: Python<'py>,
        surface_albedo: Option<&Any<'py>>,
        single_scattering_albedo: Option<&Any<'py>>,
        side: &str,
    ) -> PyResult<Pair<'py>> {
        let table = self.get();
        let side = self::side(&table, side)?;
        let (rule, albedo) = albedo(surface_albedo, single_scattering_albedo)?;
        let alpha = alpha(&table, &rule, albedo.single(&rule)?).map_err(names::value_error)?;
        let at = table.at_albedo(alpha).map_err(names::value_error)?;
        let count = table.layout().radii().len();
        let rings = (0..count).map(|ring| at.reflectance(side, Region::Ring(ring)));
        let (values, errors) = rings.map(|ring| (ring.value, ring.error.min(f64::MAX))).unzip();
        let one = [&Numbers::One(0.0)];
        Ok((array_like(py, &one, &[count], values)?, array_like(py, &one, &[count], errors)?))
    }

    /// Single-scattering albedo at which the face of entry returns a surface albedo, with its standard error.
    ///
    /// Parameters
    /// ----------
    /// surface_albedo : float
    ///     Among those that albedos up to the one of the walk make.
    ///
    /// Returns
    /// -------
    /// value, error : float
    #[pyo3(signature = (surface_albedo))]
    fn single_scattering_albedo(&self, surface_albedo: &Any<'_>) -> PyResult<(f64, f64)> {
        let rule = Rule::new("surface_albedo", "in [0, 1]", 0.0, 1.0);
        let surface_albedo = Numbers::extract(rule.name, surface_albedo)?.single(&rule)?;
        let found = self.get().single_scattering_albedo(surface_albedo).map_err(names::value_error)?;
        Ok((found.value, found.error.min(f64::MAX)))
    }

    /// Profile through the energies within the table's radii, to evaluate and to sample.
    ///
    /// Parameters
    /// ----------
    /// surface_albedo, single_scattering_albedo : float
    ///     Albedo up to the one of the walk; one of both.
    /// side : {"reflected", "transmitted"}, default "reflected"
    ///     Face of a slab at which light leaves.
    ///
    /// Returns
    /// -------
    /// translucid.Profile
    ///     With radii in mean free paths. Choose `edges` such that rings are filled well: their noise is the profile's.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If fewer than four rings have 100 photons.
    #[pyo3(signature = (*, surface_albedo=None, single_scattering_albedo=None, side="reflected"))]
    fn profile(
        &self,
        py: Python<'_>,
        surface_albedo: Option<&Any<'_>>,
        single_scattering_albedo: Option<&Any<'_>>,
        side: &str,
    ) -> PyResult<Profile> {
        let table = self.get();
        let (rule, albedo) = albedo(surface_albedo, single_scattering_albedo)?;
        let alpha = alpha(&table, &rule, albedo.single(&rule)?).map_err(names::value_error)?;
        let at = table.at_albedo(alpha).map_err(names::value_error)?;
        let profile = at.profile(self::side(&table, side)?).map_err(names::value_error)?;
        let description = format!("WhiteTable.profile(single_scattering_albedo={alpha})");
        // Later photons do not change the profile
        let snapshot = Self { table: Mutex::new(table.clone()), walking: Mutex::default() };
        let keywords = [("single_scattering_albedo", alpha)].into_py_dict(py)?;
        keywords.set_item("side", side)?;
        let method = Bound::new(py, snapshot)?.getattr("profile")?;
        let call = py.import("functools")?.getattr("partial")?.call((method,), Some(&keywords))?;
        Ok(Profile::of_one(description, Arc::new(profile), Origin::Call(call.unbind())))
    }

    /// Adds the photons of other tables, in place and exactly.
    ///
    /// Parameters
    /// ----------
    /// *tables : WhiteTable
    ///     Tables of the same walk with other photons: of other seeds or ranges.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If the tables differ in more than their photons, or share photons. The table is then unchanged.
    #[pyo3(signature = (*tables))]
    fn merge(&self, tables: Vec<PyRef<'_, Self>>) -> PyResult<()> {
        let mut sum = (*self.get()).clone();
        for table in tables {
            sum.merge(&table.get()).map_err(table_error)?;
        }
        self.set(sum);
        Ok(())
    }

    fn __add__(&self, other: &Self) -> PyResult<Self> {
        let mut sum = (*self.get()).clone();
        sum.merge(&other.get()).map_err(table_error)?;
        Ok(Self::new(sum))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.get() == other.get()
    }

    /// Writes the table to an NPZ file, whole or not at all.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The file, which is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be written.
    #[expect(clippy::needless_pass_by_value, reason = "extracted for this call")]
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let table = self.get();
        py.detach(|| translucid_files::write_atomically(&path, |out| table.write(out)))
            .map_err(|error| PyOSError::new_err(error.to_string()))
    }

    /// Reads a table from an NPZ file that `save` or the command has written.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The file.
    ///
    /// Returns
    /// -------
    /// WhiteTable
    ///
    /// Raises
    /// ------
    /// OSError
    ///     If the file cannot be read.
    /// ValueError
    ///     If it is no such table, cut short, or its numbers contradict each other.
    #[classmethod]
    #[expect(clippy::needless_pass_by_value, reason = "extracted for this call")]
    fn load(class: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let table = class.py().detach(|| Table::load(&path)).map_err(table_error)?;
        Ok(Self::new(table))
    }

    /// The table from the bytes of its file.
    #[classmethod]
    fn _from_bytes(_class: &Bound<'_, PyType>, bytes: &[u8]) -> PyResult<Self> {
        Table::read(bytes, &PathBuf::from("bytes")).map(Self::new).map_err(table_error)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Any<'py>, (Bound<'py, PyBytes>,))> {
        let mut bytes = Vec::new();
        slf.get().get().write(&mut bytes)?;
        Ok((slf.get_type().getattr("_from_bytes")?, (PyBytes::new(slf.py(), &bytes),)))
    }

    /// Number of photons that entered the medium.
    #[getter]
    fn photons(&self) -> u64 {
        self.get().photons()
    }

    /// Photons that the table holds: pairs of a seed and a range.
    #[getter]
    fn photon_ranges<'py>(&self, py: Python<'py>) -> PyResult<Vec<(u64, Any<'py>)>> {
        let range = py.get_type::<PyRange>();
        let ranges = self.get().photon_ranges().to_vec();
        ranges.into_iter().map(|part| Ok((part.seed, range.call1((part.start, part.end))?))).collect()
    }

    /// Radii between the rings, in mean free paths.
    #[getter]
    fn edges<'py>(&self, py: Python<'py>) -> PyResult<Any<'py>> {
        let radii = self.get().layout().radii().to_vec();
        array_like(py, &[&Numbers::One(0.0)], &[radii.len()], radii)
    }

    /// Single-scattering albedo at which the photons walked, the highest that the table serves.
    #[getter]
    fn reference_albedo(&self) -> f64 {
        self.get().reference_albedo()
    }

    /// Mean number of collisions of a photon at that albedo.
    #[getter]
    fn mean_collisions(&self) -> f64 {
        self.get().mean_collisions()
    }

    /// Geometry, boundary and light of the walk, by the names of the arguments of `walk`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let table = self.get();
        let Parameters { phase_function, eta, thickness, incidence, spot_radius } =
            table.problem().parameters();
        let parameters = PyDict::new(py);
        let (phase_function, g) = phase_function::as_argument(py, phase_function)?;
        parameters.set_item("g", g)?;
        parameters.set_item("phase_function", phase_function)?;
        parameters.set_item("eta", eta)?;
        parameters.set_item("thickness", thickness.is_finite().then_some(thickness))?;
        parameters.set_item("spot_radius", spot_radius)?;
        let (configuration, angle) = match incidence {
            Incidence::Pencil { cos_theta: 1.0 } => ("searchlight", None),
            Incidence::Pencil { cos_theta } => ("searchlight", Some(cos_theta.acos().to_degrees())),
            Incidence::Cosine => ("diffuse", None),
            Incidence::UniformCosine => ("uniform-cosine", None),
        };
        parameters.set_item("configuration", configuration)?;
        parameters.set_item("incidence_angle", angle)?;
        parameters.set_item("sectors", table.layout().sectors())?;
        Ok(parameters)
    }

    fn __repr__(&self) -> String {
        let table = self.get();
        let (photons, albedo) = (table.photons(), table.reference_albedo());
        let rings = table.layout().rings();
        format!(
            "<WhiteTable of {photons} photons in {rings} rings, single-scattering albedos up to {albedo}>"
        )
    }

    #[classattr]
    fn __hash__(py: Python<'_>) -> Py<PyAny> {
        py.None()
    }
}
