//! Subsurface scattering of Blender Cycles: its methods by version, and the material of translucid that looks the same.
//!
//! The sources of the rules are those of the systems ([`super::known`]), which have their rules from here.

use super::rule::Factor;
use super::{CyclesWalk, SurfaceAlbedo};
use crate::error::{InputError, ParameterError, require, require_non_negative};
use crate::{Model, scaling_from_mfp_diffuse};

/// Method of subsurface scattering in Blender Cycles, by its name in Blender 5.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CyclesMethod {
    /// Christensen-Burley.
    Burley,
    /// Random Walk.
    RandomWalk,
    /// Random Walk (Legacy).
    RandomWalkLegacy,
    /// Random Walk (Skin).
    RandomWalkSkin,
}

/// Versions of Blender from which methods have other names.
const SINCE: [[u32; 2]; 3] = [[5, 2], [4, 0], [3, 0]];

/// Identifiers of the methods from each version on, empty where it has no such method.
const NAMES: [(CyclesMethod, [&str; 3]); 4] = [
    (CyclesMethod::Burley, ["BURLEY", "BURLEY", "BURLEY"]),
    (CyclesMethod::RandomWalk, ["RANDOM_WALK", "", ""]),
    (CyclesMethod::RandomWalkLegacy, ["RANDOM_WALK_LEGACY", "RANDOM_WALK", "RANDOM_WALK_FIXED_RADIUS"]),
    (CyclesMethod::RandomWalkSkin, ["RANDOM_WALK_SKIN", "RANDOM_WALK_SKIN", "RANDOM_WALK"]),
];

/// Flights after which Cycles goes on in the similar isotropic medium.
const ANISOTROPIC_FLIGHTS: f64 = 10.0;

/// Most colors whose albedos are found one by one, which takes microseconds each.
const POINTS: usize = 4096;

impl CyclesMethod {
    /// The method of an identifier in a version of Blender, like (5, 2, 3).
    ///
    /// # Errors
    /// The version is before (3, 0), or has no such method.
    pub fn named(version: &[u32], name: &str) -> Result<Self, InputError> {
        let Some(column) = SINCE.iter().position(|since| version >= &since[..]) else {
            let numbers: Vec<String> = version.iter().map(u32::to_string).collect();
            let message = format!("version is ({}), but must be (3, 0) or later", numbers.join(", "));
            return Err(InputError::new(message));
        };
        let names = NAMES.iter().map(|(method, names)| (*method, names[column]));
        let names: Vec<(Self, &str)> = names.filter(|(_, name)| !name.is_empty()).collect();
        names.iter().find(|(_, known)| *known == name).map(|(method, _)| *method).ok_or_else(|| {
            let all: Vec<&str> = names.iter().map(|(_, name)| *name).collect();
            InputError::new(format!("method is '{name}', but must be one of {}", all.join(", ")))
        })
    }

    /// Factor from the radius to the width d of Burley's profile, or to the length that [`CyclesWalk::mfp`] takes.
    pub(super) const fn factor(self) -> Factor {
        match self {
            Self::Burley | Self::RandomWalkLegacy => Factor::OverFourPi,
            Self::RandomWalk => Factor::One,
            Self::RandomWalkSkin => Factor::Skin,
        }
    }

    /// The random walk in media of a mean cosine g; none of Burley's profile.
    pub(super) fn walk(self, g: f64) -> Option<CyclesWalk> {
        match self {
            Self::Burley => None,
            // Every walk scatters backward as the new one does
            Self::RandomWalkLegacy | Self::RandomWalkSkin if g >= 0.0 => Some(CyclesWalk::legacy(g)),
            _ => Some(CyclesWalk::new(g)),
        }
    }
}

/// Subsurface scattering of Blender Cycles as a material of translucid that looks the same.
///
/// Walks end after 256 flights.
/// With an anisotropy Cycles goes on in the similar isotropic medium after 10 flights; the walk here does not, and ends as
/// late as that would.
#[derive(Clone, Debug)]
pub struct CyclesMaterial {
    method: CyclesMethod,
    walk: Option<CyclesWalk>,
    ior: f64,
    alpha: f64,
}

/// A key of scene files, and its value.
type Key<T> = (&'static str, T);

impl CyclesMaterial {
    /// A method with the index of refraction that refracts the view, the mean cosine g, which is clamped as the version of
    /// Blender does, and the width α of the facets.
    ///
    /// # Errors
    /// A number is not finite, or one but the anisotropy is negative.
    pub fn new(
        method: CyclesMethod,
        version: &[u32],
        ior: f64,
        anisotropy: f64,
        alpha: f64,
    ) -> Result<Self, ParameterError> {
        require(anisotropy.is_finite(), "anisotropy", anisotropy, "finite")?;
        let (ior, alpha) = (require_non_negative("ior", ior)?, require_non_negative("alpha", alpha)?);
        let g = anisotropy.max(if version >= &SINCE[0][..] { -0.9 } else { 0.0 });
        Ok(Self { method, walk: method.walk(g), ior, alpha })
    }

    /// Keys of scene files that depend on neither color nor radius: names, and numbers.
    pub fn keys(&self) -> (Vec<Key<&'static str>>, Vec<Key<f64>>) {
        let mut names = vec![("subsurface_parameter", "mfp")];
        let Some(walk) = &self.walk else {
            names.push(("subsurface_model", Model::NormalizedDiffusion.name()));
            names.push(("subsurface_configuration", "diffuse"));
            return (names, Vec::new());
        };
        // Where light is not absorbed, a flight in the similar medium stands for 1/(1 − g)
        let later = (CyclesWalk::MOST_FLIGHTS - ANISOTROPIC_FLIGHTS) / (1.0 - walk.g());
        let mut numbers = vec![
            ("subsurface_scatter_anisotropy", walk.g()),
            ("subsurface_eta", self.ior.max(1.01).min(3.0)),
            ("subsurface_flights", (ANISOTROPIC_FLIGHTS + later).round_ties_even()),
        ];
        if self.method == CyclesMethod::RandomWalkSkin {
            names.push(("subsurface_model", "random-walk-skin"));
        } else {
            names.push(("subsurface_model", "random-walk-rough"));
            numbers.push(("specular_roughness", self.alpha.min(1.0).sqrt()));
        }
        (names, numbers)
    }

    /// Surface albedos of colors, which are clamped to \[0, 1\], and mean free paths for a radius of 1: a single one where the
    /// color does not change it.
    ///
    /// Albedos of walks are those of the medium, without an end of the walks.
    /// Albedos that take a bisection are interpolated between 4096 colors where there are more.
    ///
    /// # Errors
    /// A color is not finite or negative.
    pub fn media(&self, colors: &[f64]) -> Result<(Vec<f64>, Vec<f64>), ParameterError> {
        colors.iter().try_for_each(|&color| require_non_negative("base_color", color).map(|_| ()))?;
        let mfp = |color: f64| {
            let factor = self.method.factor().value(SurfaceAlbedo::gray(color.min(1.0))?, self.ior)?;
            Ok(match &self.walk {
                Some(walk) => walk.mfp(factor),
                None => factor * scaling_from_mfp_diffuse(color),
            })
        };
        Ok(match &self.walk {
            None => {
                let mfps: Result<Vec<f64>, _> = colors.iter().map(|&color| mfp(color)).collect();
                (colors.iter().map(|color| color.min(1.0)).collect(), mfps?)
            }
            Some(walk) => {
                let albedos = of_colors(colors, |color| Ok(walk.surface_albedo_of_medium(color)))?;
                let is_skin = self.method == CyclesMethod::RandomWalkSkin;
                (albedos, if is_skin { of_colors(colors, mfp)? } else { vec![mfp(1.0)?] })
            }
        })
    }
}

/// A function of each color; of many it is interpolated between [`POINTS`] values.
fn of_colors(
    colors: &[f64],
    f: impl Fn(f64) -> Result<f64, ParameterError>,
) -> Result<Vec<f64>, ParameterError> {
    if colors.len() <= POINTS {
        return colors.iter().map(|&color| f(color)).collect();
    }
    let steps = (POINTS - 1) as f64;
    let table: Vec<f64> = (0..POINTS).map(|i| f(i as f64 / steps)).collect::<Result<_, _>>()?;
    let interpolated = |color: &f64| {
        let place = color.min(1.0) * steps;
        let i = (place as usize).min(POINTS - 2);
        table[i] + (place - i as f64) * (table[i + 1] - table[i])
    };
    Ok(colors.iter().map(interpolated).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Configuration::Diffuse;
    use crate::convention::System;

    #[test]
    fn methods_are_those_of_the_version() {
        for (version, expected) in [
            ([3, 6], CyclesMethod::RandomWalkSkin),
            ([5, 1], CyclesMethod::RandomWalkLegacy),
            ([6, 0], CyclesMethod::RandomWalk),
        ] {
            assert_eq!(CyclesMethod::named(&version, "RANDOM_WALK"), Ok(expected), "{version:?}");
        }
        let error = CyclesMethod::named(&[5, 1, 0], "CUBIC").unwrap_err().to_string();
        assert_eq!(error, "method is 'CUBIC', but must be one of BURLEY, RANDOM_WALK, RANDOM_WALK_SKIN");
        let error = CyclesMethod::named(&[2, 93], "BURLEY").unwrap_err().to_string();
        assert_eq!(error, "version is (2, 93), but must be (3, 0) or later");
    }

    /// A system has the transport mean free path, and the albedo without the light that is left after the last flight.
    #[test]
    fn media_are_those_of_the_systems() {
        for (method, system, g) in [
            (CyclesMethod::Burley, "cycles-burley", 0.0),
            (CyclesMethod::RandomWalk, "cycles-walk", -0.6),
            (CyclesMethod::RandomWalkLegacy, "cycles-walk-legacy", 0.8),
            (CyclesMethod::RandomWalkSkin, "cycles-skin", 0.3),
        ] {
            let system = System::named(system).next().unwrap();
            let values =
                if method == CyclesMethod::RandomWalkSkin { [1.0, 1.0, 1.4, g] } else { [1.0, 1.0, g, 0.0] };
            let material = CyclesMaterial::new(method, &[5, 2], 1.4, g, 1.0).unwrap();
            // Many are interpolated
            let many = material.media(&vec![0.5; POINTS + 1]).unwrap();
            for color in [0.2, 0.5, 0.8] {
                let (albedos, mfps) = material.media(&[color]).unwrap();
                let read = system.read(&values, SurfaceAlbedo::gray(color).unwrap(), Diffuse).unwrap();
                let alpha = method.walk(g).map_or(0.0, |walk| walk.single_scattering_albedo(color));
                let ratio = read.mfp() / mfps[0] * (1.0 - g * alpha);
                let unfinished = albedos[0] - read.albedo().of_channel();
                assert!((ratio - 1.0).abs() < 1e-14, "{method:?} {color}: {ratio}");
                assert!((-1e-15..0.082).contains(&unfinished), "{method:?} {color}: {unfinished}");
                assert!(color != 0.5 || (many.0[9] - albedos[0]).abs() < 1e-6);
                assert!(color != 0.5 || (many.1[0] - mfps[0]).abs() < 1e-3, "{method:?}");
            }
        }
    }
}
