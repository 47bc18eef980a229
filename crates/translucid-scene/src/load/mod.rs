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
/// The file is missing, cannot be read, or is not a file: a pipe would keep the reader waiting.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    let failure = |reason: String| SceneError::at(Place::file(path), format!("cannot be read: {reason}"));
    let metadata = std::fs::metadata(path).map_err(|error| failure(error.to_string()))?;
    if !metadata.is_file() {
        return Err(failure(String::from("not a file")));
    }
    std::fs::read(path).map_err(|error| failure(error.to_string()))
}
