//! A material whose numbers become constants, tables or sums.

use translucid_profile::Parameterization;

/// Parameters of a material for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Surface albedos A, in [0, 1].
    pub surface_albedo: [f64; 3],
    /// Mean free paths or diffuse ones \[L\].
    pub length: [f64; 3],
    /// Which of the two they are.
    pub parameterization: Parameterization,
}
