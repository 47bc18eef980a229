//! A profile through points that somebody measured or simulated.

use std::f64::consts::PI;

use crate::Profile;
use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::math::quadrature::{integrate, shared_gauss_legendre};

/// Points of the Gauss rule on each panel, on which ln(r R) is a cubic in ln r.
const POINTS: usize = 8;
/// The most that r R of a sample of 0 between others counts as, relative to the greatest.
const FLOOR: f64 = 1e-12;
/// Natural logarithm by which radius or r R change over one panel of the Gauss rule.
const PANEL: f64 = 2.0;
/// Least ratio of a radius to the one before it, so that their logarithms differ.
const RATIO_MIN: f64 = 1.0 + 1e-9;

/// The reflectance profile through samples (r, R): a monotone cubic of ln(r R) in ln r between them, r R a straight line
/// before the first and an exponential behind the last.
///
/// The straight line goes through the first two samples, kept between 0 and twice the first at r = 0: R may tend to a
/// constant there or grow like 1/r.
/// The rate of the exponential in r R is the least-squares one of the samples with light in the outer half of the radii.
/// Noise is not smoothed; a sample of 0 between others counts as 1e-12 of the greatest r R, or as the least if that is
/// less, and samples of 0 at the end are left out.
/// To evaluate often, to sample or to rescale, make a [`TabulatedProfile`](crate::TabulatedProfile) of it.
///
/// ```
/// use translucid_profile::{NormalizedDiffusion, Profile, SampledProfile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let source = NormalizedDiffusion::from_d(0.8, 1.0)?;
/// let radii: Vec<f64> = (0..100).map(|i| 0.01 * 1.08_f64.powi(i)).collect();
/// let reflectances: Vec<f64> = radii.iter().map(|&r| source.eval(r)).collect();
/// let sampled = SampledProfile::new(&radii, &reflectances)?;
/// assert!((sampled.total() - 0.8).abs() < 1e-5);
/// assert!((sampled.eval(1.234) / source.eval(1.234) - 1.0).abs() < 1e-5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SampledProfile {
    /// ln(r R) over ln r, radii in units of `length`.
    curve: MonotoneCubic,
    /// Radii of the samples in units of `length`.
    radii: Vec<f64>,
    /// Energy within each sample's radius.
    enclosed: Vec<f64>,
    /// Energy beyond each sample's radius.
    beyond: Vec<f64>,
    /// r R at r = 0, and at the first sample.
    head: [f64; 2],
    /// Rate at which r R falls behind the last sample, in 1/`length`.
    tail_rate: f64,
    /// Last sample's r and r R.
    last: [f64; 2],
    /// Energy within the last sample's radius and behind it.
    total: f64,
    rule: &'static [(f64, f64)],
    /// Radius of the sample in the middle \[L\].
    length: f64,
}

impl SampledProfile {
    /// Makes the profile of at least four radii r > 0 \[L\], rising, and as many reflectances R ≥ 0 \[L⁻²\].
    ///
    /// # Errors
    /// A radius or reflectance is out of its range, there are too few, or R does not fall towards its end.
    pub fn new(radii: &[f64], reflectances: &[f64]) -> Result<Self, ParameterError> {
        let count = radii.len();
        require(
            count == reflectances.len(),
            "number of reflectances",
            reflectances.len() as f64,
            "that of radii",
        )?;
        let mut before = 0.0;
        for &r in radii {
            let allowed = "greater than the one before by 1e-9 of itself, in (0, 1e100]";
            require(r > before * RATIO_MIN && r <= 1e100, "radius", r, allowed)?;
            before = r;
        }
        for &reflectance in reflectances {
            require((0.0..=1e200).contains(&reflectance), "reflectance", reflectance, "in [0, 1e200]")?;
        }
        let count = count - reflectances.iter().rev().take_while(|&&reflectance| reflectance == 0.0).count();
        require(count >= 4, "number of radii up to the last with light", count as f64, "at least 4")?;

        // Bring lengths near 1, and take logarithms
        let length = radii[count / 2];
        let unit: Vec<f64> = radii[..count].iter().map(|r| r / length).collect();
        let densities: Vec<f64> =
            unit.iter().zip(reflectances).map(|(x, value)| (x * length) * value * length).collect();
        let greatest = densities.iter().copied().fold(0.0, f64::max);
        let with_light = densities.iter().copied().filter(|density| *density > 0.0);
        let floor = with_light.fold(FLOOR * greatest, f64::min).max(f64::MIN_POSITIVE);
        let logarithm = |density: &f64| density.max(floor).ln();
        let (xs, ys): (Vec<f64>, Vec<f64>) =
            (unit.iter().map(|x| x.ln()).collect(), densities.iter().map(logarithm).collect());
        let (first, second) = (ys[0].exp(), ys[1].exp());
        let at_zero = first - (second - first) / (unit[1] - unit[0]) * unit[0];
        let head = [at_zero.max(0.0).min(2.0 * first), first];
        let lit: Vec<(f64, f64)> = (unit.iter().copied().zip(ys.iter().copied()).zip(&densities))
            .filter_map(|(point, density)| (*density > 0.0).then_some(point))
            .collect();
        require(lit.len() > 1, "number of radii with light", lit.len() as f64, "at least 2")?;
        let tail_rate = falling_rate(&lit);
        let allowed = "greater than 0: the reflectance has to fall towards its end";
        require(tail_rate > 0.0, "rate at which r R falls in the outer half", tail_rate / length, allowed)?;

        let last = [unit[count - 1], ys[count - 1].exp()];
        let mut profile = Self {
            curve: MonotoneCubic::new(&xs, &ys),
            radii: unit,
            enclosed: Vec::new(),
            beyond: Vec::new(),
            head,
            tail_rate,
            last,
            total: 0.0,
            rule: shared_gauss_legendre(POINTS),
            length,
        };

        // Sum up the energies from both sides, where each keeps its digits
        let rings: Vec<f64> = xs.windows(2).map(|pair| profile.between(pair[0], pair[1])).collect();
        let mut enclosed = profile.within_head(profile.radii[0]);
        let mut beyond = profile.tail(last[0]);
        profile.enclosed.push(enclosed);
        profile.beyond.push(beyond);
        for (ring, opposite) in rings.iter().zip(rings.iter().rev()) {
            enclosed += ring;
            beyond += opposite;
            profile.enclosed.push(enclosed);
            profile.beyond.push(beyond);
        }
        profile.beyond.reverse();
        profile.total = enclosed + profile.tail(last[0]);
        let allowed = "finite and greater than 0";
        require(
            profile.total > 0.0 && profile.total.is_finite(),
            "energy of all samples",
            profile.total,
            allowed,
        )?;
        Ok(profile)
    }

    /// Energy within x, not beyond the first sample.
    fn within_head(&self, x: f64) -> f64 {
        PI * x * (self.head[0] + self.density(x))
    }

    /// Energy beyond x behind the last sample.
    fn tail(&self, x: f64) -> f64 {
        2.0 * PI * self.density(x) / self.tail_rate
    }

    /// Energy between two logarithms of radii, with no sample in between.
    fn between(&self, from: f64, to: f64) -> f64 {
        // The curve does not turn between samples: its ends say how much it changes
        let change = (self.curve.eval(to) - self.curve.eval(from)).abs().max(to - from);
        let panels = 1 + (change / PANEL) as usize;
        let edge = |i: usize| from + (to - from) * (i as f64 / panels as f64);
        let panel = |i: usize| integrate(self.rule, edge(i), edge(i + 1), |x| (self.curve.eval(x) + x).exp());
        2.0 * PI * (0..panels).map(panel).sum::<f64>()
    }

    /// r R at the radius x, both in units of the length.
    fn density(&self, x: f64) -> f64 {
        let [first, last] = [self.radii[0], self.last[0]];
        if x >= last {
            return self.last[1] * (-self.tail_rate * (x - last)).exp();
        }
        if x >= first {
            return self.curve.eval(x.ln()).exp();
        }
        self.head[0] + (self.head[1] - self.head[0]) * (x / first)
    }

    /// Number of the sample at or before x, which lies between the first and the last.
    fn sample_before(&self, x: f64) -> usize {
        self.radii.partition_point(|radius| *radius <= x).saturating_sub(1).min(self.radii.len() - 2)
    }

    /// Radius in units of the length; NaN and less than 0 count as 0.
    fn unit(&self, r: f64) -> f64 {
        r.max(0.0) / self.length
    }
}

impl Profile for SampledProfile {
    fn eval_times_r(&self, r: f64) -> f64 {
        (self.density(self.unit(r)) / self.length).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let x = self.unit(r);
        if x >= self.last[0] {
            return self.total - self.tail(x);
        }
        if x <= self.radii[0] {
            return self.within_head(x);
        }
        let i = self.sample_before(x);
        self.enclosed[i] + self.between(self.radii[i].ln(), x.ln())
    }

    fn beyond(&self, r: f64) -> f64 {
        let x = self.unit(r);
        if x >= self.last[0] {
            return self.tail(x);
        }
        if x <= self.radii[0] {
            return self.total - self.within_head(x);
        }
        let i = self.sample_before(x);
        self.beyond[i + 1] + self.between(x.ln(), self.radii[i + 1].ln())
    }

    fn surface_albedo(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        let half = self.enclosed.partition_point(|&enclosed| enclosed < 0.5 * self.total);
        self.length * self.radii[half.min(self.radii.len() - 1)]
    }

    fn evaluations_to_build(&self) -> u32 {
        (POINTS * (self.enclosed.len() - 1)) as u32
    }
}

/// Least-squares rate at which the logarithms fall with x over the outer half of the range, two points at least.
fn falling_rate(points: &[(f64, f64)]) -> f64 {
    let end = points[points.len() - 1].0;
    let outer = points.partition_point(|(x, _)| *x < 0.5 * end).min(points.len() - 2);
    let points = &points[outer..];
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (mean_x, mean_y) = (mean(|point| point.0), mean(|point| point.1));
    let products =
        |f: fn(f64, f64) -> f64| -> f64 { points.iter().map(|(x, y)| f(x - mean_x, y - mean_y)).sum() };
    -products(|x, y| x * y) / products(|x, _| x * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NormalizedDiffusion, TabulatedProfile};

    fn source() -> NormalizedDiffusion {
        NormalizedDiffusion::from_d(0.8, 1.0).unwrap()
    }

    fn sampled(length: f64) -> SampledProfile {
        let radii: Vec<f64> = (0..120).map(|i| length * 0.01 * 1.065_f64.powi(i)).collect();
        let values: Vec<f64> = radii.iter().map(|r| source().eval(r / length) / length / length).collect();
        SampledProfile::new(&radii, &values).unwrap()
    }

    #[test]
    fn samples_give_back_their_profile() {
        for length in [1e-60, 1.0, 1e40] {
            let (found, expected) = (sampled(length), source());
            for i in 0..100 {
                let r = 1e-3 * 1.12_f64.powi(i);
                let value = found.eval_times_r(r * length) * length / expected.eval_times_r(r);
                // The last samples are at 17 and 18, and behind them the exponential is a guess
                assert!((value - 1.0).abs() < if r < 16.0 { 1e-4 } else { 0.1 }, "{r}: {value}");
                let enclosed = found.enclosed(r * length) / expected.enclosed(r);
                assert!((enclosed - 1.0).abs() < 1e-4, "{r}: {enclosed}");
                let sum = found.enclosed(r * length) + found.beyond(r * length);
                assert!((sum - found.surface_albedo()).abs() < 1e-13, "{r}: {sum}");
            }
        }
    }

    /// r R = e^{−r} down to 1e-87: no sample with light counts as more than it is.
    #[test]
    fn samples_far_away_stay_what_they_are() {
        let radii: Vec<f64> = (1..=800).map(|i| 0.25 * f64::from(i)).collect();
        let values: Vec<f64> = radii.iter().map(|r| (-r).exp() / r).collect();
        let profile = SampledProfile::new(&radii, &values).unwrap();
        for r in [1.0f64, 30.3, 150.2, 199.0, 230.0] {
            let expected = 2.0 * PI * (-r).exp();
            assert!((profile.beyond(r) / expected - 1.0).abs() < 1e-2, "{r}: {}", profile.beyond(r));
        }
        assert!((profile.surface_albedo() / (2.0 * PI) - 1.0).abs() < 0.02, "{}", profile.surface_albedo());
    }

    /// Where r R falls by thousands from sample to sample, energies still rise.
    #[test]
    fn energies_rise_between_samples_that_are_far_apart() {
        let (radii, values) = ([0.003, 0.02, 0.07, 2.3], [220.0, 28.0, 6.1, 7e-8]);
        let profile = SampledProfile::new(&radii, &values).unwrap();
        let (mut within, mut beyond) = (0.0, f64::MAX);
        for i in 0..=2000 {
            let r = 1e-4 * 1e5f64.powf(f64::from(i) / 2000.0);
            let next = (profile.enclosed(r), profile.beyond(r));
            assert!(next.0 >= within * (1.0 - 1e-13), "{r}: {} after {within}", next.0);
            assert!(next.1 <= beyond * (1.0 + 1e-13), "{r}: {} after {beyond}", next.1);
            (within, beyond) = next;
        }
    }

    #[test]
    fn table_of_samples_keeps_their_shares() {
        let (profile, expected) = (sampled(1.0), source());
        let table = TabulatedProfile::new(&profile);
        assert!(table.cdf_error() < 1e-4, "{}", table.cdf_error());
        for u in [0.01, 0.3, 0.6, 0.9, 0.99] {
            assert!((expected.cdf(table.quantile(u)) - u).abs() < 1e-4 * u, "{u}");
        }
    }

    #[test]
    fn zeros_are_taken_as_no_light() {
        let radii: Vec<f64> = (1..=12).map(f64::from).collect();
        let mut values: Vec<f64> = radii.iter().map(|r| (-r).exp()).collect();
        values[6] = 0.0;
        values[10] = 0.0;
        values[11] = 0.0;
        let profile = SampledProfile::new(&radii, &values).unwrap();
        for i in 0..1000 {
            let r = 0.02 * f64::from(i);
            let values = [profile.eval(r), profile.enclosed(r), profile.beyond(r)];
            assert!(values.iter().all(|v| v.is_finite() && *v >= 0.0), "{r}: {values:?}");
        }
        assert!(profile.eval(7.0) < 1e-9);
    }

    /// Noise with zeros in it, by the trapezoidal rule in ln r.
    #[test]
    fn eval_integrates_to_total() {
        let radii: Vec<f64> = (0..60).map(|i| 0.02 * 1.13f64.powi(i)).collect();
        let noise = |i: usize| f64::from((i as u32 * 7919) % 23) / 12.0;
        let values: Vec<f64> =
            radii.iter().enumerate().map(|(i, r)| noise(i) * (-r / 3.0).exp() / r).collect();
        assert!(values.iter().filter(|value| **value == 0.0).count() > 1);
        let profile = SampledProfile::new(&radii, &values).unwrap();
        let step = 1e-3;
        let ring = |i: i32| (step * f64::from(i)).exp();
        let sum: f64 =
            (-20_000..=8000).map(|i| 2.0 * PI * ring(i) * profile.eval_times_r(ring(i)) * step).sum();
        assert!((sum / profile.surface_albedo() - 1.0).abs() < 1e-5, "{sum} {}", profile.surface_albedo());
    }

    /// Radii next to the samples, where logarithms do not tell the two apart.
    #[test]
    fn energies_rise_through_the_samples() {
        let radii: Vec<f64> = (0..40).map(|i| 1e5 + 700.0 * f64::from(i)).collect();
        let values: Vec<f64> = radii.iter().map(|r| (-r / 3e3).exp()).collect();
        let profile = SampledProfile::new(&radii, &values).unwrap();
        let mut before = 0.0;
        for r in radii {
            for r in [r.next_down(), r, r.next_up()] {
                let (within, beyond) = (profile.enclosed(r), profile.beyond(r));
                assert!(within >= before * (1.0 - 1e-15), "{r}: {within} after {before}");
                assert!(
                    ((within + beyond) / profile.surface_albedo() - 1.0).abs() < 1e-14,
                    "{r}: {within} {beyond}"
                );
                before = within;
            }
        }
    }

    #[test]
    fn new_refuses_what_is_no_profile() {
        let refuse = |radii: &[f64], values: &[f64], expected: &str| {
            let found = SampledProfile::new(radii, values).unwrap_err().to_string();
            assert!(found.contains(expected), "{found}");
        };
        refuse(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0], "at least 4");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[3.0, 2.0, 1.0], "number of reflectances is 3");
        refuse(&[1.0, 2.0, 2.0, 4.0], &[4.0, 3.0, 2.0, 1.0], "radius is 2");
        refuse(&[1.0, 2.0, 2.0 + 1e-12, 4.0], &[4.0, 3.0, 2.0, 1.0], "radius is 2");
        refuse(&[0.0, 2.0, 3.0, 4.0], &[4.0, 3.0, 2.0, 1.0], "radius is 0");
        refuse(&[1.0, 2.0, 3.0, f64::INFINITY], &[4.0, 3.0, 2.0, 1.0], "radius is inf");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[4.0, -3.0, 2.0, 1.0], "reflectance is -3");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[4.0, f64::NAN, 2.0, 1.0], "reflectance is NaN");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 4.0], "has to fall");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[0.0; 4], "at least 4");
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        for length in [1e-90, 1.0, 1e90] {
            let profile = sampled(length);
            for r in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 5e-324, f64::MAX, 1e-300, 1e300]
            {
                let values =
                    [profile.eval(r), profile.eval_times_r(r), profile.enclosed(r), profile.beyond(r)];
                assert!(values.iter().all(|v| v.is_finite() && *v >= 0.0), "{length} {r}: {values:?}");
            }
        }
    }
}
