//! Light of one wave number k that leaves layers of isotropic scatterers.
//!
//! Light that varies as e^{ikx} along the layers collides S(z) dz times at each depth, where
//!
//! ```text
//! S(z) = σ_s(z) [φ₀(z) + ∫ K(z, z') S(z') dz' + 4 W_g(z) B],     B = ρ [Φ₀ + ∫ W_g S dz + 4 W_gg B]
//! ```
//!
//! with the beam's fluence φ₀, the fluence K of a plane of isotropic sources, the light W_g of such a plane that gets to a
//! Lambertian ground of the reflectance ρ, and the ground's exitance B (G. B. Rybicki 1971 for the half space). The
//! unknown is S less its first order σ_s φ₀, whose light is added in real space.

use num_complex::Complex64;

use super::super::{Ground, Layers};
use super::cones::{Cones, Faces, Leaving};
use super::depths::{Depths, in_unit, stride};
use super::kernel::Kernel;
use crate::exact::dielectric_directions::DirectionCounts;

/// Rules of one accuracy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    /// Nodes a panel of depths.
    pub(super) panel: usize,
    /// Directions of cones.
    pub(super) directions: DirectionCounts,
}

/// Layers that wait for a wave number.
#[derive(Clone, Debug)]
pub(super) struct Transform {
    kernel: Kernel,
    depths: Depths,
    cones: Cones,
    faces: Faces,
    /// Optical thickness and thickness of all layers.
    end: [f64; 2],
    /// Reflectance of a Lambertian ground.
    ground: f64,
    /// First order σ_s φ₀ at each node, and the beam's flux into the ground.
    first: Vec<f64>,
    grounded: f64,
}

/// A normal beam in the layers: amplitudes of its flux down, from the upper face, and up, from the lower face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beam {
    pub(super) down: f64,
    pub(super) up: f64,
}

impl Beam {
    pub(super) fn new(faces: Faces, depth: f64) -> Self {
        let reflected = |eta: f64| ((eta - 1.0) / (eta + 1.0)) * ((eta - 1.0) / (eta + 1.0));
        let [top, bottom] = [reflected(faces.top), reflected(faces.bottom)];
        let through = libm::exp(-depth);
        let down = (1.0 - top) / (1.0 - top * bottom * through * through);
        Self { down, up: down * through * bottom }
    }
}

impl Transform {
    pub(super) fn new(layers: &Layers, faces: Faces, unit: f64, counts: Counts) -> Self {
        let depths = Depths::new(layers, unit, counts.panel);
        let mut end = [0.0, 0.0];
        for layer in layers.layers() {
            let layer = in_unit(layer, unit);
            end = [end[0] + layer.extinction() * layer.thickness, end[1] + layer.thickness];
        }
        let beam = Beam::new(faces, end[0]);
        let fluence = |tau: f64| {
            let up = if beam.up > 0.0 { beam.up * libm::exp(tau - end[0]) } else { 0.0 };
            beam.down * libm::exp(-tau) + up
        };
        let first = depths.nodes.iter().map(|node| node.scattering * fluence(node.tau)).collect();
        let ground = match layers.ground() {
            Ground::Lambertian { reflectance } => reflectance,
            _ => 0.0,
        };
        let cones = Cones::new(faces, counts.directions);
        let grounded = beam.down * libm::exp(-end[0]);
        Self { kernel: Kernel::new(), depths, cones, faces, end, ground, first, grounded }
    }

    /// Light that leaves above and below, less that which was scattered once and left without being reflected.
    pub(super) fn remainder(&self, k: Complex64) -> [Complex64; 2] {
        let size = self.depths.nodes.len();
        let wide = stride(size);
        let mut matrix = vec![Complex64::ZERO; wide * wide];
        self.depths.add_direct(&self.kernel, k, &mut matrix);
        self.add_images(k, &mut matrix);
        let mut leaving = self.straight(k);
        self.cones.add(&self.depths, self.end, k, &mut matrix, &mut leaving);
        let Leaving { all, straight, of_ground } = &leaving;
        let weights: Vec<f64> = self.depths.nodes.iter().map(|node| node.weight).collect();
        let weighed = |values: &[Complex64], light: &[Complex64]| -> Complex64 {
            values.iter().zip(light).zip(&weights).map(|((a, b), weight)| a * b * *weight).sum()
        };
        let first: Vec<Complex64> = self.first.iter().map(|value| Complex64::from(*value)).collect();
        let mut right = vec![Complex64::ZERO; wide];
        for (i, node) in self.depths.nodes.iter().enumerate() {
            let row = &mut matrix[i * wide..][..wide];
            row[size] = 4.0 * all[1][i];
            right[i] = row.iter().zip(&first).map(|(a, b)| a * b).sum::<Complex64>() * node.scattering;
            row.iter_mut().for_each(|value| *value *= -node.scattering);
            row[i] += 1.0;
        }
        for j in 0..size {
            matrix[size * wide + j] = -self.ground * all[1][j] * weights[j];
        }
        matrix[size * wide + size] = 1.0 - 4.0 * self.ground * of_ground[1];
        right[size] = self.ground * (self.grounded + weighed(&all[1], &first));
        solve(&mut matrix, &mut right);
        let exitance = right[size];
        [0, 1].map(|side| {
            let from_ground = if side == 0 { 4.0 * of_ground[0] * exitance } else { Complex64::ZERO };
            let reflected: Vec<Complex64> =
                all[side].iter().zip(&straight[side]).map(|(all, straight)| all - straight).collect();
            weighed(&all[side], &right[..size]) + weighed(&reflected, &first) + from_ground
        })
    }

    /// Light of sources at each node, and of the ground, that leaves through faces that do not reflect.
    fn straight(&self, k: Complex64) -> Leaving {
        let zeros = vec![Complex64::ZERO; self.depths.nodes.len()];
        let mut leaving = Leaving {
            all: [zeros.clone(), zeros.clone()],
            straight: [zeros.clone(), zeros],
            of_ground: [Complex64::ZERO; 2],
        };
        let [tau_end, z_end] = self.end;
        let has_end = tau_end.is_finite();
        let reflects = self.faces.reflects();
        let flux = |tau: f64, z: f64| 0.5 * self.kernel.eval(tau, k * z)[1];
        for (i, node) in self.depths.nodes.iter().enumerate() {
            let places = [[node.tau, node.z], [tau_end - node.tau, z_end - node.z]];
            for side in 0..if has_end { 2 } else { 1 } {
                if reflects[side] {
                    continue;
                }
                let [tau, z] = places[side];
                leaving.straight[side][i] = flux(tau, z);
                leaving.all[side][i] = leaving.straight[side][i];
                if has_end && reflects[1 - side] {
                    let [tau, z] = places[1 - side];
                    leaving.all[side][i] += flux(tau_end + tau, z_end + z);
                }
            }
        }
        if has_end && self.ground > 0.0 {
            let emitted = |times: f64| 0.5 * self.kernel.eval(times * tau_end, k * times * z_end)[2];
            leaving.of_ground =
                if reflects[0] { [Complex64::ZERO, emitted(2.0)] } else { [emitted(1.0), Complex64::ZERO] };
        }
        leaving
    }

    /// Adds light that a face reflects, as if it reflected all.
    fn add_images(&self, k: Complex64, matrix: &mut [Complex64]) {
        let nodes = &self.depths.nodes;
        let wide = stride(nodes.len());
        let [top, bottom] = self.faces.reflects();
        let [tau_end, z_end] = self.end;
        for i in 0..nodes.len() {
            for j in 0..=i {
                let (tau, z) = (nodes[i].tau + nodes[j].tau, nodes[i].z + nodes[j].z);
                let mut value = Complex64::ZERO;
                if top {
                    value += 0.5 * self.kernel.eval(tau, k * z)[0];
                }
                if bottom {
                    value += 0.5 * self.kernel.eval(2.0 * tau_end - tau, k * (2.0 * z_end - z))[0];
                }
                matrix[i * wide + j] += value * nodes[j].weight;
                if i != j {
                    matrix[j * wide + i] += value * nodes[i].weight;
                }
            }
        }
    }
}

/// Solves the system by Gauss's elimination with partial pivoting; the solution takes the right side's place.
fn solve(matrix: &mut [Complex64], right: &mut [Complex64]) {
    let size = right.len();
    for column in 0..size {
        let size_of = |row: usize| matrix[row * size + column].norm_sqr();
        let pivot = (column..size).max_by(|a, b| size_of(*a).total_cmp(&size_of(*b))).unwrap_or(column);
        if pivot != column {
            let (first, second) = matrix.split_at_mut(pivot * size);
            first[column * size..][..size].swap_with_slice(&mut second[..size]);
            right.swap(column, pivot);
        }
        let inverse = matrix[column * size + column].inv();
        for row in column + 1..size {
            let (first, second) = matrix.split_at_mut(row * size);
            let (source, target) = (&first[column * size..][..size], &mut second[..size]);
            let factor = target[column] * inverse;
            if factor.norm_sqr() > 0.0 {
                target[column..].iter_mut().zip(&source[column..]).for_each(|(t, s)| *t -= factor * s);
                let subtracted = factor * right[column];
                right[row] -= subtracted;
            }
        }
    }
    for row in (0..size).rev() {
        let known: Complex64 = (row + 1..size).map(|j| matrix[row * size + j] * right[j]).sum();
        right[row] = (right[row] - known) / matrix[row * size + row];
    }
}
