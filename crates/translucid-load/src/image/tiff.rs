//! TIFF images.

use std::io::Cursor;

use tiff::ColorType;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use translucid_scene::{ColorSpace, Pixels, linear_from_srgb};

use super::Decoded;
use super::file_bytes::ImageBytes;

/// Decodes the first image of a file, grey or RGB with or without alpha: 8 bits a channel to bytes, 16 bits to linear floats,
/// and floats as they are.
pub(super) fn decode(source: &ImageBytes<'_>, color_space: ColorSpace) -> Decoded {
    let damaged = |error: tiff::TiffError| source.error(format!("damaged TIFF: {error}"));
    let mut decoder = Decoder::new(Cursor::new(source.bytes)).map_err(damaged)?;
    let [width, height] =
        decoder.dimensions().map(<[u32; 2]>::from).map_err(damaged)?.map(|edge| edge as usize);
    let count = source.check_size(width, height)?;
    let channels = match decoder.colortype().map_err(damaged)? {
        ColorType::Gray(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) => 3,
        ColorType::RGBA(_) => 4,
        other => {
            let error = source.error(format!("a TIFF of colors {other:?}"));
            return Err(error.with_help("grey and RGB, with or without alpha, can be read"));
        }
    };
    // As much as such an image needs, and some for what is packed
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 16 * count;
    limits.intermediate_buffer_size = 16 * count + (1 << 20);
    let samples = decoder.with_limits(limits).read_image().map_err(damaged)?;
    let linear = |value: f32| match color_space {
        ColorSpace::Srgb => linear_from_srgb(value),
        ColorSpace::Linear => value,
    };
    let pixels = match samples {
        DecodingResult::U8(samples) => rgba(&samples, channels, count, 255).map(Pixels::Byte),
        DecodingResult::U16(samples) => {
            let part = |pixel: [u16; 4]| {
                let [r, g, b, a] = pixel.map(|value| f32::from(value) / 65535.0);
                [linear(r), linear(g), linear(b), a]
            };
            rgba(&samples, channels, count, u16::MAX)
                .map(|pixels| Pixels::Float(pixels.into_iter().map(part).collect()))
        }
        DecodingResult::F32(samples) => rgba(&samples, channels, count, 1.0).map(Pixels::Float),
        _ => {
            let error = source.error("a TIFF of unusual numbers");
            return Err(error.with_help("channels of 8 or 16 bits and floats of 32 bits can be read"));
        }
    };
    pixels
        .map(|pixels| ([width, height], pixels))
        .ok_or_else(|| source.error("damaged TIFF: pixels are missing"))
}

/// Grey, grey and alpha, RGB or RGBA to RGBA, opaque where there is no alpha; `None` where there are not so many.
fn rgba<T: Copy>(samples: &[T], channels: usize, count: usize, opaque: T) -> Option<Vec<[T; 4]>> {
    let pixel = |pixel: &[T]| match *pixel {
        [grey] => Some([grey, grey, grey, opaque]),
        [grey, alpha] => Some([grey, grey, grey, alpha]),
        [r, g, b] => Some([r, g, b, opaque]),
        [r, g, b, a] => Some([r, g, b, a]),
        _ => None,
    };
    (samples.len() == channels * count).then(|| samples.chunks(channels).map_while(pixel).collect())
}

/// A small valid file of 16 bits.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    let data: Vec<u16> = (0..9 * 7 * 3).map(|i| (i * 1373 % 65521) as u16).collect();
    file::<tiff::encoder::colortype::RGB16>(9, 7, &data)
}

#[cfg(test)]
fn file<C: tiff::encoder::colortype::ColorType>(width: u32, height: u32, data: &[C::Inner]) -> Vec<u8>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut bytes).expect("a buffer");
    encoder.write_image::<C>(width, height, data).expect("a valid image");
    bytes.into_inner()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use tiff::encoder::colortype::{CMYK8, Gray16, Gray32Float, RGB8, RGBA16};
    use translucid_scene::{Image, Place, SceneError};

    use super::*;
    use crate::decode_image;

    fn decoded(bytes: &[u8], color_space: ColorSpace) -> Result<Image, SceneError> {
        decode_image(&Place::file(Path::new("a.tif")), bytes, color_space, &mut Vec::new())
    }

    #[test]
    fn tiff_keeps_sixteen_bits() {
        let bytes = file::<RGBA16>(2, 1, &[0, 1, 32768, 65535, 65535, 257, 4096, 0]);
        let image = decoded(&bytes, ColorSpace::Linear).unwrap();
        assert_eq!((image.width, image.height), (2, 1));
        let expected = [0.0, 1.0, 32768.0, 65535.0].map(|v: f32| v / 65535.0);
        assert_eq!(image.texel(0, 0), expected);
        assert_eq!(image.texel(1, 0)[3], 0.0);
        let curved = decoded(&bytes, ColorSpace::Srgb).unwrap().texel(0, 0);
        // The inverse of sRGB's curve at 32768/65535
        assert!((curved[2] - 0.214_045).abs() < 1e-5 && curved[3] == 1.0, "{curved:?}");
        let grey = decoded(&file::<Gray16>(1, 1, &[13107]), ColorSpace::Linear).unwrap();
        assert_eq!(grey.texel(0, 0), [0.2, 0.2, 0.2, 1.0]);
    }

    #[test]
    fn tiff_reads_bytes_and_floats() {
        let bytes = decoded(&file::<RGB8>(1, 1, &[255, 51, 0]), ColorSpace::Linear).unwrap();
        let expected = [1.0, 0.2, 0.0, 1.0];
        assert!(
            bytes.texel(0, 0).iter().zip(expected).all(|(value, expected)| (value - expected).abs() < 1e-6)
        );
        let float = decoded(&file::<Gray32Float>(1, 1, &[3.5]), ColorSpace::Srgb).unwrap();
        assert_eq!(float.texel(0, 0), [3.5, 3.5, 3.5, 1.0]);
    }

    #[test]
    fn tiff_that_is_broken_or_unusual_is_refused_with_its_name() {
        let whole = example();
        for bytes in [&whole[..4], &whole[..whole.len() / 2], b"II*\0\xff\xff\xff\xff".as_slice()] {
            let message = decoded(bytes, ColorSpace::Srgb).unwrap_err().to_string();
            assert!(message.starts_with("a.tif: ") && message.contains("TIFF"), "{message}");
        }
        let inks = decoded(&file::<CMYK8>(1, 1, &[1, 2, 3, 4]), ColorSpace::Srgb).unwrap_err().to_string();
        assert!(inks.contains("CMYK"), "{inks}");
    }
}
