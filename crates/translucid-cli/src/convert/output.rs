//! Rows as CSV, JSON or text for people.

use std::fmt::Write as _;
use std::path::Path;

use translucid_files::check_writable;
use translucid_laboratory::Cell;
use translucid_profile::convention::{ConvertedNumber, Role, System};

use crate::failure::Failure;
use crate::files::write_file;
use crate::table::{ReadableFormat, exact, print};

/// One row of the table.
pub(super) type Row = [Cell; COLUMNS.len()];

/// Writes the numbers of systems and further rows to a file or to stdout.
pub(super) fn write(
    numbers: &[ConvertedNumber],
    more: &[Row],
    format: ReadableFormat,
    path: Option<&Path>,
) -> Result<(), Failure> {
    let rows: Vec<Vec<Cell>> = numbers.iter().map(cells).chain(more.iter().cloned()).map(Vec::from).collect();
    let text = format.text(&COLUMNS, &rows, || {
        let (numbers, more) = (paragraphs(numbers), plain_paragraphs(more));
        let separator = if numbers.is_empty() || more.is_empty() { "" } else { "\n" };
        numbers + separator + &more
    });
    let Some(path) = path else { return print(&text) };
    check_writable(path)?;
    write_file(path, text.as_bytes())
}

/// Every system with its parameters and its rule, a line each.
pub(super) fn list() -> String {
    let mut text = String::from("system                 length in  parameters and rule\n");
    for system in System::ALL {
        let unit = system.unit.name().unwrap_or("scene unit");
        let parameters: Vec<String> = system
            .parameters
            .iter()
            .map(|parameter| match parameter.role {
                Role::Factor { default, .. } | Role::Setting { default, .. } => {
                    format!("{} ({default})", parameter.name)
                }
                _ => parameter.name.to_owned(),
            })
            .collect();
        let (name, parameters, formula) = (system.name, parameters.join(", "), system.formula);
        text += &format!("{name:<21}  {unit:<10} {parameters}: {formula}\n");
    }
    text
}

pub(super) const COLUMNS: [&str; 7] = ["system", "parameter", "channel", "value", "unit", "equal", "source"];

fn cells(row: &ConvertedNumber) -> Row {
    let source = row.system.source;
    [
        Cell::from(row.system.name),
        Cell::from(row.parameter),
        Cell::from(row.channel),
        Cell::from(row.value),
        Cell::from(row.unit.as_str()),
        Cell::from(row.equal),
        Cell::from(format!("{}: {}", source.kind, source.place)),
    ]
}

fn paragraphs(rows: &[ConvertedNumber]) -> String {
    let width = rows.iter().map(|row| row.parameter.len()).max().unwrap_or(0);
    let mut text = String::new();
    for system in rows.chunk_by(|a, b| a.system.title == b.system.title) {
        let first = system[0].system;
        let separator = if text.is_empty() { "" } else { "\n" };
        let (name, title, version) = (first.name, first.title, first.version);
        // Writing to a string cannot fail
        let _ = writeln!(text, "{separator}{name}: {title} ({version})");
        let _ = writeln!(text, "  {}", first.formula);
        for parameter in system.chunk_by(|a, b| a.parameter == b.parameter) {
            let values: Vec<String> =
                parameter.iter().map(|row| format!("{:>10}", rounded(row.value))).collect();
            let line =
                format!("  {:<width$} {} {}", parameter[0].parameter, values.join(" "), parameter[0].unit);
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    text
}

/// Rows by their systems, which have no title.
fn plain_paragraphs(rows: &[Row]) -> String {
    let word = |row: &Row, i: usize| match &row[i] {
        Cell::Word(word) => word.clone(),
        Cell::Number(number) => rounded(*number),
    };
    let width = rows.iter().map(|row| word(row, 1).len()).max().unwrap_or(0);
    let mut text = String::new();
    for system in rows.chunk_by(|a, b| a[0] == b[0]) {
        let separator = if text.is_empty() { "" } else { "\n" };
        text += &format!("{separator}{}\n", word(&system[0], 0));
        for parameter in system.chunk_by(|a, b| a[1] == b[1]) {
            let values: Vec<String> = parameter.iter().map(|row| format!("{:>12}", word(row, 3))).collect();
            text += &format!("  {:<width$} {}\n", word(&parameter[0], 1), values.join(" "));
        }
    }
    text
}

/// A number to six digits.
fn rounded(value: f64) -> String {
    let six: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    exact(six)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_keeps_six_digits() {
        assert_eq!(rounded(0.1 + 0.2), "0.3");
        assert_eq!(rounded(1.0 / 3.0), "0.333333");
        assert_eq!(rounded(2e-300 / 3.0), "6.66667e-301");
        assert_eq!(rounded(0.0), "0");
    }
}
