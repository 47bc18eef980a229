//! Single scattering of photon beam diffusion: light that is scattered once on its way from the beam to the surface.

use std::f64::consts::PI;

use super::require_eta;
use crate::math::elementary::{Single, exp_negative};
use crate::{Medium, ParameterError, Profile, fresnel_from_inside};

/// Steps of the trapezoidal rule in ln(σ − σ₀) for each unit.
const STEPS_PER_UNIT: f64 = 2.5;
/// The rule's range: what lies below e^−18 counts for r > 1e4 only, what lies above e^20 is 2e-9 of r R₁ at r = 0.
const STEPS: std::ops::RangeInclusive<i32> = -45..=50;
/// e^{−x} is nothing beyond.
const EXPONENT_MAX: f64 = 30.0;

/// Light scattered exactly once, for a pencil beam along the normal, by the phase function of Henyey and
/// Greenstein: exact.
///
/// ```text
/// R₁(r) = ∫ σ_s e^{−σ_t (t + d)} p(−μ) T(μ) μ/d² dt,   d² = r² + t²,   μ = t/d
/// ```
///
/// T = 1 − F is what the boundary transmits from inside; t starts at r √(η² − 1) where η > 1.
/// The medium's own quantities count, not the reduced ones.
///
/// R₁ grows like 1/r; 8 digits are right at every radius up to 100 mean free paths.
///
/// # Method
/// In mean free paths and over the length of the way in units of the radius, σ = (t + d)/r, the integral is a Laplace
/// transform, whose integrals over the plane are elementary:
///
/// ```text
/// R₁(r)       = α/4πr ∫ f(σ) e^{−rσ} dσ,     f(σ) = 4πp(−μ) T(μ) μ 2/(σ² + 1),     μ = (σ² − 1)/(σ² + 1)
/// beyond(r)   = α/2 ∫ f(σ)/σ e^{−rσ} dσ
/// ```
///
/// σ begins at 1, or at σ₀ = η + √(η² − 1) where the boundary ceases to reflect all light (η > 1).
/// All other singularities of f lie at least a right angle away from the path of σ as seen from there, whatever η and g;
/// so the trapezoidal rule in ln(σ − σ₀) converges like e^{−π²/step}.
#[derive(Clone, Debug)]
pub struct BeamSingleScattering {
    single_scattering_albedo: f64,
    mfp: f64,
    ways: Ways,
}

impl BeamSingleScattering {
    /// Single scattering in a medium under a boundary of relative index η = n_inside/n_outside ∈ [0.5, 3].
    ///
    /// # Errors
    /// η is outside its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self::of(medium, Ways::new(medium.g(), require_eta(eta)?)))
    }

    pub(super) fn of(medium: &Medium, ways: Ways) -> Self {
        Self { single_scattering_albedo: medium.single_scattering_albedo(), mfp: medium.mfp(), ways }
    }

    /// r in mean free paths, not negative.
    fn relative(&self, r: f64) -> f64 {
        (r.max(0.0) / self.mfp).min(f64::MAX)
    }
}

impl Profile for BeamSingleScattering {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = self.relative(r);
        let sum = self.ways.sum(EXPONENT_MAX / r, |sigma| sigma * exp_negative::<Single>(r * sigma).0);
        (self.single_scattering_albedo / (4.0 * PI) * sum / self.mfp).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let r = self.relative(r);
        let share = self.ways.sum(f64::INFINITY, |sigma| exp_negative::<Single>(r * sigma).1);
        0.5 * self.single_scattering_albedo * share
    }

    fn beyond(&self, r: f64) -> f64 {
        let r = self.relative(r);
        let share = self.ways.sum(EXPONENT_MAX / r, |sigma| exp_negative::<Single>(r * sigma).0);
        0.5 * self.single_scattering_albedo * share
    }

    fn surface_albedo(&self) -> f64 {
        self.single_scattering_albedo * self.ways.total()
    }

    /// The mean free path.
    fn scale(&self) -> f64 {
        self.mfp
    }
}

/// Lengths of ways in units of r, and how much light takes each.
#[derive(Clone, Debug)]
pub(super) struct Ways {
    /// σ.
    lengths: [f64; WAYS],
    /// f dσ/σ.
    weights: [f64; WAYS],
}

/// Number of ways.
const WAYS: usize = (*STEPS.end() - *STEPS.start() + 1) as usize;

impl Ways {
    /// The ways in a medium of mean cosine g ∈ (−1, 1) under a boundary η.
    pub(super) fn new(g: f64, eta: f64) -> Self {
        let first = if eta > 1.0 { eta + ((eta - 1.0) * (eta + 1.0)).sqrt() } else { 1.0 };
        let (mut lengths, mut weights) = ([0.0; WAYS], [0.0; WAYS]);
        for ((step, sigma), weight) in STEPS.zip(&mut lengths).zip(&mut weights) {
            let excess = libm::exp(f64::from(step) / STEPS_PER_UNIT);
            *sigma = first + excess;

            // Compute the cosine of the exit from σ − 1 with its digits, and 1 − μ
            let past_one = (first - 1.0) + excess;
            let scale = 1.0 / (*sigma * *sigma + 1.0);
            let (mu, gap) = ((past_one * (past_one + 2.0) * scale).min(1.0), 2.0 * scale);

            // Scatter: 4πp = (1 − g²)/(1 + g² + 2gμ)^{3/2}
            let square = (1.0 + g) * (1.0 + g) - 2.0 * g * gap;
            let phase = (1.0 - g) * (1.0 + g) / (square * square.sqrt());

            // Pass the boundary
            let passed = 1.0 - fresnel_from_inside(mu, eta);
            *weight = phase * passed * mu * 2.0 * scale * excess / (STEPS_PER_UNIT * *sigma);
        }
        Self { lengths, weights }
    }

    /// ∫ f/σ kernel(σ) dσ over the ways that exceed the shortest by less than `excess_max`.
    fn sum(&self, excess_max: f64, kernel: impl Fn(f64) -> f64) -> f64 {
        let count = self.lengths.partition_point(|sigma| sigma - self.lengths[0] < excess_max);
        let ways = self.lengths[..count].iter().zip(&self.weights);
        ways.map(|(sigma, weight)| weight * kernel(*sigma)).sum()
    }

    /// Energy for α = 1.
    pub(super) fn total(&self) -> f64 {
        0.5 * self.weights.iter().sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::{gauss_legendre, integrate};

    fn single(g: f64, eta: f64) -> BeamSingleScattering {
        let medium = Medium::from_mfp(0.8, 1.0, g).expect("valid");
        BeamSingleScattering::from_medium(&medium, eta).expect("valid")
    }

    /// 2πα ∫₀¹ T(μ) p(−μ) μ/(1 + μ) (1 − e^{−r √((1 + μ)/(1 − μ))}) dμ, with μ from the critical angle on.
    fn enclosed_by_exits(g: f64, eta: f64, r: f64) -> f64 {
        let rule = gauss_legendre(60);
        let critical = (1.0 - 1.0 / (eta * eta)).max(0.0).sqrt();
        let over = |from: f64, to: f64, complement: &dyn Fn(f64) -> (f64, f64)| {
            integrate(&rule, from, to, |x| {
                let (gap, slope) = complement(x);
                let mu = 1.0 - gap;
                let phase = (1.0 - g * g) / (1.0 + g * g + 2.0 * g * mu).powf(1.5);
                let within = -(-r * ((2.0 - gap) / gap).sqrt()).exp_m1();
                0.4 * (1.0 - fresnel_from_inside(mu, eta)) * phase * mu / (1.0 + mu) * within * slope
            })
        };
        // 1 − μ is x⁴ near 0 and (1 − μ_c) − x² near the critical angle
        let middle = 0.5 * (1.0 - critical);
        over(0.0, middle.powf(0.25), &|x| (x.powi(4), 4.0 * x.powi(3)))
            + over(0.0, middle.sqrt(), &|x| (2.0 * middle - x * x, 2.0 * x))
    }

    #[test]
    fn enclosed_matches_the_integral_over_exits() {
        for eta in [0.6, 1.0, 1.1, 1.4, 3.0] {
            for g in [-0.7, 0.0, 0.5, 0.9] {
                for r in [1e-3, 0.1, 1.0, 10.0] {
                    let (found, expected) = (single(g, eta).enclosed(r), enclosed_by_exits(g, eta, r));
                    let off = (found / expected - 1.0).abs();
                    assert!(off < 1e-8, "{eta} {g} {r}: {found} {expected} {off:e}");
                }
            }
        }
    }

    #[test]
    fn total_without_a_boundary_is_elementary() {
        let expected = 0.4 * (1.0 - std::f64::consts::LN_2);
        assert!((single(0.0, 1.0).surface_albedo() / expected - 1.0).abs() < 1e-8);
    }

    #[test]
    fn energies_sum_to_the_total() {
        for (g, eta) in [(0.0, 1.0), (0.9, 1.4), (-0.9, 0.7), (0.999999, 1.0), (-0.999999, 1.0)] {
            let single = single(g, eta);
            for r in [1e-300, 1e-9, 0.01, 1.0, 30.0] {
                let sum = single.enclosed(r) + single.beyond(r);
                assert!((sum / single.surface_albedo() - 1.0).abs() < 1e-8, "{g} {eta} {r}: {sum}");
            }
        }
    }
}
