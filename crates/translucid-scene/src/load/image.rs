//! Image files of any format, told apart by their first bytes.

use std::path::Path;

use super::{exr, jpeg, png, radiance, read_file};
use crate::{ColorSpace, Image, Pixels, Place, SceneError, Warning};

/// Longest edge of an image [pixels].
const LONGEST_EDGE: usize = 32_768;

/// Most pixels of an image.
const MOST_PIXELS: usize = 1 << 28;

/// Pixels that may be claimed by a file of any length.
const SMALL: usize = 1 << 22;

/// Most pixels for each byte of a file beyond [`SMALL`]: deflate packs at most 1032 bytes in one.
const PIXELS_PER_BYTE: usize = 2_048;

/// Loads an image file: PNG, JPEG, OpenEXR or Radiance HDR, whatever its name ends in.
///
/// `color_space` says how to read integer files; float files are linear.
/// Color profiles, gamma chunks and orientation tags in the file are ignored.
///
/// # Errors
/// The file cannot be read, is damaged, of another format, beyond 32 768 pixels an edge or 2²⁸ pixels.
pub fn load_image(
    path: &Path,
    color_space: ColorSpace,
    warnings: &mut Vec<Warning>,
) -> Result<Image, SceneError> {
    let image = decode_image(&Place::file(path), &read_file(path)?, color_space, warnings)?;
    Ok(Image { path: Some(path.to_owned()), ..image })
}

/// Decodes an image from bytes as [`load_image`] does; `place` is where messages say it came from.
///
/// # Errors
/// As [`load_image`].
pub fn decode_image(
    place: &Place,
    bytes: &[u8],
    color_space: ColorSpace,
    warnings: &mut Vec<Warning>,
) -> Result<Image, SceneError> {
    let source = Source { place, bytes };
    let raster = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode(&source, color_space)?,
        [0xff, 0xd8, 0xff, ..] => jpeg::decode(&source, warnings)?,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(&source)?,
        [b'#', b'?', ..] => radiance::decode(&source)?,
        _ => return Err(source.unknown_format()),
    };
    Ok(raster.into_image(place, color_space, warnings))
}

/// The bytes of an image file and their place.
pub(super) struct Source<'a> {
    pub(super) place: &'a Place,
    pub(super) bytes: &'a [u8],
}

impl Source<'_> {
    pub(super) fn error(&self, message: impl Into<String>) -> SceneError {
        SceneError::at(self.place.clone(), message)
    }

    fn unknown_format(&self) -> SceneError {
        let message = if self.bytes.is_empty() {
            "is empty, but an image is expected"
        } else {
            "is not an image of a known format"
        };
        self.error(message).with_help("PNG, JPEG, OpenEXR and Radiance HDR can be read")
    }

    /// Number of pixels, refused before anything of that size is allocated.
    pub(super) fn check_size(&self, width: usize, height: usize) -> Result<usize, SceneError> {
        if width == 0 || height == 0 {
            return Err(self.error(format!("the image has no pixels: {width} × {height}")));
        }
        let pixels = width.saturating_mul(height);
        if width.max(height) > LONGEST_EDGE || pixels > MOST_PIXELS {
            let message = format!("the image is too large: {width} × {height} pixels");
            return Err(self.error(message).with_help(format!(
                "at most {LONGEST_EDGE} pixels an edge and {MOST_PIXELS} in all can be read"
            )));
        }
        if pixels > SMALL.saturating_add(self.bytes.len().saturating_mul(PIXELS_PER_BYTE)) {
            let length = self.bytes.len();
            return Err(
                self.error(format!("{length} bytes cannot hold the {width} × {height} pixels claimed"))
            );
        }
        Ok(pixels)
    }
}

/// What a format's decoder returns.
pub(super) struct Raster {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Pixels,
}

impl Raster {
    fn into_image(mut self, place: &Place, color_space: ColorSpace, warnings: &mut Vec<Warning>) -> Image {
        let color_space = match &mut self.pixels {
            Pixels::Byte(_) => color_space,
            Pixels::Float(pixels) => {
                mend(pixels, place, warnings);
                ColorSpace::Linear
            }
        };
        // `check_size` has bounded both edges.
        let [width, height] = [self.width, self.height].map(|edge| edge as u32);
        Image { name: place.to_string(), path: None, width, height, color_space, pixels: self.pixels }
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
mod tests {
    use super::*;
    use crate::test_assets::{asset, mutants};

    fn decoded(bytes: &[u8]) -> Result<Image, SceneError> {
        decode_image(&Place::file(Path::new("a.png")), bytes, ColorSpace::Srgb, &mut Vec::new())
    }

    fn is_sound(image: &Image) -> bool {
        let count = image.width as usize * image.height as usize;
        match &image.pixels {
            Pixels::Byte(pixels) => pixels.len() == count,
            Pixels::Float(pixels) => pixels.len() == count && pixels.iter().flatten().all(|v| v.is_finite()),
        }
    }

    #[test]
    fn image_of_unknown_format_is_refused_with_its_name() {
        for (bytes, part) in [
            (&b""[..], "is empty"),
            (b"\x89PN", "not an image of a known format"),
            (b"GIF89a", "PNG, JPEG, OpenEXR and Radiance HDR can be read"),
        ] {
            let message = decoded(bytes).unwrap_err().to_string();
            assert!(message.starts_with("a.png: ") && message.contains(part), "{message}");
        }
        let missing = load_image(Path::new("no/such.png"), ColorSpace::Srgb, &mut Vec::new());
        assert!(missing.unwrap_err().to_string().starts_with("no/such.png: cannot be read"));
    }

    #[test]
    fn image_survives_any_mutation() {
        let jpegs: [&[u8]; 3] = [
            include_bytes!("../../tests/data/color.jpg"),
            include_bytes!("../../tests/data/progressive.jpg"),
            include_bytes!("../../tests/data/cmyk.jpg"),
        ];
        let others = [png::example(), exr::example(), radiance::example()];
        for file in jpegs.map(<[u8]>::to_vec).into_iter().chain(others) {
            assert!(decoded(&file).is_ok());
            for mutant in mutants(&file, 2_000) {
                assert!(decoded(&mutant).map_or(true, |image| is_sound(&image)));
            }
        }
    }

    #[test]
    fn image_loads_real_files() {
        for (name, size) in [
            ("env/interior.exr", None),
            ("env/studio.exr", None),
            ("env/spruit_sunrise_small.hdr", None),
            ("env/urban_alley_01_1k.hdr", Some((1024, 512))),
            ("head/color.jpg", None),
            ("head/normal.jpg", None),
            ("spot/spot.png", None),
        ] {
            let Some(path) = asset(name) else { continue };
            let mut warnings = Vec::new();
            let image = load_image(&path, ColorSpace::Srgb, &mut warnings).unwrap();
            assert!(is_sound(&image) && warnings.is_empty(), "{name}: {warnings:?}");
            assert!(size.is_none_or(|size| size == (image.width, image.height)));
            assert!(
                image.mean()[..3].iter().all(|&mean| mean > 0.0 && mean < 100.0),
                "{name}: {:?}",
                image.mean()
            );
        }
    }
}
