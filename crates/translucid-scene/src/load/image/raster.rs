//! Pixels that a decoder has read, and the image made of them.

use crate::{ColorSpace, Image, Pixels, Place, Warning};

/// Pixels as a format's decoder returns them.
pub(super) struct Raster {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Pixels,
}

impl Raster {
    pub(super) fn into_image(
        mut self,
        place: &Place,
        color_space: ColorSpace,
        warnings: &mut Vec<Warning>,
    ) -> Image {
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
