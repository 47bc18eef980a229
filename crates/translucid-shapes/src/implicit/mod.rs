//! Solids given by distance functions, their colors by noise, and the meshes made of them.

pub(super) mod distance;
pub(super) mod noise;
pub(super) mod sculpture;
mod surface_nets;
