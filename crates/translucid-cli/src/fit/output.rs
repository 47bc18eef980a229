//! Where the results of a fit go: stdout and stderr, or the files of a directory.

use std::path::{Path, PathBuf};

use clap::Args;
use translucid_files::check_writable;
use translucid_laboratory::{Chart, DataTable};

use crate::failure::Failure;
use crate::files::{Directory, input_among, is_own, refusal, write_file};
use crate::table::{TableFormat, print};
use crate::{command_line, messages};

#[derive(Args, Debug)]
pub(super) struct OutputArguments {
    /// Directory to write files to, in place of stdout and stderr; made if it is not there
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How to write the table on stdout
    #[arg(long, value_enum, default_value = "csv", conflicts_with = "output")]
    format: TableFormat,
}

/// File of the report.
const REPORT: &str = "report.txt";

impl OutputArguments {
    /// Does some work that fills the directory: makes it and finds out first whether its files can be written, and refuses to
    /// write over those that are not of an earlier fit. Others keep off it meanwhile.
    pub(super) fn fill(
        &self,
        files: &[&str],
        input: Option<&Path>,
        work: impl FnOnce() -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let Some(path) = &self.output else { return work() };
        Directory::fill(path, |directory| {
            check(directory, files, input)?;
            work()
        })
    }

    /// Writes the report, then the first of the tables, or with a directory all of them.
    pub(super) fn write(&self, report: &str, tables: &[DataTable]) -> Result<(), Failure> {
        let Some(directory) = &self.output else {
            messages::line(report.trim_end());
            return print(&self.format.text(&tables[0].columns, &tables[0].rows));
        };
        // The report comes first: it says whose the others are
        let report =
            format!("translucid {}: {}\n\n{report}", env!("CARGO_PKG_VERSION"), command_line::shown());
        write_file(&directory.join(REPORT), report.as_bytes())?;
        for table in tables {
            let text = TableFormat::Csv.text(&table.columns, &table.rows);
            write_file(&directory.join(format!("{}.csv", table.name)), text.as_bytes())?;
        }
        Ok(())
    }

    /// Writes a chart to the directory, if there is one, as SVG.
    pub(super) fn write_chart(&self, chart: &Chart, file: &str) -> Result<(), Failure> {
        let Some(directory) = &self.output else { return Ok(()) };
        write_file(&directory.join(file), chart.svg().as_bytes())
    }
}

/// Finds out whether files of a directory can be written, and refuses to write over those that are not of an earlier fit.
fn check(directory: &Directory, files: &[&str], input: Option<&Path>) -> Result<(), Failure> {
    let paths: Vec<PathBuf> = files.iter().chain([&REPORT]).map(|file| directory.file(file)).collect();
    paths.iter().try_for_each(|path| check_writable(path))?;
    if let Some(path) = input_among(paths.iter().map(PathBuf::as_path), input.into_iter()) {
        return Err(refusal(path, "is a file that is read, and would be overwritten"));
    }
    match paths.iter().find(|path| path.exists()) {
        Some(path) if !is_own(&directory.file(REPORT)) => {
            Err(refusal(path, "exists already, and was not made by translucid"))
        }
        _ => Ok(()),
    }
}
