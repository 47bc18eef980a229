//! From real wave numbers back to radii, by poles.
//!
//! A transform of light in layers has its singularities at imaginary wave numbers ±iκ, κ ≥ k₀, as interchange of light and
//! detector makes it symmetric. So it is nearly a sum of poles there, whose inverse is known:
//!
//! ```text
//! f̂(k) ≈ Σ c_j/(k² + κ_j²)            f(r) = (1/2π) Σ c_j K₀(κ_j r)
//! ```
//!
//! With κ_j² = k₀² + e^{2hj} the sum follows any such transform up to some e^{−2π²/h}. The c_j are found by least
//! squares: what they leave undetermined for real k is as small in f(r).

use std::f64::consts::PI;

use crate::exact::macdonald::Macdonald;

/// A sum of poles.
#[derive(Clone, Debug)]
pub(super) struct Poles {
    /// κ_j and c_j/2π.
    terms: Vec<[f64; 2]>,
}

/// Part of a column's norm below which the coefficients are held down.
const RIDGE: f64 = 1e-7;
/// Least part of the light that counts, where it falls like k⁻².
const LEAST_PART: f64 = 1e-4;

impl Poles {
    /// From wave numbers with the transform there and the light beside it, with poles from `least` to `most` at the step h.
    pub(super) fn new(samples: &[[f64; 3]], k0: f64, [least, most]: [f64; 2], step: f64) -> Self {
        let count = (libm::log(most / least) / step).ceil() as usize + 1;
        let squares: Vec<f64> = (0..count)
            .map(|j| {
                let beyond = least * libm::exp(step * j as f64);
                k0 * k0 + beyond * beyond
            })
            .collect();
        let total = samples.first().map_or(0.0, |[_, value, _]| value.abs());
        if samples.iter().all(|[_, value, _]| *value == 0.0) {
            return Self { terms: Vec::new() };
        }
        let half = samples.iter().find(|[_, value, _]| value.abs() < 0.5 * total).map_or(1.0, |[k, ..]| *k);
        let mut rows: Vec<Vec<f64>> = samples
            .iter()
            .map(|[k, value, beside]| {
                let least = LEAST_PART * total / (1.0 + k * k / (half * half));
                let weight = 1.0 / (value.abs() + beside.abs() + least).max(f64::MIN_POSITIVE);
                let terms = squares.iter().map(|square| weight / (k * k + square));
                terms.chain([weight * value]).collect()
            })
            .collect();
        let norms: Vec<f64> =
            (0..count).map(|j| rows.iter().map(|row| row[j] * row[j]).sum::<f64>().sqrt()).collect();
        for row in &mut rows {
            row.iter_mut().zip(&norms).for_each(|(value, norm)| *value /= norm);
        }
        rows.extend((0..count).map(|j| (0..=count).map(|i| if i == j { RIDGE } else { 0.0 }).collect()));
        let solution = least_squares(rows, count);
        let terms = squares.iter().zip(solution.iter().zip(&norms));
        Self { terms: terms.map(|(square, (c, norm))| [square.sqrt(), c / norm / (2.0 * PI)]).collect() }
    }

    /// f̂(k).
    pub(super) fn transform(&self, k: f64) -> f64 {
        self.terms.iter().map(|[kappa, factor]| 2.0 * PI * factor / (k * k + kappa * kappa)).sum()
    }

    /// f(r) for r > 0.
    pub(super) fn eval(&self, r: f64) -> f64 {
        self.terms.iter().map(|[kappa, factor]| factor * bessel_k0(kappa * r)).sum()
    }
}

pub(super) fn bessel_k0(z: f64) -> f64 {
    match Macdonald::new(z.into()) {
        Macdonald::Small { k0, .. } => k0.re,
        Macdonald::Scaled { k0, .. } => k0.re * libm::exp(-z),
    }
}

/// Least squares by Householder's reflections; the last column is the right side.
fn least_squares(mut rows: Vec<Vec<f64>>, count: usize) -> Vec<f64> {
    for column in 0..count {
        let norm = rows[column..].iter().map(|row| row[column] * row[column]).sum::<f64>().sqrt();
        let head = rows[column][column];
        let pivot = if head > 0.0 { -norm } else { norm };
        let mut vector: Vec<f64> = rows[column..].iter().map(|row| row[column]).collect();
        vector[0] -= pivot;
        let square: f64 = vector.iter().map(|x| x * x).sum();
        if square == 0.0 {
            continue;
        }
        for j in column..=count {
            let dot: f64 = vector.iter().zip(&rows[column..]).map(|(x, row)| x * row[j]).sum();
            let factor = 2.0 * dot / square;
            rows[column..].iter_mut().zip(&vector).for_each(|(row, x)| row[j] -= factor * x);
        }
    }
    let mut solution = vec![0.0; count];
    for i in (0..count).rev() {
        let known: f64 = (i + 1..count).map(|j| rows[i][j] * solution[j]).sum();
        solution[i] = (rows[i][count] - known) / rows[i][i];
    }
    solution
}
