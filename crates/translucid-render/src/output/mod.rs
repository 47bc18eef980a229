//! From sums to files: images, display transforms and checkpoints.
//!
//! Every file is written beside its target and then renamed onto it, so that a reader never meets half
//! of one.

#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as images need it"
)]

mod atomic_file;
mod checkpoint;
mod denoise;
mod error;
mod exr;
mod png;
mod tone_mapping;

pub use atomic_file::{check_writable, write_atomically};
pub(crate) use checkpoint::Checked;
pub use checkpoint::{CheckpointInfo, load_checkpoint, save_checkpoint};
pub use denoise::{DENOISER_VARIABLE, DenoiseError, Denoised, Denoiser};
pub use error::OutputError;
pub use exr::{ImageInfo, write_exr, write_exr_with_denoised};
pub use png::{write_denoised_png, write_png};
pub use tone_mapping::display_from_linear;
