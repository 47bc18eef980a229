//! Decoded images and their lookup.

use std::path::PathBuf;
use std::sync::LazyLock;

use rayon::prelude::*;

use crate::{SceneError, Wrap};
use translucid_words::{WholeInterval, refusal};

/// Relation of stored values to linear light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// sRGB transfer curve: colors in 8-bit files.
    Srgb,
    /// Values as they are: data, normals, float images.
    Linear,
}

/// How the numbers of an image file become an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ImageKind {
    /// Colors: in the color space that the file states, or else in this one.
    Color(ColorSpace),
    /// Numbers in this color space, whatever the file states: data, and colors of formats that name the space themselves.
    Plain(ColorSpace),
}

impl ImageKind {
    /// The color space of a file that states none.
    pub fn color_space(self) -> ColorSpace {
        match self {
            Self::Color(color_space) | Self::Plain(color_space) => color_space,
        }
    }
}

/// Pixels in rows from top to bottom, four channels red, green, blue, alpha.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// 8 bits a channel, to be decoded by the image's color space (alpha is always linear).
    Byte(Vec<[u8; 4]>),
    /// Linear half or full precision data; finite.
    Float(Vec<[f32; 4]>),
}

/// A decoded image of `width × height` pixels, both in [1, 32768], at most 2²⁸ together.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Name for messages, usually the file's.
    pub name: String,
    /// The file that holds the image alone; none if it came out of another file or no file.
    pub path: Option<PathBuf>,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Color space of `Pixels::Byte` data.
    pub color_space: ColorSpace,
    /// The data.
    pub pixels: Pixels,
}

impl Image {
    /// Linear red, green, blue, alpha of the pixel in column `x` from the left and row `y` from the top.
    ///
    /// Beyond the edge, the edge's pixel.
    pub fn texel(&self, x: u32, y: u32) -> [f32; 4] {
        let column = x.min(self.width.saturating_sub(1)) as usize;
        let row = y.min(self.height.saturating_sub(1)) as usize;
        self.at(row * self.width as usize + column)
    }

    /// Linear value of a pixel by its place in the data; 0 where there is none.
    fn at(&self, index: usize) -> [f32; 4] {
        match &self.pixels {
            Pixels::Byte(pixels) => pixels.get(index).map_or([0.0; 4], |&p| self.decode(p)),
            Pixels::Float(pixels) => pixels.get(index).copied().unwrap_or_default(),
        }
    }

    /// Number of pixels in the data.
    fn len(&self) -> usize {
        match &self.pixels {
            Pixels::Byte(pixels) => pixels.len(),
            Pixels::Float(pixels) => pixels.len(),
        }
    }

    /// Bilinear interpolation of linear values at image coordinates (u, v), v upward.
    ///
    /// The image covers the unit square: the pixel in column i, row j from the top has its center at
    /// u = (i + ½)/width, v = 1 − (j + ½)/height.
    /// A coordinate that is not finite counts as 0.
    pub fn bilinear(&self, u: f32, v: f32, wrap: [Wrap; 2]) -> [f32; 4] {
        let (columns, s) = neighbors(wrapped(u, wrap[0]), self.width, wrap[0]);
        let (rows, t) = neighbors(1.0 - wrapped(v, wrap[1]), self.height, wrap[1]);
        let row = |y| mix(self.texel(columns[0], y), self.texel(columns[1], y), s);
        mix(row(rows[0]), row(rows[1]), t)
    }

    /// Linear value of the pixel whose square holds image coordinates, which count as for [`bilinear`](Self::bilinear).
    pub fn nearest(&self, u: f32, v: f32, wrap: [Wrap; 2]) -> [f32; 4] {
        let (columns, s) = neighbors(wrapped(u, wrap[0]), self.width, wrap[0]);
        let (rows, t) = neighbors(1.0 - wrapped(v, wrap[1]), self.height, wrap[1]);
        self.texel(columns[usize::from(s >= 0.5)], rows[usize::from(t >= 0.5)])
    }

    /// Mean of the linear values over all pixels.
    pub fn mean(&self) -> [f32; 4] {
        let mut sum = [0.0_f64; 4];
        for value in (0..self.len()).map(|index| self.at(index)) {
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += f64::from(value);
            }
        }
        sum.map(|sum| (sum / self.len().max(1) as f64) as f32)
    }

    /// Greatest linear value of each channel over all pixels.
    pub fn greatest(&self) -> [f32; 4] {
        let greater = |m: [f32; 4], p: [f32; 4]| std::array::from_fn(|i| m[i].max(p[i]));
        (0..self.len()).map(|index| self.at(index)).fold([f32::NEG_INFINITY; 4], greater)
    }

    /// Longest edge in pixels.
    pub const LONGEST_EDGE: usize = 32_768;
    /// Most pixels.
    pub const MOST_PIXELS: usize = 1 << 28;

    /// Checks the size, and that every value is finite.
    ///
    /// # Errors
    /// There are no pixels or too many, as many as `width × height` they are not, or a value is not finite.
    pub fn validate(&self) -> Result<(), SceneError> {
        self.check().map_err(|error| error.within_named("image", &self.name))
    }

    pub(crate) fn check(&self) -> Result<(), SceneError> {
        let edge = WholeInterval::new(1, Self::LONGEST_EDGE as u64);
        edge.check("width", self.width)?;
        edge.check("height", self.height)?;
        let (width, count) = (self.width as usize, self.width as usize * self.height as usize);
        if count > Self::MOST_PIXELS {
            let must_be = format!("at most {}", Self::MOST_PIXELS);
            return Err(refusal("width * height", count, must_be));
        }
        if self.len() != count {
            return Err(refusal("pixels.len()", self.len(), format!("width * height = {count}")));
        }
        let Pixels::Float(pixels) = &self.pixels else { return Ok(()) };
        let is_bad = |pixel: &[f32; 4]| !pixel.iter().fold(true, |all, value| all & value.is_finite());
        match pixels.par_iter().position_first(is_bad) {
            Some(i) => Err(refusal(
                format_args!("pixel ({}, {})", i % width, i / width),
                format_args!("{:?}", pixels[i]),
                "finite",
            )),
            None => Ok(()),
        }
    }

    fn decode(&self, [r, g, b, a]: [u8; 4]) -> [f32; 4] {
        let linear = |byte: u8| f32::from(byte) * (1.0 / 255.0);
        match self.color_space {
            ColorSpace::Srgb => {
                let table = &*SRGB_TABLE;
                [table[usize::from(r)], table[usize::from(g)], table[usize::from(b)], linear(a)]
            }
            ColorSpace::Linear => [r, g, b, a].map(linear),
        }
    }
}

/// Linear value of an sRGB value, both in [0, 1] (IEC 61966-2-1:1999, section 5.2).
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

/// `linear_from_srgb` of every byte.
pub static SRGB_TABLE: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));

/// A coordinate brought to [0, 1].
fn wrapped(coordinate: f32, wrap: Wrap) -> f32 {
    if !coordinate.is_finite() {
        return 0.0;
    }
    match wrap {
        Wrap::Repeat => coordinate - coordinate.floor(),
        Wrap::Mirror => {
            let half = 0.5 * coordinate;
            1.0 - (2.0 * (half - half.floor()) - 1.0).abs()
        }
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
    }
}

/// The two pixels around a coordinate in [0, 1], and the weight of the second.
fn neighbors(coordinate: f32, size: u32, wrap: Wrap) -> ([u32; 2], f32) {
    let position = coordinate * size as f32 - 0.5;
    let first = position.floor();
    let last = i64::from(size.max(1)) - 1;
    let inside = |index: i64| match wrap {
        Wrap::Repeat if index < 0 => last,
        Wrap::Repeat if index > last => 0,
        _ => index.clamp(0, last), // A mirror image meets its edge pixel with itself.
    };
    let index = first as i64;
    ([inside(index) as u32, inside(index + 1) as u32], position - first)
}

fn mix(a: [f32; 4], b: [f32; 4], weight: f32) -> [f32; 4] {
    std::array::from_fn(|i| a[i] * (1.0 - weight) + b[i] * weight)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];

    /// 3 × 2 pixels whose red is 0, 1, 2 in the top row and 3, 4, 5 in the bottom row.
    fn ramp() -> Image {
        let pixels = (0..6).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        Image {
            name: String::from("ramp"),
            path: None,
            width: 3,
            height: 2,
            color_space: ColorSpace::Linear,
            pixels: Pixels::Float(pixels),
        }
    }

    fn bytes(color_space: ColorSpace, pixels: Vec<[u8; 4]>) -> Image {
        let width = pixels.len() as u32;
        Image { name: String::new(), path: None, width, height: 1, color_space, pixels: Pixels::Byte(pixels) }
    }

    #[test]
    fn bilinear_at_texel_centers_is_the_texel() {
        let image = ramp();
        for wrap in WRAPS {
            for (x, y) in (0..3).flat_map(|x| (0..2).map(move |y| (x, y))) {
                let u = (x as f32 + 0.5) / 3.0;
                let v = 1.0 - (y as f32 + 0.5) / 2.0;
                let value = image.bilinear(u, v, [wrap; 2])[0];
                assert!((value - image.texel(x, y)[0]).abs() < 1e-5, "{wrap:?} {x} {y}: {value}");
            }
        }
    }

    #[test]
    fn bilinear_is_linear_between_texels() {
        let value = ramp().bilinear(1.25 / 3.0, 0.5, [Wrap::Clamp; 2])[0];
        assert!((value - (0.75 + 1.5)).abs() < 1e-5, "{value}");
    }

    #[test]
    fn nearest_is_the_pixel_all_over_its_square() {
        for wrap in WRAPS {
            let at = |u: f32, v: f32| ramp().nearest(u, v, [wrap; 2])[0];
            for (column, u) in [(0.0, 0.01), (0.0, 0.32), (1.0, 0.34), (1.0, 0.66), (2.0, 0.67), (2.0, 0.99)]
            {
                assert_eq!(
                    [at(u, 0.99), at(u, 0.51), at(u, 0.49), at(u, 0.01)],
                    [column, column, column + 3.0, column + 3.0]
                );
            }
        }
        let at = |u: f32, wrap| ramp().nearest(u, 0.75, [wrap; 2])[0];
        assert_eq!([at(1.1, Wrap::Repeat), at(1.1, Wrap::Mirror), at(1.1, Wrap::Clamp)], [0.0, 2.0, 2.0]);
    }

    #[test]
    fn bilinear_wraps_as_told() {
        let image = ramp();
        let at = |u: f32, wrap| image.bilinear(u, 0.75, [wrap; 2])[0];
        // The edge u = 0 is midway between the first pixel and what lies beyond.
        for (wrap, edge, beyond, far) in
            [(Wrap::Repeat, 1.0, 2.0, 0.0), (Wrap::Mirror, 0.0, 0.0, 2.0), (Wrap::Clamp, 0.0, 0.0, 2.0)]
        {
            assert!((at(0.0, wrap) - edge).abs() < 1e-5, "{wrap:?}");
            assert!((at(-0.5 / 3.0, wrap) - beyond).abs() < 1e-5, "{wrap:?}");
            assert!((at(1.0 + 0.5 / 3.0, wrap) - far).abs() < 1e-5, "{wrap:?}");
        }
        assert!((at(1.0 + 2.5 / 3.0, Wrap::Mirror) - 0.0).abs() < 1e-5);
        assert!((at(2.0 + 1.5 / 3.0, Wrap::Mirror) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn bilinear_survives_any_coordinate() {
        let image = ramp();
        let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN, 1e9, -1e-30, 1.0, -1.0];
        for wrap in WRAPS {
            for (u, v) in odd.into_iter().flat_map(|u| odd.map(|v| (u, v))) {
                let value = image.bilinear(u, v, [wrap; 2])[0];
                assert!((0.0..=5.0).contains(&value), "{u} {v} {wrap:?}: {value}");
            }
        }
    }

    #[test]
    fn texel_decodes_colors_but_not_alpha_or_data() {
        let colors = bytes(ColorSpace::Srgb, vec![[0, 188, 255, 128]]).texel(0, 0);
        // sRGB 188 is 50.3 % linear.
        assert!((colors[1] - 0.502_886).abs() < 1e-5, "{colors:?}");
        assert_eq!([colors[0], colors[2]], [0.0, 1.0]);
        assert!((colors[3] - 128.0 / 255.0).abs() < 1e-6);
        let data = bytes(ColorSpace::Linear, vec![[51, 0, 255, 0]]).texel(0, 0);
        assert!((data[0] - 0.2).abs() < 1e-6 && data[2] == 1.0);
    }

    #[test]
    fn texel_clamps_to_the_edge() {
        assert_eq!(ramp().texel(7, 9)[0], 5.0);
    }

    #[test]
    fn mean_averages_linear_values() {
        assert_eq!(ramp().mean(), [2.5, 0.0, 0.0, 1.0]);
        let grey = bytes(ColorSpace::Srgb, vec![[0; 4], [255; 4]]).mean();
        assert_eq!(grey, [0.5; 4]);
    }
}
