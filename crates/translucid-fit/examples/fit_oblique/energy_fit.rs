//! Energy that leaves at each angle, as polynomials of the surface albedo.

use std::f64::consts::{LN_2, PI};

use nalgebra::{DMatrix, DVector};
use translucid_profile::{Configuration, half_space_single_scattering_albedo, half_space_surface_albedo};

use crate::shape_fit::polynomial;

/// Functions of the cosine that deviations from the mean are made of.
pub(crate) const FUNCTIONS: usize = 3;
/// Coefficients of each function's polynomial, and of the one between albedos.
pub(crate) const COEFFICIENTS: usize = 4;
/// Rounds in which the weights of the worst points grow, so that the greatest error gets small.
const ROUNDS: u32 = 60;

/// μ ln(1 + 1/μ), μ and μ² less their means over diffuse light, 2∫ f μ dμ.
pub(crate) fn functions(mu: f64) -> [f64; FUNCTIONS] {
    let log = if mu > 0.0 { mu * mu.recip().ln_1p() } else { 0.0 };
    [log - (4.0 * LN_2 - 1.0) / 3.0, mu - 2.0 / 3.0, mu * mu - 0.5]
}

/// The coefficients and the worst of their errors.
pub(crate) struct Energy {
    /// Coefficients of q(μ, A): E = A (1 − (1 − A) q), A for diffuse light.
    pub(crate) deviations: [[f64; COEFFICIENTS]; FUNCTIONS],
    /// Greatest |E_fit − E| / A.
    pub(crate) worst: f64,
    /// Coefficients of p: A_diffuse = A (1 + (1 − A) p(A)), A for light along the normal.
    pub(crate) diffuse: [f64; COEFFICIENTS],
    /// Greatest relative error of A_diffuse.
    pub(crate) worst_diffuse: f64,
}

impl Energy {
    pub(crate) fn fit(unit: f64) -> Self {
        let round = |c: f64| (c / unit).round() * unit;
        let albedos: Vec<f64> = (0..=50).map(|i| (f64::from(i) / 50.0).clamp(1e-3, 0.9999)).collect();
        // (1 − E/A) / (1 − A) counts as E/A does: times 1 − A
        let mut rows = Vec::new();
        let mut values = Vec::new();
        for &a in &albedos {
            let alpha = half_space_single_scattering_albedo(a, Configuration::Diffuse);
            for i in 1..=40 {
                let mu = (f64::from(i) / 40.0).powi(2);
                let exact = total(alpha, mu);
                let powers = |f: f64| (0..COEFFICIENTS).map(move |n| (1.0 - a) * f * a.powi(n as i32));
                rows.push(functions(mu).into_iter().flat_map(powers).collect::<Vec<f64>>());
                values.push(1.0 - exact / a);
            }
        }
        let coefficients: Vec<f64> = minimize_worst(&rows, &values).into_iter().map(round).collect();
        let deviations = std::array::from_fn(|f| std::array::from_fn(|n| coefficients[f * COEFFICIENTS + n]));
        let worst = worst(&rows, &values, &coefficients);

        // From the albedo along the normal to that of diffuse light
        let row = |a: &f64| -> Vec<f64> { (0..COEFFICIENTS).map(|n| (1.0 - a) * a.powi(n as i32)).collect() };
        let rows: Vec<Vec<f64>> = albedos.iter().map(row).collect();
        let of_diffuse = |a: &f64| {
            let alpha = half_space_single_scattering_albedo(*a, Configuration::Searchlight);
            half_space_surface_albedo(alpha, Configuration::Diffuse) / a - 1.0
        };
        let values: Vec<f64> = albedos.iter().map(of_diffuse).collect();
        let coefficients: Vec<f64> = minimize_worst(&rows, &values).into_iter().map(round).collect();
        let error = |a: &f64| {
            let exact = 1.0 + of_diffuse(a);
            ((1.0 + (1.0 - a) * polynomial(&coefficients, *a)) / exact - 1.0).abs()
        };
        let worst_diffuse = albedos.iter().map(error).fold(0.0, f64::max);
        let diffuse = std::array::from_fn(|n| coefficients[n]);
        Self { deviations, worst, diffuse, worst_diffuse }
    }
}

/// Share that the exact half space returns of light at a cosine: 1 − H(μ)√(1−α), with
/// ln H(μ) = −(μ/π) ∫₀^∞ ln[1 − α atan(t)/t] / (1 + μ²t²) dt by the trapezoidal rule in ln t.
fn total(alpha: f64, mu: f64) -> f64 {
    const STEP: f64 = 0.25;
    let node = |i: i32| {
        let t = (STEP * f64::from(i)).exp();
        let slope = if t < 1e-4 { 1.0 - t * t / 3.0 } else { t.atan() / t };
        (1.0 - alpha * slope).ln() * t * STEP / (1.0 + (mu * t).powi(2))
    };
    let h = (-mu / PI * (-160..=160).map(node).sum::<f64>()).exp();
    1.0 - h * (1.0 - alpha).sqrt()
}

/// Coefficients of Σ row·c near the values, with a small greatest error: C. L. Lawson's algorithm (1961).
fn minimize_worst(rows: &[Vec<f64>], values: &[f64]) -> Vec<f64> {
    let mut weights = vec![1.0; rows.len()];
    let mut best = (f64::INFINITY, Vec::new());
    for _ in 0..ROUNDS {
        let matrix = DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| weights[i] * rows[i][j]);
        let right = DVector::from_fn(rows.len(), |i, _| weights[i] * values[i]);
        let found = matrix.svd(true, true).solve(&right, 1e-14).expect("both bases were asked for");
        let found = found.as_slice().to_vec();
        let worst = worst(rows, values, &found);
        for ((weight, row), value) in weights.iter_mut().zip(rows).zip(values) {
            *weight *= 1.0 + difference(row, *value, &found).abs() / worst;
        }
        let mean = weights.iter().sum::<f64>() / weights.len() as f64;
        weights.iter_mut().for_each(|weight| *weight /= mean);
        if worst < best.0 {
            best = (worst, found);
        }
    }
    best.1
}

fn difference(row: &[f64], value: f64, coefficients: &[f64]) -> f64 {
    row.iter().zip(coefficients).map(|(x, c)| x * c).sum::<f64>() - value
}

fn worst(rows: &[Vec<f64>], values: &[f64], coefficients: &[f64]) -> f64 {
    let errors = rows.iter().zip(values).map(|(row, value)| difference(row, *value, coefficients).abs());
    errors.fold(0.0, f64::max)
}
