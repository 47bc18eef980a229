//! Tables of words and numbers as pages show them.

use translucid_words::{Cell, DataTable};

use crate::markup::escape;

/// A row of cells from words and numbers.
#[cfg(not(target_family = "wasm"))]
macro_rules! row {
    ($($cell:expr),+ $(,)?) => { vec![$($crate::Cell::from($cell)),+] };
}

#[cfg(not(target_family = "wasm"))]
pub(crate) use row;

/// An HTML table with a caption, numbers rounded to four digits and missing ones as a dash.
pub(crate) fn html(table: &DataTable) -> String {
    let mut text = String::from("<table>\n");
    if !table.caption.is_empty() {
        text += &format!("<caption>{}</caption>\n", escape(&table.caption));
    }
    text += "<thead><tr>";
    for column in &table.columns {
        text += &format!("<th scope=\"col\">{}</th>", escape(&column.name));
    }
    text += "</tr></thead>\n<tbody>\n";
    for row in &table.rows {
        text += "<tr>";
        for (i, cell) in table.cells(row).enumerate() {
            let class = if matches!(cell, Some(Cell::Word(_))) { "" } else { " class=\"number\"" };
            // A unit stays with its number where a cell is broken into lines
            let content = escape(&shown(cell)).replace(" %", "\u{a0}%");
            text += &match i {
                0 => format!("<th scope=\"row\"{class}>{content}</th>"),
                _ => format!("<td{class}>{content}</td>"),
            };
        }
        text += "</tr>\n";
    }
    text + "</tbody>\n</table>\n"
}

/// A cell for readers.
fn shown(cell: Option<&Cell>) -> String {
    match cell {
        Some(Cell::Number(number)) if number.is_finite() => rounded(*number),
        Some(Cell::Word(word)) => word.clone(),
        _ => String::from("–"),
    }
}

/// The number to four significant digits, without zeros where it has fewer, with a true minus and a power of ten where it is very small or large.
fn rounded(number: f64) -> String {
    let text = format!("{number:.3e}");
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let exact = format!("{number}");
    let digits = exact.trim_start_matches(['-', '0', '.']).chars().filter(char::is_ascii_digit).count();
    let text = if digits <= 4 && (-3..6).contains(&exponent) {
        exact
    } else if number.fract() == 0.0 && number.abs() < 1e7 {
        format!("{number}")
    } else if (-3..6).contains(&exponent) {
        format!("{number:.*}", usize::try_from(3 - exponent).unwrap_or(0))
    } else {
        format!("{mantissa}e{exponent}")
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> DataTable {
        let mut table =
            DataTable::new("errors", "Errors <of> \"models\"", &["model", "error, %", "time / ns"]);
        table.push([Cell::from("a,b \"c\" <d>|e"), Cell::from(0.1 + 0.2), Cell::from(1e-300)]);
        table.push([Cell::from("two\nlines"), Cell::from(f64::NAN), Cell::from(-12345.678)]);
        table.push([Cell::from(7.0)]);
        table
    }

    #[test]
    fn html_is_well_formed_and_escaped() {
        let text = html(&table());
        let document = roxmltree::Document::parse(&text).unwrap();
        let cells: Vec<_> = document.descendants().filter(|node| node.has_tag_name("td")).collect();
        assert_eq!(cells.len(), 6);
        assert!(text.contains("a,b &quot;c&quot; &lt;d&gt;|e") && text.contains("−12346"));
    }

    #[test]
    fn readers_see_four_digits() {
        assert_eq!(
            [0.01, -0.5, 0.0, 1e5, 2.25, 42.2034, 0.1 + 0.2, 1e-300].map(rounded),
            ["0.01", "−0.5", "0", "100000", "2.25", "42.20", "0.3000", "1.000e−300"]
        );
    }
}
