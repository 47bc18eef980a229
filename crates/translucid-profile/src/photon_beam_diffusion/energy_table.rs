//! Energy within and beyond a radius, of a profile that has no closed form for it.
//!
//! 2πr² R over ln r is interpolated by a polynomial in each of a few panels, and the polynomials are integrated.
//! All sums are of positive numbers, from either end, so that both ends keep their digits.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::quadrature::shared_gauss_legendre;

/// Points of a panel.
const POINTS: usize = 16;

/// ln r where panels meet: e² apart up to one transport mean free path, then as decay e^{−3r} lets them.
static BREAKS: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let near = (-11..0).map(|i| 2.0 * f64::from(i));
    near.chain([1.0_f64, 2.7, 5.5, 9.0, 13.0, R_LAST].map(f64::ln)).collect()
});

/// Greatest radius of the table.
pub(super) const R_LAST: f64 = 18.0;

/// Nodes of a panel, and what makes Legendre coefficients of values at them.
struct Panel {
    nodes: [f64; POINTS],
    /// (2k + 1)/2 wᵢ Pₖ(xᵢ)
    transform: [[f64; POINTS]; POINTS],
}

static PANEL: LazyLock<Panel> = LazyLock::new(|| {
    let rule = shared_gauss_legendre(POINTS);
    let mut transform = [[0.0; POINTS]; POINTS];
    for (i, &(x, weight)) in rule.iter().enumerate() {
        for (k, p) in legendre::<POINTS>(x).into_iter().enumerate() {
            transform[k][i] = (k as f64 + 0.5) * weight * p;
        }
    }
    Panel { nodes: std::array::from_fn(|i| rule[i].0), transform }
});

/// P₀ … P_{N−1} at x.
fn legendre<const N: usize>(x: f64) -> [f64; N] {
    let mut p = [1.0; N];
    p[1] = x;
    for k in 1..N - 1 {
        p[k + 1] = ((2 * k + 1) as f64 * x * p[k] - k as f64 * p[k - 1]) / (k + 1) as f64;
    }
    p
}

/// ∫ R 2πr dr between the radii of the panels.
#[derive(Clone, Debug)]
pub(super) struct EnergyTable {
    /// Legendre coefficients of the integrand of each panel.
    coefficients: Vec<[f64; POINTS]>,
    /// Energy within the inner radius of each panel, and within the last radius.
    within: Vec<f64>,
    /// Energy beyond the inner radius of each panel, and beyond the last radius.
    beyond: Vec<f64>,
}

impl EnergyTable {
    /// Of the profile R, given the energies within the first radius and beyond the last.
    pub(super) fn new(within_first: f64, beyond_last: f64, reflectance: impl Fn(f64) -> f64) -> Self {
        let panel = &*PANEL;
        let coefficients: Vec<[f64; POINTS]> = BREAKS
            .windows(2)
            .map(|ends| {
                let (center, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
                let values = panel.nodes.map(|x| {
                    let r = (center + half * x).exp();
                    half * 2.0 * PI * r * r * reflectance(r)
                });
                panel.transform.map(|row| row.iter().zip(values).map(|(a, b)| a * b).sum())
            })
            .collect();
        let mut within = vec![within_first];
        for c in &coefficients {
            within.push(within[within.len() - 1] + 2.0 * c[0]);
        }
        let mut beyond = vec![beyond_last];
        for c in coefficients.iter().rev() {
            beyond.push(beyond[beyond.len() - 1] + 2.0 * c[0]);
        }
        beyond.reverse();
        Self { coefficients, within, beyond }
    }

    /// Least radius of the table.
    pub(super) fn r_first() -> f64 {
        BREAKS[0].exp()
    }

    /// Energies within and beyond r, which lies between the first and the last radius.
    pub(super) fn within_and_beyond(&self, r: f64) -> (f64, f64) {
        let x = r.ln();
        let last = self.coefficients.len() - 1;
        let panel = BREAKS.partition_point(|end| *end <= x).saturating_sub(1).min(last);
        let (left, right) = (BREAKS[panel], BREAKS[panel + 1]);
        let x = ((2.0 * x - (left + right)) / (right - left)).clamp(-1.0, 1.0);

        // ∫ Pₖ from −1 is (Pₖ₊₁ − Pₖ₋₁)/(2k + 1)
        let (c, p) = (&self.coefficients[panel], legendre::<{ POINTS + 1 }>(x));
        let mut part = c[0] * (x + 1.0);
        for k in 1..POINTS {
            part += c[k] * (p[k + 1] - p[k - 1]) / (2 * k + 1) as f64;
        }
        (self.within[panel] + part, self.beyond[panel + 1] + (2.0 * c[0] - part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// R = e^{−r}/2πr: within r lie 1 − e^{−r}, beyond it e^{−r}.
    #[test]
    fn energies_match_an_exponential() {
        let first = EnergyTable::r_first();
        let table = EnergyTable::new(-(-first).exp_m1(), (-R_LAST).exp(), |r| (-r).exp() / (2.0 * PI * r));
        for i in 0..=400 {
            let r = first * (R_LAST / first).powf(f64::from(i) / 400.0);
            let (within, beyond) = table.within_and_beyond(r);
            assert!((within / -(-r).exp_m1() - 1.0).abs() < 1e-11, "{r:e}: {within:e}");
            assert!((beyond / (-r).exp() - 1.0).abs() < 1e-9, "{r:e}: {beyond:e}");
        }
    }
}
