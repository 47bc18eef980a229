//! A profile and its energy within and beyond a radius, where neither has a closed form.
//!
//! 2πr² R over ln r is interpolated by a polynomial in each of a few panels, and the polynomials are integrated.
//! So is R itself: 60 ns where the integral over the beam takes 460 to 760, and as near to it as that is to the truth.
//! All sums are of positive numbers, from either end, so that both ends keep their digits.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::math::legendre_panel::LegendrePanel;

/// ln r where panels meet: e² or e apart up to one transport mean free path, then as decay e^{−3r} lets them.
static BREAKS: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let near = (-11..0).map(|i| 2.0 * f64::from(i)).chain([-1.0, 0.0]);
    near.chain([2.7_f64, 5.5, 9.0, 13.0, R_LAST].map(f64::ln)).collect()
});

/// Greatest radius of the table.
pub(super) const R_LAST: f64 = 18.0;

/// ∫ R 2πr dr between the radii of the panels.
#[derive(Clone, Debug)]
pub(super) struct EnergyTable {
    /// R over ln r.
    profile: Vec<LegendrePanel>,
    /// 2πr² R over ln r.
    panels: Vec<LegendrePanel>,
    /// Energy within the inner radius of each panel, and within the last radius.
    within: Vec<f64>,
    /// Energy beyond the inner radius of each panel, and beyond the last radius.
    beyond: Vec<f64>,
}

impl EnergyTable {
    /// Of the profile R, given the energies within the first radius and beyond the last.
    pub(super) fn new(within_first: f64, beyond_last: f64, reflectance: impl Fn(f64) -> f64) -> Self {
        let (mut profile, mut panels) = (Vec::new(), Vec::new());
        for ends in BREAKS.windows(2) {
            let (center, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let radii = LegendrePanel::nodes().map(|x| (center + half * x).exp());
            let values = radii.map(&reflectance);
            profile.push(LegendrePanel::new(&values));
            let rings = std::array::from_fn(|i| half * 2.0 * PI * (radii[i] * radii[i]) * values[i]);
            panels.push(LegendrePanel::new(&rings));
        }
        let mut within = vec![within_first];
        for panel in &panels {
            within.push(within[within.len() - 1] + panel.integral());
        }
        let mut beyond = vec![beyond_last];
        for panel in panels.iter().rev() {
            beyond.push(beyond[beyond.len() - 1] + panel.integral());
        }
        beyond.reverse();
        Self { profile, panels, within, beyond }
    }

    /// Least radius of the table.
    pub(super) fn r_first() -> f64 {
        BREAKS[0].exp()
    }

    /// The panel that r is in, and where, in [−1, 1].
    fn place(&self, r: f64) -> (usize, f64) {
        let x = r.ln();
        let last = self.panels.len() - 1;
        let panel = BREAKS.partition_point(|end| *end <= x).saturating_sub(1).min(last);
        let (left, right) = (BREAKS[panel], BREAKS[panel + 1]);
        (panel, ((2.0 * x - (left + right)) / (right - left)).clamp(-1.0, 1.0))
    }

    /// R(r), r between the first and the last radius.
    pub(super) fn reflectance(&self, r: f64) -> f64 {
        let (panel, x) = self.place(r);
        self.profile[panel].value(x)
    }

    /// Energies within and beyond r, which lies between the first and the last radius.
    pub(super) fn within_and_beyond(&self, r: f64) -> (f64, f64) {
        let (panel, x) = self.place(r);
        let part = self.panels[panel].integral_to(x);
        (self.within[panel] + part, self.beyond[panel + 1] + (self.panels[panel].integral() - part))
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
