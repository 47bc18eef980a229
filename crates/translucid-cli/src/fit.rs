//! `translucid fit`: simple profiles fitted to the exact half space, or to a table of a user's own.

mod albedos;
mod half_space;
mod output;
mod report;
mod table;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use translucid_profile::{Configuration, Parameterization};

use crate::failure::Failure;
use crate::model::ConfigurationName;
use crate::table::exact;

const EXAMPLES: &str = "\
Fits the exact half space (isotropic scattering, no boundary) at the surface albedos 0.01, 0.02, ..., 0.99.

Columns for burley: surface_albedo, s, error; the width of the profile is d = length/s, and s minimizes the
error. A polynomial of the form of Christensen and Burley 2015 is fitted to these points with the least mean error.
Without --configuration and --parameter the three cases of the talk are fitted, and all tables begin with the
columns configuration, parameter. The report gives the radii for which the mean error is that of the talk.
Columns for exponentials: surface_albedo, weight_1, rate_1, ..., error; the profile is
A/(2 pi r) (weight_1 rate_1 exp(-rate_1 r/length) + ...)/length, fitted by least squares.

length is the mean free path or the diffuse mean free path, by --parameter. error is the area-weighted
L1 distance: the integral of |R_fit - R| 2 pi r dr over that of R 2 pi r dr, up to --max-radius.

The table goes to stdout, the report to stderr. With -o both go to files of a directory: points.csv,
errors.csv, report.txt and, for burley, coefficients.csv.

With --table, normalized diffusion, exponentials and Gaussians are fitted to your file by least squares of
(fit - reflectance)/error; without errors each line has the same error relative to the best fit. Columns: fit,
parameter, value, standard_error, which is empty if nothing limits the parameter; a warning names parameters that
the file does not determine (error above a third of the value). Lengths are in the unit of r. With -o the files are
parameters.csv, residuals.csv (fit - reflectance in units of the error; without errors, of the reflectance), the
same drawn over r as residuals.svg, and report.txt.

With --table and --family half-space the exact half space of isotropic scatterers is fitted to the file: sigma_a and
sigma_s_prime, in 1 over the unit of r, and from these the mean free path mfp and the surface_albedo of the light
that enters. reflectance is the light that leaves over the light that falls on the medium, of which a boundary
(--eta) lets less enter.

With --gamma the second similarity parameter gamma = (1 - g2)/(1 - g1) of the phase function is fitted besides, g1
and g2 being its first two Legendre moments; it decides R(r) nearer than some transport mean free paths. Higher
moments are taken for those of a forward peak (Henyey-Greenstein, g = 0.85) on an isotropic ground. The report has
the correlations, and with -o they are in correlations.csv.

Examples:
  translucid fit --family burley
  translucid fit --configuration searchlight --parameter mfp --family burley
  translucid fit --configuration diffuse --parameter mfp --family burley --max-radius 8 -o fit
  translucid fit --configuration searchlight --parameter dmfp --family exponentials --terms 3 -o fit
  translucid fit --table examples/measured.csv --terms 2
  translucid fit --table examples/measured.csv --family half-space --eta 1.4
  translucid fit --table examples/measured.csv --family half-space --eta 1.4 --gamma";

/// Fits simple profiles to the exact one, and prints their errors
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FitArguments {
    /// How light enters the medium; for burley [default: all cases of the talk], for half-space [default: searchlight]
    #[arg(long)]
    configuration: Option<ConfigurationName>,
    /// Length in which the fit is expressed; for burley [default: all cases of the talk]
    #[arg(long, value_enum)]
    parameter: Option<ParameterName>,
    /// Family of functions to fit
    #[arg(long, value_enum, required_unless_present = "table")]
    family: Option<FamilyName>,
    /// Number of exponentials, with --table also of Gaussians, 1 to 8 [default: 3, with --table 2]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=8))]
    terms: Option<u32>,
    /// Greatest radius that counts in the error, in mean free paths [default: infinite]
    #[arg(long, value_name = "R", default_value_t = f64::INFINITY, hide_default_value = true, allow_negative_numbers = true)]
    max_radius: f64,
    /// CSV file of a profile of your own to fit: columns r, reflectance and optionally error
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["parameter", "max_radius"]
    )]
    table: Option<PathBuf>,
    /// Relative index of refraction of the half space's boundary, in [0.5, 3]; 1 is none
    #[arg(long, value_name = "ETA", default_value_t = 1.0, hide_default_value = true)]
    eta: f64,
    /// Fit the second similarity parameter of the half space's phase function, too
    #[arg(long)]
    gamma: bool,
    #[command(flatten)]
    output: output::OutputArguments,
}

/// Lengths of a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ParameterName {
    /// Mean free path in the volume
    Mfp,
    /// Diffuse mean free path on the surface
    Dmfp,
}

/// Families of profiles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FamilyName {
    /// Normalized diffusion
    Burley,
    /// A sum of exponentials over r
    Exponentials,
    /// The exact half space, to a table
    HalfSpace,
}

/// Runs the verb.
pub(crate) fn run(arguments: &FitArguments) -> Result<(), Failure> {
    let terms = |default: u32| arguments.terms.unwrap_or(default) as usize;
    let is_half_space = arguments.family == Some(FamilyName::HalfSpace);
    if arguments.eta != 1.0 && !is_half_space {
        return Err(Failure::input("--eta is for --family half-space"));
    }
    if arguments.gamma && !is_half_space {
        return Err(Failure::input("--gamma is for --family half-space"));
    }
    if arguments.gamma && arguments.configuration == Some(ConfigurationName::Diffuse) {
        return Err(Failure::input("--gamma is for --configuration searchlight, but it is diffuse"));
    }
    if is_half_space && arguments.terms.is_some() {
        return Err(Failure::input("--terms is for sums, but the family is half-space"));
    }
    match (&arguments.table, arguments.family) {
        (Some(path), Some(FamilyName::HalfSpace)) => return table::run_half_space(arguments, path),
        (Some(path), None) if arguments.configuration.is_none() => {
            return table::run(arguments, path, terms(2));
        }
        (Some(_), None) => {
            return Err(Failure::input("--configuration is for --family half-space with --table"));
        }
        (Some(_), Some(_)) => {
            return Err(Failure::input(
                "--family is half-space with --table, or none: then all sums are fitted",
            ));
        }
        (None, Some(FamilyName::HalfSpace)) => return Err(needs_table()),
        (None, _) => {}
    }
    let r_max = arguments.max_radius;
    if r_max.is_nan() || r_max < 1e-3 {
        let message = format!("--max-radius is {}, but must be at least 0.001 mean free paths", exact(r_max));
        return Err(Failure::input(message));
    }
    if arguments.family == Some(FamilyName::Burley) && arguments.terms.is_some() {
        return Err(Failure::input("--terms is for --family exponentials, but the family is burley"));
    }
    if arguments.is_all_of_the_talk() {
        return albedos::burley_of_the_talk(r_max, &arguments.output);
    }
    let case = arguments.case()?;
    match case.family {
        FamilyName::Burley => albedos::burley(&case, &arguments.output),
        FamilyName::Exponentials => albedos::exponentials(&case, terms(3), &arguments.output),
        FamilyName::HalfSpace => Err(needs_table()),
    }
}

fn needs_table() -> Failure {
    Failure::input("--family half-space fits a --table")
}

impl FitArguments {
    /// Whether every case that the talk has a polynomial for is asked for.
    fn is_all_of_the_talk(&self) -> bool {
        let [no_configuration, no_parameter] = [self.configuration.is_none(), self.parameter.is_none()];
        self.family == Some(FamilyName::Burley) && no_configuration && no_parameter
    }

    fn case(&self) -> Result<Case, Failure> {
        let missing = |option: &str| Failure::input(format!("{option} is missing"));
        Ok(Case {
            configuration: self.configuration.ok_or_else(|| missing("--configuration"))?.into(),
            parameterization: match self.parameter.ok_or_else(|| missing("--parameter"))? {
                ParameterName::Mfp => Parameterization::Mfp,
                ParameterName::Dmfp => Parameterization::Dmfp,
            },
            family: self.family.ok_or_else(|| missing("--family"))?,
            max_radius: self.max_radius,
        })
    }
}

/// Task of fitting a family to the exact half space.
#[derive(Clone, Copy, Debug)]
struct Case {
    configuration: Configuration,
    parameterization: Parameterization,
    family: FamilyName,
    /// In mean free paths.
    max_radius: f64,
}
