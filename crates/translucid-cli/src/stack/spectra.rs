//! Values that differ between wavelengths or between red, green and blue.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use csv::{ReaderBuilder, Trim};
use translucid_laboratory::colorimetry::{WAVELENGTHS, wavelength};
use translucid_scene::description::{Content, Item};
use translucid_scene::{Interval, Place, SceneError};

use crate::files::{broken_csv, read_at_most};
use crate::table::exact;

/// Wavelengths that a table may have, and those that it must cover \[nm\].
const ALLOWED: Interval = Interval::closed(100.0, 1e5);
const NEEDED: [f64; 2] = [400.0, 700.0];
const UNIT: &str = "wavelengths are in nanometers";
/// Keys whose values cannot be meant for another, when a column has their name.
const KEYS: [&str; 7] = ["scattering", "absorption", "surface_albedo", "mfp", "g", "eta", "reflectance"];
/// Most rows of a table in the file itself, and bytes of one beside it.
const MOST_ROWS: usize = 100_000;
const MOST_BYTES: u64 = 1 << 24;

/// Values of a key.
enum Values {
    /// One number for all channels.
    Number(f64),
    /// Red, green and blue.
    Rgb([f64; 3]),
    /// Wavelengths, which ascend, and values.
    Table(Vec<[f64; 2]>),
}

/// All values of a file, by their keys, as far as they have been read.
#[derive(Default)]
pub(super) struct Spectra {
    values: RefCell<BTreeMap<String, Values>>,
    /// Key of a first table, and of first values for red, green and blue.
    first: RefCell<[Option<String>; 2]>,
    /// Channel whose values are read.
    pub(super) channel: Cell<usize>,
    /// Values that hold beyond their tables, in words.
    pub(super) notes: RefCell<Vec<String>>,
    /// Files of tables.
    pub(super) files: RefCell<Vec<PathBuf>>,
}

impl Spectra {
    /// Channels of the values that have been read.
    pub(super) fn count(&self) -> usize {
        match &*self.first.borrow() {
            [Some(_), _] => WAVELENGTHS,
            [_, Some(_)] => 3,
            _ => 1,
        }
    }

    /// The value of a key for the channel.
    ///
    /// # Errors
    /// It is none, it is outside the range, or its kind does not go with that of others.
    pub(super) fn number(&self, item: &Item<'_>, range: Interval) -> Result<f64, SceneError> {
        if !self.values.borrow().contains_key(item.path()) {
            let values = read(item, range)?;
            self.admit(item, &values)?;
            if let Content::Text(_) = item.content() {
                self.files.borrow_mut().push(item.file()?);
            }
            self.values.borrow_mut().insert(item.path().to_owned(), values);
        }
        let channel = self.channel.get();
        Ok(match &self.values.borrow()[item.path()] {
            Values::Number(value) => *value,
            Values::Rgb(values) => values[channel],
            Values::Table(rows) => interpolate(rows, wavelength(channel)),
        })
    }

    /// Refuses tables beside values of three channels, and notes where a table ends too early.
    fn admit(&self, item: &Item<'_>, values: &Values) -> Result<(), SceneError> {
        let kind = match values {
            Values::Number(_) => return Ok(()),
            Values::Table(rows) => {
                let [first, last] = [rows[0][0], rows[rows.len() - 1][0]];
                let all = [wavelength(0), wavelength(WAVELENGTHS - 1)];
                if first > all[0] || last < all[1] {
                    let (path, [first, last]) = (item.path(), [first, last].map(exact));
                    self.notes.borrow_mut().push(format!(
                        "{path} covers {first} to {last} nm; the values at its ends hold on to 380 and 780 nm"
                    ));
                }
                0
            }
            Values::Rgb(_) => 1,
        };
        let mut first = self.first.borrow_mut();
        if let Some(other) = &first[1 - kind] {
            let what = ["a table over wavelengths", "values for red, green and blue"];
            let message = format!("{} has {}, but {other} has {}", item.path(), what[kind], what[1 - kind]);
            return Err(item.error(message).with_help("give all in one of the two ways, or as one number"));
        }
        first[kind].get_or_insert_with(|| item.path().to_owned());
        Ok(())
    }
}

/// The values of a key.
fn read(item: &Item<'_>, range: Interval) -> Result<Values, SceneError> {
    let rows = match item.content() {
        Content::List(_) => {
            let mut values = [0.0; 3];
            for (value, item) in values.iter_mut().zip(item.array::<3>("numbers for red, green and blue")?) {
                *value = item.double(range)?;
            }
            return Ok(Values::Rgb(values));
        }
        Content::Table(_) => read_inline(item, range)?,
        Content::Text(_) => read_file(item, range)?,
        _ => return item.double(range).map(Values::Number),
    };
    let [from, to] = NEEDED;
    match (rows.first(), rows.last()) {
        (Some([first, _]), Some([last, _])) if *first <= from && *last >= to => Ok(Values::Table(rows)),
        (Some([first, _]), Some([last, _])) => {
            let [path, first, last] = [item.path(), &exact(*first), &exact(*last)];
            Err(item.error(format!("{path} covers {first} to {last} nm, but must cover {from} to {to} nm")))
        }
        _ => Err(item.error(format!("{} has no values", item.path()))),
    }
}

/// `{ wavelengths = […], values = […] }`.
fn read_inline(item: &Item<'_>, range: Interval) -> Result<Vec<[f64; 2]>, SceneError> {
    let table = item.table()?.allow(&["wavelengths", "values"])?;
    let list = |key| table.require(key)?.list("numbers", MOST_ROWS);
    let (wavelengths, values) = (list("wavelengths")?, list("values")?);
    if wavelengths.len() != values.len() {
        let (path, count, other) = (item.path(), wavelengths.len(), values.len());
        return Err(item.error(format!("{path} has {count} wavelengths, but {other} values")));
    }
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for (wavelength, value) in wavelengths.iter().zip(&values) {
        let nanometers = wavelength.double(ALLOWED).map_err(|error| error.with_help(UNIT))?;
        let row = [nanometers, value.double(range)?];
        if let Some([before, _]) = rows.last().filter(|before| before[0] >= row[0]) {
            return Err(wavelength.refuse(&format!("greater than {}, the one before it", exact(*before))));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// A CSV file with the columns `wavelength` and, unless it has just one other, that of the key's name.
fn read_file(item: &Item<'_>, range: Interval) -> Result<Vec<[f64; 2]>, SceneError> {
    let path = item.file()?;
    let refused = |message: String| item.error(format!("{} {message}", path.display()));
    let bytes = read_at_most(&path, MOST_BYTES).map_err(refused)?;
    let key = item.path().rsplit('.').next().unwrap_or_default();
    parse(&bytes, &path, key, range)
}

fn parse(bytes: &[u8], path: &Path, key: &str, range: Interval) -> Result<Vec<[f64; 2]>, SceneError> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: &csv::Error| broken_csv(path, error);
    let header = reader.headers().map_err(|error| broken(&error))?.clone();
    let refuse = |message: String| SceneError::at(Place::file(path), message);
    let names: Vec<&str> = header.iter().map(|column| column.trim_start_matches('\u{feff}')).collect();
    let column = |name: &str| {
        let found = names.iter().position(|column| *column == name).ok_or_else(|| {
            let error = refuse(format!("there is no column {name}; the columns are {}", names.join(", ")));
            if names.iter().any(|column| column.contains([';', '\t'])) {
                error.with_help("separate columns by commas, and write numbers with a decimal point")
            } else {
                error
            }
        })?;
        match names[found + 1..].contains(&name) {
            true => Err(refuse(format!("there are two columns {name}"))),
            false => Ok(found),
        }
    };
    let wavelengths = column("wavelength")?;
    let values = if names.len() == 2 { 1 - wavelengths } else { column(key)? };
    if names[values] != key && KEYS.contains(&names[values]) {
        return Err(refuse(format!("the column is {}, but {key} is read from it", names[values])));
    }
    let mut rows: Vec<[f64; 2]> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| broken(&error))?;
        let fail = |message: String| {
            let line = record.position().map_or(0, |position| position.line() as usize);
            SceneError::at(Place::line(path, line), message)
        };
        // A spreadsheet's empty row
        if record.iter().all(str::is_empty) {
            continue;
        }
        let number = |column: usize, range: Interval| {
            let (name, text) = (&header[column], &record[column]);
            let number = text.parse().ok().filter(|number| range.contains(*number));
            let shown = if text.is_empty() { "empty" } else { text };
            number.ok_or_else(|| fail(format!("{name} is {shown}, but must be in {range}")))
        };
        let nanometers = number(wavelengths, ALLOWED).map_err(|error| error.with_help(UNIT))?;
        let row = [nanometers, number(values, range)?];
        if let Some([before, _]) = rows.last().filter(|before| before[0] >= row[0]) {
            let [found, before] = [row[0], *before].map(exact);
            return Err(fail(format!(
                "wavelength is {found}, but must be greater than {before}, the one before it"
            )));
        }
        rows.push(row);
    }
    Ok(rows)
}

/// The value at a wavelength: between rows linear, beyond them that of the nearest. There are two rows at least.
fn interpolate(rows: &[[f64; 2]], wavelength: f64) -> f64 {
    let above = rows.partition_point(|[at, _]| *at <= wavelength).clamp(1, rows.len() - 1);
    let [[from, a], [to, b]] = [rows[above - 1], rows[above]];
    a + (b - a) * ((wavelength - from) / (to - from)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_rows_are_skipped_and_empty_cells_named() {
        let read = |text: &str| {
            parse(text.as_bytes(), Path::new("a.csv"), "g", Interval::UNIT).map_err(|error| error.message)
        };
        assert_eq!(read("wavelength,g\n,\n400,1\n , \n700,0\n"), Ok(vec![[400.0, 1.0], [700.0, 0.0]]));
        assert_eq!(read("wavelength,g\n400,\n"), Err("g is empty, but must be in [0, 1]".into()));
    }

    #[test]
    fn values_between_rows_are_linear_and_beyond_them_constant() {
        let rows = [[400.0, 1.0], [500.0, 3.0], [700.0, 2.0]];
        let found = [380.0, 400.0, 425.0, 500.0, 600.0, 700.0, 780.0].map(|w| interpolate(&rows, w));
        assert_eq!(found, [1.0, 1.0, 1.5, 3.0, 2.5, 2.0, 2.0]);
    }
}
