//! Whether a rendering fits into memory: the system would end the process without a word.

use std::fs;

use translucid_image::PixelRect;
use translucid_scene::SceneError;

use super::Session;
use crate::world::{PixelSample, layer};

/// Memory that can be had without swapping, in bytes; `None` where the system does not say.
pub fn available_memory() -> Option<u64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    Some(line.split_whitespace().next()?.parse::<u64>().ok()? * 1024)
}

impl Session {
    /// Memory that a pixel takes while it is rendered: its sums, and a sample that waits. Denoising and writing take
    /// less.
    pub const BYTES_PER_PIXEL: u64 = (8 * layer::COUNT + size_of::<PixelSample>()) as u64;

    /// Refuses pictures that take more memory than is free.
    ///
    /// # Errors
    /// They do.
    pub fn require_memory(pixels: PixelRect, bytes_per_pixel: u64) -> Result<(), SceneError> {
        let needed = pixels.area().saturating_mul(bytes_per_pixel);
        match available_memory() {
            Some(available) if needed > available => {
                let PixelRect { width, height, .. } = pixels;
                let [needed, available] = [needed, available].map(|bytes| bytes as f64 / f64::from(1 << 30));
                let message = format!(
                    "a picture of {width}x{height} pixels needs {needed:.1} GiB of memory, but {available:.1} GiB are free"
                );
                Err(SceneError::new(message).with_help("choose a smaller size"))
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(target_os = "linux")]
    #[test]
    fn memory_is_required_before_it_is_taken() {
        assert!(available_memory().unwrap() > 0);
        let largest = PixelRect::whole([1 << 20; 2]);
        let message = Session::require_memory(largest, 1 << 20).unwrap_err().message;
        assert!(
            message.starts_with("a picture of 1048576x1048576 pixels needs 1073741824.0 GiB"),
            "{message}"
        );
        Session::require_memory(PixelRect::whole([1; 2]), 1).unwrap();
    }
}
