//! Several exposures of one view as one photograph.

use crate::linear_photo::Photo;

/// Part of the greatest value from which on an exposure may be clipped.
const CEILING: f32 = 0.98;

/// Part of the first exposure's ceiling from which on its light is far above its noise.
const BRIGHT: f64 = 0.02;

impl Photo {
    /// One photograph of several exposures of the same view, in the numbers of the first: each pixel's light by all that do
    /// not clip it, weighed by the photons that they count. `None` where their sizes differ or one has nothing in common with
    /// the first.
    pub fn merged(exposures: &[Self]) -> Option<Self> {
        let first = exposures.first()?;
        if exposures.iter().any(|photo| [photo.width, photo.height] != [first.width, first.height]) {
            return None;
        }
        let ceilings: Vec<[f32; 3]> =
            exposures.iter().map(|photo| photo.greatest().map(|v| CEILING * v)).collect();
        let is_whole = |i: usize, p: usize, c: usize| exposures[i].pixels[p][c] < ceilings[i][c];
        // Exposure times over that of the first
        let ratio = |i: usize| {
            let (mut joint, mut square) = (0.0, 0.0);
            for (p, c) in (0..first.pixels.len()).flat_map(|p| (0..3).map(move |c| (p, c))) {
                let [a, b] = [first, &exposures[i]].map(|photo| f64::from(photo.pixels[p][c]));
                if is_whole(0, p, c) && is_whole(i, p, c) && a > BRIGHT * f64::from(ceilings[0][c]) {
                    (joint, square) = (joint + a * b, square + a * a);
                }
            }
            let ratio = joint / square;
            (ratio.is_finite() && ratio > 0.0).then_some(ratio)
        };
        let ratios: Vec<f64> = (0..exposures.len()).map(ratio).collect::<Option<_>>()?;
        let shortest = (0..ratios.len()).min_by(|a, b| ratios[*a].total_cmp(&ratios[*b]))?;
        let light = |p: usize, c: usize| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for i in (0..ratios.len()).filter(|i| is_whole(*i, p, c)) {
                (sum, weight) = (sum + f64::from(exposures[i].pixels[p][c]), weight + ratios[i]);
            }
            if weight > 0.0 {
                sum / weight
            } else {
                f64::from(exposures[shortest].pixels[p][c]) / ratios[shortest]
            }
        };
        Some(Self::from_fn(first.width, first.height, |x, y| {
            std::array::from_fn(|c| light(y * first.width + x, c) as f32)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn merged_exposures_hold_what_each_clips() {
        let scene = |x: usize| 0.01 * (x as f32 + 1.0);
        let photo = |time: f32| Photo::from_fn(100, 20, |x, _| [(time * scene(x)).min(1.0); 3]);
        let merged = Photo::merged(&[photo(3.0), photo(0.9), photo(0.25)]).unwrap();
        for x in 0..100 {
            // The brightest value of the shortest is above its ceiling, and taken as it is
            let expected = 3.0 * scene(x);
            assert!((merged.at(x, 3)[1] / expected - 1.0).abs() < 1e-5, "{x}: {:?}", merged.at(x, 3));
        }
        assert!(photo(3.0).clipped() > 0.6 && photo(0.9).clipped() == 0.0 && merged.clipped() == 0.0);
        let other = Photo::from_fn(90, 20, |_, _| [0.5; 3]);
        assert_eq!(Photo::merged(&[photo(1.0), other]), None);
        let black = Photo::from_fn(100, 20, |_, _| [0.0; 3]);
        assert_eq!(Photo::merged(&[photo(1.0), black]), None);
        assert_eq!(Photo::merged(&[]), None);
    }
}
