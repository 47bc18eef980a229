//! PNG images.

use std::io::Cursor;
use std::sync::LazyLock;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use translucid_scene::{ColorSpace, Pixels, linear_from_srgb};

use super::Decoded;
use super::file_bytes::ImageBytes;

/// Decodes 8 bits a channel or less to bytes, 16 bits to linear floats.
pub(super) fn decode(source: &ImageBytes<'_>, color_space: ColorSpace) -> Decoded {
    let damaged = |error: png::DecodingError| source.error(format!("damaged PNG: {error}"));
    let mut decoder = Decoder::new_with_limits(Cursor::new(source.bytes), Limits { bytes: usize::MAX });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(damaged)?;
    let [width, height] = [header.width, header.height].map(|edge| edge as usize);
    source.check_size(width, height)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size().ok_or_else(|| source.error("the PNG is too large"))?;
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples).map_err(damaged)?;
    samples.truncate(frame.buffer_size());
    let channels = frame.color_type.samples();
    let pixels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let pixel = |p| float_pixel(p, frame.color_type, color_space);
            Pixels::Float(samples.chunks_exact(2 * channels).map(pixel).collect())
        }
        _ => Pixels::Byte(samples.chunks_exact(channels).map(byte_pixel).collect()),
    };
    Ok(([width, height], pixels))
}

/// Grey, grey and alpha, RGB or RGBA to RGBA.
fn byte_pixel(pixel: &[u8]) -> [u8; 4] {
    match *pixel {
        [grey] => [grey, grey, grey, 255],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, 255],
        [r, g, b, a] => [r, g, b, a],
        _ => [0; 4],
    }
}

/// Linear values of 16-bit sRGB codes: a photograph has a thousand times as many samples as there are codes.
static LINEAR_FROM_SRGB_CODE: LazyLock<Vec<f32>> =
    LazyLock::new(|| (0..=u16::MAX).map(|code| linear_from_srgb(f32::from(code) / 65535.0)).collect());

/// As `byte_pixel`, of big-endian 16-bit samples, decoded.
fn float_pixel(pixel: &[u8], color_type: ColorType, color_space: ColorSpace) -> [f32; 4] {
    let code = |i: usize| u16::from_be_bytes([pixel[2 * i], pixel[2 * i + 1]]);
    let sample = |i: usize| f32::from(code(i)) / 65535.0;
    let color = |i: usize| match color_space {
        ColorSpace::Srgb => LINEAR_FROM_SRGB_CODE[usize::from(code(i))],
        ColorSpace::Linear => sample(i),
    };
    match color_type {
        ColorType::GrayscaleAlpha => [color(0), color(0), color(0), sample(1)],
        ColorType::Rgb => [color(0), color(1), color(2), 1.0],
        ColorType::Rgba => [color(0), color(1), color(2), sample(3)],
        ColorType::Grayscale | ColorType::Indexed => [color(0), color(0), color(0), 1.0],
    }
}

/// A small valid file.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 9, 7);
    encoder.set_color(ColorType::Rgba);
    encoder.set_depth(BitDepth::Sixteen);
    let data: Vec<u8> = (0..9 * 7 * 8).map(|i| (i * 37 % 251) as u8).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&data)).expect("a valid image");
    bytes
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use translucid_scene::{Image, Place, SceneError};

    use super::*;
    use crate::decode_image;

    /// A PNG file of the given samples.
    fn file(width: u32, height: u32, color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if color == ColorType::Indexed {
            encoder.set_palette(vec![10, 20, 30, 40, 50, 60]);
            encoder.set_trns(vec![255, 128]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        bytes
    }

    fn decoded(bytes: &[u8], color_space: ColorSpace) -> Result<Image, SceneError> {
        decode_image(&Place::file(Path::new("a.png")), bytes, color_space, &mut Vec::new())
    }

    fn byte_pixels(bytes: &[u8]) -> Vec<[u8; 4]> {
        match decoded(bytes, ColorSpace::Srgb).unwrap().pixels {
            Pixels::Byte(pixels) => pixels,
            Pixels::Float(_) => panic!("expected bytes"),
        }
    }

    #[test]
    fn png_reads_every_color_type() {
        use ColorType::{Grayscale, GrayscaleAlpha, Indexed, Rgb, Rgba};
        let eight = BitDepth::Eight;
        let pixels = |color, data: &[u8]| byte_pixels(&file(2, 1, color, eight, data));
        assert_eq!(pixels(Grayscale, &[7, 9]), [[7, 7, 7, 255], [9, 9, 9, 255]]);
        assert_eq!(pixels(GrayscaleAlpha, &[7, 1, 9, 2]), [[7, 7, 7, 1], [9, 9, 9, 2]]);
        assert_eq!(pixels(Rgb, &[1, 2, 3, 4, 5, 6]), [[1, 2, 3, 255], [4, 5, 6, 255]]);
        assert_eq!(pixels(Rgba, &[1, 2, 3, 4, 5, 6, 7, 8]), [[1, 2, 3, 4], [5, 6, 7, 8]]);
        assert_eq!(pixels(Indexed, &[1, 0]), [[40, 50, 60, 128], [10, 20, 30, 255]]);
    }

    #[test]
    fn png_expands_few_bits() {
        let bits = file(3, 1, ColorType::Grayscale, BitDepth::One, &[0b1010_0000]);
        assert_eq!(byte_pixels(&bits), [[255; 4], [0, 0, 0, 255], [255; 4]]);
        let palette = file(2, 1, ColorType::Indexed, BitDepth::Two, &[0b0100_0000]);
        assert_eq!(byte_pixels(&palette), [[40, 50, 60, 128], [10, 20, 30, 255]]);
    }

    #[test]
    fn png_of_16_bits_becomes_linear_floats() {
        let half = 0x8000_u16.to_be_bytes();
        let bytes = file(1, 1, ColorType::GrayscaleAlpha, BitDepth::Sixteen, &[half, half].concat());
        let stored = f32::from(0x8000_u16) / 65535.0;
        let color = decoded(&bytes, ColorSpace::Srgb).unwrap();
        assert_eq!(color.color_space, ColorSpace::Linear);
        let [r, _, b, a] = color.texel(0, 0);
        assert!((r - 0.214_053).abs() < 1e-5 && r == b, "{r}");
        assert!((a - stored).abs() < 1e-6);
        assert_eq!(decoded(&bytes, ColorSpace::Linear).unwrap().texel(0, 0), [stored; 4]);
    }

    #[test]
    fn png_that_is_broken_is_refused_with_its_name() {
        let good = file(40, 40, ColorType::Rgb, BitDepth::Eight, &[77; 4800]);
        let mut checksum = good.clone();
        let last = checksum.len() - 20;
        checksum[last] ^= 1;
        let mut huge = good.clone();
        huge[16..20].copy_from_slice(&0x7fff_ffff_u32.to_be_bytes());
        let mut zero = good.clone();
        zero[16..20].copy_from_slice(&[0; 4]);
        for bytes in [&good[..30], &good[..good.len() / 2], &good[..8], &checksum, &huge, &zero] {
            let message = decoded(bytes, ColorSpace::Srgb).unwrap_err().to_string();
            assert!(message.starts_with("a.png: "), "{message}");
            assert!(message.contains("PNG") || message.contains("pixels"), "{message}");
        }
    }
}
