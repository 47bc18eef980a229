//! Where the results of a fit go: stdout and stderr, or the files of a directory.

use std::path::{Path, PathBuf};

use clap::Args;
use translucid_image::check_writable;
use translucid_laboratory::{Chart, DataTable};

use crate::failure::Failure;
use crate::files::{Directory, input_among, refusal, write_file};
use crate::messages;
use crate::table::{TableFormat, print};

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
    /// Makes the directory and finds out whether its files can be written, before the work.
    pub(super) fn check(&self, files: &[&str], input: Option<&Path>) -> Result<(), Failure> {
        let Some(path) = &self.output else { return Ok(()) };
        let directory = Directory::make(path)?;
        let paths: Vec<PathBuf> = files.iter().chain([&REPORT]).map(|file| directory.file(file)).collect();
        paths.iter().try_for_each(|path| check_writable(path))?;
        match input_among(paths.iter().map(PathBuf::as_path), input.into_iter()) {
            Some(path) => Err(refusal(path, "is a file that is read, and would be written over")),
            None => Ok(()),
        }
    }

    /// Writes the report, then the first of the tables, or with a directory all of them.
    pub(super) fn write(&self, report: &str, tables: &[DataTable]) -> Result<(), Failure> {
        let Some(directory) = &self.output else {
            messages::line(report.trim_end());
            return print(&self.format.text(&tables[0].columns, &tables[0].rows));
        };
        for table in tables {
            let text = TableFormat::Csv.text(&table.columns, &table.rows);
            write_file(&directory.join(format!("{}.csv", table.name)), text.as_bytes())?;
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
}
