//! Boundary condition of a smooth surface for diffused light, which it lets out by fluence and by flux, with a share reflected back inside.
//!
//! E. d'Eon and G. Irving, *A Quantized-Diffusion Model for Rendering Translucent Materials*, SIGGRAPH 2011, after
//! A. Kienle and M. S. Patterson, *Improved solutions of the steady-state and the time-resolved diffusion equations
//! for reflectance from a semi-infinite turbid medium*, 1997.

use crate::error::{ParameterError, require};
use crate::{fresnel_moment_1_from_inside, fresnel_moment_2_from_inside};

/// Constants of a relative index for diffused light that meets the boundary from inside.
///
/// ```text
/// exitance = C_φ φ + C_E E,   C_φ = ¼ (1 − 2C₁),   C_E = ½ (1 − 3C₂),   A_F = (1 + 3C₂)/(1 − 2C₁)
/// ```
///
/// C₁ and C₂ are the moments of the reflectance from inside. For every η, 2 A_F C_φ + C_E = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DiffusionBoundary {
    /// C_φ.
    pub(crate) fluence: f64,
    /// C_E.
    pub(crate) flux: f64,
    /// A_F, by which internal reflection moves the extrapolated boundary away to the height 2 A_F D.
    pub(crate) mismatch: f64,
}

impl DiffusionBoundary {
    /// The boundary of a relative index η = n_inside/n_outside ∈ [0.05, 20].
    pub(crate) fn new(eta: f64) -> Result<Self, ParameterError> {
        require((0.05..=20.0).contains(&eta), "eta", eta, "in [0.05, 20]")?;
        let c_1 = fresnel_moment_1_from_inside(eta);
        let c_2 = fresnel_moment_2_from_inside(eta);
        let mismatch = (1.0 + 3.0 * c_2) / (1.0 - 2.0 * c_1);
        Ok(Self { fluence: 0.25 * (1.0 - 2.0 * c_1), flux: 0.5 * (1.0 - 3.0 * c_2), mismatch })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fluence_and_flux_add_up() {
        for eta in [0.05, 0.5, 1.0, 1.4, 3.0, 20.0] {
            let b = DiffusionBoundary::new(eta).unwrap();
            assert!((2.0 * b.mismatch * b.fluence + b.flux - 1.0).abs() < 1e-15, "{eta}");
        }
        let matched = DiffusionBoundary::new(1.0).unwrap();
        assert_eq!([matched.fluence, matched.flux, matched.mismatch], [0.25, 0.5, 1.0]);
    }
}
