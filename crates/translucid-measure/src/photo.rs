//! Linear pixels of a photograph.

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

impl Photo {
    /// A photograph of pixels by column and row.
    pub fn from_fn(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [f32; 3]) -> Self {
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
