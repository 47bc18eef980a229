//! Reflectance profiles that somebody measured or simulated.

use std::path::PathBuf;

use translucid_profile::{AlbedoTable, ParameterError, TabulatedProfile};

use crate::{Place, SceneError};

/// A reflectance profile as numbers from a file, for one or more surface albedos.
///
/// Radii are in units of a length that the material states, reflectances in its inverse square.
/// Only the shape counts: what leaves altogether is the material's surface albedo.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileTable {
    /// Where it comes from.
    pub path: PathBuf,
    /// One for each surface albedo, rising; where the file states none, a single one.
    pub rows: Vec<ProfileRow>,
}

impl ProfileTable {
    /// The table to evaluate and sample, whose rows are the file's profiles.
    ///
    /// # Errors
    /// A profile cannot be tabulated, say because it does not fall towards its end.
    pub fn table(&self) -> Result<AlbedoTable, SceneError> {
        let albedos: Vec<f64> = self.rows.iter().map(|row| row.surface_albedo.unwrap_or(1.0)).collect();
        let mut rows = self.rows.iter();
        let mut current = None;
        AlbedoTable::new(&albedos, |surface_albedo| {
            let row = rows.next().expect("one call for each albedo");
            current = row.surface_albedo;
            Ok(Box::new(row.profile()?.scaled(1.0, surface_albedo)?))
        })
        .map_err(|error| {
            let of = current.map_or(String::new(), |a| format!("the profile of surface_albedo {a}: "));
            SceneError::at(Place::file(&self.path), format!("{of}{error}"))
        })
    }
}

/// The profile of one surface albedo.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileRow {
    /// Surface albedo A in [0, 1], if the file says it.
    pub surface_albedo: Option<f64>,
    /// Radii r, rising, greater than 0.
    pub radii: Vec<f64>,
    /// R(r), finite and at least 0, one for each radius.
    pub reflectances: Vec<f64>,
    /// Energy within r, finite and rising, one for each radius; empty where the file does not say it.
    pub enclosed: Vec<f64>,
}

impl ProfileRow {
    /// The numbers as a table in the radius: it keeps the energies, if they are known.
    fn profile(&self) -> Result<TabulatedProfile, ParameterError> {
        if self.enclosed.is_empty() {
            return TabulatedProfile::from_samples(&self.radii, &self.reflectances);
        }
        // Where a tally has run out of photons there is nothing to keep
        let dark = self.reflectances.iter().rev().take_while(|&&reflectance| reflectance == 0.0).count();
        let count = self.radii.len() - dark;
        TabulatedProfile::from_samples_and_enclosed(
            &self.radii[..count],
            &self.reflectances[..count],
            &self.enclosed[..count],
        )
    }
}
