//! Phase functions by words, or as tables in CSV files.

use std::path::Path;
use std::sync::Arc;

use csv::{ReaderBuilder, Trim};
use translucid_reference::layers::Layer;
use translucid_reference::walk::{PhaseFunction, PhaseTable};
use translucid_words::{Content, Context, Error, Item, Parse, Place, exact};

use crate::files::{broken_csv, read_at_most};

/// Greatest file, in bytes.
const MOST_BYTES: u64 = 1 << 24;
const COLUMNS: &str = "the columns are cosine or degrees, and phase_function, separated by commas";

/// A phase function as somebody gave it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GivenPhaseFunction(pub(crate) PhaseFunction);

impl GivenPhaseFunction {
    /// The layer with this phase function.
    pub(crate) fn of(&self, layer: Layer) -> Layer {
        layer.with_phase_function(self.0.clone())
    }
}

impl Parse for GivenPhaseFunction {
    const FORM: &'static str =
        "henyey-greenstein, rayleigh, two-term:W,G1,G2, moments:X1,X2,..., or a FILE.csv";

    fn parse(item: &Item<'_>, context: &mut Context) -> Result<Self, Error> {
        if let Content::Numbers(rows) = item.content() {
            let rows = rows.as_chunks().0.to_vec();
            let table =
                PhaseTable::new(rows).map_err(|error| item.error(format!("{}: {error}", item.path())))?;
            return Ok(Self(PhaseFunction::Table(Arc::new(table))));
        }
        let text = item.text()?;
        if is_phase_file(text) {
            let path = item.file()?;
            context.files.push(path.clone());
            return read_phase_file(&path).map(Self);
        }
        let found = PhaseFunction::parse(text, 0.0)
            .map_err(|problem| item.error(format!("{}: {problem}", item.path())))?;
        let must_be = || format!("one of {}, or a FILE.csv", PhaseFunction::WORDS.join(", "));
        found.map(Self).ok_or_else(|| item.refuse(&must_be()))
    }
}

/// Returns whether a text names such a file, not a phase function.
pub fn is_phase_file(text: &str) -> bool {
    Path::new(text).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Reads a phase function over the cosine or the angle of deflection, rising or falling, in any scale.
///
/// # Errors
/// The file cannot be read or is no such table; the error points at the line.
pub fn read_phase_file(path: &Path) -> Result<PhaseFunction, Error> {
    let whole = |message: String| Error::at(Place::file(path), message);
    let bytes = read_at_most(path, MOST_BYTES).map_err(whole)?;
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(&bytes[..]);
    let header = reader.headers().map_err(|error| broken_csv(path, &error))?.clone();
    let column = |name: &str| header.iter().position(|found| found.eq_ignore_ascii_case(name));
    let missing = |name: &str| {
        let message = format!("there is no column \"{name}\"");
        Error::at(Place::line(path, 1), message).with_help(COLUMNS)
    };
    let (angles, name, range) = match (column("cosine"), column("degrees")) {
        (Some(place), None) => (place, "cosine", [-1.0, 1.0]),
        (None, Some(place)) => (place, "degrees", [0.0, 180.0]),
        (None, None) => return Err(missing("cosine")),
        (Some(_), Some(_)) => {
            let message = "there are both columns cosine and degrees, but one of them is enough";
            return Err(Error::at(Place::line(path, 1), message));
        }
    };
    let values = column("phase_function").ok_or_else(|| missing("phase_function"))?;
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| broken_csv(path, &error))?;
        let line = record.position().map_or(0, |position| position.line() as usize);
        let number = |column: usize, name: &str, [low, high]: [f64; 2]| {
            let text = record.get(column).unwrap_or_default();
            let value = text.parse::<f64>().ok().filter(|value| (low..=high).contains(value));
            value.ok_or_else(|| {
                let range = format!("[{}, {}]", exact(low), exact(high));
                let message = format!("{name} is \"{text}\", but must be a number in {range}");
                Error::at(Place::line(path, line), message)
            })
        };
        let angle = number(angles, name, range)?;
        rows.push([angle, number(values, "phase_function", [0.0, 1e100])?]);
    }
    if rows.len() > 1 && rows[0][0] > rows[1][0] {
        rows.reverse();
    }
    let table = if name == "cosine" { PhaseTable::new(rows) } else { PhaseTable::from_degrees(&rows) };
    let table = table.map_err(|error| whole(error.to_string()))?;
    Ok(PhaseFunction::Table(Arc::new(table)))
}
