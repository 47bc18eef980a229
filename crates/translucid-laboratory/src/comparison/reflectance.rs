//! Curves R(r) of one surface albedo.

use translucid_profile::{Configuration, Profile};

use super::{Contender, Reference, RingPoint, Walk, chi_square_probability};

/// One profile over the radii of a [`Reflectance`].
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// [`Contender::name`], or "exact" for the reference.
    pub name: &'static str,
    /// R(r) \[ℓ⁻²\].
    pub reflectance: Vec<f64>,
    /// Energy that leaves within r.
    pub enclosed: Vec<f64>,
}

/// Reflectance over the radius at one surface albedo: the exact solution, the walk and the contenders.
#[derive(Clone, Debug, PartialEq)]
pub struct Reflectance {
    /// Way in which light enters.
    pub configuration: Configuration,
    /// Surface albedo A.
    pub surface_albedo: f64,
    /// Single-scattering albedo of the medium that returns A.
    pub single_scattering_albedo: f64,
    /// Radii in mean free paths, rising evenly in ln r.
    pub radii: Vec<f64>,
    /// The exact solution.
    pub exact: Curve,
    /// The contenders that know the configuration and reach A.
    pub curves: Vec<Curve>,
    /// The walk's rings.
    pub points: Vec<RingPoint>,
}

impl Reflectance {
    /// Radii of a curve.
    pub const RADII: usize = 200;
    /// The first of them, in mean free paths.
    pub const LEAST_RADIUS: f64 = 0.01;

    /// Evaluates everything up to a radius greater than 0.01.
    pub fn new(
        reference: &Reference,
        contenders: &[&Contender],
        walk: Option<&Walk>,
        max_radius: f64,
    ) -> Self {
        let ratio = (max_radius / Self::LEAST_RADIUS).powf(1.0 / (Self::RADII - 1) as f64);
        let radii: Vec<f64> = (0..Self::RADII as i32).map(|i| Self::LEAST_RADIUS * ratio.powi(i)).collect();
        let known = contenders.iter().filter(|one| one.knows(reference.configuration));
        let curves =
            known.filter_map(|one| Some(curve(one.name, &*one.profile(reference).ok()?, &radii))).collect();
        Self {
            configuration: reference.configuration,
            surface_albedo: reference.surface_albedo,
            single_scattering_albedo: reference.single_scattering_albedo(),
            exact: curve("exact", &reference.exact, &radii),
            curves,
            points: walk.map(|walk| walk.points(reference)).unwrap_or_default(),
            radii,
        }
    }

    /// χ² of the walk's rings against the exact solution, how many there are, and how often chance alone is as far off.
    pub fn chi_square(&self) -> (f64, usize, f64) {
        let chi_square = self.points.iter().map(|point| point.deviate().powi(2)).sum();
        (chi_square, self.points.len(), chi_square_probability(chi_square, self.points.len()))
    }

    /// The greatest distance of a ring from the exact solution, in standard errors; 0 without rings.
    pub fn greatest_deviate(&self) -> f64 {
        self.points.iter().map(|point| point.deviate().abs()).fold(0.0, f64::max)
    }
}

fn curve(name: &'static str, profile: &dyn Profile, radii: &[f64]) -> Curve {
    Curve {
        name,
        reflectance: radii.iter().map(|r| profile.eval(*r)).collect(),
        enclosed: radii.iter().map(|r| profile.enclosed(*r)).collect(),
    }
}
