//! Where the results of a fit go: stdout and stderr, or the files of a directory.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use translucid_image::{OutputError, check_writable, write_atomically};
use translucid_laboratory::Chart;

use crate::failure::Failure;
use crate::messages;
use crate::table::{TableFormat, exact};

#[derive(Args, Debug)]
pub(super) struct OutputArguments {
    /// Directory to write files to, in place of stdout and stderr; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How to write the table on stdout
    #[arg(long, value_enum, default_value = "csv", conflicts_with = "output")]
    format: TableFormat,
}

/// A value of a table.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// A number; one that is not finite counts as missing.
    Number(f64),
    /// A word without commas and quotes.
    Word(String),
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Value {
    fn from(word: &str) -> Self {
        Self::Word(word.to_owned())
    }
}

/// A table with named columns.
#[derive(Clone, Debug)]
pub(super) struct Table {
    /// File name in a directory.
    pub(super) file: &'static str,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
    /// One value for each column.
    pub(super) rows: Vec<Vec<Value>>,
}

impl Table {
    /// An empty table.
    pub(super) fn new(file: &'static str, columns: &[&str]) -> Self {
        Self { file, columns: columns.iter().map(|name| (*name).to_owned()).collect(), rows: Vec::new() }
    }

    /// Puts columns before the others, which have one word in all rows.
    pub(super) fn with_words(mut self, words: &[(&str, &str)]) -> Self {
        self.columns.splice(0..0, words.iter().map(|(name, _)| (*name).to_owned()));
        for row in &mut self.rows {
            row.splice(0..0, words.iter().map(|(_, word)| Value::from(*word)));
        }
        self
    }

    fn csv(&self) -> String {
        let field = |value: &Value| match value {
            Value::Number(number) if number.is_finite() => exact(*number),
            Value::Number(_) => String::new(),
            Value::Word(word) => word.clone(),
        };
        let line = |row: &Vec<Value>| row.iter().map(field).collect::<Vec<_>>().join(",");
        let lines = [self.columns.join(",")].into_iter().chain(self.rows.iter().map(line));
        lines.map(|line| line + "\n").collect()
    }

    fn json(&self) -> String {
        let field = |(name, value): (&String, &Value)| match value {
            Value::Number(number) if number.is_finite() => format!("\"{name}\":{}", exact(*number)),
            Value::Number(_) => format!("\"{name}\":null"),
            Value::Word(word) => format!("\"{name}\":\"{word}\""),
        };
        let object = |row: &Vec<Value>| {
            let fields: Vec<String> = self.columns.iter().zip(row).map(field).collect();
            format!("{{{}}}", fields.join(","))
        };
        format!("[\n{}\n]\n", self.rows.iter().map(object).collect::<Vec<_>>().join(",\n"))
    }
}

/// File of the report.
const REPORT: &str = "report.txt";

impl OutputArguments {
    /// Makes the directory and finds out whether its files can be written, before the work.
    pub(super) fn check(&self, files: &[&str], input: Option<&Path>) -> Result<(), Failure> {
        let Some(directory) = &self.output else { return Ok(()) };
        fs::create_dir_all(directory).map_err(|error| {
            let message = format!("cannot make the directory: {error}");
            OutputError::new(directory, message).with_help("name another directory with -o DIR")
        })?;
        let input = input.and_then(|path| fs::canonicalize(path).ok());
        for file in files.iter().chain([&REPORT]) {
            let path = directory.join(file);
            check_writable(&path)?;
            if input.is_some() && fs::canonicalize(&path).ok() == input {
                let error = OutputError::new(&path, "is a file that is read, and would be written over");
                return Err(error.with_help("name another directory with -o DIR").into());
            }
        }
        Ok(())
    }

    /// Writes the report, then the first of the tables, or with a directory all of them.
    pub(super) fn write(&self, report: &str, tables: &[Table]) -> Result<(), Failure> {
        let Some(directory) = &self.output else {
            messages::line(report.trim_end());
            return self.print(&tables[0]);
        };
        for table in tables {
            write_file(&directory.join(table.file), table.csv().as_bytes())?;
        }
        write_file(&directory.join(REPORT), report.as_bytes())
    }

    /// Writes a chart to the directory, if there is one, as SVG and as PNG.
    pub(super) fn write_chart(&self, chart: &Chart, [svg, png]: [&str; 2]) -> Result<(), Failure> {
        let Some(directory) = &self.output else { return Ok(()) };
        write_file(&directory.join(svg), chart.svg().as_bytes())?;
        let picture = chart.png().map_err(|error| Failure::work(error.to_string()))?;
        write_file(&directory.join(png), &picture)
    }

    /// Prints a table; a reader that closes stdout early is no error.
    fn print(&self, table: &Table) -> Result<(), Failure> {
        let text = match self.format {
            TableFormat::Csv => table.csv(),
            TableFormat::Json => table.json(),
        };
        let mut out = io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(Failure::work(format!("cannot write to stdout: {error}")))
            }
            _ => Ok(()),
        }
    }
}

fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_atomically(path, |out| out.write_all(bytes)).map_err(Failure::late)
}
