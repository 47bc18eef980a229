//! Diffusion in layers, as the first guess of what many collisions do.
//!
//! ```text
//! J = −D ∇φ + 3D S₁,     ∇·J + σ_a φ = S₀,     D = 1/(3σ'_t)
//! ```
//!
//! with the fluence φ over η², the sources' zeroth and first moments over all directions, and Robin's condition on both faces, by finite volumes around the depths.

use std::f64::consts::PI;

use super::stack::{Sheet, Stack};

/// Volumes of all layers that scatter, with the equations eliminated.
pub(super) struct Diffusion {
    /// Layer and depth of each volume.
    places: Vec<[usize; 2]>,
    /// Width of the volume times η².
    widths: Vec<f64>,
    /// Conductance to the next volume.
    conductances: Vec<f64>,
    pivots: Vec<f64>,
}

impl Diffusion {
    /// With the reflectances of the first face and of the last for diffuse light.
    pub(super) fn new(stack: &Stack, reflectances: [f64; 2]) -> Self {
        let (mut places, mut widths, mut losses) = (Vec::new(), Vec::new(), Vec::new());
        let mut resistances = Vec::new();
        for (number, sheet) in stack.sheets.iter().enumerate() {
            let square = sheet.layer.eta * sheet.layer.eta;
            let diffusion = diffusion(sheet);
            for (node, [_, weight]) in sheet.depths.iter().enumerate() {
                places.push([number, node]);
                widths.push(square * weight);
                losses.push(square * weight * (sheet.layer.absorption + diffusion * stack.k * stack.k));
                resistances.push(0.5 * weight / (square * diffusion));
            }
        }
        let conductances: Vec<f64> = resistances.windows(2).map(|pair| 1.0 / (pair[0] + pair[1])).collect();
        let count = places.len();
        let leak = |place: usize, reflectance: f64| {
            let sheet = &stack.sheets[places[place][0]];
            let out = 0.5 * sheet.layer.eta * sheet.layer.eta * (1.0 - reflectance) / (1.0 + reflectance);
            1.0 / (resistances[place] + 1.0 / out.max(1e-9))
        };
        if count > 0 {
            losses[0] += leak(0, reflectances[0]);
            losses[count - 1] += leak(count - 1, reflectances[1]);
        }
        let mut pivots = Vec::with_capacity(count);
        for i in 0..count {
            let above = if i > 0 { conductances[i - 1] } else { 0.0 };
            let below = conductances.get(i).copied().unwrap_or(0.0);
            let taken = if i > 0 { above * above / pivots[i - 1] } else { 0.0 };
            let pivot: f64 = losses[i] + above + below - taken;
            pivots.push(pivot.max(1e-12 * (above + below)));
        }
        Self { places, widths, conductances, pivots }
    }

    /// Adds to sources those that light makes which they diffuse to.
    pub(super) fn add(&self, stack: &Stack, orders: usize, sources: &mut [f64]) {
        let count = self.places.len();
        let moments: Vec<[f64; 3]> = self
            .places
            .iter()
            .map(|[number, node]| moments(&stack.sheets[*number], orders, *node, sources))
            .collect();
        // 3D times the flux that sources send down, at the faces of volumes
        let sent = |i: usize| {
            let sheet = &stack.sheets[self.places[i][0]];
            sheet.layer.eta * sheet.layer.eta * 3.0 * diffusion(sheet) * moments[i][1]
        };
        let sent: Vec<f64> = (1..count).map(|i| 0.5 * (sent(i - 1) + sent(i))).collect();
        // Flux that sources send drives fluence, and hardly any flux: it is the gradient of fluence alone that does
        let isotropic: Vec<f64> = (0..count).map(|i| moments[i][0] * self.widths[i]).collect();
        let divergence = (0..count).map(|i| {
            let aside = 3.0 * diffusion(&stack.sheets[self.places[i][0]]) * stack.k * moments[i][2];
            let above = if i > 0 { sent[i - 1] } else { 0.0 };
            above - sent.get(i).copied().unwrap_or(0.0) + aside * self.widths[i]
        });
        let divergence = self.solve(divergence.collect());
        let fluence = self.solve(isotropic);
        let flux: Vec<f64> =
            self.conductances.iter().enumerate().map(|(i, c)| c * (fluence[i] - fluence[i + 1])).collect();
        for (i, [number, node]) in self.places.iter().enumerate() {
            let sheet = &stack.sheets[*number];
            let per_angle = sheet.scattering / (4.0 * PI);
            let sides = [i.checked_sub(1).and_then(|i| flux.get(i)), flux.get(i)];
            let known = sides.iter().flatten().count().max(1) as f64;
            let square = sheet.layer.eta * sheet.layer.eta;
            let down = sides.into_iter().flatten().sum::<f64>() / known / square;
            let aside = -diffusion(sheet) * stack.k * fluence[i];
            for (ray, mu) in sheet.cosines.iter().enumerate() {
                let at = |parity: usize, order: usize| sheet.place(orders, parity, order, ray) + node;
                sources[at(0, 0)] += 2.0 * per_angle * (fluence[i] + divergence[i]);
                if sheet.g != 0.0 {
                    sources[at(1, 0)] += 6.0 * per_angle * sheet.g * mu * down;
                    if orders > 1 {
                        let sine = (1.0 - mu * mu).max(0.0).sqrt();
                        sources[at(0, 1)] += 3.0 * per_angle * sheet.g * sine * aside;
                    }
                }
            }
        }
    }
}

impl Diffusion {
    /// Fluence of sources.
    fn solve(&self, mut values: Vec<f64>) -> Vec<f64> {
        for i in 1..values.len() {
            values[i] += self.conductances[i - 1] / self.pivots[i - 1] * values[i - 1];
        }
        for i in (0..values.len()).rev() {
            let below = values.get(i + 1).map_or(0.0, |below| self.conductances[i] * below);
            values[i] = (values[i] + below) / self.pivots[i];
        }
        values
    }
}

/// D of a layer.
fn diffusion(sheet: &Sheet) -> f64 {
    1.0 / (3.0 * (sheet.extinction - sheet.g * sheet.scattering))
}

/// Integrals over all directions of sources at a depth: of themselves, and of their components down and, over i, along k.
fn moments(sheet: &Sheet, orders: usize, node: usize, sources: &[f64]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (ray, (weight, mu)) in sheet.weights.iter().zip(&sheet.cosines).enumerate() {
        let at = |parity: usize, order: usize| sources[sheet.place(orders, parity, order, ray) + node];
        let weight = 2.0 * PI * weight;
        sums[0] += weight * at(0, 0);
        sums[1] += weight * mu * at(1, 0);
        if orders > 1 {
            sums[2] += weight * (1.0 - mu * mu).max(0.0).sqrt() * at(0, 1);
        }
    }
    sums
}
