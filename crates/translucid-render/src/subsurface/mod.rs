//! Light under surfaces: the BSSRDF of each material, and the transport that finds its light.
//!
//! A BSSRDF S(x_i, ω_i, x_o, ω_o) relates light that enters a body at the entry point x_i to light that leaves it at the
//! exit point x_o. Paths come from the camera, so they meet x_o first.
//!
//! ```text
//! kernel/          S(x_i, ω_i, x_o), the spatial part of the BSSRDF: the profile, cut and tabulated, and its directions
//! transport/       how light is found: probes, shared probes, points, a walk
//! recipes.rs       from materials to transports; kernels and media that edits may need again
//! transports.rs    the transports of a scene, as paths use them
//! pairing.rs       whose parameters count where a texture gives exit and entry point different ones
//! normalization.rs how much of a profile a shape holds; shape_factor.rs makes up for it
//! exit_point.rs    x_o, the point that light leaves
//! entry_point.rs   x_i, and the light that arrives there
//! ```

pub(crate) mod entry_point;
mod exit_point;
pub(crate) mod kernel;
mod normalization;
mod note;
mod pairing;
mod parameters;
mod recipes;
mod shape_factor;
pub(crate) mod transport;
mod transports;

pub(crate) use exit_point::ExitPoint;
pub use note::{Note, NoteKind};
pub(crate) use parameters::Subsurface;
pub(crate) use recipes::Recipes;
pub(crate) use transport::{Tracer, TransportScratch};
pub(crate) use transports::{Transports, media};
