//! Rectangles of pixels.

/// A half-open rectangle of pixels: columns from `x0` to before `x1`, rows from `y0` to before `y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Region {
    /// First column.
    pub x0: u32,
    /// First row.
    pub y0: u32,
    /// Column after the last.
    pub x1: u32,
    /// Row after the last.
    pub y1: u32,
}

impl Region {
    /// The region that is all of a picture of this width and height.
    #[must_use]
    pub fn whole([width, height]: [u32; 2]) -> Self {
        Self { x0: 0, y0: 0, x1: width, y1: height }
    }

    /// Width in pixels; 0 where the region ends before it begins.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.x1.saturating_sub(self.x0)
    }

    /// Height in pixels; 0 where the region ends before it begins.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.y1.saturating_sub(self.y0)
    }

    /// Tells whether the region has no pixel.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.width() == 0 || self.height() == 0
    }

    /// Tells whether the region has pixels and all of them are those of a picture of this width and height.
    #[must_use]
    pub fn is_within(&self, [width, height]: [u32; 2]) -> bool {
        !self.is_empty() && self.x1 <= width && self.y1 <= height
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn region_has_the_pixels_between_its_ends() {
        let region = Region { x0: 2, y0: 3, x1: 7, y1: 4 };
        assert_eq!((region.width(), region.height()), (5, 1));
        assert!(region.is_within([7, 4]) && !region.is_within([6, 4]) && !region.is_within([7, 3]));
        for empty in [Region { x1: 2, ..region }, Region { y1: 0, ..region }] {
            assert!(empty.is_empty() && !empty.is_within([9, 9]));
        }
        assert!(Region::whole([7, 4]).is_within([7, 4]));
    }
}
