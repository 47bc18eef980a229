//! Gauss–Legendre quadrature, for integrals that have no closed form.

use std::f64::consts::PI;
use std::sync::OnceLock;

/// Nodes and weights of the rule with n points on [−1, 1].
///
/// Newton's iteration on the Legendre polynomial Pₙ from Tricomi's guess cos(π (i + ¾)/(n + ½)); exact to
/// rounding for polynomials up to degree 2n − 1.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    if (1..=MOST_SHARED).contains(&n) { shared_gauss_legendre(n).to_vec() } else { worked_out(n) }
}

/// Points of the largest rule that is kept.
const MOST_SHARED: usize = 64;

/// The rule of [`gauss_legendre`] with 1 ≤ n ≤ 64 points, worked out when it is first asked for: 20 points take 20 µs.
pub(crate) fn shared_gauss_legendre(n: usize) -> &'static [(f64, f64)] {
    static RULES: [OnceLock<Vec<(f64, f64)>>; MOST_SHARED] = [const { OnceLock::new() }; MOST_SHARED];
    RULES[n - 1].get_or_init(|| worked_out(n))
}

fn worked_out(n: usize) -> Vec<(f64, f64)> {
    (0..n).map(|i| gauss_legendre_point(n, i)).collect()
}

fn gauss_legendre_point(n: usize, i: usize) -> (f64, f64) {
    let mut x = libm::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
    let mut slope = 1.0;
    for _ in 0..8 {
        let (value, new_slope) = legendre(n, x);
        slope = new_slope;
        x -= value / slope;
    }
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

/// Pₙ(x) and its slope, by Bonnet's recursion.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 1..=n {
        let k = k as f64;
        let next = ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k;
        (before, value) = (value, next);
    }
    (value, n as f64 * (x * value - before) / (x * x - 1.0))
}

/// ∫ f from a to b with the rule given.
pub fn integrate(rule: &[(f64, f64)], a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (center, half) = (0.5 * (a + b), 0.5 * (b - a));
    half * rule.iter().map(|&(x, weight)| weight * f(center + half * x)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_is_exact_for_polynomials() {
        for n in [2, 5, 16, 64] {
            let rule = gauss_legendre(n);
            for power in 0..2 * n {
                let found = integrate(&rule, 0.0, 1.0, |x| x.powi(power as i32));
                assert!((found * (power + 1) as f64 - 1.0).abs() < 1e-13, "{n} points, power {power}");
            }
        }
    }
}
