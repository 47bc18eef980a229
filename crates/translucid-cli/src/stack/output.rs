//! Colors as CSV, JSON, text for people, and swatches.

use std::fmt::Write as _;
use std::path::Path;

use clap::ValueEnum;
use translucid_files::check_writable;
use translucid_laboratory::Cell;
use translucid_laboratory::stack::{Field, Swatch};

use super::file::channel_name;
use super::{Contrast, Row, StackArguments, is_picture};
use crate::failure::Failure;
use crate::files::write_file;
use crate::table::{TableFormat, print};

/// How colors are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
    /// For people
    Text,
}

const COLUMNS: [&str; 17] = [
    "ground",
    "reflectance",
    "transmittance",
    "X",
    "Y",
    "Z",
    "L",
    "a",
    "b",
    "srgb",
    "in_srgb",
    "error",
    "kubelka_munk_reflectance",
    "kubelka_munk_delta_e",
    "tp_ab",
    "tp_2000",
    "contrast_ratio",
];

/// Writes the table to a file or stdout, and the swatch if a picture is asked for.
pub(super) fn write(arguments: &StackArguments, rows: &[Row], contrast: &Contrast) -> Result<(), Failure> {
    let conditions = arguments.conditions(rows[0].measured.reflectance.len());
    let (columns, cells) = if arguments.channels { channels(rows) } else { colors(rows, contrast) };
    let text = match arguments.format {
        OutputFormat::Csv => TableFormat::Csv.text(&columns, &cells),
        OutputFormat::Json => TableFormat::Json.text(&columns, &cells),
        OutputFormat::Text if arguments.channels => {
            return Err(Failure::input("--channels is a table, which --format text does not print")
                .with_help("use --format csv or json"));
        }
        OutputFormat::Text => paragraph(rows, contrast, &conditions),
    };
    let Some(path) = &arguments.output else { return print(&text) };
    check_writable(path)?;
    let failed = |error: std::io::Error| Failure::work(format!("cannot draw the swatch: {error}"));
    if is_picture(path, "svg") {
        write_file(
            path,
            swatch(&arguments.file, rows, contrast, &conditions).svg().map_err(failed)?.as_bytes(),
        )?;
    } else if is_picture(path, "png") {
        write_file(path, &swatch(&arguments.file, rows, contrast, &conditions).png().map_err(failed)?)?;
    } else {
        return write_file(path, text.as_bytes());
    }
    print(&text)
}

type Cells = (Vec<String>, Vec<Vec<Cell>>);

fn colors(rows: &[Row], contrast: &Contrast) -> Cells {
    let cells = |row: &Row| {
        let color = row.color;
        let numbers = [color.xyz[1] / 100.0, row.transmittance].into_iter().chain(color.xyz).chain(color.lab);
        let mut cells = vec![Cell::from(row.ground)];
        cells.extend(numbers.map(Cell::Number));
        cells.extend([Cell::from(color.hex()), Cell::from(if color.is_in_srgb() { "yes" } else { "no" })]);
        let rest = [
            row.error,
            row.kubelka_munk.xyz[1] / 100.0,
            row.kubelka_munk_delta_e(),
            contrast.tp_ab,
            contrast.tp_2000,
            contrast.ratio,
        ];
        cells.extend(rest.map(Cell::Number));
        cells
    };
    (COLUMNS.map(str::to_owned).to_vec(), rows.iter().map(cells).collect())
}

/// Reflectances by channel, a column for each ground, then the transmittance and the greatest error.
fn channels(rows: &[Row]) -> Cells {
    let count = rows[0].measured.reflectance.len();
    let mut columns = vec![String::from(if count > 3 { "wavelength" } else { "channel" })];
    columns.extend(rows.iter().map(|row| format!("reflectance_{}", row.ground)));
    columns.extend(["transmittance", "error"].map(str::to_owned));
    let own = &rows[rows.len() - 1];
    let cells = |i: usize| {
        let name = channel_name(i, count);
        let mut cells = vec![name.parse().map_or(Cell::Word(name), Cell::Number)];
        cells.extend(rows.iter().map(|row| Cell::Number(row.measured.reflectance[i])));
        // As in the table of colors, no number over a ground
        cells.push(Cell::Number(own.measured.transmittance[i] + 0.0 * own.transmittance));
        cells.push(Cell::Number(rows.iter().map(|row| row.measured.errors[i]).fold(0.0, f64::max)));
        cells
    };
    (columns, (0..count).map(cells).collect())
}

/// Lines for people.
fn paragraph(rows: &[Row], contrast: &Contrast, conditions: &str) -> String {
    let mut text = format!(
        "{:<7}{:>12}{:>15}  L*, a*, b*                 sRGB\n",
        "over", "reflectance", "transmittance"
    );
    for row in rows {
        let transmittance =
            if row.transmittance.is_nan() { String::from("-") } else { format!("{:.4}", row.transmittance) };
        // Writing to a string cannot fail
        let _ = writeln!(
            text,
            "{:<7}{:>12.4}{transmittance:>15}  {:<25}  {}{}",
            row.ground,
            row.color.xyz[1] / 100.0,
            lab(row),
            row.color.hex(),
            if row.color.is_in_srgb() { "" } else { " (nearest)" }
        );
    }
    if let Some(line) = words(contrast) {
        let _ = writeln!(text, "{line}");
    }
    let distances: Vec<String> =
        rows.iter().map(|row| format!("{:.2} over {}", row.kubelka_munk_delta_e(), row.place())).collect();
    let _ =
        writeln!(text, "Kubelka-Munk with Saunderson's correction is off by ΔE*ab {}", distances.join(", "));
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    let _ = writeln!(text, "{conditions}; numerical errors up to {error:.0e} ΔE*ab");
    text
}

/// TP and contrast ratio in words, if there are any.
fn words(contrast: &Contrast) -> Option<String> {
    let Contrast { tp_ab, tp_2000, ratio } = contrast;
    let ratio = if ratio.is_nan() { String::new() } else { format!(", contrast ratio {ratio:.3}") };
    (!tp_ab.is_nan()).then(|| format!("TP {tp_ab:.2} ΔE*ab, {tp_2000:.2} CIEDE2000{ratio}"))
}

fn lab(row: &Row) -> String {
    // No negative zero
    let [l, a, b] = row.color.lab.map(|value| (100.0 * value).round() / 100.0 + 0.0);
    format!("{l:.2}, {a:.2}, {b:.2}")
}

fn swatch(file: &Path, rows: &[Row], contrast: &Contrast, conditions: &str) -> Swatch {
    let field = |row: &Row| {
        let nearest = if row.color.is_in_srgb() { "" } else { ", the nearest color of sRGB" };
        let mut lines = vec![
            format!("L*, a*, b*: {}", lab(row)),
            format!("{}{nearest}", row.color.hex()),
            format!("reflectance {:.4}", row.color.xyz[1] / 100.0),
        ];
        if !row.transmittance.is_nan() {
            lines.push(format!("transmittance {:.4}", row.transmittance));
        }
        Field { name: format!("over {}", row.place()), ground: row.bare, layers: row.color, lines }
    };
    let name = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let lines = words(contrast).into_iter().chain([conditions.to_owned()]);
    Swatch { title: name, lines: lines.collect(), fields: rows.iter().map(field).collect() }
}
