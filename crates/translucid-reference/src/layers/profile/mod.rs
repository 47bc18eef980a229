//! Light that leaves layers around a normal pencil beam.

mod chain;
mod depths;
mod diffusion;
mod directions;
mod kernel;
mod panel;
mod poles;
mod remainder;
mod single;
mod single2;
mod stack;
mod transform;

use num_complex::Complex64;
use rayon::prelude::*;
use translucid_profile::ParameterError;

use self::depths::{Depths, in_unit};
use self::single::Single;
use self::transform::Transform;
use super::{Ground, Layer, Layers, LayersError};
use crate::Estimate;
use crate::exact::dispersion::Dispersion;
use crate::exact::h_function::Nested;
use crate::exact::hankel_inversion::{Contour, Inversion, Settings};

/// Profiles R(r) and T(r) of layers under a normal pencil beam, as [`Layers::profile`] solves them.
///
/// One unit of flux arrives from above; light that was never scattered is no part of them.
#[derive(Clone, Debug)]
pub struct LayersProfile {
    /// Length in which the solution counts \[L\].
    unit: f64,
    reflected: Side,
    transmitted: Option<Side>,
}

/// Light that leaves through one face.
#[derive(Clone, Debug)]
struct Side {
    single: Single,
    rest: Inversion,
    /// The difference between two rules of depths.
    doubt: Inversion,
}

/// Nodes of a panel of depths, by the finer and the coarser rule.
const NODES: [usize; 2] = [7, 5];
/// Most nodes of a stack: each wave number solves a system of as many equations.
const MOST_DEPTHS: usize = 800;
/// Radius up to which the error keeps small, in mean free paths of the thinnest medium.
const FARTHEST: f64 = 300.0;
/// Part of the least decay at which wave numbers begin: at the whole, light gets infinitely deep.
const BEFORE_DECAY: f64 = 0.95;
/// Step of wave numbers.
const STEP: f64 = 0.2;
/// Error as a part of the value that is in all rules.
const COMMON: f64 = 2e-5;

impl Layers {
    /// Solves for the profiles R(r) and T(r) under a normal pencil beam.
    ///
    /// They are exact for layers of isotropic scatterers (g = 0) without a face that reflects: R(r) to 1e-4 of itself or better
    /// for r from 1e-4 to 30 mean free paths, which its error states; beyond, to less where hardly anything absorbs.
    /// Light that is scattered once is computed in real space, the rest by wave number: an integral equation over depth
    /// whose kernel is known in closed form but for one smooth integral.
    ///
    /// ```
    /// use translucid_reference::layers::{Ground, Layer, Layers};
    ///
    /// let paint = Layer::new(50.0, 0.1, 0.1);
    /// let wood = Layer::new(10.0, 1.0, f64::INFINITY);
    /// let profile = Layers::new(1.0, vec![paint, wood], Ground::None)?.profile()?;
    /// let near = profile.reflectance(0.01);
    /// assert!(near.relative_error() < 1e-4 && near.value > profile.reflectance(0.02).value);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A layer scatters by another law than the isotropic one, media have different indices of refraction, or there are too
    /// many layers: some 15.
    pub fn profile(&self) -> Result<LayersProfile, LayersError> {
        self.check_for_profile()?;
        let extinctions: Vec<f64> =
            (self.layers.iter()).filter(|layer| layer.scattering > 0.0).map(Layer::extinction).collect();
        let most = extinctions.iter().copied().fold(0.0, f64::max);
        let least = extinctions.iter().copied().fold(most, f64::min);
        let unit = if most > 0.0 { 1.0 / most } else { 1.0 };
        let depths = Depths::count(self, unit, NODES[0]);
        if depths > MOST_DEPTHS {
            let allowed = "at most 800 for a profile: fewer or thinner layers";
            let error = ParameterError::new("number of depths that the layers need", depths as f64, allowed);
            return Err(LayersError { layer: None, error });
        }
        let r_max = FARTHEST * if most > 0.0 { (most / least).min(1e6) } else { 1.0 };
        let contour =
            Contour::new(self.slowest_decay(unit), &Settings { r_max, k_step: STEP, ..Settings::default() });
        let [fine, coarse] = NODES.map(|count| Transform::new(self, unit, count));
        let at = |k: Complex64| {
            let [fine, coarse] = [fine.remainder(k), coarse.remainder(k)];
            [0, 1].map(|side| [fine[side], fine[side] - coarse[side]])
        };
        let values: Vec<[[Complex64; 2]; 2]> = contour.nodes.par_iter().map(|node| at(node.k)).collect();
        let total = at(Complex64::ZERO);
        let side = |side: usize| {
            let inversion = |which: usize| {
                let plain = |value: Complex64| Nested { fine: value, coarse: value };
                let values: Vec<Nested> = values.iter().map(|value| plain(value[side][which])).collect();
                let total = Estimate { value: total[side][which].re, error: 0.0 };
                Inversion::new(&contour, &values).with_total(total)
            };
            let single = Single::new(self, unit, side == 1);
            Side { single, rest: inversion(0), doubt: inversion(1) }
        };
        let is_open = matches!(self.ground, Ground::Medium { .. });
        Ok(LayersProfile { unit, reflected: side(0), transmitted: is_open.then(|| side(1)) })
    }

    /// Checks for what a profile can be solved.
    fn check_for_profile(&self) -> Result<(), LayersError> {
        let eta = self.eta_above;
        let fail = |layer, parameter, value, allowed, limit| {
            let error = ParameterError { limit, ..ParameterError::new(parameter, value, allowed) };
            Err(LayersError { layer, error })
        };
        let same = "for a profile that of the medium above,";
        for (i, layer) in self.layers.iter().enumerate() {
            if !layer.deflection.is_isotropic() && layer.scattering > 0.0 {
                let allowed = "0 for a profile: only totals know other phase functions";
                return fail(Some(i), "g", layer.deflection.moment(1), allowed, None);
            }
            if layer.eta != eta {
                return fail(Some(i), "eta", layer.eta, same, Some(eta));
            }
        }
        match self.ground {
            Ground::Medium { eta: below } if below != eta => fail(None, "eta below", below, same, Some(eta)),
            _ => Ok(()),
        }
    }

    /// Least decay along the layers, or less: no stack keeps light as long as the endless medium of one of its layers.
    fn slowest_decay(&self, unit: f64) -> f64 {
        let decay = |layer: &Layer| {
            let extinction = layer.extinction();
            let alpha = layer.scattering / extinction.max(f64::MIN_POSITIVE);
            unit * extinction * if alpha > 0.0 { Dispersion::new(alpha).k0 } else { 1.0 }
        };
        BEFORE_DECAY * self.layers.iter().map(decay).fold(1.0, f64::min)
    }
}

impl LayersProfile {
    /// Light R(r) that leaves above, per area at the distance r > 0 from the beam \[L⁻²\]; it grows like 1/r.
    ///
    /// r below the least normal number counts as that number, and NaN counts as 0.
    pub fn reflectance(&self, r: f64) -> Estimate {
        self.eval(&self.reflected, r)
    }

    /// Light T(r) that leaves into the medium below, per area at the distance r > 0 from the beam \[L⁻²\]; 0 on a ground.
    ///
    /// r counts as in [`reflectance`](Self::reflectance).
    pub fn transmittance(&self, r: f64) -> Estimate {
        self.transmitted.as_ref().map_or(Estimate::ZERO, |side| self.eval(side, r))
    }

    fn eval(&self, side: &Side, r: f64) -> Estimate {
        // The square of a smaller radius is no number
        let r = (if r > 1e-100 { r.min(1e100) } else { 1e-100 }) / self.unit;
        let (single, rest, doubt) = (side.single.eval(r), side.rest.eval(r), side.doubt.eval(r));
        let error = single.error + rest.error + 3.0 * doubt.value.abs() + COMMON * rest.value.abs();
        let scale = 1.0 / (self.unit * self.unit);
        Estimate {
            value: ((single.value + rest.value) * scale).clamp(0.0, f64::MAX),
            error: (error * scale).min(f64::MAX),
        }
    }
}

#[cfg(test)]
mod tests;
