//! A sum of exponentials as a distribution of radii, which the refined profiles are made of.

use crate::math::elementary::{Double, exp_negative, negative_log};

/// Far more steps than any argument needs.
const MOST_STEPS: u32 = 200;

/// Distribution of radii with the density p(r) = Σ w_k λ_k e^{−λ_k r} per length, Σ w_k = 1.
///
/// A weight after the first may be negative, as far as the density is not.
/// Radii are at least 0 and finite numbers or infinity; NaN is the caller's affair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExponentialMixture<const N: usize> {
    /// Weights w_k.
    pub(crate) weights: [f64; N],
    /// Rates λ_k \[L⁻¹\]; the first is the least of those with positive weights.
    pub(crate) rates: [f64; N],
    /// A length near the mean radius \[L\], in which quantiles are sought.
    pub(crate) length: f64,
}

impl<const N: usize> ExponentialMixture<N> {
    /// Density per length p(r) \[L⁻¹\].
    #[inline(always)]
    pub(crate) fn density(&self, r: f64) -> f64 {
        self.sum(|k| self.rates[k] * exp_negative::<Double>(self.rates[k] * r).0)
    }

    /// Share within r, Σ w_k (1 − e^{−λ_k r}), with the digits of a small r.
    #[inline(always)]
    pub(crate) fn within(&self, r: f64) -> f64 {
        self.sum(|k| exp_negative::<Double>(self.rates[k] * r).1)
    }

    /// Share beyond r, Σ w_k e^{−λ_k r}, with the digits of a large r.
    #[inline(always)]
    pub(crate) fn beyond(&self, r: f64) -> f64 {
        self.sum(|k| exp_negative::<Double>(self.rates[k] * r).0)
    }

    /// Radius for a random number u ∈ [0, 1], where all weights are positive: −ln(1 − u')/λ_k with probability w_k,
    /// where u' is u rescaled.
    #[inline(always)]
    pub(crate) fn sample(&self, u: f64) -> f64 {
        // Choose a term, number by number: a branch would keep a loop from being vectorized
        let (mut start, mut weight, mut rate) = (0.0, self.weights[0], self.rates[0]);
        let mut end = weight;
        for k in 1..N {
            let beyond = u >= end;
            start = if beyond { end } else { start };
            weight = if beyond { self.weights[k] } else { weight };
            rate = if beyond { self.rates[k] } else { rate };
            end += self.weights[k];
        }
        // The greatest u below a term's end may round up to 1
        let rescaled = ((u - start) / weight).min(1.0 - f64::EPSILON / 2.0);
        negative_log(1.0 - rescaled, rescaled) / rate
    }

    /// Radius within which the share u is; u is clamped to [0, 1], NaN counts as 0.
    pub(crate) fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        self.radius(negative_log((1.0 - u).max(f64::MIN_POSITIVE), u))
    }

    /// Radius beyond which the share v is; v is clamped to [2.2e-308, 1], NaN counts as 1.
    pub(crate) fn quantile_complement(&self, v: f64) -> f64 {
        let v = v.min(1.0).max(f64::MIN_POSITIVE);
        self.radius(negative_log(v, 1.0 - v))
    }

    /// Mean radius Σ w_k/λ_k \[L\].
    #[inline]
    pub(crate) fn mean_radius(&self) -> f64 {
        self.sum(|k| 1.0 / self.rates[k])
    }

    /// Mean squared radius 2 Σ w_k/λ_k² \[L²\].
    #[inline]
    pub(crate) fn mean_squared_radius(&self) -> f64 {
        2.0 * self.sum(|k| (1.0 / self.rates[k]) / self.rates[k])
    }

    /// Σ w_k f(k), added in pairs.
    #[inline(always)]
    pub(crate) fn sum(&self, f: impl Fn(usize) -> f64) -> f64 {
        let parts: [f64; N] = std::array::from_fn(|k| self.weights[k] * f(k));
        let pairs = parts.chunks_exact(2);
        let last = pairs.remainder();
        // −0 is what changes no number that is added to it
        let sum = pairs.fold(-0.0, |sum, pair| sum + (pair[0] + pair[1]));
        last.iter().fold(sum, |sum, part| sum + part)
    }

    /// The radius r where h(r) = −ln(share beyond r) is `depth` ≥ 0, by Chebyshev's iteration, which is of third order,
    /// in a bracket that is halved where a step would leave it.
    ///
    /// Where all weights are positive h is concave and Newton's step leads to a radius that is too small wherever it
    /// begins; the term of second order, bounded, lengthens it, and the bracket is never left.
    fn radius(&self, depth: f64) -> f64 {
        // In units of the length, so that no product leaves the range of numbers
        let rates = self.rates.map(|rate| rate * self.length);
        let slowest = rates.into_iter().fold(f64::INFINITY, f64::min);
        let greatest: f64 = self.weights.iter().map(|weight| weight.abs()).sum();
        let (mut low, mut high) = (0.0, (depth + libm::log(greatest) + ROUNDING) / slowest);
        // Start where a lower bound of positive weights says: e^{−Σ w λ r} lies below the mixture, and so does its
        // slowest term
        let of_first = self.weights[0].min(1.0);
        let of_first = negative_log(of_first, 1.0 - of_first);
        let mean_rate = self.sum(|k| rates[k]).max(slowest);
        let mut r = (depth / mean_rate).max((depth - of_first) / rates[0]).max(low).min(high);
        for _ in 0..MOST_STEPS {
            // Evaluate h and its slopes: h' is the mean rate of what is left beyond r, −h'' the variance of the rates
            let parts: [(f64, f64); N] = std::array::from_fn(|k| exp_negative::<Double>(rates[k] * r));
            let beyond = self.sum(|k| parts[k].0).max(f64::MIN_POSITIVE).min(1.0);
            let within = self.sum(|k| parts[k].1).max(0.0).min(1.0);
            let slope = self.sum(|k| rates[k] * parts[k].0) / beyond;
            // Where the exponentials underflow, the slowest is what is left
            let slope = if slope > 0.0 { slope } else { slowest };
            let variance = self.sum(|k| rates[k] * rates[k] * parts[k].0) / beyond - slope * slope;

            let missing = depth - negative_log(beyond, within);
            if missing > 0.0 {
                low = r;
            } else {
                high = r;
            }
            let newton = missing / slope;
            let step = newton * (1.0 + (0.5 * newton * variance / slope).max(-0.5).min(1.0));
            let next = r + step;
            let stays = next >= low && next <= high;
            // Steps cube: after one of a millionth nothing is left but rounding
            let is_last = step.abs() <= 1e-6 * r;
            r = if stays || is_last { next.max(0.0) } else { 0.5 * (low + high) };
            if is_last {
                break;
            }
        }
        r * self.length
    }
}

/// Rounding of the bracket's end, far more than there is.
const ROUNDING: f64 = 1e-9;
