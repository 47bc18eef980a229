//! `translucid fit`: simple profiles fitted to the exact half space.

mod albedos;
mod output;
mod report;

use clap::{Args, ValueEnum};
use translucid_profile::{Configuration, Parameterization};

use crate::failure::Failure;
use crate::model::ConfigurationName;
use crate::table::exact;

const EXAMPLES: &str = "\
Fits the exact half space (isotropic scattering, no boundary) at the surface albedos 0.01, 0.02, ..., 0.99.

Columns for burley: surface_albedo, s, error; the width of the profile is d = length/s, and s is what
minimizes the error. A polynomial of the form that Christensen and Burley 2015 give is fitted to these points
such that the mean error is least.
Columns for exponentials: surface_albedo, weight_1, rate_1, ..., error; the profile is
A/(2 pi r) (weight_1 rate_1 exp(-rate_1 r/length) + ...)/length, fitted by least squares.

length is the mean free path or the diffuse mean free path, as --parameter says. error is the area-weighted
L1 distance: the integral of |R_fit - R| 2 pi r dr over that of R 2 pi r dr, up to --max-radius.

The table goes to stdout, the report to stderr. With -o both go to files of a directory: points.csv,
errors.csv, report.txt and, for burley, coefficients.csv.

Examples:
  translucid fit --configuration searchlight --parameter mfp --family burley
  translucid fit --configuration diffuse --parameter mfp --family burley --max-radius 8 -o fit
  translucid fit --configuration searchlight --parameter dmfp --family exponentials --terms 3 -o fit";

/// Fits simple profiles to the exact one, and prints how far they are
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    /// How light enters the medium
    #[arg(long)]
    configuration: ConfigurationName,
    /// Length that the fit is in
    #[arg(long, value_enum)]
    parameter: ParameterName,
    /// What is fitted
    #[arg(long, value_enum)]
    family: FamilyName,
    /// Number of exponentials, 1 to 8 [default: 3]
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..=8))]
    terms: Option<u32>,
    /// Greatest radius that counts in the error, in mean free paths [default: all count]
    #[arg(long, value_name = "R", default_value_t = f64::INFINITY, hide_default_value = true, allow_negative_numbers = true)]
    max_radius: f64,
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
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let r_max = arguments.max_radius;
    if r_max.is_nan() || r_max < 1e-3 {
        let message = format!("--max-radius is {}, but must be at least 0.001 mean free paths", exact(r_max));
        return Err(Failure::input(message));
    }
    match (arguments.family, arguments.terms) {
        (FamilyName::Burley, Some(_)) => {
            Err(Failure::input("--terms is for --family exponentials, but the family is burley"))
        }
        (FamilyName::Burley, None) => albedos::burley(arguments),
        (FamilyName::Exponentials, terms) => albedos::exponentials(arguments, terms.unwrap_or(3) as usize),
    }
}

impl Arguments {
    fn configuration(&self) -> Configuration {
        match self.configuration {
            ConfigurationName::Searchlight => Configuration::Searchlight,
            ConfigurationName::Diffuse => Configuration::Diffuse,
        }
    }

    fn parameterization(&self) -> Parameterization {
        match self.parameter {
            ParameterName::Mfp => Parameterization::Mfp,
            ParameterName::Dmfp => Parameterization::Dmfp,
        }
    }
}
