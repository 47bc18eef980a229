//! Light on its way through a dielectric boundary into the half space.

use num_complex::Complex64;
use translucid_profile::{ParameterError, fresnel_moment_1_from_inside, require};

use super::dielectric_directions::azimuthal_mean;
use super::dielectric_response::Response;
use super::oblique_single_scattering::{Beam, cosine_single_scattering, uniform_cosine_single_scattering};
use super::single_scattering::SingleScattering;
use crate::Incidence;

/// Directions of light that has entered through the boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) enum BoundaryEntrance {
    /// A pencil beam; without a boundary too.
    Pencil(Beam),
    /// Equal radiance from outside; under a boundary only.
    Cosine {
        /// ∫ T(μ) μ dμ over inside directions.
        passed: f64,
    },
    /// Cosines distributed uniformly inside; under a boundary only.
    UniformCosine,
}

impl BoundaryEntrance {
    /// Checks the parameters: α ∈ (0, 1], η ∈ [0.5, 3], and a beam that enters.
    pub(crate) fn checked(alpha: f64, eta: f64, incidence: Incidence) -> Result<Self, ParameterError> {
        Ok(match incidence {
            Incidence::Pencil { cos_theta } => Self::Pencil(checked_beam(alpha, eta, cos_theta)?),
            Incidence::Cosine => {
                check_medium(alpha, eta)?;
                Self::Cosine { passed: 0.5 - fresnel_moment_1_from_inside(eta) }
            }
            Incidence::UniformCosine => {
                check_medium(alpha, eta)?;
                Self::UniformCosine
            }
        })
    }

    /// R̂ averaged over azimuths, less single scattering.
    pub(crate) fn remainder(&self, response: &Response, k: Complex64) -> Complex64 {
        match self {
            Self::Pencil(beam) => {
                mean_over_azimuths(beam, k, |s0| response.pencil_remainder(beam.cos_inside, s0))
            }
            Self::Cosine { passed } => response.cosine_remainder(*passed),
            Self::UniformCosine => response.uniform_cosine_remainder(),
        }
    }

    /// R̂ averaged over azimuths.
    pub(crate) fn whole(&self, response: &Response, k: Complex64) -> Complex64 {
        match self {
            Self::Pencil(beam) => mean_over_azimuths(beam, k, |s0| response.pencil(beam.cos_inside, s0)),
            Self::Cosine { passed } => response.cosine(*passed),
            Self::UniformCosine => response.uniform_cosine(),
        }
    }

    /// Profile of the light scattered once, which is added in real space.
    pub(crate) fn single_scattering(&self, single_scattering_albedo: f64, eta: f64) -> SingleScattering {
        match self {
            Self::Pencil(beam) => beam.mean_single_scattering(single_scattering_albedo),
            Self::Cosine { .. } => cosine_single_scattering(single_scattering_albedo, eta),
            Self::UniformCosine => uniform_cosine_single_scattering(single_scattering_albedo, eta),
        }
    }
}

/// Points for the mean over azimuths.
const AZIMUTHS: usize = 40;

fn mean_over_azimuths(beam: &Beam, k: Complex64, f: impl Fn(Complex64) -> Complex64) -> Complex64 {
    let Beam { cos_inside, sin_inside, .. } = *beam;
    if sin_inside <= 0.0 {
        return f(Complex64::from(1.0 / cos_inside));
    }
    let nodes = azimuthal_mean(sin_inside, AZIMUTHS).into_iter();
    nodes.map(|(n_x, weight)| weight * f((1.0 - Complex64::I * k * n_x) / cos_inside)).sum()
}

/// Checks the parameters of a pencil beam as [`BoundaryEntrance::checked`] does, and refracts it.
pub(crate) fn checked_beam(alpha: f64, eta: f64, cos_theta: f64) -> Result<Beam, ParameterError> {
    check_medium(alpha, eta)?;
    require(cos_theta > 0.0 && cos_theta <= 1.0, "cos_theta", cos_theta, "in (0, 1]")?;
    let allowed = "above that of total reflection, sqrt(1 - eta^2)";
    Beam::refracted(eta, cos_theta).ok_or(ParameterError::new("cos_theta", cos_theta, allowed))
}

fn check_medium(alpha: f64, eta: f64) -> Result<(), ParameterError> {
    require(alpha > 0.0 && alpha <= 1.0, "single_scattering_albedo", alpha, "in (0, 1]")?;
    require((0.5..=3.0).contains(&eta), "eta", eta, "in [0.5, 3] for the exact solution")?;
    Ok(())
}
