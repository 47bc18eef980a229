//! Values that differ between wavelengths or between red, green and blue.

use std::path::Path;

use csv::{ReaderBuilder, Trim};
use translucid_laboratory::colorimetry::{WAVELENGTHS, wavelength};
use translucid_words::{Content, Context, Error, Interval, Item, Place, Varied, exact};

use crate::files::{broken_csv, read_at_most};

/// Wavelengths that a table may have, and those that it must cover \[nm\].
const ALLOWED: Interval = Interval::closed(100.0, 1e5);
const NEEDED: [f64; 2] = [400.0, 700.0];
const UNIT: &str = "wavelengths are in nanometers";
/// Keys whose values cannot be meant for another, when a column has their name.
const KEYS: [&str; 7] = ["scattering", "absorption", "surface_albedo", "mfp", "g", "eta", "reflectance"];
/// Most rows of a table in the file itself, and bytes of one beside it.
const MOST_ROWS: usize = 100_000;
const MOST_BYTES: u64 = 1 << 24;

/// Reads values for red, green and blue, or a table over wavelengths, here or in a file.
///
/// # Errors
/// There is no such value, it is outside the range, or its kind does not go with that of others.
pub(crate) fn vary(item: &Item<'_>, range: Interval, context: &mut Context) -> Result<Varied, Error> {
    let (kind, values) = match item.content() {
        Content::List(_) => {
            let items = item.array::<3>("numbers for red, green and blue")?;
            (1, items.iter().map(|item| item.double(range)).collect::<Result<_, _>>()?)
        }
        Content::Table(_) => (0, of_rows(item, &read_inline(item, range)?, context)?),
        _ => {
            context.files.push(item.file()?);
            (0, of_rows(item, &read_file(item, range)?, context)?)
        }
    };
    if let Some(other) = &context.first_varied[1 - kind] {
        let what = ["a table over wavelengths", "values for red, green and blue"];
        let message = format!("{} has {}, but {other} has {}", item.path(), what[kind], what[1 - kind]);
        return Err(item.error(message).with_help("give all in one of the two ways, or as one number"));
    }
    context.first_varied[kind].get_or_insert_with(|| item.path().to_owned());
    Ok(Varied::many(values))
}

/// The values of a table at all wavelengths.
fn of_rows(item: &Item<'_>, rows: &[[f64; 2]], context: &mut Context) -> Result<Vec<f64>, Error> {
    let path = item.path();
    let (Some([first, _]), Some([last, _])) = (rows.first(), rows.last()) else {
        return Err(item.error(format!("{path} has no values")));
    };
    let covered = format!("{path} covers {} to {} nm", exact(*first), exact(*last));
    let [from, to] = NEEDED;
    if *first > from || *last < to {
        return Err(item.error(format!("{covered}, but must cover {from} to {to} nm")));
    }
    if *first > wavelength(0) || *last < wavelength(WAVELENGTHS - 1) {
        context.notes.push(format!("{covered}; the values at its ends hold on to 380 and 780 nm"));
    }
    Ok((0..WAVELENGTHS).map(|i| interpolate(rows, wavelength(i))).collect())
}

/// `{ wavelengths = […], values = […] }`.
fn read_inline(item: &Item<'_>, range: Interval) -> Result<Vec<[f64; 2]>, Error> {
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
fn read_file(item: &Item<'_>, range: Interval) -> Result<Vec<[f64; 2]>, Error> {
    let path = item.file()?;
    let refused = |message: String| item.error(format!("{} {message}", path.display()));
    let bytes = read_at_most(&path, MOST_BYTES).map_err(refused)?;
    let key = item.path().rsplit('.').next().unwrap_or_default();
    parse(&bytes, &path, key, range)
}

fn parse(bytes: &[u8], path: &Path, key: &str, range: Interval) -> Result<Vec<[f64; 2]>, Error> {
    let mut reader = ReaderBuilder::new().trim(Trim::All).comment(Some(b'#')).from_reader(bytes);
    let broken = |error: &csv::Error| broken_csv(path, error);
    let header = reader.headers().map_err(|error| broken(&error))?.clone();
    let refuse = |message: String| Error::at(Place::file(path), message);
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
            Error::at(Place::line(path, line), message)
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
