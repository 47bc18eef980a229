//! Light of one wave number that leaves layers, less that which was scattered once and left straight.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f64x8};

use super::super::Layers;
use super::diffusion::Diffusion;
use super::stack::{Resolution, Stack};
use crate::walk::instruction_sets::dispatched;

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
    let (rest, left) = solve(&stack, &diffusion, resolution, &right);
    let sources: Vec<f64> = first.iter().zip(&rest).map(|(a, b)| a + b).collect();
    let exits = stack.sweep(&sources).exits;
    Remainder { rest: [exits[0] - straight[0], exits[1] - straight[1]], straight, left }
}

/// S with S − (what S scatters to) = `right`, by Y. Saad and M. H. Schultz 1986, *GMRES*, preconditioned from the right.
pub(super) fn solve(
    stack: &Stack,
    diffusion: &Diffusion,
    resolution: &Resolution,
    right: &[f64],
) -> (Vec<f64>, f64) {
    let orders = resolution.orders;
    let norm = dot(right, right).sqrt();
    if norm == 0.0 {
        return (right.to_vec(), 0.0);
    }
    let mut basis = vec![scaled(right, 1.0 / norm)];
    // Columns of the triangle, rotations, and the right side as they turn it
    let (mut columns, mut rotations) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new());
    let mut turned = vec![norm];
    while columns.len() < STEPS && turned[columns.len()].abs() > resolution.enough * norm {
        let step = columns.len();
        let guess = preconditioned(stack, diffusion, orders, &basis[step]);
        let scattered = stack.scatter(&stack.sweep(&guess));
        let mut next: Vec<f64> = guess.iter().zip(&scattered).map(|(a, b)| a - b).collect();
        let mut column = Vec::with_capacity(step + 2);
        for vector in &basis {
            let along = dot(vector, &next);
            add(&mut next, -along, vector);
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
        add(&mut sum, *factor, vector);
    }
    (preconditioned(stack, diffusion, orders, &sum), left)
}

fn preconditioned(stack: &Stack, diffusion: &Diffusion, orders: usize, vector: &[f64]) -> Vec<f64> {
    let mut result = vector.to_vec();
    diffusion.add(stack, orders, &mut result);
    result
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    dispatched!(Level::new(), simd => dot_by(simd, a, b), narrow => dot_by(simd, a, b))
}

/// In eight sums, whatever vectors there are: one alone would wait for each addition.
#[inline(always)]
fn dot_by<S: Simd>(simd: S, a: &[f64], b: &[f64]) -> f64 {
    let (chunks, others) = (a.chunks_exact(8), b.chunks_exact(8));
    let mut rest: f64 = chunks.remainder().iter().zip(others.remainder()).map(|(a, b)| a * b).sum();
    let mut sums = f64x8::splat(simd, 0.0);
    for (a, b) in chunks.zip(others) {
        sums += f64x8::from_slice(simd, a) * f64x8::from_slice(simd, b);
    }
    for sum in sums.to_array() {
        rest += sum;
    }
    rest
}

/// Adds a multiple of a vector to a sum.
fn add(sum: &mut [f64], factor: f64, vector: &[f64]) {
    dispatched!(Level::new(), _simd => add_in_lanes(sum, factor, vector), narrow => add_in_lanes(sum, factor, vector));
}

#[inline(always)]
fn add_in_lanes(sum: &mut [f64], factor: f64, vector: &[f64]) {
    for (sum, x) in sum.iter_mut().zip(vector) {
        *sum += factor * x;
    }
}

fn scaled(vector: &[f64], factor: f64) -> Vec<f64> {
    vector.iter().map(|x| x * factor).collect()
}
