//! Surfaces: a material's values at a point, and the scattering of light at its interface.

pub mod bsdf;
mod medium;
mod parameters;
mod shading_normal;
mod shells;
mod tables;
mod texture;

pub(crate) use medium::{WalkMedium, WalkRecipe};
pub(crate) use parameters::{
    absorption, emission_at, opacity_at, parameters_at, stated_length_at, surface_albedo_at,
};
pub(crate) use shading_normal::shading_normal_at;
pub(crate) use shells::{ShellPlace, Shells};
pub(crate) use tables::SurfaceTables;
pub(crate) use translucid_law::facing;
