//! Files as bytes, and what their names say.

use std::ffi::OsStr;
use std::path::Path;

#[cfg(not(target_family = "wasm"))]
use translucid_scene::{Place, SceneError};

/// A file's extension in lower case; empty if it has none.
pub(crate) fn extension(path: &Path) -> String {
    path.extension().and_then(OsStr::to_str).unwrap_or_default().to_lowercase()
}

/// A file's name without its extension.
pub(crate) fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

#[cfg(target_family = "wasm")]
pub(crate) use crate::given_files::{is_file, read_file};

/// Whether there is a file at a path.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn is_file(path: &Path) -> bool {
    path.is_file()
}

/// Reads a file whole.
///
/// # Errors
/// The file is missing, cannot be read, or is not a file: a pipe would keep the reader waiting.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    let failure = |reason: String| SceneError::at(Place::file(path), format!("cannot be read: {reason}"));
    let metadata = std::fs::metadata(path).map_err(|error| failure(error.to_string()))?;
    if !metadata.is_file() {
        return Err(failure(String::from("not a file")));
    }
    // What is read and what becomes of it are there at the same time: of text of quadrilaterals twelve times its size. Asked
    // for and given back, as a loader that finds no memory on its way could only end the process
    let needed = usize::try_from(metadata.len()).unwrap_or(usize::MAX).saturating_mul(13);
    if Vec::<u8>::new().try_reserve_exact(needed).is_err() {
        let mebibytes = needed as f64 / f64::from(1 << 20);
        let reason = format!("that takes about {mebibytes:.0} MiB of memory, which this process cannot have");
        return Err(failure(reason));
    }
    std::fs::read(path).map_err(|error| failure(error.to_string()))
}
