//! Least squares of means whose noise the differences of blocks tell.
//!
//! Neighboring pixels are not independent, and the noise of a photograph is not known.
//! So the picture is cut into blocks, whose differences show how far to trust their mean: covariances are those of clusters
//! [K.-Y. Liang and S. L. Zeger, *Longitudinal Data Analysis Using Generalized Linear Models*, 1986].

use nalgebra::{DMatrix, DVector};

use crate::fit::Interval;
use crate::robust_least_squares::{jacobian, robust_least_squares};
use crate::samples::Samples;

/// Fewest blocks whose differences tell anything.
const FEWEST_BLOCKS: usize = 6;

/// Fewest places.
const FEWEST_PLACES: usize = 16;

/// Means of blocks, and how far they are to be trusted.
pub(crate) struct Clusters<'a> {
    samples: &'a Samples,
    /// Channel by channel at each place.
    pub(crate) means: Vec<f64>,
    /// 1 over their standard errors, by a noise model of the values.
    inverse_errors: Vec<f64>,
}

/// Errors of the means that are the same for all blocks, so that their differences do not show them.
#[derive(Default)]
pub(crate) struct CommonErrors {
    /// Changes of the means by one standard error, channel by channel at each place.
    pub(crate) normal: Vec<Vec<f64>>,
    /// Changes of the means of which any part may have to be added, from none to all.
    pub(crate) up_to: Vec<Vec<f64>>,
}

/// Parameters that explain the means.
pub(crate) struct Found {
    pub(crate) parameters: Vec<f64>,
    covariance: DMatrix<f64>,
    /// Covariance by the common errors of all blocks.
    common: DMatrix<f64>,
    /// Middle of the intervals less the parameters.
    drift: Vec<f64>,
    /// Degrees of freedom of the covariance.
    degrees: f64,
    /// Mean square of the means' residuals over their noise.
    pub(crate) misfit: f64,
}

impl<'a> Clusters<'a> {
    /// `None` where there are fewer than six blocks or 16 places, or numbers that are not finite. `counts` are the pixels of
    /// a block at each place.
    pub(crate) fn new(samples: &'a Samples, counts: impl Fn(usize) -> f64) -> Option<Self> {
        let Samples { places, pixel_width, blocks, .. } = samples;
        let n = places.len();
        let is_usable = blocks.len() >= FEWEST_BLOCKS
            && n >= FEWEST_PLACES
            && *pixel_width > 0.0
            && places.iter().all(|x| x.is_finite())
            && blocks.iter().all(|block| block.len() == n && block.iter().flatten().all(|v| v.is_finite()));
        if !is_usable {
            return None;
        }
        let count = blocks.len() as f64;
        let of = |i: usize| blocks.iter().map(move |block| block[i / 3][i % 3]);
        let means: Vec<f64> = (0..3 * n).map(|i| of(i).sum::<f64>() / count).collect();
        let variance = |i: usize| {
            let square = of(i).map(|v| (v - means[i]).powi(2)).sum::<f64>();
            counts(i / 3) * square / (count - 1.0) / count
        };
        let variances: Vec<f64> = (0..3 * n).map(variance).collect();
        let mut inverse_errors = noise_model(&means, &variances)?;
        inverse_errors.iter_mut().enumerate().for_each(|(i, inverse)| *inverse *= counts(i / 3).sqrt());
        Some(Self { samples, means, inverse_errors })
    }

    /// Leaves the first places out of fits.
    pub(crate) fn leave_out(&mut self, places: usize) {
        self.inverse_errors[..3 * places].fill(0.0);
    }

    /// Standard errors of the means, by place; infinite where they are left out.
    pub(crate) fn errors(&self) -> Vec<[f64; 3]> {
        let error = |inverse: &[f64]| std::array::from_fn(|c| 1.0 / inverse[c]);
        self.inverse_errors.chunks_exact(3).map(error).collect()
    }

    /// The best of fits from several starts, of light by parameters and channel, with errors that all blocks share.
    pub(crate) fn fit(
        &self,
        light: impl Fn(&[f64], usize) -> Vec<f64>,
        common_errors: impl Fn(&[f64]) -> CommonErrors,
        starts: &[Vec<f64>],
        scales: &[f64],
    ) -> Option<Found> {
        let residuals = |p: &[f64]| {
            let curves = [0, 1, 2].map(|c| light(p, c));
            let residual = |i: usize| (self.means[i] - curves[i % 3][i / 3]) * self.inverse_errors[i];
            (0..self.means.len()).map(residual).collect::<Vec<f64>>()
        };
        let square = |p: &[f64]| residuals(p).iter().map(|r| r * r).sum::<f64>();
        let minima = starts.iter().map(|start| robust_least_squares(residuals, start, scales));
        let minimum = minima.min_by(|a, b| square(&a.parameters).total_cmp(&square(&b.parameters)))?;
        let p = &minimum.parameters;
        let (weighted, bread) = self.sensitivity(&residuals, p, &minimum.weights, scales)?;
        let CommonErrors { normal, up_to } = common_errors(p);
        let change = |of_means: &Vec<f64>| {
            let residuals =
                of_means.iter().zip(&self.inverse_errors).map(|(change, inverse)| change * inverse);
            -&bread * (weighted.transpose() * DVector::from_iterator(self.means.len(), residuals))
        };
        let mut common = DMatrix::<f64>::zeros(p.len(), p.len());
        let mut drift = DVector::<f64>::zeros(p.len());
        for change in normal.iter().map(change) {
            common += &change * change.transpose();
        }
        // Evenly distributed from none to all
        for change in up_to.iter().map(change) {
            common += &change * change.transpose() / 12.0;
            drift += 0.5 * change;
        }
        let free =
            self.inverse_errors.iter().filter(|inverse| **inverse > 0.0).count().saturating_sub(p.len());
        Some(Found {
            misfit: square(p) / free.max(1) as f64,
            covariance: self.covariance(&weighted, &bread),
            common,
            drift: drift.iter().copied().collect(),
            parameters: minimum.parameters,
            degrees: (self.samples.blocks.len() - 1) as f64,
        })
    }

    /// The weighted Jacobian J of the residuals, and (JᵀWJ)⁻¹.
    fn sensitivity(
        &self,
        residuals: &impl Fn(&[f64]) -> Vec<f64>,
        p: &[f64],
        weights: &[f64],
        scales: &[f64],
    ) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let jacobian = jacobian(residuals, p, scales);
        let weighted =
            DMatrix::from_fn(jacobian.nrows(), p.len(), |row, i| jacobian[(row, i)] * weights[row]);
        // A picture without blur says nothing of it: only its size counts
        let scale = DMatrix::from_diagonal(&DVector::from_row_slice(scales));
        let normal = &scale * (jacobian.transpose() * &weighted) * &scale;
        let bread = &scale * normal.clone().pseudo_inverse(1e-12 * normal.amax()).ok()? * &scale;
        Some((weighted, bread))
    }

    /// Covariance of the parameters by the scores of the blocks.
    fn covariance(&self, weighted: &DMatrix<f64>, bread: &DMatrix<f64>) -> DMatrix<f64> {
        let count = self.samples.blocks.len() as f64;
        let mut meat = DMatrix::<f64>::zeros(bread.nrows(), bread.nrows());
        for block in &self.samples.blocks {
            // What a block alone would move: its difference from the mean
            let difference =
                |i: usize| (block[i / 3][i % 3] - self.means[i]) * self.inverse_errors[i] / count;
            let difference = DVector::from_iterator(self.means.len(), (0..self.means.len()).map(difference));
            let score = weighted.transpose() * difference;
            meat += &score * score.transpose();
        }
        bread * meat * bread * (count / (count - 1.0))
    }
}

impl Found {
    /// Standard error of a parameter; one of 100 in a logarithm is one of nothing, too.
    pub(crate) fn error(&self, i: usize) -> f64 {
        (self.covariance[(i, i)] + self.common[(i, i)]).max(0.0).sqrt().min(100.0)
    }

    /// A function of a parameter with its intervals.
    pub(crate) fn interval(&self, i: usize, map: impl Fn(f64) -> f64) -> Interval {
        let (value, middle) = (self.parameters[i], self.parameters[i] + self.drift[i]);
        let [of_blocks, common] = [&self.covariance, &self.common].map(|all| all[(i, i)].max(0.0).sqrt());
        let around = |z: f64| {
            let reach = (student(z, self.degrees) * of_blocks)
                .hypot(z * common)
                .min(student(z, self.degrees) * 100.0);
            // The value itself is never left out
            [map((middle - reach).min(value)), map((middle + reach).max(value))]
        };
        Interval { value: map(value), likely: around(0.994_457_883), sure: around(1.959_963_985) }
    }

    /// Correlation of the errors of two parameters; 0 where one is known exactly.
    pub(crate) fn correlation(&self, i: usize, j: usize) -> f64 {
        let product = self.error(i) * self.error(j);
        let joint = self.covariance[(i, j)] + self.common[(i, j)];
        if product > 0.0 { (joint / product).clamp(-1.0, 1.0) } else { 0.0 }
    }
}

/// 1 over the standard errors of means, by a straight line through their variances: reading noise and that of photons.
fn noise_model(means: &[f64], variances: &[f64]) -> Option<Vec<f64>> {
    let n = means.len() as f64;
    let (mean, variance) = (means.iter().sum::<f64>() / n, variances.iter().sum::<f64>() / n);
    let spread: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
    let joint: f64 = means.iter().zip(variances).map(|(m, v)| (m - mean) * (v - variance)).sum();
    let slope = if spread > 0.0 { (joint / spread).max(0.0) } else { 0.0 };
    let lowest = means.iter().copied().fold(f64::MAX, f64::min);
    // Nothing is exact, and nothing far more so than all the rest
    let least = (0.05 * variance).max(1e-12 * mean * mean);
    let at = |m: f64| (variance + slope * (m - mean)).max(least).max(slope * (m - lowest) * 0.1);
    (least > 0.0).then(|| means.iter().map(|m| 1.0 / at(*m).sqrt()).collect())
}

/// Quantile of Student's t where that of the normal distribution is z, for five degrees of freedom and more, to 0.5 %
/// [E. A. Cornish and R. A. Fisher 1937].
fn student(z: f64, degrees: f64) -> f64 {
    let z2 = z * z;
    let first = z * (z2 + 1.0) / 4.0;
    let second = z * (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / 96.0;
    let third = z * (3.0 * z2.powi(3) + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / 384.0;
    z + first / degrees + second / degrees.powi(2) + third / degrees.powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (degrees, expected) in [(5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423)] {
            assert!((student(1.959_963_985, degrees) / expected - 1.0).abs() < 5e-3, "{degrees}");
        }
    }
}
