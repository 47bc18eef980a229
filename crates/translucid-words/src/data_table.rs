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
