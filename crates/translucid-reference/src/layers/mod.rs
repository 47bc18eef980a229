//! Plane layers of different media.
//!
//! Any number of layers lies between a medium above, from which light comes, and a ground: each has its own scattering,
//! absorption, phase function, index of refraction and thickness.
//! Faces between media of different indices reflect and refract by Fresnel's law for unpolarized light.
//!
//! *Lengths and coefficients are in any one unit*, L and L⁻¹. *One unit of flux arrives from above*, and what the first
//! face reflects is part of the totals: here, unlike in the rest of the crate, media have many faces.

mod layer;
mod matrix;
mod operators;
#[cfg(not(target_family = "wasm"))]
mod profile;
mod rays;
mod totals;
#[cfg(not(target_family = "wasm"))]
mod walk;

pub use layer::Layer;
#[cfg(not(target_family = "wasm"))]
pub use profile::{DiffuseProfile, LayersProfile};
pub use totals::Totals;
#[cfg(not(target_family = "wasm"))]
pub use walk::{Grid, LayersTally, Quantity};

use std::fmt;
use std::sync::Arc;

use translucid_profile::{ParameterError, require};

use crate::phase_function::PhaseFunction;

/// Ground below the last layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ground {
    /// Nothing: the last layer is infinitely thick.
    None,
    /// A clear half space of the index of refraction η, into which light leaves for good; air has 1.
    Medium {
        /// Index of refraction, in [0.1, 10].
        eta: f64,
    },
    /// A surface in optical contact with the last layer, which returns a part of the light that reaches it, with the same
    /// radiance into every direction, and absorbs the rest.
    ///
    /// With air between them, a clear layer of η = 1 lies on it.
    Lambertian {
        /// Part of the flux that returns, in [0, 1]: 0 is a black ground.
        reflectance: f64,
    },
}

impl Ground {
    /// Air.
    pub const AIR: Self = Self::Medium { eta: 1.0 };
    /// A ground that absorbs all light.
    pub const BLACK: Self = Self::Lambertian { reflectance: 0.0 };
}

/// Plane layers on a ground, known to be valid.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    eta_above: f64,
    layers: Vec<Layer>,
    ground: Ground,
}

impl Layers {
    /// Most layers that are allowed.
    pub const MOST: usize = 1000;

    /// Layers from top to bottom under a medium of the index of refraction η₀ ∈ [0.1, 10], which is 1 for air.
    ///
    /// ```
    /// use translucid_reference::layers::{Ground, Layer, Layers};
    ///
    /// let epidermis = Layer::new(20.0, 1.5, 0.1).with_g(0.8).with_eta(1.4);
    /// let dermis = Layer::new(15.0, 0.1, 2.0).with_g(0.8).with_eta(1.4);
    /// assert!(Layers::new(1.0, vec![epidermis, dermis], Ground::BLACK).is_ok());
    ///
    /// let error = Layers::new(1.0, vec![Layer::new(1.0, 0.0, 0.0)], Ground::AIR).unwrap_err();
    /// assert_eq!(error.to_string(), "layer 1: thickness is 0, but must be greater than 0");
    /// ```
    ///
    /// # Errors
    /// A parameter is outside its range, an infinite layer is not the last or has a ground below, or there are more than 16
    /// different indices of refraction.
    pub fn new(eta_above: f64, layers: Vec<Layer>, ground: Ground) -> Result<Self, LayersError> {
        let outside = |error| LayersError { layer: None, error };
        require(layer::ETA.contains(&eta_above), "eta_above", eta_above, "in [0.1, 10]").map_err(outside)?;
        match ground {
            Ground::None => {}
            Ground::Medium { eta } => {
                require(layer::ETA.contains(&eta), "eta", eta, "in [0.1, 10]").map_err(outside)?;
            }
            Ground::Lambertian { reflectance } => {
                let is_part = (0.0..=1.0).contains(&reflectance);
                require(is_part, "reflectance", reflectance, "in [0, 1]").map_err(outside)?;
            }
        }
        let count = layers.len();
        let is_count = (1..=Self::MOST).contains(&count);
        require(is_count, "number of layers", count as f64, "in [1, 1000]").map_err(outside)?;
        for (i, layer) in layers.iter().enumerate() {
            let within = |error| LayersError { layer: Some(i), error };
            layer.check().map_err(within)?;
            check_thickness(layer, i + 1 == count, ground).map_err(within)?;
        }
        let layers = Self { eta_above, layers, ground };
        let indices = rays::squared_indices(&layers).len();
        require(indices <= MOST_INDICES, "number of different eta", indices as f64, "at most 16")
            .map_err(outside)?;
        Ok(layers)
    }

    /// Index of refraction of the medium above.
    pub fn eta_above(&self) -> f64 {
        self.eta_above
    }

    /// Layers from top to bottom, of which there is at least one.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Warnings of phase functions whose tables are too coarse for their peaks, by layer.
    pub fn warnings(&self) -> Vec<String> {
        let of = |(i, layer): (usize, &Layer)| {
            layer.phase_function.warning().map(|warning| format!("layer {}: {warning}", i + 1))
        };
        self.layers.iter().enumerate().filter_map(of).collect()
    }

    /// The layers with every second row of the tables of their phase functions; none if there are no tables.
    pub fn thinned(&self) -> Option<Self> {
        let thinned = |layer: &Layer| {
            let PhaseFunction::Table(table) = &layer.phase_function else { return None };
            Some(layer.clone().with_phase_function(PhaseFunction::Table(Arc::new(table.thinned()?))))
        };
        let found: Vec<Option<Layer>> = self.layers.iter().map(thinned).collect();
        found.iter().any(Option::is_some).then(|| {
            let layers =
                found.into_iter().zip(&self.layers).map(|(own, layer)| own.unwrap_or_else(|| layer.clone()));
            Self { layers: layers.collect(), ..self.clone() }
        })
    }

    /// Ground below the last layer, [`Ground::None`] if that is infinitely thick and only then.
    pub fn ground(&self) -> Ground {
        self.ground
    }
}

/// Most indices of refraction in one stack: rays are split at each.
const MOST_INDICES: usize = 16;

fn check_thickness(layer: &Layer, is_last: bool, ground: Ground) -> Result<(), ParameterError> {
    let thickness = layer.thickness;
    if thickness.is_finite() {
        require((1e-30..=1e30).contains(&thickness), "thickness", thickness, "in [1e-30, 1e30]")?;
        let allowed = "infinite in the last layer if there is no ground";
        require(!(is_last && ground == Ground::None), "thickness", thickness, allowed)?;
    } else {
        require(is_last, "thickness", thickness, "finite in all layers but the last")?;
        require(ground == Ground::None, "thickness", thickness, "finite above a ground")?;
        let allowed = "greater than 0 in an infinite layer; a clear half space is a ground";
        require(layer.extinction() > 0.0, "extinction", layer.extinction(), allowed)?;
    }
    Ok(())
}

/// A parameter outside its range, with the layer that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayersError {
    /// Layer from 0, if it is one's.
    pub layer: Option<usize>,
    /// Parameter, value and range.
    pub error: ParameterError,
}

impl fmt::Display for LayersError {
    /// Counts layers from 1.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.layer {
            Some(layer) => write!(f, "layer {}: {}", layer + 1, self.error),
            None => self.error.fmt(f),
        }
    }
}

impl std::error::Error for LayersError {}

#[cfg(test)]
mod tests {
    use translucid_profile::{AlbedoInversion, Configuration, Parameterization};

    use super::*;

    fn refused(layers: Vec<Layer>, ground: Ground) -> String {
        Layers::new(1.0, layers, ground).unwrap_err().to_string()
    }

    #[test]
    fn layers_without_meaning_are_refused() {
        let plain = Layer::new(1.0, 0.1, 1.0);
        let endless = Layer::new(1.0, 0.1, f64::INFINITY);
        for (layers, ground, expected) in [
            (vec![], Ground::AIR, "number of layers is 0, but must be in [1, 1000]"),
            (
                vec![plain.clone(), Layer::new(1.0, 0.1, -1.0)],
                Ground::AIR,
                "layer 2: thickness is -1, but must be greater than 0",
            ),
            (
                vec![Layer::new(f64::NAN, 0.1, 1.0)],
                Ground::AIR,
                "layer 1: scattering is NaN, but must be in [0, 1e30]",
            ),
            (vec![plain.clone().with_g(1.0)], Ground::AIR, "layer 1: g is 1, but must be in (-1, 1)"),
            (vec![plain.clone().with_eta(0.0)], Ground::AIR, "layer 1: eta is 0, but must be in [0.1, 10]"),
            (
                vec![endless.clone(), plain.clone()],
                Ground::AIR,
                "layer 1: thickness is inf, but must be finite in all layers but the last",
            ),
            (vec![endless], Ground::AIR, "layer 1: thickness is inf, but must be finite above a ground"),
            (
                vec![plain.clone()],
                Ground::None,
                "layer 1: thickness is 1, but must be infinite in the last layer if there is no ground",
            ),
            (
                vec![plain.clone()],
                Ground::Lambertian { reflectance: 1.5 },
                "reflectance is 1.5, but must be in [0, 1]",
            ),
        ] {
            assert_eq!(refused(layers, ground), expected);
        }
        assert!(
            refused(vec![plain.clone().with_moments(vec![0.9])], Ground::AIR)
                .contains("no moments of a phase function")
        );
        let moments = (1..80).map(|l| 0.8f64.powi(l)).collect();
        assert!(Layers::new(1.0, vec![plain.with_moments(moments)], Ground::AIR).is_ok());
    }

    #[test]
    fn layer_of_a_surface_albedo_has_its_medium() {
        let inversion = AlbedoInversion::new(0.0, 1.0, Configuration::Searchlight).unwrap();
        let layer = Layer::from_surface_albedo(&inversion, 0.5, 0.25, Parameterization::Mfp, 1.0).unwrap();
        assert!((layer.extinction() - 4.0).abs() < 1e-12);
        assert!((layer.scattering / 4.0 - 0.938171938710).abs() < 2e-5);
        for (albedo, length) in [(0.0, 1.0), (1.1, 1.0), (0.5, 0.0), (0.5, f64::NAN)] {
            assert!(
                Layer::from_surface_albedo(&inversion, albedo, length, Parameterization::Mfp, 1.0).is_err()
            );
        }
    }
}
