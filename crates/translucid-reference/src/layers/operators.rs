//! Reflection and transmission of one layer between rays, and of one face.
//!
//! Radiances down and up, I⁺ and I⁻, of discrete directions obey, with S = I⁺ + I⁻ and D = I⁺ − I⁻,
//!
//! ```text
//! dS/dz = −A D,   dD/dz = −B S,   A, B = σ_t/μ − σ_s h∓ w/μ
//! ```
//!
//! In amplitudes √(wμ) I both are symmetric and positive. With A = LLᵀ, LᵀBL = VΛ²Vᵀ, P = LV and G = L⁻ᵀV = P⁻ᵀ the light of
//! equal or opposite sources at both faces of the thickness d is (K. Stamnes et al. 1988, *Numerically stable algorithm
//! for discrete-ordinate-method radiative transfer*, in the form of even and odd parity)
//!
//! ```text
//! R + T = 2(1 + G Λ tanh(Λd/2) Gᵀ)⁻¹ − 1,     R − T = 1 − 2(1 + P Λ⁻¹ tanh(Λd/2) Pᵀ)⁻¹
//! ```
//!
//! without a difference of growing numbers, for every thickness, and for Λ = 0 too.

use translucid_profile::fresnel_from_outside;

use super::Layer;
use super::matrix::{Eigen, Matrix};
use super::rays::Rays;

/// Reflection and transmission of amplitudes of rays by a layer, the same from both sides.
#[derive(Clone, Debug)]
pub(super) struct LayerOperators {
    pub(super) reflected: Matrix,
    pub(super) transmitted: Matrix,
}

impl LayerOperators {
    pub(super) fn new(layer: &Layer, rays: &Rays) -> Self {
        let count = rays.count(layer.eta);
        let cosines: Vec<f64> = (0..count).map(|ray| rays.cosine(ray, layer.eta)).collect();
        if layer.scattering == 0.0 {
            let through = |mu: &f64| libm::exp(-depth(layer) / mu);
            return Self {
                reflected: Matrix::from_fn(count, |_, _| 0.0),
                transmitted: Matrix::diagonal(&cosines.iter().map(through).collect::<Vec<f64>>()),
            };
        }
        let weights: Vec<f64> = (0..count).map(|ray| rays.cosine_weight(ray, layer.eta)).collect();
        let scatter = Scatter::new(layer, &cosines, &weights, rays.moments(count));
        scatter.operators(layer, &cosines, &weights)
    }
}

/// σ_t d, with 0 · ∞ = 0 left out by the layers' check.
pub(super) fn depth(layer: &Layer) -> f64 {
    layer.extinction() * layer.thickness
}

/// Scattering between directions: coefficients and redistribution, without the peak that counts as not scattered.
struct Scatter {
    scattering: f64,
    /// h⁺ + h⁻, and h⁺ − h⁻.
    parities: [Matrix; 2],
}

impl Scatter {
    /// With so many moments; what the next one says of forward scattering is a peak of no angle (W. J. Wiscombe 1977,
    /// *The delta-M method*).
    fn new(layer: &Layer, cosines: &[f64], weights: &[f64], moments: usize) -> Self {
        let peak = layer.phase_function.moment(moments);
        let factors: Vec<f64> = (0..moments)
            .map(|l| (2 * l + 1) as f64 * (layer.phase_function.moment(l) - peak) / (1.0 - peak))
            .collect();
        let polynomials: Vec<Vec<f64>> = cosines.iter().map(|mu| legendre(*mu, moments)).collect();
        let of_parity = |parity: usize| {
            let element = |i: usize, j: usize| {
                let orders = (parity..moments).step_by(2);
                orders.map(|l| factors[l] * polynomials[i][l] * polynomials[j][l]).sum()
            };
            Matrix::from_fn(cosines.len(), element)
        };
        let even = normalized(&of_parity(0), weights);
        Self { scattering: layer.scattering * (1.0 - peak), parities: [even, of_parity(1)] }
    }

    fn operators(&self, layer: &Layer, cosines: &[f64], weights: &[f64]) -> LayerOperators {
        let extinction = self.scattering + layer.absorption;
        let size = cosines.len();
        let roots: Vec<f64> = weights.iter().zip(cosines).map(|(weight, mu)| (weight / mu).sqrt()).collect();
        let rates = |parity: usize| {
            Matrix::from_fn(size, |i, j| {
                let straight = if i == j { extinction / cosines[i] } else { 0.0 };
                straight - self.scattering * roots[i] * self.parities[parity].at(i, j) * roots[j]
            })
        };
        let lower = rates(1).cholesky();
        let squared = lower.transposed().times(&rates(0)).times(&lower);
        let Eigen { mut values, vectors } = squared.symmetric_eigen();
        if layer.absorption == 0.0
            && let Some(least) = values.iter_mut().min_by(|a, b| a.total_cmp(b))
        {
            *least = 0.0;
        }
        let decays: Vec<f64> = values.iter().map(|value| value.max(0.0).sqrt()).collect();
        let inverse_modes = lower.lower_inverse().transposed().times(&vectors);
        let half = 0.5 * layer.thickness;
        let even = |lambda: &f64| if *lambda > 0.0 { lambda * libm::tanh(lambda * half) } else { 0.0 };
        let even: Vec<f64> = decays.iter().map(even).collect();
        let even = inverse_modes.sandwich(&even).one_plus_inverse();
        let identity = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        if layer.thickness.is_infinite() {
            return LayerOperators {
                reflected: Matrix::from_fn(size, |i, j| 2.0 * even.at(i, j) - identity(i, j)),
                transmitted: Matrix::from_fn(size, |_, _| 0.0),
            };
        }
        let odd = |lambda: &f64| {
            let argument = lambda * half;
            if argument > 1e-8 { libm::tanh(argument) / lambda } else { half }
        };
        let odd: Vec<f64> = decays.iter().map(odd).collect();
        let odd = lower.times(&vectors).sandwich(&odd).one_plus_inverse();
        LayerOperators {
            reflected: Matrix::from_fn(size, |i, j| even.at(i, j) - odd.at(i, j)),
            transmitted: Matrix::from_fn(size, |i, j| even.at(i, j) + odd.at(i, j) - identity(i, j)),
        }
    }
}

/// P₀ … of a cosine.
fn legendre(mu: f64, count: usize) -> Vec<f64> {
    let mut values = vec![1.0, mu];
    for l in 1..count.max(2) - 1 {
        let order = l as f64;
        values.push(((2.0 * order + 1.0) * mu * values[l] - order * values[l - 1]) / (order + 1.0));
    }
    values
}

/// Multiplies a symmetric redistribution by 1 + a_i + a_j so that Σ_i w_i h_ij = 1: no energy is lost to quadrature.
pub(super) fn normalized(matrix: &Matrix, weights: &[f64]) -> Matrix {
    let size = weights.len();
    let sums = matrix.times_vector(weights);
    let system =
        Matrix::from_fn(size, |j, i| weights[i] * matrix.at(i, j) + if i == j { sums[j] } else { 0.0 });
    let right = Matrix::from_fn(size, |j, column| if column == 0 { 1.0 - sums[j] } else { 0.0 });
    let factors = system.solve(right);
    Matrix::from_fn(size, |i, j| matrix.at(i, j) * (1.0 + factors.at(i, 0) + factors.at(j, 0)))
}

/// Reflectance of a face for the rays that both media have, the first ones.
pub(super) fn face(rays: &Rays, eta_above: f64, eta_below: f64) -> Vec<f64> {
    let common = rays.count(eta_above).min(rays.count(eta_below));
    let reflectance = |ray: usize| fresnel_from_outside(rays.cosine(ray, eta_above), eta_below / eta_above);
    (0..common).map(reflectance).collect()
}
