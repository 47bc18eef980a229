//! Noise of the dark that a file has cut off at zero.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::linear_photo::Photo;

/// Edge of the squares of pixels whose light counts as even.
const TILE: usize = 16;

/// Greatest share of zeros from which noise can be told: of more, the dark is below 0 by far.
const MOST_ZEROS: f64 = 0.6;

/// Least median difference of neighbors over the noise: it is 0.3 of cut noise of which 60 % are zeros, and more of less.
const LEAST_DIFFERENCE: f64 = 0.15;

impl Photo {
    /// The most that a square of pixels is brighter than it was because values below 0 are 0 in the file.
    ///
    /// Of a Gaussian of mean μ = t σ, Φ(−t) is below 0, and the mean of what is left in its place is σ (φ(t) + t Φ(t)):
    /// the share of zeros determines t, and the mean σ. Where all values are 0 there was no noise to cut, and where neighbors
    /// differ by less than such noise, black and bright meet.
    pub fn cut_noise(&self) -> f64 {
        let mut most = 0.0_f64;
        for y in (0..self.height).step_by(TILE) {
            for x in (0..self.width).step_by(TILE) {
                let tile = self.part([x, y, x + TILE, y + TILE]);
                let mean = tile.mean();
                for (c, mean) in mean.into_iter().enumerate() {
                    let zeros = tile.pixels.iter().filter(|pixel| pixel[c] == 0.0).count();
                    let [noise, gained] = cut(zeros as f64 / tile.pixels.len() as f64);
                    if tile.median_difference(c) > LEAST_DIFFERENCE * noise * mean {
                        most = most.max(gained * mean);
                    }
                }
            }
        }
        most
    }

    /// Median of the differences of neighbors in a row.
    fn median_difference(&self, c: usize) -> f64 {
        let rows = self.pixels.chunks_exact(self.width);
        let pairs = rows.flat_map(|row| row.windows(2));
        let mut all: Vec<f64> = pairs.map(|pair| f64::from(pair[1][c] - pair[0][c]).abs()).collect();
        let middle = all.len() / 2;
        if all.is_empty() { 0.0 } else { *all.select_nth_unstable_by(middle, f64::total_cmp).1 }
    }
}

/// Noise, and what its cutting has added, over the mean of what is left, by the share of zeros.
fn cut(zeros: f64) -> [f64; 2] {
    if !(zeros > 0.0 && zeros <= MOST_ZEROS) {
        return [0.0; 2];
    }
    let below = |t: f64| 0.5 * libm::erfc(-t * FRAC_1_SQRT_2);
    let (mut low, mut high) = (-9.0, 9.0);
    for _ in 0..50 {
        let t = 0.5 * (low + high);
        if below(-t) > zeros { low = t } else { high = t }
    }
    let t = 0.5 * (low + high);
    let density = libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt();
    let left = density + t * below(t);
    [1.0 / left, (density - t * below(-t)) / left]
}

#[cfg(test)]
mod tests {
    use translucid_testing::SplitMix;

    use super::*;

    /// Light of mean 0.01 in the dark half, in noise of 0.02: 0.02 (φ(½) − ½ Φ(−½)) = 0.003956 is added to it.
    #[test]
    fn cut_noise_is_what_the_dark_has_gained() {
        let mut random = SplitMix(3);
        let noise: Vec<f64> =
            (0..128 * 128).map(|_| (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0).collect();
        let photo = |least: f64| {
            Photo::from_fn(128, 128, |x, y| {
                let light = if x < 64 { 0.01 } else { 0.5 };
                [(light + 0.02 * noise[128 * y + x]).max(least) as f32; 3]
            })
        };
        assert_eq!(photo(-1.0).cut_noise(), 0.0);
        let cut = photo(0.0);
        let dark = cut.part([0, 0, 64, 128]);
        let gained = dark.mean()[0] - photo(-1.0).part([0, 0, 64, 128]).mean()[0];
        assert!((gained - 0.003_956).abs() < 4e-4, "{gained}");
        // The most of 32 squares, whose shares of zeros, 0.31 ± 0.03, differ
        let found = cut.cut_noise();
        assert!(found > gained && found < 1.5 * gained, "{found} {gained}");
        let black = Photo::from_fn(32, 32, |x, _| if x < 16 { [0.0; 3] } else { [0.5; 3] });
        assert_eq!(black.cut_noise(), 0.0);
        assert_eq!(Photo::from_fn(32, 32, |_, _| [0.0; 3]).cut_noise(), 0.0);
        // A bright disk on black, and in noise of a thousandth of it
        for noisy in [0.0, 1e-3] {
            let disk = Photo::from_fn(128, 128, |x, y| {
                let light = if (x as f64 - 60.0).hypot(y as f64 - 70.0) < 20.0 { 0.9 } else { 0.0 };
                [(light + noisy * noise[128 * y + x]).max(0.0) as f32; 3]
            });
            // φ(0) of the noise, in the square that has gained most
            assert!(disk.cut_noise() <= 0.6 * noisy, "{}", disk.cut_noise());
        }
    }
}
