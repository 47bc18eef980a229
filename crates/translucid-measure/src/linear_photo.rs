//! Photographs in linear numbers.

use std::path::Path;

use translucid_scene::{ColorSpace, Image, Pixels};

use crate::error::MeasureError;
use crate::remark::Remark;

/// A photograph, or a part of one: linear red, green and blue in rows from top to bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width × height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

/// A photograph, and what messages call it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedPhoto {
    /// Name of its file, or of the argument that it came by.
    pub name: String,
    /// Its pixels.
    pub photo: Photo,
}

impl NamedPhoto {
    /// The photograph in a decoded image, over black where it is transparent, with a warning where the values are those of a
    /// camera's own curve.
    pub fn from_image(name: String, image: &Image, say: &mut dyn FnMut(Remark)) -> Self {
        if matches!(image.pixels, Pixels::Byte(_)) && image.color_space == ColorSpace::Srgb {
            say(Remark::Warning(format!(
                "{name}: 8-bit values are taken as sRGB; cameras bend them at will, and lengths with them: better \
                 develop the raw file to linear OpenEXR"
            )));
        }
        // OpenEXR has colors times alpha [Kainz, Bogart and Stanczyk: Technical Introduction to OpenEXR], all others beside it
        let ending = image.path.as_deref().and_then(Path::extension);
        let is_multiplied = ending.is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
        let mut is_transparent = false;
        let photo = Photo::from_fn(image.width as usize, image.height as usize, |x, y| {
            let [r, g, b, alpha] = image.texel(x as u32, y as u32);
            is_transparent |= alpha < 1.0;
            [r, g, b].map(|value| if is_multiplied { value } else { value * alpha })
        });
        if is_transparent {
            say(Remark::Note(format!("{name}: what is transparent is taken to be black behind")));
        }
        Self { name, photo }
    }

    /// A rectangle of it; refuses one that reaches beyond it, naming the option that states it.
    pub(crate) fn part(&self, option: &str, rectangle: [usize; 4]) -> Result<Photo, MeasureError> {
        let [_, _, x1, y1] = rectangle;
        let Photo { width, height, .. } = self.photo;
        if x1 > width || y1 > height {
            let message =
                format!("`{option}` ends at {x1},{y1}, but the photograph is {width}×{height} pixels");
            return Err(MeasureError::of_photo(&self.name, message));
        }
        Ok(self.photo.part(rectangle))
    }

    /// Refuses a photograph of another size than the one that it belongs to.
    pub(crate) fn require_size_of(&self, photo: &Photo) -> Result<(), MeasureError> {
        let [[w, h], size] = [&self.photo, photo].map(|photo| [photo.width, photo.height]);
        if size == [w, h] {
            return Ok(());
        }
        let message = format!("is {w}×{h} pixels, but the photograph is {}×{}", size[0], size[1]);
        Err(MeasureError::of_photo(&self.name, message))
    }
}

impl Photo {
    /// A photograph of pixels by column and row.
    pub fn from_fn(width: usize, height: usize, mut pixel: impl FnMut(usize, usize) -> [f32; 3]) -> Self {
        let at = |i: usize| pixel(i % width, i / width);
        Self { width, height, pixels: (0..width * height).map(at).collect() }
    }

    /// The pixels from (x0, y0) to before (x1, y1), as many of them as there are.
    pub fn part(&self, [x0, y0, x1, y1]: [usize; 4]) -> Self {
        let (x1, y1) = (x1.min(self.width), y1.min(self.height));
        let (x0, y0) = (x0.min(x1), y0.min(y1));
        Self::from_fn(x1 - x0, y1 - y0, |x, y| self.at(x0 + x, y0 + y))
    }

    /// The pixel in a column and a row.
    pub fn at(&self, x: usize, y: usize) -> [f32; 3] {
        self.pixels[y * self.width + x]
    }

    /// The share of values that are 1, where a camera or a file has cut off what is brighter; 0 where some are greater.
    pub fn clipped(&self) -> f64 {
        if self.greatest().into_iter().fold(0.0, f32::max) != 1.0 {
            return 0.0;
        }
        let count = self.pixels.iter().flatten().filter(|value| **value == 1.0).count();
        count as f64 / (3 * self.pixels.len()) as f64
    }

    /// Subtracts a photograph with the light off, of the same size.
    pub(crate) fn subtract(&mut self, dark: &Self) {
        for (pixel, dark) in self.pixels.iter_mut().zip(&dark.pixels) {
            for (value, dark) in pixel.iter_mut().zip(dark) {
                *value -= dark;
            }
        }
    }

    /// The greatest value of each channel, at least 0.
    pub(crate) fn greatest(&self) -> [f32; 3] {
        self.pixels.iter().fold([0.0; 3], |most, pixel| std::array::from_fn(|c| f32::max(most[c], pixel[c])))
    }

    /// Mean of the channels in a column and a row.
    pub(crate) fn gray(&self, x: usize, y: usize) -> f64 {
        self.at(x, y).iter().map(|v| f64::from(*v)).sum::<f64>() / 3.0
    }

    /// Mean of all pixels.
    pub fn mean(&self) -> [f64; 3] {
        let count = self.pixels.len().max(1) as f64;
        std::array::from_fn(|c| self.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transparent_pixels_are_over_black() {
        let image = |ending: &str, pixels| Image {
            name: String::new(),
            path: Some(format!("a.{ending}").into()),
            width: 2,
            height: 1,
            color_space: ColorSpace::Linear,
            pixels,
        };
        let read = |image: &Image| {
            let mut remarks = Vec::new();
            let photo = NamedPhoto::from_image("a".into(), image, &mut |remark| remarks.push(remark));
            (photo.photo.pixels, remarks.len())
        };
        let floats = || Pixels::Float(vec![[0.5, 0.25, 0.125, 0.5], [1.0; 4]]);
        assert_eq!(read(&image("png", floats())), (vec![[0.25, 0.125, 0.0625], [1.0; 3]], 1));
        assert_eq!(read(&image("EXR", floats())), (vec![[0.5, 0.25, 0.125], [1.0; 3]], 1));
        let bytes = Pixels::Byte(vec![[255, 0, 0, 0], [0, 255, 0, 255]]);
        assert_eq!(read(&image("png", bytes)), (vec![[0.0; 3], [0.0, 1.0, 0.0]], 1));
        let opaque = Pixels::Float(vec![[0.5, 0.25, 0.125, 1.0]; 2]);
        assert_eq!(read(&image("png", opaque)), (vec![[0.5, 0.25, 0.125]; 2], 0));
    }
}
