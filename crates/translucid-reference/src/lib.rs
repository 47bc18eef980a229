//! Ground truth for subsurface scattering.
//!
//! Every approximation of light under a surface needs a judge. This crate holds four, on the same parameters:
//!
//! - [`exact`]: the half space of isotropic scatterers, solved. Its figures carry an estimate of their numerical
//!   error: without a boundary some 1e-10 of the value, with one as [`exact::HalfSpace::with_boundary`] states.
//! - [`walk`]: a Monte Carlo walk for everything else (phase functions, slabs, spots of light), whose figures
//!   carry a standard error, and whose tables serve every albedo at once.
//! - [`layers`]: plane layers of different media on a ground.
//! - [`mcml`]: the files of another walk through layers, MCML.
//! - [`body`]: the same, photon by photon, in things that are no half space: sphere, slab and wedge.
//!
//! # Conventions
//! *Lengths are mean free paths* (ℓ = 1/σ_t = 1), but in [`layers`]: a medium of another ℓ has the profile R(r/ℓ)/ℓ².
//!
//! *One unit of flux has entered the medium.* What the boundary reflects from outside is not part of it, as in
//! the BSSRDF S = C F_t R F_t, where the factor F_t stands for entering; light that is reflected on its way out
//! stays inside, and R counts what gets through. [`specular_reflectance`] is the part that never entered.
//!
//! A reflectance profile is the exitance at the distance r from the point of entry, in ℓ⁻².
//!
//! # Out of scope
//! Approximate profiles (`translucid-profile`), fits, colors, files of tables other than the walk's own.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

// Walks need a clock and vectors, which WebAssembly has not: there are the exact half space and the totals of layers alone.
#[cfg(not(target_family = "wasm"))]
pub mod body;
mod estimate;
pub mod exact;
mod incidence;
pub mod layers;
#[cfg(not(target_family = "wasm"))]
pub mod mcml;
#[cfg_attr(
    target_family = "wasm",
    allow(dead_code, reason = "of phase functions, layers need the moments alone")
)]
mod phase_function;
mod phase_table;
#[cfg(not(target_family = "wasm"))]
mod ray;
#[cfg(not(target_family = "wasm"))]
mod split_mix;
#[cfg(not(target_family = "wasm"))]
pub mod walk;

pub use estimate::Estimate;
pub use incidence::{Incidence, specular_reflectance};
