//! Least-squares fits of mixtures to a measured or simulated table, with the uncertainties of their parameters.

use std::marker::PhantomData;

use levenberg_marquardt::LevenbergMarquardt;
use nalgebra::{DMatrix, DVector};
use translucid_profile::{ParameterError, Profile, require};

use crate::least_squares::{Residuals, least_squares};
use crate::profile_fit::extensions;
use crate::{Family, Mixture};

/// R(r) at one radius, with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Radius r > 0 \[L\].
    pub r: f64,
    /// Reflectance R(r) \[L⁻²\]; noise may make it negative.
    pub reflectance: f64,
    /// Standard error of the reflectance, greater than 0 \[L⁻²\]; up to a common factor where that is not known.
    pub error: f64,
}

/// Errors of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Errors {
    /// Standard errors; those of the parameters follow from them alone.
    Known,
    /// In proportion to the standard errors; the factor is what makes the residuals as large as they are.
    Relative,
}

/// A parameter with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Its value.
    pub value: f64,
    /// Its standard error, in linear approximation; infinite where the samples do not determine it.
    pub error: f64,
}

impl Estimate {
    /// Returns whether the samples determine it: the value is at least three errors away from 0.
    ///
    /// Closer to 0 the linear approximation ends, and the truth may be farther off than the error says: of samples all
    /// close to the entry, whose scale is 1, a fit gives the scale 0.07 ± 0.04.
    pub fn is_determined(&self) -> bool {
        3.0 * self.error <= self.value.abs()
    }
}

/// A mixture fitted to samples.
///
/// ```
/// use translucid_fit::{Burley, Errors, Sample, SampleFit};
/// use translucid_profile::NormalizedDiffusion;
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let truth = NormalizedDiffusion::from_d(0.7, 2.0)?;
/// let samples: Vec<Sample> = (1..=30)
///     .map(|i| 0.4 * f64::from(i))
///     .map(|r| Sample { r, reflectance: truth.eval(r), error: 0.01 * truth.eval(r) })
///     .collect();
/// let fit = SampleFit::<Burley>::new(&samples, Errors::Known, 1)?;
/// assert!((fit.total().value - 0.7).abs() < 1e-6 && fit.total().error < 0.01);
/// assert!((fit.scales()[0].value - 2.0).abs() < 1e-6 && fit.scales()[0].error < 0.01);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SampleFit<F> {
    mixture: Mixture<F>,
    total: Estimate,
    weights: Vec<Estimate>,
    scales: Vec<Estimate>,
    chi_square: f64,
    degrees_of_freedom: usize,
    is_singular: bool,
}

impl<F: Family> SampleFit<F> {
    /// Fits R(r) = Σ a_k K_{s_k}(r) with energies a_k > 0 and scales s_k > 0 by least squares of (R_fit − R)/error.
    ///
    /// # Errors
    /// `terms` is not in 1..=8, there are not more samples than parameters (two for each term), a sample is not what
    /// [`Sample`] says, or none is greater than 0.
    pub fn new(samples: &[Sample], errors: Errors, terms: usize) -> Result<Self, ParameterError> {
        require((1..=8).contains(&terms), "terms", terms as f64, "in 1..=8")?;
        let (count, parameters) = (samples.len(), 2 * terms);
        require(count > parameters, "number of samples", count as f64, "greater than that of parameters")?;
        for sample in samples {
            require((1e-100..=1e100).contains(&sample.r), "r", sample.r, "in [1e-100, 1e100]")?;
            let (size, error) = (sample.reflectance.abs(), sample.error);
            require(size <= 1e200, "reflectance", sample.reflectance, "in [-1e200, 1e200]")?;
            require((1e-250..=1e250).contains(&error), "error", error, "in [1e-250, 1e250]")?;
        }
        let greatest = samples.iter().map(|sample| sample.reflectance).fold(0.0, f64::max);
        require(greatest > 0.0, "greatest reflectance", greatest, "greater than 0")?;

        // Find the best mixture, each number of terms from one less
        let data = Data::new(samples);
        let mut best = data.first::<F>();
        for _ in 1..terms {
            best.sort_by(|a, b| a.1.total_cmp(&b.1));
            let sum: f64 = best.iter().map(|term| term.0).sum();
            let shares: Vec<_> = best.iter().map(|(energy, scale)| (energy / sum, *scale)).collect();
            let energies = |start: Vec<(f64, f64)>| start.into_iter().map(|(w, s)| (w * sum, s)).collect();
            let starts = extensions(&shares).into_iter().map(energies).collect::<Vec<Vec<_>>>().into_iter();
            let fits = starts.map(|start| data.descend::<F>(&start));
            best = fits.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are starts").1;
        }
        best.sort_by(|a, b| a.1.total_cmp(&b.1));
        Ok(Self::from_terms(&data, &best, errors))
    }

    /// Uncertainties from the Jacobian at the optimum.
    fn from_terms(data: &Data, terms: &[(f64, f64)], errors: Errors) -> Self {
        let (problem, parameters) = (Problem::<F>::new(data), parameters_of(terms));
        let chi_square = problem.chi_square(&parameters);
        let degrees_of_freedom = data.points.len() - 2 * terms.len();
        let factor = match errors {
            Errors::Known => 1.0,
            Errors::Relative => chi_square / degrees_of_freedom as f64,
        };
        let directions = directions(problem.jacobian(&parameters));
        let is_singular = directions.iter().any(|direction| !direction.has_effect);
        let error = |gradient: &DVector<f64>| {
            let variance: f64 = directions.iter().map(|direction| direction.variance(gradient)).sum();
            let variance = if variance.is_infinite() { variance } else { factor * variance };
            if variance.is_nan() { f64::INFINITY } else { variance.sqrt() }
        };

        // Energies and scales are exponentials of what the optimizer moved
        let count = terms.len();
        let sum: f64 = terms.iter().map(|(energy, _)| energy).sum();
        let weight = |k: usize| terms[k].0 / sum;
        let along = |f: &dyn Fn(usize) -> f64| DVector::from_iterator(2 * count, (0..2 * count).map(f));
        let total_gradient = along(&|i| if i < count { weight(i) } else { 0.0 });
        let of_weight = |k: usize| {
            let gradient = along(&|i| match i {
                i if i >= count => 0.0,
                i if i == k => weight(k) * (1.0 - weight(k)),
                i => -weight(k) * weight(i),
            });
            Estimate { value: weight(k), error: if count == 1 { 0.0 } else { error(&gradient) } }
        };
        let of_scale = |k: usize| {
            let scale = terms[k].1 * data.unit_r;
            let gradient = along(&|i| f64::from(u8::from(i == count + k)));
            Estimate { value: scale, error: scale * error(&gradient) }
        };
        let total = sum * data.unit_energy;
        let mixture = terms.iter().map(|(energy, scale)| (energy / sum, scale * data.unit_r)).collect();
        Self {
            mixture: Mixture::sorted(total, mixture),
            total: Estimate { value: total, error: total * error(&total_gradient) },
            weights: (0..count).map(of_weight).collect(),
            scales: (0..count).map(of_scale).collect(),
            chi_square,
            degrees_of_freedom,
            is_singular,
        }
    }

    /// The fitted mixture, whose total may exceed 1 where the samples say so.
    pub fn mixture(&self) -> &Mixture<F> {
        &self.mixture
    }

    /// Energy ∫ R 2πr dr, which for a reflectance is the surface albedo.
    pub fn total(&self) -> Estimate {
        self.total
    }

    /// Shares of the energy, of sum 1, in the order of the scales.
    pub fn weights(&self) -> &[Estimate] {
        &self.weights
    }

    /// Scales \[L\], rising.
    pub fn scales(&self) -> &[Estimate] {
        &self.scales
    }

    /// Σ ((R_fit − R)/error)².
    pub fn chi_square(&self) -> f64 {
        self.chi_square
    }

    /// Samples less parameters.
    pub fn degrees_of_freedom(&self) -> usize {
        self.degrees_of_freedom
    }

    /// χ² for each degree of freedom.
    pub fn reduced_chi_square(&self) -> f64 {
        self.chi_square / self.degrees_of_freedom as f64
    }

    /// (R_fit − R)/error of each sample.
    pub fn residuals(&self, samples: &[Sample]) -> Vec<f64> {
        let residual = |sample: &Sample| (self.mixture.eval(sample.r) - sample.reflectance) / sample.error;
        samples.iter().map(residual).collect()
    }

    /// True if some combination of parameters has no effect on the samples.
    pub fn is_singular(&self) -> bool {
        self.is_singular
    }
}

/// Samples in units that keep the arithmetic within range.
struct Data {
    unit_r: f64,
    unit_energy: f64,
    points: Vec<Sample>,
}

impl Data {
    fn new(samples: &[Sample]) -> Self {
        let count = samples.len() as f64;
        let unit_r = libm::exp(samples.iter().map(|sample| libm::log(sample.r)).sum::<f64>() / count);
        let energy = |sample: &Sample| (sample.r / unit_r).powi(2) * sample.reflectance;
        let unit = samples.iter().map(energy).fold(f64::MIN_POSITIVE, f64::max);
        let point = |sample: &Sample| Sample {
            r: sample.r / unit_r,
            reflectance: sample.reflectance / unit,
            error: sample.error / unit,
        };
        // R in 1/r²
        Self { unit_r, unit_energy: unit * unit_r * unit_r, points: samples.iter().map(point).collect() }
    }

    /// The best single term: a ladder of scales, the energy of each by linear least squares.
    fn first<F: Family>(&self) -> Vec<(f64, f64)> {
        let (low, high) = self
            .points
            .iter()
            .fold((f64::MAX, 0.0f64), |(low, high), point| (low.min(point.r), high.max(point.r)));
        let start = |i: i32| {
            let scale = 0.1 * low * libm::pow(100.0 * high / low, f64::from(i) / 40.0) / F::MEAN_RADIUS;
            let sums = self.points.iter().fold([0.0; 2], |[a, b], point| {
                let kernel = F::times_r(point.r / scale) / (scale * point.r) / point.error;
                [a + kernel * point.reflectance / point.error, b + kernel * kernel]
            });
            vec![(if sums[0] > 0.0 { sums[0] / sums[1] } else { 1e-3 }, scale)]
        };
        let cost = |terms: &[(f64, f64)]| Problem::<F>::new(self).chi_square(&parameters_of(terms));
        let starts = (0..=40).map(start).map(|terms| (cost(&terms), terms));
        let best = starts.filter(|(cost, _)| cost.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| vec![(1.0, 1.0)], |(_, terms)| self.descend::<F>(&terms).1)
    }

    /// Follows χ² down from a start.
    fn descend<F: Family>(&self, start: &[(f64, f64)]) -> (f64, Vec<(f64, f64)>) {
        let problem = Problem::<F>::new(self);
        let search = LevenbergMarquardt::new().with_patience(200);
        let found = least_squares(search, &parameters_of(start), &problem);
        let chi_square = problem.chi_square(&found);
        (if chi_square.is_finite() { chi_square } else { f64::MAX }, terms_of(&found))
    }
}

/// A number whose square is one; where radii span hundreds of decades, ∞ · 0 counts as 0.
fn representable(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(-1e150, 1e150) }
}

/// Farthest that a logarithm goes: no kernel is then anything but 0 or its limit.
const MOST: f64 = 300.0;

/// Parameters of the optimizer: logarithms of the energies, then of the scales.
fn parameters_of(terms: &[(f64, f64)]) -> Vec<f64> {
    let energies = terms.iter().map(|(energy, _)| libm::log(energy.max(1e-30)));
    energies.chain(terms.iter().map(|(_, scale)| libm::log(*scale))).collect()
}

/// Energies and scales of the optimizer's parameters.
fn terms_of(parameters: &[f64]) -> Vec<(f64, f64)> {
    let exp = |ln: &f64| libm::exp(ln.clamp(-MOST, MOST));
    let (energies, scales) = parameters.split_at(parameters.len() / 2);
    energies.iter().map(exp).zip(scales.iter().map(exp)).collect()
}

/// Distance of a family's sums from the samples, by the optimizer's parameters.
struct Problem<'a, F> {
    data: &'a Data,
    family: PhantomData<F>,
}

impl<'a, F: Family> Problem<'a, F> {
    fn new(data: &'a Data) -> Self {
        Self { data, family: PhantomData }
    }

    fn chi_square(&self, parameters: &[f64]) -> f64 {
        DVector::from_vec(self.residuals(parameters)).norm_squared()
    }
}

impl<F: Family> Residuals for Problem<'_, F> {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        let terms = terms_of(parameters);
        let residual = |point: &Sample| {
            let value = |(energy, s): &(f64, f64)| energy * F::times_r(point.r / s) / (s * point.r);
            representable((terms.iter().map(value).sum::<f64>() - point.reflectance) / point.error)
        };
        self.data.points.iter().map(residual).collect()
    }

    /// ∂/∂ln a = a K,  ∂/∂ln s = −a (φ + xφ')/(s r).
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let terms = terms_of(parameters);
        let mut jacobian = DMatrix::zeros(self.data.points.len(), 2 * terms.len());
        for (row, point) in self.data.points.iter().enumerate() {
            for (k, (energy, s)) in terms.iter().enumerate() {
                let x = point.r / s;
                let factor = energy / (s * point.r * point.error);
                jacobian[(row, k)] = representable(factor * F::times_r(x));
                let slope = -factor * (F::times_r(x) + x * F::slope(x));
                jacobian[(row, terms.len() + k)] = representable(slope);
            }
        }
        jacobian
    }
}

/// Directions of the parameters, by the singular values of the Jacobian with columns of equal length.
fn directions(mut jacobian: DMatrix<f64>) -> Vec<Direction> {
    /// Below this share of the greatest a singular value is rounding error
    const LEAST: f64 = 1e-9;
    let norms: Vec<f64> = jacobian.column_iter().map(|column| column.norm()).collect();
    for (mut column, norm) in jacobian.column_iter_mut().zip(&norms) {
        column /= norm.max(f64::MIN_POSITIVE);
    }
    let svd = jacobian.svd(false, true);
    let rows = svd.v_t.expect("asked for");
    let greatest = svd.singular_values.max();
    let direction = |(i, value): (usize, &f64)| {
        let along = |parameter: usize| rows[(i, parameter)] / norms[parameter].max(f64::MIN_POSITIVE);
        let along = DVector::from_iterator(norms.len(), (0..norms.len()).map(along));
        if *value > LEAST * greatest {
            Direction { along: along / *value, has_effect: true }
        } else {
            Direction { along, has_effect: false }
        }
    };
    svd.singular_values.iter().enumerate().map(direction).collect()
}

/// A combination of parameters that varies independently of the others.
struct Direction {
    /// Change of each parameter in one standard deviation; any multiple of it, if it has no effect on the samples.
    along: DVector<f64>,
    has_effect: bool,
}

impl Direction {
    /// Variance that it gives a quantity with a gradient over the parameters.
    fn variance(&self, gradient: &DVector<f64>) -> f64 {
        let terms = self.along.iter().zip(gradient.iter()).map(|(along, slope)| along * slope);
        let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term| (sum + term, size + term.abs()));
        match self.has_effect {
            true => sum * sum,
            // Terms that cancel leave the quantity alone
            false if sum.abs() > 1e-6 * size => f64::INFINITY,
            false => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::Profile;

    use super::*;
    use crate::{Burley, Exponential, Gaussian};

    /// Standard normal numbers by a linear congruence and the central limit of 12 uniform ones.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 =
                    self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    fn samples(truth: &dyn Profile, relative: f64, noise: &mut Noise) -> Vec<Sample> {
        let sample = |i: i32| {
            let r = 0.05 * 1.12f64.powi(i) * truth.scale();
            let error = relative * truth.eval(r);
            Sample { r, reflectance: truth.eval(r) + error * noise.next(), error }
        };
        (0..50).map(sample).collect()
    }

    fn mixture<F: Family>(terms: &[(f64, f64)]) -> Mixture<F> {
        Mixture::new(0.6, terms).unwrap()
    }

    /// The truth lies, of 200 tables, within one standard error in 68.3 % ± 3.3 %, within two in 95.4 % ± 1.5 %: a count
    /// four standard deviations off has a probability of some 1e-4; ten parameters with two counts make it 2e-3.
    fn covers<F: Family>(terms: &[(f64, f64)], errors: Errors) {
        let truth = mixture::<F>(terms);
        let mut noise = Noise(7);
        let mut within: Vec<[u32; 2]> = Vec::new();
        for _ in 0..200 {
            let mut table = samples(&truth, 0.02, &mut noise);
            if errors == Errors::Relative {
                table.iter_mut().for_each(|sample| sample.error *= 1e3);
            }
            let fit = SampleFit::<F>::new(&table, errors, terms.len()).unwrap();
            assert!(!fit.is_singular());
            let expected = [0.6].into_iter().chain(truth.scales().iter().copied());
            let found = [fit.total()].into_iter().chain(fit.scales().iter().copied());
            within.resize(1 + terms.len(), [0; 2]);
            for ((found, expected), within) in found.zip(expected).zip(&mut within) {
                assert!(found.is_determined(), "{found:?}");
                let off = (found.value - expected).abs() / found.error;
                within[0] += u32::from(off < 1.0);
                within[1] += u32::from(off < 2.0);
            }
        }
        for [one, two] in within {
            assert!((137 - 26..=137 + 26).contains(&one) && (191 - 12..=200).contains(&two), "{one} {two}");
        }
    }

    #[test]
    fn truth_lies_within_the_errors() {
        covers::<Burley>(&[(1.0, 2.0)], Errors::Known);
        covers::<Burley>(&[(1.0, 2.0)], Errors::Relative);
        covers::<Exponential>(&[(0.3, 0.4), (0.7, 3.0)], Errors::Known);
        covers::<Gaussian>(&[(0.3, 0.4), (0.7, 3.0)], Errors::Known);
    }

    #[test]
    fn fit_recovers_a_mixture_without_noise() {
        let truth = mixture::<Exponential>(&[(0.2, 0.3), (0.5, 1.0), (0.3, 4.0)]);
        let mut table = samples(&truth, 1e-3, &mut Noise(1));
        table.iter_mut().for_each(|sample| sample.reflectance = truth.eval(sample.r));
        let fit = SampleFit::<Exponential>::new(&table, Errors::Known, 3).unwrap();
        assert!(fit.chi_square() < 1e-10 && fit.degrees_of_freedom() == 44, "{}", fit.chi_square());
        for k in 0..3 {
            assert!((fit.scales()[k].value / truth.scales()[k] - 1.0).abs() < 1e-5, "{k}");
            assert!((fit.weights()[k].value / truth.weights()[k] - 1.0).abs() < 1e-5, "{k}");
        }
    }

    #[test]
    fn fit_does_not_depend_on_the_units() {
        let truth = mixture::<Burley>(&[(1.0, 2.0)]);
        let table = samples(&truth, 0.02, &mut Noise(3));
        let unit = SampleFit::<Burley>::new(&table, Errors::Known, 1).unwrap();
        for length in [1e-60, 1e60] {
            let scale = |s: &Sample| Sample {
                r: s.r * length,
                reflectance: s.reflectance / length / length,
                error: s.error / length / length,
            };
            let other: Vec<Sample> = table.iter().map(scale).collect();
            let other = SampleFit::<Burley>::new(&other, Errors::Known, 1).unwrap();
            assert!((other.total().value / unit.total().value - 1.0).abs() < 1e-9);
            assert!((other.total().error / unit.total().error - 1.0).abs() < 1e-6);
            assert!((other.scales()[0].error / length / unit.scales()[0].error - 1.0).abs() < 1e-6);
        }
    }

    /// Two exponentials fitted to one; and one with all samples close to the entry, where R ~ 1/r says nothing of s.
    #[test]
    fn parameters_that_do_not_matter_are_told() {
        let truth = mixture::<Exponential>(&[(1.0, 1.0)]);
        let table = samples(&truth, 0.02, &mut Noise(5));
        let fit = SampleFit::<Exponential>::new(&table, Errors::Known, 2).unwrap();
        let all = fit.scales().iter().chain(fit.weights());
        assert!(all.clone().any(|estimate| !estimate.is_determined()), "{fit:?}");
        let one = SampleFit::<Exponential>::new(&table, Errors::Known, 1).unwrap();
        assert!(one.total().is_determined() && one.scales()[0].is_determined());
        assert_eq!(one.weights()[0], Estimate { value: 1.0, error: 0.0 });

        let mut noise = Noise(6);
        let near = |i: i32| {
            let r = 1e-3 * (1.0 + 0.1 * f64::from(i));
            Sample {
                r,
                reflectance: truth.eval(r) * (1.0 + 0.02 * noise.next()),
                error: 0.02 * truth.eval(r),
            }
        };
        let near: Vec<Sample> = (0..20).map(near).collect();
        let fit = SampleFit::<Exponential>::new(&near, Errors::Known, 1).unwrap();
        assert!(!fit.total().is_determined() && !fit.scales()[0].is_determined(), "{fit:?}");
    }

    #[test]
    fn samples_are_checked() {
        let good = Sample { r: 1.0, reflectance: 1.0, error: 0.1 };
        let new = |samples: &[Sample], terms| SampleFit::<Burley>::new(samples, Errors::Known, terms);
        assert!(new(&[good; 2], 1).is_err());
        assert!(new(&[good; 9], 0).is_err() && new(&[good; 90], 9).is_err());
        for bad in [
            Sample { r: 0.0, ..good },
            Sample { r: f64::NAN, ..good },
            Sample { reflectance: f64::INFINITY, ..good },
            Sample { error: 0.0, ..good },
            Sample { error: f64::NAN, ..good },
        ] {
            assert!(new(&[good, good, good, bad], 1).is_err(), "{bad:?}");
        }
        assert!(new(&[Sample { reflectance: -1.0, ..good }; 4], 1).is_err());
    }

    /// One sample over and over determines neither parameter, and extremes give numbers.
    #[test]
    fn odd_samples_give_numbers() {
        let good = Sample { r: 1.0, reflectance: 1.0, error: 0.1 };
        let fit = SampleFit::<Burley>::new(&[good; 5], Errors::Known, 1).unwrap();
        assert!(fit.is_singular() && !fit.total().is_determined());
        for exponent in [-99, 99] {
            let table: Vec<Sample> = (0..6)
                .map(|i| Sample {
                    r: if i == 0 { 10f64.powi(exponent) } else { f64::from(i) },
                    reflectance: 10f64.powi(20 * i - 60),
                    error: 10f64.powi(-40 * i),
                })
                .collect();
            for terms in [1, 2] {
                let fit = SampleFit::<Gaussian>::new(&table, Errors::Relative, terms).unwrap();
                assert!(!fit.total().value.is_nan() && !fit.total().error.is_nan(), "{fit:?}");
            }
        }
    }
}
