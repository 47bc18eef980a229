//! The smooth curve through samples of a profile, and its energies.

use std::f64::consts::PI;

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::MonotoneCubic;
use crate::math::quadrature::{integrate, shared_gauss_legendre};

/// Fewest points that make a profile.
const POINTS_MIN: usize = 4;
/// Least ratio of a radius to the one before it, so that their logarithms differ.
const RATIO_MIN: f64 = 1.0 + 1e-9;
/// Points of the Gauss rule on each half of a cell, on which ln(r R) is a cubic in ln r.
const POINTS: usize = 8;
/// The most that r R of a sample of 0 between others counts as, relative to the greatest.
const FLOOR: f64 = 1e-12;
/// Natural logarithm by which radius or r R change over one cell at most.
const CELL: f64 = 0.1;

/// Curve through samples (r, R): a monotone cubic of ln(r R) in ln r between them, r R a straight line before the first
/// and an exponential behind the last.
pub(super) struct SampleCurve {
    /// ln(r R) over ln r, radii in units of `length`.
    curve: MonotoneCubic,
    /// r R at r = 0, and at the first sample.
    head: [f64; 2],
    /// Rate at which r R falls behind the last sample, in 1/`length`.
    pub(super) tail_rate: f64,
    /// Ends of cells in units of `length`: the samples, and radii between those that differ much.
    pub(super) radii: Vec<f64>,
    /// Radius of the sample in the middle \[L\].
    pub(super) length: f64,
    rule: &'static [(f64, f64)],
}

impl SampleCurve {
    /// Draws the curve through at least four radii and as many reflectances.
    pub(super) fn new(radii: &[f64], reflectances: &[f64]) -> Result<Self, ParameterError> {
        let count = check_samples(radii, reflectances)?;

        // Bring lengths near 1, and take logarithms
        let length = radii[count / 2];
        let unit: Vec<f64> = radii[..count].iter().map(|r| r / length).collect();
        let samples = unit.iter().zip(reflectances);
        let densities: Vec<f64> = samples.map(|(x, value)| (x * length) * value * length).collect();
        let most = densities.iter().copied().fold(0.0, f64::max);
        require(most < f64::INFINITY, "greatest r R times a radius", most, "finite")?;
        let floor = floor_of(&densities);
        let xs: Vec<f64> = unit.iter().map(|x| libm::log(*x)).collect();
        let ys: Vec<f64> = densities.iter().map(|density| libm::log(density.max(floor))).collect();

        // Go on before the first and behind the last sample
        let (first, second) = (libm::exp(ys[0]), libm::exp(ys[1]));
        let at_zero = first - (second - first) / (unit[1] - unit[0]) * unit[0];
        let head = [at_zero.max(0.0).min(2.0 * first), first];
        let points = unit.iter().zip(&ys).zip(&densities);
        let lit: Vec<[f64; 2]> =
            points.filter(|(_, density)| **density > 0.0).map(|((x, y), _)| [*x, *y]).collect();
        require(lit.len() > 1, "number of radii with light", lit.len() as f64, "at least 2")?;
        let outer = lit.partition_point(|[x, _]| *x < 0.5 * lit[lit.len() - 1][0]).min(lit.len() - 2);
        let tail_rate = falling_rate(&lit[outer..]);
        let allowed = "greater than 0: the reflectance has to fall towards its end";
        require(tail_rate > 0.0, "rate at which r R falls in the outer half", tail_rate / length, allowed)?;

        let curve = MonotoneCubic::new(&xs, &ys);
        let radii = ends_of_cells(&unit, &xs, &ys);
        Ok(Self { curve, head, tail_rate, radii, length, rule: shared_gauss_legendre(POINTS) })
    }

    /// Densities per length 2πr R at the ends of cells.
    pub(super) fn densities(&self) -> Vec<f64> {
        self.radii.iter().map(|x| 2.0 * PI * libm::exp(self.curve.eval(libm::log(*x)))).collect()
    }

    /// Energies of each cell and its first half, beginning at 0.
    pub(super) fn energies(&self) -> Vec<[f64; 2]> {
        let (first, [zero, at_first]) = (self.radii[0], self.head);
        let within = |x: f64| PI * x * (2.0 * zero + (at_first - zero) * (x / first));
        let mut energies = vec![[within(first), within(0.5 * first)]];
        energies.extend(self.radii.windows(2).map(|ends| {
            let middle = 0.5 * (ends[0] + ends[1]);
            let half = self.between(ends[0], middle);
            [half + self.between(middle, ends[1]), half]
        }));
        energies
    }

    /// Energy between two radii of one cell.
    fn between(&self, from: f64, to: f64) -> f64 {
        2.0 * PI * integrate(self.rule, libm::log(from), libm::log(to), |x| libm::exp(self.curve.eval(x) + x))
    }
}

/// Checks samples, and tells how many there are up to the last with light.
fn check_samples(radii: &[f64], reflectances: &[f64]) -> Result<usize, ParameterError> {
    check_radii(radii)?;
    check_reflectances(radii, reflectances)?;
    let count =
        radii.len() - reflectances.iter().rev().take_while(|&&reflectance| reflectance == 0.0).count();
    require(count >= 4, "number of radii up to the last with light", count as f64, "at least 4")?;
    Ok(count)
}

pub(super) fn check_radii(radii: &[f64]) -> Result<(), ParameterError> {
    require(radii.len() >= POINTS_MIN, "number of radii", radii.len() as f64, "at least 4")?;
    let mut before = 0.0;
    for (i, r) in radii.iter().enumerate() {
        let allowed = "in [1e-150, 1e150] and greater than the one before by 1e-9 of itself; its index is";
        require_of(i, *r > before * RATIO_MIN && *r < 1e150 && *r > 1e-150, "radius", *r, allowed)?;
        before = *r;
    }
    Ok(())
}

pub(super) fn check_reflectances(radii: &[f64], reflectances: &[f64]) -> Result<(), ParameterError> {
    check_count("number of reflectances", reflectances, radii)?;
    for (i, value) in reflectances.iter().enumerate() {
        require_of(i, (0.0..1e300).contains(value), "reflectance", *value, "in [0, 1e300); its index is")?;
    }
    Ok(())
}

pub(super) fn check_count(
    parameter: &'static str,
    values: &[f64],
    radii: &[f64],
) -> Result<(), ParameterError> {
    let count = values.len();
    require_of(radii.len(), count == radii.len(), parameter, count as f64, "that of the radii,")
}

/// Demands as [`require`] does what ends in a number: the index of one of many values, or how many there must be.
pub(super) fn require_of(
    number: usize,
    holds: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<(), ParameterError> {
    let numbered = |error| ParameterError { limit: Some(number as f64), ..error };
    require(holds, parameter, value, allowed).map(drop).map_err(numbered)
}

/// Value that a sample of 0 counts as.
fn floor_of(densities: &[f64]) -> f64 {
    let greatest = densities.iter().copied().fold(0.0, f64::max);
    let with_light = densities.iter().copied().filter(|density| *density > 0.0);
    with_light.fold(FLOOR * greatest, f64::min).max(f64::MIN_POSITIVE)
}

/// The samples' radii, and between two as many more as their logarithms ask for.
fn ends_of_cells(radii: &[f64], xs: &[f64], ys: &[f64]) -> Vec<f64> {
    let mut ends = vec![radii[0]];
    for (i, pair) in xs.windows(2).enumerate() {
        let change = (ys[i + 1] - ys[i]).abs().max(pair[1] - pair[0]);
        let cells = 1 + (change / CELL) as usize;
        let step = (pair[1] - pair[0]) / cells as f64;
        ends.extend((1..cells).map(|j| libm::exp(pair[0] + step * j as f64)));
        ends.push(radii[i + 1]);
    }
    ends
}

/// Least-squares rate at which logarithms fall with the radius.
pub(super) fn falling_rate(points: &[[f64; 2]]) -> f64 {
    let mean = |i: usize| points.iter().map(|point| point[i]).sum::<f64>() / points.len() as f64;
    let [mean_r, mean_log] = [mean(0), mean(1)];
    let product =
        |i: usize| points.iter().map(|p| (p[0] - mean_r) * (p[i] - [mean_r, mean_log][i])).sum::<f64>();
    -product(1) / product(0)
}
