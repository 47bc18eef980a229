//! WebP images, which glTF files may have by EXT_texture_webp.

use std::io::Cursor;

use image_webp::WebPDecoder;

use super::encoding::Samples;
use super::file_bytes::ImageBytes;
use super::tags::Exif;
use super::{Decoded, Picture, Stated};

/// Decodes images with and without loss; of an animated one the first frame.
pub(super) fn decode(source: &ImageBytes<'_>) -> Decoded {
    let damaged = |error: image_webp::DecodingError| source.error(format!("damaged WebP: {error}"));
    let mut decoder = WebPDecoder::new(Cursor::new(source.bytes)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let size = [width, height].map(|edge| edge as usize);
    let count = source.check_size(size[0], size[1])?;
    let channels = if decoder.has_alpha() { 4 } else { 3 };
    let mut samples = vec![0; channels * count];
    decoder.read_image(&mut samples).map_err(damaged)?;
    let pixel = |p: &[u8]| [p[0], p[1], p[2], p.get(3).copied().unwrap_or(255)];
    let samples = Samples::Byte(samples.chunks_exact(channels).map(pixel).collect());
    // Metadata that cannot be read is none
    let exif = decoder.exif_metadata().ok().flatten().map(|exif| Exif::parse(&exif)).unwrap_or_default();
    let stated = decoder.icc_profile().ok().flatten().map(Stated::Icc);
    Ok(Picture { stated, orientation: exif.orientation, ..Picture::plain(size, samples) })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use translucid_scene::{ColorSpace, Image, Pixels, Place};
    use translucid_testing::mutants;

    use crate::decode_image;
    use crate::result::Result;

    /// Two pixels without loss, written by Pillow: (200, 100, 50, 255) and (20, 40, 220, 128).
    const PIXELS: &[u8] = &[
        82, 73, 70, 70, 34, 0, 0, 0, 87, 69, 66, 80, 86, 80, 56, 76, 22, 0, 0, 0, 47, 1, 0, 0, 16, 15, 112,
        20, 158, 83, 208, 222, 138, 251, 127, 128, 193, 131, 140, 232, 127, 0,
    ];

    fn decoded(bytes: &[u8]) -> Result<Image> {
        decode_image(&Place::file(Path::new("a.webp")), bytes, ColorSpace::Srgb, &mut Vec::new())
    }

    #[test]
    fn pixels_are_those_that_were_written() {
        let image = decoded(PIXELS).unwrap();
        assert_eq!((image.width, image.height), (2, 1));
        assert_eq!(image.pixels, Pixels::Byte(vec![[200, 100, 50, 255], [20, 40, 220, 128]]));
    }

    #[test]
    fn damage_is_an_error_or_an_image_and_never_a_panic() {
        for mutant in mutants(PIXELS, 2_000) {
            assert!(decoded(&mutant).map_or(true, |image| image.validate().is_ok()));
        }
        assert!(decoded(&PIXELS[..24]).unwrap_err().to_string().contains("damaged WebP"));
    }
}
