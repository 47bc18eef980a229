//! Warnings on their way out: equal ones are counted, not repeated.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use translucid_scene::{Place, SceneError, Warning};

/// The file that is being read and what was found in it so far.
pub(super) struct Notes<'a> {
    pub(super) path: &'a Path,
    entries: RefCell<Vec<CountedWarning>>,
    files: RefCell<Vec<PathBuf>>,
}

/// A warning, the first part of the file that it is of, and how many there are.
struct CountedWarning {
    message: String,
    first: String,
    count: usize,
}

/// So many different warnings are kept; a damaged file could make one for every number in it.
const MOST: usize = 256;

impl<'a> Notes<'a> {
    pub(super) fn new(path: &'a Path) -> Self {
        Self { path, entries: RefCell::default(), files: RefCell::default() }
    }

    /// Writes down that something was repaired or left out at a part of the file.
    pub(super) fn warn(&self, part: &str, message: impl Into<String>) {
        let message = message.into();
        let mut entries = self.entries.borrow_mut();
        if let Some(entry) = entries.iter_mut().find(|entry| entry.message == message) {
            entry.count += 1;
        } else if entries.len() < MOST {
            entries.push(CountedWarning { message, first: part.to_owned(), count: 1 });
        }
    }

    /// Writes down that a file beside this one was read.
    pub(super) fn add_file(&self, path: &Path) {
        self.files.borrow_mut().push(path.to_owned());
    }

    /// Takes the files beside this one that were read.
    pub(super) fn take_files(&self) -> Vec<PathBuf> {
        self.files.take()
    }

    /// An error at a part of the file.
    pub(super) fn error(&self, part: &str, message: impl Into<String>) -> SceneError {
        SceneError::at(Place::part(self.path, part), message)
    }

    /// All warnings, each with the number of its places.
    pub(super) fn into_warnings(self) -> impl Iterator<Item = Warning> {
        let path = self.path;
        self.entries.into_inner().into_iter().map(move |CountedWarning { message, first, count }| Warning {
            message: if count == 1 { message } else { format!("{message} ({count} times, here first)") },
            place: Some(Place::part(path, first)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_counted_by_message_and_keep_the_first_place() {
        let notes = Notes::new(Path::new("x.glb"));
        notes.warn("mesh 0", "lines are left out");
        notes.warn("mesh 1", "lines are left out");
        notes.warn("mesh 2", "points are left out");
        let found: Vec<String> = notes.into_warnings().map(|warning| warning.to_string()).collect();
        assert_eq!(
            found,
            ["x.glb, mesh 0: lines are left out (2 times, here first)", "x.glb, mesh 2: points are left out"]
        );
    }
}
