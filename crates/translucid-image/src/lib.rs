//! Pictures in files.
//!
//! A [`Picture`] is a rectangle of pixels with named channels, whose values are asked for row by row, so that sums of
//! a renderer are written without a copy of them.
//! It becomes an OpenEXR file of all its channels ([`Picture::save_exr`]) or an 8-bit PNG of what a display shows
//! ([`Picture::save_png`]), and [`Denoiser`] takes its noise away.
//! Every file is written beside its target and then takes its place ([`translucid_files`]): no reader meets half of one.
//!
//! # Units
//! Colors are linear Rec. 709, multiplied by coverage. Pixels count from the upper left corner.
//!
//! # Out of scope
//! Reading pictures, and any knowledge of scenes and of how a picture is computed.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![allow(
    clippy::manual_clamp,
    reason = "`clamp` passes NaN on, `max` then `min` turns it into the lower bound, as images need it"
)]

mod denoise;
mod exposure;
mod exr;
mod picture;
mod pixel_rect;
mod png;
mod python_packages;

pub use denoise::{DENOISER_VARIABLE, Denoised, Denoiser};
pub use picture::{MetadataValue, Picture, PictureChannel, Precision};
pub use pixel_rect::PixelRect;
pub use png::{CodedPicture, DisplayTransform, Encoding};
pub use python_packages::import_packages_from;
pub use translucid_display::{ToneMapping, display_from_linear};
pub use translucid_files::OutputError;
