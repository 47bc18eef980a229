//! TIFF images.

mod pages;

use std::borrow::Cow;
use std::io::Cursor;

use tiff::TiffError;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use translucid_scene::Warning;

use super::encoding::{Curve, Encoding, Samples};
use super::file_bytes::ImageBytes;
use super::other_formats;
use super::png::rgba;
use super::tags::{Directory, Exif, ExifColor, TagFile};
use super::{Decoded, Picture, Stated};
use crate::primaries::{ADOBE_RGB, Primaries};
use crate::result::Result;
use pages::Pages;

/// Tags of TIFF 6.0.
mod tag {
    pub(super) const NEW_SUBFILE_TYPE: u16 = 254;
    pub(super) const WIDTH: u16 = 256;
    pub(super) const HEIGHT: u16 = 257;
    pub(super) const BITS: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const PHOTOMETRIC: u16 = 262;
    pub(super) const DESCRIPTION: u16 = 270;
    pub(super) const SAMPLES: u16 = 277;
    pub(super) const PLANES: u16 = 284;
    pub(super) const TRANSFER_FUNCTION: u16 = 301;
    pub(super) const WHITE_POINT: u16 = 318;
    pub(super) const PRIMARIES: u16 = 319;
    pub(super) const COLOR_MAP: u16 = 320;
    pub(super) const COEFFICIENTS: u16 = 529;
    pub(super) const SUBSAMPLING: u16 = 530;
    pub(super) const ICC_PROFILE: u16 = 34675;
}

/// Decodes the picture of a file: gray, RGB, YCbCr or a palette, with or without alpha, interleaved or in planes.
///
/// 8 bits a channel or less become bytes, 16 bits stay, and floats are as they are.
pub(super) fn decode(source: &ImageBytes<'_>, warnings: &mut Vec<Warning>) -> Decoded {
    let file = TagFile::open(source.bytes);
    let directories = file.map(TagFile::pages).unwrap_or_default();
    let (Some(file), Some(first)) = (file, directories.first()) else {
        return Err(source.error("damaged TIFF: it has no image"));
    };
    if let Some(format) = other_formats::raw_in_tiff(source.bytes, &directories) {
        return Err(other_formats::raw(source, format));
    }
    let pages =
        Pages::choose(&directories).map_err(|(message, help)| source.error(message).with_help(help))?;
    if let Some(message) = pages.doubt {
        warnings.push(Warning { message, place: Some(source.place.clone()) });
    }
    let mut planes = pages.pages.iter().map(|page| decode_page(source, file, page));
    let Some(mut picture) = planes.next().transpose()? else {
        return Err(source.error("damaged TIFF: it has no image"));
    };
    for (channel, plane) in planes.enumerate() {
        set_channel(&mut picture.samples, channel + 1, &plane?.samples);
        picture.is_gray = false;
    }
    let page = pages.pages.first().unwrap_or(first);
    let exif = Exif::of(page);
    picture.orientation = exif.orientation;
    picture.stated = stated(page, exif, matches!(picture.samples, Samples::Float(_)));
    Ok(picture)
}

/// Takes a channel from the red of another picture of the same size and kind.
fn set_channel(samples: &mut Samples, channel: usize, from: &Samples) {
    fn set<T: Copy>(pixels: &mut [[T; 4]], channel: usize, from: &[[T; 4]]) {
        for (pixel, from) in pixels.iter_mut().zip(from) {
            pixel[channel] = from[0];
        }
    }
    match (samples, from) {
        (Samples::Byte(pixels), Samples::Byte(from)) => set(pixels, channel, from),
        (Samples::Short(pixels), Samples::Short(from)) => set(pixels, channel, from),
        (Samples::Float(pixels), Samples::Float(from)) => set(pixels, channel, from),
        _ => {}
    }
}

/// What a page states of its colors.
fn stated(page: &Directory<'_>, exif: Exif, is_float: bool) -> Option<Stated> {
    let profile = page.bytes(tag::ICC_PROFILE);
    if !profile.is_empty() {
        return Some(Stated::Icc(profile.to_vec()));
    }
    if page.has(tag::TRANSFER_FUNCTION) {
        return Some(Stated::Unknown("its TransferFunction is left out".into()));
    }
    let curve = if is_float { Curve::Linear } else { Curve::Srgb };
    if let (&[a, b, c, d, e, f, ..], &[x, y, ..]) =
        (&page.fractions(tag::PRIMARIES)[..], &page.fractions(tag::WHITE_POINT)[..])
    {
        let primaries = Primaries([[a, b], [c, d], [e, f], [x, y]]);
        let is_sound = primaries.to_rec_709().is_finite();
        return Some(match is_sound {
            true => Stated::encoding(Encoding::new("PrimaryChromaticities", curve, primaries)),
            false => Stated::Unknown("its PrimaryChromaticities are no primaries".into()),
        });
    }
    match exif.color? {
        ExifColor::AdobeRgb => {
            let curve = Curve::Power(563.0 / 256.0);
            Some(Stated::encoding(Encoding::new("Adobe RGB, by EXIF", curve, ADOBE_RGB)))
        }
        ExifColor::Uncalibrated => None,
    }
}

/// A page in the words of messages, where it is valid but cannot be read.
fn unread(page: &Directory<'_>) -> Option<String> {
    let compression = page.number(tag::COMPRESSION).unwrap_or(1);
    let name = match compression {
        1 | 5 | 7 | 8 | 32773 | 32946 => None,
        2..=4 => Some("fax (CCITT)"),
        6 => Some("JPEG of TIFF's old kind"),
        34676 | 34677 => Some("SGI LogLuv"),
        34712 | 33003 | 33005 => Some("JPEG 2000"),
        34887 => Some("LERC"),
        34925 => Some("LZMA"),
        34926 | 50000 => Some("ZSTD"),
        34927 | 50001 => Some("WebP"),
        50002 | 52546 => Some("JPEG XL"),
        22610 | 34933 | 34934 => Some("JPEG XR"),
        other => return Some(format!("is a TIFF compressed by method {other}")),
    };
    if let Some(name) = name {
        return Some(format!("is a TIFF compressed with {name}"));
    }
    let bits = page.numbers(tag::BITS);
    let is_subsampled = page.numbers(tag::SUBSAMPLING) != [1, 1];
    let colors = match page.number(tag::PHOTOMETRIC) {
        Some(0..=3) | None => None,
        Some(4) => Some("of a mask"),
        Some(5) => Some("of inks (CMYK)"),
        Some(6) if compression != 7 && is_subsampled => Some("of subsampled YCbCr"),
        Some(6) if page.number(tag::PLANES) == Some(2) => Some("of YCbCr in planes"),
        Some(6) => None,
        Some(8..=10) => Some("of L*a*b* colors"),
        Some(32844 | 32845) => Some("of LogLuv colors"),
        Some(_) => Some("of unknown colors"),
    };
    if let Some(colors) = colors {
        return Some(format!("is a TIFF {colors}"));
    }
    let is_deep = page.numbers(tag::SAMPLES).first().is_some_and(|samples| *samples > 1);
    match bits.first().copied().unwrap_or(1) {
        1 | 2 | 4 if !is_deep => None,
        8 | 16 | 32 | 64 => None,
        other => Some(format!("is a TIFF of {other} bits a channel")),
    }
}

fn decode_page(source: &ImageBytes<'_>, file: TagFile<'_>, page: &Directory<'_>) -> Decoded {
    if let Some(what) = unread(page) {
        return Err(source.error(format!("{what}, which cannot be read")).with_help(
            "save it as TIFF of 8 or 16 bits or floats a channel, gray or RGB, uncompressed or with deflate or LZW",
        ));
    }
    let size = [tag::WIDTH, tag::HEIGHT].map(|tag| page.number(tag).unwrap_or_default());
    source.check_size(size[0], size[1])?;
    let photometric = page.number(tag::PHOTOMETRIC);
    // The decoder takes no palettes, but gray, which the numbers of a palette are in all but meaning
    let is_palette = photometric == Some(3);
    let change = page.place(tag::PHOTOMETRIC).filter(|_| is_palette).map(|place| (place, 1));
    let bytes = Cow::<[u8]>::Owned(file.beginning_with(page, change));
    let planes = if page.number(tag::PLANES) == Some(2) { page.number(tag::SAMPLES).unwrap_or(1) } else { 1 };
    let mut read = read_planes(source, &bytes, size, planes.min(4))?.into_iter();
    let first = read.next().ok_or_else(|| source.error("damaged TIFF: pixels are missing"))?;
    let mut samples = match is_palette {
        true => {
            colors_of(&first, page).ok_or_else(|| source.error("damaged TIFF: its palette is too short"))?
        }
        false => samples_of(source, first, page, size)?,
    };
    let is_in_color = photometric == Some(2);
    for (channel, plane) in (1..).zip(read).filter(|_| is_in_color) {
        set_channel(&mut samples, channel, &samples_of(source, plane, page, size)?);
    }
    let is_gray = matches!(photometric, Some(0 | 1) | None);
    Ok(Picture { is_gray, ..Picture::plain(size, samples) })
}

/// The numbers of a page as a whole, or of each of several planes.
fn read_planes(
    source: &ImageBytes<'_>,
    bytes: &[u8],
    size: [usize; 2],
    planes: usize,
) -> Result<Vec<DecodingResult>> {
    let failed = |error: TiffError| match error {
        TiffError::UnsupportedError(what) => {
            let error = source.error(format!("is a TIFF of a kind that cannot be read: {what}"));
            error.with_help("save it as TIFF of 8 or 16 bits or floats a channel, gray or RGB")
        }
        other => source.error(format!("damaged TIFF: {other}")),
    };
    // As much as such an image needs, and some for what is packed
    let mut limits = Limits::default();
    limits.decoding_buffer_size = 64 * size[0] * size[1];
    limits.intermediate_buffer_size = 64 * size[0] * size[1] + (1 << 20);
    let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(failed)?.with_limits(limits);
    let read = |plane| match planes {
        1 => decoder.read_image(),
        _ => read_plane(&mut decoder, size, plane),
    };
    (0..planes).map(read).collect::<Result<_, _>>().map_err(failed)
}

/// The numbers of a plane, chunk by chunk: the decoder's own way to read all planes fails with tiles that end beyond the picture.
fn read_plane(
    decoder: &mut Decoder<Cursor<&[u8]>>,
    [width, height]: [usize; 2],
    plane: usize,
) -> Result<DecodingResult, TiffError> {
    let chunk = <[u32; 2]>::from(decoder.chunk_dimensions()).map(|edge| (edge as usize).max(1));
    let [across, down] = [width.div_ceil(chunk[0]), height.div_ceil(chunk[1])];
    let mut whole: Option<DecodingResult> = None;
    for i in 0..across * down {
        let index = (plane * across * down + i) as u32;
        let [chunk_width, chunk_height] =
            <[u32; 2]>::from(decoder.chunk_data_dimensions(index)).map(|edge| edge as usize);
        let mut read = decoder.read_chunk(index)?;
        let whole = whole.get_or_insert_with(|| zeros_like(&read, width * height));
        let (buffer, mut read) = (read.as_buffer(0), whole.as_buffer(0));
        let (from, into) = (buffer.as_bytes(), read.as_bytes_mut());
        let sample = into.len() / (width * height);
        let [x, y] = [i % across * chunk[0], i / across * chunk[1]];
        let used = sample * chunk_width.min(width - x);
        for (row, from) in from.chunks_exact((sample * chunk_width).max(1)).take(chunk_height).enumerate() {
            let start = ((y + row) * width + x) * sample;
            if let (true, Some(into)) = (y + row < height, into.get_mut(start..start + used)) {
                into.copy_from_slice(&from[..used]);
            }
        }
    }
    whole.ok_or(TiffError::LimitsExceeded)
}

/// So many zeros of the same kind.
fn zeros_like(numbers: &DecodingResult, count: usize) -> DecodingResult {
    match numbers {
        DecodingResult::U16(_) => DecodingResult::U16(vec![0; count]),
        DecodingResult::F16(_) => DecodingResult::F16(vec![Default::default(); count]),
        DecodingResult::F32(_) => DecodingResult::F32(vec![0.0; count]),
        DecodingResult::F64(_) => DecodingResult::F64(vec![0.0; count]),
        DecodingResult::U8(_) => DecodingResult::U8(vec![0; count]),
        // Refused later, whatever they are
        _ => DecodingResult::I64(vec![0; count]),
    }
}

/// Pixels of a page that is no palette.
fn samples_of(
    source: &ImageBytes<'_>,
    samples: DecodingResult,
    page: &Directory<'_>,
    size: [usize; 2],
) -> Result<Samples> {
    let samples = match samples {
        DecodingResult::U8(samples) if page.number(tag::PHOTOMETRIC) == Some(6) => {
            let pixels = pixels(&samples, page, size, 255);
            pixels.map(|pixels| Samples::Byte(rgb_of_ycbcr(pixels, page)))
        }
        DecodingResult::U8(samples) => {
            pixels(&unpacked(samples, page, size, true), page, size, 255).map(Samples::Byte)
        }
        DecodingResult::U16(samples) => pixels(&samples, page, size, u16::MAX).map(Samples::Short),
        DecodingResult::F16(samples) => {
            let samples: Vec<f32> = samples.into_iter().map(Into::into).collect();
            pixels(&samples, page, size, 1.0).map(Samples::Float)
        }
        DecodingResult::F32(samples) => pixels(&samples, page, size, 1.0).map(Samples::Float),
        DecodingResult::F64(samples) => {
            let samples: Vec<f32> = samples.into_iter().map(|value| value as f32).collect();
            pixels(&samples, page, size, 1.0).map(Samples::Float)
        }
        _ => {
            let error = source.error("is a TIFF of signed or long integers, which cannot be read");
            return Err(error.with_help("channels of 8 or 16 bits without sign and floats can be read"));
        }
    };
    samples.ok_or_else(|| source.error("damaged TIFF: pixels are missing"))
}

/// Pixels of as many channels as the page has, or of one plane; `None` where there are not so many.
fn pixels<T: Copy>(samples: &[T], page: &Directory<'_>, size: [usize; 2], opaque: T) -> Option<Vec<[T; 4]>> {
    let count = size[0] * size[1];
    let channels = samples.len() / count;
    if channels == 0 || samples.len() != channels * count {
        return None;
    }
    // Beside gray only an alpha counts, beside RGB the first of what else there is
    let most = if matches!(page.number(tag::PHOTOMETRIC), Some(0 | 1) | None) { 2 } else { 4 };
    let used = channels.min(most);
    Some(samples.chunks_exact(channels).map(|pixel| rgba(&pixel[..used], opaque)).collect())
}

/// Numbers of 1, 2 or 4 bits as bytes of their own, for light with the greatest at 255.
fn unpacked(samples: Vec<u8>, page: &Directory<'_>, size: [usize; 2], is_light: bool) -> Vec<u8> {
    let bits = page.number(tag::BITS).unwrap_or(1);
    if !matches!(bits, 1 | 2 | 4) {
        return samples;
    }
    let greatest = (1_u8 << bits) - 1;
    let scale = if is_light { 255 / greatest } else { 1 };
    let row = |row: &[u8]| {
        let number = |i: usize| (row[i * bits / 8] >> (8 - bits - i * bits % 8)) & greatest;
        (0..size[0]).map(|i| scale * number(i)).collect::<Vec<u8>>()
    };
    samples.chunks_exact((size[0] * bits).div_ceil(8)).flat_map(row).collect()
}

/// The colors of a palette.
fn colors_of(numbers: &DecodingResult, page: &Directory<'_>) -> Option<Samples> {
    let size = [tag::WIDTH, tag::HEIGHT].map(|tag| page.number(tag).unwrap_or_default());
    let numbers: Vec<usize> = match numbers {
        DecodingResult::U8(numbers) => {
            unpacked(numbers.clone(), page, size, false).into_iter().map(usize::from).collect()
        }
        DecodingResult::U16(numbers) => numbers.iter().copied().map(usize::from).collect(),
        _ => return None,
    };
    let map = page.numbers(tag::COLOR_MAP);
    let length = map.len() / 3;
    let color = |i: usize| (i < length).then(|| [map[i], map[length + i], map[2 * length + i]]);
    // Some programs write bytes where TIFF has 16 bits
    let is_of_bytes = map.iter().all(|value| *value < 256);
    if is_of_bytes || map.iter().all(|value| value % 257 == 0) {
        let byte = |value: usize| (if is_of_bytes { value } else { value / 257 }) as u8;
        let pixel = |i| color(i).map(|[r, g, b]| [byte(r), byte(g), byte(b), 255]);
        return numbers.into_iter().map(pixel).collect::<Option<_>>().map(Samples::Byte);
    }
    let pixel = |i| color(i).map(|[r, g, b]| [r as u16, g as u16, b as u16, u16::MAX]);
    numbers.into_iter().map(pixel).collect::<Option<_>>().map(Samples::Short)
}

/// Red, green and blue of luma and color differences of full range (TIFF 6.0, section 21).
fn rgb_of_ycbcr(pixels: Vec<[u8; 4]>, page: &Directory<'_>) -> Vec<[u8; 4]> {
    let coefficients = page.fractions(tag::COEFFICIENTS);
    let [red, green, blue] = coefficients.try_into().unwrap_or([0.299, 0.587, 0.114]);
    let byte = |value: f64| value.round().clamp(0.0, 255.0) as u8;
    let rgb = |[y, cb, cr, alpha]: [u8; 4]| {
        let [y, cb, cr] = [f64::from(y), f64::from(cb) - 128.0, f64::from(cr) - 128.0];
        let r = y + (2.0 - 2.0 * red) * cr;
        let b = y + (2.0 - 2.0 * blue) * cb;
        [byte(r), byte((y - red * r - blue * b) / green), byte(b), alpha]
    };
    pixels.into_iter().map(rgb).collect()
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
    use translucid_scene::{ColorSpace, Image, Place};

    use super::*;
    use crate::decode_image;

    fn decoded(bytes: &[u8], color_space: ColorSpace) -> Result<Image> {
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

    type Tags = Vec<(u16, u16, Vec<u32>)>;

    /// A little-endian file of pages of gray or RGB, each with its own tags and its strips.
    fn written(pages: &[(Tags, Vec<Vec<u8>>)]) -> Vec<u8> {
        let mut bytes = b"II*\0\0\0\0\0".to_vec();
        let mut link = 4;
        for (tags, chunks) in pages {
            let is_tiled = tags.iter().any(|tag| tag.0 == 322);
            let mut tags = tags.clone();
            let mut offsets = Vec::new();
            for chunk in chunks {
                offsets.push(bytes.len() as u32);
                bytes.extend(chunk);
            }
            tags.push((if is_tiled { 324 } else { 273 }, 4, offsets));
            tags.push((if is_tiled { 325 } else { 279 }, 4, chunks.iter().map(|c| c.len() as u32).collect()));
            tags.sort();
            let mut entries = (tags.len() as u16).to_le_bytes().to_vec();
            for (tag, kind, values) in tags {
                let value = |v: &u32| match kind {
                    2 => vec![*v as u8],
                    3 => (*v as u16).to_le_bytes().to_vec(),
                    _ => v.to_le_bytes().to_vec(),
                };
                let mut data: Vec<u8> = values.iter().flat_map(value).collect();
                entries.extend(tag.to_le_bytes());
                entries.extend(kind.to_le_bytes());
                entries.extend((values.len() as u32).to_le_bytes());
                if data.len() > 4 {
                    entries.extend((bytes.len() as u32).to_le_bytes());
                    bytes.extend(data);
                } else {
                    data.resize(4, 0);
                    entries.extend(data);
                }
            }
            let start = (bytes.len() as u32).to_le_bytes();
            bytes[link..link + 4].copy_from_slice(&start);
            bytes.extend(entries);
            link = bytes.len();
            bytes.extend([0; 4]);
        }
        bytes
    }

    /// Tags of a page of 3 × 2 pixels of 16 bits.
    fn tags(samples: u32, photometric: u32, more: &[(u16, u16, Vec<u32>)]) -> Tags {
        let mut tags = vec![
            (256, 3, vec![3]),
            (257, 3, vec![2]),
            (258, 3, vec![16; samples as usize]),
            (262, 3, vec![photometric]),
            (277, 3, vec![samples]),
        ];
        tags.extend_from_slice(more);
        tags
    }

    fn text(text: &str) -> Vec<u32> {
        text.bytes().chain([0]).map(u32::from).collect()
    }

    /// Six numbers of 16 bits.
    fn strip(first: u16) -> Vec<u8> {
        (0..6).flat_map(|i| (first + i).to_le_bytes()).collect()
    }

    fn codes(image: &Image, x: u32, y: u32) -> [u32; 3] {
        let [r, g, b, _] = image.texel(x, y);
        [r, g, b].map(|value| (value * 65535.0).round() as u32)
    }

    #[test]
    fn tiff_of_a_page_for_each_channel_is_read_in_color() {
        let page =
            |description: &str, first: u16| (tags(1, 1, &[(270, 2, text(description))]), vec![strip(first)]);
        let of = |description: &str| written(&[page(description, 100), page("", 200), page("", 300)]);
        let color = decoded(&of("ImageJ=1.53t\nimages=3\nchannels=3\nmode=composite\n"), ColorSpace::Linear);
        assert_eq!(codes(&color.unwrap(), 1, 1), [104, 204, 304]);
        for (description, part) in [
            ("ImageJ=1.53t\nimages=3\nslices=3\n", "has 3 gray pages of one size"),
            ("{\"shape\": [3, 2, 3]}", "has 3 gray pages of one size"),
            ("ImageJ=1.53t\nimages=9\nchannels=3\n", "is a stack of 9 images by ImageJ"),
        ] {
            let message = decoded(&of(description), ColorSpace::Linear).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn tiff_of_more_pages_says_which_is_read() {
        let color = |first| (tags(3, 2, &[]), vec![[strip(first), strip(first), strip(first)].concat()]);
        let mut thumbnail = color(900);
        thumbnail.0.push((254, 4, vec![1]));
        let read = |pages: &[(Tags, Vec<Vec<u8>>)]| {
            let mut warnings = Vec::new();
            let place = Place::file(Path::new("a.tif"));
            let image = decode_image(&place, &written(pages), ColorSpace::Linear, &mut warnings).unwrap();
            (codes(&image, 0, 0)[0], warnings.first().map(ToString::to_string))
        };
        assert_eq!(read(&[thumbnail.clone(), color(100)]), (100, None));
        let said = "a.tif: the first of its 2 pages is read, the others are left out";
        assert_eq!(read(&[color(100), thumbnail, color(200)]), (100, Some(said.to_owned())));
    }

    #[test]
    fn tiff_in_planes_is_read_in_strips_and_tiles() {
        let planar = (284, 3, vec![2]);
        let strips =
            written(&[(tags(3, 2, std::slice::from_ref(&planar)), [100, 200, 300].map(strip).to_vec())]);
        assert_eq!(codes(&decoded(&strips, ColorSpace::Linear).unwrap(), 2, 1), [105, 205, 305]);
        // Tiles of 16 × 16 end far beyond the picture
        let tile = |first: u16| -> Vec<u8> {
            let number = |i: u16| if i % 16 < 3 && i < 32 { first + i / 16 * 3 + i % 16 } else { 0 };
            (0..256).flat_map(|i| number(i).to_le_bytes()).collect()
        };
        let tiled = tags(3, 2, &[planar, (322, 3, vec![16]), (323, 3, vec![16])]);
        let tiled = written(&[(tiled, [100, 200, 300].map(tile).to_vec())]);
        let image = decoded(&tiled, ColorSpace::Linear).unwrap();
        assert_eq!([codes(&image, 0, 0), codes(&image, 2, 1)], [[100, 200, 300], [105, 205, 305]]);
        for file in [strips, tiled] {
            for mutant in translucid_testing::mutants(&file, 1_000) {
                let _ = decoded(&mutant, ColorSpace::Linear);
            }
        }
    }

    #[test]
    fn tiff_of_a_palette_few_bits_and_white_at_zero_is_read() {
        let small = |photometric: u32, bits: u32, more: Tags| {
            let mut tags = tags(1, photometric, &more);
            tags.retain(|tag| tag.0 != 258);
            tags.push((258, 3, vec![bits]));
            tags
        };
        let map = (320, 3, [[0, 65535, 0, 0], [0, 0, 25700, 0], [0, 0, 0, 12850]].concat());
        let palette = written(&[(small(3, 2, vec![map]), vec![vec![0b0110_1100, 0b0000_0000]])]);
        let image = decoded(&palette, ColorSpace::Linear).unwrap();
        assert_eq!([codes(&image, 0, 0), codes(&image, 2, 0)], [[65535, 0, 0], [0, 0, 12850]]);
        let bits = written(&[(small(1, 1, vec![]), vec![vec![0b1010_0000, 0b0100_0000]])]);
        let image = decoded(&bits, ColorSpace::Linear).unwrap();
        assert_eq!(
            [codes(&image, 2, 0), codes(&image, 1, 0), codes(&image, 1, 1)],
            [[65535; 3], [0; 3], [65535; 3]]
        );
        let white = written(&[(tags(1, 0, &[]), vec![strip(100)])]);
        assert_eq!(codes(&decoded(&white, ColorSpace::Linear).unwrap(), 0, 0), [65435; 3]);
        let turned = written(&[(tags(1, 1, &[(274, 3, vec![8])]), vec![strip(100)])]);
        let image = decoded(&turned, ColorSpace::Linear).unwrap();
        assert_eq!(([image.width, image.height], codes(&image, 0, 0)), ([2, 3], [102; 3]));
    }

    #[test]
    fn tiff_of_64_bit_offsets_is_read() {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = tiff::encoder::TiffEncoder::new_big(&mut bytes).unwrap();
        encoder.write_image::<RGBA16>(1, 1, &[100, 200, 300, 65535]).unwrap();
        let image = decoded(&bytes.into_inner(), ColorSpace::Linear).unwrap();
        assert_eq!(codes(&image, 0, 0), [100, 200, 300]);
    }

    #[test]
    fn tiff_that_is_whole_but_not_read_is_called_by_name() {
        let refused = |photometric: u32, more: &[(u16, u16, Vec<u32>)]| {
            let file = written(&[(tags(1, photometric, more), vec![strip(0)])]);
            decoded(&file, ColorSpace::Srgb).unwrap_err().to_string()
        };
        for (code, name) in [
            (50000, "ZSTD"),
            (34925, "LZMA"),
            (50002, "JPEG XL"),
            (50001, "WebP"),
            (4, "fax (CCITT)"),
            (9999, "method 9999"),
        ] {
            let message = refused(1, &[(259, 3, vec![code])]);
            assert!(message.contains(name) && !message.contains("damaged"), "{message}");
        }
        assert!(refused(8, &[]).contains("L*a*b*"));
        let dng = refused(32803, &[(50706, 1, vec![1, 4, 0, 0])]);
        assert!(dng.contains("is a camera's raw file (DNG)"), "{dng}");
        let nef = refused(32803, &[(271, 2, text("NIKON CORPORATION"))]);
        assert!(nef.contains("is a camera's raw file (NEF)"), "{nef}");
    }
}
