//! `translucid reference --layers FILE.mci`: the walks of MCML's files.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use translucid_reference::Estimate;
use translucid_reference::mcml::{MciRun, Mco, parse_mci};
use translucid_reference::walk::Control;
use translucid_scene::{Place, SceneError};
use translucid_words::Cell;

use super::layers_walk::watched;
use super::{Method, ReferenceArguments};
use crate::failure::Failure;
use crate::files::{input_among, write_file};
use crate::output_lock::OutputLock;
use crate::table::refuse_npz;
use crate::{interrupt, messages};

const COLUMNS: [&str; 8] = ["run", "quantity", "layer", "r", "z", "angle", "value", "standard_error"];

/// Walks all runs of a file.
pub(super) fn run(arguments: &ReferenceArguments, path: &Path) -> Result<(), Failure> {
    if arguments.method == Some(Method::Exact) {
        return Err(Failure::input("--method is exact, but an .mci file asks for photons")
            .with_help("leave --method out, or use --method monte-carlo"));
    }
    refuse_what_the_file_says(arguments)?;
    refuse_npz(arguments.table.file())?;
    if !fs::metadata(path).map_or(true, |data| data.is_file()) {
        return Err(at(path, None, String::from("is not a file")));
    }
    let bytes = fs::read(path).map_err(|error| at(path, None, format!("cannot be read: {error}")))?;
    let runs = parse_mci(&bytes).map_err(|error| SceneError::of_text(path, error))?;
    for run in &runs {
        run.check().map_err(|error| at(path, Some(run.line), format!("{}: {error}", run.output)))?;
    }
    let outputs = Outputs::new(arguments, path, &runs)?;
    let _locks = outputs.files().map(OutputLock::take).collect::<Result<Vec<_>, _>>()?;
    interrupt::catch("\nstopping; press Ctrl-C again to lose the work")?;
    for run in runs.iter().filter(|run| run.is_binary) {
        let message = format!("{}:{}: format B is written as text, as MCML does", path.display(), run.line);
        messages::print_warning(&message);
    }
    let mut results = Vec::new();
    for (number, run) in runs.iter().enumerate() {
        let walk = |control: &Control| run.walk(arguments.walk.seed(), control);
        let result = watched(&run.output, run.photons, walk, Mco::tally)
            .map_err(|error| at(path, Some(run.line), error.to_string()))?;
        let interrupted = interrupt::settle();
        let photons = result.tally().photons();
        if photons > 0 {
            if let Outputs::Files(files) = &outputs {
                write_file(&files[number], result.text().as_bytes())?;
            } else {
                results.push(result);
            }
        }
        if interrupted {
            outputs.write_table(arguments, &results)?;
            let help =
                format!("{} has {photons} photons of {}; runs after it have none", run.output, run.photons);
            return Err(Failure::interrupted(help));
        }
    }
    outputs.write_table(arguments, &results)
}

/// Refuses options of light, radii and photons.
fn refuse_what_the_file_says(arguments: &ReferenceArguments) -> Result<(), Failure> {
    let given = [
        ("--configuration", arguments.configuration.is_some()),
        ("--incidence-angle", arguments.incidence_angle.is_some()),
        ("--at or --points", arguments.radii.count() > 0),
        ("--absorption", !arguments.absorption.is_empty()),
    ];
    if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
        return Err(
            Failure::input(format!("{option} is given, but an .mci file says it")).with_help("leave it out")
        );
    }
    if arguments.tolerance.is_some() {
        return Err(Failure::input("--tolerance belongs to the exact solution, not to a walk")
            .with_help("the file states the number of photons"));
    }
    arguments.walk.refuse_for_layers(false)
}

/// Files that results go to.
enum Outputs {
    /// An `.mco` file for each run.
    Files(Vec<PathBuf>),
    /// One table for all runs.
    Table(PathBuf),
}

impl Outputs {
    /// Finds out whether they can be written.
    fn new(arguments: &ReferenceArguments, path: &Path, runs: &[MciRun]) -> Result<Self, Failure> {
        let is_mco = |file: &Path| file.extension().is_some_and(|found| found.eq_ignore_ascii_case("mco"));
        if arguments.table.is_json() && arguments.table.file().is_none_or(is_mco) {
            return Err(Failure::input("--format is json, but .mco files have a form of their own")
                .with_help("name a file for the table by -o"));
        }
        let outputs = match arguments.table.file() {
            None => {
                let beside = |run| Ok(path.with_file_name(name_of(path, run)?));
                Self::Files(runs.iter().map(beside).collect::<Result<_, Failure>>()?)
            }
            Some(file) if is_mco(file) => {
                if runs.len() > 1 {
                    let message =
                        format!("--output is one file, but {} has {} runs", path.display(), runs.len());
                    return Err(Failure::input(message)
                        .with_help("leave it out: each run names its file; or name a .csv file for all"));
                }
                Self::Files(vec![file.to_owned()])
            }
            Some(file) => Self::Table(file.to_owned()),
        };
        outputs.files().try_for_each(translucid_files::check_writable)?;
        if let Some(file) = input_among(outputs.files(), [path].into_iter()) {
            let message = format!("the output {} is the file that is read", file.display());
            return Err(Failure::input(message).with_help("choose another file with -o"));
        }
        Ok(outputs)
    }

    fn files(&self) -> impl Iterator<Item = &Path> {
        match self {
            Self::Files(files) => files.as_slice(),
            Self::Table(file) => std::slice::from_ref(file),
        }
        .iter()
        .map(PathBuf::as_path)
    }

    fn write_table(&self, arguments: &ReferenceArguments, results: &[Mco]) -> Result<(), Failure> {
        match self {
            Self::Files(_) => Ok(()),
            Self::Table(_) => arguments.table.write_cells(COLUMNS, results.iter().flat_map(rows)),
        }
    }
}

/// The name of a run's output, which is to stay in the file's folder and to replace nothing but its like.
fn name_of<'a>(path: &Path, run: &'a MciRun) -> Result<&'a str, Failure> {
    let name = run.output.as_str();
    let refused = |message: &str| {
        let message = format!("the output {name:?} {message}");
        Err(at(path, Some(run.line), message).with_help("choose another file with -o"))
    };
    let mut parts = Path::new(name).components();
    let is_plain = matches!((parts.next(), parts.next()), (Some(Component::Normal(_)), None));
    if !is_plain || name.contains(['/', '\\', ':']) {
        return refused("names a folder, but must be a file in that of the .mci file");
    }
    if name.contains(char::is_control) {
        return refused("has a control character");
    }
    if is_foreign(&path.with_file_name(name)) {
        return refused("is there and no .mco file, and would be overwritten");
    }
    Ok(name)
}

/// Whether something is there that is no `.mco` file.
fn is_foreign(path: &Path) -> bool {
    let Ok(data) = fs::metadata(path) else { return false };
    let is_like = |mut file: File| {
        let mut start = [0; 2];
        file.read_exact(&mut start).is_ok() && [*b"A1", *b"B1"].contains(&start)
    };
    !(data.is_file() && File::open(path).is_ok_and(is_like))
}

/// Lines of the table: `.mco` figures with their errors and places.
fn rows(result: &Mco) -> impl Iterator<Item = [Cell; 8]> {
    let specular = Estimate { value: result.tally().specular(), error: 0.0 };
    let number = |value: Option<f64>| Cell::Number(value.unwrap_or(f64::NAN));
    let first = (String::from("Rsp"), [None; 4], specular);
    let others = result.figures().map(|figure| {
        let layer = figure.layer.map(|layer| layer as f64);
        (figure.name.to_owned(), [layer, figure.r, figure.z, figure.angle], figure.density)
    });
    std::iter::once(first).chain(others).map(move |(name, places, density)| {
        let [layer, r, z, angle] = places.map(number);
        let [value, error] = [density.value, density.error].map(Cell::Number);
        [Cell::Word(result.run().output.clone()), Cell::Word(name), layer, r, z, angle, value, error]
    })
}

fn at(path: &Path, line: Option<usize>, message: String) -> Failure {
    let place = line.map_or_else(|| Place::file(path), |line| Place::line(path, line));
    SceneError::at(place, message).into()
}
