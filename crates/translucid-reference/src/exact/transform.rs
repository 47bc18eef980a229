//! Hankel transform of the half space without its profile.

use translucid_profile::ParameterError;

use super::boundary_entrance::BoundaryEntrance;
use super::dielectric;
use super::dispersion::Dispersion;
use super::half_space::HalfSpace;
use crate::Incidence;

/// Hankel transform R̂(k) = ∫ R(r) J₀(kr) 2πr dr of the exact half space of isotropic scatterers, for who needs no R(r): a
/// boundary's profile takes some hundred wave numbers of its own, which are not solved here.
#[derive(Clone, Debug)]
pub struct HalfSpaceTransform(Solution);

#[derive(Clone, Debug)]
enum Solution {
    Matched(HalfSpace),
    Boundary { dispersion: Dispersion, eta: f64, entrance: BoundaryEntrance },
}

impl HalfSpaceTransform {
    /// The half space of [`HalfSpace::with_boundary`].
    ///
    /// ```
    /// use translucid_reference::Incidence;
    /// use translucid_reference::exact::{HalfSpace, HalfSpaceTransform};
    ///
    /// let transform = HalfSpaceTransform::new(0.9, 1.4, Incidence::Cosine)?;
    /// let half_space = HalfSpace::with_boundary(0.9, 1.4, Incidence::Cosine)?;
    /// assert_eq!(transform.at(0.3), half_space.hankel(0.3).value);
    /// # Ok::<(), translucid_profile::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// A parameter is outside its range, or a beam is totally reflected (η < 1).
    pub fn new(
        single_scattering_albedo: f64,
        eta: f64,
        incidence: Incidence,
    ) -> Result<Self, ParameterError> {
        if eta == 1.0 {
            let matched = HalfSpace::with_boundary(single_scattering_albedo, eta, incidence)?;
            return Ok(Self(Solution::Matched(matched)));
        }
        let entrance = BoundaryEntrance::checked(single_scattering_albedo, eta, incidence)?;
        let dispersion = Dispersion::new(single_scattering_albedo);
        Ok(Self(Solution::Boundary { dispersion, eta, entrance }))
    }

    /// R̂ of a wave number k ≥ 0 \[ℓ⁻¹\], as near as [`HalfSpace::hankel`] says of the same k; NaN counts as 0.
    pub fn at(&self, k: f64) -> f64 {
        let k = if k > 0.0 { k } else { 0.0 };
        match &self.0 {
            Solution::Matched(half_space) => half_space.hankel(k).value,
            Solution::Boundary { dispersion, eta, entrance } => {
                dielectric::transform(dispersion, *eta, *entrance, k).min(1.0)
            }
        }
    }
}
