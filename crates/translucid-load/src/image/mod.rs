//! Image files of any format, told apart by their first bytes.

mod encoding;
mod exr;
mod file_bytes;
mod icc;
mod jpeg;
mod other_formats;
mod png;
mod radiance;
mod tags;
mod tiff;
mod upright;
mod webp;

use std::path::Path;

use crate::file::read_file;
use crate::loading::Loading;
use crate::result::Result;
use encoding::{Curve, Encoding, Samples};
pub use exr::ExrChannels;
use file_bytes::ImageBytes;
use icc::Profile;
use translucid_scene::{ColorSpace, Image, ImageKind, Pixels, Place, SceneError, Warning};

/// Loads a photograph: PNG, JPEG, WebP, TIFF, OpenEXR or Radiance HDR, whatever its name ends in.
///
/// The file's own statement of its colors counts: ICC profiles, cICP, gAMA and cHRM of PNG, chromaticities and CIE XYZ of
/// OpenEXR, EXPOSURE and COLORCORR of Radiance HDR. Of a JPEG with a gain map the base is read, with a warning.
/// They become linear Rec. 709, with negative values for colors beyond it.
/// `color_space` is that of integers in a file that states none; `Linear` replaces also a stated curve, but not stated primaries.
/// The pixels stand as a viewer shows them: the orientation of EXIF and TIFF counts.
///
/// # Errors
/// The file cannot be read, is damaged, of another format, beyond 32 768 pixels an edge or 2²⁸ pixels.
pub fn load_image(path: &Path, color_space: ColorSpace, warnings: &mut Vec<Warning>) -> Result<Image> {
    let bytes = read_file(path)?;
    let kind = ImageKind::Color(color_space);
    let image = decode_for(Use::Photograph, &Place::file(path), &bytes, kind, warnings)?;
    Ok(Image { path: Some(path.to_owned()), ..image })
}

/// Loads an image of numbers, whatever colors the file states: integers by the curve of `color_space`, and nothing else changed.
///
/// # Errors
/// As [`load_image`].
pub fn load_plain_image(path: &Path, color_space: ColorSpace, warnings: &mut Vec<Warning>) -> Result<Image> {
    decode_for(Use::Scene, &Place::file(path), &read_file(path)?, ImageKind::Plain(color_space), warnings)
}

/// Loads an image of a scene as [`load_image`] does, as a part of a load.
pub(crate) fn read_image(path: &Path, kind: ImageKind, loading: &mut Loading<'_>) -> Result<Image> {
    let bytes = loading.read(path)?;
    let image = decode_for(Use::Scene, &Place::file(path), &bytes, kind, loading.warnings)?;
    Ok(Image { path: Some(path.to_owned()), ..image })
}

/// Loads all channels of an OpenEXR file, whatever its parts.
///
/// # Errors
/// The file cannot be read, is damaged, of another format, or beyond what an image may have, see [`load_image`].
pub fn load_exr(path: &Path) -> Result<ExrChannels> {
    let (place, bytes) = (Place::file(path), read_file(path)?);
    exr::decode_channels(&ImageBytes { place: &place, bytes: &bytes })
}

/// Decodes an image of a scene from bytes as [`load_image`] does; `place` is where messages say it came from.
///
/// # Errors
/// As [`load_image`].
pub fn decode_image(
    place: &Place,
    bytes: &[u8],
    color_space: ColorSpace,
    warnings: &mut Vec<Warning>,
) -> Result<Image> {
    decode_for(Use::Scene, place, bytes, ImageKind::Color(color_space), warnings)
}

/// Who asks for an image.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Use {
    /// A measurement.
    Photograph,
    /// A scene: textures, skies.
    Scene,
    /// A glTF file, whose coordinates are those of the pixels as they are stored.
    Gltf,
}

/// Decodes an image.
pub(crate) fn decode_for(
    used_as: Use,
    place: &Place,
    bytes: &[u8],
    kind: ImageKind,
    warnings: &mut Vec<Warning>,
) -> Result<Image> {
    let source = ImageBytes { place, bytes };
    let picture = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode(&source)?,
        [0xff, 0xd8, 0xff, ..] => jpeg::decode(&source, warnings)?,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(&source, warnings)?,
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => tiff::decode(&source, warnings)?,
        [b'#', b'?', ..] => radiance::decode(&source, warnings)?,
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => webp::decode(&source)?,
        _ => return Err(other_formats::refusal(&source)),
    };
    let Picture { size, orientation, .. } = picture;
    let mut reading = Reading { used_as, place, warnings };
    let (mut pixels, color_space) = reading.decode(picture, kind)?;
    if let Pixels::Float(pixels) = &mut pixels {
        mend(pixels, place, reading.warnings);
    }
    let is_turned = (2..=8).contains(&orientation);
    if used_as == Use::Gltf && is_turned {
        reading.warn(format!(
            "its orientation {orientation} is passed over: glTF's coordinates are those of the stored pixels"
        ));
    }
    let size = match &mut pixels {
        _ if used_as == Use::Gltf => size,
        Pixels::Byte(pixels) => upright::upright(pixels, size, orientation),
        Pixels::Float(pixels) => upright::upright(pixels, size, orientation),
    };
    // `check_size` has bounded both edges.
    let [width, height] = size.map(|edge| edge as u32);
    Ok(Image { name: place.to_string(), path: None, width, height, color_space, pixels })
}

/// A picture as its file has it.
struct Picture {
    /// Width and height.
    size: [usize; 2],
    samples: Samples,
    /// Red, green and blue are the same channel.
    is_gray: bool,
    stated: Option<Stated>,
    /// The number that TIFF and EXIF have for it; 1 is upright.
    orientation: u16,
}

impl Picture {
    /// A picture whose file states nothing of its colors.
    fn plain(size: [usize; 2], samples: Samples) -> Self {
        Self { size, samples, is_gray: false, stated: None, orientation: 1 }
    }
}

/// What a file states of its colors.
enum Stated {
    Icc(Vec<u8>),
    Encoding(Box<Encoding>),
    /// One of which a part is not stated, and a warning.
    Partly(Box<Encoding>, String),
    /// A statement that is passed over, in words that go on with what is done instead.
    Unknown(String),
}

impl Stated {
    fn encoding(encoding: Encoding) -> Self {
        Self::Encoding(Box::new(encoding))
    }
}

/// A picture as its decoder returns it.
type Decoded = Result<Picture>;

/// The way from a picture's numbers to an image.
struct Reading<'a> {
    used_as: Use,
    place: &'a Place,
    warnings: &'a mut Vec<Warning>,
}

impl Reading<'_> {
    fn warn(&mut self, message: String) {
        self.warnings.push(Warning { message, place: Some(self.place.clone()) });
    }

    fn decode(&mut self, picture: Picture, kind: ImageKind) -> Result<(Pixels, ColorSpace)> {
        let Picture { samples, is_gray, stated, .. } = picture;
        let color_space = kind.color_space();
        let (wanted, taken_as) = match color_space {
            ColorSpace::Srgb => (Curve::Srgb, "sRGB"),
            ColorSpace::Linear => (Curve::Linear, "linear Rec. 709"),
        };
        let stated = stated.filter(|_| matches!(kind, ImageKind::Color(_)));
        let encoding = match stated {
            None => return Ok(plain(samples, color_space)),
            Some(Stated::Encoding(encoding)) => *encoding,
            Some(Stated::Partly(encoding, words)) => {
                self.warn(words);
                *encoding
            }
            Some(Stated::Unknown(words)) => {
                self.warn(format!("{words}: its numbers are taken as {taken_as}"));
                return Ok(plain(samples, color_space));
            }
            Some(Stated::Icc(bytes)) => match Profile::parse(&bytes, is_gray) {
                Ok(Profile::Matrix(encoding)) => encoding,
                Ok(Profile::Tables(tables)) if color_space == ColorSpace::Srgb => {
                    let pixels = tables.decode(&samples);
                    let pixels = pixels.map_err(|words| SceneError::at(self.place.clone(), words))?;
                    self.check_photograph(&samples, &tables.name, true);
                    return Ok((Pixels::Float(pixels), ColorSpace::Linear));
                }
                Ok(Profile::Tables(tables)) => {
                    let name = tables.name;
                    self.warn(format!(
                        "its ICC profile \"{name}\" is left out, for its numbers are to be linear"
                    ));
                    return Ok(plain(samples, color_space));
                }
                Err(words) => {
                    self.warn(format!(
                        "its ICC profile {words} and is left out: its numbers are taken as {taken_as}"
                    ));
                    return Ok(plain(samples, color_space));
                }
            },
        };
        Ok(self.decode_stated(samples, encoding, color_space, &wanted))
    }

    /// Decodes what curves and primaries are known of.
    fn decode_stated(
        &mut self,
        samples: Samples,
        mut encoding: Encoding,
        color_space: ColorSpace,
        wanted: &Curve,
    ) -> (Pixels, ColorSpace) {
        let is_linear = encoding.has_curve(&Curve::Linear);
        if color_space == ColorSpace::Linear && !is_linear {
            let name = &encoding.name;
            self.warn(format!("its numbers are taken as linear, although \"{name}\" has a curve"));
            encoding = encoding.with_curve(&Curve::Linear);
        }
        if encoding.is_rec_709() {
            match &samples {
                Samples::Float(_) if encoding.has_curve(&Curve::Linear) => {
                    return plain(samples, color_space);
                }
                Samples::Byte(_) | Samples::Short(_) if encoding.has_curve(wanted) => {
                    return plain(samples, color_space);
                }
                Samples::Byte(_) | Samples::Short(_) if is_linear => {
                    return plain(samples, ColorSpace::Linear);
                }
                _ => {}
            }
        }
        let pixels = encoding.decode(&samples);
        self.check_photograph(&samples, &encoding.name, !encoding.is_rec_709());
        self.check_gamut(&pixels, &encoding.name);
        (Pixels::Float(pixels), ColorSpace::Linear)
    }

    /// Warns of a photograph whose bytes are decoded, and of clipped values that a change of primaries hides.
    fn check_photograph(&mut self, samples: &Samples, name: &str, is_mixed: bool) {
        if self.used_as != Use::Photograph {
            return;
        }
        if matches!(samples, Samples::Byte(_)) {
            self.warn(format!(
                "8-bit values are decoded as \"{name}\"; cameras bend them at will, and lengths with them: better \
                 develop the raw file to linear OpenEXR"
            ));
        }
        let clipped = clipped(samples);
        if is_mixed && clipped > 1e-3 {
            let percent = 100.0 * clipped;
            self.warn(format!("{percent:.1} % of the values are at the end of their range in \"{name}\""));
        }
    }

    /// Says where colors of textures are beyond what materials take.
    fn check_gamut(&mut self, pixels: &[[f32; 4]], name: &str) {
        if self.used_as != Use::Scene {
            return;
        }
        // A thousandth is less than a level of a byte
        let is_beyond = |pixel: &&[f32; 4]| pixel[..3].iter().any(|value| *value < -1e-3);
        let count = pixels.iter().filter(is_beyond).count();
        if count > 0 {
            let percent = 100.0 * count as f64 / pixels.len() as f64;
            self.warn(format!(
                "{percent:.1} % of the pixels have colors of \"{name}\" beyond Rec. 709, with negative channels; \
                 materials take them as 0"
            ));
        }
    }
}

/// Numbers whose file states nothing: floats are linear.
fn plain(samples: Samples, color_space: ColorSpace) -> (Pixels, ColorSpace) {
    let curve = match color_space {
        ColorSpace::Srgb => Curve::Srgb,
        ColorSpace::Linear => Curve::Linear,
    };
    match samples {
        Samples::Byte(pixels) => (Pixels::Byte(pixels), color_space),
        Samples::Float(pixels) => (Pixels::Float(pixels), ColorSpace::Linear),
        short @ Samples::Short(_) => {
            let encoding = Encoding::new("", curve, crate::primaries::REC_709);
            (Pixels::Float(encoding.decode(&short)), ColorSpace::Linear)
        }
    }
}

/// The share of integers that are the greatest of their kind.
fn clipped(samples: &Samples) -> f64 {
    fn share<T: Copy + PartialEq>(pixels: &[[T; 4]], greatest: T) -> f64 {
        let values = pixels.iter().flat_map(|pixel| &pixel[..3]);
        values.filter(|value| **value == greatest).count() as f64 / (3 * pixels.len()).max(1) as f64
    }
    match samples {
        Samples::Byte(pixels) => share(pixels, u8::MAX),
        Samples::Short(pixels) => share(pixels, u16::MAX),
        Samples::Float(_) => 0.0,
    }
}

/// Sets values that are not finite to 0 and counts their pixels.
fn mend(pixels: &mut [[f32; 4]], place: &Place, warnings: &mut Vec<Warning>) {
    let mut count = 0_usize;
    for pixel in pixels.iter_mut().filter(|pixel| pixel.iter().any(|value| !value.is_finite())) {
        count += 1;
        *pixel = pixel.map(|value| if value.is_finite() { value } else { 0.0 });
    }
    if count > 0 {
        let noun = if count == 1 { "pixel has" } else { "pixels have" };
        let message = format!("{count} {noun} values that are NaN or infinite: set to 0");
        warnings.push(Warning { message, place: Some(place.clone()) });
    }
}

#[cfg(test)]
mod tests;
