//! From a system's length and the surface albedo to the width of the profile or to the mean free path.

use std::f64::consts::PI;

use super::SurfaceAlbedo;
use super::multiscatter::single_scattering_albedo;
use super::skin::mfp_per_radius;
use crate::error::{ParameterError, require};
use crate::{scaling_from_dmfp_searchlight, scaling_from_mfp_diffuse, scaling_from_mfp_searchlight};

/// Meaning of a system's parameters.
#[derive(Clone, Copy, Debug)]
pub(super) enum Rule {
    /// d = length × factor.
    Width(Factor),
    /// ℓ* = length × factor.
    Mfp(Factor),
    /// σ_a and σ_s, of which the surface albedo is a consequence.
    Medium,
    /// σ_a and σ_s whose α' is taken for the surface albedo: d = 1/(σ'_t s(α')) with the diffuse fit.
    MediumAsProfile,
}

/// Factor of a length, a function of the surface albedo and of the settings.
#[derive(Clone, Copy, Debug)]
pub(super) enum Factor {
    /// 1.
    One,
    /// 1/5, which pbrt-v3 has from the authors of the Disney model.
    Fifth,
    /// 1/4π, kept by Cycles to look like the cubic and Gaussian profiles it had before.
    OverFourPi,
    /// 1/(4π s(A)), s diffuse.
    OverFourPiDiffuse,
    /// 1/(4π s(A/max A)), s diffuse.
    OverFourPiDiffuseOfRelative,
    /// 1/s(A), s searchlight from ℓ; A kept in the two limits.
    OverSearchlight(f64, f64),
    /// 1/(0.6 s(A)), s searchlight from ℓ.
    OverSixTenthsSearchlight,
    /// 1/(0.6 s(A)) where the code forgets the absolute value: s = 1.85 − A + 7 (A − 0.8)³.
    OverSixTenthsSigned,
    /// 1/s(A), s from ℓ_d; A not below the limit.
    OverDiffuseMfp(f64),
    /// 1/(1 − αg) with α of the color and the setting for g: from 1/σ_t to ℓ*.
    OverOneMinusAlphaG,
    /// α/max α, α not below a thousandth of the greatest: Adobe's σ_s is alike in all channels.
    OfGreatestAlpha,
    /// √(3(1 − α')) of a dipole ([`super::skin`]), the setting being the index of refraction.
    Skin,
}

impl Factor {
    /// The factor, greater than 0.
    pub(super) fn value(self, albedo: SurfaceAlbedo, setting: f64) -> Result<f64, ParameterError> {
        let a = albedo.of_channel();
        Ok(match self {
            Self::One => 1.0,
            Self::Fifth => 0.2,
            Self::OverFourPi => 0.25 / PI,
            Self::OverFourPiDiffuse => 0.25 / PI / scaling_from_mfp_diffuse(a),
            Self::OverFourPiDiffuseOfRelative => {
                0.25 / PI / scaling_from_mfp_diffuse(a / albedo.greatest().max(1e-6))
            }
            Self::OverSearchlight(least, most) => 1.0 / scaling_from_mfp_searchlight(a.max(least).min(most)),
            Self::OverSixTenthsSearchlight => 1.0 / (0.6 * scaling_from_mfp_searchlight(a)),
            Self::OverSixTenthsSigned => 1.0 / (0.6 * signed_searchlight(a)?),
            Self::OverDiffuseMfp(least) => 1.0 / scaling_from_dmfp_searchlight(a.max(least)),
            Self::OverOneMinusAlphaG => 1.0 / (1.0 - setting * single_scattering_albedo(a, setting)),
            Self::OfGreatestAlpha => {
                let (alpha, greatest) =
                    (single_scattering_albedo(a, 0.0), single_scattering_albedo(albedo.greatest(), 0.0));
                if greatest > 0.0 { (alpha / greatest).max(1e-3) } else { 1.0 }
            }
            Self::Skin => mfp_per_radius(a, setting),
        })
    }
}

/// The searchlight fit without its absolute value, which is negative for dark albedos.
fn signed_searchlight(a: f64) -> Result<f64, ParameterError> {
    let t = a - 0.8;
    let s = 1.85 - a + 7.0 * t * t * t;
    require(s > 0.0, "surface_albedo", a, "above 0.18 here, since the rule's s(A) is negative below")?;
    Ok(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signed_searchlight_is_negative_for_dark_albedos() {
        assert!(signed_searchlight(0.1).is_err() && signed_searchlight(0.179).is_err());
        assert!(signed_searchlight(0.18).is_ok());
        // Where A ≥ 0.8 the absolute value does nothing
        assert_eq!(signed_searchlight(0.9).unwrap(), scaling_from_mfp_searchlight(0.9));
    }

    #[test]
    fn relative_albedo_does_not_divide_by_zero() {
        let black = SurfaceAlbedo::gray(0.0).unwrap();
        let factor = Factor::OverFourPiDiffuseOfRelative.value(black, 0.0).unwrap();
        assert_eq!(factor, 0.25 / PI / scaling_from_mfp_diffuse(0.0));
    }
}
