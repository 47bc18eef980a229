//! Metering: the exposure that a picture wants.

use std::io;

use crate::Picture;

/// Share of the picture that is darker than what the meter looks at: bright, but no highlight. With less, the backdrop decides
/// and a white bust in front of it has no shades left; chosen by eye.
const PERCENTILE: f64 = 0.97;

/// Value to which the meter exposes the luminance at the percentile: the brightest tone that curves leave about as it is.
const TARGET: f64 = 0.8;

/// Bins of luminance to the stop.
const BINS_PER_STOP: f64 = 64.0;

/// Most stops that a picture is made brighter or darker.
const LIMIT: f64 = 32.0;

impl Picture<'_> {
    /// Exposure in tenths of a stop, within ±32, that brings the 97th percentile of the luminance to 0.8.
    ///
    /// Pixels count that something covers by half at least; `R`, `G` and `B` are divided by the coverage `A`, where there is
    /// one. What is black or not finite does not count, and a picture without anything else stays as it is.
    ///
    /// ```
    /// use translucid_image::{Picture, PictureChannel};
    ///
    /// let channels = ["R", "G", "B"].map(PictureChannel::single);
    /// let dark = Picture::new([8, 8], channels.to_vec(), |_, values| values.fill(0.8 / 32.0));
    /// assert_eq!(dark.metered_exposure()?, 5.0);
    /// # Ok::<(), std::io::Error>(())
    /// ```
    ///
    /// # Errors
    /// The picture has no pixels, a color channel is missing, or its region is not within the whole.
    pub fn metered_exposure(&self) -> io::Result<f32> {
        self.check()?;
        let color = self.indices_of(["R", "G", "B"])?;
        let alpha = self.index_of("A");
        // Counts in bins, not sorted numbers: no memory that grows with the picture, and no order that matters.
        let last = (4.0 * LIMIT * BINS_PER_STOP) as usize - 1;
        let mut counts = vec![0_u64; last + 1];
        let mut row = self.new_row();
        for y in self.region.rows() {
            self.read_row(y, &mut row);
            for pixel in row.chunks_exact(self.channels.len()) {
                let coverage = alpha.map_or(1.0, |index| pixel[index]);
                let [red, green, blue] = color.map(|index| pixel[index].max(0.0));
                let luminance = (0.2126 * red + 0.7152 * green + 0.0722 * blue) / coverage;
                if coverage >= 0.5 && luminance > 0.0 && luminance.is_finite() {
                    let bin = (libm::log2(luminance) + 2.0 * LIMIT) * BINS_PER_STOP;
                    counts[(bin.max(0.0) as usize).min(last)] += 1;
                }
            }
        }
        Ok(percentile(&counts).map_or(0.0, |bin| {
            let stops = libm::log2(TARGET) - ((bin as f64 + 0.5) / BINS_PER_STOP - 2.0 * LIMIT);
            ((stops * 10.0).round() / 10.0).clamp(-LIMIT, LIMIT) as f32
        }))
    }
}

/// The bin that the percentile is in, if there is anything.
fn percentile(counts: &[u64]) -> Option<usize> {
    let below = PERCENTILE * counts.iter().sum::<u64>() as f64;
    let sums = counts.iter().scan(0, |sum, count| {
        *sum += count;
        Some((*sum, *count))
    });
    sums.enumerate().find(|&(_, (sum, count))| count > 0 && sum as f64 >= below).map(|(bin, _)| bin)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PictureChannel;

    fn metered(pixels: &[[f64; 4]]) -> f32 {
        let channels = ["R", "G", "B", "A"].map(PictureChannel::single);
        let picture = Picture::new([pixels.len() as u32, 1], channels.to_vec(), |_, values| {
            values.copy_from_slice(pixels.as_flattened());
        });
        picture.metered_exposure().unwrap()
    }

    #[test]
    fn meter_undoes_any_exposure() {
        let picture = |stops: f64| -> Vec<[f64; 4]> {
            let factor = stops.exp2();
            (0..1000).map(|i| [1e-3 * f64::from(i) * factor, 0.5 * factor, 0.1 * factor, 1.0]).collect()
        };
        let plain = metered(&picture(0.0));
        for stops in [-20.0, -3.5, 0.1, 12.0] {
            // To a tenth, and a bin's width.
            assert!((f64::from(plain - metered(&picture(stops))) - stops).abs() < 0.11, "{stops}");
        }
        assert_eq!(metered(&picture(-50.0)), 32.0);
        assert_eq!(metered(&picture(50.0)), -32.0);
    }

    #[test]
    fn meter_takes_neither_highlights_nor_what_is_not_there() {
        let mut pixels = vec![[0.8, 0.8, 0.8, 1.0]; 100];
        assert_eq!(metered(&pixels), 0.0);
        pixels[..2].fill([1e4, 1e4, 1e4, 1.0]);
        assert_eq!(metered(&pixels), 0.0, "two highlights of a hundred");
        pixels.extend([[0.0, 0.0, 0.0, 0.0]; 1000]);
        pixels.extend([[9.0, 9.0, 9.0, 0.4]; 1000]);
        pixels.extend([[f64::NAN; 4], [f64::INFINITY, 1.0, 1.0, 1.0], [-1.0, -1.0, -1.0, 1.0]]);
        assert_eq!(metered(&pixels), 0.0);
        // Half covered by light of 0.8.
        pixels.extend([[0.4, 0.4, 0.4, 0.5]; 3000]);
        assert_eq!(metered(&pixels), 0.0);
        for nothing in [[0.0; 4], [f64::NAN; 4], [1.0, 1.0, 1.0, 0.0]] {
            assert_eq!(metered(&[nothing; 9]), 0.0);
        }
    }
}
