//! Quantized diffusion: Grosjean's diffusion from a whole beam, as a sum of Gaussians, one for each quantum of time.
//!
//! E. d'Eon and G. Irving, *A Quantized-Diffusion Model for Rendering Translucent Materials*, SIGGRAPH 2011.

use std::f64::consts::PI;

use crate::error::ParameterError;
use crate::math::elementary::{Double, exp_negative};
use crate::math::scaled_erfc::{erfcx, erfcx_drop, erfcx_remainder};
use crate::math::slices::{Elementwise, map_slice};
use crate::medium::diffusion_boundary::DiffusionBoundary;
use crate::model::dipole::source_pair::{bounded, damped};
use crate::{Appearance, Medium, Profile};

/// Number of Gaussians; 20 to 60 are in use (R. Habel, P. H. Christensen and W. Jarosz 2013).
const COUNT: usize = 40;
/// Least variance \[ℓ*²\]: R levels off below r ≈ 1e-3 ℓ*.
const LEAST_VARIANCE: f64 = 1e-7;
/// Greatest variance times σ_tr²: its Gaussian has lost the factor e^−30 to absorption.
const GREATEST_VARIANCE: f64 = 60.0;
/// Below this σ_tr² the variances stay: the last one is then 6e10 ℓ*², the light beyond it some 1e-5 of all.
const LEAST_SIGMA_TR_SQUARED: f64 = 1e-9;
/// Value of √v σ_tr at which the steps of time turn from even in ln v to even in √v.
const TURN: f64 = 2.0;

/// Quantized diffusion for one medium, light entering perpendicularly.
///
/// Light of the time τ (a length: the path that it has travelled) has spread to a Gaussian of the variance v = 2Dτ
/// along each axis and lost the factor e^{−σ_a τ}.
/// The beam is a source of the strength α'σ'_t e^{−σ'_t z} at the depth z, with its negative image at the height
/// z + 2z_b, z_b = 2A_F D_G; the sum over depths has a closed form for each time:
///
/// ```text
/// R(r) = α' Σᵢ wᵢ w_R(vᵢ) e^{−r²/2vᵢ}/(2πvᵢ)
/// w_R  = C_φ [w_φ(v, 0) − w_φ(v, 2z_b)] + C_E [w_E(v, 0) + w_E(v, 2z_b)]
/// w_φ(v, m) = ½ α' σ'_t e^{−m²/2v} erfcx((m + σ'_t v)/√2v)
/// w_E(v, m) = D σ'_t [α' e^{−m²/2v}/√2πv − w_φ(v, m)]
/// ```
///
/// D = D_G is Grosjean's diffusion coefficient; C_φ, C_E and A_F are as in the [`BetterDipole`](crate::BetterDipole).
/// The factor α' stands before the sum and in w_φ: in all α'², as in the better dipole.
/// Single scattering is no part of the model.
/// It reaches every surface albedo: without absorption its total is 1, as for every depth of source.
///
/// **Quanta of time.** The paper gives each Gaussian what an interval of time leaves over from absorption and the
/// variance at its middle, each interval being 1.618 times the one before: with 40 of them 1.4 % of the energy is lost
/// at A = 0.15 (test `intervals_of_the_paper_lose_energy`).
/// Here 40 Gaussians stand where the trapezoidal rule puts them on a path in time that is even in ln v for short times
/// and in √v for long ones, the first takes up all earlier times, and all are scaled by the little that brings their
/// sum to the exact total of the sum over continuous time ([`surface_albedo`](Profile::surface_albedo)).
/// Against that model with continuous time, over r from 0.003 ℓ* to 10 ℓ_d, R is off by at most 3e-5 where
/// A ≤ 0.6, 2e-4 at 0.9, and 8e-3 without absorption (test `gaussians_converge_to_continuous_time`).
///
/// Radii above 1e150 ℓ* count as that many.
///
/// ```
/// use translucid_profile::{Appearance, Parameterization, Profile, QuantizedDiffusion};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let half = Appearance { surface_albedo: 0.5, length: 2.0, parameterization: Parameterization::Mfp, g: 0.0 };
/// let profile = QuantizedDiffusion::new(&half, 1.4)?;
/// assert!((profile.surface_albedo() - 0.5).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuantizedDiffusion {
    /// 1/2vᵢ, in ℓ*⁻².
    rates: [f64; COUNT],
    /// Energy of each Gaussian.
    energies: [f64; COUNT],
    /// Value of each Gaussian at its center: energy/2πvᵢ, in ℓ*⁻².
    peaks: [f64; COUNT],
    /// Sum of the energies.
    total: f64,
    /// ℓ* \[L\].
    transport_mfp: f64,
}

impl QuantizedDiffusion {
    /// Makes the profile of a medium and a relative index η = n_inside/n_outside ∈ [0.05, 20].
    ///
    /// # Errors
    /// η is outside its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self::of(medium, DiffusionBoundary::new(eta)?))
    }

    /// Makes the profile whose total is a surface albedo A ∈ [0, 1], for a relative index η ∈ [0.05, 20].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(appearance: &Appearance, eta: f64) -> Result<Self, ParameterError> {
        let boundary = DiffusionBoundary::new(eta)?;
        let total = |absorbed| Beam::new(absorbed, 1.0 - absorbed, boundary).total();
        Ok(Self::of(&appearance.medium(total)?, boundary))
    }

    fn of(medium: &Medium, boundary: DiffusionBoundary) -> Self {
        let absorbed = medium.sigma_a() / medium.sigma_t_prime();
        let beam = Beam::new(absorbed, medium.alpha_prime(), boundary);
        let (variances, mut energies) = beam.gaussians();
        let total = beam.total();

        // Scale to the total; in the dark limit there is nothing to scale
        let sum: f64 = energies.iter().sum();
        let factor = if sum > 0.0 { total / sum } else { 0.0 };
        energies.iter_mut().for_each(|energy| *energy *= factor);
        Self {
            rates: variances.map(|v| 0.5 / v),
            energies,
            peaks: std::array::from_fn(|i| energies[i] / (2.0 * PI * variances[i])),
            total,
            transport_mfp: medium.transport_mfp(),
        }
    }

    /// ℓ*² R at a radius in transport mean free paths.
    fn relative(&self, r: f64) -> f64 {
        self.sum(&self.peaks, Kept { square: r * r })
    }

    /// Σ factorᵢ f(1/2vᵢ), the terms first, so that they become vector code, and then four sums side by side.
    #[inline(always)]
    fn sum(&self, factors: &[f64; COUNT], f: impl Elementwise) -> f64 {
        let mut terms = [0.0; COUNT];
        map_slice(&self.rates, &mut terms, f);
        let mut sums = [0.0; 4];
        for (terms, factors) in terms.chunks_exact(4).zip(factors.chunks_exact(4)) {
            for i in 0..4 {
                sums[i] += terms[i] * factors[i];
            }
        }
        (sums[0] + sums[1]) + (sums[2] + sums[3])
    }

    /// A radius in transport mean free paths.
    fn relative_radius(&self, r: f64) -> f64 {
        bounded(r / self.transport_mfp)
    }
}

impl Profile for QuantizedDiffusion {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = self.relative_radius(r);
        self.relative(r) * r / self.transport_mfp
    }

    fn eval(&self, r: f64) -> f64 {
        (self.relative(self.relative_radius(r)) / self.transport_mfp / self.transport_mfp).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.sum(&self.energies, Lost { square: self.relative_radius(r).powi(2) })
    }

    fn beyond(&self, r: f64) -> f64 {
        self.sum(&self.energies, Kept { square: self.relative_radius(r).powi(2) })
    }

    /// ```text
    /// A = α'²/(1 + s) [C_φ/(2Ds) (1 − e^{−2s z_b}) + C_E/2 (1 + e^{−2s z_b})],   s = σ_tr, lengths in ℓ*
    /// ```
    ///
    /// This is the total of a better dipole whose source is at the depth z, averaged over e^{−z}.
    fn surface_albedo(&self) -> f64 {
        self.total
    }

    fn scale(&self) -> f64 {
        self.transport_mfp
    }
}

/// e^{−r²/2v}, given r² and for 1/2v.
struct Kept {
    square: f64,
}

impl Elementwise for Kept {
    #[inline(always)]
    fn at(&self, rate: f64) -> f64 {
        exp_negative::<Double>(self.square * rate).0
    }
}

/// 1 − e^{−r²/2v}, given r² and for 1/2v.
struct Lost {
    square: f64,
}

impl Elementwise for Lost {
    #[inline(always)]
    fn at(&self, rate: f64) -> f64 {
        exp_negative::<Double>(self.square * rate).1
    }
}

/// The beam below the surface and its image; lengths in transport mean free paths.
#[derive(Clone, Copy)]
struct Beam {
    alpha_prime: f64,
    /// Grosjean's D_G.
    diffusion_coefficient: f64,
    /// σ_tr² = σ_a/D_G.
    sigma_tr_squared: f64,
    /// 2z_b, between a source's mirror image and the image that is used.
    shift: f64,
    boundary: DiffusionBoundary,
}

impl Beam {
    fn new(absorbed: f64, alpha_prime: f64, boundary: DiffusionBoundary) -> Self {
        let diffusion_coefficient = (1.0 + absorbed) / 3.0;
        Self {
            alpha_prime,
            diffusion_coefficient,
            sigma_tr_squared: absorbed / diffusion_coefficient,
            shift: 4.0 * boundary.mismatch * diffusion_coefficient,
            boundary,
        }
    }

    /// Total over continuous time; the formula is [`QuantizedDiffusion::surface_albedo`]'s.
    fn total(&self) -> f64 {
        let s = self.sigma_tr_squared.sqrt();
        let (damping, _) = exp_negative::<Double>(s * self.shift);
        let fluence = self.boundary.fluence / self.diffusion_coefficient * damped(s, self.shift);
        let flux = self.boundary.flux * (1.0 + damping);
        self.alpha_prime * self.alpha_prime * 0.5 * (fluence + flux) / (1.0 + s)
    }

    /// Energy per variance that leaves as a Gaussian of the variance v > 0: α' w_R e^{−σ_a τ} dτ/dv.
    fn energy_per_variance(&self, v: f64) -> f64 {
        let root = (2.0 * v).sqrt();
        let (at_surface, at_image) = (0.5 * root, (self.shift + v) / root);
        let (kept, lost) = exp_negative::<Double>(self.shift * self.shift / (2.0 * v));

        // The difference of w_φ, split so that only erfcx at neighbouring arguments is subtracted
        let fluence = 0.5 * (lost * erfcx(at_surface) + kept * erfcx_drop(at_surface, at_image));

        // 1/√π − √(v/2) erfcx(x), where √(v/2) = x − m/√2v
        let image = erfcx_remainder(at_image) + self.shift / root * erfcx(at_image);
        let flux = self.diffusion_coefficient / root * (erfcx_remainder(at_surface) + kept * image);

        let leaving = self.boundary.fluence * fluence + self.boundary.flux * flux;
        let (survival, _) = exp_negative::<Double>(0.5 * self.sigma_tr_squared * v);
        self.alpha_prime * self.alpha_prime * leaving * survival / (2.0 * self.diffusion_coefficient)
    }

    /// Variances that rise and the energy of each.
    ///
    /// ```text
    /// ∫ energy dv by the trapezoidal rule in s,   √v = (TURN/σ_tr) ln(1 + e^s)
    /// ```
    ///
    /// The integrand is analytic within ±iπ of the real axis and falls at both ends, so that the rule converges
    /// exponentially. At the lower end it falls like √v, that is e^s: the nodes left out there make a geometric series.
    fn gaussians(&self) -> ([f64; COUNT], [f64; COUNT]) {
        let unit = TURN / self.sigma_tr_squared.max(LEAST_SIGMA_TR_SQUARED).sqrt();
        let first = libm::log(libm::expm1(LEAST_VARIANCE.sqrt() / unit));
        let last = libm::log(libm::expm1(GREATEST_VARIANCE.sqrt() / TURN));
        let step = (last - first) / (COUNT - 1) as f64;

        let (mut variances, mut energies) = ([0.0; COUNT], [0.0; COUNT]);
        for i in 0..COUNT {
            let s = first + step * i as f64;
            let root = unit * libm::log1p(libm::exp(s));
            let slope = 2.0 * root * unit / (1.0 + libm::exp(-s));
            variances[i] = root * root;
            energies[i] = step * slope * self.energy_per_variance(root * root);
        }
        energies[0] /= 1.0 - libm::exp(-step);
        (variances, energies)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameterization;
    use crate::math::quadrature::{gauss_legendre, integrate};
    use crate::model::dipole::source_pair::SourcePair;

    fn beam(absorbed: f64, eta: f64) -> Beam {
        Beam::new(absorbed, 1.0 - absorbed, DiffusionBoundary::new(eta).unwrap())
    }

    /// R of the extended source by quadrature over depth: the model with continuous time.
    fn over_depth(beam: &Beam, r: f64) -> f64 {
        let rule = gauss_legendre(16);
        let s = beam.sigma_tr_squared.sqrt();
        let at = |z: f64| {
            let pair = SourcePair::new(s, z, z + beam.shift);
            let fluence = beam.boundary.fluence / beam.diffusion_coefficient * pair.fluence(r);
            (-z).exp() * (fluence + beam.boundary.flux * pair.flux(r))
        };
        // Panels double from 2e-6 to 40: the integrand changes over depths like r
        let edges: Vec<f64> = [0.0].into_iter().chain((0..=24).map(|k| 40.0 * 0.5f64.powi(24 - k))).collect();
        let sum: f64 = edges.windows(2).map(|e| integrate(&rule, e[0], e[1], at)).sum();
        beam.alpha_prime * beam.alpha_prime * sum
    }

    #[test]
    fn energies_add_up_to_the_total_before_scaling() {
        let mut worst = 0.0f64;
        for eta in [0.5, 1.0, 1.5, 3.0] {
            for absorbed in [0.0, 1e-9, 1e-5, 1e-3, 0.03, 0.3, 0.9] {
                let b = beam(absorbed, eta);
                let (_, energies) = b.gaussians();
                let off = energies.iter().sum::<f64>() / b.total() - 1.0;
                worst = worst.max(off.abs());
            }
        }
        assert!(worst < 1e-4, "{worst:e}");
    }

    #[test]
    fn intervals_of_the_paper_lose_energy() {
        let b = beam(0.3, 1.0);
        let end = |i: i32| 1e-6 * 1.618f64.powi(i);
        let gaussian = |i: i32| {
            let (from, to) = (if i == 0 { 0.0 } else { end(i - 1) }, end(i));
            let v = b.diffusion_coefficient * (from + to);
            // The survival at the middle is part of the energy per variance, the paper takes its mean
            let at_middle = (-0.3 * 0.5 * (from + to)).exp();
            let mean = ((-0.3 * from).exp() - (-0.3 * to).exp()) / 0.3;
            let rate = 2.0 * b.diffusion_coefficient * b.energy_per_variance(v) / at_middle.max(1e-300);
            mean * rate
        };
        let found = (0..COUNT as i32).map(gaussian).sum::<f64>() / b.total() - 1.0;
        assert!((found + 0.01424).abs() < 1e-5, "{found}");
    }

    #[test]
    fn gaussians_converge_to_continuous_time() {
        for eta in [1.0, 1.5] {
            for (absorbed, limit) in
                [(0.9, 3e-5), (0.3, 3e-5), (0.03, 3e-5), (1e-3, 2e-4), (1e-6, 3e-3), (0.0, 8e-3)]
            {
                let b = beam(absorbed, eta);
                let medium = Medium::new(absorbed, 1.0 - absorbed, 0.0).unwrap();
                let profile = QuantizedDiffusion::from_medium(&medium, eta).unwrap();
                let farthest = (10.0 * medium.dmfp()).min(1e4);
                let radii = (0..=60).map(|i| 3e-3 * (farthest / 3e-3).powf(f64::from(i) / 60.0));
                let worst =
                    radii.map(|r| (profile.eval(r) / over_depth(&b, r) - 1.0).abs()).fold(0.0, f64::max);
                assert!(worst < limit, "{eta} {absorbed}: {worst:e}");
            }
        }
    }

    #[test]
    fn total_is_one_without_absorption_and_zero_without_scattering() {
        for eta in [0.05, 0.7, 1.0, 1.4, 3.0, 20.0] {
            let white = QuantizedDiffusion::from_medium(&Medium::new(0.0, 2.0, 0.3).unwrap(), eta).unwrap();
            assert!((white.surface_albedo() - 1.0).abs() < 1e-15, "{eta}: {}", white.surface_albedo());
            assert!((white.enclosed(1e30) - 1.0).abs() < 2e-15, "{eta}: {}", white.enclosed(1e30));
            let black = QuantizedDiffusion::from_medium(&Medium::new(2.0, 0.0, 0.3).unwrap(), eta).unwrap();
            assert_eq!([black.surface_albedo(), black.eval(0.1), black.enclosed(1.0)], [0.0; 3]);
        }
    }

    #[test]
    fn constructors_refuse_what_has_no_profile() {
        let medium = Medium::new(0.1, 1.0, 0.0).unwrap();
        for eta in [0.0, -1.0, 0.04, 21.0, f64::NAN, f64::INFINITY] {
            assert!(QuantizedDiffusion::from_medium(&medium, eta).is_err(), "{eta}");
        }
        let parameterization = Parameterization::Mfp;
        let appearance = Appearance { surface_albedo: 1.1, length: 1.0, parameterization, g: 0.0 };
        assert!(QuantizedDiffusion::new(&appearance, 1.4).is_err());
    }
}
