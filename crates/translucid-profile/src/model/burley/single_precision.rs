//! Burley's normalized diffusion in single precision, for the inner loop of a renderer.
//!
//! The formulas are those of [`NormalizedDiffusion`](crate::NormalizedDiffusion), which explains them.
//! Between single-precision arguments and results the arithmetic runs in `f64` registers with short
//! polynomials: on today's processors that costs a scalar loop nothing, and it leaves hardly more than the
//! result's own rounding.
//! In pure `f32` the rounding of r/3d alone would cost 2.6e-6 of the profile at u = 1 − 2⁻³².

use std::f64::consts::PI;

use crate::math::elementary::Single;
use crate::math::slices::{elementwise, map_slice};
use crate::model::burley::kernel;

/// Least width that the arithmetic holds.
const D_MIN: f32 = 1e-18;
/// Greatest width that the arithmetic holds.
const D_MAX: f32 = 1e18;

/// Normalized diffusion for one width d, without the surface albedo, in single precision.
///
/// The densities do not depend on A: multiply [`pdf_area`](Self::pdf_area) by A to get the profile.
/// Every method lies within a relative 7e-8 of the [`f64` profile](crate::NormalizedDiffusion) of the same d
/// wherever the result is a normal number.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an
/// infinity; lengths are in the unit of d.
///
/// The shares 2⁻³² … 1 − 2⁻³² that a random generator hands out do not all exist in `f32`, which stops at
/// 1 − 2⁻²⁴.
/// [`quantile`](Self::quantile) takes the share within r and resolves the small radii,
/// [`quantile_complement`](Self::quantile_complement) takes the share beyond r and resolves the tail.
///
/// ```
/// use translucid_profile::NormalizedDiffusionF32;
///
/// let profile = NormalizedDiffusionF32::from_d(0.5);
/// let r = profile.quantile_complement(0.25);
/// assert!((profile.complementary_cdf(r) - 0.25).abs() < 1e-7);
/// // The weight of a sample drawn by the density itself is the surface albedo.
/// let surface_albedo = 0.8;
/// assert!((profile.eval(surface_albedo, r) / profile.pdf_area(r) - surface_albedo).abs() < 1e-7);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedDiffusionF32 {
    three_d: f64,
    inverse_3d: f64,
}

impl NormalizedDiffusionF32 {
    /// Makes the profile of width d \[L\], clamped to [1e-18, 1e18]; NaN counts as the least.
    ///
    /// d = 0 is the Lambertian limit, for which a renderer needs no profile.
    #[inline]
    pub fn from_d(d: f32) -> Self {
        let three_d = 3.0 * f64::from(d.max(D_MIN).min(D_MAX));
        Self { three_d, inverse_3d: 1.0 / three_d }
    }

    /// Width d \[L\].
    #[inline]
    pub fn d(self) -> f32 {
        (self.three_d / 3.0) as f32
    }

    /// Reflectance profile R(r) = A p_a(r) for the surface albedo given \[L⁻²\].
    #[inline]
    pub fn eval(self, surface_albedo: f32, r: f32) -> f32 {
        (f64::from(surface_albedo) * self.unrounded_pdf_area(r)).min(f64::from(f32::MAX)) as f32
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\].
    ///
    /// It grows like 1/(4πdr); so that it stays finite, r below the least normal number 1.2e-38 counts as that
    /// number and a density above the greatest number as that one.
    #[inline(always)]
    pub fn pdf_area(self, r: f32) -> f32 {
        self.unrounded_pdf_area(r).min(f64::from(f32::MAX)) as f32
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]; 1/(2d) at r = 0.
    #[inline]
    pub fn pdf(self, r: f32) -> f32 {
        self.unrounded_pdf(r) as f32
    }

    /// Share of the energy that leaves within r: 1 − ¼e^{−r/d} − ¾e^{−r/3d}.
    #[inline]
    pub fn cdf(self, r: f32) -> f32 {
        kernel::within::<Single>(self.t(r)) as f32
    }

    /// Share of the energy that leaves beyond r: ¼e^{−r/d} + ¾e^{−r/3d}.
    #[inline]
    pub fn complementary_cdf(self, r: f32) -> f32 {
        kernel::beyond::<Single>(self.t(r)) as f32
    }

    /// Radius within which the share u ∈ [0, 1] of the energy leaves \[L\].
    ///
    /// u is clamped to [0, 1 − 2⁻³³]; NaN counts as 0.
    #[inline]
    pub fn quantile(self, u: f32) -> f32 {
        let u = f64::from(u.max(0.0)).min(1.0 - LEAST_COMPLEMENT);
        (self.three_d * kernel::quantile::<Single>(u, 1.0 - u)) as f32
    }

    /// Radius beyond which the share u ∈ [0, 1] of the energy leaves \[L\].
    ///
    /// It maps a uniform random number to a radius of density p, monotonically.
    /// u is clamped to [2⁻³³, 1], so that a generator's 0 gives 68 d instead of an infinity; NaN counts as 1.
    #[inline(always)]
    pub fn quantile_complement(self, u: f32) -> f32 {
        let u = f64::from(u.min(1.0)).max(LEAST_COMPLEMENT);
        (self.three_d * kernel::quantile::<Single>(1.0 - u, u)) as f32
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\]; not monotone in u, see
    /// [`NormalizedDiffusion::sample`](crate::NormalizedDiffusion::sample).
    ///
    /// u is clamped to [0, 1 − 2⁻³³]; NaN counts as 0.
    #[inline(always)]
    pub fn sample(self, u: f32) -> f32 {
        let u = f64::from(u.max(0.0)).min(1.0 - LEAST_COMPLEMENT);
        (self.three_d * kernel::sample::<Single>(u)) as f32
    }

    /// [`pdf_area`](Self::pdf_area) of every radius, as far as the shorter slice goes.
    pub fn pdf_area_slice(self, radii: &[f32], densities: &mut [f32]) {
        map_slice(radii, densities, elementwise!(self, NormalizedDiffusionF32, f32, pdf_area));
    }

    /// [`sample`](Self::sample) of every random number, as far as the shorter slice goes.
    pub fn sample_slice(self, randoms: &[f32], radii: &mut [f32]) {
        map_slice(randoms, radii, elementwise!(self, NormalizedDiffusionF32, f32, sample));
    }

    #[inline(always)]
    fn unrounded_pdf(self, r: f32) -> f64 {
        kernel::density::<Single>(self.t(r)) * self.inverse_3d
    }

    #[inline(always)]
    fn unrounded_pdf_area(self, r: f32) -> f64 {
        self.unrounded_pdf(r) / (2.0 * PI * f64::from(r.max(f32::MIN_POSITIVE)))
    }

    /// r/3d, the argument of the kernel.
    #[inline(always)]
    fn t(self, r: f32) -> f64 {
        f64::from(r.max(0.0)) * self.inverse_3d
    }
}

/// Least share beyond a radius, 2⁻³³: half of what 32 random bits resolve.
const LEAST_COMPLEMENT: f64 = 1.0 / 8_589_934_592.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NormalizedDiffusion;

    const D: [f32; 4] = [1e-6, 0.7, 1.0, 3e5];

    fn pair(d: f32) -> (NormalizedDiffusionF32, NormalizedDiffusion) {
        (NormalizedDiffusionF32::from_d(d), NormalizedDiffusion::from_d(1.0, f64::from(d)).unwrap())
    }

    /// Shares from 2⁻³² to ½, evenly in the logarithm and evenly.
    fn small_shares() -> impl Iterator<Item = f32> {
        let logarithmic = (0..=31_000).map(|i| (-(i as f32) / 1000.0 - 1.0).exp2());
        logarithmic.chain((1..=50_000).map(|i| i as f32 / 100_000.0))
    }

    /// Both ends of u ∈ [2⁻³², 1 − 2⁻³²]: the lower half by the share, the upper half by its complement.
    #[test]
    fn quantiles_agree_with_f64() {
        let mut worst = 0.0f64;
        for d in D {
            let (twin, exact) = pair(d);
            for u in small_shares() {
                let lower = f64::from(twin.quantile(u)) / exact.quantile(f64::from(u));
                let upper = f64::from(twin.quantile_complement(u)) / exact.quantile_complement(f64::from(u));
                worst = worst.max((lower - 1.0).abs()).max((upper - 1.0).abs());
            }
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    /// The other half of either quantile's domain, as far as `f32` resolves it.
    #[test]
    fn quantiles_agree_with_f64_beyond_the_median() {
        let mut worst = 0.0f64;
        for d in D {
            let (twin, exact) = pair(d);
            for u in small_shares().map(|u| 1.0 - u).filter(|u| *u < 1.0) {
                let lower = f64::from(twin.quantile(u)) / exact.quantile(f64::from(u));
                let upper = f64::from(twin.quantile_complement(u)) / exact.quantile_complement(f64::from(u));
                worst = worst.max((lower - 1.0).abs()).max((upper - 1.0).abs());
            }
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    #[test]
    fn densities_and_shares_agree_with_f64() {
        let mut worst = 0.0f64;
        for d in D {
            let (twin, exact) = pair(d);
            for u in small_shares() {
                for r in [twin.quantile(u), twin.quantile_complement(u)] {
                    let wide = f64::from(r);
                    let ratios = [
                        f64::from(twin.pdf(r)) / exact.pdf(wide),
                        f64::from(twin.pdf_area(r)) / exact.pdf_area(wide),
                        f64::from(twin.cdf(r)) / exact.cdf(wide),
                        f64::from(twin.complementary_cdf(r)) / exact.complementary_cdf(wide),
                    ];
                    worst = ratios.iter().fold(worst, |worst, ratio| worst.max((ratio - 1.0).abs()));
                }
            }
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    #[test]
    fn samples_agree_with_f64() {
        let mut worst = 0.0f64;
        for d in D {
            let (twin, exact) = pair(d);
            for i in 1..100_000 {
                let u = i as f32 / 100_000.0;
                worst = worst.max((f64::from(twin.sample(u)) / exact.sample(f64::from(u)) - 1.0).abs());
            }
            assert_eq!(twin.d(), d);
        }
        assert!(worst < 7e-8, "{worst:e}");
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        let arguments = [
            0.0,
            -0.0,
            f32::NAN,
            f32::INFINITY,
            -1.0,
            1e-45,
            f32::MIN_POSITIVE,
            0.25,
            0.5,
            1.0,
            2.0,
            1e30,
            f32::MAX,
        ];
        for d in [0.0, f32::NAN, 1e-30, 1e-18, 1.0, 1e18, f32::INFINITY, -1.0] {
            let p = NormalizedDiffusionF32::from_d(d);
            for x in arguments {
                let values = [
                    p.pdf(x),
                    p.pdf_area(x),
                    p.eval(0.5, x),
                    p.cdf(x),
                    p.complementary_cdf(x),
                    p.quantile(x),
                    p.quantile_complement(x),
                    p.sample(x),
                ];
                for (i, value) in values.into_iter().enumerate() {
                    assert!(value.is_finite() && value >= 0.0, "d {d} method {i} of {x}: {value}");
                }
            }
        }
    }

    #[test]
    fn slices_equal_scalars_bit_for_bit() {
        let p = NormalizedDiffusionF32::from_d(0.7);
        let from: Vec<f32> = (0..1003).map(|i| i as f32 / 1002.0).collect();
        let mut to = vec![0.0; 1003];
        type Slice = fn(NormalizedDiffusionF32, &[f32], &mut [f32]);
        type Scalar = fn(NormalizedDiffusionF32, f32) -> f32;
        let pairs: [(Slice, Scalar); 2] = [
            (NormalizedDiffusionF32::pdf_area_slice, NormalizedDiffusionF32::pdf_area),
            (NormalizedDiffusionF32::sample_slice, NormalizedDiffusionF32::sample),
        ];
        for (slice, scalar) in pairs {
            slice(p, &from, &mut to);
            for (from, to) in from.iter().zip(&to) {
                assert_eq!(to.to_bits(), scalar(p, *from).to_bits());
            }
        }
    }
}
