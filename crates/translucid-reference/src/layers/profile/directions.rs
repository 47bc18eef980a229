//! Profiles of layers of any phase functions and faces, by real wave numbers.
//!
//! Two solutions, of fewer and more directions, moments, wave numbers and poles, tell the error.

use rayon::prelude::*;
use translucid_profile::ParameterError;

use super::super::rays::squared_indices;
use super::super::{Ground, Layer, Layers, LayersError};
use super::hankel::Hankel;
use super::poles::Poles;
use super::remainder::{Remainder, remainder};
use super::single::Single;
use super::stack::Resolution;
use super::watch::Watch;
use crate::Estimate;

/// Light that leaves through one face.
#[derive(Clone, Debug)]
pub(super) struct Side {
    solutions: [(Single, Hankel); 2],
    /// Radius from which on wave numbers say nothing.
    farthest: f64,
    /// Part of the value that equations left unsolved.
    left: f64,
    /// Error over the difference of the two solutions.
    caution: f64,
}

/// How finely the finer and the coarser solution are made.
#[derive(Clone, Copy, Debug)]
struct Settings {
    /// Moments of the phase functions.
    moments: usize,
    /// Nodes of a panel of depths.
    nodes: usize,
    /// Most orders of the azimuth.
    orders: usize,
    /// Rays and azimuths that are added by ln k.
    growth: [f64; 2],
    /// Norm of what may be left of the equations, over that of their right sides.
    enough: f64,
    /// Step of ln k.
    step: f64,
    /// Step of ln κ of poles.
    pole_step: f64,
}

/// Wave numbers, by the least transport coefficient or the slowest decay, and by the greatest extinction coefficient.
const LEAST: [f64; 2] = [0.02, 0.05];
const MOST: f64 = 40.0;
/// Poles, by the least and the greatest wave number.
const POLES: [f64; 2] = [0.3, 1.0];

impl Settings {
    /// Resolution for a wave number in mean free paths.
    fn resolution(&self, k: f64) -> Resolution {
        let [rays, azimuths] = self.growth.map(|growth| growth * libm::log1p(k));
        let orders = ((3.0 + 6.0 * k.min(10.0)) as usize).min(self.moments).min(self.orders);
        Resolution {
            rays: (self.moments / 2).max(8) + rays as usize,
            moments: self.moments,
            orders,
            azimuths: (4.0 + 0.5 * orders as f64 + azimuths) as usize,
            nodes: self.nodes,
            enough: self.enough,
        }
    }
}

/// Light by one rule.
struct Solution {
    sides: [(Single, Hankel); 2],
    farthest: f64,
    left: f64,
}

/// Solves by one rule, for light that leaves above and below; nothing if it is stopped.
fn solve(layers: &Layers, unit: f64, settings: &Settings, watch: &Watch) -> Option<Solution> {
    let scattering = || layers.layers().iter().filter(|layer| layer.scattering > 0.0);
    let transport =
        |layer: &Layer| unit * (layer.extinction() - layer.scattering * layer.phase_function.moment(1));
    let k0 = layers.slowest_decay(unit);
    let low = (LEAST[0] * scattering().map(transport).fold(1.0, f64::min)).max(LEAST[1] * k0);
    let span = libm::log(MOST / low);
    let count = (span / settings.step).ceil() as usize + 1;
    watch.expect(count);
    let ks: Vec<f64> = (0..count).map(|i| low * libm::exp(span * i as f64 / (count - 1) as f64)).collect();
    let at = |k: &f64| watch.step(|| remainder(layers, unit, *k, &settings.resolution(*k)));
    let values: Vec<Remainder> = ks.par_iter().map(at).collect::<Option<_>>()?;
    let [above, below] = Single::sides(layers, unit, settings.moments);
    let poles = |side: usize| {
        let sample = |(k, value): (&f64, &Remainder)| [*k, value.rest[side], value.straight[side]];
        let samples: Vec<[f64; 3]> = ks.iter().zip(&values).map(sample).collect();
        let poles = Poles::new(&samples, k0, [POLES[0] * low, POLES[1] * MOST], settings.pole_step);
        let plain: Vec<[f64; 2]> = samples.iter().map(|[k, value, _]| [*k, *value]).collect();
        let bend =
            plain.iter().find(|[_, value]| value.abs() < 0.5 * plain[0][1].abs()).map_or(1.0, |[k, _]| *k);
        Hankel::new(poles, &plain, bend)
    };
    let left = values.iter().map(|value| value.left).fold(0.0, f64::max);
    Some(Solution { sides: [(above, poles(0)), (below, poles(1))], farthest: 1.0 / low, left })
}

impl Side {
    /// Light that leaves above, and below; nothing if it is stopped.
    pub(super) fn both(layers: &Layers, unit: f64, is_quick: bool, watch: &Watch) -> Option<[Self; 2]> {
        let [fine, coarse] = settings(layers, is_quick);
        let Solution { sides: [above, below], farthest, left } = solve(layers, unit, &fine, watch)?;
        let [coarse_above, coarse_below] = solve(layers, unit, &coarse, watch)?.sides;
        let is_clear = layers.layers().iter().any(|layer| layer.scattering == 0.0);
        let caution = CAUTION[usize::from(is_clear)];
        let side = |fine, coarse| Self { solutions: [fine, coarse], farthest, left, caution };
        Some([side(above, coarse_above), side(below, coarse_below)])
    }

    pub(super) fn eval(&self, r: f64) -> Estimate {
        let [value, coarse] = self.values(r);
        // Where the two cross they agree by chance
        let beside = [0.75, 1.3].map(|factor| {
            let [value, coarse] = self.values(factor * r);
            (value - coarse).abs() * factor
        });
        let doubt = beside.into_iter().fold((value - coarse).abs(), f64::max);
        let unknown = if r > self.farthest { value.abs() } else { 0.0 };
        Estimate {
            value: value.max(0.0),
            error: self.caution * doubt + (COMMON + 10.0 * self.left) * value.abs() + unknown,
        }
    }

    fn values(&self, r: f64) -> [f64; 2] {
        [0, 1].map(|i| self.solutions[i].0.eval(r).value + self.solutions[i].1.eval(r))
    }
}

impl Layers {
    /// Checks for what [`Side::both`] solves.
    pub(super) fn check_for_directions(&self) -> Result<(), LayersError> {
        let require = |is_allowed, parameter, value, allowed, layer| {
            let error = ParameterError::new(parameter, value, allowed);
            if is_allowed { Ok(()) } else { Err(LayersError { layer, error }) }
        };
        let indices = squared_indices(self).len();
        let allowed = "at most 4 for a profile";
        require(indices <= 4, "number of different eta", indices as f64, allowed, None)?;
        let scattering = || self.layers().iter().enumerate().filter(|(_, layer)| layer.scattering > 0.0);
        let count = scattering().count();
        let allowed = "at most 10 for a profile with faces or of scatterers that are not isotropic";
        require(count <= 10, "number of layers that scatter", count as f64, allowed, None)?;
        let extinctions = || scattering().map(|(_, layer)| layer.extinction());
        let contrast = extinctions().fold(0.0, f64::max) / extinctions().fold(f64::INFINITY, f64::min);
        let allowed = "at most 1000 for a profile";
        require(
            contrast <= 1e3 || count == 0,
            "greatest extinction over the least",
            contrast,
            allowed,
            None,
        )?;
        if matches!(self.ground, Ground::Lambertian { reflectance } if reflectance > 0.0) {
            // The beam's spot on the ground is seen as sharp as it is far
            let thickness: f64 = self.layers().iter().map(|layer| layer.thickness).sum();
            let depth = thickness * extinctions().fold(0.0, f64::max);
            let allowed = "at least 1 for a profile with faces or of scatterers that are not isotropic, or a black ground";
            require(
                depth >= 1.0,
                "mean free paths of the densest layer that the ground is deep",
                depth,
                allowed,
                None,
            )?;
        }
        for (i, layer) in scattering() {
            let peak = layer.phase_function.moment(MOMENTS[MOMENTS.len() - 1]).abs();
            let allowed = "at most 0.1 for a profile, which is g = 0.93";
            require(peak <= 0.1, "moment 32 of the phase function", peak, allowed, Some(i))?;
        }
        Ok(())
    }
}

/// Error over the difference of the two solutions, without and with clear layers: both have few directions for the long ways
/// that light goes through those.
const CAUTION: [f64; 2] = [2.0, 4.0];
/// Error as a part of the value that is in both solutions.
const COMMON: f64 = 3e-4;

/// The finer and the coarser solution's.
fn settings(layers: &Layers, is_quick: bool) -> [Settings; 2] {
    let scattering = || layers.layers().iter().filter(|layer| layer.scattering > 0.0);
    let peak = |moments: usize| {
        scattering().map(|layer| layer.phase_function.moment(moments).abs()).fold(0.0, f64::max)
    };
    let few = MOMENTS.iter().position(|moments| peak(*moments) < SMALL_PEAK).unwrap_or(MOMENTS.len() - 1);
    let coarser = |number: usize| if peak(MOMENTS[number]) == 0.0 { number } else { number.max(1) - 1 };
    let fine = Settings {
        moments: MOMENTS[few],
        nodes: 6,
        orders: 16,
        growth: [2.0, 2.0],
        enough: 1e-7,
        step: 0.3,
        pole_step: 0.75,
    };
    let moments = MOMENTS[coarser(few)];
    let coarse = Settings { moments, nodes: 5, orders: 10, step: 0.36, pole_step: 0.9, ..fine };
    if !is_quick {
        return [fine, coarse];
    }
    let fine =
        Settings { moments, nodes: 4, orders: 8, growth: [1.0, 1.5], enough: 2e-4, step: 0.36, ..fine };
    let moments = MOMENTS[coarser(coarser(few))];
    [fine, Settings { moments, nodes: 3, orders: 6, step: 0.43, pole_step: 0.9, ..fine }]
}

/// Numbers of moments, of which the first does that leaves a peak so small.
const MOMENTS: [usize; 7] = [2, 4, 8, 12, 16, 24, 32];
const SMALL_PEAK: f64 = 6e-3;
