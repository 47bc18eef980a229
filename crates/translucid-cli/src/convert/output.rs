//! Rows as CSV, JSON or text for people.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use clap::ValueEnum;
use translucid_image::write_atomically;
use translucid_profile::convention::{LengthUnit, Role, System};
use translucid_scene::ConvertedNumber;

use crate::failure::Failure;
use crate::table::exact;

/// How rows are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SettingFormat {
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
    /// For people: a paragraph for each system, six digits
    Text,
}

/// Writes the rows to a file or to stdout.
pub(super) fn write(rows: &[ConvertedNumber], format: SettingFormat, path: Option<&Path>) -> Result<(), Failure> {
    let text = match format {
        SettingFormat::Csv => csv(rows),
        SettingFormat::Json => json(rows),
        SettingFormat::Text => paragraphs(rows),
    };
    if let Some(path) = path {
        translucid_image::check_writable(path)?;
        return write_atomically(path, |out| out.write_all(text.as_bytes())).map_err(Failure::late);
    }
    print(&text)
}

/// Writes to stdout, whose reader may leave early.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::work(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Every system with its parameters and its rule, a line each.
pub(super) fn list() -> String {
    let mut text = String::from("system                 length in  parameters and rule\n");
    for system in System::ALL {
        let unit = match system.unit {
            LengthUnit::Scene => "scene unit",
            LengthUnit::Millimeter => "mm",
            LengthUnit::Centimeter => "cm",
        };
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

const COLUMNS: [&str; 7] = ["system", "parameter", "channel", "value", "unit", "equal", "source"];

/// The texts of a row; the fourth is a number.
fn fields(row: &ConvertedNumber) -> [String; 7] {
    let source = row.system.source;
    let kind = if source.is_code { "code" } else { "document" };
    let text = |text: &str| text.to_owned();
    [
        text(row.system.name),
        text(row.parameter),
        text(row.channel),
        exact(row.value),
        row.unit.clone(),
        text(row.equal),
        format!("{kind}: {}", source.place),
    ]
}

fn csv(rows: &[ConvertedNumber]) -> String {
    let mut text = COLUMNS.join(",") + "\n";
    for row in rows {
        text += &fields(row).map(|field| quoted_if_needed(&field)).join(",");
        text.push('\n');
    }
    text
}

/// A field of a CSV file (RFC 4180).
fn quoted_if_needed(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

fn json(rows: &[ConvertedNumber]) -> String {
    let objects: Vec<String> = rows
        .iter()
        .map(|row| {
            let mut members = Vec::new();
            for (i, (name, field)) in COLUMNS.iter().zip(fields(row)).enumerate() {
                let value = if i == 3 { field } else { json_string(&field) };
                members.push(format!("\"{name}\":{value}"));
            }
            format!("\n{{{}}}", members.join(","))
        })
        .collect();
    if objects.is_empty() { "[]\n".to_owned() } else { format!("[{}\n]\n", objects.join(",")) }
}

/// A string of names and paths, none of which has a control character.
fn json_string(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
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

/// A number to six digits.
fn rounded(value: f64) -> String {
    let six: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    exact(six)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_survive_commas_and_quotes() {
        assert_eq!(quoted_if_needed("a, \"b\""), "\"a, \"\"b\"\"\"");
        assert_eq!(quoted_if_needed("a b"), "a b");
        assert_eq!(json_string("a\\\"b"), "\"a\\\\\\\"b\"");
    }

    #[test]
    fn rounded_keeps_six_digits() {
        assert_eq!(rounded(0.1 + 0.2), "0.3");
        assert_eq!(rounded(1.0 / 3.0), "0.333333");
        assert_eq!(rounded(2e-300 / 3.0), "6.66667e-301");
        assert_eq!(rounded(0.0), "0");
    }
}
