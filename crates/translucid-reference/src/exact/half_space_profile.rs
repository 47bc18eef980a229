//! The exact half space as a profile, to judge others by.

use translucid_profile::{Configuration, ParameterError, Profile};

use super::{HalfSpace, positive_radius};

/// The exact half space of isotropic scatterers without a boundary, with a mean free path of 1, behind the trait that
/// every model has.
///
/// Each call solves an integral, which costs some microseconds; the estimates of its error are dropped.
/// [`ExactProfile`](translucid_profile::ExactProfile) is the same from a table, to 1e-6 of the cdf.
///
/// ```
/// use translucid_profile::{Configuration, Profile};
/// use translucid_reference::exact::HalfSpaceProfile;
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let exact = HalfSpaceProfile::from_surface_albedo(0.5, Configuration::Searchlight)?;
/// assert!((exact.enclosed(1.0) - 0.253274).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct HalfSpaceProfile(HalfSpace);

impl HalfSpaceProfile {
    /// The half space that returns a surface albedo.
    ///
    /// # Errors
    /// The surface albedo is not in (0, 1\].
    pub fn from_surface_albedo(
        surface_albedo: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        Ok(Self(HalfSpace::from_surface_albedo(surface_albedo, configuration.into())?))
    }

    /// The solution with the estimates of its error.
    pub fn half_space(&self) -> &HalfSpace {
        &self.0
    }
}

impl Profile for HalfSpaceProfile {
    fn eval_times_r(&self, r: f64) -> f64 {
        // The square of a smaller radius is no number
        let r = positive_radius(r).max(1e-300);
        r * self.0.eval(r).value
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.0.enclosed(r).value
    }

    fn beyond(&self, r: f64) -> f64 {
        self.0.beyond(r).value
    }

    fn surface_albedo(&self) -> f64 {
        self.0.total().value
    }

    fn scale(&self) -> f64 {
        1.0
    }
}
