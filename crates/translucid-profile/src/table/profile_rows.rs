//! Reflectance profiles that somebody measured or simulated, as the rows of a table.

use std::fmt::Display;

use super::albedo_table::AlbedoTable;
use super::tabulated_profile::TabulatedProfile;
use crate::error::{InputError, ParameterError};
use crate::short::Short;

/// The profile of one surface albedo, as numbers.
///
/// Radii are in units of a length that is the user's choice, reflectances in its inverse square.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ProfileRow {
    /// Surface albedo A in [0, 1], if it is known.
    pub surface_albedo: Option<f64>,
    /// Radii r, rising, greater than 0.
    pub radii: Vec<f64>,
    /// R(r), finite and at least 0, one for each radius.
    pub reflectances: Vec<f64>,
    /// Energy within r, finite and rising, one for each radius; empty where it is not known.
    pub enclosed: Vec<f64>,
}

/// A closed range of numbers.
#[derive(Clone, Copy)]
pub(super) struct Range {
    least: f64,
    most: f64,
    /// Its text in messages.
    pub(super) text: &'static str,
}

/// Range of a radius.
pub(super) const RADIUS: Range = Range { least: 1e-100, most: 1e100, text: "[1e-100, 1e100]" };
/// Range of a reflectance and of an enclosed energy.
pub(super) const ENERGY: Range = Range { least: 0.0, most: 1e200, text: "[0, 1e200]" };
/// Range of a surface albedo.
pub(super) const ALBEDO: Range = Range { least: 0.0, most: 1.0, text: "[0, 1]" };
/// Most profiles of a table: each takes some 60 KB.
pub(super) const MOST_PROFILES: usize = 1000;
/// Fewest radii of a profile.
pub(super) const FEWEST_RADII: usize = 4;

impl Range {
    /// Whether a number is in the range; NaN is in none.
    pub(super) fn contains(self, x: f64) -> bool {
        (self.least..=self.most).contains(&x)
    }

    fn check(self, field: &str, x: f64) -> Result<(), InputError> {
        if self.contains(x) {
            return Ok(());
        }
        Err(refusal(field, Short(x), format_args!("in {}", self.text)))
    }
}

/// The error of a field with a value that it must not have: "FIELD = VALUE: must be …".
fn refusal(field: impl Display, value: impl Display, must_be: impl Display) -> InputError {
    InputError::new(format!("{field} = {value}: must be {must_be}"))
}

impl AlbedoTable {
    /// The table whose rows are profiles that are known as numbers, in the order of their surface albedos.
    ///
    /// Only the shape of a profile counts: its energy is the surface albedo of the row.
    ///
    /// # Errors
    /// There are no rows or more than 1000, their albedos or radii do not rise, a number is out of its range, or a profile
    /// cannot be tabulated, say because it does not fall towards its end.
    ///
    /// ```
    /// use translucid_profile::{AlbedoTable, parse_profile_rows};
    ///
    /// let rows = parse_profile_rows(b"r,reflectance\n0.1,5\n1,1\n2,0.4\n4,0.05\n")?;
    /// let table = AlbedoTable::from_profile_rows(&rows)?;
    /// assert!(table.at(0.8, 1.0).cdf(4.0) > 0.8);
    /// # Ok::<(), translucid_profile::InputError>(())
    /// ```
    pub fn from_profile_rows(rows: &[ProfileRow]) -> Result<Self, InputError> {
        check(rows)?;
        let albedos: Vec<f64> = rows.iter().map(|row| row.surface_albedo.unwrap_or(1.0)).collect();
        let none = ProfileRow::default();
        let mut next = rows.iter();
        let mut current = None;
        Self::new(&albedos, |surface_albedo| {
            let row = next.next().unwrap_or(&none);
            current = row.surface_albedo;
            Ok(Box::new(row.profile()?.scaled(1.0, surface_albedo)?))
        })
        .map_err(|error| {
            let of = current.map_or(String::new(), |a| format!("the profile of surface_albedo {a}: "));
            InputError::new(format!("{of}{error}"))
        })
    }
}

/// Checks every number of the rows of a table.
fn check(rows: &[ProfileRow]) -> Result<(), InputError> {
    if !(1..=MOST_PROFILES).contains(&rows.len()) {
        return Err(refusal("rows.len()", rows.len(), format_args!("in [1, {MOST_PROFILES}]")));
    }
    for (i, row) in rows.iter().enumerate() {
        row.check()
            .map_err(|error| InputError { message: format!("rows[{i}], {}", error.message), ..error })?;
    }
    let albedos = rows.iter().map(|row| row.surface_albedo);
    if rows.len() > 1 && !albedos.is_sorted_by(|a, b| a.is_some() && a < b) {
        return Err(InputError::new("the surface_albedo of its rows must be there and rise"));
    }
    Ok(())
}

impl ProfileRow {
    fn check(&self) -> Result<(), InputError> {
        if let Some(albedo) = self.surface_albedo {
            ALBEDO.check("surface_albedo", albedo)?;
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
                range.check(&format!("{name}[{i}]"), value)?;
            }
        }
        check_rising("radii", &self.radii, |a, b| a < b)?;
        check_rising("enclosed", &self.enclosed, |a, b| a <= b)?;
        if self.reflectances.iter().all(|&reflectance| reflectance == 0.0) {
            return Err(InputError::new("reflectances are 0 everywhere"));
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

fn check_rising(name: &str, values: &[f64], rises: fn(f64, f64) -> bool) -> Result<(), InputError> {
    match values.windows(2).position(|pair| !rises(pair[0], pair[1])) {
        Some(i) => Err(refusal(
            format_args!("{name}[{}]", i + 1),
            Short(values[i + 1]),
            format_args!("above {}, the one before", Short(values[i])),
        )),
        None => Ok(()),
    }
}
