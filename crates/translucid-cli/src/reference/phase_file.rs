//! Phase functions as tables in CSV files.

use std::path::Path;
use std::sync::Arc;

use csv::{ReaderBuilder, Trim};
use translucid_reference::walk::{PhaseFunction, PhaseTable};
use translucid_scene::{Place, SceneError};

use crate::files::{broken_csv, read_at_most};
use crate::table::exact;

/// Greatest file, in bytes.
const MOST_BYTES: u64 = 1 << 24;
const COLUMNS: &str = "the columns are cosine or degrees, and phase_function, separated by commas";

/// Returns whether a text names such a file, not a phase function.
pub(super) fn is_phase_file(text: &str) -> bool {
    Path::new(text).extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"))
}

/// Reads a phase function over the cosine or the angle of deflection, rising or falling, in any scale.
///
/// # Errors
/// The file cannot be read or is no such table; the error points at the line.
pub(super) fn read_phase_file(path: &Path) -> Result<PhaseFunction, SceneError> {
    let whole = |message: String| SceneError::at(Place::file(path), message);
    let bytes = read_at_most(path, MOST_BYTES).map_err(whole)?;
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(&bytes[..]);
    let header = reader.headers().map_err(|error| broken_csv(path, &error))?.clone();
    let column = |name: &str| header.iter().position(|found| found.eq_ignore_ascii_case(name));
    let missing = |name: &str| {
        let message = format!("there is no column \"{name}\"");
        SceneError::at(Place::line(path, 1), message).with_help(COLUMNS)
    };
    let (angles, name, range) = match (column("cosine"), column("degrees")) {
        (Some(place), None) => (place, "cosine", [-1.0, 1.0]),
        (None, Some(place)) => (place, "degrees", [0.0, 180.0]),
        (None, None) => return Err(missing("cosine")),
        (Some(_), Some(_)) => {
            let message = "there are both columns cosine and degrees, but one of them is enough";
            return Err(SceneError::at(Place::line(path, 1), message));
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
                SceneError::at(Place::line(path, line), message)
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
