//! `translucid compare`: every model beside the exact solution, as a page, figures and tables.

mod output;

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, ValueEnum};
use translucid_laboratory::comparison::{Comparison, Contender, Settings, Stopped, Watch};
use translucid_laboratory::figures::Report;
use translucid_profile::{Configuration, Model};

use crate::failure::Failure;
use crate::files::Directory;
use crate::progress::{Meter, Unit};
use crate::reference::parse_photons;
use crate::table::exact;
use crate::{interrupt, machine, messages};

const EXAMPLES: &str = "\
The medium is a half space of isotropic scatterers (g = 0) without a boundary (eta = 1); lengths are mean free
paths. Every model has the same surface albedo and is compared with the exact solution; photons that walk
through the same medium are an independent check in every figure.

DIR/index.html shows and explains everything and is self-contained. Beside it are NAME.svg and NAME.csv
for each figure NAME, and tables with stable columns:
  errors.csv       model, configuration, medium, surface_albedo, r_max, error
                   the area-weighted L1 distance from the exact solution: the integral of |R_model - R| 2 pi r dr
                   over that of R 2 pi r dr up to r_max; empty means all radii. medium: \"own\" is the one for which
                   the model returns the surface albedo, \"exact\" the one for which the exact solution does.
  timing.csv       model, quantity, nanoseconds, median_nanoseconds, rounds
                   one call; lower decile and median over rounds in which all calls take turns.
  reflectance.csv  configuration, surface_albedo, model, r, reflectance, enclosed
  monte-carlo.csv  configuration, surface_albedo, single_scattering_albedo, r, reflectance, standard_error, exact,
                   photons
  scaling.csv      configuration, parameter, surface_albedo, s, error
  samples.csv      model, surface_albedo, left, right, count, expected
  fresnel.csv      side, eta, degrees, fresnel, schlick

Options and seed determine every byte, whatever the threads, except times: timing.csv, times.csv,
error-against-time-*, and the page that shows them.

Examples:
  translucid compare
  translucid compare -o comparison --surface-albedo 0.2,0.5,0.8
  translucid compare -o dipoles --models normalized-diffusion,dipole,better-dipole --configuration searchlight
  translucid compare -o fine --surface-albedo 0.95 --max-radius 40 --photons 1e8 --seed 7";

/// Compares the models with the exact solution: curves, errors and times as a page, figures and tables
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CompareArguments {
    /// Directory to write to
    #[arg(short, long, value_name = "DIR", default_value = "comparison")]
    output: PathBuf,
    /// Surface albedos that get figures, each in (0, 1]
    #[arg(
        long,
        value_name = "A,...",
        value_delimiter = ',',
        default_value = "0.2,0.5,0.8",
        allow_negative_numbers = true
    )]
    surface_albedo: Vec<f64>,
    /// Models, variants and fits to compare [default: all]
    #[arg(
        long,
        value_name = "MODEL,...",
        value_delimiter = ',',
        value_parser = PossibleValuesParser::new(names())
    )]
    models: Vec<String>,
    /// How light enters the medium
    #[arg(long, value_enum, default_value = "both")]
    configuration: Configurations,
    /// Greatest radius of the figures, in mean free paths
    #[arg(long, value_name = "R", default_value_t = 16.0, allow_negative_numbers = true)]
    max_radius: f64,
    /// Number of photons that walk in each configuration; 0 for none
    #[arg(long, value_name = "N", default_value = "4e6", value_parser = parse_photons)]
    photons: u64,
    /// Number of radii drawn from each model; 0 for none
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(..=1_000_000_000))]
    samples: u64,
    /// Number of rounds in which calls are timed, at most 1000; 0 for no times
    #[arg(long, value_name = "N", default_value_t = 80, value_parser = clap::value_parser!(u16).range(..=1000))]
    timing_rounds: u16,
    /// Seed of the photons and of the radii
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Number of threads, at most 1024 [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// One configuration or both.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Configurations {
    /// A pencil beam enters perpendicularly
    Searchlight,
    /// Light enters with a cosine distribution
    Diffuse,
    /// Both
    Both,
}

/// Most albedos of one page.
const MOST_ALBEDOS: usize = 20;
/// Radii that figures can end at.
const MAX_RADII: std::ops::RangeInclusive<f64> = 0.5..=1000.0;
/// Least surface albedo: below it there is next to nothing to see, or to count.
const LEAST_ALBEDO: f64 = 1e-6;
/// Parts of the work that the drawing is.
const DRAWING: f64 = 0.2;

/// Runs the verb.
pub(crate) fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    let settings = arguments.settings()?;
    let pool = machine::threads(arguments.threads)?;
    let count = Directory::fill(&arguments.output, |directory| {
        output::check(directory)?;
        interrupt::catch("\nstopping; nothing has been written yet")?;
        let meter = Meter::new(Unit::Parts);
        let progress = |done: f64| meter.update((1e6 * done) as u64, 1_000_000);
        let compute = |done: f64| progress((1.0 - DRAWING) * done);
        let draw = |done: f64| progress(1.0 - DRAWING + DRAWING * done);
        let files = pool.install(|| {
            let watch = Watch { stop: &interrupt::STOP, progress: &compute };
            let comparison = Comparison::new(settings, watch).map_err(stopped)?;
            output::draw(&Report::new(&comparison), &draw)
        });
        meter.finish();
        let files = files?;
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(stopped(Stopped));
        }
        // Files of two comparisons beside each other would be worse than the moment that the rest takes
        interrupt::catch("\nall files are being written; press Ctrl-C again to end at once")?;
        directory.write(&files)?;
        Ok(files.len())
    })?;
    let page = arguments.output.join(output::PAGE);
    messages::line(&format!("{count} files in {}; open {}", arguments.output.display(), page.display()));
    Ok(())
}

/// Ctrl-C.
fn stopped(_: Stopped) -> Failure {
    Failure::interrupted("nothing was written; fewer --models or --photons take less time")
}

/// Values of `--models`, and a model that it refuses with a reason.
fn names() -> Vec<PossibleValue> {
    let mut names: Vec<PossibleValue> = Contender::names().into_iter().map(PossibleValue::new).collect();
    names.push(PossibleValue::new(OBLIQUE.name()).hide(true));
    names
}

/// A model that is not compared: its profile is no function of the radius alone.
const OBLIQUE: Model = Model::NormalizedDiffusionOblique;

impl CompareArguments {
    /// Settings that the options ask for.
    fn settings(&self) -> Result<Settings, Failure> {
        let albedos = &self.surface_albedo;
        if let Some(a) = albedos.iter().find(|a| !(LEAST_ALBEDO..=1.0).contains(*a)) {
            let message = format!("--surface-albedo is {}, but must be in [0.000001, 1]", exact(*a));
            return Err(Failure::input(message)
                .with_help("without any light that comes back there is nothing to compare"));
        }
        if albedos.len() > MOST_ALBEDOS {
            let message = format!(
                "--surface-albedo has {} values, but at most {MOST_ALBEDOS} fit on a page",
                albedos.len()
            );
            return Err(Failure::input(message).with_help("compare the others in another directory"));
        }
        if let Some(i) = (1..albedos.len()).find(|i| albedos[..*i].contains(&albedos[*i])) {
            return Err(Failure::input(format!("--surface-albedo has {} twice", exact(albedos[i]))));
        }
        let models = &self.models;
        if let Some(i) = (1..models.len()).find(|i| models[..*i].contains(&models[*i])) {
            return Err(Failure::input(format!("--models has {} twice", models[i])));
        }
        if models.iter().any(|name| name == OBLIQUE.name()) {
            let message = format!("--models has {OBLIQUE}, whose light may come at any angle");
            let same = Model::NormalizedDiffusionRefined;
            return Err(Failure::input(message)
                .with_help(format!("for perpendicular light it is the same as {same}")));
        }
        if !MAX_RADII.contains(&self.max_radius) {
            let found = exact(self.max_radius);
            let message = format!("--max-radius is {found}, but must be in [0.5, 1000] mean free paths");
            return Err(Failure::input(message));
        }
        let mut contenders = Contender::all();
        if !self.models.is_empty() {
            contenders.retain(|one| self.models.iter().any(|name| name == one.name));
        }
        let configurations = match self.configuration {
            Configurations::Searchlight => vec![Configuration::Searchlight],
            Configurations::Diffuse => vec![Configuration::Diffuse],
            Configurations::Both => vec![Configuration::Searchlight, Configuration::Diffuse],
        };
        if let Some(one) = contenders.iter().find(|one| !configurations.iter().any(|c| one.knows(*c))) {
            let message = format!("--models has {}, which knows a perpendicular pencil beam only", one.name);
            return Err(Failure::input(message).with_help("leave it out, or use --configuration both"));
        }
        Ok(Settings {
            contenders,
            surface_albedos: albedos.clone(),
            configurations,
            max_radius: self.max_radius,
            photons: self.photons,
            seed: self.seed,
            samples: self.samples,
            timing_rounds: usize::from(self.timing_rounds),
            ..Settings::default()
        })
    }
}
