//! Fits of simple reflectance profiles to reference ones, and the errors that they keep.
//!
//! - [`l1_error`]: the area-weighted L1 distance of a profile from a reference, relative to the reference's energy;
//!   [`Judge`] measures many profiles against one reference.
//! - [`fit`]: least squares with mixtures of K members of a [`Family`] ([`Gaussian`], [`Exponential`], [`Burley`]), whose
//!   weights are not negative and sum to 1.
//! - [`SampleFit`]: mixtures fitted to a measured or simulated table, with the uncertainties of their parameters;
//!   [`SampleFits`] has one of every family.
//! - [`MediumFit`]: a medium's coefficients fitted to such a table, where each single-scattering albedo has its profile;
//!   [`MediumGrid`] has one of every second similarity parameter γ, too.
//! - [`ScalingFit`]: the scale s(A) that brings normalized diffusion closest to the exact half space, and
//!   [`ScalingPolynomial`]s through it.
//! - [`least_squares`] of any [`Residuals`].
//!
//! Anything that is a [`Profile`](translucid_profile::Profile) can be the reference.
//!
//! ```
//! use translucid_fit::{Exponential, fit, l1_error};
//! use translucid_profile::NormalizedDiffusion;
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! // Normalized diffusion is two exponentials
//! let burley = NormalizedDiffusion::from_d(0.5, 2.0)?;
//! let fits = fit::<Exponential>(&burley, 2)?;
//! let [weights, scales] = [fits[1].mixture.weights(), fits[1].mixture.scales()];
//! assert!((weights[0] - 0.25).abs() < 1e-9 && (scales[0] - 2.0).abs() < 1e-8);
//! assert!((weights[1] - 0.75).abs() < 1e-9 && (scales[1] - 6.0).abs() < 1e-8);
//! assert!(l1_error(&fits[1].mixture, &burley, f64::INFINITY) < 1e-8);
//! assert!(l1_error(&fits[0].mixture, &burley, f64::INFINITY) > 0.05); // one exponential
//! # Ok(())
//! # }
//! ```
//!
//! # Units
//! Lengths are in the unit of the reference.
//!
//! # Out of scope
//! Making references (`translucid-reference`), files, figures.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod family;
mod l1_error;
mod least_squares;
mod medium_fit;
mod medium_grid;
mod minimum;
mod mixture;
mod profile_fit;
mod sample_fit;
mod sample_fits;
mod scaling_fit;
mod scaling_polynomial;

pub use family::{Burley, Exponential, Family, Gaussian};
pub use l1_error::{Judge, l1_error};
pub use least_squares::{Residuals, least_squares};
pub use levenberg_marquardt::LevenbergMarquardt;
pub use medium_fit::{MediumFit, MediumProfile};
pub use medium_grid::MediumGrid;
pub use mixture::Mixture;
pub use profile_fit::{Fit, Target, fit};
pub use sample_fit::{Errors, Estimate, Sample, SampleFit};
pub use sample_fits::SampleFits;
pub use scaling_fit::{ErrorSummary, ScalingFit, ScalingPoint};
pub use scaling_polynomial::ScalingPolynomial;
