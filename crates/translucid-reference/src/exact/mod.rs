//! The exact half space of isotropic scatterers (g = 0).
//!
//! Light that varies along the surface like e^{i k·x} sees a one-dimensional half space for each wave number k, whose
//! solution is an H function (G. B. Rybicki 1971, S. Chandrasekhar 1950); a profile is the Hankel transform of that.
//! Every step is a quadrature that converges exponentially, and every figure comes with an [`Estimate`] of its
//! error:
//!
//! 1. Light scattered once is taken apart and computed in real space ([`SingleScattering`]): it is what makes R ~ 1/r.
//! 2. The rest is transformed along a ray into the complex plane of k, which gives all digits of R(r) even where it has
//!    decayed to 1e-50.
//!
//! Under a dielectric boundary ([`HalfSpace::with_boundary`]) the transform is the solution of an integral equation over
//! directions, and an oblique beam ([`ObliqueHalfSpace`]) has one transform for each harmonic of the azimuth.
//!
//! ```
//! use translucid_reference::{Incidence, exact::HalfSpace};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! let half_space = HalfSpace::new(0.9, Incidence::NORMAL)?;
//! let profile = half_space.eval(1.0);
//! assert!((profile.value - 2.1217649785e-2).abs() < 1e-12 && profile.relative_error() < 1e-9);
//! let energy = half_space.enclosed(1.0).value + half_space.beyond(1.0).value;
//! assert!((energy - half_space.total().value).abs() < 1e-13);
//! # Ok(())
//! # }
//! ```
//!
//! [`Estimate`]: crate::Estimate

mod albedo;
mod angular_quadrature;
mod azimuthal_inversion;
mod boundary_entrance;
pub(crate) mod complex;
mod dielectric;
mod dielectric_directions;
mod dielectric_response;
pub(crate) mod dispersion;
mod energy;
pub(crate) mod h_function;
mod half_space;
mod half_space_profile;
pub(crate) mod hankel_inversion;
mod index_matched;
pub(crate) mod macdonald;
mod oblique;
mod oblique_single_scattering;
mod seen_from_above;
mod single_scattering;
mod transform;

pub use albedo::single_scattering_albedo;
pub use half_space::HalfSpace;
pub use half_space_profile::HalfSpaceProfile;
pub use oblique::ObliqueHalfSpace;
pub use seen_from_above::SeenFromAbove;
pub use single_scattering::SingleScattering;
pub use transform::HalfSpaceTransform;

/// A radius as the formulas need it: at least the least normal number; NaN counts as 0.
fn positive_radius(r: f64) -> f64 {
    if r > f64::MIN_POSITIVE { r.min(f64::MAX) } else { f64::MIN_POSITIVE }
}
