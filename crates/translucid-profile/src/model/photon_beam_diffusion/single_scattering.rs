//! Light that is scattered once on its way from a beam to the surface.
//!
//! At the length t along the beam a part σ_s e^{−σ_t t} dt is scattered, and reaches the exit over the distance
//! D with the cosine μ = t cos θ/D. In mean free paths, with t = r w and D = r d,
//!
//! ```text
//! R₁ = (α/r) ∫ p T(μ) cos θ w/d³ e^{−r (w + d)} dw,   d² = 1 − 2wS + w²,   μ = w cos θ/d
//! ```
//!
//! S being the cosine between beam and exit as seen from the entry, T what the boundary lets out, p the phase
//! function of the angle whose cosine is (S − w)/d. That is a Laplace transform over σ = w + d, the length of
//! the way:
//!
//! ```text
//! R₁ = (α/4πr) ∫ f(σ) e^{−rσ} dσ,   f = 4πp T cos θ w/(d² q),   q = σ − S,
//! w = (σ − 1)(σ + 1)/2q,   d = (q + (1 − S²)/q)/2
//! ```
//!
//! (R. Habel et al. 2013 have it over t.) σ begins at 1, or where the boundary ceases to reflect all
//! light (η > 1; along the normal t = r√(η² − 1)).
//! All other singularities of f lie at least a right angle away from the path of σ as seen from there, whatever
//! η, g and the direction; so the trapezoidal rule in the logarithm of σ − σ_first converges like e^{−π²/step}.

use std::f64::consts::PI;

use super::beam_dipole::dot;
use super::require_eta;
use crate::math::elementary::{Double, exp_negative};
use crate::math::slices::{Elementwise, map_slice};
use crate::{Medium, ParameterError, Profile, fresnel_from_inside};

/// Steps of the trapezoidal rule in ln(σ − σ_first) for each unit: 1e-12 of R₁ at r = 50, less at smaller radii.
const STEPS_PER_UNIT: f64 = 4.0;
/// The rule's range: what lies below e^−24 counts for r > 1e4 only, what lies above e^27 is 4e-12 of R₁ at r = 0.
const STEPS: std::ops::RangeInclusive<i32> = -96..=108;
/// e^{−x} is nothing beyond.
const EXPONENT_MAX: f64 = 38.0;

/// The phase function of Henyey and Greenstein, 4πp = (1 − g²)/(1 + g² − 2g cos Θ)^{3/2}.
#[derive(Clone, Copy, Debug)]
pub(super) struct HenyeyGreenstein {
    g: f64,
}

impl HenyeyGreenstein {
    pub(super) fn new(g: f64) -> Self {
        Self { g }
    }

    /// 4πp from 1 − cos Θ and 1 + cos Θ, so that no digits are lost where it is steep.
    fn value(self, less: f64, more: f64) -> f64 {
        let g = self.g;
        let square =
            if g > 0.0 { (1.0 - g).powi(2) + 2.0 * g * less } else { (1.0 + g).powi(2) - 2.0 * g * more };
        (1.0 - g) * (1.0 + g) / (square * square.sqrt())
    }
}

/// A beam and the exit that its light is scattered to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattering {
    pub(super) eta: f64,
    pub(super) phase: HenyeyGreenstein,
    /// Cosine of the beam to the normal, inside.
    pub(super) cos_theta: f64,
    /// 1 − S and 1 + S.
    pub(super) gap: f64,
    pub(super) sum: f64,
}

impl Scattering {
    /// r R₁ in 1/mfp for α = 1, r > 0 in mean free paths.
    pub(super) fn eval_times_r(&self, r: f64) -> f64 {
        let Some(first) = self.first() else { return 0.0 };
        let mut sum = 0.0;
        let least = exp_negative::<Double>(r * first).0;
        let last = (STEPS_PER_UNIT * (EXPONENT_MAX / r).ln()).min(f64::from(*STEPS.end())) as i32;
        if least > 0.0 {
            self.for_each(first, *STEPS.start()..=last, |y, weight| {
                sum += weight * exp_negative::<Double>(r * y).0;
            });
        }
        least * sum / (4.0 * PI)
    }

    /// The least σ; `None` if no light gets out.
    fn first(&self) -> Option<f64> {
        let Self { eta, cos_theta, gap, sum, .. } = *self;
        if eta <= 1.0 {
            return Some(1.0);
        }
        // w cos θ/d = μ_c
        let shift = 0.5 * (sum - gap);
        let critical = (eta - 1.0) * (eta + 1.0) / (eta * eta);
        let margin = (cos_theta * cos_theta - critical).max(0.0);
        let denominator = critical * shift + (critical * (critical * shift * shift + margin)).sqrt();
        let w = critical / denominator;
        let d = ((w - shift).powi(2) + gap * sum).sqrt();
        (denominator > 1e-12 * critical).then_some(w + d)
    }

    /// Calls back with σ − σ_first and f dσ.
    fn for_each(&self, first: f64, steps: std::ops::RangeInclusive<i32>, mut call: impl FnMut(f64, f64)) {
        for step in steps {
            let y = (f64::from(step) / STEPS_PER_UNIT).exp();
            call(y, self.density(first, y) * y / STEPS_PER_UNIT);
        }
    }

    /// f at σ = first + y.
    fn density(&self, first: f64, y: f64) -> f64 {
        let past_one = (first - 1.0) + y;
        let q = past_one + self.gap;
        let opposite = self.gap * self.sum / q;
        let (w, d) = (0.5 * past_one * (past_one + 2.0) / q, 0.5 * (q + opposite));
        let mu = (self.cos_theta * w / d).min(1.0);
        // 1 + (w − S)/d and 1 − (w − S)/d
        let (less, more) = (2.0 * q / (q + opposite), 2.0 * opposite / (q + opposite));
        let passed = 1.0 - fresnel_from_inside(mu, self.eta);
        self.phase.value(less, more) * passed * self.cos_theta * w / (d * d * q)
    }
}

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
/// R₁ grows like 1/r; 12 digits are right at every radius up to 1e3 mean free paths.
#[derive(Clone, Debug)]
pub struct BeamSingleScattering {
    single_scattering_albedo: f64,
    mfp: f64,
    ways: Ways,
}

/// Lengths of ways in units of r, and how much goes each.
#[derive(Clone, Debug)]
pub(super) struct Ways {
    /// Least σ.
    first: f64,
    /// σ − first, rising.
    excess: Vec<f64>,
    /// f dσ
    weights: Vec<f64>,
    /// f/σ dσ, and the sums from each on
    weights_of_energy: Vec<f64>,
    energies_from: Vec<f64>,
    /// ½ ∫ f/σ dσ: the total for α = 1.
    pub(super) total: f64,
}

impl Ways {
    pub(super) fn along_the_normal(g: f64, eta: f64) -> Self {
        let phase = HenyeyGreenstein::new(g);
        let scattering = Scattering { eta, phase, cos_theta: 1.0, gap: 1.0, sum: 1.0 };
        let first = scattering.first().unwrap_or(f64::MAX);
        let (mut excess, mut weights) = (Vec::new(), Vec::new());
        scattering.for_each(first, STEPS, |y, weight| {
            excess.push(y);
            weights.push(weight);
        });
        let weights_of_energy: Vec<f64> = excess.iter().zip(&weights).map(|(y, w)| w / (first + y)).collect();
        let mut energies_from = vec![0.0; excess.len() + 1];
        for (i, weight) in weights_of_energy.iter().enumerate().rev() {
            energies_from[i] = energies_from[i + 1] + weight;
        }
        let total = 0.5 * energies_from[0];
        Self { first, excess, weights, weights_of_energy, energies_from, total }
    }

    /// How many ways have an excess less than that.
    fn count(&self, excess_max: f64) -> usize {
        self.excess.partition_point(|y| *y < excess_max)
    }

    /// Σ weight × kernel(σ − first) over the ways that come first.
    fn sum(&self, weights: &[f64], count: usize, kernel: impl Elementwise<f64>) -> f64 {
        let mut terms = [0.0; WAYS];
        let terms = &mut terms[..count];
        map_slice(&self.excess[..count], terms, kernel);
        dot(&weights[..count], terms)
    }
}

/// Number of ways.
const WAYS: usize = (*STEPS.end() - *STEPS.start() + 1) as usize;

/// e^{−ry}
struct Fading {
    r: f64,
}

impl Elementwise<f64> for Fading {
    #[inline(always)]
    fn at(&self, y: f64) -> f64 {
        exp_negative::<Double>(self.r * y).0
    }
}

/// 1 − e^{−r (first + y)}
struct Within {
    r: f64,
    first: f64,
}

impl Elementwise<f64> for Within {
    #[inline(always)]
    fn at(&self, y: f64) -> f64 {
        exp_negative::<Double>(self.r * (self.first + y)).1
    }
}

impl BeamSingleScattering {
    /// Of a medium, under a boundary of relative index η = n_inside/n_outside ∈ [0.5, 3].
    ///
    /// # Errors
    /// η is outside its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        require_eta(eta)?;
        Ok(Self::of(medium, Ways::along_the_normal(medium.g(), eta)))
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
        let (least, _) = exp_negative::<Double>(r * self.ways.first);
        let sum = self.ways.sum(&self.ways.weights, self.ways.count(EXPONENT_MAX / r), Fading { r });
        (self.single_scattering_albedo / (4.0 * PI) * least * sum / self.mfp).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let r = self.relative(r);
        // Of the rest all lies within r
        let ways = &self.ways;
        let count = ways.count(EXPONENT_MAX / r - ways.first);
        let near = ways.sum(&ways.weights_of_energy, count, Within { r, first: ways.first });
        0.5 * self.single_scattering_albedo * (near + ways.energies_from[count])
    }

    fn beyond(&self, r: f64) -> f64 {
        let r = self.relative(r);
        let (least, _) = exp_negative::<Double>(r * self.ways.first);
        let sum =
            self.ways.sum(&self.ways.weights_of_energy, self.ways.count(EXPONENT_MAX / r), Fading { r });
        0.5 * self.single_scattering_albedo * least * sum
    }

    fn total(&self) -> f64 {
        self.single_scattering_albedo * self.ways.total
    }

    /// The mean free path.
    fn scale(&self) -> f64 {
        self.mfp
    }

    fn evaluations_to_build(&self) -> u32 {
        WAYS as u32
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
                    assert!(off < 1e-9, "{eta} {g} {r}: {found} {expected} {off:e}");
                }
            }
        }
    }

    #[test]
    fn total_without_a_boundary_is_elementary() {
        let expected = 0.4 * (1.0 - std::f64::consts::LN_2);
        assert!((single(0.0, 1.0).total() / expected - 1.0).abs() < 1e-13);
    }

    #[test]
    fn energies_sum_to_the_total() {
        for (g, eta) in [(0.0, 1.0), (0.9, 1.4), (-0.9, 0.7), (0.999999, 1.0), (-0.999999, 1.0)] {
            let single = single(g, eta);
            for r in [1e-300, 1e-9, 0.01, 1.0, 30.0] {
                let sum = single.enclosed(r) + single.beyond(r);
                assert!((sum / single.total() - 1.0).abs() < 1e-13, "{g} {eta} {r}: {sum}");
            }
        }
    }

    /// The trapezoidal rule against one of half the step.
    #[test]
    fn ways_are_dense_enough() {
        for (g, eta) in [(0.0, 1.0), (0.9, 1.4), (-0.9, 1.0001), (0.5, 0.7), (0.999, 3.0)] {
            let single = single(g, eta);
            let phase = HenyeyGreenstein::new(g);
            let scattering = Scattering { eta, phase, cos_theta: 1.0, gap: 1.0, sum: 1.0 };
            let first = single.ways.first;
            for r in [1e-6, 1e-3, 0.1, 1.0, 5.0, 20.0, 50.0] {
                let term = |step: i32| {
                    let y = (f64::from(step) / (2.0 * STEPS_PER_UNIT)).exp();
                    (-r * y).exp() * scattering.density(first, y) * y / (2.0 * STEPS_PER_UNIT)
                };
                let fine: f64 = (2 * STEPS.start()..=2 * STEPS.end()).map(term).sum();
                let expected = 0.8 / (4.0 * PI) * fine * (-r * first).exp();
                let off = (single.eval_times_r(r) / expected - 1.0).abs();
                assert!(off < 1e-12, "{g} {eta} {r}: {off:e}");
            }
        }
    }
}
