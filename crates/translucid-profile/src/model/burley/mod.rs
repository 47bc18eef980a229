//! Burley's normalized diffusion: two exponentials whose integral is the surface albedo.
//!
//! B. Burley, *Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering*, SIGGRAPH 2015
//! course notes; P. H. Christensen and B. Burley, *Approximate Reflectance Profiles for Efficient
//! Subsurface Scattering*, Pixar Technical Memo 15-04, 2015, equation 3.

pub(crate) mod kernel;

use std::f64::consts::PI;

use crate::error::{ParameterError, require, require_fraction, require_non_negative};
use crate::math::slices::{elementwise, map_slice};
use crate::medium::similarity::is_plain;
use crate::profile::{apply_each, finite_quotient, methods_of};
use crate::{
    Appearance, Configuration, Medium, Parameterization, Profile, Quantity, Similarity, d_from_surface_albedo,
};

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
/// Lengths are in the unit of d.
/// A radius that is negative or NaN counts as 0, and no argument makes a method panic or return a NaN or an
/// infinity.
/// Every method is exact to a few units in the last place, times r/3d where an exponential decides.
/// The slice methods return bit for bit what the scalar ones do.
///
/// ```
/// use translucid_profile::{Configuration, NormalizedDiffusion, Parameterization};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let marble = NormalizedDiffusion::new(0.8, 2.1, Parameterization::Mfp, Configuration::Searchlight)?;
/// assert!((marble.d() - 2.0).abs() < 1e-14);
/// assert!((marble.enclosed(1e3) - 0.8).abs() < 1e-15);
/// assert!((marble.cdf(marble.quantile(0.3)) - 0.3).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Sr")]
#[doc(alias = "Burley")]
#[doc(alias = "Christensen-Burley")]
pub struct NormalizedDiffusion {
    surface_albedo: f64,
    d: f64,
    inverse_3d: f64,
}

impl NormalizedDiffusion {
    /// Makes the profile of a surface albedo A ∈ [0, 1] and a length \[L\], mean free path or diffuse mean
    /// free path as the parameterization says; d = length / s(A).
    ///
    /// # Errors
    /// The surface albedo is not in [0, 1], or the width d is not in [1e-150, 1e150].
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
        let allowed = "such that d = length / s(surface_albedo) is in [1e-150, 1e150]";
        require((D_MIN..=D_MAX).contains(&d), "length", length, allowed)?;
        Self::from_d(surface_albedo, d)
    }

    /// Makes the profile of a surface albedo, a length and g, under a boundary of relative index η = n_inside/n_outside.
    ///
    /// By [`Similarity`]: d = ℓ*/(c s(A)) with c = c(A; g, η), or d = ℓ_d/(c s(A)) with another c.
    /// Without phase function and boundary (g = 0, η = 1) this is [`new`](Self::new), bit for bit.
    ///
    /// The mean L1 error over the grid of `docs/accuracy/similarity.md` is 17 % (searchlight) or 15 % (diffuse transmission), at
    /// most 40 % or 33 %, where ℓ* alone leaves 45 % or 42 %: two positive exponentials have no dimple.
    /// [`SimilarRefinedDiffusion`](crate::SimilarRefinedDiffusion) has.
    ///
    /// # Errors
    /// As [`new`](Self::new); or g is not in [−0.5, 0.9], or η not in [1, 1.5].
    pub fn from_appearance(
        appearance: &Appearance,
        eta: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        let Appearance { surface_albedo, length, parameterization, g } = *appearance;
        if is_plain(g, eta) {
            return Self::new(surface_albedo, length, parameterization, configuration);
        }
        let similarity = Similarity::new(surface_albedo, g, eta, configuration)?;
        let own_length = match parameterization {
            Parameterization::Mfp => similarity.transport_mfp(length, parameterization)?,
            Parameterization::Dmfp => length,
        };
        let stretch = similarity.stretch_of_normalized_diffusion(parameterization);
        Self::new(surface_albedo, own_length / stretch, parameterization, configuration).map_err(|error| {
            if error.parameter == "length" { ParameterError { value: length, ..error } } else { error }
        })
    }

    /// Makes the profile of a medium under a boundary of relative index η, by [`Similarity`].
    ///
    /// # Errors
    /// The medium's g is not in [−0.5, 0.9] or η not in [1, 1.5]; or the width d is not in [1e-150, 1e150].
    pub fn from_medium(
        medium: &Medium,
        eta: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        let similarity = Similarity::of_medium(medium, eta, configuration)?;
        let length =
            medium.transport_mfp() / similarity.stretch_of_normalized_diffusion(Parameterization::Mfp);
        Self::new(similarity.surface_albedo(), length, Parameterization::Mfp, configuration)
    }

    /// Makes the profile of a surface albedo A ∈ [0, 1] and a width d ∈ [1e-150, 1e150] \[L\].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn from_d(surface_albedo: f64, d: f64) -> Result<Self, ParameterError> {
        require_fraction("surface_albedo", surface_albedo)?;
        require((D_MIN..=D_MAX).contains(&d), "d", d, "in [1e-150, 1e150]")?;
        Ok(Self { surface_albedo, d, inverse_3d: 1.0 / (3.0 * d) })
    }

    /// Surface albedo A = ∫ R 2πr dr, dimensionless.
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
    /// R grows like A/(4πdr).
    /// So that it stays finite, r below the least normal number 2.2e-308 counts as that number and R above
    /// the greatest number as that one; near 0 prefer [`eval_times_r`](Self::eval_times_r).
    #[inline(always)]
    pub fn eval(&self, r: f64) -> f64 {
        finite_quotient(self.eval_times_r(r), r)
    }

    /// Profile times radius, g(r) = r R(r) \[L⁻¹\]; A/(4πd) at r = 0.
    #[inline(always)]
    pub fn eval_times_r(&self, r: f64) -> f64 {
        self.surface_albedo * (self.pdf(r) / (2.0 * PI))
    }

    /// Density per length p(r) = 2πr R(r)/A \[L⁻¹\]; 1/(2d) at r = 0. It does not depend on A.
    #[inline(always)]
    pub fn pdf(&self, r: f64) -> f64 {
        kernel::density(self.t(r)) * self.inverse_3d
    }

    /// Density per area p_a(r) = R(r)/A \[L⁻²\], at r = 0 as [`eval`](Self::eval). It does not depend on A.
    #[inline]
    pub fn pdf_area(&self, r: f64) -> f64 {
        finite_quotient(self.pdf(r) / (2.0 * PI), r)
    }

    /// Share of the energy that leaves within r: 1 − ¼e^{−r/d} − ¾e^{−r/3d}, exact for small r too.
    #[inline(always)]
    pub fn cdf(&self, r: f64) -> f64 {
        kernel::within(self.t(r))
    }

    /// Share of the energy that leaves beyond r: ¼e^{−r/d} + ¾e^{−r/3d}, exact for large r too.
    ///
    /// It falls to 0 at r = 2124 d, where it leaves the range of normal numbers.
    #[inline]
    pub fn complementary_cdf(&self, r: f64) -> f64 {
        kernel::beyond(self.t(r))
    }

    /// Energy that leaves within r: ∫₀^r R(r') 2πr' dr' = A cdf(r).
    #[inline]
    pub fn enclosed(&self, r: f64) -> f64 {
        self.surface_albedo * self.cdf(r)
    }

    /// Radius within which the share u ∈ [0, 1] of the energy leaves \[L\].
    ///
    /// ```text
    /// r = −3d ln(2 sinh(asinh(2 − 2u)/3))
    /// ```
    ///
    /// Exact for every u; but numbers near 1 are 1e-16 apart, which is coarse for the tail:
    /// [`quantile_complement`](Self::quantile_complement) resolves it.
    /// u is clamped to [0, 1], NaN counts as 0, and u = 1 gives the radius of the complement 2.2e-308.
    #[inline(always)]
    pub fn quantile(&self, u: f64) -> f64 {
        let u = u.max(0.0).min(1.0);
        3.0 * self.d * kernel::quantile(u, (1.0 - u).max(f64::MIN_POSITIVE))
    }

    /// Radius beyond which the share u ∈ [0, 1] of the energy leaves \[L\]: `quantile(1 − u)` with every digit
    /// of the tail.
    ///
    /// u is clamped to [2.2e-308, 1]; NaN counts as 1.
    ///
    /// ```
    /// use translucid_profile::NormalizedDiffusion;
    ///
    /// # fn main() -> Result<(), translucid_profile::ParameterError> {
    /// let profile = NormalizedDiffusion::from_d(1.0, 1.0)?;
    /// assert!((profile.complementary_cdf(profile.quantile_complement(1e-30)) / 1e-30 - 1.0).abs() < 1e-13);
    /// # Ok(())
    /// # }
    /// ```
    #[inline(always)]
    pub fn quantile_complement(&self, u: f64) -> f64 {
        let u = u.min(1.0).max(f64::MIN_POSITIVE);
        3.0 * self.d * kernel::quantile(1.0 - u, u)
    }

    /// Radius of density p(r) for a random number u uniform on [0, 1) \[L\].
    ///
    /// With probability ¼ it is −d ln(1 − u'), with probability ¾ −3d ln(1 − u'), where u' is u rescaled.
    /// Cheaper than [`quantile`](Self::quantile), but not monotone in u: a stratified u becomes two strata
    /// that overlap in r.
    /// u is clamped to [0, 1]; NaN counts as 0.
    #[inline(always)]
    pub fn sample(&self, u: f64) -> f64 {
        3.0 * self.d * kernel::sample(u.max(0.0).min(1.0))
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

    /// [`eval`](Self::eval) of every radius, as far as the shorter slice goes.
    pub fn eval_slice(&self, radii: &[f64], reflectances: &mut [f64]) {
        map_slice(radii, reflectances, elementwise!(*self, NormalizedDiffusion, eval));
    }

    /// [`quantile`](Self::quantile) of every share, as far as the shorter slice goes.
    pub fn quantile_slice(&self, shares: &[f64], radii: &mut [f64]) {
        map_slice(shares, radii, elementwise!(*self, NormalizedDiffusion, quantile));
    }

    /// [`sample`](Self::sample) of every random number, as far as the shorter slice goes.
    pub fn sample_slice(&self, randoms: &[f64], radii: &mut [f64]) {
        map_slice(randoms, radii, elementwise!(*self, NormalizedDiffusion, sample));
    }

    /// r/3d, the argument of the kernel.
    #[inline(always)]
    fn t(&self, r: f64) -> f64 {
        r.max(0.0) * self.inverse_3d
    }
}

impl Profile for NormalizedDiffusion {
    methods_of!(|own| own; all);

    /// Width d \[L\].
    fn scale(&self) -> f64 {
        self.d
    }

    fn apply(&self, quantity: Quantity, from: &[f64], to: &mut [f64]) {
        match quantity {
            Quantity::Eval => self.eval_slice(from, to),
            Quantity::Quantile => self.quantile_slice(from, to),
            Quantity::Sample => self.sample_slice(from, to),
            _ => apply_each(self, quantity, from, to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(surface_albedo: f64, d: f64) -> NormalizedDiffusion {
        NormalizedDiffusion::from_d(surface_albedo, d).unwrap()
    }

    #[test]
    fn new_refuses_what_has_no_profile() {
        let new = |a, l| NormalizedDiffusion::new(a, l, Parameterization::Mfp, Configuration::Diffuse);
        for (a, l) in [(-0.1, 1.0), (1.1, 1.0), (f64::NAN, 1.0), (0.5, -1.0), (0.5, 0.0), (0.5, f64::NAN)] {
            assert!(new(a, l).is_err(), "{a} {l}");
        }
        assert!(new(0.5, f64::INFINITY).is_err());
        assert!(new(0.5, 1e-160).is_err());
        assert!(new(0.0, 1.0).is_ok() && new(1.0, 1.0).is_ok());
        let message = new(0.5, 0.0).unwrap_err().to_string();
        assert!(message.starts_with("length is 0, but must be such that d"), "{message}");
    }

    #[test]
    fn eval_matches_the_formula() {
        let p = profile(0.8, 0.7);
        for r in [1e-6, 0.1, 1.0, 5.0, 20.0] {
            let expected = 0.8 * ((-r / 0.7f64).exp() + (-r / 2.1f64).exp()) / (8.0 * PI * 0.7 * r);
            assert!((p.eval(r) / expected - 1.0).abs() < 1e-14, "{r}");
            assert!((p.eval_times_r(r) / (r * expected) - 1.0).abs() < 1e-14, "{r}");
            assert!((p.pdf_area(r) / (expected / 0.8) - 1.0).abs() < 1e-14, "{r}");
            assert!((p.pdf(r) / (2.0 * PI * r * expected / 0.8) - 1.0).abs() < 1e-14, "{r}");
            let beyond = 0.25 * (-r / 0.7f64).exp() + 0.75 * (-r / 2.1f64).exp();
            assert!((p.complementary_cdf(r) / beyond - 1.0).abs() < 1e-14, "{r}");
            assert!((p.cdf(r) - (1.0 - beyond)).abs() < 4e-16, "{r}");
        }
    }

    #[test]
    fn pdf_is_the_slope_of_cdf() {
        let p = profile(0.8, 0.7);
        for i in 1..200 {
            let r = 0.05 * f64::from(i);
            let h = 1e-4;
            // Five-point rule: truncation h⁴ p⁗/30 ~ 1e-17, rounding 1e-16/h = 1e-12
            let slope = (p.cdf(r - 2.0 * h) - 8.0 * p.cdf(r - h) + 8.0 * p.cdf(r + h) - p.cdf(r + 2.0 * h))
                / (12.0 * h);
            assert!((slope - p.pdf(r)).abs() < 5e-12, "{r}: {slope} {}", p.pdf(r));
        }
    }

    #[test]
    fn quantile_inverts_cdf() {
        let p = profile(0.8, 0.7);
        for i in 1..20_000 {
            let u = f64::from(i) / 20_000.0;
            assert!((p.cdf(p.quantile(u)) / u - 1.0).abs() < 2e-15, "{u}");
            let small = (-f64::from(i) / 30.0).exp();
            assert!((p.cdf(p.quantile(small)) / small - 1.0).abs() < 2e-15, "{small:e}");
            // The exponential multiplies the radius's rounding by r/3d = −ln u.
            let back = p.complementary_cdf(p.quantile_complement(small));
            assert!((back / small - 1.0).abs() < 2e-15 * (1.0 - small.ln()), "{small:e}");
        }
    }

    #[test]
    fn quantile_rises_from_zero() {
        let p = profile(0.8, 0.7);
        assert_eq!(p.quantile(0.0), 0.0);
        assert_eq!(p.quantile_complement(1.0), 0.0);
        assert_eq!(p.quantile(1.0), p.quantile_complement(0.0));
        let mut last = 0.0;
        for i in 1..=100_000 {
            let r = p.quantile(f64::from(i) / 100_000.0);
            assert!(r > last);
            last = r;
        }
        // Near 0 the cdf is r/2d.
        assert!((p.quantile(1e-300) / 1.4e-300 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn radius_zero_has_the_limits() {
        let p = profile(0.8, 0.7);
        assert!((p.eval_times_r(0.0) / (0.8 / (4.0 * PI * 0.7)) - 1.0).abs() < 1e-15);
        assert!((p.pdf(0.0) / (0.5 / 0.7) - 1.0).abs() < 1e-15);
        assert_eq!(p.cdf(0.0), 0.0);
        assert_eq!(p.complementary_cdf(0.0), 1.0);
        assert_eq!(p.eval(0.0), p.eval(f64::MIN_POSITIVE));
        assert!(p.eval(0.0) > 1e305 && p.eval(0.0) > p.eval(1e-307));
        assert_eq!(profile(0.8, 1e-20).eval(0.0), f64::MAX);
        assert_eq!(profile(0.0, 0.7).eval(0.0), 0.0);
        for r in [1e-300, 1e-100, 1e-10] {
            assert!((p.eval(r) * r / p.eval_times_r(0.0) - 1.0).abs() < 1e-9, "{r}");
        }
    }

    #[test]
    fn albedo_zero_is_black_and_one_keeps_all() {
        let black = profile(0.0, 1.0);
        let white = profile(1.0, 1.0);
        for r in [0.0, 1e-9, 0.3, 4.0, f64::INFINITY] {
            assert_eq!(black.eval(r), 0.0);
            assert_eq!(black.enclosed(r), 0.0);
            assert_eq!(black.pdf(r), white.pdf(r));
        }
        assert_eq!(white.enclosed(f64::INFINITY), 1.0);
        for a in [1e-300, 1e-9, 1.0 - 1e-9] {
            let p = profile(a, 1.0);
            assert!((p.eval(0.3) / (a * white.eval(0.3)) - 1.0).abs() < 1e-15);
        }
    }

    /// As d → 0 all energy gathers at r = 0: the Lambertian limit.
    #[test]
    fn width_to_zero_gathers_all_energy() {
        for d in [1e-3, 1e-9, 1e-100, 1e-150] {
            let p = profile(0.8, d);
            assert!((p.enclosed(120.0 * d) - 0.8).abs() < 1e-15);
            assert!(p.quantile(0.999) < 21.0 * d);
            assert!((p.mean_radius() / d - 2.5).abs() < 1e-15);
        }
    }

    #[test]
    fn slices_equal_scalars_bit_for_bit() {
        let p = profile(0.8, 0.7);
        let from: Vec<f64> = (0..1003).map(|i| f64::from(i) / 1002.0).collect();
        let mut to = vec![0.0; 1003];
        type Slice = fn(&NormalizedDiffusion, &[f64], &mut [f64]);
        type Scalar = fn(&NormalizedDiffusion, f64) -> f64;
        let pairs: [(Slice, Scalar); 3] = [
            (NormalizedDiffusion::eval_slice, NormalizedDiffusion::eval),
            (NormalizedDiffusion::quantile_slice, NormalizedDiffusion::quantile),
            (NormalizedDiffusion::sample_slice, NormalizedDiffusion::sample),
        ];
        for (slice, scalar) in pairs {
            slice(&p, &from, &mut to);
            for (from, to) in from.iter().zip(&to) {
                assert_eq!(to.to_bits(), scalar(&p, *from).to_bits());
            }
        }
    }

    #[test]
    fn slices_of_unequal_length_fill_the_shorter() {
        let p = profile(0.8, 0.7);
        let mut to = [-1.0; 3];
        p.eval_slice(&[1.0], &mut to);
        assert_eq!(to, [p.eval(1.0), -1.0, -1.0]);
        p.eval_slice(&[1.0; 5], &mut to);
        assert_eq!(to, [p.eval(1.0); 3]);
    }
}
