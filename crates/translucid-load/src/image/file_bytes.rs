//! Bytes of an image file, and how large an image they may claim to be.

use translucid_scene::{Image, Place, SceneError};

use crate::result::Result;

/// Pixels that may be claimed by a file of any length.
const SMALL: usize = 1 << 22;

/// Most pixels for each byte of a file beyond [`SMALL`]: deflate packs at most 1032 bytes in one.
const PIXELS_PER_BYTE: usize = 2_048;

/// Most values of all channels that are read for each pixel that a file may claim.
const SAMPLES_PER_PIXEL: u64 = 16;

/// Most values of all channels: 16 GiB in single precision.
const MOST_SAMPLES: u64 = 1 << 32;

/// The bytes of an image file and their place.
pub(super) struct ImageBytes<'a> {
    pub(super) place: &'a Place,
    pub(super) bytes: &'a [u8],
}

impl ImageBytes<'_> {
    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        SceneError::at(self.place.clone(), message)
    }

    /// Number of pixels, refused before anything of that size is allocated.
    pub(super) fn check_size(&self, width: usize, height: usize) -> Result<usize> {
        if width == 0 || height == 0 {
            return Err(self.error(format!("the image has no pixels: {width} × {height}")));
        }
        let pixels = width.saturating_mul(height);
        if width.max(height) > Image::LONGEST_EDGE || pixels > Image::MOST_PIXELS {
            let message = format!("the image is too large: {width} × {height} pixels");
            return Err(self.error(message).with_help(format!(
                "at most {} pixels an edge and {} in all can be read",
                Image::LONGEST_EDGE,
                Image::MOST_PIXELS
            )));
        }
        if pixels > SMALL.saturating_add(self.bytes.len().saturating_mul(PIXELS_PER_BYTE)) {
            let length = self.bytes.len();
            return Err(
                self.error(format!("{length} bytes cannot hold the {width} × {height} pixels claimed"))
            );
        }
        Ok(pixels)
    }

    /// Refuses more values of all channels together than fit in memory, or than a file of this length may hold.
    pub(super) fn check_samples(&self, samples: u64) -> Result<()> {
        let length = self.bytes.len();
        let claimed = SMALL.saturating_add(length.saturating_mul(PIXELS_PER_BYTE)) as u64;
        let most = claimed.saturating_mul(SAMPLES_PER_PIXEL).min(MOST_SAMPLES);
        if samples > most {
            let message = format!(
                "the channels hold {samples} values, but of a file of {length} bytes at most {most} are read"
            );
            return Err(self.error(message));
        }
        Ok(())
    }
}
