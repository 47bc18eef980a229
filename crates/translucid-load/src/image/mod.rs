//! Image files of any format, told apart by their first bytes.

mod exr;
mod file_bytes;
mod jpeg;
mod png;
mod radiance;
mod tiff;
mod webp;

use std::path::Path;

use crate::file::read_file;
use crate::loading::Loading;
pub use exr::ExrChannels;
use file_bytes::ImageBytes;
use translucid_scene::{ColorSpace, Image, Pixels, Place, SceneError, Warning};

/// Loads an image file: PNG, JPEG, TIFF, OpenEXR or Radiance HDR, whatever its name ends in.
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
    read_image(path, color_space, &mut Loading::unwatched(warnings))
}

/// As [`load_image`], as a part of a load.
pub(crate) fn read_image(
    path: &Path,
    color_space: ColorSpace,
    loading: &mut Loading<'_>,
) -> Result<Image, SceneError> {
    let bytes = loading.read(path)?;
    let image = decode_image(&Place::file(path), &bytes, color_space, loading.warnings)?;
    Ok(Image { path: Some(path.to_owned()), ..image })
}

/// Loads all channels of an OpenEXR file, whatever its parts.
///
/// # Errors
/// The file cannot be read, is damaged, of another format, or beyond what an image may have, see [`load_image`].
pub fn load_exr(path: &Path) -> Result<ExrChannels, SceneError> {
    let (place, bytes) = (Place::file(path), read_file(path)?);
    exr::decode_channels(&ImageBytes { place: &place, bytes: &bytes })
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
    let source = ImageBytes { place, bytes };
    let ([width, height], mut pixels) = match bytes {
        [0x89, b'P', b'N', b'G', ..] => png::decode(&source, color_space)?,
        [0xff, 0xd8, 0xff, ..] => jpeg::decode(&source, warnings)?,
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(&source, warnings)?,
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => tiff::decode(&source, color_space)?,
        [b'#', b'?', ..] => radiance::decode(&source)?,
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => webp::decode(&source)?,
        _ => return Err(source.unknown_format()),
    };
    let color_space = match &mut pixels {
        Pixels::Byte(_) => color_space,
        Pixels::Float(pixels) => {
            mend(pixels, place, warnings);
            ColorSpace::Linear
        }
    };
    // `check_size` has bounded both edges.
    let (width, height) = (width as u32, height as u32);
    Ok(Image { name: place.to_string(), path: None, width, height, color_space, pixels })
}

/// Width, height and pixels, as a format's decoder returns them.
type Decoded = Result<([usize; 2], Pixels), SceneError>;

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
    use translucid_testing::mutants;

    use super::*;

    fn decoded(bytes: &[u8]) -> Result<Image, SceneError> {
        decode_image(&Place::file(Path::new("a.png")), bytes, ColorSpace::Srgb, &mut Vec::new())
    }

    fn is_sound(image: &Image) -> bool {
        image.validate().is_ok()
    }

    #[test]
    fn image_of_unknown_format_is_refused_with_its_name() {
        for (bytes, part) in [
            (&b""[..], "is empty"),
            (b"\x89PN", "not an image of a known format"),
            (b"GIF89a", "PNG, JPEG, TIFF, OpenEXR and Radiance HDR can be read"),
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
        let others = [png::example(), exr::example(), radiance::example(), tiff::example()];
        for file in jpegs.map(<[u8]>::to_vec).into_iter().chain(others) {
            assert!(decoded(&file).is_ok());
            for mutant in mutants(&file, 2_000) {
                assert!(decoded(&mutant).map_or(true, |image| is_sound(&image)));
            }
        }
    }
}
