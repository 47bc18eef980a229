//! Burley's normalized diffusion in single precision, for the inner loop of a renderer.
//!
//! The formulas are those of [`NormalizedDiffusion`](crate::NormalizedDiffusion), which explains them;
//! this file differs from it only in arithmetic.

use std::f32::consts::PI;

/// Least width that the arithmetic holds, 1e-18.
pub(crate) const D_MIN: f32 = 1e-18;
/// Greatest width that the arithmetic holds, 1e18.
pub(crate) const D_MAX: f32 = 1e18;

/// Normalized diffusion for one width d, without the surface albedo.
///
/// The densities do not depend on A: multiply [`pdf_area`](Self::pdf_area) by A to get the profile.
/// No argument makes a method panic or return a NaN; lengths are in the unit of d.
///
/// ```
/// use translucid_profile::NormalizedDiffusionF32;
///
/// let profile = NormalizedDiffusionF32::from_d(0.5);
/// let r = profile.quantile_complement(0.25);
/// assert!((profile.complementary_cdf(r) - 0.25).abs() < 1e-6);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalizedDiffusionF32 {
    d: f32,
    inverse_3d: f32,
}

impl NormalizedDiffusionF32 {
    /// Makes the profile of width d, clamped to [1e-18, 1e18]; NaN counts as the least.
    ///
    /// d = 0 is the Lambertian limit, for which a renderer needs no profile.
    #[inline]
    pub fn from_d(d: f32) -> Self {
        let d = d.max(D_MIN).min(D_MAX);
        Self { d, inverse_3d: 1.0 / (3.0 * d) }
    }

    /// Width d \[L\].
    #[inline]
    pub fn d(self) -> f32 {
        self.d
    }

    /// Reflectance profile R(r) = A p_a(r) \[L⁻²\] for the surface albedo given.
    #[inline]
    pub fn eval(self, surface_albedo: f32, r: f32) -> f32 {
        surface_albedo * self.pdf_area(r)
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\].
    ///
    /// It grows like 1/r; at r = 0 it is the largest finite number.
    #[inline]
    pub fn pdf_area(self, r: f32) -> f32 {
        let r = r.max(f32::MIN_POSITIVE);
        (self.pdf(r) / (2.0 * PI * r)).min(f32::MAX)
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]; 1/(2d) at r = 0.
    #[inline]
    pub fn pdf(self, r: f32) -> f32 {
        let x = self.x(r);
        0.75 * self.inverse_3d * x * (1.0 + x * x)
    }

    /// Probability that a radius is less than r.
    #[inline]
    pub fn cdf(self, r: f32) -> f32 {
        let y = -(-r.max(0.0) * self.inverse_3d).exp_m1();
        0.25 * y * (6.0 + y * (y - 3.0))
    }

    /// Probability that a radius is greater than r: ¼e^{−r/d} + ¾e^{−r/3d}.
    #[inline]
    pub fn complementary_cdf(self, r: f32) -> f32 {
        let x = self.x(r);
        0.25 * x * (3.0 + x * x)
    }

    /// Radius \[L\] below which the share u of the energy leaves; exact where u is small.
    #[inline]
    pub fn quantile(self, u: f32) -> f32 {
        let u = u.max(0.0).min(1.0 - f32::EPSILON / 2.0);
        self.quantile_pair(u, 1.0 - u)
    }

    /// Radius \[L\] beyond which the share u of the energy leaves; exact where u is small.
    ///
    /// It maps a uniform random number u to a radius of density p. u = 0 counts as the least normal number.
    #[inline]
    pub fn quantile_complement(self, u: f32) -> f32 {
        let u = u.max(f32::MIN_POSITIVE).min(1.0);
        self.quantile_pair(1.0 - u, u)
    }

    /// Radius for a share u within and its complement.
    #[inline]
    fn quantile_pair(self, u: f32, complement: f32) -> f32 {
        let x = 2.0 * ((2.0 * complement).asinh() / 3.0).sinh();
        let y = 1.0 - x;
        let y = y - (y * (6.0 + y * (y - 3.0)) - 4.0 * u) / (3.0 * (1.0 + x * x));
        let log = if x > 0.7 { (-y).ln_1p() } else { x.ln() };
        (-3.0 * self.d * log).max(0.0)
    }

    /// e^{−r/3d}, from which everything else follows.
    #[inline]
    fn x(self, r: f32) -> f32 {
        (-r.max(0.0) * self.inverse_3d).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_complement_inverts_complementary_cdf() {
        let profile = NormalizedDiffusionF32::from_d(0.7);
        for i in 1..1000 {
            let u = i as f32 / 1000.0;
            let back = profile.complementary_cdf(profile.quantile_complement(u));
            assert!((back / u - 1.0).abs() < 2e-6, "{u} {back}");
        }
    }

    #[test]
    fn every_method_is_finite_for_any_argument() {
        for d in [0.0, f32::NAN, 1e-30, 1e-18, 1.0, 1e18, f32::INFINITY, -1.0] {
            let p = NormalizedDiffusionF32::from_d(d);
            for x in [0.0, -0.0, f32::NAN, f32::INFINITY, -1.0, f32::MIN_POSITIVE, 1e-40, 0.5, 1.0, 1e30] {
                for value in [
                    p.pdf(x),
                    p.pdf_area(x),
                    p.cdf(x),
                    p.complementary_cdf(x),
                    p.quantile(x),
                    p.quantile_complement(x),
                ] {
                    assert!(value.is_finite() && value >= 0.0, "d {d} argument {x}: {value}");
                }
            }
        }
    }
}
