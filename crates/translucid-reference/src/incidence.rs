//! Directions in which light enters the medium.

use translucid_profile::{Configuration, fresnel_from_outside, fresnel_moment_1_from_outside};

/// Directions in which light enters, at one point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Incidence {
    /// A pencil beam that arrives from outside at an angle of incidence, in the plane y = 0 towards +x.
    Pencil {
        /// Cosine of the angle of incidence outside, in (0, 1].
        cos_theta: f64,
    },
    /// Light of equal radiance from all directions outside: a cosine distribution, less what the boundary
    /// reflects. (*Diffuse transmission* in Christensen and Burley 2015.)
    Cosine,
    /// Directions inside the medium distributed uniformly in the cosine μ ∈ (0, 1): as from an isotropic
    /// source on the surface. Its totals are elementary, which makes it a test.
    UniformCosine,
}

impl Incidence {
    /// A pencil beam along the normal (*searchlight*).
    pub const NORMAL: Self = Self::Pencil { cos_theta: 1.0 };
}

impl From<Configuration> for Incidence {
    fn from(configuration: Configuration) -> Self {
        match configuration {
            Configuration::Searchlight => Self::NORMAL,
            Configuration::Diffuse => Self::Cosine,
        }
    }
}

/// Part of the incident flux that the boundary reflects before it enters, in [0, 1].
///
/// η = n_inside/n_outside. Exact Fresnel reflectance of the pencil; for the cosine distribution
/// 2 ∫ F(μ) μ dμ; 0 where the entry is given inside the medium.
///
/// ```
/// use translucid_reference::{Incidence, specular_reflectance};
///
/// assert!((specular_reflectance(Incidence::NORMAL, 1.5) - 0.04).abs() < 1e-15);
/// assert_eq!(specular_reflectance(Incidence::Cosine, 1.0), 0.0);
/// ```
pub fn specular_reflectance(incidence: Incidence, eta: f64) -> f64 {
    match incidence {
        Incidence::Pencil { cos_theta } => fresnel_from_outside(cos_theta, eta),
        Incidence::Cosine => 2.0 * fresnel_moment_1_from_outside(eta),
        Incidence::UniformCosine => 0.0,
    }
}
