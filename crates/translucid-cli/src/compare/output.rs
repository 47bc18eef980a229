//! The files of a comparison.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use translucid_files::check_writable;
use translucid_laboratory::Chart;
use translucid_laboratory::comparison::Stopped;
use translucid_laboratory::figures::Report;

use super::stopped;
use crate::failure::Failure;
use crate::files::{Directory, NamedFile, is_own_page, refusal};
use crate::interrupt;

/// The file that shows the others.
pub(super) const PAGE: &str = "index.html";
/// Names that another program may well have given its own files.
const COMMON_NAMES: [&str; 3] = [PAGE, "errors.csv", "timing.csv"];
/// Title of a comparison's page.
const TITLE: &str = "Reflectance profiles compared";

/// Finds out before the work whether files can be written, and refuses to write over those that are not of an earlier
/// comparison.
pub(super) fn check(directory: &Directory) -> Result<(), Failure> {
    let paths = COMMON_NAMES.map(|name| directory.file(name));
    paths.iter().try_for_each(|path| check_writable(path))?;
    match paths.iter().find(|path| path.exists()) {
        Some(path) if !is_own_page(&paths[0], TITLE) => {
            Err(refusal(path, "exists already, and was not made by translucid"))
        }
        _ => Ok(()),
    }
}

/// Draws everything: the page, two files a chart, one a table. The page comes first: it says whose the others are.
pub(super) fn draw(report: &Report, progress: &(dyn Fn(f64) + Sync)) -> Result<Vec<NamedFile>, Failure> {
    let charts: Vec<&Chart> = report.page.charts().collect();
    let done = AtomicUsize::new(0);
    let drawn = charts.par_iter().map(|chart| {
        if interrupt::STOP.load(Ordering::Relaxed) {
            return Err(stopped(Stopped));
        }
        let file = |end: &str, content: Vec<u8>| (format!("{}.{end}", chart.name), content);
        let files = [file("svg", chart.svg().into_bytes()), file("csv", chart.table().csv().into_bytes())];
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / charts.len() as f64);
        Ok(files)
    });
    let drawn: Vec<[NamedFile; 2]> = drawn.collect::<Result<_, Failure>>()?;
    let mut files = vec![(String::from(PAGE), report.page.html().into_bytes())];
    files.extend(drawn.into_iter().flatten());
    let tables = report.page.tables().chain(&report.tables);
    files.extend(tables.map(|table| (format!("{}.csv", table.name), table.csv().into_bytes())));
    Ok(files)
}
