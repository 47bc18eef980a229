//! Probability that chance alone is as far off.

use std::f64::consts::PI;

/// Probability that χ² of so many degrees of freedom is at least as large as the one found, in \[0, 1\]; 1 without any
/// freedom.
///
/// For whole degrees of freedom a finite sum, with the complementary error function where they are odd (M. Abramowitz
/// and I. A. Stegun, *Handbook of Mathematical Functions*, 1964, 26.4.4 and 26.4.5):
///
/// ```text
/// Q(x | n even) = e^{−x/2} Σ_{i<n/2} (x/2)^i / i!
/// Q(x | n odd)  = erfc(√(x/2)) + e^{−x/2} √(2x/π) Σ_{i<(n−1)/2} x^i / (1·3·…·(2i+1))
/// ```
///
/// ```
/// // One degree of freedom is a squared normal deviate: 1.96 standard deviations
/// assert!((translucid_laboratory::comparison::chi_square_probability(3.841_459, 1) - 0.05).abs() < 1e-7);
/// ```
pub fn chi_square_probability(chi_square: f64, freedom: usize) -> f64 {
    let x = chi_square.max(0.0);
    if freedom == 0 {
        return 1.0;
    }
    if x > 2000.0 + 4.0 * freedom as f64 {
        return 0.0;
    }
    // Terms grow before they fall, so each carries its share of the exponential
    let odd = freedom % 2 == 1;
    let first = if odd { (2.0 * x / PI).sqrt().ln() - 0.5 * x } else { -0.5 * x };
    let ratio = |i: usize| if odd { x / (2 * i + 1) as f64 } else { 0.5 * x / i as f64 };
    let (mut ln_term, mut sum) = (first, 0.0);
    for i in 0..freedom / 2 {
        if i > 0 {
            ln_term += ratio(i).ln();
        }
        sum += ln_term.exp();
    }
    let tail = if odd { libm::erfc((0.5 * x).sqrt()) } else { 0.0 };
    (sum + tail).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz and Stegun, table 26.8: percentage points.
    #[test]
    fn probabilities_are_those_of_the_handbook() {
        for (freedom, chi_square, probability) in [
            (1, 2.70554, 0.1),
            (2, 5.99147, 0.05),
            (3, 7.81473, 0.05),
            (5, 1.14548, 0.95),
            (10, 23.2093, 0.01),
            (40, 55.7585, 0.05),
            (100, 67.3276, 0.995),
        ] {
            let found = chi_square_probability(chi_square, freedom);
            assert!((found / probability - 1.0).abs() < 2e-5, "{freedom} {chi_square}: {found}");
        }
    }

    #[test]
    fn probabilities_fall_from_one_to_zero() {
        for freedom in [1, 2, 7, 40, 1001] {
            assert_eq!(chi_square_probability(0.0, freedom), 1.0);
            assert_eq!(chi_square_probability(1e9, freedom), 0.0);
            assert_eq!(chi_square_probability(f64::INFINITY, freedom), 0.0);
            let mut before = 1.0;
            for i in 1..200 {
                let next = chi_square_probability(0.02 * f64::from(i * i), freedom);
                assert!(next <= before + 1e-12, "{freedom} {i}: {next} {before}");
                before = next;
            }
        }
        assert_eq!(chi_square_probability(f64::NAN, 3), 1.0);
        assert_eq!(chi_square_probability(5.0, 0), 1.0);
    }
}
