//! Rectangles of pixels.

use std::ops::Range;

/// A rectangle of pixels, which end below 2³².
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
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
    /// The rectangle that is all of a picture of this width and height.
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { left: 0, top: 0, width, height }
    }

    /// Numbers of the columns.
    pub fn columns(&self) -> Range<u32> {
        self.left..self.left.saturating_add(self.width)
    }

    /// Numbers of the rows.
    pub fn rows(&self) -> Range<u32> {
        self.top..self.top.saturating_add(self.height)
    }

    /// Number of pixels.
    pub fn area(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Returns whether there are pixels and all of them are those of a picture of this width and height.
    pub fn is_within(&self, [width, height]: [u32; 2]) -> bool {
        self.area() > 0 && self.columns().end <= width && self.rows().end <= height
    }

    /// The pixels that both rectangles have, if any.
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let common = |a: Range<u32>, b: Range<u32>| a.start.max(b.start)..a.end.min(b.end);
        let columns = common(self.columns(), other.columns());
        let rows = common(self.rows(), other.rows());
        let (left, top) = (columns.start, rows.start);
        let has_pixels = !columns.is_empty() && !rows.is_empty();
        has_pixels.then(|| Self { left, top, width: columns.end - left, height: rows.end - top })
    }

    /// Coordinates of all pixels, row by row.
    pub fn pixels(self) -> impl Iterator<Item = (u32, u32)> {
        self.rows().flat_map(move |y| self.columns().map(move |x| (x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rect_has_the_pixels_between_its_ends() {
        let rect = PixelRect { left: 2, top: 3, width: 5, height: 1 };
        assert_eq!(rect.pixels().collect::<Vec<_>>(), [(2, 3), (3, 3), (4, 3), (5, 3), (6, 3)]);
        assert!(rect.is_within([7, 4]) && !rect.is_within([6, 4]) && !rect.is_within([7, 3]));
        for empty in [PixelRect { width: 0, ..rect }, PixelRect { height: 0, ..rect }] {
            assert!(empty.area() == 0 && !empty.is_within([9, 9]));
        }
        assert!(PixelRect::whole([7, 4]).is_within([7, 4]));
        assert!(!PixelRect { left: u32::MAX, ..rect }.is_within([7, 4]));
    }

    #[test]
    fn intersection_has_the_pixels_of_both() {
        let a = PixelRect { left: 1, top: 2, width: 4, height: 3 };
        let b = PixelRect { left: 3, top: 0, width: 9, height: 4 };
        let both: Vec<_> = a.pixels().filter(|pixel| b.pixels().any(|other| other == *pixel)).collect();
        assert_eq!(a.intersection(&b).unwrap().pixels().collect::<Vec<_>>(), both);
        assert_eq!(a.intersection(&PixelRect { left: 5, ..b }), None);
    }
}
