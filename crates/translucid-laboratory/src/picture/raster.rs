//! Pixels to show, and the colors of maps.

use std::io;

use translucid_image::CodedPicture;

use crate::chart::Shade;

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

    /// Codes of 8 bits, three a pixel.
    fn codes(&self) -> impl Iterator<Item = [u8; 3]> {
        self.pixels.iter().map(|color| color.map(|value| (value.clamp(0.0, 1.0) * 255.0).round() as u8))
    }

    /// A PNG that names the program that made it.
    ///
    /// # Errors
    /// There is no pixel, or more than the format can hold.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let codes: Vec<u8> = self.codes().flatten().collect();
        let software = concat!("translucid ", env!("CARGO_PKG_VERSION"));
        CodedPicture::rgb([self.width, self.height], &codes).with_text("Software", software).encode()
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

#[cfg(test)]
mod tests {
    use super::super::tests::noise;
    use super::*;

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
