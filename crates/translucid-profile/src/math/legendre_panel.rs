//! A polynomial through an integrand's values at Gauss points, and its integral up to any place.

use std::sync::LazyLock;

use crate::math::quadrature::shared_gauss_legendre;

/// Points of a panel.
pub(crate) const POINTS: usize = 16;

/// The Gauss points, and what makes Legendre coefficients of values at them.
struct Rule {
    nodes: [f64; POINTS],
    /// (2k + 1)/2 wᵢ Pₖ(xᵢ): a row for each point i.
    transform: [[f64; POINTS]; POINTS],
}

static RULE: LazyLock<Rule> = LazyLock::new(|| {
    let rule = shared_gauss_legendre(POINTS);
    let transform = std::array::from_fn(|i| {
        let (x, weight) = rule[i];
        let p = legendre(x);
        std::array::from_fn(|k| (k as f64 + 0.5) * weight * p[k])
    });
    Rule { nodes: std::array::from_fn(|i| rule[i].0), transform }
});

/// Bonnet's recursion (k + 1) Pₖ₊₁ = (2k + 1) x Pₖ − k Pₖ₋₁, divided by k + 1 beforehand.
const BONNET: [[f64; 2]; POINTS] = {
    let mut factors = [[0.0; 2]; POINTS];
    let mut k = 0;
    while k < POINTS {
        factors[k] = [(2 * k + 1) as f64 / (k + 1) as f64, k as f64 / (k + 1) as f64];
        k += 1;
    }
    factors
};

/// P₀ … P₁₆ at x.
fn legendre(x: f64) -> [f64; POINTS + 1] {
    let mut p = [1.0; POINTS + 1];
    p[1] = x;
    for k in 1..POINTS {
        p[k + 1] = BONNET[k][0] * x * p[k] - BONNET[k][1] * p[k - 1];
    }
    p
}

/// An integrand on [−1, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LegendrePanel {
    /// Legendre coefficients over 2k + 1.
    reduced: [f64; POINTS],
}

impl LegendrePanel {
    /// Points at which the integrand is to be evaluated.
    pub(crate) fn nodes() -> &'static [f64; POINTS] {
        &RULE.nodes
    }

    /// The panel of values at the nodes.
    pub(crate) fn new(values: &[f64; POINTS]) -> Self {
        let mut reduced = [0.0; POINTS];
        for (value, row) in values.iter().zip(&RULE.transform) {
            for (sum, factor) in reduced.iter_mut().zip(row) {
                *sum += factor * value;
            }
        }
        for (k, c) in reduced.iter_mut().enumerate() {
            *c /= (2 * k + 1) as f64;
        }
        Self { reduced }
    }

    /// Integral over [−1, 1].
    pub(crate) fn integral(&self) -> f64 {
        2.0 * self.reduced[0]
    }

    /// Integral over [−1, x].
    pub(crate) fn integral_to(&self, x: f64) -> f64 {
        // ∫ Pₖ from −1 is (Pₖ₊₁ − Pₖ₋₁)/(2k + 1)
        let (c, p) = (&self.reduced, legendre(x));
        let mut sum = c[0] * (x + 1.0);
        for k in 1..POINTS {
            sum += c[k] * (p[k + 1] - p[k - 1]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integral_to_is_exact_for_polynomials() {
        for power in 0..POINTS as i32 {
            let panel = LegendrePanel::new(&LegendrePanel::nodes().map(|x| x.powi(power)));
            let antiderivative = |x: f64| x.powi(power + 1) / f64::from(power + 1);
            for i in 0..=20 {
                let x = f64::from(i) / 10.0 - 1.0;
                let expected = antiderivative(x) - antiderivative(-1.0);
                assert!((panel.integral_to(x) - expected).abs() < 1e-15, "power {power} to {x}");
            }
            let expected = antiderivative(1.0) - antiderivative(-1.0);
            assert!((panel.integral() - expected).abs() < 1e-15, "power {power}");
        }
    }
}
