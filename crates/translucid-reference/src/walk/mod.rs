//! The Monte Carlo walk: photons through a half space or a slab.

mod boundary;
mod exit;
mod lanes;
mod measure;
mod problem;
mod random;
mod scatter;
mod sources;
mod trace;

pub use exit::Side;
pub(crate) use exit::{Exit, PhotonCounts};
#[doc(hidden)]
pub use measure::count_collisions_and_exits;
pub use problem::{Parameters, PhaseFunction, Problem};
pub(crate) use trace::trace;
