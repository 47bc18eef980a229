//! Light of one wave number k that leaves layers of isotropic scatterers.
//!
//! Light that varies as e^{ikx} along the layers collides S(z) dz times at each depth, where
//!
//! ```text
//! S(z) = σ_s(z) [φ₀(z) + ∫ K(z, z') S(z') dz' + 4 W_g(z) B],     B = ρ [Φ₀ + ∫ W_g S dz]
//! ```
//!
//! with the beam's fluence φ₀, the fluence K of a plane of isotropic sources, the light W_g of such a plane that gets to a
//! Lambertian ground of the reflectance ρ, and the ground's exitance B (G. B. Rybicki 1971 for the half space). The
//! unknown is S less its first order σ_s φ₀, whose light is added in real space.

use num_complex::Complex64;

use super::super::{Ground, Layers};
use super::depths::{Depths, in_unit, stride};
use super::kernel::Kernel;

/// Layers that wait for a wave number.
#[derive(Clone, Debug)]
pub(super) struct Transform {
    kernel: Kernel,
    depths: Depths,
    /// Optical thickness and thickness of all layers.
    end: [f64; 2],
    /// Reflectance of a Lambertian ground.
    ground: f64,
}

impl Transform {
    /// With so many nodes in a panel of depths.
    pub(super) fn new(layers: &Layers, unit: f64, panel: usize) -> Self {
        let mut end = [0.0, 0.0];
        for layer in layers.layers() {
            let layer = in_unit(layer, unit);
            end = [end[0] + layer.extinction() * layer.thickness, end[1] + layer.thickness];
        }
        let ground = match layers.ground() {
            Ground::Lambertian { reflectance } => reflectance,
            _ => 0.0,
        };
        Self { kernel: Kernel::new(), depths: Depths::new(layers, unit, panel), end, ground }
    }

    /// Light that leaves above and below, less that which was scattered once by a layer alone.
    pub(super) fn remainder(&self, k: Complex64) -> [Complex64; 2] {
        let nodes = &self.depths.nodes;
        let wide = stride(nodes.len());
        let mut matrix = vec![Complex64::ZERO; wide * wide];
        self.depths.add_direct(&self.kernel, k, &mut matrix);
        let [up, down] = self.leaving(k);
        let first: Vec<f64> = nodes.iter().map(|node| node.scattering * libm::exp(-node.tau)).collect();
        let weights: Vec<f64> = nodes.iter().map(|node| node.weight).collect();

        // Write the equations of all depths, and of the ground
        let mut right = vec![Complex64::ZERO; wide];
        for (i, node) in nodes.iter().enumerate() {
            let row = &mut matrix[i * wide..][..wide];
            row[nodes.len()] = 4.0 * down[i];
            right[i] = row.iter().zip(&first).map(|(a, b)| a * *b).sum::<Complex64>() * node.scattering;
            row.iter_mut().for_each(|value| *value *= -node.scattering);
            row[i] += 1.0;
        }
        let ground = &mut matrix[nodes.len() * wide..];
        let arriving = |values: &mut dyn Iterator<Item = Complex64>| -> Complex64 {
            values.zip(&down).zip(&weights).map(|((value, light), weight)| value * light * *weight).sum()
        };
        for (value, (light, weight)) in ground.iter_mut().zip(down.iter().zip(&weights)) {
            *value = -self.ground * light * *weight;
        }
        ground[nodes.len()] = Complex64::ONE;
        let unscattered = libm::exp(-self.end[0]);
        right[nodes.len()] =
            self.ground * (unscattered + arriving(&mut first.iter().map(|value| Complex64::from(*value))));

        // Solve them, and see what leaves
        solve(&mut matrix, &mut right);
        let of_nodes = |light: &[Complex64]| -> Complex64 {
            right
                .iter()
                .zip(light)
                .zip(&weights)
                .map(|((value, light), weight)| value * light * *weight)
                .sum()
        };
        let mut reflected = of_nodes(&up);
        if self.ground > 0.0 {
            // ∫ of the cosine law: 2 F₃
            let [tau, z] = self.end;
            reflected += 2.0 * self.kernel.eval(tau, k * z)[2] * right[nodes.len()];
        }
        [reflected, of_nodes(&down)]
    }

    /// Light of isotropic sources at each node that gets straight to the upper and to the lower face.
    fn leaving(&self, k: Complex64) -> [Vec<Complex64>; 2] {
        let [tau_end, z_end] = self.end;
        let flux = |tau: f64, z: f64| 0.5 * self.kernel.eval(tau, k * z)[1];
        let nodes = &self.depths.nodes;
        let up = nodes.iter().map(|node| flux(node.tau, node.z)).collect();
        let down = |node: &super::depths::Depth| {
            if tau_end.is_finite() { flux(tau_end - node.tau, z_end - node.z) } else { Complex64::ZERO }
        };
        [up, nodes.iter().map(down).collect()]
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
