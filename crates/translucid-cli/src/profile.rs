//! `translucid profile`: a profile as a table.

use clap::Args;

use crate::failure::Failure;
use crate::model::ModelArguments;
use crate::table::{TableArguments, exact};

const EXAMPLES: &str = "\
Columns: r, reflectance R(r) per area, enclosed = integral of R 2 pi r' dr' from 0 to r.
Radii are in the unit of --mfp or --dmfp.
R grows like 1/r towards r = 0, where a huge finite number stands for infinity.

Examples:
  translucid profile --surface-albedo 0.8 --mfp 1 --at 0.1,1,10
  translucid profile --surface-albedo 0.5 --dmfp 2 --points 1000 --max 20 -o profile.csv
  translucid profile --surface-albedo 0.8 --mfp 1 --configuration searchlight --at 1 --format json";

/// Prints a reflectance profile as a table
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Radii, comma-separated
    #[arg(
        long,
        value_name = "R1,R2,...",
        value_delimiter = ',',
        allow_negative_numbers = true,
        required_unless_present = "points",
        conflicts_with_all = ["points", "max"]
    )]
    at: Vec<f64>,
    /// Number of evenly spaced radii max/N, 2 max/N, ..., max
    #[arg(long, value_name = "N", requires = "max", value_parser = clap::value_parser!(u32).range(1..))]
    points: Option<u32>,
    /// Largest radius of --points
    #[arg(long, value_name = "R", requires = "points", allow_negative_numbers = true)]
    max: Option<f64>,
    #[command(flatten)]
    table: TableArguments,
}

/// Runs the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let profile = arguments.model.profile()?;
    let columns = ["r", "reflectance", "enclosed"];
    let row = |r: f64| [r, profile.eval(r), profile.enclosed(r)];
    match (arguments.points, arguments.max) {
        (Some(points), Some(max)) => {
            require_radius("--max", max)?;
            if max == 0.0 {
                return Err(Failure::input("--max is 0, but must be greater"));
            }
            let radius = |i: u32| max * (f64::from(i) / f64::from(points));
            arguments.table.write(columns, (1..=points).map(radius).map(row))
        }
        _ => {
            arguments.at.iter().try_for_each(|&r| require_radius("--at", r))?;
            arguments.table.write(columns, arguments.at.iter().copied().map(row))
        }
    }
}

fn require_radius(option: &str, r: f64) -> Result<(), Failure> {
    if r >= 0.0 && r.is_finite() {
        return Ok(());
    }
    let r = exact(r);
    Err(Failure::input(format!("{option} has the radius {r}, but radii must be finite and at least 0")))
}
