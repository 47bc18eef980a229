//! The ways in which light under surfaces is found.

pub(crate) mod points;
pub(crate) mod probes;
pub(crate) mod shared;
pub(crate) mod walk;
