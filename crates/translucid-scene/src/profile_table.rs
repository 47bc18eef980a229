//! Reflectance profiles that somebody measured or simulated.

use std::path::PathBuf;

use translucid_profile::{AlbedoTable, ProfileRow};

use crate::{Place, SceneError};

/// A reflectance profile as numbers from a file, for one or more surface albedos.
///
/// Radii are in units of a length that the material states, reflectances in its inverse square.
/// Only the shape counts: what leaves altogether is the material's surface albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileTable {
    /// The file that it comes from.
    pub path: PathBuf,
    /// One for each surface albedo, rising; where the file states none, a single one.
    pub rows: Vec<ProfileRow>,
}

impl ProfileTable {
    /// Checks every number, and that the profiles can be tabulated.
    ///
    /// # Errors
    /// As [`table`](Self::table).
    pub fn validate(&self) -> Result<(), SceneError> {
        self.table().map(drop).map_err(|error| SceneError {
            place: None,
            ..error.within(format_args!("profile table {}", self.path.display()))
        })
    }

    /// The table to evaluate and sample, whose rows are the file's profiles.
    ///
    /// # Errors
    /// As [`AlbedoTable::from_profile_rows`].
    pub fn table(&self) -> Result<AlbedoTable, SceneError> {
        AlbedoTable::from_profile_rows(&self.rows)
            .map_err(|error| SceneError::at(Place::file(&self.path), error.message))
    }
}
