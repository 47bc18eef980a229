//! Reflectance profiles that somebody measured or simulated.

use std::path::PathBuf;

use translucid_profile::{AlbedoTable, ParameterError, TabulatedProfile};

use crate::interval::{Interval, Written, refusal};
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

/// Range of a radius.
pub(crate) const RADIUS: Interval = Interval::closed(1e-100, 1e100);
/// Range of a reflectance and of an enclosed energy.
pub(crate) const ENERGY: Interval = Interval::closed(0.0, 1e200);
/// Most profiles of a table: each takes some 60 KB.
pub(crate) const MOST_PROFILES: usize = 1000;
/// Fewest radii of a profile.
pub(crate) const FEWEST_RADII: usize = 4;

impl ProfileTable {
    /// Checks every number, and that the profiles can be tabulated.
    ///
    /// # Errors
    /// There are no rows or too many, their albedos or radii do not rise, a number is out of its range, or
    /// [`table`](Self::table) fails.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.table().map(drop).map_err(|error| SceneError {
            place: None,
            ..error.within(format_args!("profile table {}", self.path.display()))
        })
    }

    /// Checks every number.
    pub(crate) fn check(&self) -> Result<(), SceneError> {
        if !(1..=MOST_PROFILES).contains(&self.rows.len()) {
            let must_be = format!("in [1, {MOST_PROFILES}]");
            return Err(refusal("rows.len()", self.rows.len(), must_be));
        }
        for (i, row) in self.rows.iter().enumerate() {
            row.check().map_err(|error| error.within(format_args!("rows[{i}]")))?;
        }
        let albedos = self.rows.iter().map(|row| row.surface_albedo);
        if self.rows.len() > 1 && !albedos.is_sorted_by(|a, b| a.is_some() && a < b) {
            return Err(SceneError::new("the surface_albedo of its rows must be there and rise"));
        }
        Ok(())
    }

    /// The table to evaluate and sample, whose rows are the file's profiles.
    ///
    /// # Errors
    /// A profile cannot be tabulated, say because it does not fall towards its end, or a number is out of its range.
    pub fn table(&self) -> Result<AlbedoTable, SceneError> {
        self.check().map_err(|error| error.or_at(&self.path))?;
        let albedos: Vec<f64> = self.rows.iter().map(|row| row.surface_albedo.unwrap_or(1.0)).collect();
        let none = ProfileRow::default();
        let mut rows = self.rows.iter();
        let mut current = None;
        AlbedoTable::new(&albedos, |surface_albedo| {
            let row = rows.next().unwrap_or(&none);
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
    fn check(&self) -> Result<(), SceneError> {
        if let Some(albedo) = self.surface_albedo {
            Interval::UNIT.check_double("surface_albedo", albedo)?;
        }
        let count = self.radii.len();
        if count < FEWEST_RADII {
            return Err(refusal("radii.len()", count, format_args!("at least {FEWEST_RADII}")));
        }
        if self.reflectances.len() != count {
            let must_be = format!("{count}, the number of radii");
            return Err(refusal("reflectances.len()", self.reflectances.len(), must_be));
        }
        if !self.enclosed.is_empty() && self.enclosed.len() != count {
            let must_be = format!("0 or {count}, the number of radii");
            return Err(refusal("enclosed.len()", self.enclosed.len(), must_be));
        }
        for (name, range, values) in [
            ("radii", RADIUS, &self.radii),
            ("reflectances", ENERGY, &self.reflectances),
            ("enclosed", ENERGY, &self.enclosed),
        ] {
            for (i, &value) in values.iter().enumerate() {
                range.check_double(&format!("{name}[{i}]"), value)?;
            }
        }
        check_rising("radii", &self.radii, |a, b| a < b)?;
        check_rising("enclosed", &self.enclosed, |a, b| a <= b)?;
        if self.reflectances.iter().all(|&reflectance| reflectance == 0.0) {
            return Err(SceneError::new("reflectances are 0 everywhere"));
        }
        Ok(())
    }

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

fn check_rising(name: &str, values: &[f64], rises: fn(f64, f64) -> bool) -> Result<(), SceneError> {
    match values.windows(2).position(|pair| !rises(pair[0], pair[1])) {
        Some(i) => Err(refusal(
            format_args!("{name}[{}]", i + 1),
            Written(values[i + 1]),
            format_args!("above {}, the one before", Written(values[i])),
        )),
        None => Ok(()),
    }
}
