//! Tests of the crate from outside: its laws, naive second implementations, and tables.

mod naive_beam;
mod naive_diffusion;
mod naive_directional;
mod naive_gaussians;
mod normalized_diffusion_laws;
mod profile_laws;
mod tables;
