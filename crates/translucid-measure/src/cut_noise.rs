//! Noise of the dark that a file has cut off at zero.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use crate::Photo;

/// Edge of the squares of pixels whose light counts as even.
const TILE: usize = 16;

impl Photo {
    /// The most that a square of pixels is brighter than it was because values below 0 are 0 in the file.
    ///
    /// Of a Gaussian of mean μ = t σ, Φ(−t) is below 0, and the mean of what is left in its place is σ (φ(t) + t Φ(t)):
    /// the share of zeros tells t, and the mean σ. Where all values are 0 there was no noise to cut.
    pub fn cut_noise(&self) -> f64 {
        let mut most = 0.0_f64;
        for y in (0..self.height).step_by(TILE) {
            for x in (0..self.width).step_by(TILE) {
                let tile = self.part([x, y, x + TILE, y + TILE]);
                let mean = tile.mean();
                for (c, mean) in mean.into_iter().enumerate() {
                    let zeros = tile.pixels.iter().filter(|pixel| pixel[c] == 0.0).count();
                    most = most.max(mean * excess(zeros as f64 / tile.pixels.len() as f64));
                }
            }
        }
        most
    }
}

/// Part of the mean of cut values that the cutting has added, by the share of zeros.
fn excess(zeros: f64) -> f64 {
    if !(zeros > 0.0 && zeros < 1.0) {
        return 0.0;
    }
    let below = |t: f64| 0.5 * libm::erfc(-t * FRAC_1_SQRT_2);
    let (mut low, mut high) = (-9.0, 9.0);
    for _ in 0..50 {
        let t = 0.5 * (low + high);
        if below(-t) > zeros { low = t } else { high = t }
    }
    let t = 0.5 * (low + high);
    let density = libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt();
    (density - t * below(-t)) / (density + t * below(t))
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
    }
}
