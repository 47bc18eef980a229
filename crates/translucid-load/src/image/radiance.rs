//! Radiance HDR images (G. Ward, "Real Pixels", Graphics Gems II, 1991).
//!
//! A text header, a line with the resolution, then pixels of three mantissas and a shared exponent,
//! flat or packed by runs: the old scheme repeats the pixel before, the new one packs each channel of a
//! scan line by itself.
//!
//! A reader of our own, since files with any of the eight orientations, flat pixels and old runs are read, runs must fit
//! their line, and a mantissa stands for the middle of its interval.

use translucid_scene::{SceneError, Warning};

use super::encoding::{Curve, Encoding, Samples};
use super::file_bytes::ImageBytes;
use super::{Decoded, Picture, Stated};
use crate::primaries::Primaries;
use crate::result::Result;

/// Three mantissas and the exponent.
type Rgbe = [u8; 4];

/// Widths for which a scan line may be packed by the new scheme.
const PACKABLE: std::ops::RangeInclusive<usize> = 8..=0x7fff;

/// Decodes all eight orientations, to radiances: stored values over all EXPOSURE and COLORCORR (Radiance, *File formats*).
pub(super) fn decode(source: &ImageBytes<'_>, warnings: &mut Vec<Warning>) -> Decoded {
    let mut reader = Reader { source, position: 0 };
    let Header { primaries, exposure } = reader.header(warnings)?;
    if exposure != [1.0; 3] {
        // Most other programs pass over them
        let factor =
            if exposure == [exposure[0]; 3] { format!("{}", exposure[0]) } else { format!("{exposure:?}") };
        let message =
            format!("its values are divided by {factor}, the EXPOSURE or COLORCORR that its header states");
        warnings.push(Warning { message, place: Some(source.place.clone()) });
    }
    let layout = reader.layout()?;
    source.check_size(layout.line_length, layout.lines)?;
    let [width, height] = if layout.by_columns {
        [layout.lines, layout.line_length]
    } else {
        [layout.line_length, layout.lines]
    };
    let mut pixels = vec![[0.0; 4]; width * height];
    let mut line = Vec::with_capacity(layout.line_length);
    for number in 0..layout.lines {
        reader.line(&mut line, layout.line_length, number)?;
        for (i, &pixel) in line.iter().enumerate() {
            let [x, y] = layout.place(number, i);
            pixels[y * width + x] = float_from_rgbe(pixel, exposure);
        }
    }
    let encoding = |primaries| Stated::encoding(Encoding::new("PRIMARIES", Curve::Linear, primaries));
    let picture = Picture::plain([width, height], Samples::Float(pixels));
    Ok(Picture { stated: primaries.map(encoding), ..picture })
}

/// Radiance's convention: the mantissa's middle, 0 for exponent 0, over the exposure.
fn float_from_rgbe([r, g, b, e]: Rgbe, exposure: [f64; 3]) -> [f32; 4] {
    if e == 0 {
        return [0.0, 0.0, 0.0, 1.0];
    }
    let scale = 2_f64.powi(i32::from(e) - 136);
    let light = |mantissa: u8, exposure: f64| ((f64::from(mantissa) + 0.5) * scale / exposure) as f32;
    let [r, g, b] = [light(r, exposure[0]), light(g, exposure[1]), light(b, exposure[2])];
    [r, g, b, 1.0]
}

/// Order of the pixels in the file.
struct Layout {
    /// Lines are columns of the image.
    by_columns: bool,
    lines: usize,
    line_length: usize,
    /// Lines go up or to the left.
    lines_reversed: bool,
    /// Pixels of a line go up or to the left.
    pixels_reversed: bool,
}

impl Layout {
    /// Column from the left and row from the top of a pixel.
    fn place(&self, line: usize, pixel: usize) -> [usize; 2] {
        let line = if self.lines_reversed { self.lines - 1 - line } else { line };
        let pixel = if self.pixels_reversed { self.line_length - 1 - pixel } else { pixel };
        if self.by_columns { [line, pixel] } else { [pixel, line] }
    }
}

/// The statements of a header.
struct Header {
    primaries: Option<Primaries>,
    /// Product of all factors that were applied to the radiance, a channel each.
    exposure: [f64; 3],
}

struct Reader<'a> {
    source: &'a ImageBytes<'a>,
    position: usize,
}

impl Reader<'_> {
    fn error(&self, message: impl std::fmt::Display) -> SceneError {
        self.source.error(format!("damaged Radiance HDR: {message}"))
    }

    /// The text up to the next line feed.
    fn text_line(&mut self) -> Result<String> {
        let rest = &self.source.bytes[self.position..];
        let length =
            rest.iter().position(|&byte| byte == b'\n').ok_or_else(|| self.error("the header has no end"))?;
        self.position += length + 1;
        Ok(String::from_utf8_lossy(&rest[..length]).trim_end().to_owned())
    }

    /// Reads up to the empty line. Indented lines are those of pictures that this one was made from.
    fn header(&mut self, warnings: &mut Vec<Warning>) -> Result<Header> {
        let (mut primaries, mut exposure) = (None, [1.0; 3]);
        loop {
            let line = self.text_line()?;
            if line.is_empty() {
                return Ok(Header { primaries, exposure });
            }
            let factors = line.strip_prefix("EXPOSURE=").map(|factor| vec![factor.trim(); 3]);
            let factors =
                factors.or_else(|| Some(line.strip_prefix("COLORCORR=")?.split_whitespace().collect()));
            if let Some(factors) = factors {
                let number = |word: &&str| word.parse().ok().filter(|f: &f64| (1e-30..1e30).contains(f));
                let factors: Option<Vec<f64>> = factors.iter().map(number).collect();
                let product = factors.and_then(|factors| <[f64; 3]>::try_from(factors).ok());
                let product = product.map(|[r, g, b]| [exposure[0] * r, exposure[1] * g, exposure[2] * b]);
                match product.filter(|product| product.iter().all(|f| (1e-30..1e30).contains(f))) {
                    Some(product) => exposure = product,
                    None => {
                        let message =
                            format!("\"{line}\" of its header is passed over: it states no factor above 0");
                        warnings.push(Warning { message, place: Some(self.source.place.clone()) });
                    }
                }
            }
            if let Some(numbers) = line.strip_prefix("PRIMARIES=") {
                let words: Vec<f64> =
                    numbers.split_whitespace().map_while(|word| word.parse().ok()).collect();
                // Some programs write zeros where they know of none
                if words == [0.0; 8] {
                    continue;
                }
                let stated = <[f64; 8]>::try_from(words).ok();
                let stated =
                    stated.map(|[a, b, c, d, e, f, g, h]| Primaries([[a, b], [c, d], [e, f], [g, h]]));
                let stated = stated.filter(|stated| stated.to_rec_709().is_finite());
                primaries =
                    Some(stated.ok_or_else(|| self.error(format!("\"{line}\" are no four chromaticities")))?);
            }
            if let Some(format) = line.strip_prefix("FORMAT=")
                && format.trim() != "32-bit_rle_rgbe"
            {
                let message =
                    format!("the Radiance HDR format is {format}, but only 32-bit_rle_rgbe can be read");
                return Err(self.source.error(message));
            }
        }
    }

    /// Parses the resolution line, "-Y height +X width" for the usual orientation.
    fn layout(&mut self) -> Result<Layout> {
        let line = self.text_line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let axis = |word: &str| match word {
            "-Y" => Some((false, false)),
            "+Y" => Some((false, true)),
            "+X" => Some((true, false)),
            "-X" => Some((true, true)),
            _ => None,
        };
        let parsed = match words[..] {
            [first, lines, second, length] => axis(first)
                .zip(axis(second))
                .zip(lines.parse().ok().zip(length.parse().ok()))
                .filter(|((first, second), _)| first.0 != second.0),
            _ => None,
        };
        let ((first, second), (lines, line_length)) = parsed.ok_or_else(|| {
            self.error(format!("the resolution is \"{line}\", not like \"-Y 512 +X 1024\""))
        })?;
        Ok(Layout {
            by_columns: first.0,
            lines,
            line_length,
            lines_reversed: first.1,
            pixels_reversed: second.1,
        })
    }

    fn take<const N: usize>(&mut self, line: usize) -> Result<[u8; N]> {
        let bytes = self.source.bytes.get(self.position..).and_then(|rest| rest.first_chunk::<N>());
        let bytes = *bytes.ok_or_else(|| self.error(format!("the data ends in scan line {line}")))?;
        self.position += N;
        Ok(bytes)
    }

    /// Reads one scan line, of either packing.
    fn line(&mut self, pixels: &mut Vec<Rgbe>, length: usize, line: usize) -> Result<()> {
        pixels.clear();
        let first: Rgbe = self.take(line)?;
        let announced = usize::from(first[2]) << 8 | usize::from(first[3]);
        if first[..2] == [2, 2] && first[2] < 128 && PACKABLE.contains(&length) {
            if announced != length {
                let message = format!("scan line {line} has {announced} pixels instead of {length}");
                return Err(self.error(message));
            }
            pixels.resize(length, [0; 4]);
            (0..4).try_for_each(|channel| self.packed_channel(pixels, channel, line))
        } else {
            self.position -= 4;
            self.old_line(pixels, length, line)
        }
    }

    /// The new scheme: a count above 128 announces a run, else as many values.
    fn packed_channel(&mut self, pixels: &mut [Rgbe], channel: usize, line: usize) -> Result<()> {
        let mut filled = 0;
        while filled < pixels.len() {
            let [code] = self.take(line)?;
            let count = usize::from(if code > 128 { code - 128 } else { code });
            if count == 0 || count > pixels.len() - filled {
                return Err(self.error(format!("a run of {count} values in scan line {line}")));
            }
            let run = &mut pixels[filled..filled + count];
            if code > 128 {
                let [value] = self.take(line)?;
                run.iter_mut().for_each(|pixel| pixel[channel] = value);
            } else {
                for pixel in run {
                    [pixel[channel]] = self.take(line)?;
                }
            }
            filled += count;
        }
        Ok(())
    }

    /// The old scheme: (1, 1, 1, n) repeats the last pixel n times; successive ones are digits of a
    /// number to the base 256, the lowest first.
    fn old_line(&mut self, pixels: &mut Vec<Rgbe>, length: usize, line: usize) -> Result<()> {
        let mut shift = 0;
        while pixels.len() < length {
            let pixel: Rgbe = self.take(line)?;
            if pixel[..3] != [1, 1, 1] {
                pixels.push(pixel);
                shift = 0;
                continue;
            }
            let count = usize::from(pixel[3]) << shift;
            let Some(&last) = pixels.last().filter(|_| count <= length - pixels.len()) else {
                return Err(self.error(format!("a run of {count} pixels in scan line {line}")));
            };
            pixels.resize(pixels.len() + count, last);
            shift = (shift + 8).min(24);
        }
        Ok(())
    }
}

/// A small valid file, its lines packed by both schemes.
#[cfg(test)]
pub(super) fn example() -> Vec<u8> {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 9\n".to_vec();
    bytes.extend([2, 2, 0, 9, 128 + 9, 50, 4, 1, 2, 3, 4, 128 + 5, 7, 128 + 9, 60, 128 + 9, 130]);
    bytes.extend([9, 8, 7, 129, 1, 1, 1, 8]);
    bytes
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use translucid_scene::{ColorSpace, Image, Place};

    use super::*;
    use crate::decode_image;

    fn decoded(bytes: &[u8]) -> Result<Image> {
        decode_image(&Place::file(Path::new("a.hdr")), bytes, ColorSpace::Srgb, &mut Vec::new())
    }

    fn file(resolution: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("#?RADIANCE\n# made here\nFORMAT=32-bit_rle_rgbe\n\n{resolution}\n");
        [header.as_bytes(), data].concat()
    }

    /// Pixels with mantissas (i, 2 i, 3 i), scaled so that the mantissa is the value.
    fn pixel(i: u8) -> Rgbe {
        [i, 2 * i, 3 * i, 136]
    }

    fn reds(image: &Image) -> Vec<f32> {
        let places = (0..image.height).flat_map(|y| (0..image.width).map(move |x| (x, y)));
        places.map(|(x, y)| image.texel(x, y)[0] - 0.5).collect()
    }

    /// As in files of Poly Haven.
    #[test]
    fn radiance_primaries_of_zeros_are_none() {
        let pixels = pixel(5);
        let plain = file("-Y 1 +X 1", &pixels);
        let stated = [b"#?RADIANCE\nPRIMARIES=0 0 0 0 0 0 0 0\n", &plain["#?RADIANCE\n".len()..]].concat();
        assert_eq!(decoded(&stated).unwrap().texel(0, 0), decoded(&plain).unwrap().texel(0, 0));
    }

    /// Radiance, *File formats*: the original is the stored value over the product of all factors. Indented lines are about
    /// pictures that this one was made from.
    #[test]
    fn radiance_divides_by_all_that_was_applied() {
        let read = |lines: &str| {
            let plain = file("-Y 1 +X 1", &pixel(5));
            let bytes = [b"#?RADIANCE\n", lines.as_bytes(), &plain["#?RADIANCE\n".len()..]].concat();
            let mut warnings = Vec::new();
            let place = Place::file(Path::new("a.hdr"));
            let image = decode_image(&place, &bytes, ColorSpace::Srgb, &mut warnings).unwrap();
            (image.texel(0, 0), warnings.iter().map(ToString::to_string).collect::<String>())
        };
        for (lines, divided, part) in [
            ("EXPOSURE=2.0\n", [2.75, 5.25, 7.75, 1.0], "divided by 2,"),
            ("EXPOSURE= 4\npfilt -1\nEXPOSURE=5.000000e-01\n", [2.75, 5.25, 7.75, 1.0], "divided by 2,"),
            ("COLORCORR=1 2 0.5\nEXPOSURE=2\n", [2.75, 2.625, 15.5, 1.0], "divided by [2.0, 4.0, 1.0],"),
            ("\tEXPOSURE=2\nEXPOSURE=1.0\n", [5.5, 10.5, 15.5, 1.0], ""),
            ("EXPOSURE=0\n", [5.5, 10.5, 15.5, 1.0], "\"EXPOSURE=0\" of its header is passed over"),
            ("COLORCORR=1 2\n", [5.5, 10.5, 15.5, 1.0], "\"COLORCORR=1 2\" of its header is passed over"),
        ] {
            let (texel, warnings) = read(lines);
            assert_eq!(texel, divided, "{lines}");
            assert!(warnings.contains(part) && part.is_empty() == warnings.is_empty(), "{lines}: {warnings}");
        }
    }

    #[test]
    fn radiance_reads_flat_pixels() {
        let image = decoded(&file("-Y 1 +X 2", &[pixel(5), [9, 9, 9, 0]].concat())).unwrap();
        assert_eq!(image.texel(0, 0), [5.5, 10.5, 15.5, 1.0]);
        assert_eq!(image.texel(1, 0), [0.0, 0.0, 0.0, 1.0]);
    }

    #[test]
    fn radiance_reads_old_runs() {
        let data = [pixel(5), [1, 1, 1, 3], pixel(7), [1, 1, 1, 2], [1, 1, 1, 1]].concat();
        let image = decoded(&file("-Y 1 +X 263", &data)).unwrap();
        let expected = [vec![5.0; 4], vec![7.0; 259]].concat();
        assert_eq!(reds(&image), expected);
    }

    #[test]
    fn radiance_reads_new_runs() {
        let mut data = vec![2, 2, 0, 10];
        for value in [3, 4, 5] {
            data.extend([128 + 6, value, 4, value, value + 1, value + 2, value + 3]);
        }
        data.extend([128 + 10, 136]);
        let image = decoded(&file("-Y 1 +X 10", &data)).unwrap();
        assert_eq!(reds(&image), [3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(image.texel(9, 0), [6.5, 7.5, 8.5, 1.0]);
    }

    #[test]
    fn radiance_turns_every_orientation_upright() {
        let data: Vec<u8> = (0..6).flat_map(pixel).collect();
        let upright = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        for (resolution, expected) in [
            ("-Y 2 +X 3", upright),
            ("-Y 2 -X 3", [2.0, 1.0, 0.0, 5.0, 4.0, 3.0]),
            ("+Y 2 +X 3", [3.0, 4.0, 5.0, 0.0, 1.0, 2.0]),
            ("+X 3 -Y 2", [0.0, 2.0, 4.0, 1.0, 3.0, 5.0]),
            ("-X 3 +Y 2", [5.0, 3.0, 1.0, 4.0, 2.0, 0.0]),
        ] {
            let image = decoded(&file(resolution, &data)).unwrap();
            assert_eq!((image.width, image.height), (3, 2), "{resolution}");
            assert_eq!(reds(&image), expected, "{resolution}");
        }
    }

    #[test]
    fn radiance_that_is_broken_is_refused_with_its_place() {
        for (bytes, part) in [
            (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe".to_vec(), "the header has no end"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n".to_vec(), "32-bit_rle_xyze"),
            (file("-Y 1 -Y 1", &[]), "\"-Y 1 -Y 1\""),
            (file("-Y one +X 1", &[]), "\"-Y one +X 1\""),
            (file("-Y 99999 +X 1", &[]), "too large"),
            (file("-Y 0 +X 1", &[]), "no pixels"),
            (file("-Y 30000 +X 8000", &[]), "cannot hold"),
            (file("-Y 18446744073709551616 +X 1", &[]), "resolution"),
            (file("-Y 2 +X 1", &pixel(1)), "ends in scan line 1"),
            (file("-Y 1 +X 3", &[pixel(1), [1, 1, 1, 200]].concat()), "a run of 200 pixels in scan line 0"),
            (file("-Y 1 +X 3", &[1, 1, 1, 2]), "a run of 2 pixels"),
            (file("-Y 1 +X 8", &[2, 2, 0, 9]), "9 pixels instead of 8"),
            (file("-Y 1 +X 8", &[2, 2, 0, 8, 128 + 9, 1]), "a run of 9 values"),
            (file("-Y 1 +X 8", &[2, 2, 0, 8, 0]), "a run of 0 values"),
            (file("-Y 1 +X 8", &[2, 2, 0, 8, 8, 1, 2]), "ends in scan line 0"),
        ] {
            let message = decoded(&bytes).unwrap_err().to_string();
            assert!(message.starts_with("a.hdr: ") && message.contains(part), "{message}: {part}");
        }
    }
}
