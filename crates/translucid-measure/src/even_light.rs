//! Light that changes along an edge, taken out of the samples.

use crate::edge_line::straight;
use crate::samples::Samples;

/// How light changes along an edge, over that in the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SlopeAlong {
    /// Relative change per length \[L⁻¹\].
    pub(crate) slope: f64,
    /// Its standard error.
    pub(crate) error: f64,
    /// How much brighter it is at the ends than in the middle, beyond a straight line; 0 where noise hides it.
    pub(crate) bend: f64,
}

/// Standard errors from which on a bend is one.
const SURE: f64 = 4.0;

/// Standard error of the slope by medians over that by least squares, whose efficiency is 64 % for normal residuals.
const OF_MEDIANS: f64 = 1.25;

impl Samples {
    /// Takes out the slope of the light along the edge, channel by channel: a block is as bright as all in the mean times a
    /// factor, and the factors lie on a line.
    pub(crate) fn even_out_along(&mut self) -> [SlopeAlong; 3] {
        let means = self.means();
        let count = self.blocks.len();
        let [first, last] = self.along;
        let step = (last - first) / count as f64;
        let place = |b: usize| step * (b as f64 + 0.5 - 0.5 * count as f64);
        let slopes = [0, 1, 2].map(|c| {
            let square: f64 = means.iter().map(|mean| mean[c] * mean[c]).sum();
            let factor = |(b, block): (usize, &Vec<[f64; 3]>)| {
                let joint: f64 = block.iter().zip(&means).map(|(v, mean)| v[c] * mean[c]).sum();
                (place(b), joint / square)
            };
            let factors: Vec<(f64, f64)> = self.blocks.iter().enumerate().map(factor).collect();
            slope_of(&factors)
        });
        for (b, block) in self.blocks.iter_mut().enumerate() {
            let light = slopes.map(|along| (1.0 + along.slope * place(b)).max(0.1));
            block.iter_mut().flat_map(|v| v.iter_mut().zip(light)).for_each(|(v, light)| *v /= light);
        }
        slopes
    }
}

/// Slope of factors around 1 by their places, around 0.
fn slope_of(factors: &[(f64, f64)]) -> SlopeAlong {
    let (slope, height) = straight(factors);
    let spread: f64 = factors.iter().map(|(x, _)| x * x).sum();
    let left: f64 = factors.iter().map(|(x, y)| (y - height - slope * x).powi(2)).sum();
    let error = OF_MEDIANS * (left / (factors.len() as f64 - 2.0) / spread).sqrt();
    if !(slope.is_finite() && error.is_finite()) {
        return SlopeAlong { slope: 0.0, error: 0.0, bend: 0.0 };
    }
    let bend = bend_of(factors.iter().map(|(x, y)| (*x, (y - slope * x) / height)));
    SlopeAlong { slope: slope / height, error, bend }
}

/// Change from the middle to the ends by the parabola through values around 1, at places around 0; 0 where noise hides it.
fn bend_of(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let mut squares: Vec<(f64, f64)> = values.map(|(x, y)| (x * x, y)).collect();
    let count = squares.len() as f64;
    let [mean_x, mean_y] = [squares.iter().map(|v| v.0).sum::<f64>(), squares.iter().map(|v| v.1).sum()];
    let farthest = squares.iter().map(|v| v.0).fold(0.0, f64::max);
    squares.iter_mut().for_each(|(x, y)| (*x, *y) = (*x - mean_x / count, *y - mean_y / count));
    let spread: f64 = squares.iter().map(|(x, _)| x * x).sum();
    let bend = squares.iter().map(|(x, y)| x * y).sum::<f64>() / spread;
    let left: f64 = squares.iter().map(|(x, y)| (y - bend * x).powi(2)).sum();
    let error = (left / (count - 2.0) / spread).sqrt();
    if bend.abs() > SURE * error { bend * farthest } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light that changes by 30 % along the edge, with a crumb in one of the blocks.
    #[test]
    fn slope_along_is_taken_out() {
        let places: Vec<f64> = (-20..20).map(f64::from).collect();
        let light = |x: f64| 0.3 * (1.0 + libm::tanh(x / 5.0));
        let block = |b: usize| {
            let field = 1.0 + 0.3 * ((b as f64 + 0.5) / 24.0 - 0.5);
            let crumb = if b == 5 { 0.5 } else { 1.0 };
            places.iter().map(|x| [field * crumb * light(*x); 3]).collect()
        };
        let mut samples =
            Samples { blocks: (0..24).map(block).collect(), pixel_width: 1.0, along: [-6.0, 6.0], places };
        let slopes = samples.even_out_along();
        assert!((slopes[1].slope - 0.3 / 12.0).abs() < 1e-3, "{slopes:?}");
        assert_eq!(slopes[1].bend, 0.0);
        for b in [0, 12, 23] {
            for (x, v) in samples.places.iter().zip(&samples.blocks[b]) {
                assert!((v[0] - light(*x)).abs() < 3e-3, "{b}: {x} {v:?}");
            }
        }
    }

    /// Dark corners of a lens, beside a slope of the light.
    #[test]
    fn bend_along_is_seen_beside_noise() {
        let mut random = translucid_testing::SplitMix(1);
        let mut factors = |bend: f64| -> Vec<(f64, f64)> {
            let mut at = |x: f64| 1.0 + 0.1 * x + bend * x * x + 0.004 * (random.uniform() - 0.5);
            (0..24).map(|i| (f64::from(i) + 0.5) / 12.0 - 1.0).map(|x| (x, at(x))).collect()
        };
        let dark = slope_of(&factors(-0.03)).bend;
        assert!((dark + 0.03 * 0.92).abs() < 0.003, "{dark}");
        assert_eq!(slope_of(&factors(0.0)).bend, 0.0);
    }
}
