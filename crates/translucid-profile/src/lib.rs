//! Reflectance profiles for subsurface scattering, as pure mathematics.

#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as every function here promises"
)]

mod burley;
mod burley_f32;
mod burley_kernel;
mod elementary;
mod error;
mod fresnel;
mod half_space;
mod media;
mod quadrature;
mod scaling;

pub use burley::NormalizedDiffusion;
pub use burley_f32::NormalizedDiffusionF32;
pub use error::ParameterError;
pub use fresnel::{
    fresnel_from_inside, fresnel_from_outside, fresnel_moment_1_from_inside, fresnel_moment_1_from_outside,
    fresnel_moment_2_from_inside, fresnel_moment_2_from_outside, schlick_from_inside, schlick_from_outside,
};
pub use half_space::{half_space_single_scattering_albedo, half_space_surface_albedo};
pub use media::Medium;
pub use scaling::{
    Configuration, Parameterization, d_from_surface_albedo, d_from_surface_albedo_f32, scaling, scaling_f32,
    scaling_from_dmfp_searchlight, scaling_from_mfp_diffuse, scaling_from_mfp_searchlight,
};
