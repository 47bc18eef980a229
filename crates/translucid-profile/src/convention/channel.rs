//! One channel of a material between two systems.

use crate::convention::SurfaceAlbedo;
use crate::error::{ParameterError, require};
use crate::{Configuration, Parameterization, scaling};

/// Lengths outside leave no room for the factors of the rules and for reciprocals.
const LENGTH_MIN: f64 = 1e-120;
const LENGTH_MAX: f64 = 1e120;

/// One channel of a material: surface albedo A, transport mean free path ℓ* and width d of Burley's profile.
///
/// ```text
/// d = ℓ*/s(A)                                                        (Christensen & Burley 2015, eq. 5 or 6)
/// ```
///
/// Both lengths are in one unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Channel {
    albedo: SurfaceAlbedo,
    mfp: f64,
    d: f64,
}

impl Channel {
    /// A channel whose profile has the width d \[L\].
    ///
    /// # Errors
    /// d is neither 0, for a Lambertian channel, nor in [1e-120, 1e120].
    pub fn from_d(
        albedo: SurfaceAlbedo,
        d: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        require_length("d", d)?;
        Ok(Self { albedo, mfp: d * scale(albedo, configuration), d })
    }

    /// A channel whose medium has the transport mean free path ℓ* \[L\].
    ///
    /// # Errors
    /// ℓ* is neither 0, for a Lambertian channel, nor in [1e-120, 1e120].
    pub fn from_mfp(
        albedo: SurfaceAlbedo,
        mfp: f64,
        configuration: Configuration,
    ) -> Result<Self, ParameterError> {
        require_length("mfp", mfp)?;
        Ok(Self { albedo, mfp, d: mfp / scale(albedo, configuration) })
    }

    /// Converts lengths to another unit, of which one old unit has `factor`.
    ///
    /// # Errors
    /// A length leaves [1e-120, 1e120].
    pub fn in_unit(&self, factor: f64) -> Result<Self, ParameterError> {
        let (mfp, d) = (self.mfp * factor, self.d * factor);
        require_length("mfp", mfp)?;
        require_length("d", d)?;
        Ok(Self { albedo: self.albedo, mfp, d })
    }

    /// The channel beside others of which the greatest surface albedo is `greatest`.
    pub(super) fn among(&self, greatest: f64) -> Result<Self, ParameterError> {
        Ok(Self { albedo: SurfaceAlbedo::new(self.albedo.of_channel(), greatest)?, ..*self })
    }

    /// Surface albedo A.
    pub fn albedo(&self) -> SurfaceAlbedo {
        self.albedo
    }

    /// Transport mean free path ℓ* \[L\].
    pub fn mfp(&self) -> f64 {
        self.mfp
    }

    /// Width d of Burley's profile \[L\].
    pub fn d(&self) -> f64 {
        self.d
    }
}

fn scale(albedo: SurfaceAlbedo, configuration: Configuration) -> f64 {
    scaling(albedo.of_channel(), Parameterization::Mfp, configuration)
}

fn require_length(parameter: &'static str, length: f64) -> Result<f64, ParameterError> {
    let is_moderate = length == 0.0 || (LENGTH_MIN..=LENGTH_MAX).contains(&length);
    require(is_moderate, parameter, length, "0 or in [1e-120, 1e120]")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn from_d_and_from_mfp_agree() {
        let albedo = SurfaceAlbedo::gray(0.8).unwrap();
        // s = 1.9 − 0.8 = 1.1
        let channel = Channel::from_mfp(albedo, 2.2, Configuration::Diffuse).unwrap();
        assert!((channel.d() - 2.0).abs() < 1e-15);
        let back = Channel::from_d(albedo, channel.d(), Configuration::Diffuse).unwrap();
        assert!((back.mfp() - 2.2).abs() < 1e-15);
        assert!((back.in_unit(10.0).unwrap().d() - 20.0).abs() < 1e-14);
    }

    #[test]
    fn lengths_have_room_on_both_sides() {
        let albedo = SurfaceAlbedo::gray(0.5).unwrap();
        assert_eq!(Channel::from_mfp(albedo, 0.0, Configuration::Diffuse).unwrap().d(), 0.0);
        for bad in [-1.0, f64::NAN, f64::INFINITY, 1e-121, 1e121] {
            assert!(Channel::from_d(albedo, bad, Configuration::Diffuse).is_err());
            assert!(Channel::from_mfp(albedo, bad, Configuration::Diffuse).is_err());
        }
        let channel = Channel::from_d(albedo, 1e100, Configuration::Diffuse).unwrap();
        assert!(channel.in_unit(1e30).is_err() && channel.in_unit(1e-300).is_err());
    }
}
