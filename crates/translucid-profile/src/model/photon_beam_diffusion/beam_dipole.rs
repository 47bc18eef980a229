//! Dipoles all along a beam: the integrand of multiple scattering and its quadrature.
//!
//! Lengths are in transport mean free paths 1/σ'_t.
//! At the length t along the beam a dipole has its real source at the depth z = t cos θ and its virtual one at
//! −z − 2z_b; d_r and d_v are their distances from the exit:
//!
//! ```text
//! R(x) = α'²/4π ∫₀^∞ e^{−t} κ { C_φ/D (e^{−s d_r}/d_r − e^{−s d_v}/d_v)
//!                             + C_E [z (1 + s d_r) e^{−s d_r}/d_r³ + (z + 2z_b)(1 + s d_v) e^{−s d_v}/d_v³] } dt
//! κ = 1 − e^{−2(t + d_r)}
//! ```
//!
//! with s = σ_tr. Near the exit all of it varies on the scale of d_r, which is what y in t' = d_r takes away:
//! with S the cosine between the beam and the way to the exit, as seen from the entry,
//!
//! ```text
//! t = r/2 [(1 − S)(e^y − 1) + (1 + S)(1 − e^{−y})],   d_r = r/2 [(1 − S) e^y + (1 + S) e^{−y}]
//! ```
//!
//! (t = r sinh y, d_r = r cosh y along the normal), so that 24 to 60 Gauss–Legendre points give 11 digits along
//! the normal for all radii, and 9 digits for an oblique beam, which is cut where it passes the exit.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::Medium;
use crate::math::elementary::{Double, exp_negative};
use crate::math::quadrature::gauss_legendre;
use crate::math::slices::{Elementwise, map_slice};
use crate::medium::diffusion_boundary::DiffusionBoundary;

/// The beam is followed until e^{−t} is 2e-15 of what it is where it passes the exit.
const LENGTH: f64 = 34.0;
/// Below this radius R(r) is its logarithm.
pub(super) const R_MIN: f64 = 1e-10;
/// Above this radius R(r) is no more computed.
pub(super) const R_MAX: f64 = 1e100;

/// A medium and its boundary, as dipoles see them.
#[derive(Clone, Copy, Debug)]
pub(super) struct BeamDipole {
    /// α'²
    pub(super) alpha_squared: f64,
    /// s = σ_tr/σ'_t
    pub(super) sigma_tr: f64,
    /// z_b = 2AD
    pub(super) z_b: f64,
    /// C_φ/D
    pub(super) fluence_weight: f64,
    /// C_E
    pub(super) flux_weight: f64,
}

impl BeamDipole {
    /// Of a medium under a boundary.
    pub(super) fn of_medium(medium: &Medium, boundary: &DiffusionBoundary) -> Self {
        Self::new(medium.alpha_prime(), medium.sigma_a() / medium.sigma_t_prime(), boundary)
    }

    /// Of α' and 1 − α', each with its digits, with Grosjean's D = (1 + (1 − α'))/3.
    pub(super) fn new(alpha_prime: f64, absorbed: f64, boundary: &DiffusionBoundary) -> Self {
        let diffusion_coefficient = (1.0 + absorbed) / 3.0;
        Self {
            alpha_squared: alpha_prime * alpha_prime,
            sigma_tr: (absorbed / diffusion_coefficient).sqrt(),
            z_b: 2.0 * boundary.mismatch * diffusion_coefficient,
            fluence_weight: boundary.fluence / diffusion_coefficient,
            flux_weight: boundary.flux,
        }
    }

    /// R at an exit, in σ'_t².
    pub(super) fn eval(&self, exit: Exit) -> f64 {
        let near = R_MIN.max(exit.r);
        let stretches = Way::stretches(Exit { r: near.min(R_MAX), ..exit }, self.sigma_tr);
        let sum = stretches.map(|way| way.integrate(Reflectance(Beam { dipole: *self, way })));
        let value = self.alpha_squared / (4.0 * PI) * (sum[0] + sum[1]);
        // Both sources near the exit leave a logarithm, 4 C_E cos θ ∫ dt/t
        let logarithm = (near / exit.r.max(f64::MIN_POSITIVE)).ln();
        value + logarithm * self.logarithm(exit.cos_theta)
    }

    /// Slope of R(r) over ln(1/r) at r = 0: with κ ≈ 2(t + d_r) the flux of the real source goes like 4z/t²
    /// where t ≫ r.
    pub(super) fn logarithm(&self, cos_theta: f64) -> f64 {
        self.alpha_squared / PI * self.flux_weight * cos_theta
    }

    /// What the dipole at the length t and the depth z sends to an exit at the distance d_r, times d_r = dt/dy,
    /// less α'²/4π.
    #[inline(always)]
    pub(super) fn reflectance_times_distance(&self, t: f64, z: f64, d_r: f64) -> f64 {
        let Self { sigma_tr: s, z_b, fluence_weight, flux_weight, .. } = *self;

        // The virtual source is farther by `farther`, which keeps the digits of the difference of the two
        let d_v = (d_r * d_r + 4.0 * z_b * (z + z_b)).sqrt();
        let farther = 4.0 * z_b * (z + z_b) / (d_v + d_r);
        let (fades, faded) = exp_negative::<Double>(s * farther);
        let (arrives, _) = exp_negative::<Double>(t + s * d_r);
        let (_, kappa) = exp_negative::<Double>(2.0 * (t + d_r));

        // Fluence and flux
        let (inverse_r, inverse_v) = (1.0 / d_r, 1.0 / d_v);
        let fluence = faded + fades * farther * inverse_v;
        let real = z * (1.0 + s * d_r) * inverse_r * inverse_r;
        let virtual_ =
            (z + 2.0 * z_b) * (1.0 + s * d_v) * fades * (inverse_v * inverse_v) * (d_r * inverse_v);
        arrives * kappa * (fluence_weight * fluence + flux_weight * (real + virtual_))
    }

    /// How many dipoles [`eval`](Self::eval) takes along the normal.
    pub(super) fn points(r: f64) -> u32 {
        UnitRule::for_length(Way::y_max(Exit::along_the_normal(r), 0.0)).positions.len() as u32
    }

    /// ∫_r^∞ R 2πr' dr' along the normal without κ; for r > 18, where κ = 1 to 16 digits.
    pub(super) fn beyond_without_kappa(&self, r: f64) -> f64 {
        let [way, _] = Way::stretches(Exit::along_the_normal(r.min(R_MAX)), self.sigma_tr);
        0.5 * self.alpha_squared * way.integrate(Beyond(Beam { dipole: *self, way }))
    }
}

/// Where light leaves, as seen from the point of entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exit {
    /// Distance along the surface, greater than 0.
    pub(super) r: f64,
    /// 1 − S, S the cosine between the beam and the way to the exit.
    pub(super) gap: f64,
    /// 1 + S
    pub(super) sum: f64,
    /// Cosine of the beam to the normal, inside.
    pub(super) cos_theta: f64,
}

impl Exit {
    pub(super) fn along_the_normal(r: f64) -> Self {
        Self { r, gap: 1.0, sum: 1.0, cos_theta: 1.0 }
    }
}

/// A stretch of the beam in the variable y.
#[derive(Clone, Copy, Debug)]
struct Way {
    half_r: f64,
    gap: f64,
    sum: f64,
    cos_theta: f64,
    start: f64,
    length: f64,
}

impl Way {
    /// The beam up to where it passes the exit most closely, if that is far, and beyond.
    fn stretches(exit: Exit, sigma_tr: f64) -> [Self; 2] {
        let Exit { r, gap, sum, cos_theta } = exit;
        let y_max = Self::y_max(exit, sigma_tr);
        let nearest = if sum > gap { 0.5 * (sum / gap).ln() } else { 0.0 };
        let middle = if nearest > 1.0 { nearest.min(y_max) } else { y_max };
        let first = Self { half_r: 0.5 * r, gap, sum, cos_theta, start: 0.0, length: middle };
        [first, Self { start: middle, length: y_max - middle, ..first }]
    }

    /// y where e^{−t − s d_r} no more counts: d_r falls by S for each t at most, and grows from t = rS on.
    fn y_max(exit: Exit, sigma_tr: f64) -> f64 {
        let Exit { r, gap, sum, .. } = exit;
        let shift = (0.5 * (sum - gap)).max(0.0);
        let decay = 1.0 - sigma_tr * shift;
        let t_max = LENGTH + if decay > 0.0 { (LENGTH / decay - LENGTH).min(r * shift) } else { r * shift };

        // Solve t = t_max for e^y − 1, in the form that does not cancel
        let twice = 2.0 * t_max / r;
        let slope = sum + gap - twice;
        let root = (slope * slope + 4.0 * gap * twice).sqrt();
        let growth = if slope > 0.0 { 2.0 * twice / (slope + root) } else { (root - slope) / (2.0 * gap) };
        growth.ln_1p()
    }

    /// ∫ f dy, f given over the share of the stretch.
    #[inline(always)]
    fn integrate(&self, integrand: impl Elementwise<f64>) -> f64 {
        if self.length <= 0.0 {
            return 0.0;
        }
        let rule = UnitRule::for_length(self.length);
        let mut terms = [0.0; UnitRule::MAX];
        let terms = &mut terms[..rule.positions.len()];
        map_slice(&rule.positions, terms, integrand);
        self.length * dot(&rule.weights, terms)
    }

    /// t, d_r at a share of the stretch.
    #[inline(always)]
    fn at(&self, x: f64) -> (f64, f64) {
        let (e, complement) = exp_negative::<Double>(self.start + self.length * x);
        let ahead = self.gap / e;
        (self.half_r * complement * (ahead + self.sum), self.half_r * (ahead + self.sum * e))
    }
}

/// A dipole at every y.
#[derive(Clone, Copy)]
struct Beam {
    dipole: BeamDipole,
    way: Way,
}

/// Integrand of R(r), less α'²/4π.
struct Reflectance(Beam);

impl Elementwise<f64> for Reflectance {
    #[inline(always)]
    fn at(&self, x: f64) -> f64 {
        let Beam { dipole, way } = self.0;
        let (t, d_r) = way.at(x);
        dipole.reflectance_times_distance(t, t * way.cos_theta, d_r)
    }
}

/// Integrand of the energy beyond r without κ, less α'²/2: ∫ e^{−s d}/d r dr = e^{−s d}/s, and of the flux z
/// e^{−s d}/d.
struct Beyond(Beam);

impl Elementwise<f64> for Beyond {
    #[inline(always)]
    fn at(&self, x: f64) -> f64 {
        let Beam { dipole, way } = self.0;
        let BeamDipole { sigma_tr: s, z_b, fluence_weight, flux_weight, .. } = dipole;
        let (t, d_r) = way.at(x);
        let z = t * way.cos_theta;
        let d_v = (d_r * d_r + 4.0 * z_b * (z + z_b)).sqrt();
        let farther = 4.0 * z_b * (z + z_b) / (d_v + d_r);
        let (fades, faded) = exp_negative::<Double>(s * farther);
        let (arrives, _) = exp_negative::<Double>(t + s * d_r);
        // (1 − e^{−sΔ})/s, Δ where s = 0
        let fluence = if s * farther > 1e-200 { faded / s } else { farther };
        let flux = z / d_r + (z + 2.0 * z_b) * fades / d_v;
        arrives * d_r * (fluence_weight * fluence + flux_weight * flux)
    }
}

/// Σ a b over slices of one length, in four chains, which do not wait for each other.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    debug_assert_eq!(a.len(), b.len());
    let mut sums = [0.0; 4];
    let (a_chunks, b_chunks) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a_chunks.remainder().iter().zip(b_chunks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_chunks.zip(b_chunks) {
        for i in 0..4 {
            sums[i] += a[i] * b[i];
        }
    }
    rest + ((sums[0] + sums[1]) + (sums[2] + sums[3]))
}

/// A Gauss–Legendre rule on [0, 1].
pub(super) struct UnitRule {
    pub(super) positions: Vec<f64>,
    pub(super) weights: Vec<f64>,
}

impl UnitRule {
    /// Most points of a rule.
    const MAX: usize = 60;

    pub(super) fn new(n: usize) -> Self {
        let rule = gauss_legendre(n);
        Self {
            positions: rule.iter().map(|(x, _)| 0.5 + 0.5 * x).collect(),
            weights: rule.iter().map(|(_, w)| 0.5 * w).collect(),
        }
    }

    /// A rule that integrates along a beam of this length in y to 11 digits.
    fn for_length(y_max: f64) -> &'static Self {
        static RULES: LazyLock<[UnitRule; 5]> = LazyLock::new(|| [24, 32, 40, 48, 60].map(UnitRule::new));
        let index = [5.0, 8.0, 13.0, 19.0].partition_point(|end| *end < y_max);
        &RULES[index]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dipole(absorbed: f64, eta: f64) -> BeamDipole {
        BeamDipole::new(1.0 - absorbed, absorbed, &DiffusionBoundary::new(eta).expect("valid"))
    }

    #[test]
    fn logarithm_goes_on_below_the_least_radius() {
        for (absorbed, eta) in [(0.0, 1.0), (0.3, 1.4), (0.9, 0.6)] {
            let dipole = dipole(absorbed, eta);
            let eval = |r| dipole.eval(Exit::along_the_normal(r));
            let slope = (eval(R_MIN) - eval(2.0 * R_MIN)) / 2.0_f64.ln();
            assert!((slope / dipole.logarithm(1.0) - 1.0).abs() < 1e-8, "{absorbed} {eta}: {slope}");
            assert!((eval(R_MIN * (1.0 - 1e-12)) / eval(R_MIN * (1.0 + 1e-12)) - 1.0).abs() < 1e-11);
        }
    }

    /// Without absorption dipoles of strength t + z_b leave R ~ r^−3 far away: α'²/4π ∫ e^{−t} {C_φ/D 2z_b (t +
    /// z_b) + C_E (2t + 2z_b)} dt = α'²/4π (1 + z_b)(2 z_b C_φ/D + 2 C_E).
    #[test]
    fn eval_far_away_is_that_of_one_dipole() {
        for eta in [0.6, 1.0, 1.4] {
            let dipole = dipole(0.0, eta);
            let BeamDipole { z_b, fluence_weight, flux_weight, .. } = dipole;
            let expected = (1.0 + z_b) * (2.0 * z_b * fluence_weight + 2.0 * flux_weight) / (4.0 * PI);
            for r in [1e8_f64, 1e15] {
                let found = dipole.eval(Exit::along_the_normal(r)) * r.powi(3);
                assert!((found / expected - 1.0).abs() < 1e-12, "{eta} at {r}: {found} {expected}");
            }
        }
    }

    /// Against eight panels of the largest rule.
    #[test]
    fn rules_have_points_enough() {
        let panels = UnitRule::new(UnitRule::MAX);
        for (absorbed, eta) in [(0.0, 1.0), (0.1, 1.4), (0.9, 0.6)] {
            let dipole = dipole(absorbed, eta);
            for (cos_theta, cos_phi) in
                [(1.0, 0.0), (0.5, 1.0), (0.5, -1.0), (0.1, 0.5), (0.087, 1.0), (0.087, -1.0)]
            {
                let sin_theta = f64::sqrt(1.0 - cos_theta * cos_theta);
                for r in [
                    1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 1.0, 5.0, 15.0, 50.0,
                ] {
                    let shift = sin_theta * cos_phi;
                    let exit = Exit { r, gap: 1.0 - shift, sum: 1.0 + shift, cos_theta };
                    let [near, far] = Way::stretches(exit, dipole.sigma_tr);
                    let length = (near.length + far.length) / 8.0;
                    let sum: f64 = (0..8)
                        .map(|panel| Way { start: f64::from(panel) * length, length, ..near })
                        .map(|way| {
                            let integrand = Reflectance(Beam { dipole, way });
                            let terms = panels.positions.iter().map(|x| integrand.at(*x));
                            length * terms.zip(&panels.weights).map(|(a, b)| a * b).sum::<f64>()
                        })
                        .sum();
                    let expected = dipole.alpha_squared / (4.0 * PI) * sum;
                    let off = (dipole.eval(exit) / expected - 1.0).abs();
                    let allowed = if cos_theta == 1.0 { 1e-11 } else { 5e-10 };
                    assert!(off < allowed, "{absorbed} {eta} {cos_theta} {cos_phi} {r}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn dot_is_the_sum_of_products() {
        let numbers: Vec<f64> = (1..=11).map(f64::from).collect();
        assert_eq!(dot(&numbers, &numbers), 506.0);
        assert_eq!(dot(&numbers[..2], &numbers[..2]), 5.0);
    }
}
