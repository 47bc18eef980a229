//! The better dipole: Grosjean's diffusion from one point source, leaving by fluence and flux.
//!
//! E. d'Eon, *A Better Dipole*, 2012 (technical report).

use crate::error::ParameterError;
use crate::medium::diffusion_boundary::DiffusionBoundary;
use crate::model::dipole::source_pair::SourcePair;
use crate::{Appearance, Medium, Profile};

/// D'Eon's better dipole for one medium.
///
/// ```text
/// R(r) = α'²/4π Σ± ± [C_φ/D_G e^{−σ_tr d}/d + C_E z (1 + σ_tr d) e^{−σ_tr d}/d³]
///        over (z, d) = (z_r, d_r) with + and (−z_v, d_v) with −
/// z_r = ℓ*,   z_v = z_r + 4 A_F D_G,   d = √(r² + z²),   σ_tr = √(σ_a/D_G)
/// C_φ = ¼ (1 − 2C₁),   C_E = ½ (1 − 3C₂),   A_F = (1 + 3C₂)/(1 − 2C₁)
/// ```
///
/// D_G is Grosjean's diffusion coefficient ([`Medium::diffusion_coefficient`]), C₁ and C₂ are the moments of the
/// reflectance from inside ([`fresnel_moment_1_from_inside`](crate::fresnel_moment_1_from_inside),
/// [`fresnel_moment_2_from_inside`](crate::fresnel_moment_2_from_inside)).
/// Single scattering is no part of the model.
/// It reaches every surface albedo: its total is 1 without absorption.
///
/// Radii above 1e150 ℓ* count as that many.
///
/// ```
/// use translucid_profile::{Appearance, BetterDipole, Parameterization, Profile};
///
/// # fn main() -> Result<(), translucid_profile::ParameterError> {
/// let half = Appearance { surface_albedo: 0.5, length: 2.0, parameterization: Parameterization::Mfp, g: 0.0 };
/// let profile = BetterDipole::new(&half, 1.4)?;
/// assert!((profile.surface_albedo() - 0.5).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BetterDipole {
    /// α'² C_φ/D_G, in which D_G counts transport mean free paths.
    fluence_factor: f64,
    /// α'² C_E.
    flux_factor: f64,
    /// The two sources, in transport mean free paths.
    sources: SourcePair,
    /// ℓ* \[L\].
    transport_mfp: f64,
}

impl BetterDipole {
    /// Makes the dipole of a medium and a relative index η = n_inside/n_outside ∈ [0.05, 20].
    ///
    /// # Errors
    /// η is outside its range.
    pub fn from_medium(medium: &Medium, eta: f64) -> Result<Self, ParameterError> {
        Ok(Self::of(medium, &DiffusionBoundary::new(eta)?))
    }

    /// Makes the dipole whose total is a surface albedo A ∈ [0, 1], for a relative index η ∈ [0.05, 20].
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn new(appearance: &Appearance, eta: f64) -> Result<Self, ParameterError> {
        let boundary = DiffusionBoundary::new(eta)?;
        let total = |absorbed| Self::relative_dipole(&boundary, absorbed, 1.0 - absorbed).surface_albedo();
        Ok(Self::of(&appearance.medium(total)?, &boundary))
    }

    fn of(medium: &Medium, boundary: &DiffusionBoundary) -> Self {
        let absorbed = medium.sigma_a() / medium.sigma_t_prime();
        let relative = Self::relative_dipole(boundary, absorbed, medium.alpha_prime());
        Self { transport_mfp: medium.transport_mfp(), ..relative }
    }
}

impl BetterDipole {
    /// The dipole of transport mean free path 1 for 1 − α' = `absorbed`.
    fn relative_dipole(boundary: &DiffusionBoundary, absorbed: f64, alpha_prime: f64) -> Self {
        let diffusion_coefficient = (1.0 + absorbed) / 3.0;
        let sigma_tr = (absorbed / diffusion_coefficient).sqrt();
        let image = 1.0 + 4.0 * boundary.mismatch * diffusion_coefficient;
        let factor = alpha_prime * alpha_prime;
        Self {
            fluence_factor: factor * boundary.fluence / diffusion_coefficient,
            flux_factor: factor * boundary.flux,
            sources: SourcePair::new(sigma_tr, 1.0, image),
            transport_mfp: 1.0,
        }
    }

    /// R at a radius in transport mean free paths, times ℓ*².
    fn relative(&self, r: f64) -> f64 {
        self.fluence_factor * self.sources.fluence(r) + self.flux_factor * self.sources.flux(r)
    }
}

impl Profile for BetterDipole {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = r.max(0.0) / self.transport_mfp;
        self.relative(r) * r.min(1e150) / self.transport_mfp
    }

    fn eval(&self, r: f64) -> f64 {
        (self.relative(r / self.transport_mfp) / self.transport_mfp / self.transport_mfp).min(f64::MAX)
    }

    fn enclosed(&self, r: f64) -> f64 {
        let r = r / self.transport_mfp;
        self.fluence_factor * self.sources.fluence_enclosed(r)
            + self.flux_factor * self.sources.flux_enclosed(r)
    }

    fn beyond(&self, r: f64) -> f64 {
        let r = r / self.transport_mfp;
        self.fluence_factor * self.sources.fluence_beyond(r) + self.flux_factor * self.sources.flux_beyond(r)
    }

    /// ```text
    /// A = α'²/2 [C_φ/(D_G σ_tr) (1 − e^{−σ_tr (z_v − z_r)}) + C_E (1 + e^{−σ_tr (z_v − z_r)})] e^{−σ_tr z_r}
    /// ```
    fn surface_albedo(&self) -> f64 {
        self.fluence_factor * self.sources.fluence_total() + self.flux_factor * self.sources.flux_total()
    }

    fn scale(&self) -> f64 {
        self.transport_mfp
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{fresnel_moment_1_from_inside, fresnel_moment_2_from_inside};

    #[test]
    fn total_is_one_without_absorption_and_zero_without_scattering() {
        for eta in [0.05, 0.7, 1.0, 1.4, 3.0, 20.0] {
            let white = BetterDipole::from_medium(&Medium::new(0.0, 2.0, 0.3).unwrap(), eta).unwrap();
            assert!((white.surface_albedo() - 1.0).abs() < 1e-15, "{eta}: {}", white.surface_albedo());
            assert!((white.enclosed(1e30) - 1.0).abs() < 1e-15, "{eta}: {}", white.surface_albedo());
            let black = BetterDipole::from_medium(&Medium::new(2.0, 0.0, 0.3).unwrap(), eta).unwrap();
            assert_eq!([black.surface_albedo(), black.eval(0.1), black.enclosed(1.0)], [0.0; 3]);
        }
    }

    #[test]
    fn total_is_the_closed_form() {
        for eta in [0.7, 1.0, 1.4, 3.0] {
            let (c_1, c_2) = (fresnel_moment_1_from_inside(eta), fresnel_moment_2_from_inside(eta));
            for absorbed in [1e-9, 1e-3, 0.2, 0.9] {
                let d = (1.0 + absorbed) / 3.0;
                let s = f64::sqrt(absorbed / d);
                let x = (-s * 4.0 * d * (1.0 + 3.0 * c_2) / (1.0 - 2.0 * c_1)).exp();
                let fluence = 0.25 * (1.0 - 2.0 * c_1) * (1.0 - x) / (d * s);
                let flux = 0.5 * (1.0 - 3.0 * c_2) * (1.0 + x);
                let expected = 0.5 * (1.0 - absorbed).powi(2) * (fluence + flux) * (-s).exp();
                let medium = Medium::from_reduced(absorbed, 1.0 - absorbed, 0.0).unwrap();
                let found = BetterDipole::from_medium(&medium, eta).unwrap().surface_albedo();
                // The plain formula loses the digits that 1 − x loses
                assert!((found - expected).abs() < 1e-11, "{eta} {absorbed}: {found} {expected}");
            }
        }
    }

    #[test]
    fn constructors_refuse_what_has_no_dipole() {
        let medium = Medium::new(0.1, 1.0, 0.0).unwrap();
        for eta in [0.0, -1.0, 0.04, 21.0, f64::NAN, f64::INFINITY] {
            assert!(BetterDipole::from_medium(&medium, eta).is_err(), "{eta}");
        }
    }
}
