//! A profile through energies: what a tally of rings around the point of entry says.
//!
//! Between radii the cdf is a chain of the cells of `monotone_cell.rs`, of unequal widths, whose energies are
//! those that were given. Densities at the radii are given too, or slopes of energies.
//! Inside the first radius the energy is a r + b r², beyond the last it falls exponentially, as in the last rings.

use std::f64::consts::PI;

use crate::error::{ParameterError, require};
use crate::math::monotone_cubic::monotone_slopes;
use crate::profile::Profile;
use crate::table::monotone_cell::{Cell, Knot, RadialCell};
use crate::table::radial_table::Tail;

/// Fewest points that make a profile.
const POINTS_MIN: usize = 4;
/// Points that tell how the profile falls at the end: those beyond this part of the last radius, or as many.
const TAIL_PART: f64 = 0.75;
const TAIL_POINTS: usize = 3;

/// Cells between the radii that were given.
#[derive(Clone, Debug)]
pub(crate) struct EnergyProfile {
    cells: Vec<Cell>,
    tail: Tail,
    total: f64,
}

/// Energies, not yet normalized: of each interval and its first half, beginning at 0, and of all beyond the last
/// radius.
struct Energies {
    intervals: Vec<[f64; 2]>,
    tail: f64,
}

impl EnergyProfile {
    /// The profile whose energies within radii are given.
    pub(crate) fn from_enclosed(radii: &[f64], enclosed: &[f64]) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        check_enclosed(radii, enclosed)?;
        // How it goes on beyond the last radius: densities of the last rings are those of their middles
        let n = radii.len();
        let width = radii[n - 1] - radii[n - 2];
        let chord = |i: usize| (enclosed[i] - enclosed[i - 1]) / (radii[i] - radii[i - 1]);
        let (before, last) = (chord(n - 2), chord(n - 1));
        let rate = 2.0 * (before / last).ln() / (radii[n - 1] - radii[n - 3]);
        require(
            rate > 0.0 || last == 0.0,
            "energy per length of the last ring",
            last,
            "less than of that before it",
        )?;
        let rate = if rate.is_finite() && rate > 0.0 { rate } else { 1.0 / radii[n - 1] };
        let tail = last * (-0.5 * rate * width).exp() / rate;
        let densities = densities_of_energies(radii, enclosed, tail, rate);
        Self::with_enclosed(radii, &densities, enclosed, tail, rate)
    }

    /// The profile through samples of R whose energies within radii are given.
    pub(crate) fn from_samples_and_enclosed(
        radii: &[f64],
        reflectances: &[f64],
        enclosed: &[f64],
    ) -> Result<Self, ParameterError> {
        check_radii(radii)?;
        check_reflectances(radii, reflectances)?;
        check_enclosed(radii, enclosed)?;
        let densities = densities(radii, reflectances);
        let rate = falling_rate(radii, &densities)?;
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
        Self::new(radii, densities, &Energies { intervals, tail }, rate)
    }

    fn new(radii: &[f64], densities: &[f64], energies: &Energies, rate: f64) -> Result<Self, ParameterError> {
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
        Ok(Self { cells, tail, total })
    }

    fn cell_at(&self, r: f64) -> &Cell {
        &self.cells[self.cells.partition_point(|cell| cell.start <= r).saturating_sub(1)]
    }
}

impl Profile for EnergyProfile {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        let density = if r < self.tail.start {
            self.cell_at(r).density(r)
        } else {
            self.tail.rate * self.tail.beyond(r)
        };
        self.total * density / (2.0 * PI)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        self.total * if r < self.tail.start { self.cell_at(r).within(r) } else { 1.0 - self.tail.beyond(r) }
    }

    fn beyond(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        self.total * if r < self.tail.start { self.cell_at(r).beyond(r) } else { self.tail.beyond(r) }
    }

    fn surface_albedo(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        // The first radius within which half of the energy leaves
        self.cells
            .iter()
            .find(|cell| cell.beyond < 0.5)
            .map_or(self.tail.start, |cell| cell.start + 1.0 / cell.inverse_width)
    }

    fn evaluations_to_build(&self) -> u32 {
        0
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
    let logs = |values: &[f64]| values.iter().map(|value| value.ln()).collect::<Vec<f64>>();
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
fn falling_rate(radii: &[f64], densities: &[f64]) -> Result<f64, ParameterError> {
    let points: Vec<[f64; 2]> = radii
        .iter()
        .zip(densities)
        .filter(|(_, density)| **density > 0.0)
        .map(|(r, density)| [*r, density.ln()])
        .collect();
    let allowed = "greater than 0 at two radii and more";
    require(points.len() > 1, "number of reflectances", points.len() as f64, allowed)?;
    let last = points[points.len() - 1][0];
    let beyond = points.iter().filter(|[r, _]| *r >= TAIL_PART * last).count();
    let points = &points[points.len() - beyond.max(TAIL_POINTS).min(points.len())..];
    // Least squares
    let count = points.len() as f64;
    let [mean_r, mean_log] = [0, 1].map(|i| points.iter().map(|point| point[i]).sum::<f64>() / count);
    let product =
        |i: usize| points.iter().map(|p| (p[0] - mean_r) * (p[i] - [mean_r, mean_log][i])).sum::<f64>();
    let rate = -product(1) / product(0);
    require(
        rate > 0.0 && rate.is_finite(),
        "rate at which r R falls over the last radii",
        rate,
        "greater than 0",
    )
}

fn check_radii(radii: &[f64]) -> Result<(), ParameterError> {
    require(radii.len() >= POINTS_MIN, "number of radii", radii.len() as f64, "at least 4")?;
    let mut before = 0.0;
    for (i, r) in radii.iter().enumerate() {
        let is_good = *r > before && *r < 1e150 && *r > 1e-150;
        at_index(
            is_good,
            "radius",
            *r,
            "in [1e-150, 1e150] and greater than the one before; its index is",
            i,
        )?;
        before = *r;
    }
    Ok(())
}

fn check_reflectances(radii: &[f64], reflectances: &[f64]) -> Result<(), ParameterError> {
    check_count("number of reflectances", reflectances, radii)?;
    for (i, value) in reflectances.iter().enumerate() {
        at_index((0.0..1e300).contains(value), "reflectance", *value, "in [0, 1e300); its index is", i)?;
    }
    Ok(())
}

fn check_enclosed(radii: &[f64], enclosed: &[f64]) -> Result<(), ParameterError> {
    check_count("number of enclosed energies", enclosed, radii)?;
    let mut before = 0.0;
    for (i, value) in enclosed.iter().enumerate() {
        let is_good = *value >= before && *value < 1e300;
        at_index(is_good, "enclosed", *value, "finite and no less than the one before; its index is", i)?;
        before = *value;
    }
    Ok(())
}

fn check_count(parameter: &'static str, values: &[f64], radii: &[f64]) -> Result<(), ParameterError> {
    let (value, allowed) = (values.len() as f64, "that of the radii,");
    if values.len() == radii.len() {
        return Ok(());
    }
    Err(ParameterError { parameter, value, allowed, limit: Some(radii.len() as f64) })
}

/// The error of one of many values says which.
fn at_index(
    holds: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
    index: usize,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(ParameterError { parameter, value, allowed, limit: Some(index as f64) }) }
}
