//! Paths from the camera.

pub(crate) mod tracer;
