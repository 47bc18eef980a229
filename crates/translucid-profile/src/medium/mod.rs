//! Media and their boundaries: coefficients, Fresnel reflectance, the exact surface albedo of a half space, and the
//! inversions from what a surface shows to what it is made of.

pub(crate) mod albedo_inversion;
pub(crate) mod appearance;
pub(crate) mod diffusion_boundary;
mod discrete_ordinates;
pub(crate) mod fresnel;
pub(crate) mod half_space;
pub(crate) mod length_coefficients;
pub(crate) mod media;
pub(crate) mod scaling;
pub(crate) mod similarity;
mod similarity_coefficients;
