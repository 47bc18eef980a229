//! Contenders that are compared, and the numbers that come out.
//!
//! The medium is the talk's: a half space of isotropic scatterers (g = 0) with the refractive index of its
//! surroundings (η = 1), by its surface albedo A and a mean free path of 1.
//! The judge is its exact solution; photons that walk are an independent witness.
//!
//! - [`Contender`]: a model, a variant of one, or a fit, by name.
//! - [`Reference`]: the exact solution for one surface albedo.
//! - [`ErrorTable`]: area-weighted L1 errors of contenders for many albedos; [`claims`] are what the talk says of them.
//! - [`Reflectance`]: curves R(r) with the walk's points; [`ScalingCase`]: s(A).
//! - [`SampleTest`]: histograms of drawn radii, with χ².
//! - [`FresnelCurve`]: Schlick against Fresnel.
//! - [`Timing`]: nanoseconds per call.
//! - [`Comparison`]: all of this at once, as [`Settings`] ask for it.

mod chi_square;
mod claims;
mod contender;
mod errors;
mod fresnel;
mod monte_carlo;
mod ranges;
mod reference;
mod reflectance;
mod run;
mod sampling;
mod scaling;
mod settings;
mod timing;
mod watch;

pub use chi_square::chi_square_probability;
pub use claims::{Claim, claims};
pub use contender::{Contender, Group, Inversion, Made};
pub use errors::{ErrorRow, ErrorTable, Summary};
pub use fresnel::{FresnelCurve, Side, fresnel_curves};
pub use monte_carlo::{RingPoint, Walk};
pub use ranges::{R_MAX, talk_albedos};
pub use reference::Reference;
pub use reflectance::{Curve, Reflectance};
pub use run::Comparison;
pub use sampling::SampleTest;
pub use scaling::ScalingCase;
pub use settings::Settings;
pub use timing::{Quantity, Timing};
pub use watch::{Stopped, Watch};
