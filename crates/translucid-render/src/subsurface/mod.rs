//! Light under surfaces.

pub(crate) mod kernel;
pub(crate) mod normalization;
pub(crate) mod pairing;
pub(crate) mod transport;
