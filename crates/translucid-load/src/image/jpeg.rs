//! JPEG images.

use translucid_scene::Warning;
use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace as Layout;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::encoding::{Curve, Encoding, Samples};
use super::file_bytes::ImageBytes;
use super::tags::{Exif, ExifColor};
use super::{Decoded, Picture, Stated};
use crate::primaries::ADOBE_RGB;

/// Decodes grey, YCbCr, CMYK and YCCK images to RGB.
///
/// A file with damaged or missing data is decoded as far as it goes, with a warning.
pub(super) fn decode(source: &ImageBytes<'_>, warnings: &mut Vec<Warning>) -> Decoded {
    let damaged = |error: &DecodeErrors| source.error(format!("damaged JPEG: {}", error.to_string().trim()));
    if let Some(kind) = unread_kind(source.bytes) {
        let error = source.error(format!("is a JPEG of {kind}, which cannot be read"));
        return Err(error.with_help("save it as baseline JPEG, PNG or TIFF"));
    }
    let options = DecoderOptions::default()
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        .jpeg_set_out_colorspace(Layout::RGB);
    let decoder = |options| JpegDecoder::new_with_options(ZCursor::new(source.bytes), options);

    let mut header = decoder(options);
    header.decode_headers().map_err(|error| damaged(&error))?;
    let info = header.info().ok_or_else(|| source.error("damaged JPEG: no image"))?;
    let size = [info.width, info.height].map(usize::from);
    let count = source.check_size(size[0], size[1])?;

    let mut fault = lacks_end(source.bytes).then(|| String::from("its end is missing"));
    let samples = match decoder(options.set_strict_mode(true)).decode() {
        Ok(samples) => samples,
        Err(error) => {
            fault = Some(error.to_string());
            decoder(options).decode().map_err(|error| damaged(&error))?
        }
    };
    if let Some(fault) = fault {
        let message = format!("damaged JPEG, read as far as it goes: {}", fault.trim());
        warnings.push(Warning { message, place: Some(source.place.clone()) });
    }
    if samples.len() != 3 * count {
        return Err(source.error(format!("damaged JPEG: {} samples for {count} pixels", samples.len())));
    }
    if let Some(kind) = gain_map(source.bytes) {
        let message = format!(
            "has a gain map ({kind}), which is left out: its base picture is a rendition for displays, not light; save \
             the HDR picture as OpenEXR"
        );
        warnings.push(Warning { message, place: Some(source.place.clone()) });
    }
    let pixels = samples.chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2], 255]).collect();
    let exif = header.exif().map(|exif| Exif::parse(exif)).unwrap_or_default();
    let stated = match (header.icc_profile(), exif.color) {
        (Some(profile), _) => Some(Stated::Icc(profile)),
        (None, Some(ExifColor::AdobeRgb)) => {
            let encoding = Encoding::new("Adobe RGB, by EXIF", Curve::Power(563.0 / 256.0), ADOBE_RGB);
            Some(Stated::encoding(encoding))
        }
        (None, Some(ExifColor::Uncalibrated)) => {
            Some(Stated::Unknown("its EXIF states no color space, but \"uncalibrated\"".into()))
        }
        (None, None) => None,
    };
    let is_gray = header.input_colorspace() == Some(Layout::Luma);
    let orientation = exif.orientation;
    Ok(Picture { size, samples: Samples::Byte(pixels), is_gray, stated, orientation })
}

/// A kind of JPEG that is valid but not read, by the marker of its frame (ITU-T T.81, table B.1).
fn unread_kind(bytes: &[u8]) -> Option<&'static str> {
    let mut at = 2;
    loop {
        let &[0xff, marker, high, low, precision, ..] = bytes.get(at..)? else { return None };
        match marker {
            0xc0..=0xc2 if precision == 12 => return Some("12 bits a channel"),
            0xc0..=0xc2 | 0xda => return None,
            0xc3 => return Some("the lossless kind"),
            0xc5..=0xc7 => return Some("the hierarchical kind"),
            0xc9..=0xcb | 0xcd..=0xcf => return Some("arithmetic coding"),
            0xf7 => return Some("the kind JPEG-LS"),
            _ => at += 2 + usize::from(u16::from_be_bytes([high, low])).max(2),
        }
    }
}

/// The kind of a gain map by which the file makes an HDR picture of its base, if it has one.
fn gain_map(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 3] = [
        (b"urn:iso:std:iso:ts:21496:-1", "ISO 21496-1"),
        (b"http://ns.adobe.com/hdr-gain-map/", "Ultra HDR"),
        (b"urn:com:apple:photo:2020:aux:hdrgainmap", "Apple's"),
    ];
    let has = |name: &[u8]| bytes.windows(name.len()).any(|window| window == name);
    KINDS.into_iter().find(|(name, _)| has(name)).map(|(_, kind)| kind)
}

/// Whether no end marker follows the last scan; the decoder fills what is missing with grey.
fn lacks_end(bytes: &[u8]) -> bool {
    let last = |marker: [u8; 2]| bytes.windows(2).rposition(|pair| pair == marker);
    last([0xff, 0xd9]) < last([0xff, 0xda])
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use translucid_scene::{ColorSpace, Image, Place};

    use super::*;
    use crate::decode_image;
    use crate::result::Result;

    const COLOR: &[u8] = include_bytes!("../../tests/data/color.jpg");
    const PROGRESSIVE: &[u8] = include_bytes!("../../tests/data/progressive.jpg");
    const GREY: &[u8] = include_bytes!("../../tests/data/grey.jpg");
    const CMYK: &[u8] = include_bytes!("../../tests/data/cmyk.jpg");

    fn decoded(bytes: &[u8]) -> Result<(Image, Vec<Warning>)> {
        let mut warnings = Vec::new();
        let place = Place::file(Path::new("a.jpg"));
        let image = decode_image(&place, bytes, ColorSpace::Linear, &mut warnings)?;
        Ok((image, warnings))
    }

    /// Whether the left and right half have these colors up to JPEG's loss.
    fn assert_halves(bytes: &[u8], left: [u8; 3], right: [u8; 3]) {
        let (image, warnings) = decoded(bytes).unwrap();
        assert_eq!((image.width, image.height), (32, 16));
        assert!(warnings.is_empty(), "{warnings:?}");
        for (x, expected) in [(4, left), (28, right)] {
            let texel = image.texel(x, 8);
            for (value, expected) in texel.into_iter().zip(expected) {
                assert!((255.0 * value - f32::from(expected)).abs() < 4.0, "{texel:?} {expected:?}");
            }
            assert_eq!(texel[3], 1.0);
        }
    }

    #[test]
    fn jpeg_reads_color_grey_and_progressive() {
        assert_halves(COLOR, [200, 100, 50], [20, 40, 220]);
        assert_halves(PROGRESSIVE, [200, 100, 50], [20, 40, 220]);
        assert_halves(GREY, [30; 3], [220; 3]);
    }

    #[test]
    fn jpeg_of_inks_becomes_red_green_blue() {
        assert_halves(CMYK, [200, 100, 50], [0; 3]);
    }

    #[test]
    fn jpeg_with_a_gain_map_is_told_to_be_a_rendition() {
        for (name, kind) in [
            ("urn:iso:std:iso:ts:21496:-1\0\0\0", "ISO 21496-1"),
            ("<rdf xmlns:hdrgm=\"http://ns.adobe.com/hdr-gain-map/1.0/\"/>", "Ultra HDR"),
            ("<apdi>urn:com:apple:photo:2020:aux:hdrgainmap</apdi>", "Apple's"),
        ] {
            let length = u16::try_from(name.len() + 2).unwrap().to_be_bytes();
            let segment = [&[0xff, 0xe2], &length[..], name.as_bytes()].concat();
            // In the base's header, or in that of the map behind it
            for file in [
                [&COLOR[..2], &segment, &COLOR[2..]].concat(),
                [COLOR, &COLOR[..2], &segment, &COLOR[2..]].concat(),
            ] {
                let (image, warnings) = decoded(&file).unwrap();
                assert_eq!(image.texel(4, 8), decoded(COLOR).unwrap().0.texel(4, 8));
                assert!(warnings[0].message.contains(&format!("gain map ({kind})")), "{warnings:?}");
            }
        }
    }

    #[test]
    fn jpeg_of_a_kind_that_is_not_read_is_called_by_name() {
        let frame = COLOR.windows(2).position(|bytes| bytes == [0xff, 0xc0]).unwrap();
        let with = |at: usize, byte: u8| {
            let mut file = COLOR.to_vec();
            file[frame + at] = byte;
            decoded(&file).unwrap_err().to_string()
        };
        assert!(with(1, 0xc9).contains("is a JPEG of arithmetic coding"));
        assert!(with(1, 0xc3).contains("is a JPEG of the lossless kind"));
        assert!(with(4, 12).contains("is a JPEG of 12 bits a channel"));
    }

    #[test]
    fn jpeg_that_ends_early_is_never_read_in_silence() {
        for file in [COLOR, PROGRESSIVE, GREY, CMYK] {
            // Without the two bytes of the end marker the pixels are still complete.
            for length in 0..file.len() - 2 {
                match decoded(&file[..length]) {
                    Err(error) => assert!(error.to_string().starts_with("a.jpg: "), "{error}"),
                    Ok((image, warnings)) => {
                        assert_eq!((image.width, image.height), (32, 16));
                        assert_eq!(warnings.len(), 1, "{length} of {} bytes", file.len());
                    }
                }
            }
        }
    }

    #[test]
    fn jpeg_that_is_broken_is_refused_with_its_name() {
        let frame = COLOR.windows(2).position(|bytes| bytes == [0xff, 0xc0]).unwrap();
        let mut huge = COLOR.to_vec();
        huge[frame + 5..frame + 9].fill(0xff);
        let mut zero = COLOR.to_vec();
        zero[frame + 5..frame + 9].fill(0);
        for bytes in [&COLOR[..3], &COLOR[..50], &COLOR[..frame + 6], &huge, &zero] {
            let message = decoded(bytes).unwrap_err().to_string();
            assert!(message.starts_with("a.jpg: "), "{message}");
            assert!(message.contains("JPEG") || message.contains("too large"), "{message}");
        }
    }
}
