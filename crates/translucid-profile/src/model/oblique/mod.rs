//! The profile of a beam at any angle: four exponentials, each tilted.

pub(crate) mod coefficients;
pub(crate) mod kernel;
pub(crate) mod single_precision;

use std::f64::consts::PI;

use crate::error::{ParameterError, require_fraction};
use crate::math::elementary::{Double, exp_negative, negative_log};
use crate::model::oblique::kernel::{Family, TERMS, Terms, Way, means_above};
use crate::profile::finite_quotient;
use crate::{Configuration, Parameterization, RefinedDiffusion};

/// Normalized diffusion of an oblique beam: exitance R(r, φ) per unit of flux that has entered, at the distance r from
/// the point of entry and the azimuth φ; φ = 0 is where the beam is tilted to.
///
/// ```text
/// R(r, φ) = E/(2πr) Σ_k w_k λ_k e^{−λ_k r} cos θ_k / (1 − sin θ_k cos φ),      tan θ_k = κ_k tan θ₀
/// ```
///
/// The oblique incidence that P. H. Christensen and B. Burley 2015 leave to the future, as simple as their profile:
/// a sum of exponentials of r, each times a density of the azimuth that integrates to 1.
/// That density is the exact one of light that is scattered once, close to the entry, with θ_k = θ₀; farther terms
/// have been scattered more often and remember less of the direction: κ_k < 1.
/// Weights w_k, rates λ_k and tilts κ_k are those of the profile along the normal ([`RefinedDiffusion`]), changed in
/// proportion to g = 1 − √cos θ₀; all are polynomials of the surface albedo.
/// Along the normal the profile *is* the refined one.
///
/// # Energy
/// E = 1 − H(μ₀)√(1−α), μ₀ = cos θ₀, to within 0.26 % of the albedo A_d of diffuse light for a given A_d, and to within
/// 1 % of A for a given albedo A along the normal; 2∫E μ dμ is A_d to all digits.
/// In the configuration [`Diffuse`](Configuration::Diffuse) A is that albedo; in the configuration
/// [`Searchlight`](Configuration::Searchlight) A is E along the normal.
///
/// # Sampling
/// Both numbers have a closed form: a term by its weight, r = −ln(1 − u)/λ_k, and
/// tan(φ/2) = cos θ_k/(1 + sin θ_k) tan(π(u' − ½)), which also turns Kepler's eccentric anomaly into the true one.
///
/// # Validity
/// Fitted to the exact half space of isotropic scatterers without a boundary (g = 0, η = 1), A ∈ [0, 1] and θ₀ up to
/// 85°; beams that graze more have the shape of 85° and their own energy.
/// θ₀ is the angle *inside* the medium: a boundary refracts the beam before it gets here.
/// The errors ∫|R − R_exact| dA / ∫R dA are in the generated `coefficients.rs` and in `docs/accuracy/oblique.md`.
///
/// A radius that is negative or NaN counts as 0, an azimuth that is no number as 0, and no argument makes a method
/// panic or return a NaN or an infinity.
///
/// ```
/// use std::f64::consts::PI;
/// use translucid_profile::{Configuration, ObliqueDiffusion, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let (mfp, diffuse) = (Parameterization::Mfp, Configuration::Diffuse);
/// let marble = ObliqueDiffusion::new(0.5, 2.0, mfp, diffuse, 0.5)?; // light at 60°
/// assert!(marble.eval(2.0, 0.0) > 4.0 * marble.eval(2.0, PI)); // leaves where it goes to
/// let (r, phi) = marble.sample([0.7, 0.4]); // two random numbers in, a point out
/// assert!((marble.eval(r, phi) / marble.pdf_area(r, phi) - marble.total()).abs() < 1e-14);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "normalized-diffusion-oblique")]
pub struct ObliqueDiffusion {
    surface_albedo: f64,
    mfp: f64,
    cos_theta: f64,
    total: f64,
    /// Rates in L⁻¹.
    terms: Terms,
}

impl ObliqueDiffusion {
    /// Number of exponentials in the sum.
    pub const TERMS: usize = TERMS;

    /// Makes the profile of a surface albedo A ∈ [0, 1], a length \[L\], mean free path or diffuse mean free path as the
    /// parameterization says, and the cosine of the angle θ₀ inside the medium between the beam and the normal, in
    /// [0, 1].
    ///
    /// # Errors
    /// As [`RefinedDiffusion::new`], or the cosine is not in [0, 1].
    pub fn new(
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        configuration: Configuration,
        cos_theta: f64,
    ) -> Result<Self, ParameterError> {
        let normal = RefinedDiffusion::new(surface_albedo, length, parameterization, configuration)?;
        require_fraction("cos_theta", cos_theta)?;
        let family = Family::new(surface_albedo, configuration, means_above(0.0));
        let terms = family.terms(cos_theta);
        let mfp = normal.mfp();
        Ok(Self {
            surface_albedo,
            mfp,
            cos_theta,
            total: family.total(cos_theta),
            terms: Terms { rates: terms.rates.map(|rate| rate / mfp), ..terms },
        })
    }

    /// Surface albedo A of the configuration, dimensionless.
    pub fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// Mean free path ℓ \[L\].
    pub fn mfp(&self) -> f64 {
        self.mfp
    }

    /// Cosine of the angle between beam and normal, inside.
    pub fn cos_theta(&self) -> f64 {
        self.cos_theta
    }

    /// All the energy that leaves, E = ∫ R dA: the surface albedo for this angle.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Weights w_k of the exponentials: shares of the energy, greater than 0 and of sum 1.
    pub fn weights(&self) -> [f64; TERMS] {
        self.terms.weights
    }

    /// Rates λ_k of the exponentials \[L⁻¹\], none below the first.
    pub fn rates(&self) -> [f64; TERMS] {
        self.terms.rates
    }

    /// Eccentricities sin θ_k ∈ [0, 1) of the azimuths: the density at φ = 0 is (1 + sin θ_k)/(1 − sin θ_k) times that at
    /// φ = π.
    pub fn eccentricities(&self) -> [f64; TERMS] {
        self.terms.sines
    }

    /// Profile R(r, φ) \[L⁻²\].
    ///
    /// R grows like 1/r. So that it stays finite, r below the least normal number 2.2e-308 counts as that number and R
    /// above the greatest number as that one; near 0 prefer [`eval_times_r`](Self::eval_times_r).
    pub fn eval(&self, r: f64, phi: f64) -> f64 {
        finite_quotient(self.eval_times_r(r, phi), r)
    }

    /// Profile times radius, r R(r, φ) \[L⁻¹\], which has a limit at r = 0 for each azimuth.
    pub fn eval_times_r(&self, r: f64, phi: f64) -> f64 {
        self.total * self.density_times_r(r, phi)
    }

    /// Density per area p(r, φ) = R/E \[L⁻²\], at r = 0 as [`eval`](Self::eval).
    pub fn pdf_area(&self, r: f64, phi: f64) -> f64 {
        finite_quotient(self.density_times_r(r, phi), r)
    }

    /// Mean of R over the azimuth, E/(2πr) Σ w_k λ_k e^{−λ_k r} \[L⁻²\], at r = 0 as [`eval`](Self::eval).
    pub fn eval_mean(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        let rates = &self.terms.rates;
        let density = self.terms.sum(|k| rates[k] * exp_negative::<Double>(rates[k] * r).0);
        finite_quotient(self.total * density / (2.0 * PI), r)
    }

    /// Energy that leaves within r, over all azimuths: E Σ w_k (1 − e^{−λ_k r}).
    pub fn enclosed(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        self.total * self.terms.sum(|k| exp_negative::<Double>(self.terms.rates[k] * r).1)
    }

    /// Energy that leaves beyond r, over all azimuths: E Σ w_k e^{−λ_k r}.
    pub fn beyond(&self, r: f64) -> f64 {
        let r = r.max(0.0);
        self.total * self.terms.sum(|k| exp_negative::<Double>(self.terms.rates[k] * r).0)
    }

    /// Radius \[L\] and azimuth in [−π, π] of density [`pdf_area`](Self::pdf_area), for two random numbers uniform on
    /// [0, 1).
    ///
    /// The azimuth rises with the second number. Numbers are clamped to [0, 1]; NaN counts as 0.
    pub fn sample(&self, u: [f64; 2]) -> (f64, f64) {
        let [u, turn] = u.map(|u| u.max(0.0).min(1.0));
        let Terms { weights, rates, cosines, sines } = &self.terms;
        let (mut k, mut start) = (0, 0.0);
        while k < TERMS - 1 && u >= start + weights[k] {
            start += weights[k];
            k += 1;
        }
        // The greatest u below a term's end may round up to 1
        let rescaled = ((u - start) / weights[k]).max(0.0).min(1.0 - f64::EPSILON / 2.0);
        let r = negative_log(1.0 - rescaled, rescaled) / rates[k];
        let phi = 2.0 * libm::atan(cosines[k] / (1.0 + sines[k]) * libm::tan(PI * (turn - 0.5)));
        (r, phi)
    }

    /// r R/E.
    fn density_times_r(&self, r: f64, phi: f64) -> f64 {
        let sin_half = if phi.is_finite() { libm::sin(0.5 * phi) } else { 0.0 };
        let way = Way { versine: 2.0 * sin_half * sin_half, lift: 0.0 };
        self.terms.pdf_times_turn::<Double>(r.max(0.0), way) / (2.0 * PI)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::half_space_single_scattering_albedo;
    use crate::math::quadrature::{gauss_legendre, integrate};

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
    const COSINES: [f64; 6] = [0.0, 1e-9, 0.1, 0.5, 0.9, 1.0];

    fn profile(
        surface_albedo: f64,
        mfp: f64,
        configuration: Configuration,
        cos_theta: f64,
    ) -> ObliqueDiffusion {
        ObliqueDiffusion::new(surface_albedo, mfp, Parameterization::Mfp, configuration, cos_theta).unwrap()
    }

    fn profiles() -> impl Iterator<Item = ObliqueDiffusion> {
        let albedos = [1e-9, 0.03, 0.2, 0.5, 0.8, 0.97, 1.0];
        let each = move |c| albedos.into_iter().flat_map(move |a| COSINES.map(|mu| profile(a, 1.0, c, mu)));
        CONFIGURATIONS.into_iter().flat_map(each)
    }

    /// Radii that the trapezoidal rule in ln r visits, with its step.
    fn rings() -> (Vec<f64>, f64) {
        let step = 0.15;
        ((-200..=60).map(|i| (step * f64::from(i)).exp()).collect(), step)
    }

    #[test]
    fn normal_incidence_is_the_refined_profile() {
        for a in [0.0, 1e-6, 0.1, 0.5, 0.9, 1.0] {
            let refined =
                RefinedDiffusion::new(a, 2.0, Parameterization::Mfp, Configuration::Searchlight).unwrap();
            let oblique = profile(a, 2.0, Configuration::Searchlight, 1.0);
            assert!((oblique.total() - a).abs() <= 1e-15 * a);
            for r in [0.0, 1e-9, 0.1, 1.0, 7.0, 100.0] {
                for phi in [0.0, 1.0, PI] {
                    let (found, expected) = (oblique.eval_times_r(r, phi), refined.eval_times_r(r));
                    assert!((found - expected).abs() <= 1e-14 * expected, "{a} {r}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn eval_integrates_to_total() {
        let (radii, step) = rings();
        for p in profiles() {
            // Midpoints in the eccentric anomaly, in which a term's azimuths are uniform; the least tilt serves all
            let sines = p.eccentricities();
            let most = sines.into_iter().fold(0.0, f64::max);
            let squeeze = ((1.0 - most) / (1.0 + most)).sqrt();
            let count = 400;
            let mut sum = 0.0;
            for i in 0..count {
                let half = PI * ((f64::from(i) + 0.5) / f64::from(count) - 0.5);
                let phi = 2.0 * (squeeze * half.tan()).atan();
                let jacobian = squeeze / (half.cos().powi(2) + (squeeze * half.sin()).powi(2));
                let along: f64 = radii.iter().map(|&r| step * r * p.eval_times_r(r, phi)).sum();
                sum += along * jacobian * 2.0 * PI / f64::from(count);
            }
            assert!((sum / p.total() - 1.0).abs() < 1e-9, "{p:?}: {sum}");
        }
    }

    #[test]
    fn marginals_are_integrals_of_eval() {
        let rule = gauss_legendre(60);
        for p in profiles().filter(|p| p.cos_theta() > 0.3) {
            for r in [1e-3, 0.3, 1.0, 4.0] {
                let mean = integrate(&rule, 0.0, PI, |phi| p.eval(r, phi)) / PI;
                assert!((p.eval_mean(r) / mean - 1.0).abs() < 1e-9, "{p:?} {r}");
                let ring = integrate(&rule, r, 1.2 * r, |r| 2.0 * PI * r * p.eval_mean(r));
                assert!((p.enclosed(1.2 * r) - p.enclosed(r) - ring).abs() < 1e-13 * p.total(), "{p:?} {r}");
                assert!((p.enclosed(r) + p.beyond(r) - p.total()).abs() < 1e-14 * p.total(), "{p:?} {r}");
            }
        }
    }

    /// The energy of diffuse light is the surface albedo.
    #[test]
    fn diffuse_light_returns_surface_albedo() {
        let rule = gauss_legendre(60);
        for a in [1e-9, 0.1, 0.5, 0.9, 1.0] {
            // μ = w³, as the energy has a term μ ln μ
            let at = |w: f64| 6.0 * w.powi(5) * profile(a, 1.0, Configuration::Diffuse, w.powi(3)).total();
            let found = integrate(&rule, 0.0, 1.0, at);
            assert!((found / a - 1.0).abs() < 1e-12, "{a}: {found}");
        }
    }

    /// A half space may be named by the albedo of diffuse light or of light along the normal: a beam in it is the same,
    /// its energy up to the errors of both.
    #[test]
    fn both_configurations_are_one_half_space() {
        for a in [1e-6, 0.05, 0.2, 0.5, 0.8, 0.97, 1.0] {
            let along_normal = profile(a, 1.0, Configuration::Diffuse, 1.0).total();
            for cos_theta in COSINES {
                let diffuse = profile(a, 1.0, Configuration::Diffuse, cos_theta);
                let searchlight = profile(along_normal, 1.0, Configuration::Searchlight, cos_theta);
                let shape =
                    |p: &ObliqueDiffusion| [p.weights(), p.rates(), p.eccentricities()].into_iter().flatten();
                for (x, y) in shape(&diffuse).zip(shape(&searchlight)) {
                    assert!((x - y).abs() <= 1e-12 * y, "{a} {cos_theta}: {diffuse:?} {searchlight:?}");
                }
                let off = (searchlight.total() - diffuse.total()) / a;
                assert!(off.abs() < 2.0 * 2.6e-3, "{a} {cos_theta}: {off}");
            }
        }
    }

    /// Near the entry all light has been scattered once: R = α cos θ / (4π r (1 − sin θ cos φ)).
    #[test]
    fn near_the_entry_light_is_scattered_once() {
        for (a, cos_theta, tolerance) in
            [(0.2, 0.8, 0.12), (0.5, 0.8, 0.12), (0.5, 0.5, 0.3), (0.8, 0.6, 0.2)]
        {
            let alpha = half_space_single_scattering_albedo(a, Configuration::Searchlight);
            let p = profile(a, 1.0, Configuration::Searchlight, cos_theta);
            let sin_theta = (1.0f64 - cos_theta * cos_theta).sqrt();
            for phi in [0.0, 1.0, 2.0, PI] {
                let expected = alpha * cos_theta / (4.0 * PI * (1.0 - sin_theta * phi.cos()));
                let found = p.eval_times_r(0.0, phi);
                assert!(
                    (found / expected - 1.0).abs() < tolerance,
                    "{a} {cos_theta} {phi}: {found} {expected}"
                );
            }
        }
    }

    /// Each term's share of the numbers has its radii and azimuths: cells of equal probability get equal counts.
    #[test]
    fn sample_has_the_density_of_pdf() {
        for p in profiles().filter(|p| p.cos_theta() >= 0.1) {
            // ∫ over the plane of a smooth test function, by the closed-form sampler and by the density
            let test = |r: f64, phi: f64| (-r).exp() * (1.0 + phi.cos() + 0.5 * (2.0 * phi).cos());
            let n = 300;
            let mut sampled = 0.0;
            for (start, weight) in p.weights().into_iter().scan(0.0, |start, weight| {
                let this = *start;
                *start += weight;
                Some((this, weight))
            }) {
                for i in 0..n {
                    for j in 0..n {
                        let u = start + weight * (f64::from(i) + 0.5) / f64::from(n);
                        let (r, phi) = p.sample([u, (f64::from(j) + 0.5) / f64::from(n)]);
                        sampled += weight * test(r, phi);
                    }
                }
            }
            sampled /= f64::from(n * n);
            let rates = p.rates();
            // ∫ of a term: λ/(1 + λ) times 1 + c₁ + c₂/2 with the azimuth's harmonics c_m = tan^m(θ_k/2)
            let expected: f64 = (0..ObliqueDiffusion::TERMS)
                .map(|k| {
                    let half = (0.5 * p.eccentricities()[k].asin()).tan();
                    p.weights()[k] * rates[k] / (1.0 + rates[k]) * (1.0 + half + 0.5 * half * half)
                })
                .sum();
            assert!((sampled / expected - 1.0).abs() < 2e-4, "{p:?}: {sampled} {expected}");
        }
    }

    #[test]
    fn profile_scales_with_the_length() {
        let one = profile(0.6, 1.0, Configuration::Diffuse, 0.4);
        let other = profile(0.6, 1e9, Configuration::Diffuse, 0.4);
        for (r, phi) in [(0.0, 0.0), (0.5, 1.0), (3.0, -2.0)] {
            let (found, expected) = (other.eval_times_r(1e9 * r, phi) * 1e9, one.eval_times_r(r, phi));
            assert!((found / expected - 1.0).abs() < 1e-13);
        }
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        let arguments =
            [0.0, -0.0, f64::NAN, f64::INFINITY, -1.0, 5e-324, 1e-150, 0.25, 1.0, 1.5, 1e150, f64::MAX];
        for (a, mfp) in [(0.0, 1e-150), (1.0, 1e-150), (0.5, 1.0), (1.0, 1e150), (1e-300, 1e150)] {
            for cos_theta in COSINES {
                let p = profile(a, mfp, Configuration::Diffuse, cos_theta);
                assert!(p.total() >= 0.0 && p.total() <= 1.0);
                for x in arguments {
                    for y in arguments {
                        let (r, phi) = p.sample([x, y]);
                        assert!(r.is_finite() && r >= 0.0 && phi.abs() <= PI, "{p:?} {x} {y}: {r} {phi}");
                        for value in [p.eval(x, y), p.eval_times_r(x, y), p.pdf_area(x, y)] {
                            assert!(value.is_finite() && value >= 0.0, "{p:?} {x} {y}: {value}");
                        }
                    }
                    for value in [p.eval_mean(x), p.enclosed(x), p.beyond(x)] {
                        assert!(value.is_finite() && value >= 0.0, "{p:?} {x}: {value}");
                    }
                }
            }
        }
    }

    #[test]
    fn new_refuses_what_has_no_profile() {
        let new = |a, length, cos_theta| {
            let (mfp, diffuse) = (Parameterization::Mfp, Configuration::Diffuse);
            ObliqueDiffusion::new(a, length, mfp, diffuse, cos_theta)
        };
        for (a, length, cos_theta) in [(1.1, 1.0, 0.5), (0.5, 0.0, 0.5), (0.5, 1.0, -0.1), (0.5, 1.0, 1.1)] {
            assert!(new(a, length, cos_theta).is_err(), "{a} {length} {cos_theta}");
        }
        assert_eq!(new(0.5, 1.0, f64::NAN).unwrap_err().parameter, "cos_theta");
    }
}
