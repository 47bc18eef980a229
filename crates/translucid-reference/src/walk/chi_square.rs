//! χ² for the walk's tests.

/// Distance of χ² above its mean, as a standard normal deviate (E. B. Wilson and M. M. Hilferty, *The
/// distribution of chi-square*, 1931).
pub(super) fn deviate(chi2: f64, freedom: f64) -> f64 {
    let variance = 2.0 / (9.0 * freedom);
    ((chi2 / freedom).cbrt() - 1.0 + variance) / variance.sqrt()
}

/// Two samples of equal size, binned alike; bins with fewer than 20 in both together are left out.
pub(super) fn deviate_of_two_samples(a: &[u64], b: &[u64]) -> f64 {
    let filled = || a.iter().zip(b).filter(|&(&a, &b)| a + b >= 20);
    let chi2: f64 = filled().map(|(&a, &b)| (a as f64 - b as f64).powi(2) / (a + b) as f64).sum();
    deviate(chi2, filled().count() as f64 - 1.0)
}

/// Counts of a sample of known size against their expectations, with all that is in no bin as another bin.
pub(super) fn deviate_of_counts(counts: &[u64], expected: &[f64], size: u64) -> f64 {
    assert!(expected.iter().all(|&e| e >= 10.0), "too few expected: {expected:?}");
    let rest = size - counts.iter().sum::<u64>();
    let rest_expected = size as f64 - expected.iter().sum::<f64>();
    let terms = counts.iter().zip(expected).map(|(&n, &e)| (n as f64 - e).powi(2) / e);
    let chi2 = terms.sum::<f64>() + (rest as f64 - rest_expected).powi(2) / rest_expected;
    deviate(chi2, expected.len() as f64)
}

/// Standard normal deviate of a count with a known probability.
pub(super) fn deviate_of_count(count: u64, size: u64, probability: f64) -> f64 {
    let n = size as f64;
    (count as f64 - n * probability) / (n * probability * (1.0 - probability)).sqrt()
}
