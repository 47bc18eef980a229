//! Layers in single precision, as the kernel needs them.

use translucid_profile::{ParameterError, require};

use super::grid::Grid;
use crate::layers::{Ground, Layers};
use crate::walk::boundary::{Beyond, CLEAR, Face, Medium};

/// The layers as the kernel needs them, and the unit of length of the walk.
///
/// # Errors
/// Moments make a phase function negative at some angle, or lengths differ by more than single precision tells.
pub(super) fn media(layers: &Layers) -> Result<(Vec<Medium>, f64), ParameterError> {
    let list = layers.layers();
    let strongest = list.iter().map(|layer| layer.extinction()).fold(0.0, f64::max);
    let unit = if strongest > 0.0 { 1.0 / strongest } else { list[0].thickness };
    let mut depth = 0.0;
    let mut media = Vec::with_capacity(list.len());
    for (i, layer) in list.iter().enumerate() {
        layer.phase_function.check_for_walk()?;
        let extinction = layer.extinction() * unit;
        let is_known = extinction == 0.0 || extinction > 1e-12;
        require(
            is_known,
            "extinction",
            layer.extinction(),
            "0 or more than 1e-12 of the greatest, for a walk",
        )?;
        let thickness = layer.thickness / unit;
        let is_thick = thickness > 1e-12;
        require(
            is_thick,
            "thickness",
            layer.thickness,
            "more than 1e-12 of the shortest mean free path, for a walk",
        )?;
        let above = match i {
            0 => Face::new(layer.eta / layers.eta_above(), Beyond::Outside),
            _ => Face::new(layer.eta / list[i - 1].eta, Beyond::Layer(i - 1)),
        };
        let below = match (list.get(i + 1), layers.ground()) {
            (Some(next), _) => Face::new(layer.eta / next.eta, Beyond::Layer(i + 1)),
            (None, Ground::Medium { eta }) => Face::new(layer.eta / eta, Beyond::Outside),
            (None, Ground::Lambertian { reflectance }) => Face::new(1.0, Beyond::Ground(reflectance as f32)),
            (None, Ground::None) => Face::new(1.0, Beyond::Ground(0.0)),
        };
        media.push(Medium {
            mfp: if extinction > 0.0 { (1.0 / extinction) as f32 } else { CLEAR },
            thickness: thickness.min(f64::from(CLEAR)) as f32,
            top: depth as f32,
            absorbed: if extinction > 0.0 { (layer.absorption * unit / extinction) as f32 } else { 0.0 },
            above,
            below,
        });
        depth = (depth + thickness).min(f64::from(CLEAR));
    }
    Ok((media, unit))
}

/// The grid in units of the walk: numbers of cells per unit, and the last cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cells {
    pub(super) rings_per_unit: f32,
    pub(super) depths_per_unit: f32,
    pub(super) last_ring: f32,
    pub(super) last_depth: f32,
}

impl Cells {
    pub(super) fn new(grid: &Grid, unit: f64) -> Self {
        let per_unit = |length: f64| (unit / length).min(1e30) as f32;
        Self {
            rings_per_unit: per_unit(grid.dr),
            depths_per_unit: per_unit(grid.dz),
            last_ring: (grid.nr - 1) as f32,
            last_depth: (grid.nz - 1) as f32,
        }
    }
}
