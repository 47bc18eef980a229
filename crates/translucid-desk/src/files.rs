//! Files that questions name.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use translucid_words::{Error, Place};

/// Reads all of a file of at most so many bytes; what it says of its size counts for nothing, as pipes and devices say none.
///
/// # Errors
/// A sentence without the path.
pub fn read_at_most(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(most + 1).read_to_end(&mut bytes));
    match read {
        Ok(count) if count as u64 > most => Err(format!("has more than {most} bytes, which are not read")),
        Ok(_) => Ok(bytes),
        Err(error) => Err(format!("cannot be read: {error}{}", meant(path))),
    }
}

/// The question whether another file was meant.
#[cfg(not(target_family = "wasm"))]
fn meant(path: &Path) -> String {
    let near = translucid_load::nearest_file(path);
    near.map_or_else(String::new, |near| format!("; did you mean {}?", near.display()))
}

/// A browser has no folders to look into.
#[cfg(target_family = "wasm")]
fn meant(_: &Path) -> String {
    String::new()
}

/// The error of a CSV file that is none, at its line.
pub fn broken_csv(path: &Path, error: &csv::Error) -> Error {
    let line = error.position().map(|position| position.line() as usize);
    let place = line.map_or_else(|| Place::file(path), |line| Place::line(path, line));
    Error::at(place, error.to_string())
}
