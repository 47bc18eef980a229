//! `translucid reference`: ground truth as a table.

mod exact_method;
mod layers_method;
mod layers_walk;
mod mci_method;
mod merging;
mod photons;
mod walk_method;

pub(crate) use merging::merge_tables;
pub(crate) use photons::parse_photons;

use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args, ValueEnum};
use translucid_desk::{is_phase_file, read_phase_file};
use translucid_reference::exact::single_scattering_albedo;
use translucid_reference::walk::{Parameters, PhaseFunction, Problem, Side};
use translucid_reference::{Estimate, Incidence};

use crate::failure::Failure;
use crate::machine;
use crate::messages;
use crate::model::ConfigurationName;
use crate::radii::RadiiArguments;
use crate::table::{TableArguments, exact};

const EXAMPLES: &str = "\
Columns: surface_albedo, single_scattering_albedo, r, reflectance R(r) per area, enclosed = integral of
R 2 pi r' dr' from 0 to r, standard_error of reflectance (exact: an estimate of its numerical error).
Lengths are in the unit of --mfp. Everything is per unit of flux that has entered the medium, without the light
that the boundary reflects outside.

The exact method covers the half space with isotropic scattering (g = 0) and any boundary; the walk covers
everything. Its reflectance is the mean over a ring around r, of half width min(0.02 r, 0.05 mean free paths), or
less if radii are dense; enclosed has no such width. With --azimuth it is the mean over a sector of that ring, one
degree wide, or up to 10 with many radii.
R grows like 1/r towards r = 0, where the exact method prints a huge finite number and the walk has no ring.

--layers solves plane layers that a file states, per unit of flux that arrives from above, what their faces reflect
included. Without radii it prints totals: what is reflected (specular: never scattered), transmitted, and absorbed by each
layer. With radii it prints R(r) and T(r) of a searchlight, scattered light only, with their errors. A walk prints totals,
with what is reflected in one sum.

One walk serves all albedos of the list. --table keeps its photons in a file, which --resume continues and --merge
joins to others; no photon counts twice. With --photons A..B many machines share a walk: their tables, merged in
any order, are bit for bit the table of one run.

--layers FILE.mci walks the photons of every run of an .mci file (MCML 1.2, lengths in cm). Each run's .mco file is written
beside it, under the name that the run gives; -o FILE.mco names that of a file with one run, -o FILE.csv makes a table
with standard errors of all runs. --seed and --threads are the walk's.

Examples:
  translucid reference --method exact --configuration searchlight --surface-albedo 0.2,0.5,0.8 --at 0.1,1,10
  translucid reference --method exact --single-scattering-albedo 0.9 --eta 1.4 --points 100 --max 10
  translucid reference --layers examples/layers/skin.toml --incidence-angle 45
  translucid reference --layers examples/layers/paint.toml --at 0.1,1,10
  translucid reference --method monte-carlo --single-scattering-albedo 0.9,0.99 --g 0.8 --error 0.01 --at 1,3
  translucid reference --method monte-carlo --single-scattering-albedo 0.9 --phase-function two-term:0.9,0.8,-0.3 --at 1
  translucid reference --method monte-carlo --surface-albedo 0.5 --thickness 2 --photons 1e8 --at 1
  translucid reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 --table walk.npz --resume
  translucid reference --method monte-carlo --single-scattering-albedo 0.9 --at 1 --photons 1e9..2e9 -o part-1.npz
  translucid reference --layers examples/layers/skin.mci";

/// Prints the true reflectance profile: solved exactly, or by a Monte Carlo walk with standard errors
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, group(ArgGroup::new("albedos").required(true)))]
pub(crate) struct ReferenceArguments {
    /// How to find the truth [default: exact, but monte-carlo for --layers FILE.mci]
    #[arg(long, value_enum)]
    method: Option<Method>,
    /// How light enters the medium [default: diffuse, but searchlight with --incidence-angle or --layers]
    #[arg(long)]
    configuration: Option<ConfigurationName>,
    /// Single-scattering albedos, each in (0, 1], comma-separated
    #[arg(
        long,
        value_name = "A1,A2,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        group = "albedos"
    )]
    single_scattering_albedo: Vec<f64>,
    /// Surface albedos, each in (0, 1), comma-separated, from which the single-scattering albedos follow
    #[arg(
        long,
        value_name = "A1,A2,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        group = "albedos"
    )]
    surface_albedo: Vec<f64>,
    /// File of plane layers in place of one medium: .toml, whose totals are printed where there are no radii, or MCML's .mci,
    /// whose runs are walked
    #[arg(
        long,
        value_name = "FILE",
        group = "albedos",
        conflicts_with_all = ["mfp", "g", "phase_function", "eta", "azimuth", "thickness", "side", "spot_radius"]
    )]
    layers: Option<PathBuf>,
    /// Error of the exact solution of layers at which no finer rule is needed [default: 1e-6 of the light in totals, 1e-4 of
    /// the value in profiles; from 5e-3 on these are two to six times faster]
    #[arg(long, value_name = "PART", requires = "layers", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Absorption coefficients in place of the layers' own, one for each layer, for --method monte-carlo; given several times,
    /// each set has its rows, and one walk serves all
    #[arg(long, value_name = "A1,A2,...", requires = "layers", allow_hyphen_values = true)]
    absorption: Vec<String>,
    /// Mean free path in the volume [any unit; all lengths are in the same]
    #[arg(long, value_name = "L", default_value_t = 1.0, allow_negative_numbers = true)]
    mfp: f64,
    /// Mean cosine of the phase function, in (-1, 1)
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    g: f64,
    /// Phase function: henyey-greenstein with --g, rayleigh, two-term:W,G1,G2 (parts W and 1 - W of two Henyey-Greenstein
    /// functions), moments:X1,X2,... (Legendre moments from the first on), or a FILE.csv with the columns cosine or degrees,
    /// and phase_function
    #[arg(long, value_name = "NAME|FILE.csv", default_value = "henyey-greenstein")]
    phase_function: String,
    /// Relative index of refraction, inside over outside
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
    eta: f64,
    /// Angle of incidence of the searchlight, outside, in degrees from the normal
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    incidence_angle: Option<f64>,
    /// Direction from the entry point, in degrees from the direction of the tilted beam
    /// [default: the mean over all directions]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, requires = "incidence_angle")]
    azimuth: Option<f64>,
    /// Thickness of a slab [default: a half space]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    thickness: Option<f64>,
    /// Side of the slab where light is collected
    #[arg(long, value_enum, default_value_t = SideName::Reflected)]
    side: SideName,
    /// Radius of the disc over which light enters evenly
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true)]
    spot_radius: f64,
    #[command(flatten)]
    walk: walk_method::WalkArguments,
    #[command(flatten)]
    radii: RadiiArguments,
    #[command(flatten)]
    table: TableArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    /// The solved half space; isotropic scattering
    Exact,
    /// A walk of photons
    MonteCarlo,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum SideName {
    /// Where light enters
    Reflected,
    /// The other face
    Transmitted,
}

const COLUMNS: [&str; 6] =
    ["surface_albedo", "single_scattering_albedo", "r", "reflectance", "enclosed", "standard_error"];

/// Runs the verb.
pub(crate) fn run(arguments: &ReferenceArguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.layers {
        let is_mci = file.extension().is_some_and(|found| found.eq_ignore_ascii_case("mci"));
        let run = if is_mci { mci_method::run } else { layers_method::run };
        return machine::threads(arguments.walk.threads)?.install(|| run(arguments, file));
    }
    let problem = arguments.problem()?;
    arguments.check_albedos()?;
    machine::threads(arguments.walk.threads)?.install(|| match arguments.method.unwrap_or(Method::Exact) {
        Method::Exact => exact_method::run(arguments, &problem),
        Method::MonteCarlo => walk_method::run(arguments, &problem),
    })
}

impl ReferenceArguments {
    /// Checks what both methods share, and turns lengths into mean free paths.
    fn problem(&self) -> Result<Problem, Failure> {
        require_positive("--mfp", self.mfp)?;
        if !(1e-100..=1e100).contains(&self.mfp) {
            let message = format!("--mfp is {}, but must be in [1e-100, 1e100]", exact(self.mfp));
            return Err(Failure::input(message));
        }
        if let Some(thickness) = self.thickness {
            require_positive("--thickness", thickness)?;
        }
        if self.side == SideName::Transmitted && self.thickness.is_none() {
            return Err(Failure::input("--side transmitted needs the thickness of a slab")
                .with_help("give --thickness; nothing comes out at the far end of a half space"));
        }
        Problem::new(Parameters {
            phase_function: self.phase_function()?,
            eta: self.eta,
            thickness: self.thickness.unwrap_or(f64::INFINITY) / self.mfp,
            incidence: self.incidence()?,
            spot_radius: self.spot_radius / self.mfp,
        })
        .map_err(|error| self.name_option(error))
    }

    fn phase_function(&self) -> Result<PhaseFunction, Failure> {
        let text = &self.phase_function;
        if is_phase_file(text) {
            if self.g != 0.0 {
                let g = exact(self.g);
                return Err(Failure::input(format!("--g is {g}, but {text} states the mean cosine")));
            }
            let phase_function = read_phase_file(Path::new(text))?;
            phase_function
                .warning()
                .iter()
                .for_each(|warning| messages::print_warning(&format!("{text}: {warning}")));
            return Ok(phase_function);
        }
        let found = PhaseFunction::parse(text, self.g).map_err(|problem| {
            let option = if problem.starts_with("g is") { "--" } else { "--phase-function " };
            Failure::input(format!("{option}{problem}"))
        })?;
        found.ok_or_else(|| {
            let known = PhaseFunction::WORDS.join(", ");
            Failure::input(format!(
                "--phase-function is \"{text}\", but must be one of {known}, or a FILE.csv"
            ))
        })
    }

    fn incidence(&self) -> Result<Incidence, Failure> {
        let Some(degrees) = self.incidence_angle else {
            return Ok(match self.configuration {
                Some(ConfigurationName::Searchlight) => Incidence::NORMAL,
                None if self.layers.is_some() => Incidence::NORMAL,
                Some(ConfigurationName::Diffuse) | None => Incidence::Cosine,
            });
        };
        if self.configuration == Some(ConfigurationName::Diffuse) {
            return Err(Failure::input("--incidence-angle belongs to a beam, not to diffuse light")
                .with_help("leave --configuration out, or let it be searchlight"));
        }
        if !(0.0..90.0).contains(&degrees) {
            let degrees = exact(degrees);
            return Err(Failure::input(format!("--incidence-angle is {degrees}, but must be in [0, 90)")));
        }
        if let Some(azimuth) = self.azimuth.filter(|azimuth| !azimuth.is_finite()) {
            return Err(Failure::input(format!("--azimuth is {}, but must be finite", exact(azimuth))));
        }
        Ok(Incidence::Pencil { cos_theta: degrees.to_radians().cos() })
    }

    /// A parameter's error in the words of the command line.
    fn name_option(&self, error: translucid_profile::ParameterError) -> Failure {
        if error.parameter == "cos_theta" && self.eta < 1.0 {
            let limit = exact((1e4 * self.eta.asin().to_degrees()).floor() * 1e-4);
            let angle = exact(self.incidence_angle.unwrap_or_default());
            return Failure::input(format!(
                "--incidence-angle is {angle}, but must be below asin(eta) = {limit}"
            ))
            .with_help("beyond that angle no light enters");
        }
        let (option, value) = match error.parameter {
            "g" => ("--g", self.g),
            "eta" => ("--eta", self.eta),
            "thickness" => ("--thickness over --mfp", error.value),
            "cos_theta" => ("the cosine of --incidence-angle", error.value),
            "spot_radius" => ("--spot-radius over --mfp", error.value),
            "single_scattering_albedo" => ("--single-scattering-albedo", error.value),
            "surface_albedo" => ("--surface-albedo", error.value),
            other => (other, error.value),
        };
        let failure =
            Failure::input(format!("{option} is {}, but must be {}", exact(value), error.requirement()));
        if error.allowed.contains("exact solution") {
            return failure.with_help("use --method monte-carlo, which has no such limit");
        }
        failure
    }

    fn check_albedos(&self) -> Result<(), Failure> {
        for (option, albedos, most, range) in [
            ("--single-scattering-albedo", &self.single_scattering_albedo, 1.0, "(0, 1]"),
            ("--surface-albedo", &self.surface_albedo, 1.0_f64.next_down(), "(0, 1)"),
        ] {
            if let Some(&found) = albedos.iter().find(|albedo| !(**albedo > 0.0 && **albedo <= most)) {
                let found = exact(found);
                return Err(Failure::input(format!("{option} has {found}, but must be in {range}")));
            }
        }
        Ok(())
    }

    /// Surface albedo, where it was given, and single-scattering albedo of every part of the table, by the exact solution.
    fn albedos(&self, problem: &Problem) -> Result<Vec<(Option<f64>, f64)>, Failure> {
        if !self.single_scattering_albedo.is_empty() {
            return Ok(self.single_scattering_albedo.iter().map(|&alpha| (None, alpha)).collect());
        }
        let parameters = problem.parameters();
        let invert = |&surface_albedo: &f64| {
            let alpha = single_scattering_albedo(surface_albedo, parameters.eta, parameters.incidence);
            alpha.map(|alpha| (Some(surface_albedo), alpha)).map_err(|error| self.name_option(error))
        };
        self.surface_albedo.iter().map(invert).collect()
    }

    /// The file that keeps the walk's table: --table, or -o where that names an NPZ file.
    fn table_file(&self) -> Option<&Path> {
        self.walk.table_file.as_deref().or(self.table.npz())
    }

    fn side(&self) -> Side {
        match self.side {
            SideName::Reflected => Side::Reflected,
            SideName::Transmitted => Side::Transmitted,
        }
    }
}

/// A line of the table: albedos and radius, then what was found, lengths turned back into the unit of the mean free path.
fn row(
    [surface_albedo, alpha, r]: [f64; 3],
    mfp: f64,
    reflectance: Estimate,
    enclosed: Estimate,
) -> [f64; 6] {
    let per_area = |value: f64| (value / mfp / mfp).min(f64::MAX);
    let (reflectance, error) = (per_area(reflectance.value), per_area(reflectance.error));
    [surface_albedo, alpha, r, reflectance, enclosed.value, error]
}

fn require_positive(option: &str, value: f64) -> Result<(), Failure> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(Failure::input(format!("{option} is {}, but must be finite and greater than 0", exact(value))))
}
