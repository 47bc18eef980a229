//! `translucid oracle`: tables of light under surfaces, for tests of other programs.

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use clap::Args;
use clap::builder::PossibleValuesParser;
use translucid_files::check_writable;
use translucid_laboratory::comparison::{Stopped, Watch};
use translucid_laboratory::oracle::{
    ORACLE_PHOTONS, SCHEMA_FILE, oracle_names, oracle_schema, oracle_tables,
};

use crate::failure::Failure;
use crate::files::{Directory, NamedFile, refusal};
use crate::progress::{Meter, Unit};
use crate::reference::parse_photons;
use crate::{interrupt, machine, messages};

const EXAMPLES: &str = "\
Each table is DIR/NAME.csv and, with units, meanings, method and command, DIR/NAME.json, after DIR/schema.json:
  profile    R(r) and the light within r, of half spaces by surface albedo, g, eta and configuration
  edge       light beside the edge of a half plane that is lit: what a screen-space pass should show
  disk       light in and around a small disk that is lit
  line       light in and beside a thin line that is lit
  totals     surface albedo by single-scattering albedo
  inversion  single-scattering albedo by surface albedo, and the diffuse mean free path
  slabs      light that slabs reflect, pass and absorb
  spheres    light that leaves spheres
Lengths are mean free paths. Every number has its error. The files have the same bytes each time.
docs/guide/oracle.md shows how to test with them.

Examples:
  translucid oracle -o oracle
  translucid oracle -o edges --only edge,line";

/// Writes tables of exact light, with errors, that other programs can be tested with
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct OracleArguments {
    /// Directory to write to
    #[arg(short, long, value_name = "DIR", default_value = "oracle")]
    output: PathBuf,
    /// Tables to write [default: all]
    #[arg(long, value_name = "NAME,...", value_delimiter = ',', value_parser = PossibleValuesParser::new(oracle_names()))]
    only: Vec<String>,
    /// Number of photons of each walk, and of each sphere a tenth
    #[arg(long, value_name = "N", default_value_t = ORACLE_PHOTONS, value_parser = parse_photons)]
    photons: u64,
    /// Number of threads, at most 1024 [default: one per processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Photons that know their error.
const FEWEST_PHOTONS: u64 = 1000;

/// Runs the verb.
pub(crate) fn run(arguments: &OracleArguments) -> Result<(), Failure> {
    if arguments.photons < FEWEST_PHOTONS {
        let message = format!("--photons is {}, but must be at least {FEWEST_PHOTONS}", arguments.photons);
        return Err(Failure::input(message).with_help("errors of fewer photons would themselves be unknown"));
    }
    let all = oracle_names();
    let wanted = |name: &&str| arguments.only.is_empty() || arguments.only.iter().any(|only| only == name);
    let names: Vec<&str> = all.into_iter().filter(wanted).collect();
    let pool = machine::threads(arguments.threads)?;
    let count = Directory::fill(&arguments.output, |directory| {
        check(directory, &names)?;
        interrupt::catch("\nstopping; nothing has been written yet")?;
        let meter = Meter::new(Unit::Parts);
        let progress = |done: f64| meter.update((1e6 * done) as u64, 1_000_000);
        let watch = Watch { stop: &interrupt::STOP, progress: &progress };
        let tables = pool.install(|| oracle_tables(&names, arguments.photons, watch));
        meter.finish();
        let tables = tables.map_err(|Stopped| {
            Failure::interrupted("nothing was written; --only and fewer --photons take less time")
        })?;
        let mut files: Vec<NamedFile> = vec![(SCHEMA_FILE.into(), oracle_schema().into_bytes())];
        for table in tables {
            files.push((format!("{}.csv", table.name), table.data.csv().into_bytes()));
            files.push((format!("{}.json", table.name), table.json.into_bytes()));
        }
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(Failure::interrupted("nothing was written"));
        }
        // Files of two versions beside each other would be worse than the moment that the rest takes
        interrupt::catch("\nall files are being written; press Ctrl-C again to end at once")?;
        directory.write(&files)?;
        Ok(files.len())
    })?;
    messages::line(&format!("{count} files in {}", arguments.output.display()));
    Ok(())
}

/// Finds out before the work whether files can be written, and refuses to write over those of others.
fn check(directory: &Directory, names: &[&str]) -> Result<(), Failure> {
    let schema = directory.file(SCHEMA_FILE);
    let is_own =
        std::fs::read_to_string(&schema).is_ok_and(|text| text.contains("Oracle tables of translucid"));
    let files =
        names.iter().flat_map(|name| ["csv", "json"].map(|end| directory.file(&format!("{name}.{end}"))));
    for path in std::iter::once(schema.clone()).chain(files) {
        check_writable(&path)?;
        if path.exists() && !is_own {
            return Err(refusal(&path, "exists already, and was not made by translucid oracle"));
        }
    }
    Ok(())
}
