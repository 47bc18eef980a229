//! Surface albedo of a half space whose scattering has a preferred direction, under a dielectric boundary.
//!
//! For the total alone light may be summed over the surface and around the normal: what is left depends on the depth τ
//! and the cosine μ, and on a quadrature of directions it is a linear system (S. Chandrasekhar, *Radiative Transfer*,
//! 1950, chapter II).
//!
//! ```text
//! dI⁺/dτ = −D I⁺ + B I⁻,   −dI⁻/dτ = −D I⁻ + B I⁺             I⁺ inward, I⁻ outward
//! D_ij = (δ_ij − ½ α w_j p(μ_i, μ_j))/μ_i,   B_ij = ½ α w_j p(μ_i, −μ_j)/μ_i
//! p(μ, μ') = Σ (2l + 1) χ_l P_l(μ) P_l(μ'),   χ_l = g^l
//! ```
//!
//! The half space reflects I⁻ = R I⁺, with the R for which R B R − R D − D R + B = 0.
//! Cayley's transform of the system, doubled again and again as layers are, converges to it quadratically (C.-H. Guo,
//! X.-X. Guo and W.-W. Lin 2006, *A structure-preserving doubling algorithm for nonsymmetric algebraic Riccati
//! equation*): no thin layer to begin with, no thickness to end at.
//!
//! The peak of the phase function beyond the last moment counts as not scattered (W. J. Wiscombe 1977, *The delta-M
//! method*).

use crate::Configuration;
use crate::fresnel_from_inside;
use crate::math::quadrature::shared_gauss_legendre;
use crate::math::square_matrix::SquareMatrix;

/// Directions in each part of the hemisphere.
const DIRECTIONS: usize = 20;
/// Doublings before which every half space has converged that absorbs more than rounding.
const MOST_DOUBLINGS: usize = 64;

/// A half space of the phase function of Henyey and Greenstein under a smooth boundary, of any absorption.
#[derive(Clone, Debug)]
pub(crate) struct DiscreteOrdinates {
    g: f64,
    configuration: Configuration,
    /// Cosines inside, and their weights; the last one is that of the pencil and has none.
    cosines: Vec<f64>,
    weights: Vec<f64>,
    /// Share that the boundary lets out, for each.
    passes: Vec<f64>,
    /// P_l of each cosine.
    legendre: Vec<Vec<f64>>,
}

impl DiscreteOrdinates {
    /// For a mean cosine g ∈ (−1, 1) and a relative index η ≥ 1.
    pub(crate) fn new(g: f64, eta: f64, configuration: Configuration) -> Self {
        Self::with_directions(g, eta, configuration, DIRECTIONS)
    }

    /// With a number of directions in each part of the hemisphere, at most 64.
    pub(crate) fn with_directions(g: f64, eta: f64, configuration: Configuration, directions: usize) -> Self {
        let rule = shared_gauss_legendre(directions);
        // Total reflection ends at a kink
        let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
        let ends = if critical > 0.0 { vec![[0.0, critical], [critical, 1.0]] } else { vec![[0.0, 1.0]] };
        let (mut cosines, mut weights) = (Vec::new(), Vec::new());
        for [from, to] in ends {
            for (x, weight) in rule {
                cosines.push(0.5 * (from + to) + 0.5 * (to - from) * x);
                weights.push(0.5 * (to - from) * weight);
            }
        }
        cosines.push(1.0);
        weights.push(0.0);
        let passes = cosines.iter().map(|mu| 1.0 - fresnel_from_inside(*mu, eta)).collect();
        let legendre = cosines.iter().map(|mu| legendre_polynomials(*mu, 2 * directions)).collect();
        Self { g, configuration, cosines, weights, passes, legendre }
    }

    /// Surface albedo A ∈ [0, 1] of the medium whose reduced albedo is α' = 1 − `absorbed`, absorbed ∈ [0, 1].
    pub(crate) fn surface_albedo(&self, absorbed: f64) -> f64 {
        if absorbed <= 0.0 {
            return 1.0;
        }
        let outward = self.outward(&self.reflection(absorbed));
        let total = match self.configuration {
            Configuration::Searchlight => outward[outward.len() - 1],
            Configuration::Diffuse => {
                let sum = |f: &dyn Fn(usize) -> f64| -> f64 {
                    let term = |i: usize| self.weights[i] * self.cosines[i] * self.passes[i] * f(i);
                    (0..self.cosines.len()).map(term).sum()
                };
                sum(&|i| outward[i]) / sum(&|_| 1.0)
            }
        };
        total.max(0.0).min(1.0)
    }

    /// Radiance that arrives at the boundary from inside, for a radiance of 1 from everywhere outside; by reciprocity
    /// what leaves of a pencil which enters in that direction.
    fn outward(&self, reflection: &SquareMatrix) -> Vec<f64> {
        let size = self.cosines.len();
        let sent_back = |i: usize, j: usize| reflection.row(i)[j] * (1.0 - self.passes[j]);
        let system = SquareMatrix::from_fn(size, sent_back).plus_diagonal(-1.0, 1.0);
        let scattered = reflection.times_vector(&self.passes);
        let right = SquareMatrix::from_fn(size, |i, j| if j == 0 { scattered[i] } else { 0.0 });
        let solved = system.solve(right);
        (0..size).map(|i| solved.row(i)[0]).collect()
    }

    /// R, for inward radiances at all cosines to outward ones.
    fn reflection(&self, absorbed: f64) -> SquareMatrix {
        let (d, b) = self.system(absorbed);
        let size = self.cosines.len();
        let largest = (0..size).map(|i| d.row(i)[i]).fold(0.0, f64::max);
        let shifted = d.plus_diagonal(1.0, largest);
        // (D + γ)⁻¹ B and W = D + γ − B (D + γ)⁻¹ B
        let scattered = shifted.clone().solve(b.clone());
        let w = shifted.plus(-1.0, &b.times(&scattered));
        let identity = SquareMatrix::from_fn(size, |i, j| if i == j { 1.0 } else { 0.0 });
        let inverse = w.solve(identity);
        let mut transmitted = inverse.plus_diagonal(-2.0 * largest, 1.0);
        let mut reflected = scattered.times(&inverse).plus_diagonal(2.0 * largest, 0.0);
        for _ in 0..MOST_DOUBLINGS {
            let between = reflected.times(&reflected).plus_diagonal(-1.0, 1.0);
            let entering = between.clone().solve(transmitted.clone());
            let back = between.solve(reflected.times(&transmitted));
            let more = transmitted.times(&back);
            transmitted = transmitted.times(&entering);
            reflected = reflected.plus(1.0, &more);
            if more.largest() <= 1e-14 * reflected.largest() {
                break;
            }
        }
        reflected
    }

    /// D and B.
    fn system(&self, absorbed: f64) -> (SquareMatrix, SquareMatrix) {
        let g = self.g;
        let moments = self.legendre[0].len();
        // 1 − α = (1 − g) a/(1 − g a) for a = 1 − α'; then without the peak
        let peak = g.powi(moments as i32);
        let kept = (1.0 - g) * absorbed / (1.0 - g * absorbed);
        let kept = kept / (1.0 - (1.0 - kept) * peak);
        let half = 0.5 * (1.0 - kept);
        let factor = |l: usize| (2 * l + 1) as f64 * (g.powi(l as i32) - peak) / (1.0 - peak);
        let factors: Vec<f64> = (0..moments).map(factor).collect();
        let size = self.cosines.len();
        let phase = |i: usize, j: usize| {
            let (mut even, mut odd) = (0.0, 0.0);
            for (l, factor) in factors.iter().enumerate() {
                let term = factor * self.legendre[i][l] * self.legendre[j][l];
                if l % 2 == 0 { even += term } else { odd += term }
            }
            [even + odd, even - odd]
        };
        let element = |i: usize, j: usize, forward: bool| {
            let [ahead, back] = phase(i, j);
            half * self.weights[j] * if forward { ahead } else { back }
        };
        let d = SquareMatrix::from_fn(size, |i, j| {
            (f64::from(u8::from(i == j)) - element(i, j, true)) / self.cosines[i]
        });
        let b = SquareMatrix::from_fn(size, |i, j| element(i, j, false) / self.cosines[i]);
        (d, b)
    }
}

/// P_l(μ) for l below a number: with twice the directions as many as a part of the hemisphere integrates without a loss
/// of energy.
fn legendre_polynomials(mu: f64, number: usize) -> Vec<f64> {
    let mut values = vec![1.0, mu];
    for l in 2..number {
        let k = l as f64;
        values.push(((2.0 * k - 1.0) * mu * values[l - 1] - (k - 1.0) * values[l - 2]) / k);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::half_space_surface_albedo;

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

    #[test]
    fn isotropic_half_space_has_its_exact_albedo() {
        for configuration in CONFIGURATIONS {
            let ordinates = DiscreteOrdinates::new(0.0, 1.0, configuration);
            for absorbed in [1e-8_f64, 1e-4, 0.01, 0.1, 0.5, 0.9, 0.999] {
                let found = ordinates.surface_albedo(absorbed);
                let expected = half_space_surface_albedo(1.0 - absorbed, configuration);
                assert!((found / expected - 1.0).abs() < 1e-7, "{configuration:?} {absorbed}: {found}");
            }
        }
    }

    /// A renderer without an interface above does not weigh directions of view by what the boundary passes.
    ///
    /// Error of its mean over them in A, which only strongly backward scattering makes more than a thousandth.
    #[test]
    fn mean_over_views_is_nearly_that_of_what_passes() {
        for (g, allowed) in [(-0.9, 4.5e-3), (-0.5, 1.5e-3), (0.0, 1.5e-3), (0.5, 1.5e-3), (0.9, 1.5e-3)] {
            for eta in [1.05, 1.1, 1.2, 1.4, 3.0] {
                let ordinates = DiscreteOrdinates::new(g, eta, Configuration::Diffuse);
                for absorbed in [1e-4, 0.01, 0.1, 0.2, 0.3, 0.6, 0.9] {
                    let outward = ordinates.outward(&ordinates.reflection(absorbed));
                    let sum = |f: &dyn Fn(usize) -> f64| -> f64 {
                        let term = |i: usize| ordinates.weights[i] * ordinates.cosines[i] * f(i);
                        (0..outward.len()).filter(|i| ordinates.passes[*i] > 0.0).map(term).sum()
                    };
                    let evenly = sum(&|i| outward[i]) / sum(&|_| 1.0);
                    let off = evenly - ordinates.surface_albedo(absorbed);
                    assert!(off.abs() < allowed, "g {g} eta {eta} A {evenly}: {off}");
                }
            }
        }
    }

    /// Light that nothing absorbs leaves in the end, whatever the phase function and the boundary; what absorbs all of it
    /// sends nothing back.
    #[test]
    fn surface_albedo_rises_from_zero_to_one() {
        for (g, eta) in [(-0.9, 1.0), (0.0, 1.0), (0.5, 1.5), (0.95, 1.0), (0.8, 3.0)] {
            for configuration in CONFIGURATIONS {
                let ordinates = DiscreteOrdinates::new(g, eta, configuration);
                assert_eq!(ordinates.surface_albedo(0.0), 1.0);
                let near_white = ordinates.surface_albedo(1e-12);
                assert!(near_white < 1.0 && near_white > 0.9999, "{g} {eta}: {near_white}");
                let mut last = 1.0;
                for i in 1..=20 {
                    let found = ordinates.surface_albedo(f64::from(i) / 20.0);
                    assert!(found < last, "{g} {eta} {i}: {found}");
                    last = found;
                }
                assert_eq!(last, 0.0, "{g} {eta}");
            }
        }
    }
}
