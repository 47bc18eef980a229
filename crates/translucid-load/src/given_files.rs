//! Files that a page was given, where there is no file system.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::result::Result;

use translucid_scene::{Place, SceneError};

/// Contents by the files' names.
static FILES: Mutex<BTreeMap<OsString, Vec<u8>>> = Mutex::new(BTreeMap::new());

/// Gives readers a file, in place of one of the same name.
///
/// A browser hides folders, so a path means the file of its last part, wherever it was.
pub fn give_file(name: &str, content: Vec<u8>) {
    let name = Path::new(name).file_name().unwrap_or(OsStr::new(name));
    FILES.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), content);
}

/// Whether a file was given.
pub(crate) fn is_file(path: &Path) -> bool {
    with(path, |content| content.is_some())
}

/// The content of a file.
///
/// # Errors
/// It was not given.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>> {
    let missing = || SceneError::at(Place::file(path), "cannot be read: it was not opened with the others");
    with(path, |content| content.cloned()).ok_or_else(missing)
}

fn with<T>(path: &Path, read: impl FnOnce(Option<&Vec<u8>>) -> T) -> T {
    let files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
    read(path.file_name().and_then(|name| files.get(name)))
}
