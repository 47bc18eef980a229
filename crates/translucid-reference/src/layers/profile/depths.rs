//! Depths at which the collisions of layers are known, and the integral of a kernel over all others.
//!
//! Collisions are smooth inside a layer and have terms like z ln z at its faces, so panels of Gauss–Legendre nodes shrink
//! towards both. The kernel of a layer depends on the distance u alone and grows like ln u: its integral over a layer runs
//! over u, by pieces that shrink towards 0, the same for all nodes, and takes the collisions there from the panel's
//! polynomial.

use std::collections::BTreeMap;

use num_complex::Complex64;
use translucid_profile::quadrature::gauss_legendre;

use super::super::{Layer, Layers};
use super::kernel::Kernel;
use crate::exact::dispersion::Dispersion;

/// Nodes of all layers, in units of the length that the profile counts in.
#[derive(Clone, Debug)]
pub(super) struct Depths {
    /// In order of depth.
    pub(super) nodes: Vec<Depth>,
    scattering_layers: Vec<ScatteringLayer>,
}

/// One node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    /// Depth z.
    pub(super) z: f64,
    /// Optical depth τ.
    pub(super) tau: f64,
    /// Weight dz.
    pub(super) weight: f64,
    /// σ_s.
    pub(super) scattering: f64,
}

/// Nodes of one layer.
#[derive(Clone, Debug)]
struct ScatteringLayer {
    first: usize,
    count: usize,
    extinction: f64,
    /// Distances at which the kernel is needed.
    distances: Vec<f64>,
    uses: Vec<Use>,
}

/// Kernel value `distance` times `weights`: parts of row `row` from the column `column` on.
#[derive(Clone, Debug)]
struct Use {
    row: usize,
    column: usize,
    distance: usize,
    weights: Vec<f64>,
}

/// Ends of panels by the distance from a face, in mean free paths or thicknesses, whichever is smaller.
const PANELS: [f64; 5] = [0.01, 0.1, 0.5, 1.5, 3.5];
/// Growth of panels farther in, and where it begins to be that of an endless layer.
const ENDLESS_FROM: f64 = 16.0;
const GROWTH: f64 = 1.6;
const ENDLESS_GROWTH: f64 = 2.0;
/// Greatest depth of an endless layer that counts, in mean free paths, and that by its least decay along itself: with the
/// wave numbers of the profile light decays with depth at least a third as fast.
const DEEPEST: f64 = 3e4;
const DEEPEST_BY_DECAY: f64 = 120.0;
/// Ends of pieces by the distance from a node, in the same.
const PIECES: [f64; 15] =
    [1e-5, 5e-5, 2.5e-4, 1.2e-3, 6e-3, 0.03, 0.12, 0.4, 1.0, 2.2, 4.5, 9.0, 18.0, 40.0, 100.0];
/// Points of a piece.
const PIECE_POINTS: usize = 10;

impl Depths {
    /// So many nodes a panel, in a unit of length.
    pub(super) fn new(layers: &Layers, unit: f64, count: usize) -> Self {
        let rule = gauss_legendre(count);
        let (mut nodes, mut scattering_layers) = (Vec::new(), Vec::new());
        let (mut z, mut tau) = (0.0, 0.0);
        for layer in layers.layers() {
            let layer = in_unit(layer, unit);
            if layer.scattering > 0.0 {
                let ends = panel_ends(&layer);
                let first = nodes.len();
                for panel in ends.windows(2) {
                    let half = 0.5 * (panel[1] - panel[0]);
                    nodes.extend(rule.iter().map(|(x, weight)| {
                        let inside = panel[0] + half * (1.0 + x);
                        let tau = tau + layer.extinction() * inside;
                        Depth { z: z + inside, tau, weight: half * weight, scattering: layer.scattering }
                    }));
                }
                let inside: Vec<f64> = nodes[first..].iter().map(|node| node.z - z).collect();
                scattering_layers.push(ScatteringLayer::new(&layer, first, &ends, &inside));
            }
            z += layer.thickness;
            tau += layer.extinction() * layer.thickness;
        }
        Self { nodes, scattering_layers }
    }

    /// Number of nodes that layers need, with so many in a panel.
    pub(super) fn count(layers: &Layers, unit: f64, per_panel: usize) -> usize {
        let scattering = layers.layers().iter().filter(|layer| layer.scattering > 0.0);
        scattering.map(|layer| per_panel * (panel_ends(&in_unit(layer, unit)).len() - 1)).sum()
    }

    /// Adds ½ ∫ F₁ S dz of light that goes straight from all depths to each node.
    pub(super) fn add_direct(&self, kernel: &Kernel, k: Complex64, matrix: &mut [Complex64]) {
        let size = self.nodes.len();
        for layer in &self.scattering_layers {
            let values: Vec<Complex64> = (layer.distances.iter())
                .map(|u| 0.5 * kernel.eval(layer.extinction * u, k * *u)[0])
                .collect();
            for Use { row, column, distance, weights } in &layer.uses {
                let row = &mut matrix[row * stride(size) + column..][..weights.len()];
                row.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += values[*distance] * *weight);
            }
            // Other layers, from below
            for i in layer.first..layer.first + layer.count {
                for j in 0..layer.first {
                    let [above, below] = [self.nodes[j], self.nodes[i]];
                    let value = 0.5 * kernel.eval(below.tau - above.tau, k * (below.z - above.z))[0];
                    matrix[i * stride(size) + j] += value * above.weight;
                    matrix[j * stride(size) + i] += value * below.weight;
                }
            }
        }
    }
}

/// Columns of the matrix: one for each node, and one for the ground.
pub(super) fn stride(nodes: usize) -> usize {
    nodes + 1
}

/// Layer whose lengths are in another unit.
pub(super) fn in_unit(layer: &Layer, unit: f64) -> Layer {
    Layer {
        scattering: layer.scattering * unit,
        absorption: layer.absorption * unit,
        thickness: layer.thickness / unit,
        ..layer.clone()
    }
}

/// Length on which collisions vary near a face.
fn scale(layer: &Layer) -> f64 {
    (1.0 / layer.extinction()).min(layer.thickness)
}

/// Depth of an endless layer that counts, in mean free paths.
fn deepest(layer: &Layer) -> f64 {
    let decay = Dispersion::new(layer.scattering / layer.extinction()).k0;
    (DEEPEST_BY_DECAY / decay).min(DEEPEST)
}

/// Ends of panels from face to face.
fn panel_ends(layer: &Layer) -> Vec<f64> {
    let (scale, is_endless) = (scale(layer), layer.thickness.is_infinite());
    let middle = if is_endless { scale * deepest(layer) } else { 0.5 * layer.thickness };
    let growth = |end: f64| {
        if is_endless && end >= ENDLESS_FROM * scale { ENDLESS_GROWTH } else { GROWTH }
    };
    ends_to(middle, layer.thickness, PANELS.map(|end| end * scale), growth)
}

/// Ends of panels from a face to another, mirrored at the middle, or to the middle of an endless layer, which is its deepest
/// end: first some that are given, then such that grow by a factor of the last one.
pub(super) fn ends_to(middle: f64, thickness: f64, first: [f64; 5], growth: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut ends = vec![0.0];
    ends.extend(first);
    while let Some(last) = ends.last().copied().filter(|last| *last < middle) {
        ends.push(last * growth(last));
    }
    if thickness.is_infinite() {
        return ends;
    }
    // A last panel that would be very small becomes part of the one before
    ends.retain(|end| *end < 0.8 * middle);
    let above: Vec<f64> = ends.iter().rev().map(|end| thickness - end).collect();
    ends.push(middle);
    ends.extend(above);
    ends
}

impl ScatteringLayer {
    fn new(layer: &Layer, first: usize, ends: &[f64], inside: &[f64]) -> Self {
        let scale = scale(layer);
        let per_panel = inside.len() / (ends.len() - 1);
        let bottom = ends[ends.len() - 1];
        let pieces: Vec<f64> = std::iter::once(0.0).chain(PIECES.iter().map(|end| end * scale)).collect();
        let rule = gauss_legendre(PIECE_POINTS);
        let points = |from: f64, to: f64| {
            let half = 0.5 * (to - from);
            rule.iter().map(move |(x, weight)| (from + half * (1.0 + x), half * weight))
        };
        let whole: Vec<Vec<(f64, f64)>> =
            pieces.windows(2).map(|piece| points(piece[0], piece[1]).collect()).collect();
        let mut uses = BTreeMap::<_, Vec<f64>>::new();
        let mut add = |row: usize, at: f64, distance: usize, share: f64| {
            let (panel, weights) = interpolation(ends, inside, per_panel, at);
            let key = (first + row, first + panel * per_panel, distance);
            let sums = uses.entry(key).or_insert_with(|| vec![0.0; per_panel]);
            sums.iter_mut().zip(weights).for_each(|(sum, weight)| *sum += share * weight);
        };
        for (row, at) in inside.iter().enumerate() {
            for (sign, most) in [(-1.0, *at), (1.0, bottom - at)] {
                for (number, piece) in pieces.windows(2).enumerate().filter(|(_, piece)| piece[0] < most) {
                    let known: Vec<f64> = whole[number].iter().map(|(u, _)| *u).collect();
                    let place = |point: usize| number * PIECE_POINTS + point;
                    if piece[1] <= most {
                        for (point, (u, weight)) in whole[number].iter().enumerate() {
                            add(row, at + sign * u, place(point), *weight);
                        }
                        continue;
                    }
                    // The layer ends within the piece, whose kernel is a polynomial of the same values
                    for (u, weight) in points(piece[0], most) {
                        for (point, share) in lagrange(&known, u).into_iter().enumerate() {
                            add(row, at + sign * u, place(point), weight * share);
                        }
                    }
                }
            }
        }
        let distances = whole.into_iter().flatten().map(|(u, _)| u).collect();
        let uses =
            uses.into_iter().map(|((row, column, distance), weights)| Use { row, column, distance, weights });
        Self { first, count: inside.len(), extinction: layer.extinction(), distances, uses: uses.collect() }
    }
}

/// The panel of a depth, and the weights of its nodes in Lagrange's polynomial.
fn interpolation(ends: &[f64], nodes: &[f64], per_panel: usize, at: f64) -> (usize, Vec<f64>) {
    let panel = ends.partition_point(|end| *end < at).clamp(1, ends.len() - 1) - 1;
    (panel, lagrange(&nodes[panel * per_panel..][..per_panel], at))
}

/// Weights of the values at nodes in Lagrange's polynomial.
fn lagrange(nodes: &[f64], at: f64) -> Vec<f64> {
    let weight = |i: usize| {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| (at - other) / (nodes[i] - other)).product()
    };
    (0..nodes.len()).map(weight).collect()
}
