//! Files of reflectance profiles.

use std::path::Path;

use translucid_profile::parse_profile_rows;
use translucid_scene::{ProfileTable, SceneError};

use crate::file::read_file;
use crate::loading::Loading;
use crate::result::Result;

/// Loads a table of reflectance profiles.
///
/// # Errors
/// The file cannot be read, lacks a column, or a number is not what it must be; the error names the line.
pub fn load_profile_table(path: &Path) -> Result<ProfileTable> {
    parse_profile_table(&read_file(path)?, path)
}

/// As [`load_profile_table`], as a part of a load.
pub(crate) fn read_profile_table(path: &Path, loading: &mut Loading<'_>) -> Result<ProfileTable> {
    parse_profile_table(&loading.read(path)?, path)
}

/// Reads a table of reflectance profiles from a file's bytes; the path is for messages.
///
/// # Errors
/// As [`load_profile_table`].
pub fn parse_profile_table(bytes: &[u8], path: &Path) -> Result<ProfileTable> {
    let rows = parse_profile_rows(bytes).map_err(|error| SceneError::of_text(path, error))?;
    let table = ProfileTable { path: path.to_owned(), rows };
    table.table()?;
    Ok(table)
}
