//! Pixels to show, and the colors of maps.

use std::io;

use crate::chart::Shade;
use crate::png_bytes::encode_png;

/// Relative difference at which [`difference_color`] is at its end: half as bright again as the reference.
pub const DIFFERENCE_RANGE: f32 = 0.5;

/// Pixels as a display shows them, row by row: sRGB-encoded, in \[0, 1\].
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Raster {
    /// Pixels of a size; missing ones are black.
    pub fn new(width: usize, height: usize, mut pixels: Vec<[f32; 3]>) -> Self {
        pixels.resize(width.saturating_mul(height), [0.0; 3]);
        Self { width, height, pixels }
    }

    /// A map of values in the colors of a scale.
    pub fn of_map(width: usize, height: usize, values: &[f32], color: fn(f32) -> [f32; 3]) -> Self {
        Self::new(width, height, values.iter().map(|&value| color(value)).collect())
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels in another size: each new one has the mean light of what it covers.
    pub fn resized(&self, width: usize, height: usize) -> Self {
        if (width, height) == (self.width, self.height) || self.pixels.is_empty() {
            return Self::new(width, height, self.pixels.clone());
        }
        let linear: Vec<[f32; 3]> = self.pixels.iter().map(|color| color.map(decode)).collect();
        let [columns, rows] = [covers(self.width, width), covers(self.height, height)];
        // Each old row in the new width, then the new rows of those
        let narrow: Vec<[f32; 3]> = linear
            .chunks_exact(self.width)
            .flat_map(|row| columns.iter().map(|cover| cover.mean(|x| row[x])))
            .collect();
        let pixels = rows.iter().flat_map(|span| {
            let narrow = &narrow;
            (0..width).map(move |x| span.mean(|y| narrow[y * width + x]).map(encode))
        });
        Self::new(width, height, pixels.collect())
    }

    /// Codes of 8 bits, three a pixel.
    pub(crate) fn codes(&self) -> impl Iterator<Item = [u8; 3]> {
        self.pixels.iter().map(|color| color.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    }

    /// A PNG that says which program has made it.
    ///
    /// # Errors
    /// There is no pixel, or more than the format can hold.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let codes: Vec<u8> = self.codes().flatten().collect();
        encode_png([self.width, self.height], &codes, None)
    }
}

/// The color of a ꟻLIP error in \[0, 1\]: magma, from black for none to nearly white.
pub fn flip_color(error: f32) -> [f32; 3] {
    let index = (error.clamp(0.0, 1.0) * 255.0).round() as usize;
    flip_rs::MAGMA[index.min(255)]
}

/// The color of a relative difference: from blue at −[`DIFFERENCE_RANGE`], which is darker than the reference, over
/// white to orange at +[`DIFFERENCE_RANGE`].
pub fn difference_color(difference: f32) -> [f32; 3] {
    let part = (difference / DIFFERENCE_RANGE).clamp(-1.0, 1.0);
    let end = if part < 0.0 { Shade::BLUE } else { Shade::VERMILION };
    let [end, middle] = [end, Shade::BACKGROUND].map(Shade::components);
    [0, 1, 2].map(|c| middle[c] + part.abs() * (end[c] - middle[c]))
}

/// Part of the old pixels along an axis that a new one covers.
struct Cover {
    first: usize,
    /// Weights that add up to 1.
    weights: Vec<f32>,
}

impl Cover {
    fn mean(&self, color: impl Fn(usize) -> [f32; 3]) -> [f32; 3] {
        let mut sum = [0.0; 3];
        for (i, &weight) in self.weights.iter().enumerate() {
            let color = color(self.first + i);
            for c in 0..3 {
                sum[c] += weight * color[c];
            }
        }
        sum
    }
}

/// The covers of `new` pixels over `old` ones.
fn covers(old: usize, new: usize) -> Vec<Cover> {
    let scale = old as f64 / new as f64;
    let cover_of = |i: usize| {
        let [left, right] = [i, i + 1].map(|edge| edge as f64 * scale);
        let first = (left as usize).min(old - 1);
        let last = (right.ceil() as usize).clamp(first + 1, old);
        let cover = |j: usize| ((j + 1) as f64).min(right) - (j as f64).max(left);
        let weights: Vec<f64> = (first..last).map(|j| cover(j).max(0.0)).collect();
        let sum: f64 = weights.iter().sum();
        Cover { first, weights: weights.into_iter().map(|weight| (weight / sum) as f32).collect() }
    };
    (0..new).map(cover_of).collect()
}

/// sRGB to linear \[IEC 61966-2-1\].
fn decode(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// Linear to sRGB.
fn encode(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::super::tests::noise;
    use super::*;

    fn mean(raster: &Raster) -> f32 {
        raster.pixels.as_flattened().iter().map(|&value| decode(value)).sum::<f32>()
            / (3 * raster.pixels.len()) as f32
    }

    #[test]
    fn resized_keeps_the_mean_of_light() {
        let raster = Raster::new(37, 23, noise(37, 23, 1).display().to_vec());
        for (width, height) in [(12, 9), (80, 50), (1, 1), (37, 100), (200, 3)] {
            let other = raster.resized(width, height);
            assert_eq!((other.width(), other.height()), (width, height));
            assert!((mean(&other) - mean(&raster)).abs() < 1e-4, "{width}x{height}");
        }
        assert_eq!(raster.resized(37, 23), raster);
    }

    #[test]
    fn resized_repeats_pixels_where_it_grows_by_a_whole_number() {
        let raster = Raster::new(2, 1, vec![[0.0, 0.5, 1.0], [1.0, 0.0, 0.25]]);
        let grown: Vec<[u8; 3]> = raster.resized(4, 2).codes().collect();
        let [a, b] = [[0, 128, 255], [255, 0, 64]];
        assert_eq!(grown, [a, a, b, b, a, a, b, b]);
    }

    #[test]
    fn colors_of_maps_meet_their_ends() {
        let codes = |color: [f32; 3]| color.map(|value| (value * 255.0).round() as u8);
        // matplotlib 3.11, `magma`, entries 0, 128 and 255
        for (error, expected) in [(0.0, [0, 0, 4]), (128.0 / 255.0, [183, 55, 121]), (1.0, [252, 253, 191])] {
            let found = codes(flip_color(error));
            assert!((0..3).all(|c| found[c].abs_diff(expected[c]) <= 1), "{error} {found:?} {expected:?}");
        }
        assert_eq!(codes(flip_color(f32::NAN)), codes(flip_color(0.0)));
        assert_eq!(codes(difference_color(0.0)), [255; 3]);
        assert_eq!(codes(difference_color(-9.0)), [0x00, 0x72, 0xb2]);
        assert_eq!(codes(difference_color(DIFFERENCE_RANGE)), [0xd5, 0x5e, 0x00]);
    }

    #[test]
    fn png_reads_back_and_names_its_maker() {
        let raster = Raster::new(5, 3, noise(5, 3, 2).display().to_vec());
        let bytes = raster.png().unwrap();
        assert!(bytes.windows(10).any(|part| part == b"translucid"));
        let mut reader = png::Decoder::new(io::Cursor::new(bytes)).read_info().unwrap();
        let mut codes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut codes).unwrap();
        assert_eq!(codes, raster.codes().flatten().collect::<Vec<u8>>());
        assert!(Raster::new(0, 0, Vec::new()).png().is_err());
    }
}
