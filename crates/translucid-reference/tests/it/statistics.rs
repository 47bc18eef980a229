//! Deviates and coverage.

use translucid_testing::power;

/// Standard normal deviate of χ² with n degrees of freedom: its cube root is nearly normal (E. B. Wilson and M. M.
/// Hilferty 1931). Off by less than 10 % of the probability near 0.001 for n ≥ 10.
pub(crate) fn chi_square_deviate(chi_square: f64, n: usize) -> f64 {
    let spread = 2.0 / (9.0 * n as f64);
    ((chi_square / n as f64).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Probability that χ² with n degrees of freedom exceeds a value.
pub(crate) fn chi_square_exceedance(chi_square: f64, n: usize) -> f64 {
    0.5 * libm::erfc(chi_square_deviate(chi_square, n) / 2f64.sqrt())
}

/// Runs that tell whether intervals of 95 % hold the truth: 200, or 25 with an eighth of the power.
pub(crate) fn runs_of_coverage() -> u64 {
    power(200)
}

/// Tells whether a number of intervals that hold the truth can be that of intervals of 95 %. It is binomial: outside
/// 178…199 of 200 or 19…25 of 25 with a probability of 2e-4.
pub(crate) fn is_coverage_of_95_percent(hits: u64) -> bool {
    if runs_of_coverage() == 200 { (178..200).contains(&hits) } else { hits >= 19 }
}
