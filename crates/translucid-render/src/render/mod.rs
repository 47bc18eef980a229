//! Scenes made ready, and the loop over samples.

pub(crate) mod camera;
pub(crate) mod checkpoint;
pub(crate) mod film;
pub(crate) mod fingerprint;
pub(crate) mod picture;
pub(crate) mod pixel_blocks;
pub(crate) mod renderer;
