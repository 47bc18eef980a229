//! From a surface albedo to the medium that has it, according to a model.

use crate::error::{ParameterError, require, require_fraction, require_positive};
use crate::math::roots::falling_root;
use crate::medium::half_space::half_space_absorption;
use crate::medium::media::transport_mfp_over_dmfp;
use crate::{Configuration, Medium, Parameterization};

/// Looks of a translucent material: a surface albedo, a length, and the phase function's mean cosine.
///
/// The length is the mean free path ℓ = 1/σ_t or the diffuse mean free path ℓ_d = √(D_G/σ_a) with Grosjean's D_G
/// ([`Medium::dmfp`]), as the parameterization says, for every model alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Surface albedo A in [0, 1].
    pub surface_albedo: f64,
    /// Mean free path or diffuse mean free path, greater than 0 \[L\].
    pub length: f64,
    /// Which of the two it is.
    pub parameterization: Parameterization,
    /// Mean cosine of the phase function, in (−1, 1).
    pub g: f64,
}

impl Appearance {
    /// The medium for which a model's `total` is the surface albedo, to 1e-10 and better.
    ///
    /// `total` gets 1 − α' with all its digits, α' being the reduced albedo, and rises with α'.
    /// It is nearly straight in √(1 − α'), which is what the root finder sees.
    ///
    /// # Errors
    /// A parameter is out of its range, or no α' ∈ [0, 1] reaches the surface albedo; the error then has the most
    /// that the model reaches as its limit.
    pub fn medium(&self, total: impl Fn(f64) -> f64) -> Result<Medium, ParameterError> {
        let target = require_fraction("surface_albedo", self.surface_albedo)?;
        require_positive("length", self.length)?;
        let most = total(0.0);
        // A total that is 1 but for rounding reaches 1
        if target > most + 1e-14 {
            let allowed = "at most what the model reaches,";
            return Err(ParameterError {
                parameter: "surface_albedo",
                value: target,
                allowed,
                limit: Some(most),
            });
        }
        let excess = |root: f64| total(root * root) - target;
        let root = if target == 0.0 {
            1.0
        } else if target >= most {
            0.0
        } else {
            falling_root(excess, [most - target, -target], |_| 1e-15 + 1e-13 * target)
        };
        self.with_absorption(root * root)
    }

    /// The medium of reduced albedo α' = 1 − `absorbed` and the length that is sought.
    fn with_absorption(&self, absorbed: f64) -> Result<Medium, ParameterError> {
        require(self.g > -1.0 && self.g < 1.0, "g", self.g, "in (-1, 1)")?;
        let alpha_prime = 1.0 - absorbed;
        let transport_mfp = match self.parameterization {
            Parameterization::Mfp => self.length * (absorbed + alpha_prime / (1.0 - self.g)),
            Parameterization::Dmfp => {
                require(absorbed > 0.0, "surface_albedo", self.surface_albedo, "less than 1 with a dmfp")?;
                self.length * transport_mfp_over_dmfp(absorbed)
            }
        };
        // Of the medium's parameters the length alone can be at fault now
        let allowed = "such that the mean free path is in [1e-150, 1e150]";
        Medium::from_reduced(absorbed / transport_mfp, alpha_prime / transport_mfp, self.g)
            .map_err(|_| ParameterError::new("length", self.length, allowed))
    }
}

/// The mean free path \[L\] behind a surface albedo and a length, which is it or the diffuse one.
pub(crate) fn half_space_mfp(
    surface_albedo: f64,
    length: f64,
    parameterization: Parameterization,
    configuration: Configuration,
) -> Result<f64, ParameterError> {
    require_fraction("surface_albedo", surface_albedo)?;
    require_positive("length", length)?;
    let mfp = match parameterization {
        Parameterization::Mfp => length,
        Parameterization::Dmfp => {
            require(surface_albedo < 1.0, "surface_albedo", surface_albedo, "less than 1 with a dmfp")?;
            length * transport_mfp_over_dmfp(half_space_absorption(surface_albedo, configuration))
        }
    };
    let allowed = "such that the mean free path is in [1e-150, 1e150]";
    require((1e-150..=1e150).contains(&mfp), "length", length, allowed)?;
    Ok(mfp)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn appearance(
        surface_albedo: f64,
        length: f64,
        parameterization: Parameterization,
        g: f64,
    ) -> Appearance {
        Appearance { surface_albedo, length, parameterization, g }
    }

    /// A total with the shape of a half space's.
    fn total(absorbed: f64) -> f64 {
        let root = absorbed.sqrt();
        (1.0 - root) / (1.0 + 1.3 * root)
    }

    #[test]
    fn medium_has_the_surface_albedo_and_the_length() {
        for a in [0.0, 1e-12, 1e-3, 0.3, 0.9, 0.9999, 1.0] {
            for g in [-0.7, 0.0, 0.9] {
                let m = appearance(a, 2.5, Parameterization::Mfp, g).medium(total).unwrap();
                let absorbed = m.sigma_a() / m.sigma_t_prime();
                assert!((total(absorbed) - a).abs() < 1e-13, "{a} {g}: {}", total(absorbed));
                assert!((m.mfp() / 2.5 - 1.0).abs() < 1e-14, "{a} {g}: {}", m.mfp());
                if a < 1.0 {
                    let m = appearance(a, 2.5, Parameterization::Dmfp, g).medium(total).unwrap();
                    assert!((m.dmfp() / 2.5 - 1.0).abs() < 1e-12, "{a} {g}: {}", m.dmfp());
                }
            }
        }
    }

    #[test]
    fn medium_refuses_what_the_model_cannot_reach() {
        let error = appearance(0.95, 1.0, Parameterization::Mfp, 0.0).medium(|x| 0.9 * total(x)).unwrap_err();
        let message = "surface_albedo is 0.95, but must be at most what the model reaches, 0.9";
        assert_eq!(error.to_string(), message);
        assert!(appearance(1.0, 1.0, Parameterization::Dmfp, 0.0).medium(total).is_err());
        assert!(appearance(0.5, 0.0, Parameterization::Mfp, 0.0).medium(total).is_err());
        assert!(appearance(0.5, 1.0, Parameterization::Mfp, 1.0).medium(total).is_err());
        assert!(appearance(f64::NAN, 1.0, Parameterization::Mfp, 0.0).medium(total).is_err());
        // In the words of who asked
        for (length, parameterization) in [(1e-160, Parameterization::Mfp), (1e200, Parameterization::Dmfp)] {
            let error = appearance(0.5, length, parameterization, 0.0).medium(total).unwrap_err();
            assert_eq!([error.value, f64::from(u8::from(error.parameter == "length"))], [length, 1.0]);
        }
    }
}
