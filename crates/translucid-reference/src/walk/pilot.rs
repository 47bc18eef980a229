//! Which albedo to walk at, where a surface albedo is asked for.

use std::sync::atomic::Ordering;

use translucid_profile::{Configuration, ParameterError, half_space_single_scattering_albedo};

use super::layout::Layout;
use super::photon_exit::Side;
use super::problem::Problem;
use super::run::Control;
use super::table_error::TableError;
use super::white_table::WhiteTable;
use crate::exact::single_scattering_albedo;

/// Photons of a walk that only finds out which albedo is needed.
const PHOTONS: u64 = 1 << 17;

/// Reason why no reference albedo was found.
#[derive(Debug)]
pub enum PilotError {
    /// The walk was stopped.
    Stopped,
    /// It takes an albedo above [`WhiteTable::HIGHEST_REFERENCE_ALBEDO`].
    OutOfReach,
    /// No albedo makes the slab reflect so much, or so little.
    OutsideSlab {
        /// The least that it reflects.
        least: f64,
        /// The most.
        most: f64,
    },
    /// A parameter is out of range.
    Table(TableError),
}

impl From<TableError> for PilotError {
    fn from(error: TableError) -> Self {
        Self::Table(error)
    }
}

impl From<ParameterError> for PilotError {
    fn from(error: ParameterError) -> Self {
        Self::Table(error.into())
    }
}

impl Problem {
    /// Returns whether the exact solution knows it, too: isotropic scattering in a half space with η in [0.5, 3].
    pub fn is_solved(&self) -> bool {
        let parameters = self.parameters();
        parameters.phase_function.is_isotropic()
            && parameters.thickness.is_infinite()
            && (0.5..=3.0).contains(&parameters.eta)
    }

    /// Single-scattering albedo of a surface albedo, where the exact solution [knows](Self::is_solved) it.
    ///
    /// # Errors
    /// The surface albedo is not in (0, 1].
    pub fn solved_single_scattering_albedo(
        &self,
        surface_albedo: f64,
    ) -> Result<Option<f64>, ParameterError> {
        let parameters = self.parameters();
        let invert = || single_scattering_albedo(surface_albedo, parameters.eta, parameters.incidence);
        self.is_solved().then(invert).transpose()
    }

    /// Finds an albedo a little above the one that makes a surface albedo, by short walks.
    ///
    /// # Errors
    /// See [`PilotError`].
    pub fn pilot(&self, surface_albedo: f64, seed: u64, control: &Control) -> Result<f64, PilotError> {
        // By similarity a medium scatters like an isotropic one of the reduced albedo
        let reduced = half_space_single_scattering_albedo(surface_albedo, Configuration::Searchlight);
        let g = self.parameters().phase_function.mean_cosine();
        let guess = reduced / (1.0 - g + g * reduced);
        let mut absorbed = 0.3 * (1.0 - guess);
        loop {
            let highest = WhiteTable::HIGHEST_REFERENCE_ALBEDO;
            let reference = (1.0 - absorbed).min(highest);
            let mut table = WhiteTable::new(self.clone(), Layout::new(&[1.0], 1)?, reference)?;
            table.run(seed, PHOTONS, control)?;
            if control.stop.load(Ordering::Relaxed) {
                return Err(PilotError::Stopped);
            }
            match table.single_scattering_albedo(surface_albedo) {
                Ok(found) => {
                    let above = found.value + 0.3 * (1.0 - found.value) + 4.0 * found.error;
                    return Ok(above.min(reference));
                }
                Err(_) if reference < highest => absorbed *= 0.1,
                Err(_) if self.parameters().thickness.is_infinite() => return Err(PilotError::OutOfReach),
                Err(_) => {
                    let reflected = |albedo: f64| -> Result<f64, PilotError> {
                        Ok(table.at_albedo(albedo)?.total(Side::Reflected).value)
                    };
                    return Err(PilotError::OutsideSlab {
                        least: reflected(0.0)?,
                        most: reflected(reference)?,
                    });
                }
            }
        }
    }
}
