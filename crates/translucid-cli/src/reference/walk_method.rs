//! `translucid reference --method monte-carlo`.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::Args;
use translucid_gpu::Choice;
use translucid_reference::walk::{
    Control, Device, Forecast, Goal, Layout, PhotonRange, PilotError, Problem, Side, TableError, WhiteTable,
};

use super::photons::Photons;
use super::{COLUMNS, ReferenceArguments};
use crate::failure::Failure;
use crate::output_lock::OutputLock;
use crate::progress::{Meter, Unit, duration};
use crate::table::exact;
use crate::{interrupt, machine, messages};

/// Photons where neither their number nor an error is asked for.
const DEFAULT_PHOTONS: u64 = 10_000_000;
/// Time between two savings of the table: what a power cut may cost.
const SAVE_INTERVAL: Duration = Duration::from_secs(30);
/// Most radii of a table, each with three edges of rings.
const MOST_RADII: usize = 8000;
/// Lowest albedo that a table is asked for: the squares of weights are numbers.
const LOWEST: f64 = 1e-100;
/// Lowest albedo at which photons walk.
const LOWEST_REFERENCE: f64 = 0.5;
/// Rings × sectors for which there is room.
const MOST_CELLS: usize = 25_000;

/// Options of the walk alone.
#[derive(Args, Debug)]
pub(super) struct WalkArguments {
    /// Number of photons, including those of --table and --merge, or a half-open range A..B of them for one of many
    /// machines [default: 1e7]
    #[arg(long, value_name = "N|A..B", value_parser = Photons::parse, conflicts_with = "error")]
    photons: Option<Photons>,
    /// Relative standard error to reach for every reflectance, in place of --photons
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    error: Option<f64>,
    /// Seed of the random numbers [default: 0]
    #[arg(long, value_name = "S")]
    seed: Option<u64>,
    /// Who walks: cpu, gpu for the best graphics processor, auto for that or else the cpu, or a part of a name that `translucid
    /// devices` lists [default: cpu]
    #[arg(long, value_name = "DEVICE")]
    device: Option<String>,
    /// Number of threads, at most 1024 [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// File (NPZ) that keeps the table of photons; -o FILE.npz also does, and prints nothing
    #[arg(long = "table", value_name = "FILE.npz")]
    pub(super) table_file: Option<PathBuf>,
    /// Continue the walk of --table, if the file exists
    #[arg(long)]
    resume: bool,
    /// Tables to add, comma-separated, of other seeds or other machines
    #[arg(long, value_name = "FILE.npz,...", value_delimiter = ',')]
    merge: Vec<PathBuf>,
}

impl WalkArguments {
    /// Refuses all of them, where there is no walk.
    pub(super) fn refuse_all(&self) -> Result<(), Failure> {
        match self.given().find(|(_, given)| *given) {
            Some((option, _)) => {
                Err(Failure::input(format!("{option} belongs to the walk, and the exact method has none"))
                    .with_help("leave it out, or use --method monte-carlo"))
            }
            None => Ok(()),
        }
    }

    /// Refuses those that a walk through layers has not: all but the seed and, where nothing else states it, the number of
    /// photons.
    pub(super) fn refuse_for_layers(&self, takes_photons: bool) -> Result<(), Failure> {
        let is_taken = |option| option == "--seed" || (option == "--photons" && takes_photons);
        match self.given().find(|(option, given)| *given && !is_taken(*option)) {
            Some((option, _)) => Err(Failure::input(format!("{option} is not for these layers"))
                .with_help("leave it out: --seed and --threads are for walks through layers, and --photons N for .toml files")),
            None => Ok(()),
        }
    }

    fn given(&self) -> impl Iterator<Item = (&'static str, bool)> {
        [
            ("--photons", self.photons.is_some()),
            ("--error", self.error.is_some()),
            ("--table", self.table_file.is_some()),
            ("--resume", self.resume),
            ("--merge", !self.merge.is_empty()),
            ("--seed", self.seed.is_some()),
            ("--device", self.device.is_some()),
        ]
        .into_iter()
    }

    /// Number of photons, where it is a number and no range.
    pub(super) fn count(&self) -> Option<u64> {
        match self.photons {
            None => Some(DEFAULT_PHOTONS),
            Some(Photons::Count(count)) => Some(count),
            Some(Photons::Range(_)) => None,
        }
    }

    pub(super) fn seed(&self) -> u64 {
        self.seed.unwrap_or(0)
    }
}

/// Walks, and prints the table.
pub(super) fn run(arguments: &ReferenceArguments, problem: &Problem) -> Result<(), Failure> {
    let walk = &arguments.walk;
    if let Some(error) = walk.error.filter(|error| !(*error > 0.0 && *error < 1.0)) {
        return Err(Failure::input(format!("--error is {}, but must be in (0, 1)", exact(error))));
    }
    arguments.table.check()?;
    if walk.resume && arguments.table_file().is_none() {
        return Err(Failure::input(String::from("--resume has no table to go on from"))
            .with_help("name it with --table or -o FILE.npz"));
    }
    if let Some(path) = arguments.table_file() {
        translucid_files::check_writable(path)?;
    }
    let _lock = arguments.table_file().map(OutputLock::take).transpose()?;
    arguments.table.spare(walk.table_file.iter().chain(&walk.merge).map(PathBuf::as_path))?;
    if let (Some(table), Some(output)) = (&walk.table_file, arguments.table.npz()) {
        let message = format!("--table is {}, and --output is {}", table.display(), output.display());
        return Err(Failure::input(message).with_help("one file keeps the table: leave the other out"));
    }
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;

    let mut work = WalkWork::start(arguments, problem)?;
    work.walk()?;
    let interrupted = interrupt::settle();
    work.save()?;
    if interrupted && work.table.photons() == 0 {
        return Err(Failure::interrupted("nothing was walked yet"));
    }
    work.print()?;
    if interrupted {
        let photons = work.table.photons();
        let help = match arguments.table_file() {
            Some(path) => format!("repeat the command with --resume to go on from {}", path.display()),
            None => format!("the table is that of {photons} photons; --table would have kept them"),
        };
        return Err(Failure::interrupted(help));
    }
    Ok(())
}

/// A walk on its way.
struct WalkWork<'a> {
    arguments: &'a ReferenceArguments,
    table: WhiteTable,
    /// Radii in mean free paths.
    radii: Vec<f64>,
    albedos: Albedos,
    choice: Choice<Box<dyn Device + Send>>,
}

/// The albedos of the printed table.
enum Albedos {
    /// Surface albedos, where they were given, and single-scattering albedos.
    Known(Vec<(Option<f64>, f64)>),
    /// Surface albedos, the rest to be read off the walk.
    Surface(Vec<f64>),
}

fn device(choice: &Choice<Box<dyn Device + Send>>) -> Option<&dyn Device> {
    choice.device.as_deref().map(|device| device as &dyn Device)
}

impl Albedos {
    /// The single-scattering albedos that are known before the walk.
    fn known(&self) -> impl Iterator<Item = f64> {
        let list: &[(Option<f64>, f64)] = if let Self::Known(list) = self { list } else { &[] };
        list.iter().map(|&(_, alpha)| alpha)
    }
}

impl<'a> WalkWork<'a> {
    fn start(arguments: &'a ReferenceArguments, problem: &Problem) -> Result<Self, Failure> {
        let choice = Choice::open(arguments.walk.device.as_deref().unwrap_or("cpu")).map_err(|reason| {
            Failure::input(reason).with_help("`translucid devices` lists them; --device cpu is always there")
        })?;
        if let Some(note) = &choice.note {
            messages::print_note(note);
        }

        // Radii and bins
        let count = arguments.radii.count();
        if count > MOST_RADII {
            let message = format!("there are {count} radii, too many for a walk: {MOST_RADII} at most");
            return Err(Failure::input(message));
        }
        let radii: Vec<f64> = arguments.radii.iter()?.map(|r| r / arguments.mfp).collect();
        let sectors = arguments.azimuth.map_or(1, |azimuth| sectors(azimuth, count));
        let layout =
            Layout::around_in_sectors(&radii, sectors).map_err(|error| radius_error(arguments, &error))?;

        // What an earlier run left, else the first of the tables to be joined, else an empty one
        let mut merge = arguments.walk.merge.iter();
        let load = |path: &PathBuf| WhiteTable::load(path).map_err(table_failure);
        let earlier = match earlier_table(arguments)? {
            Some(table) => Some(table),
            None => merge.next().map(load).transpose()?,
        };
        let albedos = Albedos::new(arguments, problem)?;
        let table = match earlier {
            Some(table) => {
                if table.problem() != problem {
                    return Err(foreign_table(
                        arguments,
                        "is for another problem: geometry, boundary or light",
                    ));
                }
                if table.layout() != &layout {
                    return Err(foreign_table(arguments, "has rings around other radii"));
                }
                table
            }
            None => {
                let albedo = albedos.reference(arguments, problem)?;
                WhiteTable::new(problem.clone(), layout, albedo)
                    .map_err(|error| arguments.name_option(error))?
            }
        };
        let mut work = Self { arguments, table, radii, albedos, choice };
        for path in merge {
            work.table
                .merge(&load(path)?)
                .map_err(|error| Failure::input(format!("{} cannot be merged: {error}", path.display())))?;
        }
        work.check_albedos()?;
        work.check_range()?;
        let none = arguments.walk.photons.as_ref().filter(|photons| photons.are_none());
        if let Some(photons) = none.filter(|_| work.table.photons() == 0 && arguments.table.npz().is_none()) {
            let message = format!("--photons is {photons}, but no table has photons to continue from");
            return Err(Failure::input(message));
        }
        Ok(work)
    }

    /// A table that was made for lower albedos has no photons for higher ones.
    fn check_albedos(&self) -> Result<(), Failure> {
        let reference = self.table.reference_albedo();
        match self.albedos.known().find(|&alpha| alpha > reference) {
            Some(alpha) => {
                let (alpha, reference) = (exact(alpha), exact(reference));
                Err(foreign_table(
                    self.arguments,
                    &format!("was walked for albedos up to {reference}, and {alpha} is wanted"),
                ))
            }
            None => Ok(()),
        }
    }

    /// Photons of the range that is wanted are not to come from the tables that are joined with it.
    fn check_range(&self) -> Result<(), Failure> {
        let walk = &self.arguments.walk;
        let Some(Photons::Range(range)) = &walk.photons else { return Ok(()) };
        let wanted = range.end - range.start;
        let lacking = Photons::Range(range.clone()).lacking(&self.table, walk.seed());
        if lacking < wanted && !walk.resume {
            let Range { start, end } = range;
            let held = wanted - lacking;
            let message = format!(
                "--photons is {start}..{end}, but the tables of --merge hold {held} of these photons"
            );
            return Err(Failure::input(message).with_help("leave them out: no photon counts twice"));
        }
        Ok(())
    }

    /// Walks until there are enough photons, the error is small enough, or Ctrl-C.
    fn walk(&mut self) -> Result<(), Failure> {
        let (start, cpu_before) = (Instant::now(), machine::cpu_seconds());
        let meter = Meter::new(Unit::Photons);
        let walked = match self.arguments.walk.error {
            Some(error) => self.walk_to_error(error, &meter),
            None => self.walk_photons(&meter),
        };
        meter.finish();
        let walked = walked?;
        let seconds = start.elapsed().as_secs_f64();
        let cpu = cpu_before
            .zip(machine::cpu_seconds())
            .map_or(String::new(), |(before, after)| format!(" ({:.1} s of CPU)", after - before));
        let mut text = format!("walked {walked} photons in {}{cpu}", duration(seconds));
        if walked != self.table.photons() {
            text += &format!(", {} in all", self.table.photons());
        }
        messages::line(&text);
        Ok(())
    }

    fn walk_photons(&mut self, meter: &Meter) -> Result<u64, Failure> {
        let seed = self.arguments.walk.seed();
        let photons = self.arguments.walk.photons.clone().unwrap_or(Photons::Count(DEFAULT_PHOTONS));
        let wanted = photons.lacking(&self.table, seed);
        let mut walked = 0;
        while walked < wanted && !interrupt::STOP.load(Ordering::Relaxed) {
            let before = walked;
            let control = Control {
                stop: &interrupt::STOP,
                progress: &|done| meter.update(before + done, wanted),
                deadline: Some(Instant::now() + SAVE_INTERVAL),
                device: device(&self.choice),
            };
            walked += match photons {
                Photons::Count(_) => self.table.run(seed, wanted - walked, &control),
                Photons::Range(Range { start, end }) => {
                    self.table.run_rest(PhotonRange { seed, start, end }, &control)
                }
            }
            .map_err(table_failure)?;
            if walked < wanted {
                self.save()?;
            }
        }
        Ok(walked)
    }

    fn walk_to_error(&mut self, error: f64, meter: &Meter) -> Result<u64, Failure> {
        let (arguments, radii, albedos) = (self.arguments, &self.radii, &self.albedos);
        let worst = |table: &WhiteTable| {
            let Ok(rows) = rows(arguments, table, radii, albedos) else { return f64::INFINITY };
            // Nothing over nothing is not known either
            let relative = rows.iter().map(|row| row[5] / row[3]);
            relative.map(|error| if error.is_nan() { f64::INFINITY } else { error }).fold(0.0, f64::max)
        };
        let mut saved = (Instant::now(), Ok(()));
        let total = std::sync::atomic::AtomicU64::new(u64::MAX);
        let mut report = |table: &WhiteTable, forecast: &Forecast| {
            let Forecast { photons_done, photons_left, .. } = *forecast;
            total.store(photons_done.saturating_add(photons_left), Ordering::Relaxed);
            if saved.0.elapsed() > SAVE_INTERVAL {
                saved = (Instant::now(), save(arguments, table));
            }
        };
        let control = Control {
            stop: &interrupt::STOP,
            progress: &|done| meter.update(done, total.load(Ordering::Relaxed)),
            deadline: None,
            device: device(&self.choice),
        };
        let goal = Goal { relative_error: error, photons: u64::MAX >> 1 };
        let seed = arguments.walk.seed();
        let walked =
            self.table.run_until(seed, goal, &control, &worst, &mut report).map_err(table_failure)?;
        saved.1.map(|()| walked)
    }

    fn save(&self) -> Result<(), Failure> {
        save(self.arguments, &self.table)
    }

    fn print(&self) -> Result<(), Failure> {
        if self.arguments.table.npz().is_some() {
            return Ok(());
        }
        let rows = rows(self.arguments, &self.table, &self.radii, &self.albedos)?;
        self.arguments.table.write(COLUMNS, rows.into_iter())
    }
}

impl Albedos {
    fn new(arguments: &ReferenceArguments, problem: &Problem) -> Result<Self, Failure> {
        if !arguments.single_scattering_albedo.is_empty() {
            let highest = WhiteTable::HIGHEST_REFERENCE_ALBEDO;
            if let Some(&alpha) = arguments.single_scattering_albedo.iter().find(|&&alpha| alpha > highest) {
                let message = format!(
                    "--single-scattering-albedo has {}, but a walk goes up to {}",
                    exact(alpha),
                    exact(highest)
                );
                let help = if problem.parameters().thickness.is_finite() {
                    "take that: over so few collisions it makes no difference"
                } else {
                    "closer to 1 walks do not end; the exact method has no such limit"
                };
                return Err(Failure::input(message).with_help(help));
            }
            if let Some(&alpha) = arguments.single_scattering_albedo.iter().find(|&&alpha| alpha < LOWEST) {
                let (alpha, lowest) = (exact(alpha), exact(LOWEST));
                let message =
                    format!("--single-scattering-albedo has {alpha}, but a walk goes down to {lowest}");
                return Err(Failure::input(message).with_help("the exact method has no such limit"));
            }
            return arguments.albedos(problem).map(Self::Known);
        }
        if !problem.is_solved() {
            return Ok(Self::Surface(arguments.surface_albedo.clone()));
        }
        let albedos = arguments.albedos(problem)?;
        match albedos.iter().find(|(_, alpha)| *alpha > WhiteTable::HIGHEST_REFERENCE_ALBEDO) {
            Some(&(surface_albedo, _)) => Err(out_of_reach(surface_albedo.unwrap_or_default())),
            None => Ok(Self::Known(albedos)),
        }
    }

    /// The albedo at which to walk: the highest that is needed.
    fn reference(&self, arguments: &ReferenceArguments, problem: &Problem) -> Result<f64, Failure> {
        // Photons that survive tell of low albedos, too: those that hardly scatter would leave few
        match self {
            Self::Known(_) => Ok(self.known().fold(LOWEST_REFERENCE, f64::max)),
            Self::Surface(list) => pilot(arguments, problem, list.iter().copied().fold(0.0, f64::max))
                .map(|albedo| albedo.max(LOWEST_REFERENCE)),
        }
    }
}

/// A surface albedo that takes more collisions than a walk goes through.
fn out_of_reach(surface_albedo: f64) -> Failure {
    let message = format!(
        "--surface-albedo has {}, which takes a single-scattering albedo above {}, where a walk ends",
        exact(surface_albedo),
        exact(WhiteTable::HIGHEST_REFERENCE_ALBEDO)
    );
    Failure::input(message).with_help("the exact method has no such limit, where scattering is isotropic")
}

/// Finds an albedo a little above the one that makes a surface albedo, by short walks.
fn pilot(arguments: &ReferenceArguments, problem: &Problem, surface_albedo: f64) -> Result<f64, Failure> {
    let control = Control { stop: &interrupt::STOP, ..Control::default() };
    problem.pilot(surface_albedo, arguments.walk.seed(), &control).map_err(|error| match error {
        PilotError::Stopped => Failure::interrupted("nothing was walked yet"),
        PilotError::OutOfReach => out_of_reach(surface_albedo),
        PilotError::OutsideSlab { least, most } => {
            let message = format!(
                "--surface-albedo has {}, but this slab reflects from {least:.4} to {most:.4}",
                exact(surface_albedo)
            );
            Failure::input(message).with_help("the rest goes through or is absorbed")
        }
        PilotError::Table(TableError::Parameter(error)) => arguments.name_option(error),
        PilotError::Table(error) => table_failure(error),
    })
}

/// The lines of the printed table.
fn rows(
    arguments: &ReferenceArguments,
    table: &WhiteTable,
    radii: &[f64],
    albedos: &Albedos,
) -> Result<Vec<[f64; 6]>, Failure> {
    let pairs: Vec<(Option<f64>, f64)> = match albedos {
        Albedos::Known(list) => list.clone(),
        Albedos::Surface(list) => {
            let invert = |&albedo: &f64| {
                let alpha = table.single_scattering_albedo(albedo);
                alpha.map(|alpha| (Some(albedo), alpha.value)).map_err(|error| arguments.name_option(error))
            };
            list.iter().map(invert).collect::<Result<_, _>>()?
        }
    };
    let side = arguments.side();
    let mut rows = Vec::with_capacity(pairs.len() * radii.len());
    for (surface_albedo, alpha) in pairs {
        let at = table.at_albedo(alpha).map_err(|error| arguments.name_option(error))?;
        let surface_albedo = surface_albedo.unwrap_or_else(|| at.total(Side::Reflected).value);
        for (&radius, r) in radii.iter().zip(arguments.radii.iter()?) {
            let found = match arguments.azimuth {
                Some(degrees) => at.at_radius_and_azimuth(side, radius, degrees.to_radians()),
                None => at.at_radius(side, radius),
            };
            let found = found.map_err(|error| arguments.name_option(error))?;
            rows.push(super::row(
                [surface_albedo, alpha, r],
                arguments.mfp,
                found.reflectance,
                found.enclosed,
            ));
        }
    }
    Ok(rows)
}

/// Sectors of a half circle so that one of them is centered on a direction, or nearly: about 180, of one degree, or
/// as many as there is room for.
fn sectors(azimuth: f64, radii: usize) -> u32 {
    let most = (MOST_CELLS / (3 * radii + 1)).clamp(18, 180) as u32;
    let angle = azimuth.rem_euclid(360.0);
    let angle = angle.min(360.0 - angle);
    // How far the direction is from its sector's center, in degrees; the sectors at 0 and 180 are centered on these,
    // as both mirror images count
    let off = |sectors: &u32| {
        let width = 180.0 / f64::from(*sectors);
        let inside = angle / width;
        let center = ((inside.floor() + 0.5) * width - angle).abs();
        let edge = angle.min(180.0 - angle);
        if edge < 1e-9 { 0.0 } else { center }
    };
    (most - most / 3..=most).rev().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(most)
}

/// Table that an earlier run left in the file, if it is wanted and there.
fn earlier_table(arguments: &ReferenceArguments) -> Result<Option<WhiteTable>, Failure> {
    let Some(path) = arguments.table_file() else { return Ok(None) };
    match (arguments.walk.resume, path.exists()) {
        (true, true) => {
            let table = WhiteTable::load(path).map_err(table_failure)?;
            messages::line(&format!("continuing from {} photons", table.photons()));
            Ok(Some(table))
        }
        (true, false) => {
            messages::line(&format!("there is no {} yet: starting anew", path.display()));
            Ok(None)
        }
        (false, true) => Err(Failure::input(format!("{} exists already", path.display()))
            .with_help("--resume continues it; delete it to start anew")),
        (false, false) => Ok(None),
    }
}

/// Keeps the table where that is asked for.
fn save(arguments: &ReferenceArguments, table: &WhiteTable) -> Result<(), Failure> {
    arguments
        .table_file()
        .map_or(Ok(()), |path| translucid_files::write_atomically(path, |out| table.write(out)))
        .map_err(Failure::late)
}

fn foreign_table(arguments: &ReferenceArguments, what: &str) -> Failure {
    let walk = &arguments.walk;
    let resumed = arguments.table_file().filter(|path| walk.resume && path.exists());
    let path = resumed
        .or(walk.merge.first().map(PathBuf::as_path))
        .map_or(String::new(), |path| path.display().to_string());
    Failure::input(format!("the table {path} {what}"))
        .with_help("repeat the options that it was made with, or choose another file")
}

pub(super) fn table_failure(error: TableError) -> Failure {
    match error {
        TableError::TooMany => Failure::work(error.to_string()),
        error => Failure::input(error.to_string()),
    }
}

fn radius_error(arguments: &ReferenceArguments, error: &translucid_profile::ParameterError) -> Failure {
    let value = error.value * if error.parameter.contains("radi") { arguments.mfp } else { 1.0 };
    if error.parameter.contains('×') {
        let most = MOST_CELLS / 18 / 3;
        return Failure::input(format!(
            "there are too many radii for sectors of a direction: {most} at most"
        ));
    }
    let (name, value) = (error.parameter, exact(value));
    Failure::input(format!(
        "the walk's rings around --at or --points: {name} is {value}, but must be {}",
        error.requirement()
    ))
}
