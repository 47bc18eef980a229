//! Files as bytes, and what their names say.

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use translucid_scene::{Place, SceneError};

/// A file's extension in lower case; empty if it has none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().and_then(OsStr::to_str).unwrap_or_default().to_lowercase()
}

/// A file's name without its extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Reads a file whole.
///
/// # Errors
/// The file is missing, cannot be read, or is not a file: a pipe would keep the reader waiting.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    let failure = |reason: String| SceneError::at(Place::file(path), format!("cannot be read: {reason}"));
    let metadata = std::fs::metadata(path).map_err(|error| failure(error.to_string()))?;
    if !metadata.is_file() {
        return Err(failure(String::from("not a file")));
    }
    // What is read and what becomes of it are there at the same time: of text of quadrilaterals seven times its size. Asked
    // for and given back, as a loader that finds no memory on its way could only end the process
    let needed = usize::try_from(metadata.len()).unwrap_or(usize::MAX).saturating_mul(8);
    if Vec::<u8>::new().try_reserve_exact(needed).is_err() {
        let mebibytes = needed as f64 / f64::from(1 << 20);
        let reason = format!("that takes about {mebibytes:.0} MiB of memory, which this process cannot have");
        return Err(failure(reason));
    }
    let content = std::fs::read(path).map_err(|error| failure(error.to_string()))?;
    FILES_READ.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
    Ok(content)
}

/// Files that loaders have read: they lie deep in each other, and some are known by names in files only.
static FILES_READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// The files that all loaders of the process have read since this was called before: what another machine needs to load the
/// same scene.
pub fn take_files_read() -> Vec<PathBuf> {
    std::mem::take(&mut *FILES_READ.lock().unwrap_or_else(PoisonError::into_inner)).into_iter().collect()
}
