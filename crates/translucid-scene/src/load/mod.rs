//! Readers of the file formats, each from bytes to validated data.

mod exr;
mod gltf;
mod image;
mod jpeg;
mod ply;
mod png;
mod polygon;
mod radiance;

use std::path::Path;

pub use gltf::{GltfScene, load_gltf, parse_gltf};
pub use image::{decode_image, load_image};
pub use ply::{load_ply, parse_ply};

use crate::{Place, SceneError};

/// Reads a file whole.
///
/// # Errors
/// The file is missing or cannot be read.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    std::fs::read(path).map_err(|error| SceneError::at(Place::file(path), format!("cannot be read: {error}")))
}
