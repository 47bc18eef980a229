//! Light of one wave number that leaves layers, less that which was scattered once and left straight.

use super::super::Layers;
use super::diffusion::Diffusion;
use super::stack::{Resolution, Stack};

/// Norm of what is left over that of the first sources, at which a solution is one.
const ENOUGH: f64 = 1e-7;
/// Most steps.
const STEPS: usize = 200;

/// Flux that leaves above and below, for one wave number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remainder {
    /// All of it but `straight`.
    pub(super) rest: [f64; 2],
    /// Light that was scattered once and left straight, in these directions.
    pub(super) straight: [f64; 2],
    /// What the solution leaves of the equations, as a part of their right side.
    pub(super) left: f64,
}

/// Solves for it.
pub(super) fn remainder(layers: &Layers, unit: f64, k: f64, resolution: &Resolution) -> Remainder {
    let stack = Stack::new(layers, unit, k, resolution);
    let first = stack.first_sources();
    let straight = stack.straight(&first);
    let right = stack.scatter(&stack.sweep(&first));
    let diffusion = Diffusion::new(&stack, stack.reflectances());
    let (rest, left) = solve(&stack, &diffusion, resolution.orders, &right, ENOUGH);
    let sources: Vec<f64> = first.iter().zip(&rest).map(|(a, b)| a + b).collect();
    let exits = stack.sweep(&sources).exits;
    Remainder { rest: [exits[0] - straight[0], exits[1] - straight[1]], straight, left }
}

/// S with S − (what S scatters to) = `right`, by Y. Saad and M. H. Schultz 1986, *GMRES*, preconditioned from the right.
///
/// The norm of what is left over that of the right side comes to `enough`, and is returned.
pub(super) fn solve(
    stack: &Stack,
    diffusion: &Diffusion,
    orders: usize,
    right: &[f64],
    enough: f64,
) -> (Vec<f64>, f64) {
    let norm = dot(right, right).sqrt();
    if norm == 0.0 {
        return (right.to_vec(), 0.0);
    }
    let mut basis = vec![scaled(right, 1.0 / norm)];
    // Columns of the triangle, rotations, and the right side as they turn it
    let (mut columns, mut rotations) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new());
    let mut turned = vec![norm];
    while columns.len() < STEPS && turned[columns.len()].abs() > enough * norm {
        let step = columns.len();
        let guess = preconditioned(stack, diffusion, orders, &basis[step]);
        let scattered = stack.scatter(&stack.sweep(&guess));
        let mut next: Vec<f64> = guess.iter().zip(&scattered).map(|(a, b)| a - b).collect();
        let mut column = Vec::with_capacity(step + 2);
        for vector in &basis {
            let along = dot(vector, &next);
            next.iter_mut().zip(vector).for_each(|(x, v)| *x -= along * v);
            column.push(along);
        }
        let length = dot(&next, &next).sqrt();
        for (row, [c, s]) in rotations.iter().enumerate() {
            let [a, b] = [column[row], column[row + 1]];
            (column[row], column[row + 1]) = (c * a + s * b, c * b - s * a);
        }
        let whole = libm::hypot(column[step], length);
        let [c, s] = [column[step] / whole, length / whole];
        column[step] = whole;
        rotations.push([c, s]);
        turned.push(-s * turned[step]);
        turned[step] *= c;
        columns.push(column);
        if length <= 1e-14 * whole {
            break;
        }
        basis.push(scaled(&next, 1.0 / length));
    }
    let left = turned[columns.len()].abs() / norm;
    let steps = columns.len();
    let mut factors = turned[..steps].to_vec();
    for i in (0..steps).rev() {
        let known: f64 = (i + 1..steps).map(|j| columns[j][i] * factors[j]).sum();
        factors[i] = (factors[i] - known) / columns[i][i];
    }
    let mut sum = vec![0.0; right.len()];
    for (vector, factor) in basis.iter().zip(&factors) {
        sum.iter_mut().zip(vector).for_each(|(sum, x)| *sum += factor * x);
    }
    (preconditioned(stack, diffusion, orders, &sum), left)
}

fn preconditioned(stack: &Stack, diffusion: &Diffusion, orders: usize, vector: &[f64]) -> Vec<f64> {
    let mut result = vector.to_vec();
    diffusion.add(stack, orders, &mut result);
    result
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn scaled(vector: &[f64], factor: f64) -> Vec<f64> {
    vector.iter().map(|x| x * factor).collect()
}
