//! Colors as CSV, JSON, text for people, and swatches.

use std::ffi::OsStr;
use std::fmt::Write as _;
use std::path::Path;

use translucid_laboratory::Cell;
use translucid_laboratory::colorimetry::wavelength;
use translucid_laboratory::stack::{Field, Swatch};

use super::{ERROR, Row, StackArguments, contrast, kubelka_munk_words};
use crate::failure::Failure;
use crate::files::write_file;
use crate::table::print;

const COLUMNS: &str = "ground,reflectance,transmittance,X,Y,Z,L,a,b,srgb,in_srgb,error,kubelka_munk_reflectance,\
                       kubelka_munk_delta_e,tp_ab,tp_2000,contrast_ratio";

/// Writes the table to a file or stdout, and the swatch if a picture is asked for.
pub(super) fn write(
    arguments: &StackArguments,
    rows: &[Row],
    spread: Option<&str>,
    conditions: &str,
) -> Result<(), Failure> {
    let (columns, cells) = if arguments.channels { channels(rows) } else { colors(rows) };
    let text = arguments.format.text(&columns, &cells, || paragraph(rows, spread, conditions));
    let Some(path) = &arguments.output else { return print(&text) };
    let swatch = || swatch(&arguments.file, rows, spread, conditions);
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    let picture = match extension.as_deref().and_then(OsStr::to_str) {
        Some("svg") => swatch().svg().map(String::into_bytes),
        Some("png") => swatch().png(),
        _ => return write_file(path, text.as_bytes()),
    };
    write_file(path, &picture.map_err(|error| Failure::work(format!("cannot draw the swatch: {error}")))?)?;
    print(&text)
}

type Cells = (Vec<String>, Vec<Vec<Cell>>);

fn colors(rows: &[Row]) -> Cells {
    let cells = |row: &Row| {
        let color = row.color;
        let numbers = [color.xyz[1] / 100.0, row.transmittance].into_iter().chain(color.xyz).chain(color.lab);
        let words = [color.hex(), String::from(if color.is_in_srgb() { "yes" } else { "no" })];
        let rest = [row.error, row.kubelka_munk.xyz[1] / 100.0, row.kubelka_munk_delta_e()];
        let head = std::iter::once(Cell::from(row.ground)).chain(numbers.map(Cell::Number));
        let tail = rest.into_iter().chain(contrast(rows)).map(Cell::Number);
        head.chain(words.map(Cell::Word)).chain(tail).collect()
    };
    (COLUMNS.split(',').map(str::to_owned).collect(), rows.iter().map(cells).collect())
}

/// Reflectances by channel, a column for each ground, then the transmittance and the greatest error.
fn channels(rows: &[Row]) -> Cells {
    let count = rows[0].measured.reflectance.len();
    let mut columns = vec![String::from(if count > 3 { "wavelength" } else { "channel" })];
    columns.extend(rows.iter().map(|row| format!("reflectance_{}", row.ground)));
    columns.extend(["transmittance", "error"].map(str::to_owned));
    let own = &rows[rows.len() - 1];
    let cells = |i: usize| {
        let name = if count == 3 { ["red", "green", "blue"][i] } else { "all" };
        let mut cells = vec![if count > 3 { Cell::Number(wavelength(i)) } else { Cell::from(name) }];
        cells.extend(rows.iter().map(|row| Cell::Number(row.measured.reflectance[i])));
        // As in the table of colors, no number over a ground
        cells.push(Cell::Number(own.measured.transmittance[i] + 0.0 * own.transmittance));
        cells.push(Cell::Number(rows.iter().map(|row| row.measured.errors[i]).fold(0.0, f64::max)));
        cells
    };
    (columns, (0..count).map(cells).collect())
}

/// Lines for people.
fn paragraph(rows: &[Row], spread: Option<&str>, conditions: &str) -> String {
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
    for line in contrast_words(rows).into_iter().chain(kubelka_munk_words(rows, 0.0)) {
        let _ = writeln!(text, "{line}");
    }
    if let Some(line) = spread {
        let _ = writeln!(text, "{}", sentence(line));
    }
    let error = rows.iter().map(|row| row.error).fold(0.0, f64::max);
    let error = if error < ERROR { format!("{error:.0e}") } else { format!("{error:.2}") };
    let _ = writeln!(text, "{conditions}; numerical errors up to {error} ΔE*ab");
    text
}

/// TP and contrast ratio in words, if there are any.
fn contrast_words(rows: &[Row]) -> Option<String> {
    let [tp_ab, tp_2000, ratio] = contrast(rows);
    let ratio = if ratio.is_nan() { String::new() } else { format!(", contrast ratio {ratio:.3}") };
    (!tp_ab.is_nan()).then(|| format!("TP {tp_ab:.2} ΔE*ab, {tp_2000:.2} CIEDE2000{ratio}"))
}

/// Words with a capital letter.
fn sentence(words: &str) -> String {
    words[..1].to_uppercase() + &words[1..]
}

fn lab(row: &Row) -> String {
    // No negative zero
    let [l, a, b] = row.color.lab.map(|value| (100.0 * value).round() / 100.0 + 0.0);
    format!("{l:.2}, {a:.2}, {b:.2}")
}

fn swatch(file: &Path, rows: &[Row], spread: Option<&str>, conditions: &str) -> Swatch {
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
    let lines = contrast_words(rows).into_iter().chain(spread.map(sentence)).chain([conditions.to_owned()]);
    Swatch { title: name, lines: lines.collect(), fields: rows.iter().map(field).collect() }
}
