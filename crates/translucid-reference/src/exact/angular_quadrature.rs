//! Quadrature over the directions of light that enters or leaves.
//!
//! Light of every direction of the half space, weighted by its cosine u to the normal, decays with depth like
//! ∫₀¹ e^{−sz} du, s = √(1/u² + k²), when it varies with k along the surface.
//! H adds u ln u, harmless where u is a cube. Else the integrand has singularities at u = ±i/k, which come close to the
//! real axis where k is near the imaginary one, and a root in s near u = 1 where k is near i. The path of u is
//! therefore bent away from them.

use num_complex::Complex64;

use super::complex::{norm, sqrt};
use super::h_function::WaveNumber;

/// A node of the rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Direction {
    /// s = √(1/u² + k²).
    pub(crate) s: Complex64,
    /// Weight du.
    pub(crate) du: Complex64,
    /// λ² = 1/u².
    pub(crate) inverse_u_squared: Complex64,
}

/// Nodes of the rule for one wave number, from Gauss–Legendre nodes and weights on [−1, 1].
pub(crate) fn directions(wave_number: &WaveNumber, rule: &[(f64, f64)]) -> Vec<Direction> {
    let cubes = rule.iter().map(|&(x, weight)| {
        let root = 0.5 * (1.0 + x);
        (root * root * root, 1.5 * weight * root * root)
    });
    if wave_number.b.norm_sqr() < SMALL_B * SMALL_B {
        straight_in_s(wave_number.b, cubes).collect()
    } else {
        from_wave_number(wave_number, cubes)
    }
}

/// Bound on |b| below which s runs straight. Found by trying, like the factors below: with 32 points the error is
/// then below 1e-12 of R̂ for every k.
const SMALL_B: f64 = 3.0;

/// s = b + c (1 − p)/p: singularities are at s = ±k and −b, behind the start.
fn straight_in_s(b: Complex64, nodes: impl Iterator<Item = (f64, f64)>) -> impl Iterator<Item = Direction> {
    let c = 0.7 * libm::pow(norm(b), 0.4);
    nodes.map(move |(p, dp)| {
        let y = c * (1.0 - p) / p;
        let s = b + y;
        // λ² = s² − k² = 1 + y(y + 2b), λ dλ = s ds
        let inverse_u_squared = 1.0 + y * (y + 2.0 * b);
        let du = s * (c * dp) / (inverse_u_squared * sqrt(inverse_u_squared) * (p * p));
        Direction { s, du, inverse_u_squared }
    })
}

/// u = p/(1 + κ(1 − p)), |κ| ≈ |k|, half of the nodes on either side of u = 1/|k|.
///
/// For u ≫ 1/|k| a function of s = √(1/u² + k²) becomes constant, which this rule does not follow: the node s = k
/// (u = ∞) takes what weight is left.
fn from_wave_number(wave_number: &WaveNumber, nodes: impl Iterator<Item = (f64, f64)>) -> Vec<Direction> {
    let k = wave_number.k;
    // Half way in argument between the singularities
    let kappa = 0.7 * sqrt(k * norm(k));
    let mut left = Complex64::ONE;
    let mut directions: Vec<Direction> = nodes
        .map(|(p, dp)| {
            let denominator = 1.0 + kappa * (1.0 - p);
            let (lambda, du) = (denominator / p, dp * (1.0 + kappa) / (denominator * denominator));
            left -= du;
            Direction { s: wave_number.decay(lambda), du, inverse_u_squared: lambda * lambda }
        })
        .collect();
    directions.push(Direction { s: k, du: left, inverse_u_squared: Complex64::ZERO });
    directions
}
