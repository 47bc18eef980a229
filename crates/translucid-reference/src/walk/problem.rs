//! Geometry, boundary, scattering and illumination of a walk.

use translucid_profile::{ParameterError, require};

use crate::Incidence;

/// Distribution of the angle by which a collision deflects a photon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PhaseFunction {
    /// L. G. Henyey and J. L. Greenstein 1941, *Diffuse radiation in the galaxy*, equation 2, with the mean
    /// cosine g in (−1, 1); g = 0 is isotropic.
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
    /// J. W. Strutt (Lord Rayleigh) 1871, for unpolarized light: 3/(16π) (1 + cos²θ).
    Rayleigh,
}

impl PhaseFunction {
    /// Every direction alike.
    pub const ISOTROPIC: Self = Self::HenyeyGreenstein { g: 0.0 };

    /// Mean cosine g of the deflection.
    pub fn mean_cosine(self) -> f64 {
        match self {
            Self::HenyeyGreenstein { g } => g,
            Self::Rayleigh => 0.0,
        }
    }
}

/// Parameters of a [`Problem`], to be filled in where they differ from the default: an index-matched half space
/// of isotropic scatterers under a pencil beam.
#[derive(Clone, Copy, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem(Parameters);

impl Problem {
    /// Checks the parameters.
    ///
    /// # Errors
    /// A parameter is outside the range that [`Parameters`] states.
    pub fn new(parameters: Parameters) -> Result<Self, ParameterError> {
        let Parameters { phase_function, eta, thickness, incidence, spot_radius } = parameters;
        if let PhaseFunction::HenyeyGreenstein { g } = phase_function {
            require(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        }
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
        Ok(Self(parameters))
    }

    /// The parameters.
    pub fn parameters(&self) -> &Parameters {
        &self.0
    }

    /// Number of faces through which light can leave.
    pub(super) fn faces(&self) -> usize {
        if self.0.thickness.is_finite() { 2 } else { 1 }
    }
}
