//! Tables of reflectance profiles: CSV with a header.
//!
//! Columns `r` and `reflectance`, optionally `surface_albedo`; others are ignored, so that what
//! `translucid reference` prints can be read back.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord};

use super::read_file;
use crate::{Place, ProfileRow, ProfileTable, SceneError};

/// Fewest radii of a profile.
const FEWEST_RADII: usize = 4;
/// Most rows of a file: a profile has some hundred radii.
const MOST_LINES: usize = 1_000_000;

/// Loads a table of reflectance profiles.
///
/// # Errors
/// The file cannot be read, lacks a column, or a number is not what it must be; the error names the line.
pub fn load_profile_table(path: &Path) -> Result<ProfileTable, SceneError> {
    parse_profile_table(&read_file(path)?, path)
}

/// Reads a table of reflectance profiles from a file's bytes; the path is for messages.
///
/// # Errors
/// As [`load_profile_table`].
pub fn parse_profile_table(bytes: &[u8], path: &Path) -> Result<ProfileTable, SceneError> {
    let mut reader = ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_reader(bytes);
    let columns = Columns::find(reader.headers().map_err(|error| broken(path, &error))?, path)?;
    let mut rows: Vec<ProfileRow> = Vec::new();
    for (count, record) in reader.records().enumerate() {
        let record = record.map_err(|error| broken(path, &error))?;
        let line = record.position().map_or(0, |position| position.line() as usize);
        if count >= MOST_LINES {
            let message = format!("more than {MOST_LINES} lines");
            return Err(SceneError::at(Place::line(path, line), message));
        }
        add(&mut rows, &columns, &record, path, line)?;
    }
    check(&mut rows, path)?;
    let table = ProfileTable { path: path.to_owned(), rows };
    table.table()?;
    Ok(table)
}

/// Where the columns are.
struct Columns {
    r: usize,
    reflectance: usize,
    surface_albedo: Option<usize>,
}

impl Columns {
    fn find(header: &StringRecord, path: &Path) -> Result<Self, SceneError> {
        let find = |name: &str| header.iter().position(|column| column.eq_ignore_ascii_case(name));
        let require = |name: &str| {
            find(name).ok_or_else(|| {
                let found = header.iter().collect::<Vec<_>>().join(", ");
                let message = format!("there is no column \"{name}\"; the first line has {found}");
                SceneError::at(Place::line(path, 1), message)
                    .with_help("a profile's columns are r,reflectance and optionally surface_albedo")
            })
        };
        Ok(Self {
            r: require("r")?,
            reflectance: require("reflectance")?,
            surface_albedo: find("surface_albedo"),
        })
    }
}

/// Adds a line to the row of its surface albedo.
fn add(
    rows: &mut Vec<ProfileRow>,
    columns: &Columns,
    record: &StringRecord,
    path: &Path,
    line: usize,
) -> Result<(), SceneError> {
    let fail = |message: String| SceneError::at(Place::line(path, line), message);
    let number = |column: usize, name: &str| {
        let text = record.get(column).unwrap_or_default();
        text.parse::<f64>().map_err(|_| fail(format!("{name} is \"{text}\", but must be a number")))
    };
    let r = number(columns.r, "r")?;
    let reflectance = number(columns.reflectance, "reflectance")?;
    let surface_albedo = columns.surface_albedo.map(|column| number(column, "surface_albedo")).transpose()?;
    if !(1e-100..=1e100).contains(&r) {
        return Err(fail(format!("r is {r}, but must be in [1e-100, 1e100]")));
    }
    if !(0.0..=1e200).contains(&reflectance) {
        return Err(fail(format!("reflectance is {reflectance}, but must be in [0, 1e200]")));
    }
    if let Some(a) = surface_albedo.filter(|a| !(0.0..=1.0).contains(a)) {
        return Err(fail(format!("surface_albedo is {a}, but must be in [0, 1]")));
    }
    let known = rows.iter().position(|row| row.surface_albedo == surface_albedo);
    let index = known.unwrap_or_else(|| {
        rows.push(ProfileRow { surface_albedo, radii: Vec::new(), reflectances: Vec::new() });
        rows.len() - 1
    });
    let row = &mut rows[index];
    if let Some(&before) = row.radii.last().filter(|&&before| before >= r) {
        return Err(fail(format!("r is {r}, but must be greater than {before}, the one before")));
    }
    row.radii.push(r);
    row.reflectances.push(reflectance);
    Ok(())
}

/// Sorts the rows and refuses those that are no profile.
fn check(rows: &mut [ProfileRow], path: &Path) -> Result<(), SceneError> {
    let fail = |message: String| Err(SceneError::at(Place::file(path), message));
    if rows.is_empty() {
        return fail(String::from("the table has no lines after its header"));
    }
    for row in rows.iter() {
        let of = row.surface_albedo.map_or(String::new(), |a| format!(" of surface_albedo {a}"));
        if row.radii.len() < FEWEST_RADII {
            let count = row.radii.len();
            return fail(format!("the profile{of} has {count} radii, but needs at least {FEWEST_RADII}"));
        }
        if row.reflectances.iter().all(|&reflectance| reflectance == 0.0) {
            return fail(format!("the profile{of} is 0 everywhere"));
        }
    }
    let key = |row: &ProfileRow| row.surface_albedo.unwrap_or(0.0);
    rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
    Ok(())
}

fn broken(path: &Path, error: &csv::Error) -> SceneError {
    let line = error.position().map(|position| position.line() as usize);
    let place = line.map_or_else(|| Place::file(path), |line| Place::line(path, line));
    let message = match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("the line has {len} values, but the header names {expected_len} columns")
        }
        csv::ErrorKind::Utf8 { .. } => String::from("a table must be UTF-8 text, but this is not"),
        _ => error.to_string(),
    };
    SceneError::at(place, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<ProfileTable, SceneError> {
        parse_profile_table(text.as_bytes(), Path::new("table.csv"))
    }

    fn refuse(text: &str, expected: &str) {
        let found = parse(text).unwrap_err().to_string();
        assert!(found.contains(expected), "{found}");
    }

    #[test]
    fn table_takes_the_columns_it_knows() {
        let table =
            parse("r,enclosed,Reflectance\n0.1,0,3\n# noise\n 0.2 ,0,2\n0.4,0,1e-1\n1,0,0\n").unwrap();
        let row = ProfileRow {
            surface_albedo: None,
            radii: vec![0.1, 0.2, 0.4, 1.0],
            reflectances: vec![3.0, 2.0, 0.1, 0.0],
        };
        assert_eq!(table.rows, [row]);
    }

    #[test]
    fn table_sorts_profiles_by_albedo() {
        let lines = |a: &str| (1..=4).map(|r| format!("{a},{r},{r}\n")).collect::<String>();
        let text = format!("surface_albedo,r,reflectance\n{}{}", lines("0.8"), lines("0.2"));
        let albedos: Vec<_> = parse(&text).unwrap().rows.iter().map(|row| row.surface_albedo).collect();
        assert_eq!(albedos, [Some(0.2), Some(0.8)]);
    }

    #[test]
    fn table_says_what_is_wrong_and_where() {
        refuse("", "there is no column \"r\"");
        refuse(
            "radius,reflectance\n1,1\n",
            "there is no column \"r\"; the first line has radius, reflectance",
        );
        refuse("r,reflectance\n", "no lines");
        refuse("r,reflectance\n1,x\n", "table.csv:2: reflectance is \"x\", but must be a number");
        refuse("r,reflectance\n1\n", "table.csv:2: the line has 1 values");
        refuse("r,reflectance\n0,1\n", "table.csv:2: r is 0, but must be in [1e-100, 1e100]");
        refuse("r,reflectance\n1,1\n1,1\n", "table.csv:3: r is 1, but must be greater than 1");
        refuse("r,reflectance\n1,-1\n", "reflectance is -1");
        refuse("r,reflectance\n1,nan\n", "reflectance is NaN");
        refuse("r,reflectance\n1,1\n2,1\n3,1\n", "has 3 radii, but needs at least 4");
        refuse("r,reflectance\n1,0\n2,0\n3,0\n4,0\n", "is 0 everywhere");
        refuse("r,reflectance,surface_albedo\n1,1,1.5\n", "surface_albedo is 1.5");
        let error = parse_profile_table(b"r,reflectance\n1,\xff\n", Path::new("t")).unwrap_err();
        assert!(error.message.contains("UTF-8"), "{error}");
    }
}
