//! `translucid profile`: a profile as a table.

use clap::Args;

use crate::failure::Failure;
use crate::model::ModelArguments;
use crate::radii::RadiiArguments;
use crate::table::TableArguments;

const EXAMPLES: &str = "\
Columns: r, reflectance R(r) per area, enclosed = integral of R 2 pi r' dr' from 0 to r.
Radii are in the unit of --mfp or --dmfp, with --sigma-a and --sigma-s in its inverse.
Lengths of a --table are in units of --mfp; `translucid reference` prints such tables.
R grows like 1/r towards r = 0, where it is a huge finite number in place of infinity.

Examples:
  translucid profile --surface-albedo 0.8 --mfp 1 --at 0.1,1,10
  translucid profile --surface-albedo 0.5 --dmfp 2 --points 1000 --max 20 -o profile.csv
  translucid profile --surface-albedo 0.8 --mfp 1 --configuration searchlight --at 1 --format json
  translucid profile --model photon-beam-diffusion --surface-albedo 0.8 --mfp 1 --g 0.5 --eta 1.4 --at 1
  translucid profile --model better-dipole --sigma-a 0.0021 --sigma-s 2.19 --at 0.1,1,10
  translucid profile --model gaussians --terms 2 --surface-albedo 0.8 --mfp 1 --at 0.1,1,10
  translucid profile --table examples/measured.csv --surface-albedo 0.8 --mfp 2 --at 0.1,1,10";

/// Prints a reflectance profile as a table
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ProfileArguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    radii: RadiiArguments,
    #[command(flatten)]
    table: TableArguments,
}

/// Runs the verb.
pub(crate) fn run(arguments: &ProfileArguments) -> Result<(), Failure> {
    arguments.table.spare(arguments.model.table_file().into_iter())?;
    let profile = arguments.model.profile()?;
    let columns = ["r", "reflectance", "enclosed"];
    let row = |r: f64| [r, profile.eval(r), profile.enclosed(r)];
    arguments.table.write(columns, arguments.radii.iter()?.map(row))
}
