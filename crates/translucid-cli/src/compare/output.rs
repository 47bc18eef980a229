//! The files of a comparison.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use translucid_image::{OutputError, check_writable, write_atomically};
use translucid_laboratory::Chart;
use translucid_laboratory::figures::Report;

use crate::failure::Failure;
use crate::interrupt;
use crate::outputs::is_own_page;

/// The file that shows the others.
pub(super) const PAGE: &str = "index.html";
/// Names that another program may well have given its own files.
const COMMON_NAMES: [&str; 3] = [PAGE, "errors.csv", "timing.csv"];
/// Title of a comparison's page.
const TITLE: &str = "Reflectance profiles compared";

/// A directory to write to.
pub(super) struct Output {
    directory: PathBuf,
    /// Whether it was made for this.
    is_new: bool,
}

/// A file's name and content.
pub(super) type NamedFile = (String, Vec<u8>);

impl Output {
    /// Makes the directory and finds out whether files can be written there, before the work.
    pub(super) fn prepare(directory: &Path) -> Result<Self, Failure> {
        let is_new = !directory.exists();
        fs::create_dir_all(directory).map_err(|error| {
            let message = format!("cannot make the directory: {error}");
            OutputError::new(directory, message).with_help("name another directory with -o DIR")
        })?;
        let output = Self { directory: directory.to_owned(), is_new };
        output.check().inspect_err(|_| output.abandon())?;
        Ok(output)
    }

    fn check(&self) -> Result<(), Failure> {
        COMMON_NAMES.iter().try_for_each(|name| check_writable(&self.directory.join(name)))?;
        self.spare_others()
    }

    /// Refuses to write over files that are not those of an earlier comparison.
    fn spare_others(&self) -> Result<(), Failure> {
        if is_own_page(&self.directory.join(PAGE), TITLE) {
            return Ok(());
        }
        match COMMON_NAMES.iter().map(|name| self.directory.join(name)).find(|path| path.exists()) {
            Some(path) => {
                let error = OutputError::new(&path, "is there already, and translucid has not made it");
                Err(error.with_help("name another directory with -o DIR").into())
            }
            None => Ok(()),
        }
    }

    /// Takes a directory away that was made for nothing.
    pub(super) fn abandon(&self) {
        if self.is_new {
            // Fails, as it should, where somebody has put something there meanwhile
            let _ = fs::remove_dir(&self.directory);
        }
    }

    /// Writes all files, the page first: it says whose the others are.
    pub(super) fn write(&self, files: &[NamedFile]) -> Result<(), Failure> {
        for (name, content) in files {
            let path = self.directory.join(name);
            write_atomically(&path, |out| out.write_all(content)).map_err(Failure::late)?;
        }
        Ok(())
    }
}

/// Draws everything: the page, three files a chart, one a table.
pub(super) fn draw(report: &Report, progress: &(dyn Fn(f64) + Sync)) -> Result<Vec<NamedFile>, Failure> {
    let charts: Vec<&Chart> = report.page.charts().collect();
    let done = AtomicUsize::new(0);
    let drawn = charts.par_iter().map(|chart| {
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(super::stopped(translucid_laboratory::comparison::Stopped));
        }
        let png = chart.png().map_err(|error| Failure::work(error.to_string()))?;
        let file = |end: &str, content: Vec<u8>| (format!("{}.{end}", chart.name), content);
        let files = [
            file("svg", chart.svg().into_bytes()),
            file("png", png),
            file("csv", chart.table().csv().into_bytes()),
        ];
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / charts.len() as f64);
        Ok(files)
    });
    let drawn: Vec<[NamedFile; 3]> = drawn.collect::<Result<_, Failure>>()?;
    let mut files = vec![(String::from(PAGE), report.page.html().into_bytes())];
    files.extend(drawn.into_iter().flatten());
    let tables = report.page.tables().chain(&report.tables);
    files.extend(tables.map(|table| (format!("{}.csv", table.name), table.csv().into_bytes())));
    Ok(files)
}
