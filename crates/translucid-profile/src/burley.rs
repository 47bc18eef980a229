//! Burley's normalized diffusion: two exponentials whose integral is the surface albedo.
//!
//! B. Burley, *Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering*, SIGGRAPH 2015
//! course notes; P. H. Christensen and B. Burley, *Approximate Reflectance Profiles for Efficient
//! Subsurface Scattering*, Pixar Technical Memo 15-04, 2015, equation 3.
//!
//! Everything here follows from x = e^{−r/3d}:
//!
//! ```text
//! R(r) = A x (1 + x²) / (8π d r)        density per length p = x (1 + x²) / (4d)
//! 1 − cdf = (x³ + 3x) / 4               cdf = (6y − 3y² + y³) / 4   with y = 1 − x
//! ```

use std::f64::consts::PI;

use crate::error::{ParameterError, require, require_fraction, require_non_negative};
use crate::{Configuration, Parameterization, d_from_surface_albedo};

/// Least width that the arithmetic holds.
const D_MIN: f64 = 1e-150;
/// Greatest width that the arithmetic holds.
const D_MAX: f64 = 1e150;

/// Burley's normalized diffusion profile for one surface albedo A and one width d.
///
/// ```text
/// R(r) = A (e^{−r/d} + e^{−r/3d}) / (8π d r)
/// ```
///
/// Lengths are in the unit of d. A radius that is negative or NaN counts as 0.
/// No argument makes a method panic or return a NaN.
///
/// ```
/// use translucid_profile::NormalizedDiffusion;
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let profile = NormalizedDiffusion::from_d(0.8, 0.5)?;
/// assert!((profile.enclosed(1e3) - 0.8).abs() < 1e-15);
/// assert!((profile.cdf(profile.quantile(0.3)) - 0.3).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Sr")]
#[doc(alias = "Burley")]
pub struct NormalizedDiffusion {
    surface_albedo: f64,
    d: f64,
    inverse_3d: f64,
}

impl NormalizedDiffusion {
    /// Makes the profile of a surface albedo A ∈ [0, 1] and a length \[L\], mean free path or diffuse mean
    /// free path as the parameterization says.
    ///
    /// # Errors
    /// The surface albedo is not in [0, 1], or the width d = length / s(A) is not in [1e-150, 1e150].
    /// Length 0 is the Lambertian limit, which has no profile; see [`d_from_surface_albedo`].
    pub fn new(
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        require_fraction("surface_albedo", surface_albedo)?;
        require_non_negative("length", length)?;
        let d = d_from_surface_albedo(surface_albedo, length, parameterization, configuration);
        require(
            (D_MIN..=D_MAX).contains(&d),
            "length",
            length,
            "such that d = length / s(A) is in [1e-150, 1e150]",
        )?;
        Self::from_d(surface_albedo, d)
    }

    /// Makes the profile of a surface albedo A ∈ [0, 1] and a width d \[L\] ∈ [1e-150, 1e150].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn from_d(surface_albedo: f64, d: f64) -> Result<Self, ParameterError> {
        require_fraction("surface_albedo", surface_albedo)?;
        require((D_MIN..=D_MAX).contains(&d), "d", d, "in [1e-150, 1e150]")?;
        Ok(Self { surface_albedo, d, inverse_3d: 1.0 / (3.0 * d) })
    }

    /// Surface albedo A = ∫ R 2πr dr.
    #[inline]
    pub fn surface_albedo(&self) -> f64 {
        self.surface_albedo
    }

    /// Width d \[L\].
    #[inline]
    pub fn d(&self) -> f64 {
        self.d
    }

    /// Reflectance profile R(r) \[L⁻²\].
    ///
    /// R grows like A/(4πdr); at r = 0 the value is `f64::MAX` (0 if A = 0), so that it stays finite and
    /// falls with r. Work with [`eval_times_r`](Self::eval_times_r) where r may be 0.
    #[inline]
    pub fn eval(&self, r: f64) -> f64 {
        (self.eval_times_r(r) / r.max(f64::MIN_POSITIVE)).min(f64::MAX)
    }

    /// Profile times radius, g(r) = r R(r) \[L⁻¹\]; A/(4πd) at r = 0.
    #[inline]
    pub fn eval_times_r(&self, r: f64) -> f64 {
        self.surface_albedo * self.pdf(r) / (2.0 * PI)
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]; 1/(2d) at r = 0. It does not depend on A.
    #[inline]
    pub fn pdf(&self, r: f64) -> f64 {
        let x = self.x(r);
        0.75 * self.inverse_3d * x * (1.0 + x * x)
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\]; `f64::MAX` at r = 0. It does not depend on A.
    #[inline]
    pub fn pdf_area(&self, r: f64) -> f64 {
        (self.pdf(r) / (2.0 * PI) / r.max(f64::MIN_POSITIVE)).min(f64::MAX)
    }

    /// Share of the energy that leaves within r.
    #[inline]
    pub fn cdf(&self, r: f64) -> f64 {
        let y = -(-r.max(0.0) * self.inverse_3d).exp_m1();
        0.25 * y * (6.0 + y * (y - 3.0))
    }

    /// Share of the energy that leaves beyond r: ¼e^{−r/d} + ¾e^{−r/3d}.
    #[inline]
    pub fn complementary_cdf(&self, r: f64) -> f64 {
        let x = self.x(r);
        0.25 * x * (3.0 + x * x)
    }

    /// Energy that leaves within r: ∫₀^r R(r') 2πr' dr' = A cdf(r).
    #[inline]
    pub fn enclosed(&self, r: f64) -> f64 {
        self.surface_albedo * self.cdf(r)
    }

    /// Radius \[L\] within which the share u ∈ [0, 1] of the energy leaves.
    #[inline]
    pub fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0 - f64::EPSILON / 2.0);
        self.quantile_pair(u, 1.0 - u)
    }

    /// Radius \[L\] beyond which the share u ∈ [0, 1] of the energy leaves.
    #[inline]
    pub fn quantile_complement(&self, u: f64) -> f64 {
        let u = u.max(f64::MIN_POSITIVE).min(1.0);
        self.quantile_pair(1.0 - u, u)
    }

    /// Radius for the share u within and its complement.
    #[inline]
    fn quantile_pair(&self, u: f64, complement: f64) -> f64 {
        let x = 2.0 * ((2.0 * complement).asinh() / 3.0).sinh();
        let y = 1.0 - x;
        let y = y - (y * (6.0 + y * (y - 3.0)) - 4.0 * u) / (3.0 * (1.0 + x * x));
        let log = if x > 0.7 { (-y).ln_1p() } else { x.ln() };
        (-3.0 * self.d * log).max(0.0)
    }

    /// Mean radius ∫ r p dr = 5d/2 \[L\].
    #[inline]
    pub fn mean_radius(&self) -> f64 {
        2.5 * self.d
    }

    /// Mean squared radius ∫ r² p dr = 14d² \[L²\].
    #[inline]
    pub fn mean_squared_radius(&self) -> f64 {
        14.0 * self.d * self.d
    }

    /// e^{−r/3d}, from which everything else follows.
    #[inline]
    fn x(&self, r: f64) -> f64 {
        (-r.max(0.0) * self.inverse_3d).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantile_inverts_cdf() {
        let profile = NormalizedDiffusion::from_d(0.8, 0.7).unwrap();
        for i in 1..1000 {
            let u = f64::from(i) / 1000.0;
            assert!((profile.cdf(profile.quantile(u)) / u - 1.0).abs() < 4e-15);
        }
    }
}
