//! PNG images.

use std::io::Cursor;

use png::{BitDepth, CodingIndependentCodePoints, Decoder, Info, Limits, Transformations};

use super::encoding::{Curve, Encoding, Samples};
use super::file_bytes::ImageBytes;
use super::tags::Exif;
use super::{Decoded, Picture, Stated};
use crate::primaries::{DISPLAY_P3, Primaries, REC_709, REC_2020};
use crate::result::Result;

/// Decodes 8 bits a channel or less to bytes, 16 bits to 16 bits.
pub(super) fn decode(source: &ImageBytes<'_>) -> Decoded {
    let damaged = |error: png::DecodingError| source.error(format!("damaged PNG: {error}"));
    let mut decoder = Decoder::new_with_limits(Cursor::new(source.bytes), Limits { bytes: usize::MAX });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    let header = decoder.read_header_info().map_err(damaged)?;
    let size = [header.width, header.height].map(|edge| edge as usize);
    source.check_size(size[0], size[1])?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let length = reader.output_buffer_size().ok_or_else(|| source.error("the PNG is too large"))?;
    let mut samples = vec![0; length];
    let frame = reader.next_frame(&mut samples).map_err(damaged)?;
    samples.truncate(frame.buffer_size());
    let channels = frame.color_type.samples();
    let samples = match frame.bit_depth {
        BitDepth::Sixteen => {
            let codes: Vec<u16> =
                samples.as_chunks().0.iter().map(|bytes| u16::from_be_bytes(*bytes)).collect();
            Samples::Short(codes.chunks_exact(channels).map(|pixel| rgba(pixel, u16::MAX)).collect())
        }
        _ => Samples::Byte(samples.chunks_exact(channels).map(|pixel| rgba(pixel, u8::MAX)).collect()),
    };
    // Chunks behind the pixels are read, too: an eXIf may stand there
    reader.finish().map_err(damaged)?;
    let info = reader.info();
    let orientation = info.exif_metadata.as_ref().map_or(1, |exif| Exif::parse(exif).orientation);
    let is_gray = channels < 3;
    Ok(Picture { size, samples, is_gray, stated: stated(source, info)?, orientation })
}

/// Grey, grey and alpha, RGB or RGBA to RGBA.
pub(super) fn rgba<T: Copy>(pixel: &[T], opaque: T) -> [T; 4] {
    match *pixel {
        [grey] => [grey, grey, grey, opaque],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, opaque],
        [r, g, b, a, ..] => [r, g, b, a],
        [] => [opaque; 4],
    }
}

/// What the first of cICP, iCCP, sRGB, and gAMA with cHRM states (PNG, third edition, section 4.3).
fn stated(source: &ImageBytes<'_>, info: &Info<'_>) -> Result<Option<Stated>, translucid_scene::SceneError> {
    let points = info.coding_independent_code_points;
    // Both unspecified: as if it were not there
    if let Some(points) = points.filter(|points| [points.color_primaries, points.transfer_function] != [2; 2])
    {
        return match coded(points, info) {
            Ok(stated) => Ok(Some(stated)),
            Err(what) => Err(source
                .error(format!("the PNG's colors are {what}, which cannot be read"))
                .with_help("save it as a PNG with an ICC profile, or as linear OpenEXR")),
        };
    }
    if let Some(profile) = &info.icc_profile {
        return Ok(Some(Stated::Icc(profile.to_vec())));
    }
    if info.srgb.is_some() {
        return Ok(Some(Stated::encoding(Encoding::new("sRGB", Curve::Srgb, REC_709))));
    }
    if info.chrm_chunk.is_none() && info.gama_chunk.is_none() {
        return Ok(None);
    }
    let both = gamma(info).and_then(|curve| Ok((curve, chromaticities(info)?)));
    Ok(Some(match both {
        Ok((curve, primaries)) => Stated::encoding(Encoding::new("gAMA and cHRM", curve, primaries)),
        Err(words) => Stated::Unknown(words),
    }))
}

/// The curve of gAMA, that of sRGB if there is none.
fn gamma(info: &Info<'_>) -> Result<Curve, String> {
    Ok(match info.gama_chunk.map(|gamma| f64::from(gamma.into_value())) {
        Some(exponent) if exponent <= 0.0 => return Err(format!("its gAMA is {exponent}")),
        Some(1.0) => Curve::Linear,
        // Who writes the nearest exponent to sRGB means sRGB, as libpng and browsers take it
        Some(exponent) if (exponent - 0.45455).abs() > 1e-3 => Curve::Power(exponent.recip()),
        _ => Curve::Srgb,
    })
}

/// The primaries of cHRM, those of Rec. 709 if there is none.
fn chromaticities(info: &Info<'_>) -> Result<Primaries, String> {
    let Some(chunk) = info.chrm_chunk else { return Ok(REC_709) };
    let point = |(x, y): (png::ScaledFloat, png::ScaledFloat)| [x, y].map(|v| f64::from(v.into_value()));
    let primaries = Primaries([chunk.red, chunk.green, chunk.blue, chunk.white].map(point));
    let is_usable = primaries.to_rec_709().is_finite();
    is_usable.then_some(primaries).ok_or_else(|| String::from("its cHRM are no primaries"))
}

/// Code points of ITU-T H.273, or what they stand for where it cannot be read; gAMA and cHRM count for what is unspecified.
fn coded(points: CodingIndependentCodePoints, info: &Info<'_>) -> Result<Stated, String> {
    let CodingIndependentCodePoints { color_primaries, transfer_function, matrix_coefficients, .. } = points;
    let (primaries, name) = match color_primaries {
        1 => (REC_709, "Rec. 709"),
        2 => (chromaticities(info)?, "primaries of cHRM"),
        9 => (REC_2020, "Rec. 2020"),
        11 => (Primaries([[0.68, 0.32], [0.265, 0.69], [0.15, 0.06], [0.314, 0.351]]), "DCI-P3"),
        12 => (DISPLAY_P3, "Display P3"),
        other => return Err(format!("of the primaries {other} of cICP")),
    };
    let (curve, curve_name) = match transfer_function {
        2 => (gamma(info)?, "the curve of gAMA"),
        1 | 6 | 14 | 15 => (Curve::Rec709, "the curve of Rec. 709"),
        4 => (Curve::Power(2.2), "gamma 2.2"),
        5 => (Curve::Power(2.8), "gamma 2.8"),
        8 => (Curve::Linear, "linear"),
        13 => (Curve::Srgb, "the curve of sRGB"),
        16 => return Err("coded by PQ".into()),
        18 => return Err("coded by HLG".into()),
        other => return Err(format!("of the transfer function {other} of cICP")),
    };
    if matrix_coefficients != 0 || !points.is_video_full_range_image {
        return Err("of a video's narrow range or matrix".into());
    }
    let encoding = Encoding::new(format!("{name}, {curve_name}"), curve, primaries);
    let open = match (color_primaries, transfer_function) {
        (2, _) if info.chrm_chunk.is_some() => "primaries open: those of its cHRM count",
        (2, _) => "primaries open: they are taken as those of Rec. 709",
        (_, 2) if info.gama_chunk.is_some() => "curve open: that of its gAMA counts",
        (_, 2) => "curve open: it is taken as that of sRGB",
        _ => return Ok(Stated::encoding(encoding)),
    };
    Ok(Stated::Partly(Box::new(encoding), format!("its cICP leaves the {open}")))
}

/// A small valid file.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 9, 7);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(BitDepth::Sixteen);
    let data: Vec<u8> = (0..9 * 7 * 8).map(|i| (i * 37 % 251) as u8).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&data)).expect("a valid image");
    bytes
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use translucid_scene::{ColorSpace, Image, Pixels, Place};

    use png::ColorType;

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

    fn decoded(bytes: &[u8], color_space: ColorSpace) -> Result<Image> {
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
