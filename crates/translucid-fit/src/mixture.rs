//! A weighted sum of kernels of one family.

use std::marker::PhantomData;

use translucid_profile::{ParameterError, Profile, require};

use crate::Family;

/// R(r) = A Σ w_k K_{s_k}(r) with weights w_k ≥ 0 that sum to 1 and scales s_k > 0 \[L\] that rise with k.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture<F> {
    total: f64,
    weights: Vec<f64>,
    scales: Vec<f64>,
    family: PhantomData<F>,
}

impl<F: Family> Mixture<F> {
    /// Makes the mixture of terms (weight, scale \[L\]) with the energy `total`. The weights are divided by their sum, unless
    /// it is 1 but for rounding: what a mixture says of itself makes the same one, bit for bit.
    ///
    /// # Errors
    /// There are no terms, a weight is negative, all are 0, a scale is not greater than 0, or `total` is not finite and
    /// at least 0.
    pub fn new(total: f64, terms: &[(f64, f64)]) -> Result<Self, ParameterError> {
        require(total >= 0.0 && total.is_finite(), "total", total, "finite and at least 0")?;
        for (weight, scale) in terms {
            require(*weight >= 0.0, "weight", *weight, "at least 0")?;
            require(*scale > 0.0 && scale.is_finite(), "scale", *scale, "finite and greater than 0")?;
        }
        let sum: f64 = terms.iter().map(|term| term.0).sum();
        require(sum > 0.0 && sum.is_finite(), "sum of weights", sum, "finite and greater than 0")?;
        let is_one = (sum - 1.0).abs() <= terms.len() as f64 * f64::EPSILON;
        if is_one && terms.is_sorted_by(|a, b| a.1 <= b.1) {
            return Ok(Self::divided(total, terms, 1.0));
        }
        Ok(Self::sorted(total, terms.to_vec()))
    }

    /// Makes the mixture without a check.
    pub(crate) fn sorted(total: f64, mut terms: Vec<(f64, f64)>) -> Self {
        terms.sort_by(|a, b| a.1.total_cmp(&b.1));
        let sum = terms.iter().map(|term| term.0).sum();
        Self::divided(total, &terms, sum)
    }

    fn divided(total: f64, terms: &[(f64, f64)], sum: f64) -> Self {
        let weights = terms.iter().map(|term| term.0 / sum).collect();
        let scales = terms.iter().map(|term| term.1).collect();
        Self { total, weights, scales, family: PhantomData }
    }

    /// Weights w_k, at least 0, of sum 1.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Scales s_k \[L\], from the least to the greatest.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// Pairs of weight and scale.
    pub fn terms(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.weights.iter().copied().zip(self.scales.iter().copied())
    }

    fn sum(&self, r: f64, f: impl Fn(f64, f64) -> f64) -> f64 {
        // No kernel has anything left there, and its square is a number
        let x = |scale: f64| (r.max(0.0) / scale).min(1e150);
        self.total * self.terms().map(|(weight, scale)| weight * f(x(scale), scale)).sum::<f64>()
    }
}

impl<F: Family> Profile for Mixture<F> {
    fn eval_times_r(&self, r: f64) -> f64 {
        self.sum(r, |x, scale| F::times_r(x) / scale)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.sum(r, |x, _| F::within(x))
    }

    fn beyond(&self, r: f64) -> f64 {
        self.sum(r, |x, _| F::beyond(x))
    }

    fn surface_albedo(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        F::MEAN_RADIUS * self.terms().map(|(weight, scale)| weight * scale).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::NormalizedDiffusion;

    use super::*;
    use crate::{Burley, Exponential};

    #[test]
    fn mixtures_are_the_profiles_they_spell() {
        let burley = NormalizedDiffusion::from_d(0.7, 1.3).unwrap();
        let one = Mixture::<Burley>::new(0.7, &[(1.0, 1.3)]).unwrap();
        let two = Mixture::<Exponential>::new(0.7, &[(1.5, 3.9), (0.5, 1.3)]).unwrap();
        for r in [0.0, 0.1, 1.0, 5.0, 30.0] {
            for mixture in [&one as &dyn Profile, &two] {
                assert!((mixture.eval_times_r(r) - burley.eval_times_r(r)).abs() < 1e-16);
                assert!((mixture.enclosed(r) - burley.enclosed(r)).abs() < 1e-15);
                assert!((mixture.beyond(r) / (0.7 * burley.complementary_cdf(r)) - 1.0).abs() < 1e-14);
                assert!((mixture.scale() - burley.mean_radius()).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn terms_are_checked() {
        let new = Mixture::<Exponential>::new;
        assert!(new(0.5, &[]).is_err());
        assert!(new(0.5, &[(0.0, 1.0)]).is_err());
        assert!(new(0.5, &[(1.0, 0.0)]).is_err());
        assert!(new(0.5, &[(2.0, 1.0), (-1.0, 1.0)]).is_err());
        assert!(new(f64::NAN, &[(1.0, 1.0)]).is_err());
        assert!(new(0.5, &[(f64::NAN, 1.0)]).is_err());
        assert!(new(0.5, &[(1.0, f64::NAN)]).is_err());
    }
}
