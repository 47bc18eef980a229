//! Tone mapping: from linear radiance to what a display shows.
//!
//! [`display_from_linear`] maps a color by one of the curves of [`ToneMapping`].
//!
//! # Units
//! Colors are linear Rec. 709; display values are encoded by the sRGB curve and lie in [0, 1].
//!
//! # Out of scope
//! Exposure, pictures and files.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as images need it"
)]

mod tone_mapping;

pub use tone_mapping::{ToneMapping, display_from_linear};
