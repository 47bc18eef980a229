//! Light that leaves layers around a normal pencil beam.

mod chain;
mod depths;
mod diffuse;
mod diffusion;
mod directions;
mod hankel;
mod kernel;
mod panel;
mod poles;
mod remainder;
mod single;
mod stack;
mod transform;
mod watch;

use num_complex::Complex64;
use rayon::prelude::*;
use translucid_profile::{ParameterError, require};

use self::depths::Depths;
pub use self::diffuse::DiffuseProfile;
use self::single::Single;
use self::transform::Transform;
use self::watch::Watch;
use super::matrix::Matrix;
use super::rays::squared_indices;
use super::{Ground, Layer, Layers, LayersError};
use crate::Estimate;
use crate::exact::h_function::Nested;
use crate::exact::hankel_inversion::{Contour, Inversion, Settings};
use crate::walk::Control;

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
enum Side {
    /// Of isotropic scatterers without faces.
    Contour(Box<Contoured>),
    Directions(Box<directions::Side>),
}

/// Light by complex wave numbers.
#[derive(Clone, Debug)]
struct Contoured {
    single: Single,
    rest: Inversion,
    /// The difference between two rules of depths.
    doubt: Inversion,
}

/// Nodes of a panel of depths, by the finer and the coarser rule, and those of quick solutions.
const NODES: [[usize; 2]; 2] = [[7, 5], [4, 3]];
/// Most nodes of a stack: each wave number solves a system of as many equations.
const MOST_DEPTHS: usize = 800;
/// Radius up to which the error keeps small, in mean free paths of the thinnest medium.
const FARTHEST: f64 = 300.0;
/// Part of the least decay at which wave numbers begin: at the whole, light gets infinitely deep.
const BEFORE_DECAY: f64 = 0.95;
/// Step of wave numbers, and that of quick solutions.
const STEP: [f64; 2] = [0.2, 0.3];
/// Least tolerance, at which the rules are the finest.
const LEAST_TOLERANCE: f64 = 1e-4;
/// Tolerance from which on a quick solution does.
const QUICK: f64 = 5e-3;
/// Error as a part of the value that is in all rules.
const COMMON: f64 = 2e-5;

impl Layers {
    /// Solves for the profiles R(r) and T(r) under a normal pencil beam.
    ///
    /// Light that is scattered once and leaves straight is computed in real space, the rest by wave number.
    ///
    /// Layers of isotropic scatterers (g = 0) without a face that reflects are solved by an integral equation over depth and
    /// complex wave numbers: R(r) to 1e-4 of itself or better for r from 1e-4 to 30 mean free paths, which its error states;
    /// beyond, to less where hardly anything absorbs.
    /// All others are solved by discrete directions for real wave numbers, twice: the difference tells the error. For g = 0 it
    /// is below 1e-3 from 0.003 to 3 mean free paths; for g = 0.8 about 1e-3 from 0.1 to 3 transport mean free paths of an
    /// endless layer, and up to some per cent of itself in slabs of a few mean free paths. It grows beyond.
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
    /// There are too many layers: some 15, and 10 that scatter with faces or by another law than the isotropic one; then more
    /// than 4 indices of refraction, extinction coefficients that differ by more than a factor of 1000, |g| above 0.93 and a
    /// ground that is not black less than a mean free path deep are refused as well.
    pub fn profile(&self) -> Result<LayersProfile, LayersError> {
        // Nobody stops it
        self.profile_within(LEAST_TOLERANCE, &Control::default()).map(|profile| profile.expect("a profile"))
    }

    /// [`profile`](Self::profile) to about a tolerance, as a part of R(r); nothing if it is stopped.
    ///
    /// From 0.005 on the rules are coarser, which is two to six times faster: R(r) of endless skin is known to 0.002 from
    /// 0.1 to 10 mean free paths. Smaller ones take the rules of `profile`, which are the finest. Each number has its error
    /// in either case, and it is that which counts.
    /// Progress counts thousandths.
    ///
    /// # Errors
    /// The tolerance is not in [1e-4, 0.1], or [`profile`](Self::profile) refuses the layers.
    pub fn profile_within(
        &self,
        tolerance: f64,
        control: &Control,
    ) -> Result<Option<LayersProfile>, LayersError> {
        let allowed = (LEAST_TOLERANCE..=0.1).contains(&tolerance);
        require(allowed, "tolerance", tolerance, "in [1e-4, 0.1]")
            .map_err(|error| LayersError { layer: None, error })?;
        let is_quick = tolerance >= QUICK;
        let extinctions: Vec<f64> =
            (self.layers.iter()).filter(|layer| layer.scattering > 0.0).map(Layer::extinction).collect();
        let most = extinctions.iter().copied().fold(0.0, f64::max);
        let least = extinctions.iter().copied().fold(most, f64::min);
        let unit = if most > 0.0 { 1.0 / most } else { 1.0 };
        let is_open = matches!(self.ground, Ground::Medium { .. });
        if !self.is_plain() {
            self.check_for_directions()?;
            let sides = directions::Side::both(self, unit, is_quick, &Watch::new(control, 2));
            return Ok(sides.map(|sides| {
                let [reflected, below] = sides.map(|side| Side::Directions(Box::new(side)));
                LayersProfile { unit, reflected, transmitted: is_open.then_some(below) }
            }));
        }
        let nodes = NODES[usize::from(is_quick)];
        let depths = Depths::count(self, unit, nodes[0]);
        if depths > MOST_DEPTHS {
            let allowed = "at most 800 for a profile: fewer or thinner layers";
            let error = ParameterError::new("number of depths that the layers need", depths as f64, allowed);
            return Err(LayersError { layer: None, error });
        }
        let r_max = FARTHEST * if most > 0.0 { (most / least).min(1e6) } else { 1.0 };
        let contour = Contour::new(
            BEFORE_DECAY * self.slowest_decay(unit).min(1.0),
            &Settings { r_max, k_step: STEP[usize::from(is_quick)], ..Settings::default() },
        );
        let [fine, coarse] = nodes.map(|count| Transform::new(self, unit, count));
        let at = |k: Complex64| {
            let [fine, coarse] = [fine.remainder(k), coarse.remainder(k)];
            [0, 1].map(|side| [fine[side], fine[side] - coarse[side]])
        };
        let watch = Watch::new(control, 1);
        watch.expect(contour.nodes.len());
        let values = contour.nodes.par_iter().map(|node| watch.step(|| at(node.k)));
        let Some(values) = values.collect::<Option<Vec<[[Complex64; 2]; 2]>>>() else { return Ok(None) };
        let total = at(Complex64::ZERO);
        let singles = Single::sides(self, unit, 1);
        let side = |side: usize| {
            let inversion = |which: usize| {
                let plain = |value: Complex64| Nested { fine: value, coarse: value };
                let values: Vec<Nested> = values.iter().map(|value| plain(value[side][which])).collect();
                let total = Estimate { value: total[side][which].re, error: 0.0 };
                Inversion::new(&contour, &values).with_total(total)
            };
            let single = singles[side].clone();
            Side::Contour(Box::new(Contoured { single, rest: inversion(0), doubt: inversion(1) }))
        };
        Ok(Some(LayersProfile { unit, reflected: side(0), transmitted: is_open.then(|| side(1)) }))
    }

    /// Whether scatterers are isotropic, and no face reflects.
    fn is_plain(&self) -> bool {
        let isotropic = |layer: &Layer| layer.scattering == 0.0 || layer.phase_function.is_isotropic();
        self.layers.iter().all(isotropic) && squared_indices(self).len() == 1
    }

    /// Least decay along the layers, or less: no stack keeps light as long as the endless medium of one of its layers.
    fn slowest_decay(&self, unit: f64) -> f64 {
        self.layers.iter().map(|layer| unit * decay(layer)).fold(f64::INFINITY, f64::min)
    }
}

/// Slowest decay of light in an endless medium \[L⁻¹\], by as many moments as give it for all but strong absorption.
///
/// Its inverse is the greatest eigenvalue of the equations of moments (K. M. Case and P. F. Zweifel 1967, *Linear Transport
/// Theory*).
fn decay(layer: &Layer) -> f64 {
    if layer.absorption == 0.0 {
        return 0.0;
    }
    let extinction = layer.extinction();
    let loss = |l: usize| {
        (2 * l + 1) as f64 * (1.0 - layer.scattering / extinction * layer.phase_function.moment(l))
    };
    let element = |i: usize, j: usize| {
        if i.abs_diff(j) == 1 { i.max(j) as f64 / (loss(i) * loss(j)).sqrt() } else { 0.0 }
    };
    let eigen = Matrix::from_fn(DECAY_MOMENTS, element).symmetric_eigen();
    extinction / eigen.values.iter().copied().fold(1.0, f64::max)
}

/// Moments of the equation of decays.
const DECAY_MOMENTS: usize = 48;

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
        let Estimate { value, error } = match side {
            Side::Contour(side) => side.eval(r),
            Side::Directions(side) => side.eval(r),
        };
        let scale = 1.0 / (self.unit * self.unit);
        if (value * scale).is_nan() {
            // A unit whose square is no number
            return Estimate { value: 0.0, error: f64::MAX };
        }
        Estimate { value: (value * scale).clamp(0.0, f64::MAX), error: (error * scale).min(f64::MAX) }
    }
}

impl Contoured {
    fn eval(&self, r: f64) -> Estimate {
        let (single, rest, doubt) = (self.single.eval(r), self.rest.eval(r), self.doubt.eval(r));
        let error = single.error + rest.error + 3.0 * doubt.value.abs() + COMMON * rest.value.abs();
        Estimate { value: single.value + rest.value, error }
    }
}

#[cfg(test)]
mod tests;
