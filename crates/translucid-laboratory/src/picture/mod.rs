//! Rendered pictures beside each other: how far they are apart, maps of that, and a sheet that shows it all.
//!
//! - [`Picture`]: the light of a picture, and what a display shows of it.
//! - [`relative_mse`], [`relative_noise`], [`relative_noise_of_difference`], [`relative_difference`]: distances
//!   of light, in numbers and from pixel to pixel.
//! - [`FlipMap`]: the difference that a viewer sees, ꟻLIP.
//! - [`Raster`]: pixels to show, of a picture or of a map; they become a PNG.
//! - [`Sheet`]: pictures and their maps in columns with words below them, as an SVG.

mod errors;
mod flip;
mod raster;
mod sheet;

pub use errors::{
    RELATIVE_FLOOR, relative_difference, relative_mse, relative_noise, relative_noise_of_difference,
};
pub use flip::{FlipMap, PIXELS_PER_DEGREE};
pub use raster::{DIFFERENCE_RANGE, Raster, difference_color, flip_color};
pub use sheet::{Sheet, SheetColumn};

/// A rendered picture, row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    radiance: Vec<[f32; 3]>,
    alpha: Vec<f32>,
    display: Vec<[f32; 3]>,
}

/// A pixel of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PicturePixel {
    /// Linear Rec. 709 radiance, multiplied by coverage.
    pub radiance: [f32; 3],
    /// Coverage; 0 is background.
    pub alpha: f32,
    /// Values that a display shows: sRGB-encoded, in \[0, 1\].
    pub display: [f32; 3],
}

impl Picture {
    /// A picture of a size from its pixels; a value that is not finite counts as 0, a missing pixel as black.
    pub fn new(width: usize, height: usize, pixels: impl IntoIterator<Item = PicturePixel>) -> Self {
        let count = width.saturating_mul(height);
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let black = PicturePixel { radiance: [0.0; 3], alpha: 0.0, display: [0.0; 3] };
        let mut picture =
            Self { width, height, radiance: Vec::new(), alpha: Vec::new(), display: Vec::new() };
        for pixel in pixels.into_iter().chain(std::iter::repeat(black)).take(count) {
            picture.radiance.push(pixel.radiance.map(finite));
            picture.alpha.push(finite(pixel.alpha));
            picture.display.push(pixel.display.map(|value| finite(value).clamp(0.0, 1.0)));
        }
        picture
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Linear Rec. 709 radiance.
    pub fn radiance(&self) -> &[[f32; 3]] {
        &self.radiance
    }

    /// Values that a display shows: sRGB-encoded, in \[0, 1\].
    pub fn display(&self) -> &[[f32; 3]] {
        &self.display
    }

    /// Returns whether a surface or a visible environment covers some of a pixel.
    fn is_covered(&self, index: usize) -> bool {
        self.alpha[index] > 0.0
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::random::random;

    /// A picture whose display shows its light as it is.
    pub(crate) fn picture(width: usize, height: usize, color: impl Fn(usize, usize) -> [f32; 3]) -> Picture {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels = places.map(|(x, y)| color(x, y));
        Picture::new(
            width,
            height,
            pixels.map(|color| PicturePixel { radiance: color, alpha: 1.0, display: color }),
        )
    }

    /// A picture of colors drawn at random.
    pub(crate) fn noise(width: usize, height: usize, seed: u64) -> Picture {
        picture(width, height, |x, y| {
            [0, 1, 2].map(|channel| random(seed, ((y * width + x) * 3 + channel) as u64) as f32)
        })
    }

    #[test]
    fn picture_has_finite_numbers_only() {
        let odd =
            PicturePixel { radiance: [f32::NAN, f32::INFINITY, -1.0], alpha: f32::NAN, display: [9.0; 3] };
        let picture = Picture::new(2, 1, [odd]);
        assert_eq!(picture.radiance(), [[0.0, 0.0, -1.0], [0.0; 3]]);
        assert_eq!(picture.display(), [[1.0; 3], [0.0; 3]]);
        assert!(!picture.is_covered(0));
    }
}
