//! A profile through what somebody measured or simulated: samples of R, energies within radii, or both.
//!
//! Between radii the cdf is a chain of the cells of `monotone_cell.rs`, of unequal widths, whose energies are those that
//! were given, or those of the curve through the samples.
//! Inside the first radius the energy is a r + b r², beyond the last it falls exponentially, as in the last rings.

use std::f64::consts::PI;

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::monotone_slopes;
use crate::profile::Profile;
use crate::table::monotone_cell::{Cell, Knot, RadialCell};
use crate::table::radial_table::Tail;
use crate::table::sample_curve::{
    SampleCurve, check_count, check_radii, check_reflectances, falling_rate, require_of,
};

/// Points that tell how the profile falls at the end: those beyond this part of the last radius, or as many.
const TAIL_PART: f64 = 0.75;
const TAIL_POINTS: usize = 3;

/// The reflectance profile through samples (r, R), through energies within radii, or through both.
///
/// Energies that are given are kept. Where there are samples alone, their curve is a monotone cubic of ln(r R) in ln r
/// between them, r R a straight line before the first and an exponential behind the last.
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
/// assert!((sampled.surface_albedo() - 0.8).abs() < 1e-5);
/// assert!((sampled.eval(1.234) / source.eval(1.234) - 1.0).abs() < 1e-5);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct SampledProfile {
    /// Cells between the radii, in units of `length`.
    cells: Vec<Cell>,
    tail: Tail,
    surface_albedo: f64,
    length: f64,
}

/// Energies, not yet normalized: of each interval and its first half, beginning at 0, and of all beyond the last
/// radius.
struct Energies {
    intervals: Vec<[f64; 2]>,
    tail: f64,
}

impl SampledProfile {
    /// Makes the profile of at least four radii r > 0 \[L\], rising, and as many reflectances R ≥ 0 \[L⁻²\].
    ///
    /// # Errors
    /// A radius or reflectance is out of its range, there are too few, or R does not fall towards its end.
    pub fn new(radii: &[f64], reflectances: &[f64]) -> Result<Self, ParameterError> {
        let curve = SampleCurve::new(radii, reflectances)?;
        let (densities, intervals) = (curve.densities(), curve.energies());
        let tail = densities[densities.len() - 1] / curve.tail_rate;
        let chain = Self::chain(&curve.radii, &densities, &Energies { intervals, tail }, curve.tail_rate)?;
        Ok(Self { length: curve.length, ..chain })
    }

    /// Makes the profile of which the energies within radii are known, E(rᵢ) = ∫₀^rᵢ R 2πr dr: what a tally of rings
    /// measures.
    ///
    /// # Errors
    /// There are fewer than four radii, or not as many energies; a radius is not in \[1e-150, 1e150\] or not
    /// greater than the one before by 1e-9 of itself; an energy is less than the one before or not finite; the last ring
    /// does not have less than the one before, per length. The error names the value and, as its limit, the index.
    pub fn from_enclosed(radii: &[f64], enclosed: &[f64]) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        check_enclosed(radii, enclosed)?;
        // How it goes on beyond the last radius: densities of the last rings are those of their middles
        let n = radii.len();
        let width = radii[n - 1] - radii[n - 2];
        let chord = |i: usize| (enclosed[i] - enclosed[i - 1]) / (radii[i] - radii[i - 1]);
        let (before, last) = (chord(n - 2), chord(n - 1));
        let rate = 2.0 * libm::log(before / last) / (radii[n - 1] - radii[n - 3]);
        require(
            rate > 0.0 || last == 0.0,
            "energy per length of the last ring",
            last,
            "less than of that before it",
        )?;
        let rate = if rate.is_finite() && rate > 0.0 { rate } else { 1.0 / radii[n - 1] };
        let tail = last * libm::exp(-0.5 * rate * width) / rate;
        let densities = densities_of_energies(radii, enclosed, tail, rate);
        Self::with_enclosed(radii, &densities, enclosed, tail, rate)
    }

    /// Makes the profile of which both samples and energies within radii are known.
    ///
    /// # Errors
    /// As of [`new`](Self::new) and [`from_enclosed`](Self::from_enclosed).
    pub fn from_samples_and_enclosed(
        radii: &[f64],
        reflectances: &[f64],
        enclosed: &[f64],
    ) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        check_reflectances(radii, reflectances)?;
        check_enclosed(radii, enclosed)?;
        let densities = densities(radii, reflectances);
        let rate = rate_of_last(radii, &densities)?;
        let tail = densities[densities.len() - 1] / rate;
        Self::with_enclosed(radii, &densities, enclosed, tail, rate)
    }

    fn with_enclosed(
        radii: &[f64],
        densities: &[f64],
        enclosed: &[f64],
        tail: f64,
        rate: f64,
    ) -> Result<Self, ParameterError> {
        // Inside the first radius E = a r + b r² has its energy and density
        let (within, density) = (enclosed[0], densities[0] * radii[0]);
        let linear = (2.0 * within - density).max(0.0).min(within);
        let mut intervals = vec![[within, 0.5 * linear + 0.25 * (within - linear)]];
        // Halves by the cell that has the densities of both ends and weight 1
        intervals.extend((1..radii.len()).map(|i| {
            let (energy, width) = (enclosed[i] - enclosed[i - 1], radii[i] - radii[i - 1]);
            let [before, after] = [densities[i - 1], densities[i]].map(|density| density * width);
            [energy, energy * (before + energy) / (2.0 * energy + before + after).max(f64::MIN_POSITIVE)]
        }));
        Self::chain(radii, densities, &Energies { intervals, tail }, rate)
    }

    /// Chains cells for the energies, with densities at their ends, in the unit of the radii.
    fn chain(
        radii: &[f64],
        densities: &[f64],
        energies: &Energies,
        rate: f64,
    ) -> Result<Self, ParameterError> {
        let total = energies.intervals.iter().map(|[energy, _]| energy).sum::<f64>() + energies.tail;
        require(
            total > 0.0 && total.is_finite(),
            "energy of all samples",
            total,
            "finite and greater than 0",
        )?;

        // Sum up from both sides, so that either keeps its digits
        let share = |energy: f64| energy / total;
        let mut beyond = vec![share(energies.tail)];
        for [energy, _] in energies.intervals.iter().rev() {
            beyond.push(beyond[beyond.len() - 1] + share(*energy));
        }
        beyond.reverse();
        let mut within = 0.0;
        let mut cells = Vec::with_capacity(radii.len());
        for (i, [energy, half]) in energies.intervals.iter().enumerate() {
            let (start, start_density) = if i == 0 {
                // E = a r + b r² over the interval: the density at 0 from both of its energies
                (0.0, (4.0 * half - energy) / radii[0])
            } else {
                (radii[i - 1], densities[i - 1])
            };
            let knot = |x: f64, inside: f64, density: f64| Knot {
                x,
                within: within + share(inside),
                beyond: beyond[i] - share(inside),
                density: share(density.max(0.0)),
            };
            let ends = [knot(start, 0.0, start_density), knot(radii[i], *energy, densities[i])];
            let middle = knot(0.5 * (start + radii[i]), *half, 0.0);
            let cell = Cell::new(&ends[0], &middle, &ends[1]);
            cells.push(Cell { within, beyond: beyond[i + 1], share: share(*energy), ..cell });
            within += share(*energy);
        }
        let tail = Tail { start: radii[radii.len() - 1], share: share(energies.tail), rate };
        Ok(Self { cells, tail, surface_albedo: total, length: 1.0 })
    }

    fn cell_at(&self, x: f64) -> &Cell {
        &self.cells[self.cells.partition_point(|cell| cell.start <= x).saturating_sub(1)]
    }

    /// Radius in units of the length; NaN and less than 0 count as 0.
    fn unit(&self, r: f64) -> f64 {
        r.max(0.0) / self.length
    }
}

impl Profile for SampledProfile {
    fn eval_times_r(&self, r: f64) -> f64 {
        let x = self.unit(r);
        let density = if x < self.tail.start {
            self.cell_at(x).density(x)
        } else {
            self.tail.rate * self.tail.beyond(x)
        };
        (self.surface_albedo * density / (2.0 * PI) / self.length).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let x = self.unit(r);
        let share = if x < self.tail.start { self.cell_at(x).within(x) } else { 1.0 - self.tail.beyond(x) };
        self.surface_albedo * share
    }

    fn beyond(&self, r: f64) -> f64 {
        let x = self.unit(r);
        let share = if x < self.tail.start { self.cell_at(x).beyond(x) } else { self.tail.beyond(x) };
        self.surface_albedo * share
    }

    fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// First radius within which half of the energy leaves \[L\].
    fn scale(&self) -> f64 {
        let half = self.cells.iter().find(|cell| cell.beyond < 0.5);
        self.length * half.map_or(self.tail.start, |cell| cell.start + 1.0 / cell.inverse_width)
    }
}

/// Densities per length 2πr R.
fn densities(radii: &[f64], reflectances: &[f64]) -> Vec<f64> {
    radii.iter().zip(reflectances).map(|(r, value)| 2.0 * PI * r * value).collect()
}

/// Densities per length from the energies within radii and beyond the last: as the slopes of ln E in ln r up to
/// the median, of the logarithm of what is beyond in r from there on.
fn densities_of_energies(radii: &[f64], enclosed: &[f64], tail: f64, rate: f64) -> Vec<f64> {
    let last = radii.len() - 1;
    let first = enclosed.iter().position(|energy| *energy > 0.0).unwrap_or(last);
    let logs = |values: &[f64]| values.iter().map(|value| libm::log(*value)).collect::<Vec<f64>>();
    let powers = monotone_slopes(&logs(&radii[first..]), &logs(&enclosed[first..]));
    let beyond: Vec<f64> =
        enclosed.iter().map(|energy| (enclosed[last] - energy + tail).max(f64::MIN_POSITIVE)).collect();
    let rates = monotone_slopes(radii, &logs(&beyond));
    let density = |i: usize| match i {
        _ if i < first => 0.0,
        _ if i == last => tail * rate,
        _ if enclosed[i] < beyond[i] => powers[i - first] * enclosed[i] / radii[i],
        _ => -rates[i] * beyond[i],
    };
    (0..=last).map(density).collect()
}

/// Rate of the exponential through the last densities that are not 0.
fn rate_of_last(radii: &[f64], densities: &[f64]) -> Result<f64, ParameterError> {
    let points: Vec<[f64; 2]> = radii
        .iter()
        .zip(densities)
        .filter(|(_, density)| **density > 0.0)
        .map(|(r, density)| [*r, libm::log(*density)])
        .collect();
    let allowed = "greater than 0 at two radii and more";
    require(points.len() > 1, "number of reflectances", points.len() as f64, allowed)?;
    let last = points[points.len() - 1][0];
    let beyond = points.iter().filter(|[r, _]| *r >= TAIL_PART * last).count();
    let points = &points[points.len() - beyond.max(TAIL_POINTS).min(points.len())..];
    let rate = falling_rate(points);
    require(
        rate > 0.0 && rate.is_finite(),
        "rate at which r R falls over the last radii",
        rate,
        "greater than 0",
    )
}

fn check_enclosed(radii: &[f64], enclosed: &[f64]) -> Result<(), ParameterError> {
    check_count("number of enclosed energies", enclosed, radii)?;
    let mut before = 0.0;
    for (i, value) in enclosed.iter().enumerate() {
        let allowed = "finite and no less than the one before; its index is";
        require_of(i, *value >= before && *value < 1e300, "enclosed", *value, allowed)?;
        before = *value;
    }
    Ok(())
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
        refuse(&[1e99, 2e99, 3e99, 4e99], &[1e200, 1e100, 1e99, 1e98], "greatest r R times a radius is inf");
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
