//! Tables of words and numbers, whose columns have units and meanings.

use std::borrow::Cow;

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

impl Cell {
    /// A field of comma-separated values (RFC 4180), empty for a number that is missing.
    pub fn csv(&self) -> String {
        match self {
            Self::Number(number) if number.is_finite() => exact(*number),
            Self::Number(_) => String::new(),
            Self::Word(word) => csv_word(word),
        }
    }

    /// A JSON value: a number, null where it is missing, or a string of words without control characters.
    pub fn json(&self) -> String {
        match self {
            Self::Number(number) if number.is_finite() => exact(*number),
            Self::Number(_) => String::from("null"),
            Self::Word(word) => format!("\"{}\"", word.replace('\\', "\\\\").replace('"', "\\\"")),
        }
    }
}

/// A word among comma-separated values, in quotes where it needs them.
fn csv_word(word: &str) -> String {
    if word.contains([',', '"', '\n', '\r']) || word.trim() != word {
        format!("\"{}\"", word.replace('"', "\"\""))
    } else {
        word.to_owned()
    }
}

/// A column: its name, its unit and what it means.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name.
    pub name: Cow<'static, str>,
    /// Its unit; "1" of plain numbers, empty of words.
    pub unit: &'static str,
    /// What it means.
    pub meaning: &'static str,
}

impl Column {
    /// A column of numbers in a unit, or of words where the unit is empty.
    pub const fn new(name: &'static str, unit: &'static str, meaning: &'static str) -> Self {
        Self { name: Cow::Borrowed(name), unit, meaning }
    }

    /// The column under another name.
    #[must_use]
    pub fn named(&self, name: String) -> Self {
        Self { name: Cow::Owned(name), ..self.clone() }
    }
}

impl From<String> for Column {
    fn from(name: String) -> Self {
        Self { name: Cow::Owned(name), unit: "", meaning: "" }
    }
}

impl AsRef<str> for Column {
    fn as_ref(&self) -> &str {
        &self.name
    }
}

/// A table with named columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DataTable {
    /// Stem of its file's name.
    pub name: String,
    /// Content in a sentence.
    pub caption: String,
    /// Columns from left to right.
    pub columns: Vec<Column>,
    /// One cell for each column; what a shorter row lacks is missing.
    pub rows: Vec<Vec<Cell>>,
}

impl DataTable {
    /// An empty table whose columns have these names alone.
    pub fn new(name: &str, caption: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&name| Column::from(name.to_owned())).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn push<const N: usize>(&mut self, row: [Cell; N]) {
        self.rows.push(row.into());
    }

    /// The cells of a row, as many as there are columns.
    pub fn cells<'a>(&self, row: &'a [Cell]) -> impl Iterator<Item = Option<&'a Cell>> {
        (0..self.columns.len()).map(|i| row.get(i))
    }

    /// Comma-separated values after a line with the names \[RFC 4180, with line feeds\].
    ///
    /// Numbers are the shortest that read back exactly; missing ones are empty.
    pub fn csv(&self) -> String {
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let mut text = line(self.columns.iter().map(|column| csv_word(&column.name)).collect());
        for row in &self.rows {
            text += &line(self.cells(row).map(|cell| cell.map_or(String::new(), Cell::csv)).collect());
        }
        text
    }

    /// An empty table of these columns.
    pub fn of(columns: &[Column]) -> Self {
        Self { columns: columns.to_vec(), ..Self::default() }
    }

    /// The numbers of a column; not a number where there is none.
    pub fn numbers(&self, column: usize) -> Vec<f64> {
        let number = |row: &Vec<Cell>| match row.get(column) {
            Some(Cell::Number(number)) => *number,
            _ => f64::NAN,
        };
        self.rows.iter().map(number).collect()
    }
}

/// The shortest text that reads back as the same number; valid in CSV and JSON.
pub fn exact(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude != 0.0 && !(1e-5..1e16).contains(&magnitude) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_reads_back_exactly() {
        let mut table = DataTable::new("errors", "Errors", &["model", "error, %", "time / ns"]);
        table.push([Cell::from("a,b \"c\" <d>|e"), Cell::from(0.1 + 0.2), Cell::from(1e-300)]);
        table.push([Cell::from("two\nlines"), Cell::from(f64::NAN), Cell::from(-12345.678)]);
        table.push([Cell::from(7.0)]);
        assert_eq!(
            table.csv(),
            "model,\"error, %\",time / ns\n\"a,b \"\"c\"\" <d>|e\",0.30000000000000004,1e-300\n\
             \"two\nlines\",,-12345.678\n7,,\n"
        );
    }

    #[test]
    fn exact_reads_back_as_the_same_number() {
        let mut bits = 1_u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(bits ^ (bits >> 29));
            if value.is_finite() {
                assert_eq!(exact(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
            }
        }
        for value in [0.0, 0.1, 1.0, 1e-300, f64::MAX, f64::MIN_POSITIVE / 4.0] {
            assert_eq!(exact(value).parse::<f64>().unwrap(), value);
        }
    }

    #[test]
    fn cells_survive_commas_and_quotes() {
        assert_eq!(Cell::from("a, \"b\"").csv(), "\"a, \"\"b\"\"\"");
        assert_eq!(Cell::from("#a b").csv(), "#a b");
        assert_eq!(Cell::from("a\\\"b'").json(), "\"a\\\\\\\"b'\"");
        assert_eq!([Cell::csv, Cell::json].map(|text| text(&Cell::from(f64::NAN))), ["", "null"]);
    }
}
