//! Four exponentials whose weights and rates are polynomials of A, fitted at all A together.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use translucid_fit::{LevenbergMarquardt, Residuals, least_squares};
use translucid_profile::Profile;

/// Exponentials.
pub(crate) const TERMS: usize = 4;
/// Coefficients of a weight's polynomial.
pub(crate) const OF_WEIGHT: usize = 5;
/// Coefficients of a rate's polynomial.
pub(crate) const OF_RATE: usize = 4;
/// The weight of the last term is what the others leave of 1.
const FREE_WEIGHTS: usize = TERMS - 1;
const PARAMETERS: usize = FREE_WEIGHTS * OF_WEIGHT + TERMS * OF_RATE;
/// Least rate, which stands in where a polynomial falls below it on the way to the optimum.
const LEAST_RATE: f64 = 1e-3;
/// Number of times that the weights of the least squares are made anew.
const STAGES: u32 = 25;

/// c₀ + c₁x + c₂x² + …
pub(crate) fn polynomial(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The polynomial of a degree that minimizes Σ (weight (polynomial(x) − y))².
pub(crate) fn polynomial_through(x: &[f64], y: &[f64], weights: &[f64], degree: usize) -> Vec<f64> {
    let matrix = DMatrix::from_fn(x.len(), degree + 1, |i, j| weights[i] * x[i].powi(j as i32));
    let right = DVector::from_fn(x.len(), |i, _| weights[i] * y[i]);
    let solution = matrix.svd(true, true).solve(&right, 1e-14).expect("both bases were asked for");
    solution.as_slice().to_vec()
}

/// Polynomials of the weights of all terms but the last, and of the rates in 1/ℓ of all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) weights: [[f64; OF_WEIGHT]; FREE_WEIGHTS],
    pub(crate) rates: [[f64; OF_RATE]; TERMS],
}

impl Shape {
    /// Polynomials through weights and rates that are known at some surface albedos.
    pub(crate) fn through(albedos: &[f64], terms: &[[[f64; TERMS]; 2]]) -> Self {
        let ones = vec![1.0; albedos.len()];
        let fit = |which: usize, k: usize, degree: usize| {
            let values: Vec<f64> = terms.iter().map(|terms| terms[which][k]).collect();
            polynomial_through(albedos, &values, &ones, degree)
        };
        let array = |k| fit(0, k, OF_WEIGHT - 1).try_into().expect("the degree says how many");
        let weights = std::array::from_fn(array);
        let array = |k| fit(1, k, OF_RATE - 1).try_into().expect("the degree says how many");
        Self { weights, rates: std::array::from_fn(array) }
    }

    /// Weights and rates at a surface albedo.
    pub(crate) fn terms(&self, surface_albedo: f64) -> [[f64; TERMS]; 2] {
        let mut weights = [1.0; TERMS];
        for (k, coefficients) in self.weights.iter().enumerate() {
            weights[k] = polynomial(coefficients, surface_albedo);
            weights[FREE_WEIGHTS] -= weights[k];
        }
        [weights, self.rates.map(|coefficients| polynomial(&coefficients, surface_albedo))]
    }

    /// Every coefficient as a multiple of a unit.
    pub(crate) fn rounded(&self, unit: f64) -> Self {
        let round = |c: f64| (c / unit).round() * unit;
        Self { weights: self.weights.map(|row| row.map(round)), rates: self.rates.map(|row| row.map(round)) }
    }

    /// Panics unless every weight is positive and rates are positive and rise, at 10,001 surface albedos in [0, 1].
    pub(crate) fn assert_valid(&self) {
        for i in 0..=10_000 {
            let [weights, rates] = self.terms(f64::from(i) / 1e4);
            assert!(weights.iter().all(|weight| *weight > 0.0), "weights {weights:?} at {i}");
            assert!(rates[0] > 0.0 && rates.is_sorted(), "rates {rates:?} at {i}");
        }
    }

    fn from_parameters(parameters: &[f64]) -> Self {
        let (weights, rates) = parameters.split_at(FREE_WEIGHTS * OF_WEIGHT);
        let row = |i: usize| std::array::from_fn(|j| weights[i * OF_WEIGHT + j]);
        let rate_row = |i: usize| std::array::from_fn(|j| rates[i * OF_RATE + j]);
        Self { weights: std::array::from_fn(row), rates: std::array::from_fn(rate_row) }
    }

    fn parameters(&self) -> Vec<f64> {
        self.weights.as_flattened().iter().chain(self.rates.as_flattened()).copied().collect()
    }
}

/// Exact profiles at some surface albedos and radii.
pub(crate) struct Grid {
    points: Vec<Point>,
}

/// Energy per ln r, 2πr²R/A, at one surface albedo and one radius in mean free paths.
#[derive(Clone, Copy)]
struct Point {
    surface_albedo: f64,
    r: f64,
    ring: f64,
}

impl Grid {
    /// Radii from 2⁻¹¹ to 2¹⁰ mean free paths, this many per factor of 2.
    const PER_OCTAVE: i32 = 5;
    const OCTAVES: std::ops::RangeInclusive<i32> = -11..=10;

    pub(crate) fn new<P: Profile>(albedos: &[f64], profile: impl Fn(f64) -> P) -> Self {
        let steps = Self::OCTAVES.start() * Self::PER_OCTAVE..=Self::OCTAVES.end() * Self::PER_OCTAVE;
        let radius = |step: i32| (f64::from(step) / f64::from(Self::PER_OCTAVE)).exp2();
        let points = albedos.iter().flat_map(|surface_albedo| {
            let profile = profile(*surface_albedo);
            steps.clone().map(radius).map(move |r| Point {
                surface_albedo: *surface_albedo,
                r,
                ring: 2.0 * PI * r * profile.eval_times_r(r) / surface_albedo,
            })
        });
        Self { points: points.collect() }
    }

    /// The optimum near a start.
    pub(crate) fn minimize_l1(&self, start: Shape) -> Shape {
        let search = LevenbergMarquardt::new().with_patience(1);
        let mut problem = Problem { grid: self, roots: Vec::new() };
        let mut parameters = start.parameters();
        for step in 0..STAGES {
            // From a few percent of the energy in an e-fold of radii to what no longer matters
            problem.reweight(&parameters, 0.03 * 0.01f64.powf(f64::from(step) / f64::from(STAGES - 1)));
            parameters = least_squares(search, &parameters, &problem);
        }
        Shape::from_parameters(&parameters)
    }
}

/// The differences at all points, each times the root of its weight.
struct Problem<'a> {
    grid: &'a Grid,
    roots: Vec<f64>,
}

impl Problem<'_> {
    /// Makes the weights 1/√(x² + ε²) of the present differences x.
    fn reweight(&mut self, parameters: &[f64], epsilon: f64) {
        let root = |x: f64| x.hypot(epsilon).sqrt().recip();
        self.roots = self.differences(parameters).map(root).collect();
    }

    fn differences(&self, parameters: &[f64]) -> impl Iterator<Item = f64> {
        let shape = Shape::from_parameters(parameters);
        let difference = move |point: &Point| {
            let [weights, rates] = shape.terms(point.surface_albedo);
            let ring = |k: usize| {
                let x = rates[k].max(LEAST_RATE) * point.r;
                weights[k] * x * (-x).exp()
            };
            (0..TERMS).map(ring).sum::<f64>() - point.ring
        };
        self.grid.points.iter().map(difference)
    }
}

impl Residuals for Problem<'_> {
    fn residuals(&self, parameters: &[f64]) -> Vec<f64> {
        self.differences(parameters).zip(&self.roots).map(|(x, root)| x * root).collect()
    }

    /// With E_k = x e^{−x} of x = λ_k r: ∂/∂w_k = E_k − E_last,  ∂/∂λ_k = w_k r (1 − x) e^{−x}; each times the powers
    /// of A.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let shape = Shape::from_parameters(parameters);
        let mut jacobian = DMatrix::zeros(self.grid.points.len(), PARAMETERS);
        for (row, (point, root)) in self.grid.points.iter().zip(&self.roots).enumerate() {
            let [weights, rates] = shape.terms(point.surface_albedo);
            let x = rates.map(|rate| rate.max(LEAST_RATE) * point.r);
            let by_weight = |k: usize| x[k] * (-x[k]).exp() - x[FREE_WEIGHTS] * (-x[FREE_WEIGHTS]).exp();
            let by_rate = |k: usize| weights[k] * point.r * (1.0 - x[k]) * (-x[k]).exp();
            let of_weights = (0..FREE_WEIGHTS).map(|k| (by_weight(k), OF_WEIGHT));
            let of_rates = (0..TERMS).map(|k| (by_rate(k), OF_RATE));
            let mut column = 0;
            for (slope, count) in of_weights.chain(of_rates) {
                for power in 0..count {
                    jacobian[(row, column)] = root * slope * point.surface_albedo.powi(power as i32);
                    column += 1;
                }
            }
        }
        jacobian
    }
}
