//! The refined profile in single precision, for the inner loop of a renderer.
//!
//! The formulas are those of [`RefinedDiffusion`](crate::RefinedDiffusion), in `f64` registers with short polynomials:
//! on today's processors that costs a scalar loop nothing, and it leaves hardly more than the result's own rounding.

use std::f64::consts::PI;

use crate::Configuration;
use crate::math::elementary::Single;
use crate::math::slices::{elementwise, map_slice};
use crate::model::exponential_mixture::ExponentialMixture;
use crate::model::refined::{TERMS, terms};

/// Least mean free path that the arithmetic holds.
const MFP_MIN: f32 = 1e-18;
/// Greatest mean free path that the arithmetic holds.
const MFP_MAX: f32 = 1e18;
/// Least share beyond a radius, 2⁻³³: half of what 32 random bits resolve.
const LEAST_COMPLEMENT: f64 = 1.0 / 8_589_934_592.0;

/// Twin of [`RefinedDiffusion`](crate::RefinedDiffusion) in single precision.
///
/// Every method lies within a relative 7e-8 of the `f64` profile of the same parameters wherever the result is a normal
/// number; the rounding of a result alone is 6.0e-8.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an infinity.
/// The slice methods return bit for bit what the scalar ones do.
///
/// ```
/// use translucid_profile::{Configuration, RefinedDiffusionF32};
///
/// let marble = RefinedDiffusionF32::new(0.8, 2.0, Configuration::Searchlight);
/// let r = marble.sample(0.7); // one random number in, one radius out
/// assert!((marble.eval(r) / marble.pdf_area(r) - 0.8).abs() < 1e-7); // the weight of a sample
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinedDiffusionF32 {
    surface_albedo: f64,
    mixture: ExponentialMixture<TERMS>,
}

impl RefinedDiffusionF32 {
    /// Makes the profile of a surface albedo, clamped to [0, 1], and a mean free path \[L\], clamped to [1e-18, 1e18];
    /// NaN counts as the least.
    pub fn new(surface_albedo: f32, mfp: f32, configuration: Configuration) -> Self {
        let surface_albedo = f64::from(surface_albedo.max(0.0).min(1.0));
        let mfp = f64::from(mfp.max(MFP_MIN).min(MFP_MAX));
        let (weights, rates) = terms(surface_albedo, configuration);
        let mixture = ExponentialMixture { weights, rates: rates.map(|rate| rate / mfp), length: mfp };
        Self { surface_albedo, mixture }
    }

    /// Surface albedo A.
    #[inline]
    pub fn surface_albedo(self) -> f32 {
        self.surface_albedo as f32
    }

    /// Mean free path ℓ \[L\].
    #[inline]
    pub fn mfp(self) -> f32 {
        self.mixture.length as f32
    }

    /// Reflectance profile R(r) \[L⁻²\], at r = 0 as [`pdf_area`](Self::pdf_area).
    #[inline(always)]
    pub fn eval(self, r: f32) -> f32 {
        (self.surface_albedo * self.unrounded_pdf_area(r)).min(f64::from(f32::MAX)) as f32
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\].
    ///
    /// It grows like 1/r. So that it stays finite, r below the least normal number 1.2e-38 counts as that number and a
    /// density above the greatest number as that one.
    #[inline(always)]
    pub fn pdf_area(self, r: f32) -> f32 {
        self.unrounded_pdf_area(r).min(f64::from(f32::MAX)) as f32
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\].
    #[inline(always)]
    pub fn pdf(self, r: f32) -> f32 {
        self.unrounded_pdf(r) as f32
    }

    /// Share of the energy that leaves within r.
    #[inline(always)]
    pub fn cdf(self, r: f32) -> f32 {
        self.mixture.within::<Single>(f64::from(r.max(0.0))) as f32
    }

    /// Share of the energy that leaves beyond r.
    #[inline(always)]
    pub fn complementary_cdf(self, r: f32) -> f32 {
        self.mixture.beyond::<Single>(f64::from(r.max(0.0))) as f32
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]; not monotone in u, see
    /// [`RefinedDiffusion::sample`](crate::RefinedDiffusion::sample).
    ///
    /// u is clamped to [0, 1 − 2⁻³³]; NaN counts as 0.
    #[inline(always)]
    pub fn sample(self, u: f32) -> f32 {
        self.mixture.sample::<Single>(f64::from(u.max(0.0)).min(1.0 - LEAST_COMPLEMENT)) as f32
    }

    /// Mean radius ∫ r p dr \[L\].
    #[inline]
    pub fn mean_radius(self) -> f32 {
        self.mixture.mean_radius() as f32
    }

    /// [`eval`](Self::eval) of every radius, as far as the shorter slice goes.
    pub fn eval_slice(self, radii: &[f32], reflectances: &mut [f32]) {
        map_slice(radii, reflectances, elementwise!(self, RefinedDiffusionF32, f32, eval));
    }

    /// [`sample`](Self::sample) of every random number, as far as the shorter slice goes.
    pub fn sample_slice(self, randoms: &[f32], radii: &mut [f32]) {
        map_slice(randoms, radii, elementwise!(self, RefinedDiffusionF32, f32, sample));
    }

    #[inline(always)]
    fn unrounded_pdf(self, r: f32) -> f64 {
        self.mixture.density::<Single>(f64::from(r.max(0.0)))
    }

    #[inline(always)]
    fn unrounded_pdf_area(self, r: f32) -> f64 {
        self.unrounded_pdf(r) / (2.0 * PI * f64::from(r.max(f32::MIN_POSITIVE)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameterization, RefinedDiffusion};

    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];
    const ALBEDOS: [f32; 6] = [0.0, 0.03, 0.2, 0.5, 0.8, 1.0];

    /// Twins over albedos, both configurations and lengths.
    fn pairs() -> impl Iterator<Item = (RefinedDiffusionF32, RefinedDiffusion)> {
        let lengths = [1e-6f32, 0.7, 3e5];
        let parameters = lengths.into_iter().flat_map(|mfp| ALBEDOS.map(|a| (a, mfp)));
        parameters.flat_map(|(a, mfp)| {
            CONFIGURATIONS.map(|configuration| {
                let from = Parameterization::Mfp;
                let exact = RefinedDiffusion::new(f64::from(a), f64::from(mfp), from, configuration).unwrap();
                (RefinedDiffusionF32::new(a, mfp, configuration), exact)
            })
        })
    }

    fn relative_error(found: f32, exact: f64) -> f64 {
        let is_normal = exact.abs() > f64::from(f32::MIN_POSITIVE);
        if is_normal { (f64::from(found) / exact - 1.0).abs() } else { 0.0 }
    }

    #[test]
    fn values_and_shares_agree_with_f64() {
        let mut worst = 0.0f64;
        for (twin, exact) in pairs() {
            for i in 0..4000 {
                let r = (f64::from(i) / 4000.0 * 25.0 - 16.0).exp2() as f32 * twin.mfp();
                let at = f64::from(r);
                worst = worst
                    .max(relative_error(twin.eval(r), exact.eval(at)))
                    .max(relative_error(twin.pdf(r), exact.pdf(at)))
                    .max(relative_error(twin.pdf_area(r), exact.pdf_area(at)))
                    .max(relative_error(twin.cdf(r), exact.cdf(at)))
                    .max(relative_error(twin.complementary_cdf(r), exact.complementary_cdf(at)));
            }
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    #[test]
    fn samples_agree_with_f64() {
        let mut worst = 0.0f64;
        for (twin, exact) in pairs() {
            let ends = (1..=31_000).map(|i| (-(i as f32) / 1000.0).exp2());
            for u in ends.chain((0..20_000).map(|i| i as f32 / 20_000.0)) {
                worst = worst.max(relative_error(twin.sample(u), exact.sample(f64::from(u))));
            }
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        let arguments = [
            0.0,
            -0.0,
            -1.0,
            1e-45,
            f32::MIN_POSITIVE,
            0.25,
            1.0,
            1.5,
            1e18,
            f32::MAX,
            f32::INFINITY,
            f32::NAN,
        ];
        for (a, mfp) in [(0.0, 0.0), (1.0, 0.0), (0.5, 1.0), (1.0, f32::INFINITY), (f32::NAN, f32::NAN)] {
            let twin = RefinedDiffusionF32::new(a, mfp, Configuration::Diffuse);
            for x in arguments {
                let values = [
                    twin.eval(x),
                    twin.pdf(x),
                    twin.pdf_area(x),
                    twin.cdf(x),
                    twin.complementary_cdf(x),
                    twin.sample(x),
                    twin.mean_radius(),
                ];
                assert!(values.iter().all(|v| v.is_finite() && *v >= 0.0), "A {a} ℓ {mfp} {x}: {values:?}");
            }
        }
    }

    #[test]
    fn slices_equal_scalars_bit_for_bit() {
        let twin = RefinedDiffusionF32::new(0.8, 0.7, Configuration::Diffuse);
        let from: Vec<f32> = (0..1003).map(|i| i as f32 / 1002.0).collect();
        let mut to = vec![0.0; 1003];
        type Slice = fn(RefinedDiffusionF32, &[f32], &mut [f32]);
        type Scalar = fn(RefinedDiffusionF32, f32) -> f32;
        let pairs: [(Slice, Scalar); 2] = [
            (RefinedDiffusionF32::eval_slice, RefinedDiffusionF32::eval),
            (RefinedDiffusionF32::sample_slice, RefinedDiffusionF32::sample),
        ];
        for (slice, scalar) in pairs {
            slice(twin, &from, &mut to);
            assert!(from.iter().zip(&to).all(|(x, y)| y.to_bits() == scalar(twin, *x).to_bits()));
        }
    }
}
