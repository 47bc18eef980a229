//! Tables as files: comma-separated values, JSON, and the schema of the JSON.

use std::fmt::Write as _;

use super::table::Table;
use translucid_words::{Cell, DataTable, exact};

/// Name of the schema's file.
pub const SCHEMA_FILE: &str = "schema.json";

/// Number of digits that values have in the files, more than any of them is known to.
const DIGITS: usize = 12;

/// A number of so many significant digits.
pub(super) fn rounded(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// The cell of a value.
pub(super) fn number(value: f64) -> Cell {
    Cell::Number(rounded(value, DIGITS))
}

/// The cell of an error, of which two digits do.
pub(super) fn error(value: f64) -> Cell {
    Cell::Number(rounded(value, 2))
}

/// A table with the command that makes it.
pub(super) fn json(table: &Table, data: &DataTable, photons: u64) -> String {
    let mut text = String::from("{\n");
    let member = |name: &str, value: &str| format!("\"{name}\": {}", quoted(value));
    let head = [
        member("$schema", SCHEMA_FILE),
        member("table", table.name),
        member("program", "translucid"),
        member("version", env!("CARGO_PKG_VERSION")),
        member("command", &table.command(photons)),
        member("content", table.content),
        member("method", table.method),
        member("check", table.check),
    ];
    let columns = table.columns.iter().map(|column| {
        let members =
            [member("name", &column.name), member("unit", column.unit), member("meaning", column.meaning)];
        format!("{{{}}}", members.join(", "))
    });
    // Writing to a string cannot fail
    let _ = write!(
        text,
        "{},\n\"columns\": [\n{}\n],\n",
        head.join(",\n"),
        columns.collect::<Vec<_>>().join(",\n")
    );
    let cell = |cell: &Cell| match cell {
        Cell::Number(number) if number.is_finite() => exact(*number),
        Cell::Number(_) => String::from("null"),
        Cell::Word(word) => quoted(word),
    };
    let row = |row: &Vec<Cell>| format!("[{}]", row.iter().map(cell).collect::<Vec<_>>().join(","));
    let rows: Vec<String> = data.rows.iter().map(row).collect();
    let _ = write!(text, "\"rows\": [\n{}\n]\n}}\n", rows.join(",\n"));
    text
}

/// A string of this crate's own words, none of which has a control character.
fn quoted(word: &str) -> String {
    format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\""))
}

/// JSON schema (draft 2020-12) of the tables' files.
pub(super) fn schema(tables: &[Table]) -> String {
    let names: Vec<String> = tables.iter().map(|table| quoted(table.name)).collect();
    format!(
        r#"{{
"$schema": "https://json-schema.org/draft/2020-12/schema",
"title": "Oracle tables of translucid: light under surfaces, for tests of other programs",
"type": "object",
"required": ["table", "program", "version", "command", "content", "method", "check", "columns", "rows"],
"properties": {{
  "$schema": {{"type": "string"}},
  "table": {{"enum": [{}]}},
  "program": {{"const": "translucid"}},
  "version": {{"type": "string", "description": "Version of the program that has made the file"}},
  "command": {{"type": "string", "description": "Command that makes the file"}},
  "content": {{"type": "string"}},
  "method": {{"type": "string", "description": "How the numbers were obtained, and what their errors are"}},
  "check": {{"type": "string", "description": "By what else the numbers are tested"}},
  "columns": {{
    "type": "array",
    "items": {{
      "type": "object",
      "required": ["name", "unit", "meaning"],
      "properties": {{
        "name": {{"type": "string"}},
        "unit": {{"type": "string", "description": "1 for pure numbers; mfp is the mean free path"}},
        "meaning": {{"type": "string"}}
      }},
      "additionalProperties": false
    }}
  }},
  "rows": {{
    "type": "array",
    "description": "One array a row, with one value a column; null where there is none",
    "items": {{"type": "array", "items": {{"type": ["number", "string", "null"]}}}}
  }}
}},
"additionalProperties": false
}}
"#,
        names.join(", ")
    )
}
