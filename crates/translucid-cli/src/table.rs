//! Tables of numbers: CSV or JSON, to stdout or a file.

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use clap::{Args, ValueEnum};
use translucid_image::write_atomically;

use crate::failure::Failure;
use crate::interrupt;

/// Where a table goes, and how.
#[derive(Args, Debug)]
pub(crate) struct TableArguments {
    /// File to write instead of stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// How to write numbers
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
}

/// Text formats of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Comma-separated values after a header line
    Csv,
    /// An array with one object a row
    Json,
}

impl TableArguments {
    /// The file to write, if it is not stdout.
    pub(crate) fn output(&self) -> Option<&Path> {
        self.output.as_deref()
    }

    /// Finds out whether the file can be written, before long work.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        self.output.as_deref().map_or(Ok(()), |path| Ok(translucid_image::check_writable(path)?))
    }

    /// Refuses to write over a file that is read, whatever paths both go by.
    pub(crate) fn spare(&self, input: Option<&Path>) -> Result<(), Failure> {
        let (Some(output), Some(input)) = (self.output(), input) else { return Ok(()) };
        match (fs::canonicalize(output), fs::canonicalize(input)) {
            (Ok(written), Ok(read)) if written == read => {
                let message = format!(
                    "--output is {}, a file that is read, and would be written over",
                    output.display()
                );
                Err(Failure::input(message).with_help("choose another file for the printed table"))
            }
            _ => Ok(()),
        }
    }

    /// Writes a table row by row; a reader that closes stdout early ends it without an error.
    pub(crate) fn write<const N: usize>(
        &self,
        columns: [&str; N],
        rows: impl Iterator<Item = [f64; N]>,
    ) -> Result<(), Failure> {
        match &self.output {
            Some(path) => self.write_file(path, columns, rows),
            None => {
                let mut out = BufWriter::with_capacity(1 << 16, io::stdout().lock());
                let written = write_rows(&mut out, self.format, columns, rows).and_then(|()| out.flush());
                // Dropping the writer would try to write the rest once more.
                drop(out.into_parts());
                match written {
                    Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                        Err(Failure::work(format!("cannot write to stdout: {error}")))
                    }
                    _ => Ok(()),
                }
            }
        }
    }

    fn write_file<const N: usize>(
        &self,
        path: &Path,
        columns: [&str; N],
        rows: impl Iterator<Item = [f64; N]>,
    ) -> Result<(), Failure> {
        translucid_image::check_writable(path)?;
        interrupt::catch("\nstopping")?;
        let written = write_atomically(path, |out| write_rows(&mut Guarded(out), self.format, columns, rows));
        match written {
            Err(_) if interrupt::STOP.load(Ordering::Relaxed) => {
                Err(Failure::Interrupted { help: format!("{} was not written", path.display()) })
            }
            other => other.map_err(Failure::late),
        }
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

fn write_rows<const N: usize>(
    out: &mut impl Write,
    format: Format,
    columns: [&str; N],
    rows: impl Iterator<Item = [f64; N]>,
) -> io::Result<()> {
    match format {
        Format::Csv => {
            writeln!(out, "{}", columns.join(","))?;
            for row in rows {
                writeln!(out, "{}", row.map(exact).join(","))?;
            }
        }
        Format::Json => {
            let mut separator = "[";
            for row in rows {
                let mut number = 0;
                let fields = row.map(|value| {
                    number += 1;
                    format!("\"{}\":{}", columns[number - 1], exact(value))
                });
                write!(out, "{separator}\n{{{}}}", fields.join(","))?;
                separator = ",";
            }
            writeln!(out, "{}", if separator == "[" { "[]" } else { "\n]" })?;
        }
    }
    Ok(())
}

/// The shortest text that reads back as the same number; valid in CSV and JSON.
pub(crate) fn exact(value: f64) -> String {
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
    fn exact_reads_back_as_the_same_number() {
        let mut bits = 1_u64;
        for _ in 0..100_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let value = f64::from_bits(bits ^ (bits >> 29));
            if value.is_finite() {
                assert_eq!(exact(value).parse::<f64>().unwrap().to_bits(), value.to_bits());
                // JSON's syntax holds, too; this parser may miss by the last digit.
                let parsed: f64 = serde_json::from_str(&exact(value)).unwrap();
                assert!((parsed / value - 1.0).abs() < 1e-15 || value.abs() < 1e-300);
            }
        }
        for value in [0.0, 0.1, 1.0, 1e-300, f64::MAX, f64::MIN_POSITIVE / 4.0] {
            assert_eq!(exact(value).parse::<f64>().unwrap(), value);
        }
    }

    #[test]
    fn json_of_no_rows_is_an_empty_array() {
        let mut out = Vec::new();
        write_rows(&mut out, Format::Json, ["r"], std::iter::empty()).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), "[]\n");
    }
}
