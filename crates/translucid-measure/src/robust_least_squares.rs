//! Robust weighted least squares of a few parameters.
//!
//! MINPACK's search, which `translucid-fit` has by a crate, ends in the same minima, but takes up to thirty times as long where
//! blur and creeping explain the light alike: it follows such valleys to their end, and begins anew after each weighing.

use nalgebra::{DMatrix, DVector};

/// Minimum of the weighted squares of residuals.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RobustMinimum {
    /// The parameters.
    pub(crate) parameters: Vec<f64>,
    /// Weights that outliers have left to each residual, in (0, 1].
    pub(crate) weights: Vec<f64>,
}

/// Residuals farther out than this many robust standard deviations count less, as Huber (1964) weighs them: with 1.345 a
/// fit of normal residuals keeps 95 % of its efficiency.
const HUBER: f64 = 1.345;

/// Rounds of weighing.
const ROUNDS: usize = 8;

/// Step of the difference quotients, in the scales of the parameters.
const STEP: f64 = 1e-4;

/// A parameter whose step changes the residuals by less than this squared hardly moves.
const UNFELT: f64 = 1e-9;

/// Steps of a round.
const STEPS: usize = 60;

/// Minimizes Σ w r(p)² from a start by Levenberg's and Marquardt's method, with the weights of Huber's estimator, whose
/// scale is the median of |r|. `scales` are steps for differences of the parameters.
///
/// A step to residuals that are not finite is not taken.
pub(crate) fn robust_least_squares(
    residuals: impl Fn(&[f64]) -> Vec<f64>,
    start: &[f64],
    scales: &[f64],
) -> RobustMinimum {
    let mut parameters = start.to_vec();
    let mut values = residuals(&parameters);
    let mut weights = vec![1.0; values.len()];
    for _ in 0..ROUNDS {
        let before = parameters.clone();
        descend(&residuals, &mut parameters, &mut values, &weights, scales);
        weights = huber(&values);
        let moved = parameters.iter().zip(&before).zip(scales).any(|((a, b), s)| (a - b).abs() > 1e-3 * s);
        if !moved {
            break;
        }
    }
    RobustMinimum { parameters, weights }
}

/// Moves the parameters down to where Σ w r² is least.
fn descend(
    residuals: &impl Fn(&[f64]) -> Vec<f64>,
    parameters: &mut Vec<f64>,
    values: &mut Vec<f64>,
    weights: &[f64],
    scales: &[f64],
) {
    let mut damping = 1e-3;
    let mut sum = weighted_sum(values, weights);
    for _ in 0..STEPS {
        let jacobian = jacobian(residuals, parameters, scales);
        let normal = weighted_normal(&jacobian, weights);
        let weighted: Vec<f64> = values.iter().zip(weights).map(|(value, weight)| value * weight).collect();
        let gradient = jacobian.transpose() * DVector::from_vec(weighted);
        let mut is_better = false;
        while damping < 1e12 {
            let mut damped = normal.clone();
            for i in 0..parameters.len() {
                damped[(i, i)] += damping * normal[(i, i)].max(UNFELT / scales[i].powi(2));
            }
            let Some(step) = damped.cholesky().map(|factor| factor.solve(&gradient)) else {
                damping *= 10.0;
                continue;
            };
            let next: Vec<f64> = parameters.iter().zip(step.iter()).map(|(p, s)| p - s).collect();
            let next_values = residuals(&next);
            let next_sum = weighted_sum(&next_values, weights);
            if next_sum < sum {
                let is_done = sum - next_sum < 1e-10 * sum;
                (*parameters, *values, sum) = (next, next_values, next_sum);
                damping = (0.2 * damping).max(1e-12);
                is_better = !is_done;
                break;
            }
            damping *= 10.0;
        }
        if !is_better {
            return;
        }
    }
}

/// Derivatives of the residuals by central differences.
pub(crate) fn jacobian(
    residuals: &impl Fn(&[f64]) -> Vec<f64>,
    parameters: &[f64],
    scales: &[f64],
) -> DMatrix<f64> {
    let column = |i: usize| {
        let at = |sign: f64| {
            let mut moved = parameters.to_vec();
            moved[i] += sign * STEP * scales[i];
            residuals(&moved)
        };
        let slope = |(a, b): (&f64, &f64)| (a - b) / (2.0 * STEP * scales[i]);
        DVector::from_vec(at(1.0).iter().zip(&at(-1.0)).map(slope).collect())
    };
    DMatrix::from_columns(&(0..parameters.len()).map(column).collect::<Vec<_>>())
}

fn weighted_normal(jacobian: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut weighted = jacobian.clone();
    for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
        row *= *weight;
    }
    jacobian.transpose() * weighted
}

fn weighted_sum(values: &[f64], weights: &[f64]) -> f64 {
    values.iter().zip(weights).map(|(value, weight)| weight * value * value).sum()
}

fn huber(values: &[f64]) -> Vec<f64> {
    // What is left out has no residual
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|size| *size != 0.0).collect();
    sizes.sort_by(f64::total_cmp);
    // The median of |r| of a normal distribution is 0.6745 of its standard deviation
    let limit = HUBER * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0) / 0.6745;
    values.iter().map(|value| if value.abs() > limit { limit / value.abs() } else { 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line with two outliers among 41 points on it.
    #[test]
    fn outliers_hardly_move_a_line() {
        let points: Vec<(f64, f64)> = (0..41)
            .map(|i| {
                let x = f64::from(i) / 10.0;
                let noise = 1e-3 * libm::sin(17.0 * f64::from(i));
                let outlier = if i == 7 || i == 30 { 5.0 } else { 0.0 };
                (x, 2.0 + 3.0 * x + noise + outlier)
            })
            .collect();
        let residuals = |p: &[f64]| points.iter().map(|(x, y)| p[0] + p[1] * x - y).collect();
        let minimum = robust_least_squares(residuals, &[0.0, 0.0], &[1.0, 1.0]);
        assert!((minimum.parameters[0] - 2.0).abs() < 2e-3, "{:?}", minimum.parameters);
        assert!((minimum.parameters[1] - 3.0).abs() < 1e-3, "{:?}", minimum.parameters);
        assert!(minimum.weights[7] < 0.01 && minimum.weights[8] > 0.3);
    }
}
