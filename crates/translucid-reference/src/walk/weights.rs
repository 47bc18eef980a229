//! Weights of photons at an albedo below that at which they walked.

use super::orders::{Cell, OrderBins};
use crate::Estimate;

/// Sums over photons of weights βⁿ, β = α/α_ref, by which counts at the reference albedo become figures at α.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Weighed {
    /// Number of photons.
    pub(crate) count: u64,
    /// Σ βⁿ.
    pub(crate) first: f64,
    /// Σ (βⁿ)², for the standard error.
    pub(crate) second: f64,
    /// Derivative of `first` with respect to α.
    pub(crate) slope: f64,
    /// Σ (dβⁿ/dα)².
    pub(crate) slope_second: f64,
    /// Width of the interval in which Σ βⁿ must be by counts and mean orders.
    pub(crate) uncertainty: f64,
}

impl Weighed {
    /// Mean over all photons, with its standard error.
    ///
    /// Where the photons seen do not vary (none left, say), the error is that of a single photon of the greatest
    /// weight.
    pub(crate) fn mean(self, photons: u64, greatest_weight: f64) -> Estimate {
        let n = photons as f64;
        if photons < 2 {
            return Estimate { value: if photons == 0 { 0.0 } else { self.first }, error: f64::INFINITY };
        }
        let mean = self.first / n;
        let variance = self.second / n - mean * mean;
        let error = if variance > 0.0 { (variance / (n - 1.0)).sqrt() } else { greatest_weight / n };
        Estimate { value: mean, error }
    }
}

impl std::iter::Sum for Weighed {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            count: sum.count.saturating_add(part.count),
            first: sum.first + part.first,
            second: sum.second + part.second,
            slope: sum.slope + part.slope,
            slope_second: sum.slope_second + part.slope_second,
            uncertainty: sum.uncertainty + part.uncertainty,
        })
    }
}

/// The weights of all bins of orders at one albedo.
///
/// Photons of one order all weigh βⁿ. Where orders share a bin [a, b], their mean n̄ and their variance v give
/// the mean weight βⁿ̄ (1 + λ²v/2 + …), λ = −ln β. The variance is not recorded; a density that is straight over
/// the bin and has this mean has ((b−a+1)² − 1)/12 − (n̄ − (a+b)/2)². It is smaller by 1 − 1/c for c photons,
/// because the mean is their own: a single photon has none. The result is kept within the limits of convexity.
#[derive(Debug)]
pub(crate) struct Weights {
    reference_albedo: f64,
    beta: f64,
    lambda: f64,
    bins: Vec<BinWeights>,
}

/// βⁿ and its derivative with respect to α.
#[derive(Clone, Copy, Debug)]
struct Power {
    value: f64,
    slope: f64,
}

/// A bin with the weights at its ends; the last bin has no upper end.
#[derive(Debug)]
struct BinWeights {
    first: (f64, Power),
    last: Option<(f64, Power)>,
}

impl Weights {
    /// α is at least 0, the reference albedo greater than 0.
    pub(crate) fn new(bins: &OrderBins, alpha: f64, reference_albedo: f64) -> Self {
        let beta = alpha / reference_albedo;
        let mut weights = Self { reference_albedo, beta, lambda: -libm::log(beta), bins: Vec::new() };
        let end = |order| (f64::from(order), weights.power(f64::from(order)));
        let bins = (0..bins.len()).map(|bin| bins.orders(bin));
        weights.bins =
            bins.map(|(first, last)| BinWeights { first: end(first), last: last.map(end) }).collect();
        weights
    }

    fn power(&self, n: f64) -> Power {
        if n == 0.0 {
            return Power { value: 1.0, slope: 0.0 };
        }
        // Not n βⁿ/α, which is 0/0 at α = 0.
        let lower = libm::pow(self.beta, n - 1.0);
        Power { value: self.beta * lower, slope: n * lower / self.reference_albedo }
    }

    /// Weighs the photons of a cell.
    pub(crate) fn weigh(&self, bin: usize, cell: Cell) -> Weighed {
        if cell.count == 0 {
            return Weighed::default();
        }
        let count = cell.count as f64;
        let (weight, uncertainty) = self.mean_weight(&self.bins[bin], count, cell.order_sum as f64 / count);
        Weighed {
            count: cell.count,
            first: count * weight.value,
            second: count * weight.value * weight.value,
            slope: count * weight.slope,
            slope_second: count * weight.slope * weight.slope,
            uncertainty: count * uncertainty,
        }
    }

    /// Mean weight of a bin's photons, and the width of the interval in which it must be.
    fn mean_weight(&self, bin: &BinWeights, count: f64, mean_order: f64) -> (Power, f64) {
        let (first, at_first) = bin.first;
        let Some((last, at_last)) = bin.last else {
            let weight = self.power(mean_order);
            return (weight, at_first.value - weight.value);
        };
        if last == first {
            return (at_first, 0.0);
        }
        let at_mean = self.power(mean_order);
        if at_mean.value == 0.0 {
            return (at_mean, 0.0);
        }

        // Estimate the variance of the orders
        let (width, center) = (last - first + 1.0, 0.5 * (first + last));
        let spread = (width * width - 1.0) / 12.0 - (mean_order - center).powi(2);
        let variance = spread.max(0.0) * (1.0 - 1.0 / count);

        // Correct the weight of the mean order for it
        let factor = 1.0 + 0.5 * self.lambda * self.lambda * variance;
        let value = at_mean.value * factor;
        let slope = at_mean.slope * (factor - variance * self.lambda / mean_order);

        // Stay below the chord
        let t = (mean_order - first) / (last - first);
        let chord = Power {
            value: (1.0 - t) * at_first.value + t * at_last.value,
            slope: (1.0 - t) * at_first.slope + t * at_last.slope,
        };
        let weight = if value < chord.value { Power { value, slope } } else { chord };
        (weight, (chord.value - at_mean.value).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REFERENCE: f64 = 0.9999;

    /// Orders as a bin records them.
    fn cell(orders: &[u32]) -> Cell {
        Cell { count: orders.len() as u64, order_sum: orders.iter().map(|&n| u64::from(n)).sum() }
    }

    /// Σ βⁿ and its derivative, photon by photon.
    fn one_by_one(orders: &[u32], alpha: f64) -> (f64, f64) {
        let beta = alpha / REFERENCE;
        let weights = orders.iter().map(|&n| {
            let n = f64::from(n);
            (beta.powf(n), if n == 0.0 { 0.0 } else { n * beta.powf(n - 1.0) / REFERENCE })
        });
        weights.fold((0.0, 0.0), |sum, weight| (sum.0 + weight.0, sum.1 + weight.1))
    }

    const ALPHAS: [f64; 9] = [0.0, 1e-300, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9998, REFERENCE];

    #[test]
    fn single_orders_weigh_what_their_photons_do() {
        let bins = OrderBins::new(1.0 / 128.0).unwrap();
        for alpha in ALPHAS {
            let weights = Weights::new(&bins, alpha, REFERENCE);
            for n in [0, 1, 2, 17, 200] {
                let found = weights.weigh(bins.bin(n), cell(&[n; 3]));
                let (value, slope) = one_by_one(&[n; 3], alpha);
                assert!((found.first - value).abs() <= 1e-13 * value, "{alpha} {n}: {} {value}", found.first);
                assert!((found.slope - slope).abs() <= 1e-13 * slope, "{alpha} {n}: {} {slope}", found.slope);
                assert!((found.second - value * value / 3.0).abs() <= 1e-13 * value);
                assert_eq!((found.count, found.uncertainty), (3, 0.0));
            }
        }
    }

    /// The worst that can share a bin: all photons at its ends. Their weight is on the chord, which must be
    /// inside the stated interval; photons of one order are at its other end.
    #[test]
    fn grouped_orders_weigh_within_the_limits_of_convexity() {
        for growth in [1.0 / 128.0, 0.125, 1.0] {
            let bins = OrderBins::new(growth).unwrap();
            for alpha in ALPHAS {
                let weights = Weights::new(&bins, alpha, REFERENCE);
                for bin in (0..bins.len() - 1).step_by(7) {
                    let (a, Some(b)) = bins.orders(bin) else { panic!("bin {bin} has no end") };
                    let middle = a + (b - a) / 2;
                    for orders in
                        [vec![a, b], vec![a, a, a, b], vec![middle; 4], vec![a; 2], vec![b; 2], vec![middle]]
                    {
                        let found = weights.weigh(bin, cell(&orders));
                        let (value, _) = one_by_one(&orders, alpha);
                        let room = found.uncertainty + 1e-12 * value;
                        assert!((found.first - value).abs() <= room, "{alpha} {orders:?}: {found:?} {value}");
                        let bound = bins.weight_error_bound() * orders.len() as f64;
                        assert!(found.uncertainty <= bound, "{alpha} {a} {b}: {found:?}");
                        let alone = orders.len() == 1;
                        assert!(!alone || (found.first - value).abs() <= 1e-12 * value, "{found:?}");
                    }
                }
            }
        }
    }

    /// Orders spread as in a half space, n^(−3/2) and more slowly: the error left is far below the limits.
    #[test]
    fn grouped_orders_weigh_almost_what_smooth_densities_do() {
        // (growth, greatest relative error where λn reaches 5)
        for (growth, allowed) in [(1.0 / 128.0, 2e-8), (0.125, 1.5e-4), (0.25, 2e-3)] {
            let bins = OrderBins::new(growth).unwrap();
            for power in [1.5, 0.5, -1.0] {
                for n in [1_000u32, 30_000] {
                    let beta = (-5.0 / f64::from(n)).exp();
                    let weights = Weights::new(&bins, beta * REFERENCE, REFERENCE);
                    let bin = bins.bin(n);
                    let (a, Some(b)) = bins.orders(bin) else { panic!("bin {bin} has no end") };
                    let scale = 1e12 / (f64::from(b - a + 1) * f64::from(a).powf(-power));
                    let count = |n: u32| (scale * f64::from(n).powf(-power)).round();
                    let orders = || (a..=b).map(|n| (f64::from(n), count(n)));
                    let cell = Cell {
                        count: orders().map(|(_, c)| c as u64).sum(),
                        order_sum: orders().map(|(n, c)| (n * c) as u64).sum(),
                    };
                    let expected: f64 = orders().map(|(n, c)| c * beta.powf(n)).sum();
                    let found = weights.weigh(bin, cell).first;
                    let error = (found / expected - 1.0).abs();
                    assert!(error < allowed, "{growth} {power} {n}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn slope_is_the_derivative_of_the_weight() {
        let bins = OrderBins::new(0.125).unwrap();
        for alpha in [0.5, 0.9, 0.99, 0.999] {
            for orders in
                [vec![1, 1], vec![40; 3], vec![97, 99, 105], vec![1000, 1050, 1051], vec![3_000_000]]
            {
                let bin = bins.bin(orders[0]);
                let at = |alpha| Weights::new(&bins, alpha, REFERENCE).weigh(bin, cell(&orders));
                let step = 1e-6 * (1.0 - alpha);
                if at(alpha).first < 1e-250 {
                    continue; // too few digits left
                }
                let slope = (at(alpha + step).first - at(alpha - step).first) / (2.0 * step);
                let found = at(alpha);
                let allowed = 1e-7 * slope.abs() + 1e-14 * found.first / step;
                assert!((found.slope - slope).abs() <= allowed, "{alpha} {orders:?}: {found:?} {slope}");
            }
        }
    }

    #[test]
    fn weights_are_finite_at_the_edges() {
        let bins = OrderBins::new(0.125).unwrap();
        for alpha in ALPHAS.into_iter().chain([f64::MIN_POSITIVE, 5e-324]) {
            let weights = Weights::new(&bins, alpha, REFERENCE);
            for n in [0, 1, 2, 100, 1_000_000, u32::MAX] {
                let Weighed { first, second, slope, slope_second, uncertainty, .. } =
                    weights.weigh(bins.bin(n), cell(&[n]));
                for value in [first, second, slope, slope_second, uncertainty] {
                    assert!(value.is_finite() && value >= 0.0, "{alpha:e} {n}: {value}");
                }
            }
        }
    }

    /// How often an interval of ±1.96 errors holds the truth, for photons of equal weight of which m are expected:
    /// the figures that [`AtAlbedo`](super::super::AtAlbedo) states.
    #[test]
    fn few_photons_have_shorter_intervals_than_they_should() {
        let coverage = |m: f64| {
            let n = 1u64 << 50;
            let mut probability = (-m).exp();
            let mut sum = 0.0;
            for k in 0..2000 {
                let seen = Weighed { count: k, first: k as f64, second: k as f64, ..Weighed::default() };
                let Estimate { value, error } = seen.mean(n, 1.0);
                let expected = m / n as f64;
                if (value - expected).abs() <= 1.96 * error {
                    sum += probability;
                }
                probability *= m / (k + 1) as f64;
            }
            sum
        };
        let least = |from: u32, to: u32| (from..to).map(|m| coverage(0.1 * f64::from(m))).fold(1.0, f64::min);
        let (below_3, to_5, to_16, above) = (least(1, 29), least(29, 50), least(50, 160), least(160, 3000));
        assert!(below_3 > 0.83 && to_5 > 0.79 && to_16 > 0.86 && above > 0.92);
        assert!((coverage(300.0) - 0.95).abs() < 0.005);
    }
}
