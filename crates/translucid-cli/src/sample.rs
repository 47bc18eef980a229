//! `translucid sample`: radii drawn from a profile.

use clap::Args;
use translucid_laboratory::random;

use crate::failure::Failure;
use crate::model::ModelArguments;
use crate::table::TableArguments;

const EXAMPLES: &str = "\
Column: r, in the unit of --mfp or --dmfp, with --sigma-a and --sigma-s in its inverse.
Its density is 2 pi r R(r) / A.
normalized-diffusion is sampled in closed form, every other model by a table of its cdf (error below 1e-4).
Number i of a seed is the same whatever the count.

Examples:
  translucid sample --surface-albedo 0.8 --mfp 1 --count 1000
  translucid sample --surface-albedo 0.8 --mfp 1 --count 1000000 --seed 7 -o radii.csv
  translucid sample --model dipole --sigma-a 0.0021 --sigma-s 2.19 --count 1000
  translucid sample --table examples/measured.csv --surface-albedo 0.8 --mfp 2 --count 1000";

/// Draws radii from a reflectance profile
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SampleArguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Number of radii
    #[arg(long, value_name = "N")]
    count: u64,
    /// Seed of the random numbers
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    table: TableArguments,
}

/// Runs the verb.
pub(crate) fn run(arguments: &SampleArguments) -> Result<(), Failure> {
    arguments.table.spare(arguments.model.table_file().into_iter())?;
    let profile = arguments.model.profile_to_sample()?;
    let radius = |index| [profile.sample(random(arguments.seed, index))];
    arguments.table.write(["r"], (0..arguments.count).map(radius))
}
