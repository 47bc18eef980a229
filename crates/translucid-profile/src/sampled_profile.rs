//! A profile through points that somebody measured or simulated.

use std::f64::consts::PI;

use crate::Profile;
use crate::error::{ParameterError, require};
use crate::monotone_cubic::MonotoneCubic;
use crate::quadrature::{integrate, shared_gauss_legendre};

/// Points of the Gauss rule between two samples, where ln(r R) is a cubic in ln r.
const POINTS: usize = 8;
/// r R of a sample that is 0 between others, relative to the greatest.
const FLOOR: f64 = 1e-12;

/// The reflectance profile through samples (r, R): a monotone cubic of ln(r R) in ln r between them, r R a straight line
/// before the first and an exponential behind the last.
///
/// The straight line goes through the first two samples, kept between 0 and twice the first at r = 0: R may tend to a
/// constant there or grow like 1/r.
/// The rate of the exponential in r R is the least-squares one of the samples in the outer half of the radii.
/// Noise is not smoothed; a sample of 0 between others counts as 1e-12 of the greatest r R, and samples of 0 at the end
/// are left out.
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
    /// Energy within each sample's radius.
    enclosed: Vec<f64>,
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
            let allowed = "greater than the one before, in (0, 1e100]";
            require(r > before && r <= 1e100, "radius", r, allowed)?;
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
        let logarithm = |density: &f64| density.max(FLOOR * greatest).ln();
        let (xs, ys): (Vec<f64>, Vec<f64>) =
            (unit.iter().map(|x| x.ln()).collect(), densities.iter().map(logarithm).collect());
        let (first, second) = (ys[0].exp(), ys[1].exp());
        let at_zero = first - (second - first) / (unit[1] - unit[0]) * unit[0];
        let head = [at_zero.max(0.0).min(2.0 * first), first];
        let tail_rate = falling_rate(&unit, &ys);
        let allowed = "greater than 0: the reflectance has to fall towards its end";
        require(tail_rate > 0.0, "rate at which r R falls in the outer half", tail_rate / length, allowed)?;

        let last = [unit[count - 1], ys[count - 1].exp()];
        let mut profile = Self {
            curve: MonotoneCubic::new(&xs, &ys),
            enclosed: Vec::new(),
            head,
            tail_rate,
            last,
            total: 0.0,
            rule: shared_gauss_legendre(POINTS),
            length,
        };
        let mut enclosed = profile.within_head(unit[0]);
        for i in 0..count {
            if i > 0 {
                enclosed += profile.between(xs[i - 1], xs[i]);
            }
            profile.enclosed.push(enclosed);
        }
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
        2.0 * PI * integrate(self.rule, from, to, |x| (self.curve.eval(x) + x).exp())
    }

    /// r R at the radius x, both in units of the length.
    fn density(&self, x: f64) -> f64 {
        let first = self.curve.abscissae()[0];
        let [last, density] = self.last;
        if x >= last {
            return density * (-self.tail_rate * (x - last)).exp();
        }
        let logarithm = x.max(f64::MIN_POSITIVE).ln();
        if logarithm >= first {
            return self.curve.eval(logarithm).exp();
        }
        self.head[0] + (self.head[1] - self.head[0]) * (x / first.exp())
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
        let (logarithm, samples) = (x.max(f64::MIN_POSITIVE).ln(), self.curve.abscissae());
        if logarithm <= samples[0] {
            return self.within_head(x);
        }
        let i = self.curve.interval(logarithm);
        self.enclosed[i] + self.between(samples[i], logarithm)
    }

    fn beyond(&self, r: f64) -> f64 {
        let x = self.unit(r);
        if x >= self.last[0] {
            return self.tail(x);
        }
        let (logarithm, samples) = (x.max(f64::MIN_POSITIVE).ln(), self.curve.abscissae());
        if logarithm <= samples[0] {
            return self.total - self.enclosed(r);
        }
        // From the far end inwards, so that the tail keeps its digits
        let i = self.curve.interval(logarithm);
        let whole: f64 =
            samples.windows(2).skip(i + 1).rev().map(|pair| self.between(pair[0], pair[1])).sum();
        self.tail(self.last[0]) + whole + self.between(logarithm, samples[i + 1])
    }

    fn total(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        let half = self.enclosed.partition_point(|&enclosed| enclosed < 0.5 * self.total);
        let samples = self.curve.abscissae();
        self.length * samples[half.min(samples.len() - 1)].exp()
    }

    fn evaluations_to_build(&self) -> u32 {
        (POINTS * (self.enclosed.len() - 1)) as u32
    }
}

/// Least-squares rate at which the logarithms fall with x over the outer half of the range, two points at least.
fn falling_rate(xs: &[f64], logarithms: &[f64]) -> f64 {
    let outer = xs.partition_point(|&x| x < 0.5 * xs[xs.len() - 1]).min(xs.len() - 2);
    let (xs, ys) = (&xs[outer..], &logarithms[outer..]);
    let n = xs.len() as f64;
    let (mean_x, mean_y) = (xs.iter().sum::<f64>() / n, ys.iter().sum::<f64>() / n);
    let products = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
        xs.iter().zip(ys).map(|(&x, &y)| f(x - mean_x, y - mean_y)).sum()
    };
    -products(&|x, y| x * y) / products(&|x, _| x * x)
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
                assert!((sum - found.total()).abs() < 1e-13, "{r}: {sum}");
            }
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

    #[test]
    fn new_refuses_what_is_no_profile() {
        let refuse = |radii: &[f64], values: &[f64], expected: &str| {
            let found = SampledProfile::new(radii, values).unwrap_err().to_string();
            assert!(found.contains(expected), "{found}");
        };
        refuse(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0], "at least 4");
        refuse(&[1.0, 2.0, 3.0, 4.0], &[3.0, 2.0, 1.0], "number of reflectances is 3");
        refuse(&[1.0, 2.0, 2.0, 4.0], &[4.0, 3.0, 2.0, 1.0], "radius is 2");
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
