//! A bitmap with others in it.

use std::io::Cursor;

/// The picture with another one turned to go upwards, its upper left corner then at a place \[px\].
pub(crate) fn with_upright(picture: &[u8], lying: &[u8], at: [f64; 2]) -> Result<Vec<u8>, String> {
    let mut picture = Bitmap::read(picture)?;
    let lying = Bitmap::read(lying)?;
    let [left, top] = at.map(|x| x.round() as usize);
    for y in 0..lying.width.min(picture.height.saturating_sub(top)) {
        for x in 0..lying.height.min(picture.width.saturating_sub(left)) {
            let from = 4 * (x * lying.width + lying.width - 1 - y);
            let to = 4 * ((top + y) * picture.width + left + x);
            picture.pixels[to..to + 4].copy_from_slice(&lying.pixels[from..from + 4]);
        }
    }
    picture.write()
}

/// Rows of red, green, blue and opacity.
pub(crate) struct Bitmap {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Bitmap {
    /// Reads a picture as kuva writes them.
    pub(crate) fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut reader =
            png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|error| error.to_string())?;
        let mut pixels = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
        let frame = reader.next_frame(&mut pixels).map_err(|error| error.to_string())?;
        if frame.color_type != png::ColorType::Rgba || frame.bit_depth != png::BitDepth::Eight {
            return Err(String::from("the picture has other channels than expected"));
        }
        pixels.truncate(frame.buffer_size());
        Ok(Self { width: frame.width as usize, height: frame.height as usize, pixels })
    }

    /// Width and height.
    pub(crate) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Sets pixels, row by row in a rectangle of a width with its upper left corner at a place; what is outside is
    /// left out.
    pub(crate) fn paste(
        &mut self,
        [left, top]: [usize; 2],
        width: usize,
        codes: impl Iterator<Item = [u8; 3]>,
    ) {
        for (i, code) in codes.enumerate() {
            let (x, y) = (left + i % width, top + i / width);
            if x < self.width && y < self.height {
                let at = 4 * (y * self.width + x);
                self.pixels[at..at + 3].copy_from_slice(&code);
            }
        }
    }

    /// The pixels' red, green and blue.
    pub(crate) fn opaque(&self) -> Vec<u8> {
        self.pixels.chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect()
    }

    /// Writes the opaque picture, with the size on paper that the SVG has.
    fn write(&self) -> Result<Vec<u8>, String> {
        /// Pixels for a meter: 192 for an inch.
        const PER_METER: u32 = 7559;
        let size = [self.width, self.height].map(u32::try_from);
        let [Ok(width), Ok(height)] = size else { return Err(String::from("the picture is too large")) };
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_pixel_dims(Some(png::PixelDimensions {
            xppu: PER_METER,
            yppu: PER_METER,
            unit: png::Unit::Meter,
        }));
        let mut writer = encoder.write_header().map_err(|error| error.to_string())?;
        writer
            .write_image_data(&self.opaque())
            .and_then(|()| writer.finish())
            .map_err(|error| error.to_string())?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture as kuva writes them.
    fn picture(width: u32, height: u32, red: impl Fn(u32, u32) -> u32) -> Vec<u8> {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let pixels: Vec<u8> =
            places.flat_map(|(x, y)| [u8::try_from(red(x, y)).unwrap(), 255, 255, 255]).collect();
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header().unwrap().write_image_data(&pixels).unwrap();
        bytes
    }

    #[test]
    fn what_lay_on_the_left_stands_at_the_bottom() {
        let white = picture(10, 10, |_, _| 255);
        // Left to right 0, 1, 2, 3; the lower row 100 more
        let lying = picture(4, 2, |x, y| x + 100 * y);
        let bytes = with_upright(&white, &lying, [3.0, 5.0]).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let red = |x: usize, y: usize| pixels[3 * (10 * y + x)];
        assert_eq!([3, 4].map(|x| [5, 6, 7, 8].map(|y| red(x, y))), [[3, 2, 1, 0], [103, 102, 101, 100]]);
        assert!([red(2, 5), red(5, 5), red(3, 4), red(3, 9)].iter().all(|&value| value == 255));
    }
}
