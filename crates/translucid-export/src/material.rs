//! A material whose numbers become constants, tables or sums.

use translucid_profile::Parameterization;
use translucid_profile::convention::Preset;

/// Parameters of a material for red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Surface albedos A, in [0, 1].
    pub surface_albedo: [f64; 3],
    /// Mean free paths or diffuse ones \[L\].
    pub length: [f64; 3],
    /// Which of the two they are.
    pub parameterization: Parameterization,
    /// The surface, where it is known; only exports of whole materials use it.
    pub surface: Option<Surface>,
}

/// The surface of a material, and whether it is clear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Index of refraction.
    pub ior: f64,
    /// Perceptual roughness, in [0, 1].
    pub roughness: f64,
    /// Weight and perceptual roughness of the clear coat, in [0, 1].
    pub coat: [f64; 2],
    /// Color of white light behind a depth of what is clear, and that depth \[L\].
    pub clear: Option<([f64; 3], f64)>,
}

impl Material {
    /// The material of a preset, its lengths in a unit of so many millimeters.
    pub fn of_preset(preset: &Preset, millimeters: f64) -> Self {
        Self {
            surface_albedo: preset.surface_albedo(),
            length: preset.mfp_in_millimeters().map(|mfp| mfp / millimeters),
            parameterization: Parameterization::Mfp,
            surface: Some(Surface {
                ior: preset.eta,
                roughness: preset.roughness,
                coat: preset.coat,
                clear: preset.clear_color().map(|color| (color, Preset::CLEAR_DEPTH / millimeters)),
            }),
        }
    }
}
