//! A table of words and numbers.

use crate::markup::escape;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A number; one that is not finite counts as missing.
    Number(f64),
    /// Words.
    Word(String),
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Cell {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

impl From<String> for Cell {
    fn from(word: String) -> Self {
        Self::Word(word)
    }
}

/// A row of cells from words and numbers.
#[cfg(not(target_family = "wasm"))]
macro_rules! row {
    ($($cell:expr),+ $(,)?) => { vec![$($crate::Cell::from($cell)),+] };
}

#[cfg(not(target_family = "wasm"))]
pub(crate) use row;

/// A table with named columns.
#[derive(Clone, Debug, PartialEq)]
pub struct DataTable {
    /// Stem of its file's name.
    pub name: String,
    /// Content in a sentence.
    pub caption: String,
    /// Names of the columns, with units where they have one.
    pub columns: Vec<String>,
    /// One cell for each column; what a shorter row lacks is missing.
    pub rows: Vec<Vec<Cell>>,
}

impl DataTable {
    /// An empty table.
    pub fn new(name: &str, caption: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&column| column.to_owned()).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, row: [Cell; N]) {
        self.rows.push(row.into());
    }

    /// Comma-separated values after a line with the names \[RFC 4180, with line feeds\].
    ///
    /// Numbers are the shortest that read back exactly; missing ones are empty.
    pub fn csv(&self) -> String {
        let mut text = line(self.columns.iter().map(|column| field(column)));
        for row in &self.rows {
            text += &line(self.cells(row).map(|cell| match cell {
                Some(Cell::Number(number)) if number.is_finite() => exact(*number),
                Some(Cell::Word(word)) => field(word),
                _ => String::new(),
            }));
        }
        text
    }

    /// An HTML table with a caption, numbers rounded to four digits and missing ones as a dash.
    pub fn html(&self) -> String {
        let mut text = String::from("<table>\n");
        if !self.caption.is_empty() {
            text += &format!("<caption>{}</caption>\n", escape(&self.caption));
        }
        text += "<thead><tr>";
        for column in &self.columns {
            text += &format!("<th scope=\"col\">{}</th>", escape(column));
        }
        text += "</tr></thead>\n<tbody>\n";
        for row in &self.rows {
            text += "<tr>";
            for (i, cell) in self.cells(row).enumerate() {
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

    /// The cells of a row, as many as there are columns.
    fn cells<'a>(&self, row: &'a [Cell]) -> impl Iterator<Item = Option<&'a Cell>> {
        (0..self.columns.len()).map(|i| row.get(i))
    }
}

/// A line of comma-separated fields.
fn line(fields: impl Iterator<Item = String>) -> String {
    fields.collect::<Vec<_>>().join(",") + "\n"
}

/// A field of comma-separated values, in quotes where it needs them.
fn field(word: &str) -> String {
    if word.contains([',', '"', '\n', '\r', '#']) || word.trim() != word {
        format!("\"{}\"", word.replace('"', "\"\""))
    } else {
        word.to_owned()
    }
}

/// The shortest text that reads back as the number.
pub(crate) fn exact(number: f64) -> String {
    if number == 0.0 || (1e-4..1e7).contains(&number.abs()) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
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
    fn csv_reads_back_exactly() {
        let text = table().csv();
        assert_eq!(
            text,
            "model,\"error, %\",time / ns\n\"a,b \"\"c\"\" <d>|e\",0.30000000000000004,1e-300\n\
             \"two\nlines\",,-12345.678\n7,,\n"
        );
    }

    #[test]
    fn csv_numbers_read_back_exactly() {
        for number in [f64::MIN_POSITIVE, f64::MAX, -5e-324, 1.0 / 3.0, 1e7, 123456.7, -0.0, 1e-4] {
            assert_eq!(exact(number).parse::<f64>().map(f64::to_bits), Ok(number.to_bits()));
        }
    }

    #[test]
    fn html_is_well_formed_and_escaped() {
        let text = table().html();
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
