//! Exact solutions, walks and models of the profile crate against each other and against published figures.
//!
//! Tests whose power is a number of photons or runs have an eighth of it unless `TRANSLUCID_THOROUGH=1`, see
//! `translucid-testing`; their documentation states figures for the whole.

mod agreement;
mod albedo_inversion;
mod beam_diffusion;
mod boundary_laws;
mod boundary_monte_carlo;
mod directional_dipole;
mod exact_half_space;
mod exact_profile;
mod guided;
mod guided_walk;
mod phase_functions;
mod plain_walk;
mod solutions;
mod statistics;
mod table_errors;
mod table_profile;
mod table_radii;
