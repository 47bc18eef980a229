//! Colors of plane layers over grounds, as an instrument measures them.
//!
//! An instrument of the geometry d:8° lights a sample from everywhere and looks at it at 8° from the normal.
//! By reciprocity it finds the reflectance and transmittance of a beam that arrives at 8°, which [`Layers::totals`] solves.
//! Layers are given channel by channel: one, three of linear Rec. 709, or those of a [`Spectrum`].

mod filament;
mod kubelka_munk;
mod swatch;
mod thin_wall;
mod thin_wall_numbers;
mod wall_slab;

pub use filament::{Filament, MEANINGS};
pub use kubelka_munk::kubelka_munk;
pub use swatch::{Field, Swatch};
pub use thin_wall::{DiffuseTransmissionWall, ScatteringWall, SlabChannel, SlabLight, ThinWall, WallErrors};
pub use thin_wall_numbers::{thin_wall_numbers, wall_slab_numbers};
pub use wall_slab::WallSlab;

use rayon::prelude::*;
use translucid_image::{ToneMapping, display_from_linear};
use translucid_profile::ParameterError;
use translucid_reference::Incidence;
use translucid_reference::layers::Layers;

use crate::colorimetry::{Colorimeter, Spectrum, WAVELENGTHS, delta_e_ab};

/// Cosine of 8°.
pub(crate) const COS_8_DEGREES: f64 = 0.990_268_068_741_570_3;

/// Whether a measurement has the light that returns without having been scattered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Specular {
    /// It has (di:8°).
    Included,
    /// A gloss trap takes it away (de:8°).
    Excluded,
}

/// What layers over one ground reflect and transmit, channel by channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Part of the light that returns.
    pub reflectance: Vec<f64>,
    /// Part of the light that leaves below, scattered or not.
    pub transmittance: Vec<f64>,
    /// Reflectance by [`kubelka_munk`].
    pub kubelka_munk: Vec<f64>,
    /// Estimated numerical errors of reflectance and transmittance.
    pub errors: Vec<f64>,
}

impl Measurement {
    /// Solves layers whose coefficients are those of the channels.
    ///
    /// # Errors
    /// Those of [`Layers::totals`].
    pub fn new(channels: &[Layers], specular: Specular) -> Result<Self, ParameterError> {
        let solve = |layers: &Layers| layers.totals(Incidence::Pencil { cos_theta: COS_8_DEGREES });
        let totals = channels.par_iter().map(solve).collect::<Result<Vec<_>, _>>()?;
        let gloss = if specular == Specular::Included { 1.0 } else { 0.0 };
        let reflectance = totals.iter().map(|t| gloss * t.specular_reflectance + t.diffuse_reflectance);
        let transmittance = totals.iter().map(|t| t.collimated_transmittance + t.diffuse_transmittance);
        Ok(Self {
            reflectance: reflectance.collect(),
            transmittance: transmittance.collect(),
            kubelka_munk: channels.iter().map(|layers| kubelka_munk(layers, specular)).collect(),
            errors: totals.iter().map(|t| t.error).collect(),
        })
    }
}

/// A color by its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Color {
    /// XYZ, Y = 100 for the perfect diffuser.
    pub xyz: [f64; 3],
    /// CIELAB.
    pub lab: [f64; 3],
    /// Linear sRGB.
    pub linear_srgb: [f64; 3],
}

impl Color {
    /// The color of one value, three of linear Rec. 709, or a spectrum's.
    pub fn new(eye: &Colorimeter, channels: &[f64]) -> Self {
        let xyz = xyz(eye, channels);
        Self { xyz, lab: eye.lab(xyz), linear_srgb: eye.linear_srgb(xyz) }
    }

    /// Greatest ΔE*ab that errors of the channels can make.
    pub fn error(&self, eye: &Colorimeter, errors: &[f64]) -> f64 {
        // All weights are positive, and CIELAB is monotone in XYZ: the farthest colors are at the corners
        let error = xyz(eye, errors);
        let corner = |signs: usize| {
            let moved = |i: usize| self.xyz[i] + if signs >> i & 1 == 0 { error[i] } else { -error[i] };
            delta_e_ab(self.lab, eye.lab([0, 1, 2].map(moved)))
        };
        (0..8).map(corner).fold(0.0, f64::max)
    }

    /// The nearest color that a display shows, channel by channel: sRGB-encoded, in \[0, 1\].
    pub fn display(&self) -> [f32; 3] {
        display_from_linear(ToneMapping::Srgb, self.linear_srgb.map(|value| value as f32))
    }

    /// [`Self::display`] as `#rrggbb`.
    pub fn hex(&self) -> String {
        let [r, g, b] = self.display().map(|value| (value * 255.0).round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// Whether displays of sRGB show the color.
    pub fn is_in_srgb(&self) -> bool {
        // Within half a code
        self.linear_srgb.iter().all(|value| (-1.5e-4..=1.0045).contains(value))
    }
}

fn xyz(eye: &Colorimeter, channels: &[f64]) -> [f64; 3] {
    match *channels {
        [gray] => eye.xyz(&[gray; WAVELENGTHS]),
        [r, g, b] => eye.xyz_of_linear_srgb([r, g, b]),
        _ => {
            let mut spectrum: Spectrum = [0.0; WAVELENGTHS];
            spectrum.iter_mut().zip(channels).for_each(|(value, channel)| *value = *channel);
            eye.xyz(&spectrum)
        }
    }
}

#[cfg(test)]
mod tests {
    use translucid_profile::{fresnel_from_outside, fresnel_moment_1_from_inside};
    use translucid_reference::layers::{Ground, Layer};

    use super::*;
    use crate::colorimetry::{Illuminant, Observer};

    fn over(layers: &[Layer], ground: Ground) -> Layers {
        Layers::new(1.0, layers.to_vec(), ground).unwrap()
    }

    fn reflectance(layers: &Layers, specular: Specular) -> f64 {
        Measurement::new(std::slice::from_ref(layers), specular).unwrap().reflectance[0]
    }

    #[test]
    fn clear_sheet_over_a_ground_has_a_formula() {
        // J. L. Saunderson 1942 is exact here: the ground sends equal radiance everywhere
        let eta = 1.5;
        let (k1, k2) =
            (fresnel_from_outside(8f64.to_radians().cos(), eta), 2.0 * fresnel_moment_1_from_inside(eta));
        for ground in [0.0, 0.5, 0.9, 1.0] {
            let expected = (1.0 - k1) * (1.0 - k2) * ground / (1.0 - k2 * ground);
            let sheet =
                over(&[Layer::new(0.0, 0.0, 1.0).with_eta(eta)], Ground::Lambertian { reflectance: ground });
            for (specular, expected) in [(Specular::Included, k1 + expected), (Specular::Excluded, expected)]
            {
                for found in [reflectance(&sheet, specular), kubelka_munk(&sheet, specular)] {
                    assert!((found - expected).abs() < 2e-6, "{ground}: {found}, expected {expected}");
                }
            }
        }
    }

    /// What is thick enough hides its ground.
    #[test]
    fn opaque_layer_is_a_half_space() {
        let medium = |thickness| Layer::new(20.0, 0.3, thickness).with_g(0.6).with_eta(1.4);
        let endless = over(&[medium(f64::INFINITY)], Ground::None);
        for ground in [Ground::BLACK, Ground::Lambertian { reflectance: 1.0 }, Ground::AIR] {
            let thick = over(&[medium(20.0)], ground);
            for specular in [Specular::Included, Specular::Excluded] {
                let [found, expected] = [&thick, &endless].map(|layers| reflectance(layers, specular));
                assert!((found - expected).abs() < 2e-6, "{found}, expected {expected}");
            }
        }
    }

    #[test]
    fn errors_of_channels_bound_those_of_colors() {
        let eye = Colorimeter::new(Observer::TwoDegrees, Illuminant::D65);
        let color = Color::new(&eye, &[0.2, 0.5, 0.01]);
        let bound = color.error(&eye, &[1e-3, 2e-3, 1e-4]);
        for signs in 0..8 {
            let moved = [(0.2, 1e-3), (0.5, 2e-3), (0.01, 1e-4)];
            let moved: Vec<f64> = moved
                .iter()
                .enumerate()
                .map(|(i, (value, error))| if signs >> i & 1 == 0 { value + error } else { value - error })
                .collect();
            let distance = delta_e_ab(color.lab, Color::new(&eye, &moved).lab);
            assert!(distance <= bound && bound < 2.0, "{distance}, {bound}");
        }
        assert_eq!(Color::new(&eye, &[1.0]).hex(), "#ffffff");
        assert!(Color::new(&eye, &[0.5; WAVELENGTHS]).is_in_srgb());
        assert!(!Color::new(&eye, &[1.2, 0.1, 0.1]).is_in_srgb());
    }
}
