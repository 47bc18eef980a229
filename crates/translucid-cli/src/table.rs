//! Tables of numbers: CSV or JSON, to stdout or a file.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::{Args, ValueEnum};
use translucid_files::write_atomically;
use translucid_words::Cell;
pub(crate) use translucid_words::exact;

use crate::failure::Failure;
use crate::files::input_among;
use crate::interrupt;

/// Where a table goes, and how.
#[derive(Args, Debug)]
pub(crate) struct TableArguments {
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to write numbers
    #[arg(long, value_enum, default_value_t = TableFormat::Csv)]
    format: TableFormat,
}

/// Text formats of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TableFormat {
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
}

/// Formats of a table that people may read, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReadableFormat {
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
    /// For people, numbers rounded
    Text,
}

impl TableArguments {
    /// The file, where its name ends in `.npz`: it is not for text.
    pub(crate) fn npz(&self) -> Option<&Path> {
        self.output.as_deref().filter(|path| is_npz(path))
    }

    /// Whether the table is JSON.
    pub(crate) fn is_json(&self) -> bool {
        self.format == TableFormat::Json
    }

    /// The file, if the table is not for stdout.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.output.as_deref()
    }

    /// Finds out whether the file can be written, before long work.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        self.output.as_deref().map_or(Ok(()), |path| Ok(translucid_files::check_writable(path)?))
    }

    /// Refuses to write over a file that is read, whatever paths both go by.
    pub(crate) fn spare<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        match input_among(self.output.iter().map(PathBuf::as_path), inputs) {
            Some(path) => {
                let message =
                    format!("--output is {}, a file that is read, and would be overwritten", path.display());
                Err(Failure::input(message).with_help("choose another file for the printed table"))
            }
            None => Ok(()),
        }
    }

    /// Writes a table row by row; a reader that closes stdout early ends it without an error.
    pub(crate) fn write<const N: usize>(
        &self,
        columns: [&str; N],
        rows: impl Iterator<Item = [f64; N]>,
    ) -> Result<(), Failure> {
        self.write_cells(columns, rows.map(|row| row.map(Cell::Number)))
    }

    /// Writes a table of numbers and words in the same way.
    pub(crate) fn write_cells<const N: usize>(
        &self,
        columns: [&str; N],
        rows: impl Iterator<Item = [Cell; N]>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.output else {
            let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
            let written = self.format.write(&mut out, &columns, rows).and_then(|()| out.flush());
            // Dropping the writer would try to write the rest once more.
            drop(out.into_parts());
            return printed(written);
        };
        translucid_files::check_writable(path)?;
        interrupt::catch("\nstopping")?;
        let written = write_atomically(path, |out| self.format.write(&mut Guarded(out), &columns, rows));
        match written {
            Err(_) if interrupt::STOP.load(Ordering::Relaxed) => {
                Err(Failure::interrupted(format!("{} was not written", path.display())))
            }
            other => other.map_err(Failure::late),
        }
    }
}

fn is_npz(path: &Path) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case("npz"))
}

/// Refuses a file whose name ends in `.npz`, where there are no photons to keep in it.
pub(crate) fn refuse_npz(output: Option<&Path>) -> Result<(), Failure> {
    let Some(path) = output.filter(|path| is_npz(path)) else { return Ok(()) };
    let message = format!("--output is {}, but this is a table of numbers", path.display());
    Err(Failure::input(message).with_help("name a .csv file, or a .json file with --format json"))
}

/// Prints a text to stdout.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    printed(out.write_all(text.as_bytes()).and_then(|()| out.flush()))
}

/// The outcome of printing: a reader that leaves early is no error.
pub(crate) fn printed(written: io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::work(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// A writer that fails once Ctrl-C was pressed, so that an unfinished file goes away.
struct Guarded<W>(W);

impl<W: Write> Write for Guarded<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if interrupt::STOP.load(Ordering::Relaxed) {
            // Not `ErrorKind::Interrupted`, which callers answer by trying again.
            return Err(io::Error::other("interrupted"));
        }
        self.0.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

impl TableFormat {
    /// The text of a table.
    pub(crate) fn text(self, columns: &[impl AsRef<str>], rows: &[Vec<Cell>]) -> String {
        let mut text = Vec::new();
        // Writing to memory cannot fail
        let _ = self.write(&mut text, columns, rows.iter());
        String::from_utf8_lossy(&text).into_owned()
    }

    fn write(
        self,
        out: &mut impl Write,
        columns: &[impl AsRef<str>],
        rows: impl Iterator<Item = impl AsRef<[Cell]>>,
    ) -> io::Result<()> {
        let names: Vec<&str> = columns.iter().map(AsRef::as_ref).collect();
        match self {
            Self::Csv => {
                writeln!(out, "{}", names.join(","))?;
                for row in rows {
                    let fields: Vec<String> = row.as_ref().iter().map(Cell::csv).collect();
                    writeln!(out, "{}", fields.join(","))?;
                }
            }
            Self::Json => {
                let mut separator = "[";
                for row in rows {
                    let member = |(name, cell): (&&str, &Cell)| format!("\"{name}\":{}", cell.json());
                    let members: Vec<String> = names.iter().zip(row.as_ref()).map(member).collect();
                    write!(out, "{separator}\n{{{}}}", members.join(","))?;
                    separator = ",";
                }
                writeln!(out, "{}", if separator == "[" { "[]" } else { "\n]" })?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_of_no_rows_is_an_empty_array() {
        assert_eq!(TableFormat::Json.text(&["r"], &[]), "[]\n");
    }
}
