//! Photographs in linear numbers, and what is wrong with them.

use std::path::Path;

use translucid_load::load_image;
use translucid_measure::Photo;
use translucid_scene::{ColorSpace, Pixels, Place};

use super::arguments::MeasureArguments;
use super::report::three_digits;
use crate::failure::Failure;
use crate::messages;

/// Share of pixels at the end of their range from which on a photograph counts as clipped.
const CLIPPED: f64 = 1e-3;

/// Share from which on nothing is measured.
const TOO_MUCH_CLIPPED: f64 = 0.05;

/// Part of the light by which the dark may be brighter because a file holds nothing below 0.
const CUT_NOISE: f64 = 1e-3;

/// A photograph in linear numbers.
pub(super) fn load(path: &Path, arguments: &MeasureArguments) -> Result<Photo, Failure> {
    let color_space = if arguments.linear { ColorSpace::Linear } else { ColorSpace::Srgb };
    let mut warnings = Vec::new();
    let image = load_image(path, color_space, &mut warnings)?;
    messages::print_warnings(&warnings);
    if matches!(image.pixels, Pixels::Byte(_)) && color_space == ColorSpace::Srgb {
        let message = format!(
            "{}: 8-bit values are taken as sRGB; cameras bend them at will, and lengths with them: better \
                 develop the raw file to linear OpenEXR",
            path.display()
        );
        messages::print_warning(&message);
    }
    let pixel = |x: usize, y: usize| {
        let [r, g, b, _] = image.texel(x as u32, y as u32);
        [r, g, b]
    };
    Ok(Photo::from_fn(image.width as usize, image.height as usize, pixel))
}

/// Warns of light that is cut off, and refuses where that is much of it.
pub(super) fn check_clipping(part: &Photo, path: &Path) -> Result<(), Failure> {
    let share = part.clipped();
    let message =
        format!("{:.1} % of the values are at the end of their range, where light is lost", 100.0 * share);
    let help = "expose less, add a shorter --exposure, or leave highlights out by --region";
    if share > TOO_MUCH_CLIPPED {
        return Err(refusal(path, message).with_help(help));
    }
    if share > CLIPPED {
        messages::print_warning(&format!("{}: {message}: {help}", path.display()));
    }
    warn_of_cut_noise(part, path, part);
    Ok(())
}

/// Warns of values below 0 that the file has as 0, which makes the dark brighter, where that counts beside the light.
pub(super) fn warn_of_cut_noise(part: &Photo, path: &Path, lit: &Photo) {
    let light = lit.mean().into_iter().fold(f64::MIN_POSITIVE, f64::max);
    let gained = part.cut_noise() / light;
    if gained > CUT_NOISE {
        messages::print_warning(&format!(
            "{}: noise below 0 is cut off, which brightens the dark by up to {} % of the light: save as OpenEXR with \
             negative values, or without the camera's black level subtracted, which --dark does better",
            path.display(),
            three_digits(100.0 * gained)
        ));
    }
}

/// Subtracts a photograph with the light off, which must have the same size.
pub(super) fn subtract(photo: &mut Photo, dark: &Photo) -> Result<(), String> {
    let [size, of_dark] = [&*photo, dark].map(|photo| [photo.width, photo.height]);
    if size != of_dark {
        let [w, h] = of_dark;
        return Err(format!("is {w}×{h} pixels, but the photograph is {}×{}", size[0], size[1]));
    }
    for (pixel, dark) in photo.pixels.iter_mut().zip(&dark.pixels) {
        for (value, dark) in pixel.iter_mut().zip(dark) {
            *value -= dark;
        }
    }
    Ok(())
}

/// A rectangle of the photograph; refuses one that reaches beyond it, naming the option that states it.
pub(super) fn part(
    photo: &Photo,
    path: &Path,
    option: &str,
    rectangle: [usize; 4],
) -> Result<Photo, Failure> {
    let [_, _, x1, y1] = rectangle;
    if x1 > photo.width || y1 > photo.height {
        let message = format!(
            "{option} ends at {x1},{y1}, but the photograph is {}×{} pixels",
            photo.width, photo.height
        );
        return Err(refusal(path, message));
    }
    Ok(photo.part(rectangle))
}

/// A fault of a photograph.
pub(super) fn refusal(path: &Path, message: impl Into<String>) -> Failure {
    Failure { place: Some(Place::file(path)), ..Failure::input(message) }
}
