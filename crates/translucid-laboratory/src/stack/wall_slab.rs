//! The slab that has the light of a thin wall.
//!
//! A wall of the color c and the balance b returns c (1 − b) of the light that passes its interface and lets c b through.
//! The reflectance of a slab rises with its single-scattering albedo α; of the slabs with the wall's reflectance, which have a
//! lower α the thicker they are, the transmittance falls with the thickness.
//! So one slab at most has both, and two nested searches find it.

use translucid_profile::roots::falling_root;
use translucid_profile::{AlbedoInversion, Configuration, ParameterError, require};
use translucid_reference::layers::{Ground, Layer, Layers, Totals};
use translucid_reference::{Incidence, specular_reflectance};

use super::thin_wall::parameter_of;

/// Thicknesses that are searched, in mean free paths.
const THICKNESSES: [f64; 2] = [1e-6, 1e6];
/// Error of reflectance and transmittance at which a slab is found, and at which it still counts as one.
const FOUND: f64 = 1e-9;
const ENOUGH: f64 = 5e-6;
/// Least transmittance: of thicker slabs the exact solution, good to 1e-6, does not tell the thickness.
const LEAST_TRANSMITTANCE: f64 = 1e-4;

/// A slab of a medium, its thickness being 1 where no unit is stated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSlab {
    /// Single-scattering albedo α.
    pub single_scattering_albedo: f64,
    /// Thickness in mean free paths, σ_t d.
    pub optical_thickness: f64,
    /// Surface albedo A of the half space of the medium.
    pub surface_albedo: f64,
    /// Transport mean free path ℓ*, in thicknesses of the slab: 1/(σ_t d (1 − αg)).
    pub transport_mfp: f64,
    /// Part of diffuse light that passes without having been scattered.
    pub unscattered: f64,
}

impl WallSlab {
    /// Finds the slab, between air, that reflects and passes as much diffuse light as a thin wall of one channel.
    ///
    /// `color` is the share of the light below the interface that the wall scatters to either side, in (0, 1\]; `balance` the
    /// share of that which goes to the other side, in (0, 1\], (1 + g)/2 of OpenPBR's `subsurface_scatter_anisotropy` g.
    /// The mean cosine of the slab's phase function is chosen, in [−0.95, 0.95], and so is its index of refraction, in [1, 3].
    ///
    /// # Errors
    /// A parameter is outside its range, or no slab has the light: a boundary returns more of it than the wall does, or
    /// less than a ten-thousandth passes.
    pub fn new(color: f64, balance: f64, g: f64, eta: f64) -> Result<Self, ParameterError> {
        require(color > 0.0 && color <= 1.0, "color", color, "in (0, 1]")?;
        require(balance > 0.0 && balance <= 1.0, "balance", balance, "in (0, 1]")?;
        let inversion = AlbedoInversion::new(g, eta, Configuration::Diffuse)?;
        let entered = 1.0 - specular_reflectance(Incidence::Cosine, eta);
        let wanted = [1.0 - entered * (1.0 - color * (1.0 - balance)), entered * color * balance];
        let allowed =
            "greater: no slab that passes less than 0.0001 of the light has a thickness that can be told";
        require(wanted[1] >= LEAST_TRANSMITTANCE, "balance", balance, allowed)?;

        let light = |alpha: f64, depth: f64| Light::of(alpha, depth, g, eta);
        // The slab of a thickness that has the reflectance, or the nearest; √(1 − α) is what reflectance is smooth in
        let alpha_at = |depth: f64| {
            let more =
                |x: f64| light(1.0 - x * x, depth).map_or(f64::NAN, |light| light.diffuse[0] - wanted[0]);
            match [more(0.0), more(1.0)] {
                [white, _] if white <= 0.0 => 1.0,
                [_, black] if black >= 0.0 => 0.0,
                ends => {
                    let x = falling_root(more, ends, |_| FOUND);
                    1.0 - x * x
                }
            }
        };
        let [least, most] = THICKNESSES.map(libm::log);
        let depth_at = |u: f64| libm::exp(least + (most - least) * u);
        let more = |u: f64| {
            let depth = depth_at(u);
            light(alpha_at(depth), depth).map_or(f64::NAN, |light| light.diffuse[1] - wanted[1])
        };
        let ends = [more(0.0), more(1.0)];
        let u = if ends[0] > 0.0 && ends[1] < 0.0 { falling_root(more, ends, |_| FOUND) } else { 0.0 };
        let optical_thickness = depth_at(u);
        let alpha = alpha_at(optical_thickness);
        let found = light(alpha, optical_thickness)?;
        let off = (0..2).map(|i| (found.diffuse[i] - wanted[i]).abs()).fold(0.0, f64::max);
        let allowed = "less: no slab of this g and eta passes so much of this color and reflects so little";
        require(off < ENOUGH, "balance", balance, allowed)?;
        let below = |a: f64| alpha - inversion.single_scattering_albedo(a);
        let surface_albedo = match alpha {
            0.0 => 0.0,
            1.0 => 1.0,
            _ => falling_root(below, [alpha, alpha - 1.0], |_| 1e-14),
        };
        Ok(Self {
            single_scattering_albedo: alpha,
            optical_thickness,
            surface_albedo,
            transport_mfp: 1.0 / (optical_thickness * (1.0 - alpha * g)),
            unscattered: found.unscattered,
        })
    }
}

/// Diffuse light on a slab.
struct Light {
    /// Reflectance and transmittance.
    diffuse: [f64; 2],
    unscattered: f64,
}

impl Light {
    fn of(alpha: f64, depth: f64, g: f64, eta: f64) -> Result<Self, ParameterError> {
        let layer = Layer::new(alpha * depth, (1.0 - alpha) * depth, 1.0).with_g(g).with_eta(eta);
        let layers = Layers::new(1.0, vec![layer], Ground::AIR).map_err(parameter_of)?;
        let Totals {
            specular_reflectance,
            diffuse_reflectance,
            collimated_transmittance,
            diffuse_transmittance,
            ..
        } = layers.totals(Incidence::Cosine)?;
        Ok(Self {
            diffuse: [
                specular_reflectance + diffuse_reflectance,
                collimated_transmittance + diffuse_transmittance,
            ],
            unscattered: collimated_transmittance,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stack::{ScatteringWall, SlabChannel, SlabLight};

    /// The wall of an exact slab, and back to the slab.
    #[test]
    fn a_wall_leads_back_to_its_slab() {
        for (alpha, depth, g, eta) in [
            (0.9, 1.0, 0.0, 1.0),
            (0.99, 0.1, 0.0, 1.0),
            (0.5, 2.0, 0.0, 1.0),
            (0.999, 8.0, 0.8, 1.0),
            (1.0, 3.0, 0.0, 1.0),
            (0.9, 1.0, 0.5, 1.4),
            (0.98, 4.0, -0.4, 1.3),
        ] {
            let light = Light::of(alpha, depth, g, eta).unwrap();
            let reflected = specular_reflectance(Incidence::Cosine, eta);
            let [back, through] =
                [(light.diffuse[0] - reflected) / (1.0 - reflected), light.diffuse[1] / (1.0 - reflected)];
            let color = (back + through).min(1.0);
            let slab = WallSlab::new(color, through / color, g, eta).unwrap();
            let found = Light::of(slab.single_scattering_albedo, slab.optical_thickness, g, eta).unwrap();
            for (found, wanted) in found.diffuse.into_iter().zip(light.diffuse) {
                assert!((found - wanted).abs() < 3e-6, "{alpha} {depth} {g} {eta}: {slab:?}");
            }
            assert!(
                (slab.single_scattering_albedo - alpha).abs() < 1e-6,
                "{alpha} {depth} {g} {eta}: {slab:?}"
            );
            assert!(
                (slab.optical_thickness / depth - 1.0).abs() < 1e-6,
                "{alpha} {depth} {g} {eta}: {slab:?}"
            );
        }
    }

    /// From a material by its surface albedo and transport mean free path to a wall and back.
    #[test]
    fn a_material_leads_back_through_its_wall() {
        for (surface_albedo, transport_mfp, g, eta) in [(0.8, 0.5, 0.0, 1.0), (0.6, 2.0, 0.7, 1.4)] {
            let channel = SlabChannel { surface_albedo, transport_mfp };
            let slabs = SlabLight::of_slab(&[channel], 1.0, g, eta).unwrap();
            let wall = ScatteringWall::of(&slabs, eta);
            let found = WallSlab::new(wall.color[0], 0.5 * (1.0 + wall.anisotropy), g, eta).unwrap();
            assert!((found.surface_albedo - surface_albedo).abs() < 1e-6, "{found:?}");
            assert!((found.transport_mfp / transport_mfp - 1.0).abs() < 1e-6, "{found:?}");
            assert!((found.unscattered - slabs[0].unscattered).abs() < 1e-6, "{found:?}");
        }
    }

    /// A slab that absorbs and does not scatter passes 2 E₃(τ): 0.4432 at τ = 0.5 (M. Abramowitz and I. A. Stegun 1964, table 5.4).
    #[test]
    fn a_wall_that_returns_nothing_is_a_slab_that_absorbs() {
        let slab = WallSlab::new(0.443_208_8, 1.0, 0.0, 1.0).unwrap();
        assert!(
            slab.single_scattering_albedo < 1e-6 && (slab.optical_thickness - 0.5).abs() < 1e-5,
            "{slab:?}"
        );
    }

    #[test]
    fn light_that_no_slab_has_is_refused() {
        for (color, balance, g, eta, parameter) in [
            (0.0, 0.5, 0.0, 1.0, "color"),
            (1.2, 0.5, 0.0, 1.0, "color"),
            (f64::NAN, 0.5, 0.0, 1.0, "color"),
            (0.5, 0.0, 0.0, 1.0, "balance"),
            (0.5, 1.1, 0.0, 1.0, "balance"),
            (0.5, 1e-6, 0.0, 1.0, "balance"),
            // The second face returns some of the light
            (0.9, 1.0, 0.0, 1.5, "balance"),
            (0.5, 0.5, 0.99, 1.0, "g"),
            (0.5, 0.5, 0.0, 4.0, "eta"),
        ] {
            let error = WallSlab::new(color, balance, g, eta).unwrap_err();
            assert_eq!(error.parameter, parameter, "{color} {balance} {g} {eta}: {error}");
        }
    }
}
