//! JPEG images.

use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace as Layout;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::image::{Raster, Source};
use crate::{Pixels, SceneError, Warning};

/// Decodes grey, YCbCr, CMYK and YCCK images to RGB.
///
/// A file with damaged or missing data is decoded as far as it goes, with a warning.
pub(super) fn decode(source: &Source<'_>, warnings: &mut Vec<Warning>) -> Result<Raster, SceneError> {
    let damaged = |error: &DecodeErrors| source.error(format!("damaged JPEG: {error}"));
    let options = DecoderOptions::default()
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(Layout::RGB);
    let decoder = |options| JpegDecoder::new_with_options(ZCursor::new(source.bytes), options);

    let mut header = decoder(options);
    header.decode_headers().map_err(|error| damaged(&error))?;
    let info = header.info().ok_or_else(|| source.error("damaged JPEG: no image"))?;
    let [width, height] = [info.width, info.height].map(usize::from);
    let count = source.check_size(width, height)?;

    let samples = match decoder(options.set_strict_mode(true)).decode() {
        Ok(samples) => samples,
        Err(fault) => {
            let samples = decoder(options).decode().map_err(|error| damaged(&error))?;
            let message = format!("damaged JPEG, read as far as it goes: {fault}");
            warnings.push(Warning { message, place: Some(source.place.clone()) });
            samples
        }
    };
    if samples.len() != 3 * count {
        return Err(source.error(format!("damaged JPEG: {} samples for {count} pixels", samples.len())));
    }
    let pixels = samples.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect();
    Ok(Raster { width, height, pixels: Pixels::Byte(pixels) })
}
