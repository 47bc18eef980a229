//! The blocks of pixels whose samples are traced together.
//!
//! Samples of a block share light, so their errors are alike. Every sample number has a grid of blocks of its own, shifted
//! against those of the others, or the borders of blocks would show.

use translucid_image::PixelRect;

use crate::world::{BLOCK_SIZE, COHORT_SIZE};

/// The blocks of one sample number.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockGrid {
    size: [u32; 2],
    /// Width of the first column and height of the first row, in [1, [`BLOCK_SIZE`]].
    first: (u32, u32),
}

impl BlockGrid {
    /// The grid of a sample number on a film of this width and height.
    pub(crate) fn new(size: [u32; 2], sample: u32) -> Self {
        // Fractions of the powers of the plastic number [Roberts 2018] spread evenly over the square.
        let shift = |multiplier: u32| ((sample.wrapping_mul(multiplier) >> 16) * BLOCK_SIZE) >> 16;
        Self { size, first: (BLOCK_SIZE - shift(0xc13f_a9a9), BLOCK_SIZE - shift(0x91e1_0da5)) }
    }

    /// Number of blocks in a row, and of rows.
    fn counts(&self) -> (u32, u32) {
        let count = |size: u32, first: u32| 1 + size.saturating_sub(first).div_ceil(BLOCK_SIZE);
        (count(self.size[0], self.first.0), count(self.size[1], self.first.1))
    }

    /// Number of blocks.
    pub(crate) fn len(&self) -> usize {
        let (columns, rows) = self.counts();
        columns as usize * rows as usize
    }

    /// A block by its number.
    pub(crate) fn rect(&self, index: usize) -> PixelRect {
        let columns = self.counts().0 as usize;
        let span = |number: u32, first: u32, size: u32| {
            let begin = if number == 0 { 0 } else { first + (number - 1) * BLOCK_SIZE };
            let end = (first + number * BLOCK_SIZE).min(size);
            (begin, end - begin)
        };
        let (x, width) = span((index % columns) as u32, self.first.0, self.size[0]);
        let (y, height) = span((index / columns) as u32, self.first.1, self.size[1]);
        PixelRect { left: x, top: y, width, height }
    }

    /// Numbers of the blocks that have pixels of a region.
    pub(crate) fn blocks_in(&self, region: PixelRect) -> impl Iterator<Item = usize> {
        let columns = self.counts().0 as usize;
        let first = self.block_of(region.left, region.top);
        let last = self.block_of(region.left + region.width - 1, region.top + region.height - 1);
        let (left, right) = (first % columns, last % columns);
        (first / columns..=last / columns)
            .flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    /// The number of the block that a pixel is in.
    pub(crate) fn block_of(&self, x: u32, y: u32) -> usize {
        let place = |at: u32, first: u32| if at < first { 0 } else { 1 + (at - first) / BLOCK_SIZE };
        place(y, self.first.1) as usize * self.counts().0 as usize + place(x, self.first.0) as usize
    }
}

/// The pixels of a block in the order of their numbers: square by square, those of each row by row.
pub(crate) fn pixels_of(block: PixelRect) -> impl Iterator<Item = (u32, u32)> {
    let PixelRect { left, top, width, height } = block;
    let squares = (0..height)
        .step_by(COHORT_SIZE as usize)
        .flat_map(move |y| (0..width).step_by(COHORT_SIZE as usize).map(move |x| (x, y)));
    squares.flat_map(move |(x, y)| {
        let (width, height) = (COHORT_SIZE.min(width - x), COHORT_SIZE.min(height - y));
        PixelRect { left: left + x, top: top + y, width, height }.pixels()
    })
}

/// The number of a pixel in its block.
pub(crate) fn number_in(block: PixelRect, x: u32, y: u32) -> usize {
    let (x, y) = (x - block.left, y - block.top);
    let (left, top) = (x - x % COHORT_SIZE, y - y % COHORT_SIZE);
    let (width, height) = (COHORT_SIZE.min(block.width - left), COHORT_SIZE.min(block.height - top));
    (top * block.width + left * height + (y - top) * width + (x - left)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_every_sample_cover_each_pixel_once() {
        for size in [[1, 1], [15, 40], [16, 16], [50, 34], [97, 3]] {
            for sample in 0..40 {
                let grid = BlockGrid::new(size, sample);
                let mut seen = vec![0; (size[0] * size[1]) as usize];
                for index in 0..grid.len() {
                    let PixelRect { left: x, top: y, width, height } = grid.rect(index);
                    assert!(width > 0 && height > 0 && width <= BLOCK_SIZE && height <= BLOCK_SIZE);
                    for (number, (px, py)) in pixels_of(grid.rect(index)).enumerate() {
                        assert_eq!(number_in(grid.rect(index), px, py), number);
                    }
                    for (px, py) in (y..y + height).flat_map(|py| (x..x + width).map(move |px| (px, py))) {
                        seen[(py * size[0] + px) as usize] += 1;
                        assert_eq!(grid.block_of(px, py), index);
                    }
                }
                assert!(seen.iter().all(|&count| count == 1), "{size:?}, sample {sample}");
            }
        }
    }

    #[test]
    fn borders_are_everywhere_alike() {
        let mut columns = [0; BLOCK_SIZE as usize];
        let samples = 1600;
        for sample in 0..samples {
            columns[(BlockGrid::new([100, 100], sample).first.0 - 1) as usize] += 1;
        }
        let even = samples / BLOCK_SIZE;
        assert!(columns.iter().all(|count| (even - 5..=even + 5).contains(count)), "{columns:?}");
    }
}
