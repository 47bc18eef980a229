//! The formulas of the profile of an oblique beam in units of the mean free path, for one accuracy or another.
//!
//! [`ObliqueDiffusion`](crate::ObliqueDiffusion) explains the model.
//!
//! ```text
//! 2πr R/E = Σ_k w_k λ_k e^{−λ_k r} c_k / (1 − s_k cos φ),      c_k = cos θ_k,  s_k = sin θ_k,  tan θ_k = κ_k tan θ₀
//! w_k = (1 − g) w_k(A) + g W_k(A),  λ_k = λ_k(A) (1 + g ρ_k(A)),  κ_k = t_k(A) + g T_k(A),   g = 1 − √cos θ₀
//! E = A_d (1 − (1 − A_d) Σ_j q_j(A_d) f_j(cos θ₀))
//! ```
//!
//! w_k(A) and λ_k(A) are those of the profile along the normal, A its albedo, A_d that of diffuse light, and f_j have
//! the mean 0 over diffuse light, so that energy is kept whatever the coefficients.

use std::f64::consts::LN_2;

use crate::math::elementary::{Accuracy, exp_negative};
use crate::math::polynomial::polynomial;
use crate::model::oblique::coefficients::{DIFFUSE_ALBEDO, ENERGY, GRAZING_WEIGHTS, RATE_CHANGES, TILTS};
use crate::model::refined;
use crate::{Configuration, RefinedDiffusion};

/// Exponentials of the sum.
pub(crate) const TERMS: usize = RefinedDiffusion::TERMS;
/// Functions of the cosine that the energy's deviations are made of.
const FUNCTIONS: usize = ENERGY.len();
/// cos 85°, the end of the fit: beams that graze more have this shape.
pub(crate) const LEAST_COS_THETA: f64 = 0.087_155_742_747_658_17;

/// The model at one surface albedo, for every angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Family {
    /// Factor that makes E/A_d the energy of the configuration.
    energy: f64,
    /// (1 − A_d) q_j(A_d).
    deviations: [f64; FUNCTIONS],
    weights: [Line; TERMS],
    rates: [Line; TERMS],
    tilts: [Line; TERMS],
}

/// Value along the normal and what grazing incidence adds.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    normal: f64,
    change: f64,
}

impl Line {
    #[inline(always)]
    fn at(self, grazing: f64) -> f64 {
        self.normal + grazing * self.change
    }
}

/// The model at one surface albedo and angle; lengths in mean free paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Terms {
    pub(crate) weights: [f64; TERMS],
    pub(crate) rates: [f64; TERMS],
    /// cos θ_k.
    pub(crate) cosines: [f64; TERMS],
    /// sin θ_k.
    pub(crate) sines: [f64; TERMS],
}

/// From entry to exit, as seen from the entry: the part q of the offset lies along the surface, at the azimuth φ.
///
/// q is 1 on a plane. Elsewhere the density of the azimuth has the eccentricity q sin θ_k: its mean over the azimuth is 1
/// for any q, so that light from everywhere keeps its energy, and where q = 0 it does not depend on what is no azimuth.
#[derive(Clone, Copy)]
pub(crate) struct Way {
    /// 1 − q cos φ.
    pub(crate) versine: f64,
    /// 1 − q².
    pub(crate) lift: f64,
}

impl Family {
    /// Makes the family of a surface albedo in [0, 1], under light that enters in all directions inside a cone around the normal, with a
    /// cosine distribution: `means` is [`means_above`] of the cone's cosine. (For the searchlight the cone does not
    /// matter.)
    #[inline]
    pub(crate) fn new(surface_albedo: f64, configuration: Configuration, means: [f64; FUNCTIONS]) -> Self {
        let diffuse = match configuration {
            Configuration::Searchlight => {
                let a = surface_albedo;
                (a * (1.0 + (1.0 - a) * polynomial(&DIFFUSE_ALBEDO, a))).min(1.0)
            }
            Configuration::Diffuse => surface_albedo,
        };
        let deviations = ENERGY.each_ref().map(|row| (1.0 - diffuse) * polynomial(row, diffuse));
        let relative = |functions: [f64; FUNCTIONS]| 1.0 - dot(deviations, functions);
        let along_normal = relative(functions(1.0));
        let (energy, a) = match configuration {
            Configuration::Searchlight => (surface_albedo / along_normal, surface_albedo),
            Configuration::Diffuse => {
                (surface_albedo / relative(means), (diffuse * along_normal).max(0.0).min(1.0))
            }
        };
        let (weights, rates) = refined::terms(a, Configuration::Searchlight);
        let [first, second, third] = GRAZING_WEIGHTS.each_ref().map(|row| polynomial(row, a));
        let at_grazing = [first, second, third, 1.0 - first - second - third];
        let change = |k: usize| if k == 0 { 0.0 } else { polynomial(&RATE_CHANGES[k - 1], a) };
        Self {
            energy,
            deviations,
            weights: std::array::from_fn(|k| Line { normal: weights[k], change: at_grazing[k] - weights[k] }),
            rates: std::array::from_fn(|k| Line { normal: rates[k], change: rates[k] * change(k) }),
            tilts: TILTS.each_ref().map(|[normal, change]| Line {
                normal: polynomial(normal, a),
                change: polynomial(change, a),
            }),
        }
    }

    /// Energy of light at a cosine.
    #[inline(always)]
    pub(crate) fn total(&self, cos_theta: f64) -> f64 {
        (self.energy * (1.0 - dot(self.deviations, functions(cos_theta)))).max(0.0).min(1.0)
    }

    /// The terms at a cosine.
    #[inline(always)]
    pub(crate) fn terms(&self, cos_theta: f64) -> Terms {
        let cos_theta = cos_theta.max(LEAST_COS_THETA).min(1.0);
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
        let grazing = 1.0 - cos_theta.sqrt();
        let tilts = self.tilts.map(|tilt| tilt.at(grazing));
        let hypotenuses = tilts.map(|tilt| {
            let opposite = tilt * sin_theta;
            1.0 / (cos_theta * cos_theta + opposite * opposite).sqrt()
        });
        Terms {
            weights: self.weights.map(|weight| weight.at(grazing)),
            rates: self.rates.map(|rate| rate.at(grazing)),
            cosines: hypotenuses.map(|inverse| cos_theta * inverse),
            sines: std::array::from_fn(|k| tilts[k] * sin_theta * hypotenuses[k]),
        }
    }
}

impl Terms {
    /// 2πr R/E at a distance in mean free paths, on the way there.
    #[inline(always)]
    pub(crate) fn pdf_times_turn<P: Accuracy>(&self, r: f64, way: Way) -> f64 {
        self.sum(|k| {
            let (rate, cos, sin) = (self.rates[k], self.cosines[k], self.sines[k]);
            // √(1 − s²q²)/(1 − s q cos φ), with the digits of a beam that grazes
            let around =
                (cos * cos + sin * sin * way.lift).sqrt() / (cos * cos / (1.0 + sin) + sin * way.versine);
            rate * exp_negative::<P>(rate * r).0 * around
        })
    }

    /// Σ w_k f(k).
    #[inline(always)]
    pub(crate) fn sum(&self, f: impl Fn(usize) -> f64) -> f64 {
        let [a, b, c, d] = std::array::from_fn(|k| self.weights[k] * f(k));
        (a + b) + (c + d)
    }
}

/// f_j(μ): μ ln(1 + 1/μ), μ and μ² less their means over diffuse light, 2∫ f μ dμ.
#[inline(always)]
fn functions(mu: f64) -> [f64; FUNCTIONS] {
    let log = if mu > 0.0 { mu * libm::log1p(1.0 / mu) } else { 0.0 };
    [log - (4.0 * LN_2 - 1.0) / 3.0, mu - 2.0 / 3.0, mu * mu - 0.5]
}

/// Means of f_j over light whose cosine to the normal is above one in [0, 1), ∫ f μ dμ / ∫ μ dμ.
pub(crate) fn means_above(least: f64) -> [f64; FUNCTIONS] {
    // With ∫ μ² ln(1 + 1/μ) dμ = [μ³ ln(1 + 1/μ) + μ²/2 − μ + ln(1 + μ)]/3
    let primitive = |mu: f64| {
        let log = if mu > 0.0 { mu.powi(3) * libm::log1p(1.0 / mu) } else { 0.0 };
        [(log + 0.5 * mu * mu - mu + libm::log1p(mu)) / 3.0, mu.powi(3) / 3.0, mu.powi(4) / 4.0]
    };
    let share = 0.5 * (1.0 - least) * (1.0 + least);
    let [upper, lower] = [primitive(1.0), primitive(least)];
    let means = [(4.0 * LN_2 - 1.0) / 3.0, 2.0 / 3.0, 0.5];
    std::array::from_fn(|j| (upper[j] - lower[j]) / share - means[j])
}

#[inline(always)]
fn dot(a: [f64; FUNCTIONS], b: [f64; FUNCTIONS]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::quadrature::{gauss_legendre, integrate};

    #[test]
    fn functions_have_their_means() {
        let rule = gauss_legendre(64);
        for least in [0.0, 0.1, 0.7, 0.99] {
            let means = means_above(least);
            for (j, mean) in means.into_iter().enumerate() {
                // μ = least + (1 − least) w³, as μ² ln μ is not smooth
                let value = |w: f64| {
                    let mu = least + (1.0 - least) * w.powi(3);
                    functions(mu)[j] * mu * 3.0 * w * w * (1.0 - least)
                };
                let expected = integrate(&rule, 0.0, 1.0, value) / (0.5 * (1.0 - least * least));
                assert!((mean - expected).abs() < 1e-10, "{least} {j}: {mean} {expected}");
            }
        }
        assert!(means_above(0.0).iter().all(|mean| mean.abs() < 1e-15));
    }

    /// Weights are shares, and no rate is below the slowest of the profile along the normal: the quotient of the two
    /// profiles is bounded.
    #[test]
    fn terms_are_shares_that_reach_no_farther_than_those_along_the_normal() {
        for i in 0..=2000 {
            let a = f64::from(i) / 2e3;
            let family = Family::new(a, Configuration::Searchlight, means_above(0.0));
            let (_, normal) = refined::terms(a, Configuration::Searchlight);
            for j in 0..=50 {
                let terms = family.terms(f64::from(j) / 50.0);
                assert!((terms.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                assert!(terms.weights.iter().all(|weight| *weight > 0.0), "{a} {j}: {terms:?}");
                assert_eq!(terms.rates[0], normal[0]);
                assert!(terms.rates.iter().all(|rate| *rate >= normal[0]), "{a} {j}: {terms:?}");
                assert!(family.tilts.iter().all(|tilt| tilt.at(f64::from(j) / 50.0 * 0.7) > 0.0), "{a} {j}");
                for (cos, sin) in terms.cosines.into_iter().zip(terms.sines) {
                    assert!(cos > 0.0 && (cos * cos + sin * sin - 1.0).abs() < 1e-14, "{a} {j}: {terms:?}");
                }
            }
        }
    }
}
