//! The place of a pixel in its block, and the pixels there that it shares light with.

/// Edge \[pixels\] of a square of as many pixels as share light.
///
/// With 8 the variance at 512², 4 samples was 1.25 times as great on the head and 1.5 times on the dragon; the cost of
/// sharing goes with the square.
pub(crate) const COHORT_SIZE: u32 = 16;

/// Edge \[pixels\] of a block of pixels that are traced together.
///
/// Pixels share with 1/16 of it at most. At the edge of a region whole blocks are traced, so they should not be larger.
pub(crate) const BLOCK_SIZE: u32 = 4 * COHORT_SIZE;

/// Amplitude and period \[pixels\] of the zigzag borders between pixels that share.
///
/// Straight borders show where light travels a few pixels: at one sample, differences across the lines of a grid are 1.22
/// times those elsewhere without the zigzag, and 1.14 times with it, for 1.02 times the error (profile of 4 pixels in the
/// bench `structure`; head).
const BEND: f32 = 4.0;
const BEND_LENGTH: f32 = 22.0;

/// A pixel's place in the block of pixels that are traced together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockPlace {
    /// Number of its sample in the block.
    pub(crate) number: usize,
    /// Column and row in the block.
    pub(crate) at: [u32; 2],
    /// Width and height of the block.
    pub(crate) size: [u32; 2],
}

impl BlockPlace {
    /// The offset from the pixel to those that it shares with: a random one of up to `spread` pixels along each axis, by the
    /// lowest 32 of some random bits, plus the zigzag of the borders.
    pub(crate) fn offset(&self, spread: f32, bits: u64) -> [f32; 2] {
        let spread = spread.min(BLOCK_SIZE as f32);
        let random = [bits as u16, (bits >> 16) as u16].map(|u| spread * (f32::from(u) / 32768.0 - 1.0));
        let [x, y] = self.at.map(|at| BEND * (4.0 * ((at as f32 / BEND_LENGTH).fract() - 0.5).abs() - 1.0));
        [random[0] + y, random[1] + x]
    }

    /// Number of the square of [`COHORT_SIZE`] pixels at an offset from the pixel; see [`rectangle`](Self::rectangle).
    pub(crate) fn cohort(&self, offset: [f32; 2]) -> usize {
        let [column, row] = self.rectangle([COHORT_SIZE; 2], offset);
        row * (BLOCK_SIZE / COHORT_SIZE) as usize + column
    }

    /// Column and row of the rectangle whose pixels a pixel shares with: the one at an offset of up to [`BLOCK_SIZE`] pixels,
    /// mirrored at the block's edges.
    ///
    /// Rectangles have about the given edges \[pixels\]. A block that the picture cuts has fewer of them rather than smaller
    /// ones: with 12 × 12 pixels instead of 24 × 24 the error of regions of a small picture was 1.07 times as great.
    pub(crate) fn rectangle(&self, edges: [u32; 2], offset: [f32; 2]) -> [usize; 2] {
        [0, 1].map(|axis| {
            let size = self.size[axis] as f32;
            let count = (self.size[axis] / edges[axis]).max(1) as f32;
            let mut at = (self.at[axis] as f32 + 0.5 + offset[axis]).abs();
            // A remainder would be slower: the loop seldom runs, as few offsets are wider than the block
            while at > 2.0 * size {
                at -= 2.0 * size;
            }
            (at.min(2.0 * size - at) * count / size).min(count - 1.0) as usize
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cohorts of the pixels of a row, each so far off.
    fn cohorts(width: u32, offset: f32) -> Vec<usize> {
        let place = |x| BlockPlace { number: 0, at: [x, 0], size: [width, 1] };
        (0..width).map(|x| place(x).cohort([offset, 0.0])).collect()
    }

    #[test]
    fn cohorts_are_16_pixels_wide_or_little_more() {
        let widths = |width| {
            let all = cohorts(width, 0.0);
            all.chunk_by(|a, b| a == b).map(<[usize]>::len).collect::<Vec<_>>()
        };
        assert_eq!(widths(64), [16; 4]);
        assert_eq!(widths(37), [18, 19]);
        assert_eq!(widths(31), [31]);
        assert_eq!(widths(32), [16; 2]);
        assert_eq!(widths(1), [1]);
    }

    #[test]
    fn rectangles_count_from_the_corner() {
        let of = |at, size| BlockPlace { number: 0, at, size }.rectangle([16, 8], [0.0; 2]);
        assert_eq!([of([0, 0], [64; 2]), of([15, 7], [64; 2])], [[0, 0]; 2]);
        assert_eq!([of([16, 7], [64; 2]), of([63, 63], [64; 2])], [[1, 0], [3, 7]]);
        assert_eq!([of([20, 19], [21, 20]), of([20, 9], [21, 20])], [[0, 1], [0, 0]]);
    }

    #[test]
    fn cohorts_of_places_beyond_the_block_are_mirrored() {
        assert_eq!(
            cohorts(64, -16.0)[..34],
            [[0; 16], [0; 16]].concat().into_iter().chain([1; 2]).collect::<Vec<_>>()
        );
        assert_eq!(cohorts(64, 64.0), cohorts(64, -64.0));
        assert!(cohorts(64, 64.0).iter().eq(cohorts(64, 0.0).iter().rev()));
    }

    /// Wherever a pixel is, offsets that reach as far as the block is wide lead to all cohorts alike.
    #[test]
    fn far_offsets_lead_everywhere() {
        for x in [0, 5, 40, 63] {
            let mut counts = [0; 4];
            for i in 0..1024 {
                let offset = 64.0 * ((i as f32 + 0.5) / 512.0 - 1.0);
                counts[BlockPlace { number: 0, at: [x, 0], size: [64, 64] }.cohort([offset, 0.0])] += 1;
            }
            assert_eq!(counts, [256; 4], "column {x}");
        }
    }
}
