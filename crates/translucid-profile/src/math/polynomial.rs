//! Polynomials by Horner's rule.

/// Σ cᵢ xⁱ.
#[inline(always)]
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}
