//! Reflectance profiles for subsurface scattering, as pure mathematics.
//!
//! Light that enters a translucent surface at one point leaves it at others.
//! A *reflectance profile* R(r) is the amount of it that leaves at the distance r, per unit of area.
//! This crate holds what a renderer, a fit or a reference needs to know about profiles:
//!
//! - [`NormalizedDiffusion`]: Burley's profile with evaluation, densities, closed-form cdf and quantile, exact
//!   sampling and moments.
//! - [`RefinedDiffusion`]: the same with four exponentials and an error of 0.3 %.
//! - [`ObliqueDiffusion`]: the same for a beam at any angle, a profile over radius and azimuth;
//!   [`ObliqueDiffusionTable`] is its twin for inner loops.
//! - [`StandardDipole`], [`BetterDipole`]: diffusion from one point source and its image;
//!   [`QuantizedDiffusion`]: from a whole beam, as a sum of Gaussians.
//! - [`DirectionalDipole`]: for light from any direction on any surface; [`DirectionalDipoleAverage`], its profile along
//!   the normal.
//! - [`SumOfGaussians`]: one to six Gaussians fitted to the exact half space, for those who blur textures or screens.
//! - [`ExactProfile`]: the exact half space (g = 0, η = 1), from tables.
//! - [`Model`]: all of these by name, made of one [`Appearance`] or [`Medium`]; [`Profile`] is what they share.
//! - [`SampledProfile`]: the profile through samples or energies that somebody measured or simulated.
//! - [`TabulatedProfile`], [`AlbedoTable`] and its twin [`AlbedoTableF32`]: any profile as a table, for one surface
//!   albedo or for all, with cdf, quantile and sampling in constant time.
//! - [`d_from_surface_albedo`] and [`scaling`]: the profile's width from a surface albedo and a mean free
//!   path, in each [`Parameterization`] and [`Configuration`] (P. H. Christensen and B. Burley 2015).
//! - [`PhotonBeamDiffusion`]: dipoles along the refracted beam, and exact single scattering beside them (R. Habel et al.
//!   2013).
//! - [`Medium`]: absorption, scattering, reduced and diffusion quantities, and the conversions between them.
//! - [`half_space_surface_albedo`]: the exact surface albedo of a medium, which turns measured coefficients
//!   into the parameters of a profile; [`HFunction`]: the light that it reflects, by directions.
//! - [`convention`]: the same material in the numbers of Blender, pbrt, RenderMan, Unreal and others, and presets.
//! - [`parse_profile_rows`]: profiles from a table of comma-separated values.
//! - [`fresnel_from_outside`] and its kin: reflectance of a dielectric boundary, exact and approximate, and
//!   its angular moments.
//!
//! ```
//! use translucid_profile::{Configuration, NormalizedDiffusion, Parameterization};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! // A surface that returns half of the light, with a mean free path of 2 mm.
//! let profile = NormalizedDiffusion::new(0.5, 2.0, Parameterization::Mfp, Configuration::Searchlight)?;
//! let near = profile.enclosed(2.0);
//! assert!(near > 0.24 && near < 0.26); // half of that half leaves within 2 mm
//! let r = profile.sample(0.7); // one random number in, one radius in mm out
//! let weight = profile.eval(r) / profile.pdf_area(r);
//! assert!((weight - 0.5).abs() < 1e-15); // the surface albedo: sampling is exact
//! # Ok(())
//! # }
//! ```
//!
//! # Units
//! Lengths are in any one unit that the caller keeps to; documentation writes it L.
//! A profile and a density per area are in L⁻², a density per length and coefficients in L⁻¹, albedos, cosines,
//! shares and reflectances are pure numbers.
//! η is n_inside/n_outside.
//!
//! # Promises
//! Only constructors fail, with a [`ParameterError`] that names parameter, value and range; what reads names or text has
//! an [`InputError`].
//! No function panics or returns a NaN or an infinity, whatever the argument: what is infinite by nature (R at
//! r = 0, the diffuse mean free path without absorption) is a greatest finite number, as documented there.
//! A slice method gives the bits of the scalar one.
//!
//! # Out of scope
//! Rays, colors and channels (a channel is the caller's loop), random generators (random numbers are
//! arguments), threads and files.
//! The crate depends on `libm`, for functions that have the same bits on every machine, and on `strsim`, for advice on
//! misspelt names.
//!
//! The normalized diffusion profile is the subject of US patent 9,659,404 B2; this notice is not legal
//! advice.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as every function here promises"
)]

pub mod coefficients;
pub mod convention;
mod error;
mod math;
mod medium;
mod model;
mod nearest;
mod profile;
mod rows;
mod short;
mod table;

pub use error::{InputError, ParameterError, require};
#[doc(hidden)]
pub use math::split_mix;
pub use math::{quadrature, roots};
pub use medium::albedo_inversion::AlbedoInversion;
pub use medium::appearance::Appearance;
pub use medium::fresnel::{
    fresnel_from_inside, fresnel_from_outside, fresnel_moment_1_from_inside, fresnel_moment_1_from_outside,
    fresnel_moment_2_from_inside, fresnel_moment_2_from_outside, schlick_from_inside, schlick_from_outside,
};
pub use medium::half_space::{HFunction, half_space_single_scattering_albedo, half_space_surface_albedo};
pub use medium::media::Medium;
pub use medium::scaling::{
    Configuration, Parameterization, d_from_surface_albedo, scaling, scaling_from_dmfp_searchlight,
    scaling_from_mfp_diffuse, scaling_from_mfp_searchlight,
};
pub use medium::similarity::Similarity;
pub use model::Model;
pub use model::burley::NormalizedDiffusion;
pub use model::dipole::better::BetterDipole;
pub use model::dipole::standard::StandardDipole;
pub use model::directional_dipole::DirectionalDipole;
pub use model::directional_dipole::average::DirectionalDipoleAverage;
pub use model::directional_dipole::single_precision::{DirectionalDipoleF32, DirectionalDipoleTable};
pub use model::exact::ExactProfile;
pub use model::oblique::ObliqueDiffusion;
pub use model::oblique::single_precision::{ObliqueDiffusionF32, ObliqueDiffusionTable};
pub use model::photon_beam_diffusion::{BeamMultipleScattering, BeamSingleScattering, PhotonBeamDiffusion};
pub use model::quantized_diffusion::QuantizedDiffusion;
pub use model::refined::RefinedDiffusion;
pub use model::similar_refined::SimilarRefinedDiffusion;
pub use model::sum_of_gaussians::SumOfGaussians;
pub use nearest::nearest;
pub use profile::{Profile, Quantity};
#[doc(hidden)]
pub use rows::values;
pub use table::albedo_table::{AlbedoTable, AlbedoTableF32, ProfileView, ProfileViewF32};
pub use table::precision::Precision;
pub use table::profile_rows::ProfileRow;
pub use table::sampled_profile::SampledProfile;
pub use table::table_profile::TableProfile;
pub use table::table_text::parse_profile_rows;
pub use table::tabulated_profile::TabulatedProfile;
