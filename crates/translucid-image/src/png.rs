//! PNG files: what a picture looks like on a display.

use std::io::{self, Write};
use std::path::Path;

use ::png::{BitDepth, ColorType, Encoder, ScaledFloat, SrgbRenderingIntent};
use rayon::prelude::*;
use translucid_files::write_atomically;

use crate::picture::invalid;
use crate::{OutputError, Picture, ToneMapping, display_from_linear};

/// The way from linear radiance to a display.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayTransform {
    /// Exposure in stops.
    pub exposure: f32,
    /// Curve of the tones.
    pub tone_mapping: ToneMapping,
}

impl Picture<'_> {
    /// Writes the channels `R`, `G`, `B` and, if it is there, the coverage `A` as an 8-bit sRGB file.
    ///
    /// Where nothing covers a pixel the picture is transparent: such files have an alpha channel (straight, as the
    /// format demands); others have none. A fixed pattern of ±½ code, which depends on a pixel's place in the whole
    /// picture, hides the steps of smooth gradients. Equal values and metadata give equal bytes.
    ///
    /// # Errors
    /// As [`write_atomically`], or the picture is none, see [`write_png`](Self::write_png).
    pub fn save_png(&self, path: &Path, display: DisplayTransform) -> Result<(), OutputError> {
        write_atomically(path, |out| self.write_png(out, display))
    }

    /// Writes what [`save_png`](Self::save_png) does to anything.
    ///
    /// # Errors
    /// `out` refuses, the picture has no pixels, a color channel is missing, or its region is not within the whole.
    pub fn write_png(&self, out: impl Write, display: DisplayTransform) -> io::Result<()> {
        self.check()?;
        let mut codes = self.display_codes(display)?;
        let is_opaque = codes.as_chunks().0.iter().all(|[_, _, _, alpha]| *alpha == 255);
        if is_opaque {
            drop_alpha(&mut codes);
        }
        let software =
            Some(("Software".to_owned(), self.software.clone())).filter(|_| !self.software.is_empty());
        let notes = self.metadata.iter().map(|(name, value)| (name.clone(), value.to_string()));
        CodedPicture {
            size: self.size(),
            has_alpha: !is_opaque,
            codes: &codes,
            encoding: Encoding::Srgb,
            texts: software.into_iter().chain(notes).collect(),
        }
        .write(out)
    }

    /// The codes of [`write_png`](Self::write_png), four for each pixel: color and straight alpha.
    ///
    /// # Errors
    /// The picture has no pixels, a color channel is missing, or its region is not within the whole.
    pub fn display_codes(&self, display: DisplayTransform) -> io::Result<Vec<u8>> {
        let color = self.indices_of(["R", "G", "B"])?;
        let alpha = self.index_of("A");
        self.check()?;
        let exposure = libm::exp2(f64::from(display.exposure));
        let [width, height] = self.size();
        let bytes = width.checked_mul(height).and_then(|count| count.checked_mul(4));
        let mut codes = vec![0; bytes.ok_or_else(|| invalid("the picture is too large"))?];
        let rows = codes.par_chunks_mut(4 * width).zip(self.region.rows());
        rows.for_each_init(
            || self.new_row(),
            |row, (codes, y)| {
                self.read_row(y, row);
                let pixels = self.region.columns().zip(row.chunks_exact(self.channels.len()));
                for (code, (x, pixel)) in codes.chunks_exact_mut(4).zip(pixels) {
                    let radiance = color.map(|index| pixel[index]);
                    let alpha = alpha.map_or(1.0, |index| pixel[index]);
                    code.copy_from_slice(&display_pixel(
                        radiance,
                        alpha,
                        exposure,
                        display.tone_mapping,
                        [x, y],
                    ));
                }
            },
        );
        Ok(codes)
    }
}

/// The codes of a pixel's color and straight alpha; `at` is its place in the whole picture.
fn display_pixel(
    radiance: [f64; 3],
    alpha: f64,
    exposure: f64,
    tone_mapping: ToneMapping,
    at: [u32; 2],
) -> [u8; 4] {
    let alpha = alpha.max(0.0).min(1.0);
    let alpha_code = (alpha * 255.0).round() as u8;
    if alpha_code == 0 {
        return [0; 4];
    }
    let linear = radiance.map(|value| (value / alpha * exposure) as f32);
    let [r, g, b] = display_from_linear(tone_mapping, linear).map(|value| quantize(value, at));
    [r, g, b, alpha_code]
}

/// The 8-bit code of a display value in [0, 1], rounded up or down so that the mean over a region is right.
///
/// Whole codes stay what they are.
fn quantize(value: f32, at: [u32; 2]) -> u8 {
    (value * 255.0 + dither(at)).floor() as u8
}

/// A threshold in (0, 1) per pixel, equal for all channels, so that grey stays grey.
///
/// Multiples of the plane's two irrationals (the root of x³ = x + 1) spread evenly over any neighborhood
/// [M. Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"].
fn dither([x, y]: [u32; 2]) -> f32 {
    const STEP_X: u32 = 3_242_174_889; // 2³² · 0.754877666
    const STEP_Y: u32 = 2_447_445_414; // 2³² · 0.569840291
    let phase = x.wrapping_mul(STEP_X).wrapping_add(y.wrapping_mul(STEP_Y));
    ((phase >> 16) as f32 + 0.5) / 65536.0
}

/// Leaves the first three of every four codes.
fn drop_alpha(codes: &mut Vec<u8>) {
    let count = codes.len() / 4;
    for pixel in 0..count {
        codes.copy_within(4 * pixel..4 * pixel + 3, 3 * pixel);
    }
    codes.truncate(3 * count);
}

/// The meaning of codes, which the file states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Display values: the chunk `sRGB`.
    Srgb,
    /// Proportional to the numbers of a table: the chunk `gAMA` with 1, and no `sRGB`.
    Linear,
}

/// Pixels as 8-bit codes, to become a PNG.
///
/// ```
/// let codes = [255, 0, 0, 0, 0, 255];
/// let bytes = translucid_image::CodedPicture::rgb([2, 1], &codes).with_text("Title", "red and blue").encode()?;
/// assert!(bytes.starts_with(b"\x89PNG"));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodedPicture<'a> {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Whether a straight alpha follows the color.
    pub has_alpha: bool,
    /// Three or four codes for each pixel, row by row.
    pub codes: &'a [u8],
    /// Their meaning.
    pub encoding: Encoding,
    /// Keywords and texts.
    pub texts: Vec<(String, String)>,
}

impl<'a> CodedPicture<'a> {
    /// An opaque picture of three sRGB codes a pixel, without texts.
    pub fn rgb(size: [usize; 2], codes: &'a [u8]) -> Self {
        Self { size, has_alpha: false, codes, encoding: Encoding::Srgb, texts: Vec::new() }
    }

    /// An opaque picture of three linear codes a pixel, without texts.
    pub fn linear_rgb(size: [usize; 2], codes: &'a [u8]) -> Self {
        Self { encoding: Encoding::Linear, ..Self::rgb(size, codes) }
    }

    /// Adds a text under a keyword of 1 to 79 Latin letters.
    #[must_use]
    pub fn with_text(mut self, keyword: &str, text: &str) -> Self {
        self.texts.push((keyword.to_owned(), text.to_owned()));
        self
    }

    /// The bytes of the PNG.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn encode(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.write(&mut bytes)?;
        Ok(bytes)
    }

    /// Writes the PNG.
    ///
    /// # Errors
    /// `out` refuses, there is no pixel or more than the format can hold, `codes` has another length than that many
    /// pixels have, or a keyword is not allowed.
    pub fn write(&self, out: impl Write) -> io::Result<()> {
        let edge = |size: usize| u32::try_from(size).map_err(|_| invalid("the picture is too large"));
        let [width, height] = self.size.map(edge);
        let mut encoder = Encoder::new(out, width?, height?);
        encoder.set_color(if self.has_alpha { ColorType::Rgba } else { ColorType::Rgb });
        encoder.set_depth(BitDepth::Eight);
        match self.encoding {
            Encoding::Srgb => encoder.set_source_srgb(SrgbRenderingIntent::Perceptual),
            Encoding::Linear => encoder.set_source_gamma(ScaledFloat::from_scaled(100_000)),
        }
        for (keyword, text) in &self.texts {
            encoder.add_itxt_chunk(keyword.clone(), text.replace('\0', "?")).map_err(io::Error::other)?;
        }
        let mut writer = encoder.write_header().map_err(io::Error::other)?;
        writer.write_image_data(self.codes).map_err(io::Error::other)?;
        writer.finish().map_err(io::Error::other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MetadataValue, PictureChannel, PixelRect};

    const PLAIN: DisplayTransform = DisplayTransform { exposure: 0.0, tone_mapping: ToneMapping::Srgb };

    fn read_back(bytes: &[u8]) -> (::png::OutputInfo, Vec<u8>, Vec<(String, String)>) {
        let mut reader = ::png::Decoder::new(io::Cursor::new(bytes)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut codes).unwrap();
        let texts = reader.info().utf8_text.iter();
        let texts = texts.map(|chunk| (chunk.keyword.clone(), chunk.get_text().unwrap())).collect();
        (info, codes, texts)
    }

    fn written(
        picture: &Picture<'_>,
        display: DisplayTransform,
    ) -> (::png::OutputInfo, Vec<u8>, Vec<(String, String)>) {
        let mut bytes = Vec::new();
        picture.write_png(&mut bytes, display).unwrap();
        read_back(&bytes)
    }

    /// A picture of 32 × 32 pixels, all with these values.
    fn constant<const N: usize>(names: [&str; N], pixel: [f64; N]) -> Picture<'static> {
        Picture::new([32, 32], names.map(PictureChannel::single).to_vec(), move |_, values| {
            values.as_chunks_mut().0.fill(pixel);
        })
    }

    #[test]
    fn png_of_an_opaque_picture_is_rgb_with_metadata() {
        let metadata = [
            ("Scene", MetadataValue::Text(String::from("Äpfel\0.toml"))),
            ("Samples", MetadataValue::Integer(2)),
        ];
        let metadata = metadata.map(|(name, value)| (name.to_owned(), value)).to_vec();
        for picture in
            [constant(["B", "R", "G"], [1.0, 1.0, 0.0]), constant(["A", "R", "G", "B"], [1.0, 1.0, 0.0, 1.0])]
        {
            let (info, codes, texts) = written(&picture.with_metadata("a brush", metadata.clone()), PLAIN);
            assert_eq!((info.width, info.height, info.color_type), (32, 32, ColorType::Rgb));
            assert!(codes.chunks(3).all(|pixel| pixel == [255, 0, 255]));
            let expected = [("Software", "a brush"), ("Scene", "Äpfel?.toml"), ("Samples", "2")];
            assert_eq!(texts, expected.map(|(keyword, text)| (keyword.to_owned(), text.to_owned())));
        }
    }

    #[test]
    fn png_alpha_is_straight() {
        // White of coverage ¼: the color is not darkened by its coverage.
        let (info, codes, _) = written(&constant(["R", "G", "B", "A"], [0.25; 4]), PLAIN);
        assert_eq!(info.color_type, ColorType::Rgba);
        assert!(codes.chunks(4).all(|pixel| pixel == [255, 255, 255, 64]));
    }

    #[test]
    fn png_of_nothing_is_transparent() {
        let (_, codes, _) = written(&constant(["R", "G", "B", "A"], [0.0; 4]), PLAIN);
        assert!(codes.iter().all(|&code| code == 0));
    }

    #[test]
    fn png_dither_keeps_the_mean() {
        // Linear ⅒ two stops up is 0.4, encoded 0.6651850 · 255 = 169.622.
        let display = DisplayTransform { exposure: 2.0, ..PLAIN };
        let (_, codes, _) = written(&constant(["R", "G", "B"], [0.1; 3]), display);
        let mean = codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
        assert!((mean - 169.622).abs() < 0.02, "{mean}");
        assert!(codes.chunks(3).all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
        assert!(codes.iter().all(|code| (169..=170).contains(code)));
    }

    #[test]
    fn png_of_a_region_has_the_codes_of_the_whole() {
        let region = PixelRect { left: 5, top: 9, width: 16, height: 3 };
        let (_, whole, _) = written(&constant(["R", "G", "B"], [0.3; 3]), PLAIN);
        let part = constant(["R", "G", "B"], [0.3; 3]).within(region, [32, 32]);
        let (info, part, _) = written(&part, PLAIN);
        assert_eq!((info.width, info.height), (16, 3));
        for (row, codes) in part.chunks(48).enumerate() {
            let from = ((9 + row) * 32 + 5) * 3;
            assert_eq!(codes, &whole[from..from + 48]);
        }
    }

    #[test]
    fn png_of_values_that_are_not_finite_is_black_or_white() {
        for (odd, code) in [(f64::NAN, 0), (f64::INFINITY, 255), (f64::NEG_INFINITY, 0), (1e300, 255)] {
            let (_, codes, _) = written(&constant(["R", "G", "B", "A"], [odd, odd, odd, 1.0]), PLAIN);
            assert!(codes.iter().all(|&found| found == code), "{odd}: {codes:?}");
            let (info, ..) = written(&constant(["R", "G", "B", "A"], [odd; 4]), PLAIN);
            assert_eq!((info.width, info.height), (32, 32));
        }
    }

    #[test]
    fn png_of_no_picture_is_an_error() {
        for picture in [
            constant(["R", "G", "x"], [0.0; 3]),
            constant(["R", "G", "B"], [0.0; 3])
                .within(PixelRect { left: 3, top: 3, width: 30, height: 1 }, [32, 32]),
        ] {
            assert!(picture.write_png(io::sink(), PLAIN).is_err());
        }
    }

    #[test]
    fn coded_picture_gives_its_codes_back() {
        let codes: Vec<u8> = (0..24).collect();
        let picture = CodedPicture::rgb([4, 2], &codes).with_text("Software", "a brush");
        let (info, read, texts) = read_back(&picture.encode().unwrap());
        assert_eq!((info.width, info.height, read), (4, 2, codes.clone()));
        assert_eq!(texts, [(String::from("Software"), String::from("a brush"))]);
        for size in [[4, 3], [0, 2], [usize::MAX, 1]] {
            assert!(CodedPicture::rgb(size, &codes).encode().is_err(), "{size:?}");
        }
        assert!(CodedPicture::rgb([4, 2], &codes).with_text("", "no keyword").encode().is_err());
    }
}
