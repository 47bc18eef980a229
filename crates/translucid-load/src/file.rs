//! Files as bytes, and what their names say.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use translucid_profile::nearest;
#[cfg(not(target_family = "wasm"))]
use translucid_scene::Place;
use translucid_scene::SceneError;

#[cfg(not(target_family = "wasm"))]
use crate::result::Result;

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
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>> {
    let failure = |reason: String| SceneError::at(Place::file(path), format!("cannot be read: {reason}"));
    let metadata = std::fs::metadata(path).map_err(|error| with_nearest(failure(error.to_string()), path))?;
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

/// The file that the path of a missing one most likely stands for: one with nearly its name beside it, or with another ending,
/// or its namesake in a folder there.
///
/// None if it is not missing.
pub fn nearest_file(path: &Path) -> Option<PathBuf> {
    const MOST: usize = 10_000;
    if path.exists() {
        return None;
    }
    let name = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let listed = std::fs::read_dir(folder.unwrap_or(Path::new("."))).ok()?.flatten().take(MOST);
    let (mut files, mut folders) = (Vec::new(), Vec::new());
    for entry in listed {
        if let Ok(name) = entry.file_name().into_string() {
            if entry.path().is_dir() { folders.push(name) } else { files.push(name) }
        }
    }
    files.sort_unstable();
    folders.sort_unstable();
    // An ending that many files share brings no name nearer
    let beside = || {
        let near =
            nearest(&stem(path), files.iter().filter_map(|file| Path::new(file).file_stem()?.to_str()))?;
        let of_that_name = || files.iter().filter(|file| stem(Path::new(file)) == near);
        let same_ending = |file: &&String| extension(Path::new(file)) == extension(path);
        of_that_name().find(same_ending).or(of_that_name().next()).map(PathBuf::from)
    };
    let inside = || {
        folders
            .iter()
            .map(|inner| Path::new(inner).join(name))
            .find(|inner| folder.unwrap_or(Path::new("")).join(inner).is_file())
    };
    let found = beside().or_else(inside)?;
    Some(folder.map_or(found.clone(), |folder| folder.join(&found)))
}

/// The error of a file that is missing, with the nearest one before the advice that it has.
pub(crate) fn with_nearest(error: SceneError, path: &Path) -> SceneError {
    let Some(near) = nearest_file(path) else { return error };
    let advice = error.help.as_ref().map_or_else(String::new, |help| format!(" Or {help}"));
    let help = format!("did you mean {}?{advice}", near.display());
    error.with_help(help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_files_name_the_nearest() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("scenes")).unwrap();
        for name in ["bust.ply", "sky.hdr", "scenes/head.toml"] {
            std::fs::write(at(name), "").unwrap();
        }
        assert_eq!(nearest_file(&at("bst.ply")), Some(at("bust.ply")));
        assert_eq!(nearest_file(&at("bust.obj")), Some(at("bust.ply")));
        assert_eq!(nearest_file(&at("head.toml")), Some(at("scenes/head.toml")));
        assert_eq!(nearest_file(&at("teapot.glb")), None);
        assert_eq!(nearest_file(&at("scenes")), None, "it is there");
        assert_eq!(nearest_file(&at("no/such/folder/bust.ply")), None);
        let error = read_file(&at("sly.hdr")).unwrap_err();
        let question = format!("did you mean {}?", at("sky.hdr").display());
        assert_eq!(error.help.as_ref(), Some(&question));
        let advised = with_nearest(error.with_help("put it there"), &at("sly.hdr"));
        assert_eq!(advised.help, Some(format!("{question} Or put it there")));
    }
}
