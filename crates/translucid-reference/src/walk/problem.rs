//! Geometry, boundary, scattering and illumination of a walk.

use translucid_profile::{ParameterError, require};

use super::deflection_table::DeflectionLaw;
use crate::Incidence;
use crate::phase_function::PhaseFunction;

/// Parameters of a [`Problem`], to be filled in where they differ from the default: an index-matched half space
/// of isotropic scatterers under a pencil beam.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// Phase function of collisions.
    pub phase_function: PhaseFunction,
    /// Relative index of refraction n_inside/n_outside, the same on both faces; in [0.1, 10].
    pub eta: f64,
    /// Thickness in mean free paths, greater than 0; infinite for the half space.
    pub thickness: f64,
    /// Directions in which light enters.
    pub incidence: Incidence,
    /// Radius in mean free paths of the disc over which the points of entry are spread evenly, at least 0.
    pub spot_radius: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            phase_function: PhaseFunction::ISOTROPIC,
            eta: 1.0,
            thickness: f64::INFINITY,
            incidence: Incidence::NORMAL,
            spot_radius: 0.0,
        }
    }
}

/// Geometry, boundary, scattering and illumination of a walk, known to be valid. The albedo is no part of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    parameters: Parameters,
    law: DeflectionLaw,
}

impl Problem {
    /// Checks the parameters.
    ///
    /// # Errors
    /// A parameter is outside the range that [`Parameters`] states, or moments make the phase function negative at some angle.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        parameters.phase_function.check_for_walk()?;
        let Parameters { eta, thickness, incidence, spot_radius, .. } = parameters;
        require((0.1..=10.0).contains(&eta), "eta", eta, "in [0.1, 10]")?;
        require(thickness > 0.0, "thickness", thickness, "greater than 0")?;
        if let Incidence::Pencil { cos_theta } = incidence {
            require(cos_theta > 0.0 && cos_theta <= 1.0, "cos_theta", cos_theta, "in (0, 1]")?;
            // sin²θ < η², without cancellation near grazing
            let refracts = (eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta > 0.0;
            require(refracts, "cos_theta", cos_theta, "above that of total reflection, sqrt(1 - eta^2)")?;
        }
        let finite = spot_radius >= 0.0 && spot_radius.is_finite();
        require(finite, "spot_radius", spot_radius, "finite and at least 0")?;
        let law = DeflectionLaw::new(&parameters.phase_function);
        Ok(Self { parameters, law })
    }

    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.parameters
    }

    /// How deflections are drawn.
    pub(super) fn law(&self) -> &DeflectionLaw {
        &self.law
    }

    /// Number of faces through which light can leave.
    pub(super) fn faces(&self) -> usize {
        if self.parameters.thickness.is_finite() { 2 } else { 1 }
    }
}
