//! A half space of two media side by side: the judge of profiles whose parameters are textured.

use std::f64::consts::TAU;

use translucid_profile::{ParameterError, require};

use super::photon::{Beyond, Space, Wall, follow};
use super::shape::nearest;
use super::tally::Tally;
use crate::ray::{Ray, Vector, across};
use crate::split_mix::SplitMix;

/// A medium that scatters isotropically, without a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Half {
    /// Single-scattering albedo α in [0, 1).
    pub single_scattering_albedo: f64,
    /// Mean free path ℓ, greater than 0 and finite, in a unit of length that both halves share.
    pub mfp: f64,
}

/// The half space z > 0 with one medium where x < 0 and another where x ≥ 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoHalves {
    halves: [Half; 2],
}

impl TwoHalves {
    /// Checks the media at x < 0 and at x ≥ 0.
    ///
    /// # Errors
    /// A parameter is outside the range that [`Half`] states.
    pub fn new(halves: [Half; 2]) -> Result<Self, ParameterError> {
        for Half { single_scattering_albedo: alpha, mfp } in halves {
            require((0.0..1.0).contains(&alpha), "single_scattering_albedo", alpha, "in [0, 1)")?;
            require(mfp > 0.0 && mfp.is_finite(), "mfp", mfp, "greater than 0 and finite")?;
        }
        Ok(Self { halves })
    }

    /// Follows photons that enter at x with a cosine distribution; part 0 of the tally is the surface at x < 0, part 1
    /// that at x ≥ 0.
    ///
    /// As paths of light can be reversed, the share that leaves through a part is the radiosity at x where that part
    /// alone is lit evenly.
    pub fn walk(&self, x: f64, photons: u64, seed: u64) -> Tally {
        Tally::of_photons(2, photons, seed, |random| {
            let direction = across(INWARD, random.uniform().sqrt(), TAU * random.uniform());
            follow(self, usize::from(x >= 0.0), Ray { position: [x, 0.0, 0.0], direction }, random)
        })
    }
}

const INWARD: Vector = [0.0, 0.0, 1.0];

/// Regions 0 and 1 are the halves.
impl Space for TwoHalves {
    fn extinction(&self, half: usize) -> f64 {
        1.0 / self.halves[half].mfp
    }

    fn single_scattering_albedo(&self, half: usize) -> f64 {
        self.halves[half].single_scattering_albedo
    }

    fn scatter(&self, _: usize, _: Vector, random: &mut SplitMix) -> Vector {
        across(INWARD, 2.0 * random.uniform() - 1.0, TAU * random.uniform())
    }

    fn wall(&self, half: usize, ray: &Ray) -> Option<Wall> {
        let divide = [2.0 * half as f64 - 1.0, 0.0, 0.0];
        let (number, distance, inward) = nearest([(INWARD, 0.0), (divide, 0.0)], ray)?;
        let beyond = if number == 0 { Beyond::Outside(half) } else { Beyond::Region(1 - half) };
        Some(Wall { distance, inward, eta: 1.0, beyond })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use translucid_profile::{Configuration, half_space_single_scattering_albedo};
    use translucid_testing::{bound, power};

    use super::*;
    use crate::exact::HalfSpace;
    use crate::{Estimate, Incidence};

    fn half(surface_albedo: f64, mfp: f64) -> Half {
        let alpha = half_space_single_scattering_albedo(surface_albedo, Configuration::Diffuse);
        Half { single_scattering_albedo: alpha, mfp }
    }

    /// Four standard errors, false-alarm rate 6e-5 a comparison.
    fn assert_near(name: &str, found: Estimate, expected: f64) {
        let z = (found.value - expected) / found.error;
        assert!(z.abs() < 4.0, "{name}: {} ± {}, expected {expected}", found.value, found.error);
    }

    /// Energy of a profile beyond a line at a distance: ∫ acos(x/r)/π dE.
    fn beyond_line(exact: &HalfSpace, x: f64) -> f64 {
        let n = 400;
        // r = x/cos φ, of which the part φ/π of the circle lies beyond
        (0..n)
            .map(|i| {
                let [from, to] = [i, i + 1].map(|i| 0.5 * PI * f64::from(i) / f64::from(n));
                let beyond = |phi: f64| if phi > 1.57 { 0.0 } else { exact.beyond(x / phi.cos()).value };
                (beyond(from) - beyond(to)) * 0.5 * (from + to) / PI
            })
            .sum()
    }

    /// Equal halves are the exact half space, whatever the unit of length.
    #[test]
    fn equal_halves_are_one_half_space() {
        for mfp in [1.0, 0.1] {
            let body = TwoHalves::new([half(0.7, mfp); 2]).unwrap();
            let exact = HalfSpace::from_surface_albedo(0.7, Incidence::Cosine).unwrap();
            for x in [-0.3, 1.0] {
                let tally = body.walk(x * mfp, power(200_000), 3);
                let other = beyond_line(&exact, x.abs());
                let far = usize::from(x < 0.0);
                assert_near(&format!("{mfp} {x}, far"), tally.scattered_through(far), other);
                assert_near(&format!("{mfp} {x}, all"), tally.leaving(), 0.7);
            }
        }
    }

    /// Light that crosses the divide one way, summed over all places of entry, crosses it the other way.
    #[test]
    fn unequal_halves_are_reciprocal() {
        let body = TwoHalves::new([half(0.9, 0.4), half(0.4, 1.0)]).unwrap();
        let places = 100_u32;
        let crossing = |side: f64, part: usize| {
            let mut sum = Estimate::ZERO;
            for place in 0..places {
                let x = side * 15.0 * ((f64::from(place) + 0.5) / f64::from(places)).powi(2);
                let step = 30.0 * ((f64::from(place) + 0.5) / f64::from(places)) / f64::from(places);
                let share = body.walk(x, power(20_000), u64::from(place)).scattered_through(part);
                sum.value += step * share.value;
                sum.error = sum.error.hypot(step * share.error);
            }
            sum
        };
        let (there, back) = (crossing(-1.0, 1), crossing(1.0, 0));
        let error = there.error.hypot(back.error);
        assert!(error < bound(0.01) * there.value, "too noisy to tell: {there:?}");
        assert_near("crossing", Estimate { error, ..there }, back.value);
    }

    #[test]
    fn parameters_out_of_range_are_refused() {
        let bad = [Half { mfp: 0.0, ..half(0.5, 1.0) }, Half { single_scattering_albedo: 1.0, mfp: 1.0 }];
        assert!(bad.into_iter().all(|bad| TwoHalves::new([half(0.5, 1.0), bad]).is_err()));
    }
}
