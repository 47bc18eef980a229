//! Rectangles of pixels.

/// A rectangle of pixels; none is empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// First column.
    pub left: u32,
    /// First row, from the top.
    pub top: u32,
    /// Number of columns.
    pub width: u32,
    /// Number of rows.
    pub height: u32,
}

impl PixelRect {
    /// Number of pixels.
    #[must_use]
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// The pixels that both rectangles have, if any.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let (left, top) = (self.left.max(other.left), self.top.max(other.top));
        let right = (self.left + self.width).min(other.left + other.width);
        let bottom = (self.top + self.height).min(other.top + other.height);
        (left < right && top < bottom).then(|| Self { left, top, width: right - left, height: bottom - top })
    }

    /// Coordinates of all pixels, row by row.
    pub fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        let columns = self.left..self.left + self.width;
        (self.top..self.top + self.height).flat_map(move |y| columns.clone().map(move |x| (x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intersection_has_the_pixels_of_both() {
        let rect = |left, top, width, height| PixelRect { left, top, width, height };
        let (a, b) = (rect(2, 3, 5, 4), rect(4, 0, 9, 5));
        let common: Vec<_> = a.pixels().filter(|at| b.pixels().any(|other| other == *at)).collect();
        assert_eq!(a.intersection(&b).map(|both| both.pixels().collect()), Some(common));
        assert_eq!(a.intersection(&rect(7, 3, 1, 1)), None);
    }
}
