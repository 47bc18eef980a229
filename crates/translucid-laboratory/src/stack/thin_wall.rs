//! The thin-walled surface that stands for a slab of a material.
//!
//! A thin wall scatters the light that passes its interface at one point: a part of it back, the rest to the other side, both
//! by the cosine law. [`SlabLight`] solves the slab exactly, and a wall has its reflectance and transmittance of diffuse light.
//! It cannot have their change with the angle, nor the light that passes the slab unscattered and so goes straight on.
//!
//! By reciprocity the radiance that a slab in diffuse light sends into a direction is the share of a beam from there that it
//! reflects, or passes: so the errors by angle are those of the light that arrives, and of the view.

use rayon::prelude::*;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, fresnel_from_outside, require};
use translucid_reference::layers::{Ground, Layer, Layers};
use translucid_reference::{Incidence, specular_reflectance};

/// Angles of incidence at which slab and wall are compared, in degrees.
const ANGLES: [f64; 7] = [0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0];
/// Most optical thickness: more passes nothing, either.
const MOST_DEPTH: f64 = 1e9;

/// One channel of a slab of a material: surface albedo A and transport mean free path ℓ* \[L\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlabChannel {
    /// Surface albedo of the material, in [0, 1].
    pub surface_albedo: f64,
    /// Transport mean free path \[L\], at least 0; a channel of 0 is a Lambertian surface.
    pub transport_mfp: f64,
}

/// The light that a slab reflects and passes, in one channel, as shares of the light that arrives.
#[derive(Clone, Debug, PartialEq)]
pub struct SlabLight {
    /// Reflectance and transmittance of diffuse light.
    pub diffuse: [f64; 2],
    /// Part of diffuse light that passes without having been scattered.
    pub unscattered: f64,
    /// Reflectance and transmittance of beams at 0, 15, 30, 45, 60, 75 and 85 degrees.
    pub by_angle: Vec<[f64; 2]>,
    /// Estimated numerical error of all.
    pub error: f64,
}

impl SlabLight {
    /// Solves the slabs of a material of a thickness \[L\], between air, for a mean cosine g and an index of refraction η, each
    /// channel a medium with its A and the transport mean free path ℓ*.
    ///
    /// # Errors
    /// A parameter is outside its range.
    pub fn of_slab(
        channels: &[SlabChannel],
        thickness: f64,
        g: f64,
        eta: f64,
    ) -> Result<Vec<Self>, ParameterError> {
        require_thickness(thickness)?;
        let inversion = AlbedoInversion::new(g, eta, Configuration::Diffuse)?;
        channels
            .par_iter()
            .map(|channel| {
                let alpha = inversion.single_scattering_albedo(channel.surface_albedo);
                let mfp = channel.transport_mfp * (1.0 - alpha * g);
                let extinction = (1.0 / mfp).min(MOST_DEPTH / thickness);
                let layer = Layer::new(alpha * extinction, (1.0 - alpha) * extinction, thickness);
                let layer = layer.with_g(g).with_eta(eta);
                Self::of_layers(&Layers::new(1.0, vec![layer], Ground::AIR).map_err(parameter_of)?)
            })
            .collect()
    }

    fn of_layers(layers: &Layers) -> Result<Self, ParameterError> {
        let mut error = 0.0f64;
        let mut solve = |incidence| {
            let totals = layers.totals(incidence)?;
            error = error.max(totals.error);
            let reflectance = totals.specular_reflectance + totals.diffuse_reflectance;
            let transmittance = totals.collimated_transmittance + totals.diffuse_transmittance;
            Ok(([reflectance, transmittance], totals.collimated_transmittance))
        };
        let (diffuse, unscattered) = solve(Incidence::Cosine)?;
        let by_angle = ANGLES
            .iter()
            .map(|angle| Ok(solve(Incidence::Pencil { cos_theta: libm::cos(angle.to_radians()) })?.0))
            .collect::<Result<_, ParameterError>>()?;
        Ok(Self { diffuse, unscattered, by_angle, error })
    }

    /// Reflectance and transmittance of the light that passes the interface, which reflects the rest.
    fn below(&self, eta: f64) -> [f64; 2] {
        let reflected = specular_reflectance(Incidence::Cosine, eta);
        let [reflectance, transmittance] = self.diffuse;
        [
            ((reflectance - reflected) / (1.0 - reflected)).max(0.0),
            (transmittance / (1.0 - reflected)).min(1.0),
        ]
    }
}

/// Passes on a thickness that slabs may have.
pub(super) fn require_thickness(thickness: f64) -> Result<f64, ParameterError> {
    require(thickness > 0.0 && thickness.is_finite(), "thickness", thickness, "finite and above 0")
}

/// An error of one layer, whose parameters are the caller's.
pub(super) fn parameter_of(error: translucid_reference::layers::LayersError) -> ParameterError {
    error.error
}

/// A thin-walled surface: the shares of the light below its interface that it scatters back and through, channel by channel.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinWall {
    /// Light that returns.
    pub reflectance: Vec<f64>,
    /// Light that leaves on the other side.
    pub transmittance: Vec<f64>,
}

/// OpenPBR's parameters of a wall, which glTF's KHR_materials_scatter and Blender have, too.
#[derive(Clone, Debug, PartialEq)]
pub struct ScatteringWall {
    /// `subsurface_color`: the light that is scattered, to either side.
    pub color: Vec<f64>,
    /// `subsurface_scatter_anisotropy`: (1 + g)/2 of it goes to the other side.
    pub anisotropy: f64,
}

/// Parameters of glTF's KHR_materials_diffuse_transmission.
#[derive(Clone, Debug, PartialEq)]
pub struct DiffuseTransmissionWall {
    /// `baseColorFactor`, of the light that returns.
    pub base_color: Vec<f64>,
    /// `diffuseTransmissionFactor`: the share of all light that may pass.
    pub factor: f64,
    /// `diffuseTransmissionColorFactor`, of the light that passes.
    pub color: Vec<f64>,
}

impl ScatteringWall {
    /// The wall that scatters as much light as the slabs, and divides it between its sides as they do by least squares over
    /// the channels: one number divides all.
    pub fn of(slabs: &[SlabLight], eta: f64) -> Self {
        let below: Vec<[f64; 2]> = slabs.iter().map(|slab| slab.below(eta)).collect();
        let color: Vec<f64> = below.iter().map(|[r, t]| (r + t).min(1.0)).collect();
        let weight: f64 = color.iter().map(|c| c * c).sum();
        let passed: f64 = color.iter().zip(&below).map(|(c, [_, t])| c * t).sum();
        let share = if weight > 0.0 { passed / weight } else { 0.5 };
        // (−1, 1) is open
        Self { color, anisotropy: (2.0 * share - 1.0).clamp(-0.9999, 0.9999) }
    }

    /// The light that it scatters.
    pub fn wall(&self) -> ThinWall {
        let side = |share: f64| self.color.iter().map(|c| 0.5 * share * c).collect();
        ThinWall { reflectance: side(1.0 - self.anisotropy), transmittance: side(1.0 + self.anisotropy) }
    }
}

impl DiffuseTransmissionWall {
    /// The wall with the slabs' reflectance and transmittance, channel by channel, where a factor leaves room for both; else
    /// the nearest of the same ratio of the greatest ones.
    pub fn of(slabs: &[SlabLight], eta: f64) -> Self {
        let below: Vec<[f64; 2]> = slabs.iter().map(|slab| slab.below(eta)).collect();
        let [most_back, most_through] =
            [0, 1].map(|side| below.iter().map(|pair| pair[side]).fold(0.0, f64::max));
        // In the middle of what is possible, or as much too small for both
        let factor = if most_back + most_through <= 1.0 {
            0.5 * (most_through + 1.0 - most_back)
        } else {
            most_through / (most_back + most_through)
        };
        let color = |side: usize, share: f64| {
            let of = |pair: &[f64; 2]| if pair[side] > 0.0 { (pair[side] / share).min(1.0) } else { 0.0 };
            below.iter().map(of).collect()
        };
        Self { base_color: color(0, 1.0 - factor), factor, color: color(1, factor) }
    }

    /// The light that it scatters.
    pub fn wall(&self) -> ThinWall {
        let side = |colors: &[f64], share: f64| colors.iter().map(|c| share * c).collect();
        ThinWall {
            reflectance: side(&self.base_color, 1.0 - self.factor),
            transmittance: side(&self.color, self.factor),
        }
    }
}

impl ThinWall {
    /// Errors of the wall in a channel: reflectance and transmittance of diffuse light less the slab's, and the greatest error
    /// of either among beams at 0 to 85 degrees.
    pub fn errors(&self, channel: usize, slab: &SlabLight, eta: f64) -> WallErrors {
        let (back, through) = (self.reflectance[channel], self.transmittance[channel]);
        // The interface reflects F and lets the rest in
        let lit = |f: f64| [f + (1.0 - f) * back, (1.0 - f) * through];
        let off = |f: f64, [r, t]: [f64; 2]| {
            let [reflected, passed] = lit(f);
            [reflected - r, passed - t]
        };
        let [reflectance, transmittance] = off(specular_reflectance(Incidence::Cosine, eta), slab.diffuse);
        let by_angle = ANGLES
            .iter()
            .zip(&slab.by_angle)
            .map(|(angle, of_slab)| {
                let f = fresnel_from_outside(libm::cos(angle.to_radians()), eta);
                off(f, *of_slab).into_iter().map(f64::abs).fold(0.0, f64::max)
            })
            .fold(0.0, f64::max);
        WallErrors { reflectance, transmittance, by_angle }
    }
}

/// Errors of a thin wall in one channel, in shares of the light that arrives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallErrors {
    /// Reflectance of diffuse light, less the slab's.
    pub reflectance: f64,
    /// Transmittance of diffuse light, less the slab's.
    pub transmittance: f64,
    /// Greatest error of reflectance or transmittance at angles from 0 to 85 degrees.
    pub by_angle: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(surface_albedo: f64, transport_mfp: f64) -> SlabChannel {
        SlabChannel { surface_albedo, transport_mfp }
    }

    fn slab(surface_albedo: f64, transport_mfp: f64, g: f64, eta: f64) -> SlabLight {
        SlabLight::of_slab(&[channel(surface_albedo, transport_mfp)], 1.0, g, eta).unwrap().remove(0)
    }

    /// A thick slab returns A; a white one returns what it does not pass; a thin one passes all.
    #[test]
    fn slabs_have_the_limits_of_their_material() {
        let thick = slab(0.6, 1e-3, 0.0, 1.0);
        assert!((thick.diffuse[0] - 0.6).abs() < 1e-4 && thick.diffuse[1] < 1e-6, "{thick:?}");
        let lambertian = slab(0.6, 0.0, 0.0, 1.0);
        assert!((lambertian.diffuse[0] - 0.6).abs() < 1e-4, "{lambertian:?}");
        for (g, eta) in [(0.0, 1.0), (0.6, 1.0), (0.0, 1.4)] {
            let white = slab(1.0, 0.5, g, eta);
            assert!((white.diffuse[0] + white.diffuse[1] - 1.0).abs() < 1e-5, "{g} {eta} {white:?}");
        }
        let clear = slab(0.6, 1e6, 0.0, 1.0);
        assert!(clear.diffuse[1] > 0.9999 && clear.unscattered > 0.9999, "{clear:?}");
        let black = slab(0.0, 0.5, 0.0, 1.0);
        assert!(black.diffuse[0] == 0.0 && (black.diffuse[1] - black.unscattered).abs() < 1e-9, "{black:?}");
    }

    /// H. C. van de Hulst 1980, *Multiple Light Scattering*, table 35, as quoted by L. Wang, S. L. Jacques and L. Zheng 1995,
    /// MCML: a beam along the normal, g = 0.75, two mean free paths.
    #[test]
    fn a_slab_has_the_published_light() {
        let layer = Layer::new(90.0, 10.0, 0.02).with_g(0.75);
        let slab = SlabLight::of_layers(&Layers::new(1.0, vec![layer], Ground::AIR).unwrap()).unwrap();
        let [reflectance, transmittance] = slab.by_angle[0];
        assert!((reflectance - 0.09739).abs() < 5e-6 && (transmittance - 0.66096).abs() < 5e-6, "{slab:?}");
    }

    /// By reciprocity the mean of the beams' reflectance, weighted by the cosine, is that of diffuse light.
    #[test]
    fn beams_add_up_to_diffuse_light() {
        let layer = Layer::new(1.6, 0.2, 1.0).with_g(0.4);
        let layers = Layers::new(1.0, vec![layer], Ground::AIR).unwrap();
        let n = 64;
        let mut sum = [0.0; 2];
        for i in 0..n {
            let cos_theta = (f64::from(i) + 0.5) / f64::from(n);
            let totals = layers.totals(Incidence::Pencil { cos_theta }).unwrap();
            sum[0] += 2.0 * cos_theta * (totals.specular_reflectance + totals.diffuse_reflectance);
            sum[1] += 2.0 * cos_theta * (totals.collimated_transmittance + totals.diffuse_transmittance);
        }
        let found = SlabLight::of_layers(&layers).unwrap().diffuse;
        for (sum, found) in sum.into_iter().zip(found) {
            assert!((sum / f64::from(n) - found).abs() < 2e-4, "{sum} {found}");
        }
    }

    #[test]
    fn a_gray_wall_has_the_slab_s_light() {
        for (g, eta) in [(0.0, 1.0), (0.5, 1.4)] {
            let slab = slab(0.8, 0.3, g, eta);
            let slabs = [slab.clone()];
            for wall in
                [ScatteringWall::of(&slabs, eta).wall(), DiffuseTransmissionWall::of(&slabs, eta).wall()]
            {
                let errors = wall.errors(0, &slab, eta);
                assert!(errors.reflectance.abs() < 1e-12 && errors.transmittance.abs() < 1e-12, "{errors:?}");
                assert!(errors.by_angle > 0.01 && errors.by_angle < 0.5, "{errors:?}");
            }
        }
    }

    /// Channels that pass unlike shares: the scattering wall keeps their sums, the other wall all it can.
    #[test]
    fn colored_walls_state_what_they_cannot_have() {
        let channels = [channel(0.8, 1.0), channel(0.5, 0.3), channel(0.3, 0.1)];
        let slabs = SlabLight::of_slab(&channels, 0.5, 0.0, 1.0).unwrap();
        let scattering = ScatteringWall::of(&slabs, 1.0).wall();
        let diffuse = DiffuseTransmissionWall::of(&slabs, 1.0).wall();
        for (c, slab) in slabs.iter().enumerate() {
            let errors = scattering.errors(c, slab, 1.0);
            assert!((errors.reflectance + errors.transmittance).abs() < 1e-12, "{errors:?}");
            let errors = diffuse.errors(c, slab, 1.0);
            assert!(errors.reflectance < 1e-12 && errors.transmittance < 1e-12, "{errors:?}");
        }
        assert!(scattering.errors(2, &slabs[2], 1.0).transmittance > 0.02);
    }

    #[test]
    fn slabs_without_a_thickness_are_refused() {
        for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(SlabLight::of_slab(&[channel(0.5, 1.0)], thickness, 0.0, 1.0).is_err());
        }
        let error = SlabLight::of_slab(&[channel(0.5, 1.0)], 1.0, 0.99, 1.0).unwrap_err();
        assert_eq!(error.parameter, "g");
    }
}
