//! A homogeneous scattering medium and the many numbers that describe the same one.

use crate::error::{ParameterError, require, require_fraction, require_non_negative, require_positive};
use crate::{Configuration, half_space_surface_albedo};

/// Coefficients above this leave no room for their squares.
const COEFFICIENT_MAX: f64 = 1e150;
/// Extinctions below this leave no room for their reciprocals' squares.
const COEFFICIENT_MIN: f64 = 1e-150;

/// A homogeneous medium: absorption σ_a, scattering σ_s and mean cosine g of the phase function.
///
/// Coefficients are per unit of length \[L⁻¹\], in whatever unit the caller keeps to.
/// A value that exists is valid: σ_a, σ_s ≥ 0, σ_t ∈ [1e-150, 1e150], g ∈ (−1, 1).
///
/// ```
/// use translucid_profile::Medium;
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let medium = Medium::new(0.1, 0.9, 0.5)?;
/// assert_eq!(medium.mfp(), 1.0);
/// assert_eq!(medium.single_scattering_albedo(), 0.9);
/// assert!((medium.sigma_t_prime() - 0.55).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    sigma_a: f64,
    sigma_s: f64,
    g: f64,
}

impl Medium {
    /// Makes a medium of absorption σ_a ≥ 0, scattering σ_s ≥ 0 \[L⁻¹\] and mean cosine g ∈ (−1, 1).
    ///
    /// # Errors
    /// A parameter is outside its range, or the extinction σ_a + σ_s is not in [1e-150, 1e150].
    pub fn new(sigma_a: f64, sigma_s: f64, g: f64) -> Result<Self, ParameterError> {
        require_non_negative("sigma_a", sigma_a)?;
        require_non_negative("sigma_s", sigma_s)?;
        require(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        let sigma_t = sigma_a + sigma_s;
        let bounded = (COEFFICIENT_MIN..=COEFFICIENT_MAX).contains(&sigma_t);
        require(bounded, "sigma_t = sigma_a + sigma_s", sigma_t, "in [1e-150, 1e150]")?;
        Ok(Self { sigma_a, sigma_s, g })
    }

    /// Makes a medium of single-scattering albedo α ∈ [0, 1], mean free path ℓ > 0 \[L\] and g ∈ (−1, 1).
    ///
    /// ```text
    /// σ_s = α/ℓ,   σ_a = (1 − α)/ℓ
    /// ```
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_mfp(single_scattering_albedo: f64, mfp: f64, g: f64) -> Result<Self, ParameterError> {
        let alpha = require_fraction("single_scattering_albedo", single_scattering_albedo)?;
        require_positive("mfp", mfp)?;
        Self::new((1.0 - alpha) / mfp, alpha / mfp, g)
    }

    /// Makes a medium of absorption σ_a ≥ 0 and reduced scattering σ'_s ≥ 0 \[L⁻¹\], which measurements
    /// give, with the mean cosine g ∈ (−1, 1) that is to stand behind it: σ_s = σ'_s/(1 − g).
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn from_reduced(sigma_a: f64, sigma_s_prime: f64, g: f64) -> Result<Self, ParameterError> {
        require_non_negative("sigma_s_prime", sigma_s_prime)?;
        require(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        Self::new(sigma_a, sigma_s_prime / (1.0 - g), g)
    }

    /// Makes a medium of reduced albedo α' ∈ [0, 1), diffuse mean free path ℓ_d > 0 \[L\] and g ∈ (−1, 1).
    ///
    /// ```text
    /// ℓ* = ℓ_d √(3 (1 − α')/(2 − α'))                      (with Grosjean's D)
    /// ```
    ///
    /// # Errors
    /// As [`new`](Self::new). α' = 1 is refused: without absorption ℓ_d is infinite.
    pub fn from_dmfp(alpha_prime: f64, dmfp: f64, g: f64) -> Result<Self, ParameterError> {
        require((0.0..1.0).contains(&alpha_prime), "alpha_prime", alpha_prime, "in [0, 1)")?;
        require_positive("dmfp", dmfp)?;
        let transport_mfp = dmfp * transport_mfp_over_dmfp(1.0 - alpha_prime);
        require_positive("transport_mfp", transport_mfp)?;
        Self::from_reduced((1.0 - alpha_prime) / transport_mfp, alpha_prime / transport_mfp, g)
    }

    /// Absorption coefficient σ_a \[L⁻¹\].
    pub fn sigma_a(&self) -> f64 {
        self.sigma_a
    }

    /// Scattering coefficient σ_s \[L⁻¹\].
    pub fn sigma_s(&self) -> f64 {
        self.sigma_s
    }

    /// Mean cosine g of the phase function, dimensionless.
    pub fn g(&self) -> f64 {
        self.g
    }

    /// Extinction coefficient σ_t = σ_a + σ_s \[L⁻¹\].
    pub fn sigma_t(&self) -> f64 {
        self.sigma_a + self.sigma_s
    }

    /// Single-scattering albedo α = σ_s/σ_t, in [0, 1].
    pub fn single_scattering_albedo(&self) -> f64 {
        self.sigma_s / self.sigma_t()
    }

    /// Mean free path ℓ = 1/σ_t \[L\].
    pub fn mfp(&self) -> f64 {
        1.0 / self.sigma_t()
    }

    /// Reduced scattering coefficient σ'_s = (1 − g) σ_s \[L⁻¹\].
    pub fn sigma_s_prime(&self) -> f64 {
        (1.0 - self.g) * self.sigma_s
    }

    /// Reduced extinction coefficient σ'_t = σ_a + σ'_s \[L⁻¹\].
    pub fn sigma_t_prime(&self) -> f64 {
        self.sigma_a + self.sigma_s_prime()
    }

    /// Reduced albedo α' = σ'_s/σ'_t, in [0, 1].
    pub fn alpha_prime(&self) -> f64 {
        self.sigma_s_prime() / self.sigma_t_prime()
    }

    /// Transport mean free path ℓ* = 1/σ'_t \[L\].
    pub fn transport_mfp(&self) -> f64 {
        1.0 / self.sigma_t_prime()
    }

    /// Grosjean's diffusion coefficient D_G = (2σ_a + σ'_s)/(3σ'_t²) \[L\].
    ///
    /// C. C. Grosjean 1956, as in E. d'Eon and G. Irving, *A Quantized-Diffusion Model for Rendering
    /// Translucent Materials*, 2011: better than the classical one where absorption is strong.
    pub fn diffusion_coefficient(&self) -> f64 {
        // σ_a/σ'_t and σ'_s/σ'_t first: their sum is 1, and no square leaves the range.
        let ell = self.transport_mfp();
        (2.0 * self.sigma_a * ell + self.sigma_s_prime() * ell) * ell / 3.0
    }

    /// Effective transport coefficient σ_tr = √(σ_a/D_G) \[L⁻¹\]; 0 without absorption.
    pub fn sigma_tr(&self) -> f64 {
        (self.sigma_a / self.diffusion_coefficient()).sqrt()
    }

    /// Diffuse mean free path ℓ_d = 1/σ_tr \[L\], at most `f64::MAX`, which stands for the infinite one of a
    /// medium without absorption.
    pub fn dmfp(&self) -> f64 {
        (1.0 / self.sigma_tr()).min(f64::MAX)
    }

    /// The similar medium that scatters isotropically: the same σ_a and σ'_s with g = 0.
    ///
    /// D. R. Wyman, M. S. Patterson and B. C. Wilson, *Similarity relations for anisotropic scattering*,
    /// 1989: light far from where it entered hardly tells the two apart.
    pub fn isotropic(&self) -> Self {
        Self { sigma_a: self.sigma_a, sigma_s: self.sigma_s_prime(), g: 0.0 }
    }

    /// Surface albedo A ∈ [0, 1] of a half space of this medium without a boundary, which a profile takes
    /// together with the length [`transport_mfp`](Self::transport_mfp).
    ///
    /// Exact for g = 0 ([`half_space_surface_albedo`]); for other g that of the [similar](Self::isotropic)
    /// isotropic medium.
    ///
    /// ```
    /// use translucid_profile::{Configuration, Medium, NormalizedDiffusion, Parameterization};
    ///
    /// # fn main() -> Result<(), translucid_profile::ParameterError> {
    /// // Marble, red channel, in 1/mm: H. W. Jensen et al., A Practical Model for Subsurface Light
    /// // Transport, 2001, figure 5.
    /// let marble = Medium::from_reduced(0.0021, 2.19, 0.0)?;
    /// let surface_albedo = marble.surface_albedo(Configuration::Diffuse);
    /// assert!(surface_albedo > 0.92 && surface_albedo < 0.94);
    /// let profile = NormalizedDiffusion::new(
    ///     surface_albedo,
    ///     marble.transport_mfp(),
    ///     Parameterization::Mfp,
    ///     Configuration::Diffuse,
    /// )?;
    /// assert!(profile.mean_radius() > 1.0 && profile.mean_radius() < 1.2); // mm
    /// # Ok(())
    /// # }
    /// ```
    pub fn surface_albedo(&self, configuration: Configuration) -> f64 {
        half_space_surface_albedo(self.alpha_prime(), configuration)
    }
}

/// ℓ*/ℓ_d with Grosjean's D, for 1 − α' = `absorbed`.
pub(crate) fn transport_mfp_over_dmfp(absorbed: f64) -> f64 {
    (3.0 * absorbed / (1.0 + absorbed)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-14 * expected.abs(), "{found} is not {expected}");
    }

    #[test]
    fn conversions_match_values_worked_by_hand() {
        let m = Medium::new(0.2, 1.6, 0.75).unwrap();
        close(m.sigma_t(), 1.8);
        close(m.single_scattering_albedo(), 8.0 / 9.0);
        close(m.mfp(), 5.0 / 9.0);
        close(m.sigma_s_prime(), 0.4);
        close(m.sigma_t_prime(), 0.6);
        close(m.alpha_prime(), 2.0 / 3.0);
        close(m.transport_mfp(), 5.0 / 3.0);
        // D_G = (0.4 + 0.4)/(3·0.36) = 20/27, σ_tr² = 0.2·27/20 = 0.27
        close(m.diffusion_coefficient(), 20.0 / 27.0);
        close(m.sigma_tr(), 0.27f64.sqrt());
        close(m.dmfp(), 1.0 / 0.27f64.sqrt());
    }

    #[test]
    fn constructors_agree_with_each_other() {
        for alpha in [0.0, 0.3, 0.9, 0.999] {
            for length in [1e-3, 1.0, 250.0] {
                for g in [-0.7, 0.0, 0.9] {
                    let m = Medium::from_mfp(alpha, length, g).unwrap();
                    close(m.mfp(), length);
                    assert!((m.single_scattering_albedo() - alpha).abs() < 1e-15);
                    let reduced = Medium::from_reduced(m.sigma_a(), m.sigma_s_prime(), g).unwrap();
                    close(reduced.sigma_s(), m.sigma_s());
                    let diffuse = Medium::from_dmfp(m.alpha_prime(), m.dmfp(), g).unwrap();
                    assert!((diffuse.mfp() / m.mfp() - 1.0).abs() < 1e-12);
                    assert!((diffuse.dmfp() / m.dmfp() - 1.0).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn isotropic_keeps_the_reduced_medium() {
        let m = Medium::new(0.2, 1.6, 0.75).unwrap();
        let similar = m.isotropic();
        assert_eq!(similar.g(), 0.0);
        close(similar.sigma_t_prime(), m.sigma_t_prime());
        close(similar.dmfp(), m.dmfp());
        close(similar.sigma_t(), m.sigma_t_prime());
    }

    #[test]
    fn edges_of_the_range_stay_finite() {
        for (sigma_a, sigma_s) in
            [(0.0, 1.0), (1.0, 0.0), (1e-150, 0.0), (0.0, 1e-150), (1e150, 0.0), (1e-300, 1e150)]
        {
            for g in [-1.0 + 1e-15, 0.0, 1.0 - 1e-15] {
                let m = Medium::new(sigma_a, sigma_s, g).unwrap();
                let values = [
                    m.mfp(),
                    m.single_scattering_albedo(),
                    m.sigma_t_prime(),
                    m.alpha_prime(),
                    m.transport_mfp(),
                    m.diffusion_coefficient(),
                    m.sigma_tr(),
                    m.dmfp(),
                ];
                for (i, value) in values.into_iter().enumerate() {
                    assert!(value.is_finite() && value >= 0.0, "{sigma_a} {sigma_s} {g} number {i}: {value}");
                }
            }
        }
        assert_eq!(Medium::new(0.0, 1.0, 0.0).unwrap().dmfp(), f64::MAX);
    }

    #[test]
    fn constructors_refuse_what_is_no_medium() {
        assert!(Medium::new(-0.1, 1.0, 0.0).is_err());
        assert!(Medium::new(0.1, f64::NAN, 0.0).is_err());
        assert!(Medium::new(0.1, f64::INFINITY, 0.0).is_err());
        assert!(Medium::new(0.0, 0.0, 0.0).is_err());
        assert!(Medium::new(0.1, 1.0, 1.0).is_err() && Medium::new(0.1, 1.0, -1.0).is_err());
        assert!(Medium::new(0.1, 1.0, f64::NAN).is_err());
        assert!(Medium::from_mfp(1.1, 1.0, 0.0).is_err() && Medium::from_mfp(0.5, 0.0, 0.0).is_err());
        assert!(
            Medium::from_reduced(0.1, -1.0, 0.0).is_err() && Medium::from_reduced(0.1, 1.0, 1.0).is_err()
        );
        assert!(Medium::from_dmfp(1.0, 1.0, 0.0).is_err() && Medium::from_dmfp(0.5, 0.0, 0.0).is_err());
        assert!(Medium::from_dmfp(0.5, 5e-324, 0.0).is_err());
    }
}
