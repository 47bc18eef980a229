//! The standard dipole: classical diffusion from one point source, with an image to meet the boundary.
//!
//! H. W. Jensen, S. R. Marschner, M. Levoy and P. Hanrahan, *A Practical Model for Subsurface Light Transport*,
//! SIGGRAPH 2001, equation 4; H. W. Jensen and J. Buhler, *A Rapid Hierarchical Rendering Technique for Translucent
//! Materials*, SIGGRAPH 2002.

use crate::error::{ParameterError, require};
use crate::model::dipole::source_pair::SourcePair;
use crate::{Appearance, Medium, Profile, fresnel_moment_1_from_inside};

/// The standard dipole of Jensen et al. for one medium.
///
/// ```text
/// R(r) = α'/4π Σ z (1 + σ_tr d) e^{−σ_tr d}/d³    over (z, d) = (z_r, d_r), (z_v, d_v)
/// z_r = ℓ*,   z_v = z_r + 4 A_F D,   d = √(r² + z²),   D = ℓ*/3,   σ_tr = √(σ_a/D)
/// A_F = (1 + F_dr)/(1 − F_dr)
/// ```
///
/// F_dr = 2C₁ is the exact diffuse reflectance from inside ([`fresnel_moment_1_from_inside`]), for which the paper
/// gives a polynomial in η.
/// Single scattering is no part of the model.
/// It reaches every surface albedo: its total is 1 without absorption.
///
/// Radii above 1e150 ℓ* count as that many.
///
/// ```
/// use translucid_profile::{Medium, Profile, StandardDipole};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// // Marble, red channel, in 1/mm: Jensen et al. 2001, figure 5, which prints the diffuse reflectance 0.83.
/// let marble = StandardDipole::from_medium(&Medium::from_reduced(0.0021, 2.19, 0.0)?, 1.5)?;
/// assert!((marble.surface_albedo() - 0.83).abs() < 0.005);
/// assert!((marble.enclosed(2.0) + marble.beyond(2.0) - marble.surface_albedo()).abs() < 1e-15);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "classical dipole")]
#[doc(alias = "Jensen")]
pub struct StandardDipole {
    /// α' in [0, 1].
    alpha_prime: f64,
    /// The two sources, in transport mean free paths.
    sources: SourcePair,
    /// ℓ* \[L\].
    transport_mfp: f64,
}

impl StandardDipole {
    /// Makes the dipole of a medium and a relative index η = n_inside/n_outside ∈ [0.05, 20].
    ///
    /// # Errors
    /// η is outside its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self::of(medium, mismatch(eta)?))
    }

    /// Makes the dipole whose total is a surface albedo A ∈ [0, 1], for a relative index η ∈ [0.05, 20].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(appearance: &Appearance, eta: f64) -> Result<Self, ParameterError> {
        let mismatch = mismatch(eta)?;
        Ok(Self::of(&appearance.medium(|absorbed| total(absorbed, mismatch))?, mismatch))
    }

    fn of(medium: &Medium, mismatch: f64) -> Self {
        Self {
            alpha_prime: medium.alpha_prime(),
            sources: sources(medium.sigma_a() / medium.sigma_t_prime(), mismatch),
            transport_mfp: medium.transport_mfp(),
        }
    }
}

/// A_F = (1 + 2C₁)/(1 − 2C₁), by which internal reflection moves the image away.
fn mismatch(eta: f64) -> Result<f64, ParameterError> {
    require((0.05..=20.0).contains(&eta), "eta", eta, "in [0.05, 20]")?;
    let reflected = 2.0 * fresnel_moment_1_from_inside(eta);
    Ok((1.0 + reflected) / (1.0 - reflected))
}

/// The sources in transport mean free paths, where D = ⅓.
fn sources(absorbed: f64, mismatch: f64) -> SourcePair {
    SourcePair::new((3.0 * absorbed).sqrt(), 1.0, 1.0 + 4.0 / 3.0 * mismatch)
}

/// Surface albedo of a medium with 1 − α' = `absorbed`.
///
/// ```text
/// A = α'/2 (1 + e^{−(4/3) A_F s}) e^{−s},   s = √(3 (1 − α'))          (Jensen and Buhler 2002)
/// ```
fn total(absorbed: f64, mismatch: f64) -> f64 {
    (1.0 - absorbed) * sources(absorbed, mismatch).flux_total()
}

impl Profile for StandardDipole {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = r.max(0.0) / self.transport_mfp;
        (self.alpha_prime * self.sources.flux(r) * r.min(1e150)) / self.transport_mfp
    }

    fn eval(&self, r: f64) -> f64 {
        let flux = self.sources.flux(r / self.transport_mfp);
        (self.alpha_prime * flux / self.transport_mfp / self.transport_mfp).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.alpha_prime * self.sources.flux_enclosed(r / self.transport_mfp)
    }

    fn beyond(&self, r: f64) -> f64 {
        self.alpha_prime * self.sources.flux_beyond(r / self.transport_mfp)
    }

    fn surface_albedo(&self) -> f64 {
        self.alpha_prime * self.sources.flux_total()
    }

    fn scale(&self) -> f64 {
        self.transport_mfp
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameterization;

    #[test]
    fn total_is_one_without_absorption_and_zero_without_scattering() {
        for eta in [0.05, 0.7, 1.0, 1.4, 3.0, 20.0] {
            let white = StandardDipole::from_medium(&Medium::new(0.0, 2.0, 0.3).unwrap(), eta).unwrap();
            assert!(
                (white.surface_albedo() - 1.0).abs() < 1e-15 && (white.enclosed(1e30) - 1.0).abs() < 1e-15
            );
            let black = StandardDipole::from_medium(&Medium::new(2.0, 0.0, 0.3).unwrap(), eta).unwrap();
            assert_eq!([black.surface_albedo(), black.eval(0.1), black.enclosed(1.0)], [0.0; 3]);
        }
    }

    #[test]
    fn new_refuses_what_has_no_dipole() {
        let appearance = |surface_albedo, length| Appearance {
            surface_albedo,
            length,
            parameterization: Parameterization::Mfp,
            g: 0.0,
        };
        assert!(StandardDipole::new(&appearance(0.5, 1.0), 0.0).is_err());
        assert!(StandardDipole::new(&appearance(0.5, 1.0), f64::NAN).is_err());
        assert!(StandardDipole::new(&appearance(0.5, 0.0), 1.4).is_err());
        assert!(StandardDipole::new(&appearance(1.5, 1.0), 1.4).is_err());
    }

    /// Giovanelli's case n = 1.5, α = 0.9, g = 0, where the exact total is 0.2599.
    #[test]
    fn total_is_what_the_paper_derives() {
        let reflected = 2.0 * fresnel_moment_1_from_inside(1.5);
        let a_f = (1.0 + reflected) / (1.0 - reflected);
        let s = 0.3f64.sqrt();
        let expected = 0.45 * (1.0 + (-4.0 / 3.0 * a_f * s).exp()) * (-s).exp();
        let medium = Medium::from_reduced(0.1, 0.9, 0.0).unwrap();
        let found = StandardDipole::from_medium(&medium, 1.5).unwrap().surface_albedo();
        assert!((found - expected).abs() < 1e-15, "{found}");
    }
}
