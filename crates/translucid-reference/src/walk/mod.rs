//! The Monte Carlo walk: photons through a half space or a slab.

mod exit;
mod problem;

pub use exit::Side;
pub(crate) use exit::{Exit, PhotonCounts};
pub use problem::{Parameters, PhaseFunction, Problem};
