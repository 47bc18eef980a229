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

/// Part of the greatest value from which on an exposure may be clipped.
const CEILING: f32 = 0.98;

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

    /// One photograph of several exposures of the same view, in the numbers of the first: each pixel's light by all that do
    /// not clip it, which is the best that photons tell. `None` where their sizes differ or one has nothing in common with
    /// the first.
    pub fn merged(exposures: &[Self]) -> Option<Self> {
        let first = exposures.first()?;
        let ceilings: Vec<f32> = exposures.iter().map(|photo| CEILING * photo.greatest()).collect();
        let ok = |i: usize, p: usize, c: usize| exposures[i].pixels[p][c] < ceilings[i];
        let ratio = |i: usize| {
            let (mut joint, mut square) = (0.0, 0.0);
            for p in 0..first.pixels.len() {
                for c in 0..3 {
                    let [a, b] = [first, &exposures[i]].map(|photo| f64::from(photo.pixels[p][c]));
                    // Far above the noise in both
                    if ok(0, p, c) && ok(i, p, c) && a > 0.02 * f64::from(ceilings[0]) {
                        (joint, square) = (joint + a * b, square + a * a);
                    }
                }
            }
            let ratio = joint / square;
            (ratio.is_finite() && ratio > 0.0).then_some(ratio)
        };
        if exposures.iter().any(|photo| [photo.width, photo.height] != [first.width, first.height]) {
            return None;
        }
        let ratios: Vec<f64> = (0..exposures.len()).map(ratio).collect::<Option<_>>()?;
        let shortest = (0..ratios.len()).min_by(|a, b| ratios[*a].total_cmp(&ratios[*b]))?;
        let light = |p: usize, c: usize| {
            let (mut sum, mut weight) = (0.0, 0.0);
            for i in (0..ratios.len()).filter(|i| ok(*i, p, c)) {
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

    /// The share of values that are 1, where a camera or a file has cut off what is brighter; 0 where some are greater.
    pub fn clipped(&self) -> f64 {
        if self.greatest() != 1.0 {
            return 0.0;
        }
        let count = self.pixels.iter().flatten().filter(|value| **value == 1.0).count();
        count as f64 / (3 * self.pixels.len()) as f64
    }

    fn greatest(&self) -> f32 {
        self.pixels.iter().flatten().copied().fold(0.0, f32::max)
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
