//! Light of one wave number that leaves layers, less that which was scattered once and left straight.

use super::diffusion::Diffusion;
use super::stack::{Resolution, Stack};
use super::super::Layers;

/// Norm of what is left over that of the first sources, at which a solution is one.
const ENOUGH: f64 = 1e-7;
/// Most steps.
const STEPS: usize = 60;

/// Flux that leaves above and below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Remainder {
    pub(super) rest: [f64; 2],
    /// Light that was scattered once and left straight, which is no part of it.
    pub(super) straight: [f64; 2],
}

pub(super) fn remainder(layers: &Layers, unit: f64, k: f64, resolution: &Resolution) -> Remainder {
    let stack = Stack::new(layers, unit, k, resolution);
    let first = stack.first_sources();
    let straight = stack.straight(&first);
    let right = stack.scatter(&stack.sweep(&first));
    let diffusion = Diffusion::new(&stack, stack.reflectances());
    let rest = solve(&stack, &diffusion, resolution.orders, &right);
    let sources: Vec<f64> = first.iter().zip(&rest).map(|(a, b)| a + b).collect();
    let exits = stack.sweep(&sources).exits;
    Remainder { rest: [exits[0] - straight[0], exits[1] - straight[1]], straight }
}

/// S with S − (what S scatters to) = `right`, by Y. Saad and M. H. Schultz 1986, *GMRES*, preconditioned from the right.
fn solve(stack: &Stack, diffusion: &Diffusion, orders: usize, right: &[f64]) -> Vec<f64> {
    let norm = dot(right, right).sqrt();
    if norm == 0.0 {
        return right.to_vec();
    }
    let mut basis = vec![scaled(right, 1.0 / norm)];
    // Columns of the triangle, rotations, and the right side as they turn it
    let (mut columns, mut rotations) = (Vec::<Vec<f64>>::new(), Vec::<[f64; 2]>::new());
    let mut turned = vec![norm];
    while columns.len() < STEPS && turned[columns.len()].abs() > ENOUGH * norm {
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
    preconditioned(stack, diffusion, orders, &sum)
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

#[cfg(test)]
mod tests {
    use super::*;
    use super::super::super::{Ground, Layer};
    use crate::Incidence;
    use crate::exact::HalfSpace;

    #[test]
    fn try_it() {
        for eta in [1.0, 1.4] {
            let alpha = 0.9;
            let exact = HalfSpace::with_boundary(alpha, eta, Incidence::NORMAL).unwrap();
            let spec = crate::specular_reflectance(Incidence::NORMAL, eta);
            let layers = Layers::new(1.0, vec![Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_eta(eta)], Ground::None).unwrap();
            for k in [1e-3, 0.1, 1.0, 3.0, 10.0, 30.0, 100.0] {
                for (rays, azimuths, nodes) in [(8, 8, 6), (16, 16, 7)] {
                    let resolution = Resolution { rays, moments: 1, orders: 1, azimuths, nodes };
                    let start = std::time::Instant::now();
                    let found = remainder(&layers, 1.0, k, &resolution).rest;
                    let time = start.elapsed();
                    let rule = translucid_profile::quadrature::gauss_legendre(400);
                    let crit = (1.0f64 - 1.0 / (eta * eta)).sqrt();
                    let single = translucid_profile::quadrature::integrate(&rule, 0.0, 1.0, |t| {
                        // cluster at both ends
                        let mu = crit + (1.0 - crit) * t * t * (3.0 - 2.0 * t);
                        let jac = (1.0 - crit) * 6.0 * t * (1.0 - t);
                        let tan2 = (1.0 - mu * mu) / (mu * mu);
                        let f = translucid_profile::fresnel_from_outside(mu, 1.0 / eta);
                        jac * 0.5 * alpha * (1.0 - f) / ((1.0 + 1.0 / mu).powi(2) + k * k * tan2).sqrt()
                    });
                    let total = (1.0 - spec) * exact.hankel(k).value;
                    let expected = (1.0 - spec) * (exact.hankel(k).value - single);
                    eprintln!("{eta} {k} {rays}: {:.8} {:.8} off {:.2e} of total {:.2e} {:?}", found[0], expected, found[0] / expected - 1.0, (found[0] - expected) / total, time);
                }
            }
        }
    }

    #[test]
    fn try_g() {
        let env = |name: &str, default: usize| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
        let g = env("G", 80) as f64 / 100.0;
        let eta = env("ETA", 140) as f64 / 100.0;
        let alpha = env("ALPHA", 990) as f64 / 1000.0;
        let layers = Layers::new(1.0, vec![Layer::new(alpha, 1.0 - alpha, f64::INFINITY).with_g(g).with_eta(eta)], Ground::None).unwrap();
        let moments = env("MOMENTS", 24);
        let list = std::env::var("LIST").unwrap_or("12,8,12,6 16,12,16,6 16,24,24,6 24,24,24,7 32,24,32,8".into());
        for k in [1e-3, 0.03, 0.3, 1.0, 3.0, 10.0, 30.0] {
            let mut last = f64::NAN;
            for item in list.split(' ') {
                let n: Vec<usize> = item.split(',').map(|x| x.parse().unwrap()).collect();
                let [rays, orders, azimuths, nodes] = n[..] else { panic!() };
                let resolution = Resolution { rays, moments, orders: orders.min(moments), azimuths, nodes };
                let start = std::time::Instant::now();
                let found = remainder(&layers, 1.0, k, &resolution).rest;
                let time = start.elapsed();
                eprintln!("g {k} {item}: {:.8} change {:.2e} {:?}", found[0], found[0] / last - 1.0, time);
                last = found[0];
            }
        }
    }
}
