//! From surface albedo A and a mean free path to the profile's width d = length / s(A).
//!
//! Source of every polynomial for s: P. H. Christensen and B. Burley, *Approximate Reflectance Profiles for
//! Efficient Subsurface Scattering*, Pixar Technical Memo 15-04, 2015, equations 5, 6 and 8.
//! The one between the two mean free paths is fitted to the exact half space.

use crate::math::polynomial::polynomial;
use crate::medium::length_coefficients;

/// Way in which light enters the medium in the profile's model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Configuration {
    /// A pencil beam enters perpendicularly.
    Searchlight,
    /// Light enters at a point with a cosine distribution (the talk's "diffuse transmission").
    #[default]
    Diffuse,
}

/// The length that a profile is built from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Parameterization {
    /// Mean free path ℓ in the volume.
    #[default]
    Mfp,
    /// Diffuse mean free path ℓ_d on the surface.
    Dmfp,
}

impl Configuration {
    /// Every configuration by its name, in the order of the variants.
    pub const WORDS: [(&'static str, Self); 2] =
        [("searchlight", Self::Searchlight), ("diffuse", Self::Diffuse)];

    /// The name that commands and scene files use.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// The configuration of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, configuration)| configuration)
    }
}

impl Parameterization {
    /// Every parameterization by its name, in the order of the variants.
    pub const WORDS: [(&'static str, Self); 2] = [("mfp", Self::Mfp), ("dmfp", Self::Dmfp)];

    /// The name that commands and scene files use.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// The configuration for which the parameterization is fitted in other renderers: the one that is taken where none is named.
    pub fn usual_configuration(self) -> Configuration {
        match self {
            Self::Mfp => Configuration::Diffuse,
            Self::Dmfp => Configuration::Searchlight,
        }
    }
}

/// Scale s(A) from the mean free path ℓ in the searchlight configuration, dimensionless.
///
/// ```text
/// s = 1.85 − A + 7 |A − 0.8|³                                        (Christensen & Burley 2015, eq. 5)
/// ```
///
/// A outside [0, 1] is clamped; NaN counts as 0.
/// Mean error of the profile against Monte Carlo about 5.5 % (as the authors state it).
///
/// ```
/// assert!((translucid_profile::scaling_from_mfp_searchlight(0.8) - 1.05).abs() < 1e-15);
/// ```
#[inline]
pub fn scaling_from_mfp_searchlight(surface_albedo: f64) -> f64 {
    let a = surface_albedo.max(0.0).min(1.0);
    let t = (a - 0.8).abs();
    1.85 - a + 7.0 * t * t * t
}

/// Scale s(A) from the mean free path ℓ in the diffuse transmission configuration, dimensionless.
///
/// ```text
/// s = 1.9 − A + 3.5 (A − 0.8)²                                       (Christensen & Burley 2015, eq. 6)
/// ```
///
/// A outside [0, 1] is clamped; NaN counts as 0.
/// Mean error of the profile against Monte Carlo about 3.9 % (as the authors state it).
///
/// ```
/// assert!((translucid_profile::scaling_from_mfp_diffuse(0.8) - 1.1).abs() < 1e-15);
/// ```
#[inline]
pub fn scaling_from_mfp_diffuse(surface_albedo: f64) -> f64 {
    let a = surface_albedo.max(0.0).min(1.0);
    let t = a - 0.8;
    1.9 - a + 3.5 * t * t
}

/// Scale s(A) from the diffuse mean free path ℓ_d in the searchlight configuration, dimensionless.
///
/// ```text
/// s = 3.5 + 100 (A − 0.33)⁴                                          (Christensen & Burley 2015, eq. 8)
/// ```
///
/// A outside [0, 1] is clamped; NaN counts as 0.
/// Mean error of the profile against Monte Carlo about 7.7 % (as the authors state it).
///
/// ```
/// assert!((translucid_profile::scaling_from_dmfp_searchlight(0.33) - 3.5).abs() < 1e-15);
/// ```
#[inline]
pub fn scaling_from_dmfp_searchlight(surface_albedo: f64) -> f64 {
    let a = surface_albedo.max(0.0).min(1.0);
    let t = (a - 0.33) * (a - 0.33);
    3.5 + 100.0 * t * t
}

/// Scale s(A) for any pair of parameterization and configuration, dimensionless.
///
/// The talk gives no fit for the pair (ℓ_d, diffuse transmission).
/// Its searchlight fit stands in, so that every pair has a profile: ℓ_d governs the far field, which hardly
/// remembers how the light entered.
/// Against the diffuse fit in ℓ, carried over to ℓ_d by the exact half space, s is then too large: by
/// at most 16 % for A ∈ [0.1, 0.7], 28 % for A ∈ [0.7, 0.8], 36 % for A ∈ [0.01, 0.1].
/// Where the diffuse configuration matters, state ℓ.
///
/// The fit in ℓ_d flattens towards A = 1, where ℓ_d grows without bound at a fixed ℓ; above A = 0.9 it
/// makes the profile far wider than the fits in ℓ do, by 1.6 times at A = 0.95.
#[inline]
pub fn scaling(surface_albedo: f64, parameterization: Parameterization, configuration: Configuration) -> f64 {
    match (parameterization, configuration) {
        (Parameterization::Mfp, Configuration::Searchlight) => scaling_from_mfp_searchlight(surface_albedo),
        (Parameterization::Mfp, Configuration::Diffuse) => scaling_from_mfp_diffuse(surface_albedo),
        (Parameterization::Dmfp, _) => scaling_from_dmfp_searchlight(surface_albedo),
    }
}

/// Width d = length / s(A) of the profile, in the unit of `length`.
///
/// Length 0 gives d = 0, the Lambertian limit, which the caller handles without a profile; a negative or
/// NaN length counts as 0.
///
/// ```
/// use translucid_profile::{Configuration, Parameterization, d_from_surface_albedo};
///
/// let d = d_from_surface_albedo(0.8, 2.1, Parameterization::Mfp, Configuration::Searchlight);
/// assert!((d - 2.0).abs() < 1e-14);
/// ```
#[inline]
pub fn d_from_surface_albedo(
    surface_albedo: f64,
    length: f64,
    parameterization: Parameterization,
    configuration: Configuration,
) -> f64 {
    length.max(0.0) / scaling(surface_albedo, parameterization, configuration)
}

/// ℓ/ℓ_d of the index-matched half space of isotropic scatterers with a surface albedo, with D after Grosjean.
pub(crate) fn mfp_per_dmfp(surface_albedo: f64, configuration: Configuration) -> f64 {
    (1.0 - surface_albedo) * mfp_per_dmfp_polynomial(surface_albedo, configuration)
}

/// (ℓ/ℓ_d) / (1 − A), which has a limit at A = 1.
pub(crate) fn mfp_per_dmfp_polynomial(surface_albedo: f64, configuration: Configuration) -> f64 {
    let coefficients = match configuration {
        Configuration::Searchlight => &length_coefficients::SEARCHLIGHT,
        Configuration::Diffuse => &length_coefficients::DIFFUSE,
    };
    polynomial(coefficients, surface_albedo)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PARAMETERIZATIONS: [Parameterization; 2] = [Parameterization::Mfp, Parameterization::Dmfp];
    const CONFIGURATIONS: [Configuration; 2] = [Configuration::Searchlight, Configuration::Diffuse];

    #[test]
    fn scaling_matches_values_worked_by_hand() {
        let close =
            |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        // 1.85 − 0.2 + 7·0.216, 1.85 − 0.5 + 7·0.027, 1.85 − 1 + 7·0.008
        close(scaling_from_mfp_searchlight(0.2), 3.162);
        close(scaling_from_mfp_searchlight(0.5), 1.539);
        close(scaling_from_mfp_searchlight(1.0), 0.906);
        // 1.9 − 0.2 + 3.5·0.36, 1.9 − 0.5 + 3.5·0.09, 1.9 − 1 + 3.5·0.04
        close(scaling_from_mfp_diffuse(0.2), 2.96);
        close(scaling_from_mfp_diffuse(0.5), 1.715);
        close(scaling_from_mfp_diffuse(1.0), 1.04);
        // 3.5 + 100·0.17⁴, 3.5 + 100·0.67⁴, 3.5 + 100·0.33⁴
        close(scaling_from_dmfp_searchlight(0.5), 3.583521);
        close(scaling_from_dmfp_searchlight(1.0), 23.651121);
        close(scaling_from_dmfp_searchlight(0.0), 4.685921);
    }

    /// The talk's searchlight polynomial against the best single s of the exact solution, all r.
    #[test]
    fn scaling_lies_near_the_best_single_scale() {
        let best = [3.950, 2.972, 2.359, 1.921, 1.594, 1.333, 1.132, 0.955, 0.816];
        for (i, expected) in best.iter().enumerate() {
            let found = scaling_from_mfp_searchlight(0.1 * (i + 1) as f64);
            // The worst of the nine is A = 0.9 with 17 %.
            assert!((found / expected - 1.0).abs() < 0.175, "{i}: {found} {expected}");
        }
    }

    /// The fit in ℓ carried over to ℓ_d by the exact half space: s_d = s ℓ_d/ℓ.
    fn scaling_from_dmfp_by_way_of_mfp(surface_albedo: f64, configuration: Configuration) -> f64 {
        let alpha = crate::half_space_single_scattering_albedo(surface_albedo, configuration);
        let medium = crate::Medium::from_mfp(alpha, 1.0, 0.0).unwrap();
        scaling(surface_albedo, Parameterization::Mfp, configuration) * medium.dmfp()
    }

    /// The talk's two searchlight fits are independent of each other and meet within their errors.
    #[test]
    fn scaling_from_dmfp_agrees_with_the_fit_in_mfp() {
        for i in 1..=9 {
            let a = 0.1 * f64::from(i);
            let ratio = scaling_from_dmfp_by_way_of_mfp(a, Configuration::Searchlight)
                / scaling_from_dmfp_searchlight(a);
            assert!((ratio - 1.0).abs() < 0.08, "{a}: {ratio}");
        }
    }

    #[test]
    fn scaling_from_dmfp_stands_in_for_diffuse_as_stated() {
        for (from, to, excess) in [(0.1, 0.7, 0.16), (0.7, 0.8, 0.28), (0.01, 0.1, 0.36)] {
            for step in 0..=4 {
                let a = from + (to - from) * f64::from(step) / 4.0;
                let ratio = scaling(a, Parameterization::Dmfp, Configuration::Diffuse)
                    / scaling_from_dmfp_by_way_of_mfp(a, Configuration::Diffuse);
                assert!(ratio > 1.0 && ratio < 1.0 + excess, "{a}: {ratio}");
            }
        }
    }

    #[test]
    fn scaling_clamps_albedos_and_stays_finite() {
        for p in PARAMETERIZATIONS {
            for c in CONFIGURATIONS {
                assert_eq!(scaling(-3.0, p, c), scaling(0.0, p, c));
                assert_eq!(scaling(f64::INFINITY, p, c), scaling(1.0, p, c));
                assert_eq!(scaling(f64::NAN, p, c), scaling(0.0, p, c));
                assert_eq!(d_from_surface_albedo(0.5, 0.0, p, c), 0.0);
                assert_eq!(d_from_surface_albedo(0.5, f64::NAN, p, c), 0.0);
            }
        }
    }
}
