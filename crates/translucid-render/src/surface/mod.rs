//! Surfaces: a material's values at a point, and how the interface there scatters light.

pub mod bsdf;
pub(crate) mod material;
