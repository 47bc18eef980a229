//! Converted numbers as a table and as text for people.

use std::fmt::Write as _;

use translucid_profile::convention::{ConvertedNumber, Role, System, Unit};
use translucid_words::{Cell, Column, exact};

#[rustfmt::skip]
pub(crate) static COLUMNS: [Column; 7] = [
    Column::new("system", "", "system of the number; slab, or color space"),
    Column::new("parameter", "", "its parameter"),
    Column::new("channel", "", "all, or r, g, b"),
    Column::new("value", "", "the number, in the unit of its row"),
    Column::new("unit", "", "unit of a length or a coefficient"),
    Column::new("equal", "", "what the conversion keeps: surface_albedo, the width d of Burley's profile, or mfp; empty where nothing is"),
    Column::new("source", "", "how the rule was seen (code, document or measured pictures; exact or computed for numbers of no system's), and where"),
];

/// Every system with its versions, how its rule was seen, its parameters and the rule, a line each.
pub(crate) fn list() -> String {
    let row = |cells: [&str; 5]| {
        let [system, unit, seen, version, rule] = cells;
        format!("{system:<21}  {unit:<9}  {seen:<8}  {version:<23}  {rule}\n")
    };
    let mut text = row(["system", "length in", "seen", "versions", "parameters and rule"]);
    for system in System::ALL {
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
        let unit = system.unit.map_or("scene", Unit::name);
        let rule = format!("{}: {}", parameters.join(", "), system.formula);
        text += &row([system.name, unit, system.source.kind, system.version, &rule]);
    }
    text
}

/// Cells of a row.
pub(crate) fn cells(row: &ConvertedNumber) -> Vec<Cell> {
    vec![
        Cell::from(row.system),
        Cell::from(row.parameter),
        Cell::from(row.channel),
        Cell::from(row.value),
        Cell::from(row.unit.as_str()),
        Cell::from(row.equal),
        Cell::from(row.source.as_str()),
    ]
}

/// Numbers by their systems, each in the ways to specify a material in it.
pub(crate) fn paragraphs(rows: &[ConvertedNumber]) -> String {
    // What no rule of a system gives stands in wider columns of its own
    let is_plain = |row: &ConvertedNumber| row.way.is_none();
    let longest = |plain: bool| {
        rows.iter().filter(|row| is_plain(row) == plain).map(|row| row.parameter.len()).max().unwrap_or(0)
    };
    let widths = [longest(false), longest(true)];
    let title = |row: &ConvertedNumber| (row.system, row.way.map(|way| way.title));
    let mut text = String::new();
    for system in rows.chunk_by(|a, b| title(a) == title(b)) {
        let first = &system[0];
        let separator = if text.is_empty() { "" } else { "\n" };
        // Writing to a string cannot fail
        let _ = match first.way {
            Some(way) => writeln!(
                text,
                "{separator}{}: {} ({})\n  {}",
                first.system, way.title, way.version, way.formula
            ),
            None => writeln!(text, "{separator}{}", first.system),
        };
        let (width, column) = if is_plain(first) { (widths[1], 12) } else { (widths[0], 10) };
        for parameter in system.chunk_by(|a, b| a.parameter == b.parameter) {
            let values: Vec<String> =
                parameter.iter().map(|row| format!("{:>column$}", rounded(row.value))).collect();
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
    fn rounded_keeps_six_digits() {
        assert_eq!(rounded(0.1 + 0.2), "0.3");
        assert_eq!(rounded(1.0 / 3.0), "0.333333");
        assert_eq!(rounded(2e-300 / 3.0), "6.66667e-301");
        assert_eq!(rounded(0.0), "0");
    }
}
