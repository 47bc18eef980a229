//! White Monte Carlo tables: photons that are walked, counted, added, saved and asked.

use std::ffi::{c_char, c_int, c_void};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::Duration;

use translucid_profile::ParameterError;
use translucid_reference::Estimate;
use translucid_reference::walk::{
    AtAlbedo, Control, Layout, Parameters, PhaseFunction, PhotonRange, Problem, Region, Side, TableError,
    WhiteTable,
};

use crate::ffi_guard::{Caller, Kind, Progress, Rule, enter, room};
use crate::names;
use crate::profile::TranslucidProfile;
use crate::status::{Failure, TranslucidStatus};
use crate::threads::with_threads;

/// Photons that left a medium, counted over place and order of scattering: one walk, every albedo.
///
/// Lengths are mean free paths. The table depends on its photons alone, not on threads or on the sequence in which parts
/// of it were walked. Any number of threads may use it at once; while one walks or merges, others read the table as it
/// was before, and are refused if they want to walk or merge, too.
pub struct TranslucidWhiteTable {
    _opaque: [u8; 0],
}

/// The value behind a `TranslucidWhiteTable`.
pub(crate) struct Shared {
    table: Mutex<Arc<WhiteTable>>,
    /// Held while the table is about to change.
    changing: Mutex<()>,
}

impl Kind for TranslucidWhiteTable {
    type Value = Shared;
    const TAG: [u8; 8] = *b"tl-white";
    const NAME: &'static str = "TranslucidWhiteTable";
}

/// Geometry, boundary, scattering and light of a walk, and where its photons are counted. A field that is 0 or NULL has
/// its default.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct TranslucidWalk {
    /// Mean cosine of the phase function, in (-1, 1).
    pub g: f64,
    /// "henyey-greenstein", the default, or for g = 0 "rayleigh", "two-term:W,G1,G2" (parts W and 1 - W of two
    /// Henyey-Greenstein functions) or "moments:X1,X2,..." (Legendre moments from the first on).
    pub phase_function: *const c_char,
    /// Relative index of refraction, inside over outside, in [0.1, 10]; by default 1.
    pub eta: f64,
    /// Thickness of a slab; by default a half space.
    pub thickness: f64,
    /// Radius of the disc over which light enters evenly.
    pub spot_radius: f64,
    /// How light enters: "searchlight", or "diffuse", which is the default without an angle.
    pub configuration: *const c_char,
    /// Angle of a beam outside, in degrees from the normal, in [0, 90).
    pub incidence_angle: f64,
    /// Single-scattering albedo of the walk, in (0, 0.999999], the highest that can be asked for; by default 0.999.
    pub reference_albedo: f64,
    /// Radii at which R(r) is wanted, at most 8000: each gets a narrow ring inside and one outside.
    pub radii: *const f64,
    /// Number of radii.
    pub radius_count: usize,
    /// Radii between wide rings, rising, at most 8000, in place of radii.
    pub edges: *const f64,
    /// Number of edges.
    pub edge_count: usize,
    /// Sectors of a half circle into which rings are cut, for azimuths, at most 720; by default 1.
    pub sectors: u32,
}

/// Function that is told how many photons of a run are done, on the thread that called the run, some times a second.
///
/// Another value than 0 stops the run. It must return: neither by longjmp nor by an exception may it leave.
pub type TranslucidProgress = Option<unsafe extern "C" fn(done: u64, total: u64, user: *mut c_void) -> c_int>;

/// Most radii of a table, each with three edges of rings.
const MOST_RADII: usize = 8000;
const RADII: Rule = Rule { name: "r", allowed: "in [1e-15, 1e15]", least: 1e-15, most: 1e15 };
/// Time between two looks at progress.
const POLL: Duration = Duration::from_millis(50);

/// Makes an empty table.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_new(
    walk: *const TranslucidWalk,
    table: *mut *mut TranslucidWhiteTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("table", table)?;
        let walk = caller.structure("walk", walk)?;
        let g = walk.g;
        let phase_function = caller.text_or("phase_function", walk.phase_function, "henyey-greenstein")?;
        let phase_function = PhaseFunction::parse(phase_function, g)
            .map_err(Failure::argument)?
            .ok_or_else(|| Failure::unknown("phase_function", phase_function, &PhaseFunction::WORDS))?;
        let eta = names::number_or(walk.eta, 1.0);
        let incidence = names::incidence(caller, walk.configuration, walk.incidence_angle, eta)?;
        let thickness = names::number_or(walk.thickness, f64::INFINITY);
        let parameters =
            Parameters { phase_function, eta, thickness, incidence, spot_radius: walk.spot_radius };
        let problem = Problem::new(parameters).map_err(Failure::argument)?;
        let layout = layout(caller, &walk)?;
        let reference_albedo = names::number_or(walk.reference_albedo, 0.999);
        let made = WhiteTable::new(problem, layout, reference_albedo).map_err(Failure::argument)?;
        slot.put_handle(Shared::new(made));
        Ok(())
    })
}

/// Reads a table from an NPZ file that translucid_white_table_save, the command or the Python module has written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_load(
    path: *const c_char,
    table: *mut *mut TranslucidWhiteTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("table", table)?;
        let made = WhiteTable::load(Path::new(caller.text("path", path)?)).map_err(table_failure)?;
        slot.put_handle(Shared::new(made));
        Ok(())
    })
}

/// Writes the table to an NPZ file, which is replaced whole or not at all.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_save(
    table: *const TranslucidWhiteTable,
    path: *const c_char,
) -> TranslucidStatus {
    enter!(|caller| {
        let table = caller.handle("table", table)?.get();
        let path = Path::new(caller.text("path", path)?);
        translucid_files::write_atomically(path, |out| table.write(out))
            .map_err(|error| Failure::new(TranslucidStatus::FileError, error.to_string()))
    })
}

/// Frees a table; profiles made of it stay. NULL is none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_free(table: *mut TranslucidWhiteTable) -> TranslucidStatus {
    enter!(|caller| caller.free("table", table))
}

/// Walks photons more of a seed, the first that the table does not hold, on a number of threads, at most 1024: by 0 one
/// per processor.
///
/// progress may be NULL, and user is passed on to it. Where it stops the run, the table holds the photons that were
/// done, and the status is TRANSLUCID_STATUS_STOPPED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_run(
    table: *mut TranslucidWhiteTable,
    seed: u64,
    photons: u64,
    threads: usize,
    progress: TranslucidProgress,
    user: *mut c_void,
) -> TranslucidStatus {
    enter!(|caller| {
        let shared = caller.handle("table", table)?;
        let progress = caller.progress(progress, user);
        shared.extend(photons, threads, &progress, |table, control| table.run(seed, photons, control))
    })
}

/// Walks the photons of a seed from start to before end, as one of many machines does that share the work; otherwise as
/// translucid_white_table_run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_run_range(
    table: *mut TranslucidWhiteTable,
    seed: u64,
    start: u64,
    end: u64,
    threads: usize,
    progress: TranslucidProgress,
    user: *mut c_void,
) -> TranslucidStatus {
    enter!(|caller| {
        let shared = caller.handle("table", table)?;
        let progress = caller.progress(progress, user);
        if start > end || end == u64::MAX {
            let message = format_args!("start is {start} and end is {end}, but start <= end < 2^64 - 1");
            return Err(Failure::argument(message));
        }
        let range = PhotonRange { seed, start, end };
        shared.extend(range.len(), threads, &progress, |table, control| table.run_range(range, control))
    })
}

/// Adds the photons of another table of the same walk, exactly; it must have other photons.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_merge(
    table: *mut TranslucidWhiteTable,
    other: *const TranslucidWhiteTable,
) -> TranslucidStatus {
    enter!(|caller| {
        let shared = caller.handle("table", table)?;
        let other = caller.handle("other", other)?.get();
        let _changing = shared.change()?;
        let mut sum = (*shared.get()).clone();
        sum.merge(&other).map_err(table_failure)?;
        shared.set(sum);
        Ok(())
    })
}

/// Gives the number of photons that entered the medium.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_photons(
    table: *const TranslucidWhiteTable,
    photons: *mut u64,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("photons", photons)?;
        slot.put(caller.handle("table", table)?.get().photons());
        Ok(())
    })
}

/// Gives the radii between the table's rings, and their number: as many as fit in count, all of them if edges is NULL
/// and count 0 tells the number alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_edges(
    table: *const TranslucidWhiteTable,
    edges: *mut f64,
    count: usize,
    total: *mut usize,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("total", total)?;
        let out = caller.output("edges", edges, count)?;
        let table = caller.handle("table", table)?.get();
        let radii = table.layout().radii();
        out.write(0, &radii[..count.min(radii.len())]);
        slot.put(radii.len());
        Ok(())
    })
}

/// Gives the single-scattering albedo at which the face of entry returns a surface albedo, and its standard error where
/// that is not NULL.
///
/// Where the exact solution knows it, it is that one, without an error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_single_scattering_albedo(
    table: *const TranslucidWhiteTable,
    surface_albedo: f64,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let table = caller.handle("table", table)?.get();
        let (value, error) = (caller.output("value", value, 1)?, caller.optional_output("error", error, 1)?);
        let is_good = surface_albedo > 0.0 && surface_albedo <= 1.0;
        translucid_profile::require(is_good, "surface_albedo", surface_albedo, "in (0, 1]")
            .map_err(Failure::argument)?;
        let solved = table.problem().solved_single_scattering_albedo(surface_albedo);
        let found = match solved.map_err(Failure::argument)? {
            Some(value) => Estimate { value, error: 0.0 },
            None => table.single_scattering_albedo(surface_albedo).map_err(Failure::argument)?,
        };
        value.write(0, &[found.value]);
        error.write(0, &[found.error.min(f64::MAX)]);
        Ok(())
    })
}

/// Gives R(r), or the transmittance per area, at count radii of the walk, and standard errors where those are not NULL.
///
/// The albedo goes up to the one of the walk; side is the face of a slab at which light leaves: "reflected",
/// the default for NULL, or "transmitted".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_eval(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    r: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let place = Place { table, single_scattering_albedo, side };
        place.figures(caller, r, count, [value, error], |at, side, r| Ok(at.at_radius(side, r)?.reflectance))
    })
}

/// Gives R(r) as translucid_white_table_eval does, of the sector that holds an azimuth: a direction from the entry in
/// degrees, from where a tilted beam points to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_eval_at_azimuth(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    azimuth: f64,
    r: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let finite = Rule { name: "azimuth", allowed: "finite", least: f64::MIN, most: f64::MAX };
        finite.require(azimuth)?;
        let azimuth = (azimuth % 360.0).to_radians();
        let place = Place { table, single_scattering_albedo, side };
        place.figures(caller, r, count, [value, error], |at, side, r| {
            Ok(at.at_radius_and_azimuth(side, r, azimuth)?.reflectance)
        })
    })
}

/// Gives the energy that leaves within count radii, each one between rings of the table, and standard errors where those
/// are not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_enclosed(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    r: *const f64,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let place = Place { table, single_scattering_albedo, side };
        let radii = caller.handle("table", table)?.get();
        let radii = radii.layout().radii();
        place.figures(caller, r, count, [value, error], |at, side, r| {
            let edge = radii.iter().position(|radius| (radius - r).abs() <= 1e-9 * r);
            let not_there = || ParameterError::new("r", r, "one of the radii between the table's rings");
            Ok(at.enclosed(side, edge.ok_or_else(not_there)?))
        })
    })
}

/// Gives the energy that leaves through a face, for the one of entry the surface albedo, and its standard error where
/// that is not NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_total(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let place = Place { table, single_scattering_albedo, side };
        place.all_figures(caller, 1, [value, error], |at, side| Ok(vec![at.total(side)]))
    })
}

/// Gives the mean reflectances over the first count rings, the first from the center to the first radius, and standard
/// errors where those are not NULL.
///
/// There are as many as radii between rings: light beyond the last is not among them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_rings(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    count: usize,
    value: *mut f64,
    error: *mut f64,
) -> TranslucidStatus {
    enter!(|caller| {
        let rings = caller.handle("table", table)?.get().layout().radii().len();
        if count > rings {
            return Err(Failure::argument(format_args!(
                "count is {count}, but must be at most {rings}, all rings"
            )));
        }
        let place = Place { table, single_scattering_albedo, side };
        place.all_figures(caller, count, [value, error], |at, side| {
            Ok((0..count).map(|ring| at.reflectance(side, Region::Ring(ring))).collect())
        })
    })
}

/// Makes the profile through the energies within the table's radii, to evaluate and to sample; radii are mean free paths.
///
/// Choose edges such that rings are filled well: their noise is the profile's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn translucid_white_table_profile(
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
    profile: *mut *mut TranslucidProfile,
) -> TranslucidStatus {
    enter!(|caller| {
        let slot = caller.slot("profile", profile)?;
        let table = caller.handle("table", table)?.get();
        let side = self::side(caller, &table, side)?;
        let at = table.at_albedo(single_scattering_albedo).map_err(Failure::argument)?;
        slot.put_handle(Arc::new(at.profile(side).map_err(Failure::argument)?));
        Ok(())
    })
}

impl Shared {
    fn new(table: WhiteTable) -> Self {
        Self { table: Mutex::new(Arc::new(table)), changing: Mutex::default() }
    }

    fn get(&self) -> Arc<WhiteTable> {
        Arc::clone(&self.table.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn set(&self, table: WhiteTable) {
        *self.table.lock().unwrap_or_else(PoisonError::into_inner) = Arc::new(table);
    }

    /// Keeps others from changing the table.
    fn change(&self) -> Result<MutexGuard<'_, ()>, Failure> {
        match self.changing.try_lock() {
            Ok(guard) => Ok(guard),
            Err(TryLockError::Poisoned(guard)) => Ok(guard.into_inner()),
            Err(TryLockError::WouldBlock) => Err(Failure::new(
                TranslucidStatus::Busy,
                "another thread is walking or merging photons of this table",
            )),
        }
    }

    /// Walks more photons, on threads of its own, while this one tells of progress.
    fn extend(
        &self,
        photons: u64,
        threads: usize,
        progress: &Progress<'_>,
        run: impl FnOnce(&mut WhiteTable, &Control<'_>) -> Result<u64, TableError> + Send,
    ) -> Result<(), Failure> {
        let _changing = self.change()?;
        let mut table = (*self.get()).clone();
        let (stop, done) = (AtomicBool::new(false), AtomicU64::new(0));
        let count = |count: u64| done.store(count, Ordering::Relaxed);
        let control = Control { stop: &stop, progress: &count, ..Control::default() };
        let outcome = std::thread::scope(|scope| {
            let (send, ended) = channel::<()>();
            let table = &mut table;
            let walk = move || {
                let result = with_threads(threads, || run(table, &control));
                drop(send);
                result
            };
            let walker = std::thread::Builder::new().spawn_scoped(scope, walk).map_err(|error| {
                Failure::new(TranslucidStatus::OutOfResources, format!("cannot start a thread: {error}"))
            })?;
            while ended.recv_timeout(POLL) == Err(RecvTimeoutError::Timeout) {
                let goes_on = progress.report(done.load(Ordering::Relaxed).min(photons), photons);
                if !goes_on {
                    stop.store(true, Ordering::Relaxed);
                }
            }
            walker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        let walked = outcome?.map_err(table_failure)?;
        self.set(table);
        let goes_on = progress.report(walked, photons);
        if walked < photons && (stop.into_inner() || !goes_on) {
            let message =
                format!("the progress function has stopped the walk after {walked} of {photons} photons");
            return Err(Failure::new(TranslucidStatus::Stopped, message));
        }
        Ok(())
    }
}

fn layout(caller: &Caller, walk: &TranslucidWalk) -> Result<Layout, Failure> {
    let list = |name, start, count| {
        if count > MOST_RADII {
            let message = format_args!("{name} has {count} radii, but must have at most {MOST_RADII}");
            return Err(Failure::argument(message));
        }
        let input = caller.input(name, start, count)?;
        input.require(&Rule { name, ..RADII })?;
        input.to_vec()
    };
    if walk.radius_count > 0 && walk.edge_count > 0 {
        return Err(Failure::argument("there are both radii and edges, but only one of them is taken"));
    }
    let sectors = walk.sectors.max(1);
    let layout = if walk.radius_count > 0 {
        Layout::around_in_sectors(&list("radii", walk.radii, walk.radius_count)?, sectors)
    } else {
        Layout::new(&list("edges", walk.edges, walk.edge_count)?, sectors)
    };
    layout.map_err(Failure::argument)
}

fn side(caller: &Caller, table: &WhiteTable, side: *const c_char) -> Result<Side, Failure> {
    match caller.text_or("side", side, "reflected")? {
        "reflected" => Ok(Side::Reflected),
        "transmitted" if table.problem().parameters().thickness.is_finite() => Ok(Side::Transmitted),
        "transmitted" => Err(Failure::argument("side is \"transmitted\", but a half space has no far side")),
        other => Err(Failure::unknown("side", other, &["reflected", "transmitted"])),
    }
}

fn table_failure(error: TableError) -> Failure {
    match error {
        TableError::Unreadable { .. } => Failure::new(TranslucidStatus::FileError, error.to_string()),
        error => Failure::argument(error),
    }
}

/// Where figures are asked for.
struct Place {
    table: *const TranslucidWhiteTable,
    single_scattering_albedo: f64,
    side: *const c_char,
}

impl Place {
    /// Figures at radii, and their errors.
    fn figures(
        &self,
        caller: &Caller,
        r: *const f64,
        count: usize,
        out: [*mut f64; 2],
        figure: impl Fn(&AtAlbedo<'_>, Side, f64) -> Result<Estimate, ParameterError>,
    ) -> Result<(), Failure> {
        let r = caller.input(RADII.name, r, count)?;
        r.require(&RADII)?;
        let radii = r.to_vec()?;
        self.all_figures(caller, count, out, |at, side| {
            let mut figures = room(count)?;
            for (i, &r) in radii.iter().enumerate() {
                let found = figure(at, side, r);
                figures
                    .push(found.map_err(|error| Failure::argument(format_args!("at index {i}, {error}")))?);
            }
            Ok(figures)
        })
    }

    /// A number of figures, and their errors.
    fn all_figures(
        &self,
        caller: &Caller,
        count: usize,
        [value, error]: [*mut f64; 2],
        figures: impl FnOnce(&AtAlbedo<'_>, Side) -> Result<Vec<Estimate>, Failure>,
    ) -> Result<(), Failure> {
        let table = caller.handle("table", self.table)?.get();
        let side = side(caller, &table, self.side)?;
        let (value, error) =
            (caller.output("value", value, count)?, caller.optional_output("error", error, count)?);
        let at = table.at_albedo(self.single_scattering_albedo).map_err(Failure::argument)?;
        for (i, found) in figures(&at, side)?.iter().enumerate() {
            value.write(i, &[found.value]);
            // Of few photons nothing is known: as large as can be
            error.write(i, &[found.error.min(f64::MAX)]);
        }
        Ok(())
    }
}
