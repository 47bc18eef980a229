//! Profiles of half spaces with a boundary and a phase function, as energies in rings.
//!
//! Exact for isotropic scattering, else of walks. They take minutes, so they can be kept as a file of numbers.

#![allow(dead_code, reason = "each of the examples uses a part")]

use std::fmt::Write as _;

use translucid_profile::{Configuration, half_space_single_scattering_albedo};
use translucid_reference::exact::{self, HalfSpace};
use translucid_reference::walk::{
    Control, Layout, OrderBins, Parameters, PhaseFunction, Problem, Region, Side, WhiteTable,
};

/// Surface albedos of a table.
pub(crate) const SURFACE_ALBEDOS: [f64; 13] =
    [0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98];
/// Mean cosines of the grid.
pub(crate) const G: [f64; 5] = [-0.5, 0.0, 0.5, 0.8, 0.9];
/// Relative indices of the grid.
pub(crate) const ETA: [f64; 4] = [1.0, 1.3, 1.4, 1.5];
/// Mean cosines and relative indices that no coefficient is fitted to.
pub(crate) const HELD_OUT: [[f64; 2]; 3] = [[0.3, 1.2], [0.7, 1.45], [0.85, 1.0]];
/// Collisions of each walk.
pub(crate) const COLLISIONS: f64 = 5e8;
/// Both configurations.
pub(crate) const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
/// Greatest surface albedos that a walk serves: below each, one walk has the photons that its budget allows.
const LEVELS: [f64; 7] = [0.05, 0.2, 0.5, 0.7, 0.8, 0.9, 0.98];
/// Share of what a level keeps, 1 − A, its walk may keep: room for the noise of the walk above, which finds its albedo.
const MARGIN: f64 = 0.85;
/// Seed of every walk; the second half of its photons has the next one.
const SEED: u64 = 1;
/// Radii of the rings are 2^(i/2) mean free paths.
const HALF_OCTAVES: std::ops::RangeInclusive<i32> = -12..=22;

/// A phase function, a boundary and a configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Case {
    /// Mean cosine of the phase function, Henyey and Greenstein's.
    pub(crate) g: f64,
    /// Relative index.
    pub(crate) eta: f64,
    /// Way in which light enters.
    pub(crate) configuration: Configuration,
}

/// A half space of one surface albedo.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Surface albedo.
    pub(crate) surface_albedo: f64,
    /// Single-scattering albedo, with its standard error.
    pub(crate) single_scattering_albedo: [f64; 2],
    /// Shares of the energy in the rings between [`radii`] and beyond the last.
    pub(crate) shares: Vec<f64>,
    /// Shares of two independent halves of the photons; equal to the shares where they are exact.
    pub(crate) halves: [Vec<f64>; 2],
}

/// All half spaces of a case.
pub(crate) struct Table {
    /// Common part of both.
    pub(crate) case: Case,
    /// By surface albedo, which rises.
    pub(crate) points: Vec<Point>,
}

/// The tables in the file that the command's first argument names, or else made anew.
pub(crate) fn tables() -> Vec<Table> {
    match std::env::args().nth(1).filter(|argument| !argument.starts_with("--")) {
        Some(path) => {
            let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"));
            let mut tables = read(&text);
            let cases = cases();
            tables.sort_by_key(|table| cases.iter().position(|case| *case == table.case));
            tables
        }
        None => cases().into_iter().map(Table::new).collect(),
    }
}

/// The grid and what is held out, in both configurations.
pub(crate) fn cases() -> Vec<Case> {
    let grid = G.iter().flat_map(|g| ETA.map(|eta| [*g, eta])).chain(HELD_OUT);
    let all = grid.map(|[g, eta]| CONFIGURATIONS.map(|configuration| Case { g, eta, configuration }));
    all.flatten().collect()
}

impl Table {
    /// Solves or walks.
    pub(crate) fn new(case: Case) -> Self {
        Self { case, points: case.points(COLLISIONS) }
    }

    /// One line a point: configuration, g, η, A, α, its error, shares, shares of the halves.
    pub(crate) fn write(&self) -> String {
        let Case { g, eta, configuration } = self.case;
        let mut text = String::new();
        for point in &self.points {
            let [alpha, error] = point.single_scattering_albedo;
            let number = u8::from(configuration == Configuration::Diffuse);
            let _ = write!(text, "{number},{g},{eta},{},{alpha:e},{error:e}", point.surface_albedo);
            let shares = [&point.shares, &point.halves[0], &point.halves[1]];
            shares.into_iter().flatten().for_each(|share| {
                let _ = write!(text, ",{share:e}");
            });
            text.push('\n');
        }
        text
    }
}

/// Tables from the lines that [`Table::write`] wrote.
fn read(text: &str) -> Vec<Table> {
    let mut tables: Vec<Table> = Vec::new();
    for line in text.lines() {
        let numbers: Vec<f64> = line.split(',').map(|number| number.parse().expect("a number")).collect();
        let (head, shares) = numbers.split_at(6);
        let rings = radii().len() + 1;
        assert_eq!(shares.len(), 3 * rings, "shares of a line");
        let configuration = CONFIGURATIONS[head[0] as usize];
        let case = Case { g: head[1], eta: head[2], configuration };
        let [whole, first, second] = std::array::from_fn(|i| shares[i * rings..(i + 1) * rings].to_vec());
        let point = Point {
            surface_albedo: head[3],
            single_scattering_albedo: [head[4], head[5]],
            shares: whole,
            halves: [first, second],
        };
        match tables.iter_mut().find(|table| table.case == case) {
            Some(table) => table.points.push(point),
            None => tables.push(Table { case, points: vec![point] }),
        }
    }
    tables
}

impl Point {
    /// Reduced albedo α'.
    pub(crate) fn alpha_prime(&self, g: f64) -> f64 {
        let alpha = self.single_scattering_albedo[0];
        (1.0 - g) * alpha / (1.0 - g * alpha)
    }

    /// Transport mean free path in mean free paths, ℓ*/ℓ = 1/(1 − αg).
    pub(crate) fn transport_mfp(&self, g: f64) -> f64 {
        1.0 / (1.0 - g * self.single_scattering_albedo[0])
    }

    /// L1 distance of a profile, given by its share within a radius in mean free paths.
    pub(crate) fn l1_error(&self, within: impl Fn(f64) -> f64) -> f64 {
        distance(&differences(radii().into_iter().map(within)), &self.shares)
    }

    /// The part of the L1 distance from rings whose inner radius is in a range, and their share of the energy.
    pub(crate) fn l1_error_between(
        &self,
        range: std::ops::Range<f64>,
        within: impl Fn(f64) -> f64,
    ) -> [f64; 2] {
        let found = differences(radii().into_iter().map(within));
        let inner = std::iter::once(0.0).chain(radii());
        let rings = inner.zip(found.iter().zip(&self.shares)).filter(|(r, _)| range.contains(r));
        rings.fold([0.0; 2], |sum, (_, (found, share))| [sum[0] + (found - share).abs(), sum[1] + share])
    }

    /// L1 distance that noise alone makes: half that of the two halves, whose difference has twice the error of
    /// their mean.
    pub(crate) fn noise(&self) -> f64 {
        0.5 * distance(&self.halves[0], &self.halves[1])
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}

/// Radii of the rings in mean free paths ℓ.
pub(crate) fn radii() -> Vec<f64> {
    HALF_OCTAVES.map(|i| (0.5 * f64::from(i)).exp2()).collect()
}

impl Case {
    /// True if there is an exact solution.
    pub(crate) fn is_exact(self) -> bool {
        self.g == 0.0
    }

    /// A point for each surface albedo, exact where that is possible, else of walks with some number of collisions each.
    pub(crate) fn points(self, collisions: f64) -> Vec<Point> {
        if self.is_exact() {
            SURFACE_ALBEDOS.iter().map(|a| self.exact(*a)).collect()
        } else {
            self.walked(collisions)
        }
    }

    /// The point of a surface albedo, solved.
    pub(crate) fn exact(self, surface_albedo: f64) -> Point {
        let incidence = self.configuration.into();
        let alpha = exact::single_scattering_albedo(surface_albedo, self.eta, incidence)
            .expect("an albedo in (0, 1)");
        let half_space = HalfSpace::with_boundary(alpha, self.eta, incidence).expect("an albedo in (0, 1)");
        let total = half_space.total().value;
        let enclosed = radii().into_iter().map(|r| half_space.enclosed(r).value / total);
        let shares = differences(enclosed);
        let halves = [shares.clone(), shares.clone()];
        Point { surface_albedo, single_scattering_albedo: [alpha, 0.0], shares, halves }
    }

    fn walked(self, collisions: f64) -> Vec<Point> {
        let reached = |level: f64| 1.0 - MARGIN * (1.0 - level);
        let highest = LEVELS[LEVELS.len() - 1];
        let mut alpha = self.similar_albedo(reached(highest)).min(WhiteTable::HIGHEST_REFERENCE_ALBEDO);
        let mut points = Vec::new();
        for (i, level) in LEVELS.into_iter().enumerate().rev() {
            let halves = self.walk(alpha, level, collisions);
            let below = if i > 0 { LEVELS[i - 1] } else { 0.0 };
            let served = SURFACE_ALBEDOS.iter().rev().filter(|a| **a > below && **a <= level);
            points.extend(served.map(|a| point(*a, &halves)));
            if i > 0 {
                let next = halves[0].single_scattering_albedo(reached(below));
                alpha = next.expect("a walk reaches less than its level").value;
            }
        }
        points.reverse();
        points
    }

    /// The point of a surface albedo by a walk of its own.
    pub(crate) fn walked_alone(self, surface_albedo: f64, collisions: f64) -> Point {
        // More than similarity says: little light returns at once where scattering is forward
        let alpha = self.similar_albedo(1.0 - 0.7 * (1.0 - surface_albedo));
        point(surface_albedo, &self.walk(alpha, surface_albedo, collisions))
    }

    /// Two halves of a walk.
    fn walk(self, reference_albedo: f64, surface_albedo: f64, collisions: f64) -> [WhiteTable; 2] {
        let Self { g, eta, configuration } = self;
        let parameters = Parameters {
            phase_function: PhaseFunction::HenyeyGreenstein { g },
            eta,
            incidence: configuration.into(),
            ..Parameters::default()
        };
        let problem = Problem::new(parameters).expect("valid parameters");
        // What is not sent back is absorbed, once in 1/(1 − α) collisions
        let each = (1.0 - surface_albedo) / (1.0 - reference_albedo);
        let photons = (0.5 * collisions / each) as u64;
        [SEED, SEED + 1].map(|seed| {
            let orders = OrderBins::new(1.0 / 64.0).expect("a growth in range");
            let layout = Layout::with_order_bins(&radii(), 1, orders).expect("radii that rise");
            let mut table =
                WhiteTable::new(problem.clone(), layout, reference_albedo).expect("an albedo in range");
            table.run(seed, photons, &Control::default()).expect("few photons");
            table
        })
    }

    /// Single-scattering albedo by similarity alone, with the boundary as a mirror of diffuse light.
    fn similar_albedo(self, surface_albedo: f64) -> f64 {
        let mirror = 2.0 * translucid_profile::fresnel_moment_1_from_inside(self.eta);
        let matched = surface_albedo / (1.0 - mirror * (1.0 - surface_albedo));
        let reduced = half_space_single_scattering_albedo(matched, self.configuration);
        reduced / (1.0 - self.g + self.g * reduced)
    }
}

/// The point that two halves of a walk make together.
fn point(surface_albedo: f64, halves: &[WhiteTable; 2]) -> Point {
    let mut whole = halves[0].clone();
    whole.merge(&halves[1]).expect("halves of the same walk");
    let alpha = whole.single_scattering_albedo(surface_albedo).expect("the walk reaches it");
    let shares = |table: &WhiteTable| {
        let at = table.at_albedo(alpha.value).expect("the walk reaches it");
        let total = at.total(Side::Reflected).value;
        let rings = 0..=radii().len();
        rings.map(|ring| at.energy(Side::Reflected, Region::Ring(ring)).value / total).collect::<Vec<_>>()
    };
    Point {
        surface_albedo,
        single_scattering_albedo: [alpha.value, alpha.error],
        shares: shares(&whole),
        halves: [shares(&halves[0]), shares(&halves[1])],
    }
}

/// Shares of the rings from the shares within their radii.
pub(crate) fn differences(within: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut last = 0.0;
    let mut next = |share: f64| share - std::mem::replace(&mut last, share);
    within.chain([1.0]).map(&mut next).collect()
}
