//! Energy within and beyond a radius, as parts of one total.
//!
//! Each has a sum of its own over wave numbers, and the total a third. Where most is outside, what is beyond is the
//! total less what is within; where most is inside, the other way round. So neither exceeds the total, both add up
//! to it, and the smaller keeps its digits.
//!
//! Very far out the sums end: there the energy beyond goes on as that of a dipole of diffused light does,
//!
//! ```text
//! beyond(r) = beyond(r₁) (r₁/r) e^{−k₀(r − r₁)}
//! ```

use crate::Estimate;

/// Quantities that the parts of the energy have in common.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EnergyBudget {
    total: Estimate,
    /// Least decay rate k₀ along the surface.
    k0: f64,
    /// r₁, from which on energy falls by its law.
    far: f64,
}

/// Radius up to which the nodes of wave numbers resolve energies.
const R_FAR: f64 = 1e5;
/// Radius up to which they do where what is beyond is a difference, whose digits are lost to the total's error.
const R_FAR_DIFFERENCE: f64 = 1e4;
/// Greatest k₀ r₁ there.
const DEPTH_FAR: f64 = 3.0;

impl EnergyBudget {
    /// `is_difference`: whether the sum for what is beyond is itself the total less what is within.
    pub(crate) fn new(total: Estimate, k0: f64, is_difference: bool) -> Self {
        let far = if is_difference { (DEPTH_FAR / k0).min(R_FAR_DIFFERENCE) } else { R_FAR };
        Self { total, k0, far }
    }

    /// Surface albedo.
    pub(crate) fn total(&self) -> Estimate {
        self.total
    }

    /// Energy within and beyond r > 0, from the sums for each.
    pub(crate) fn split(
        &self,
        r: f64,
        within: impl Fn(f64) -> Estimate,
        beyond: impl Fn(f64) -> Estimate,
    ) -> [Estimate; 2] {
        let beyond = self.part(self.beyond(r, beyond));
        if beyond.value < 0.5 * self.total.value {
            return [self.rest(beyond), beyond];
        }
        let within = self.part(within(r));
        [within, self.rest(within)]
    }

    fn beyond(&self, r: f64, beyond: impl Fn(f64) -> Estimate) -> Estimate {
        if r <= self.far {
            return beyond(r);
        }
        let Estimate { value, error } = beyond(self.far);
        let factor = self.far / r * libm::exp(-self.k0 * (r - self.far));
        // The law is a leading order: it is not trusted with any digit
        Estimate { value: value * factor, error: (value + error) * factor }
    }

    fn part(&self, Estimate { value, error }: Estimate) -> Estimate {
        Estimate { value: value.min(self.total.value).max(0.0), error }
    }

    fn rest(&self, part: Estimate) -> Estimate {
        Estimate { value: self.total.value - part.value, error: self.total.error + part.error }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use translucid_testing::is_thorough;

    use crate::Incidence;
    use crate::exact::HalfSpace;

    /// Solutions with and without boundaries, and with and without absorption.
    static SOLUTIONS: LazyLock<Vec<(String, HalfSpace)>> = LazyLock::new(|| {
        let albedos = if is_thorough() { &[1.0, 0.5, 0.9999, 1.0 - 1e-16][..] } else { &[1.0, 0.9999] };
        let cases = [(0.5, Incidence::Cosine), (1.0, Incidence::NORMAL), (1.4, Incidence::Cosine)];
        let solve = |alpha: f64, (eta, incidence)| {
            let half_space = HalfSpace::with_boundary(alpha, eta, incidence).expect("valid");
            (format!("alpha {alpha}, eta {eta}"), half_space)
        };
        albedos.iter().flat_map(|&alpha| cases.map(|case| solve(alpha, case))).collect()
    });

    /// Energies at radii of 10^−3 … 10^100.
    #[test]
    fn enclosed_rises_to_the_total() {
        for (name, half_space) in SOLUTIONS.iter() {
            let total = half_space.total().value;
            assert!(total <= 1.0, "{name}: {total}");
            let (mut within, mut beyond) = (0.0, total);
            for step in -12..=400 {
                let r = 10f64.powf(0.25 * f64::from(step));
                let what = format!("{name}, r {r:e}");
                let (enclosed, left) = (half_space.enclosed(r), half_space.beyond(r));
                assert!(enclosed.value >= within, "{what}: {enclosed:?} after {within}");
                assert!(enclosed.value <= total, "{what}: {enclosed:?} of {total}");
                assert!(left.value <= beyond && left.value >= 0.0, "{what}: {left:?} after {beyond}");
                assert!((enclosed.value + left.value - total).abs() < 3e-16, "{what}");
                (within, beyond) = (enclosed.value, left.value);
            }
            assert_eq!(within, total, "{name}");
        }
    }

    /// Without absorption beyond(r) r has a limit: no jump where the law takes over.
    #[test]
    fn beyond_goes_on_as_it_was() {
        let without_absorption =
            SOLUTIONS.iter().filter(|(_, half_space)| half_space.single_scattering_albedo() == 1.0);
        for (name, half_space) in without_absorption {
            let moment = |r: f64| half_space.beyond(r).value * r;
            let expected = moment(1e3);
            for r in [0.99e4, 1.01e4, 1e9] {
                let ratio = moment(r) / expected;
                assert!((ratio - 1.0).abs() < 1e-2, "{name} {r:e}: {ratio}");
            }
        }
    }
}
