//! Diffusion from one point source and its image above the surface.

pub(crate) mod better;
pub(crate) mod source_pair;
pub(crate) mod standard;
