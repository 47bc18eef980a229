//! Directions of light on the inner side of the surface, as nodes of quadrature rules in the decay per depth s.
//!
//! At the lateral wave number k light of the direction n = (n_x, n_y, μ), k being along x, decays with depth as
//! e^{−sτ}, s = (1 + q n_x)/μ with q = −ik. For large k and real directions s varies fast, and s + s', by which the
//! equations divide, comes close to 0. Two deformations into complex directions avoid both:
//!
//! 1. *All directions of the hemisphere*, weighed alike. Rotated by an imaginary angle, the hemisphere's directions
//!    of equal s become circles, over which the integrand is constant: with k u = sinh v
//!
//!    ```text
//!    (1/4π) ∫ f(s) dΩ = ½ ∫₀¹ f(s) du,    (1/4π) ∫ f(s)/μ dΩ = ½ ∫₀¹ f(s)/(u√(1 + k²u²)) du,
//!    s = √(k² + 1/u²) = k coth v,    du/(u√(1 + k²u²)) = dv/sinh v
//!    ```
//! 2. *The cone of directions that the boundary lets out*, sin θ < S, weighed with T = 1 − F. It is covered by arcs of
//!    ellipses, which all run from n_x = −S to S,
//!
//!    ```text
//!    n_x = S c,   n_y = S √(1 − c²) sin β,   dn_x dn_y = S² √(1 − c²) cos β dc dβ,   β ∈ (−π/2, π/2)
//!    ```
//!
//!    and are bent into the upper half plane of c between their fixed ends, c = −e^{−iψ}. There all s stay away
//!    from the s' = −s and from the singularities s = −√(k² + λ²) of the H function; at the ends, T and the element
//!    of area vanish. (Chords of equal n_y end on the whole rim of the cone, and converge slowly.) T is the
//!    analytic expression in μ_o = η S cos β √(1 − c²), the cosine outside.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use super::complex::{asinh, sinh_cosh, sqrt};

/// Numbers of points of the rules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DirectionCounts {
    /// For the whole hemisphere.
    pub(crate) hemisphere: usize,
    /// For the cone: arcs with n_y ≥ 0, and points of each.
    pub(crate) arcs: usize,
    pub(crate) arc: usize,
}

/// Nodes of one rule.
#[derive(Clone, Debug, Default)]
pub(crate) struct Directions {
    /// Decay per depth s.
    pub(crate) s: Vec<Complex64>,
    /// Weights of (1/4π) ∫ f dΩ, with T in the cone.
    pub(crate) per_solid_angle: Vec<Complex64>,
    /// Weights of (1/4π) ∫ f/μ dΩ, with T in the cone.
    pub(crate) per_cosine: Vec<Complex64>,
}

impl Directions {
    fn push(&mut self, s: Complex64, per_solid_angle: Complex64, per_cosine: Complex64) {
        self.s.push(s);
        self.per_solid_angle.push(per_solid_angle);
        self.per_cosine.push(per_cosine);
    }

    /// All directions of the hemisphere, weighed alike.
    pub(crate) fn hemisphere(k: Complex64, count: usize) -> Self {
        let mut directions = Self::default();
        // H has terms like u ln u: nodes gather at u = 0
        for (x, weight) in unit_rule(count) {
            let (share, weight) = (x * x * x, 3.0 * x * x * weight);
            if k.norm_sqr() < 1e-12 {
                let [u, du] = [share, weight].map(Complex64::from);
                directions.push(u.inv(), 0.5 * du, 0.5 * du / u);
            } else {
                let end = asinh(k);
                let (v, dv) = (end * share, end * weight);
                let (sinh, cosh) = sinh_cosh(v);
                directions.push(k * cosh / sinh, 0.5 * cosh / k * dv, 0.5 * dv / sinh);
            }
        }
        directions
    }

    /// The cone of directions that get out, weighed with the transmittance.
    pub(crate) fn cone(k: Complex64, eta: f64, counts: DirectionCounts) -> Self {
        let q = -Complex64::I * k;
        let sin_edge = (1.0 / eta).min(1.0);
        let mut directions = Self::default();
        for (x, weight) in unit_rule(counts.arcs) {
            let (beta, d_beta) = (FRAC_PI_2 * x, FRAC_PI_2 * weight);
            let edge = sin_edge * libm::cos(beta);
            for &(x, weight) in &unit_rule(counts.arc) {
                let point = ArcPoint::new(x, weight);
                let end_distance = edge * edge * point.one_minus_square;
                let mu_squared = end_distance + (1.0 - sin_edge) * (1.0 + sin_edge);
                let mu_outside_squared = if eta >= 1.0 {
                    eta * eta * end_distance
                } else {
                    (1.0 - eta) * (1.0 + eta) + eta * eta * end_distance
                };
                let (mu, mu_outside) = (sqrt(mu_squared), sqrt(mu_outside_squared));
                // ±n_y alike; dΩ = dn_x dn_y/μ
                let d_n_y = edge * d_beta * sqrt(point.one_minus_square);
                let solid_angle = 2.0 * d_n_y * sin_edge * point.slope / mu;
                let weight = solid_angle * transmittance(mu, mu_outside, eta) / (4.0 * PI);
                directions.push((1.0 + q * sin_edge * point.position) / mu, weight, weight / mu);
            }
        }
        directions
    }
}

/// Mean over the azimuths φ of a function of n_x = sin θ cos φ that is analytic where the arcs bend: nodes n_x and
/// weights.
pub(crate) fn azimuthal_mean(sin: f64, count: usize) -> Vec<(Complex64, Complex64)> {
    // (1/π) ∫ f dc/√(1 − c²) over the arc
    let node = |(x, weight)| {
        let point = ArcPoint::new(x, weight);
        (sin * point.position, point.slope / sqrt(point.one_minus_square) / PI)
    };
    unit_rule(count).into_iter().map(node).collect()
}

/// A point of the bent arc from −1 to 1.
struct ArcPoint {
    /// c = −e^{−iψ}.
    position: Complex64,
    /// 1 − c², with every digit at the ends.
    one_minus_square: Complex64,
    /// Its part of dc.
    slope: Complex64,
}

impl ArcPoint {
    /// ψ = π x²(3 − 2x): T is smooth in √ψ.
    fn new(x: f64, weight: f64) -> Self {
        let psi = PI * x * x * (3.0 - 2.0 * x);
        let d_psi = PI * 6.0 * x * (1.0 - x) * weight;
        let (sin, cos) = libm::sincos(psi);
        let turned = Complex64::new(cos, -sin);
        Self {
            position: -turned,
            // 1 − e^{−2iψ} = 2i sin ψ e^{−iψ}
            one_minus_square: Complex64::I * turned * (2.0 * sin),
            slope: Complex64::I * turned * d_psi,
        }
    }
}

/// Fresnel's transmittance of unpolarized light between complex directions: with a = η μ, b = μ_o and a = μ, b = η μ_o
/// each polarization passes 4ab/(a + b)².
fn transmittance(mu: Complex64, mu_outside: Complex64, eta: f64) -> Complex64 {
    let perpendicular = eta * mu + mu_outside;
    let parallel = mu + eta * mu_outside;
    let product = 2.0 * eta * mu * mu_outside;
    product / (perpendicular * perpendicular) + product / (parallel * parallel)
}

/// Gauss–Legendre on [0, 1].
pub(crate) fn unit_rule(count: usize) -> Vec<(f64, f64)> {
    gauss_legendre(count).into_iter().map(|(x, weight)| (0.5 + 0.5 * x, 0.5 * weight)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use translucid_profile::fresnel_from_inside;

    const COUNTS: DirectionCounts = DirectionCounts { hemisphere: 28, arcs: 12, arc: 24 };

    /// (1/4π) ∫ weight(μ) f(s) dΩ over real directions, by panels of μ that meet at `edge`.
    fn real_directions(
        k: Complex64,
        weight: impl Fn(f64) -> f64,
        edge: f64,
        f: impl Fn(Complex64) -> Complex64,
    ) -> Complex64 {
        let rule = unit_rule(60);
        let azimuths = 400;
        let mut sum = Complex64::ZERO;
        for (from, to) in [(0.0, edge), (edge, 1.0)] {
            for &(x, w) in &rule {
                let mu = from + (to - from) * x * x;
                let sin = (1.0 - mu * mu).sqrt();
                for j in 0..azimuths {
                    let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(azimuths);
                    let s = (1.0 - Complex64::I * k * (sin * phi.cos())) / mu;
                    sum += f(s) * (weight(mu) * (to - from) * 2.0 * x * w / f64::from(azimuths) / 2.0);
                }
            }
        }
        sum
    }

    #[test]
    fn hemisphere_equals_real_directions() {
        for k in [Complex64::new(0.0, 0.4), Complex64::new(1.0, 0.0), Complex64::new(3.0, 3.4)] {
            let f = |s: Complex64| (s + 2.0).powi(-3);
            let directions = Directions::hemisphere(k, 40);
            let sum = |weights: &[Complex64]| -> Complex64 {
                directions.s.iter().zip(weights).map(|(&s, w)| w * f(s)).sum()
            };
            let expected = real_directions(k, |_| 1.0, 0.5, f);
            let found = sum(&directions.per_solid_angle);
            assert!((found - expected).norm() < 1e-9 * expected.norm(), "{k}: {found} {expected}");
            let expected = real_directions(k, |mu| 1.0 / mu, 0.5, f);
            let found = sum(&directions.per_cosine);
            assert!((found - expected).norm() < 1e-9 * expected.norm(), "{k}: {found} {expected}");
        }
    }

    #[test]
    fn cone_equals_real_directions() {
        for eta in [0.7, 1.2, 1.5] {
            let edge = if eta > 1.0 { (1.0f64 - 1.0 / (eta * eta)).sqrt() } else { 0.3 };
            for k in [Complex64::new(0.0, 0.4), Complex64::new(1.0, 0.0), Complex64::new(3.0, 3.4)] {
                let f = |s: Complex64| (s + 1.0).powi(-2);
                let directions = Directions::cone(k, eta, COUNTS);
                let weights = directions.s.iter().zip(&directions.per_solid_angle);
                let found: Complex64 = weights.map(|(&s, w)| w * f(s)).sum();
                let expected = real_directions(k, |mu| 1.0 - fresnel_from_inside(mu, eta), edge, f);
                let off = (found - expected).norm() / expected.norm();
                assert!(off < 1e-8, "{eta} {k}: {found} {expected} {off:e}");
            }
        }
    }
}
