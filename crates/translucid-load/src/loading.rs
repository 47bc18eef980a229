//! A load on its way: who hears of it, what is found, and the files that it reads.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use translucid_scene::Warning;

use crate::file::read_file;
use crate::result::Result;
use crate::watch::LoadWatch;

/// The context of one load, which every reader of files below it gets.
pub(crate) struct Loading<'a> {
    /// Hears how far it is, and may end it.
    pub(crate) watch: &'a LoadWatch,
    /// Warnings of what was repaired or left out.
    pub(crate) warnings: &'a mut Vec<Warning>,
    files: BTreeSet<PathBuf>,
}

impl<'a> Loading<'a> {
    /// A load that has read nothing yet.
    pub(crate) fn new(watch: &'a LoadWatch, warnings: &'a mut Vec<Warning>) -> Self {
        Self { watch, warnings, files: BTreeSet::new() }
    }

    /// A load whose progress nobody hears.
    pub(crate) fn unwatched(warnings: &'a mut Vec<Warning>) -> Self {
        Self::new(&LoadWatch::NOBODY, warnings)
    }

    /// Reads a file whole, as one of those that the load needs.
    ///
    /// # Errors
    /// As [`read_file`].
    pub(crate) fn read(&mut self, path: &Path) -> Result<Vec<u8>> {
        let content = read_file(path)?;
        self.files.insert(path.to_owned());
        Ok(content)
    }

    /// Counts files that were read elsewhere among those that the load needs.
    pub(crate) fn add_files(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        self.files.extend(files);
    }

    /// The files that were read.
    pub(crate) fn into_files(self) -> BTreeSet<PathBuf> {
        self.files
    }
}
