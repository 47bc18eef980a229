//! Diffusion in layers, as the first guess of what many collisions do.
//!
//! ```text
//! −(η² D φ')' + η² (σ_a + D k²) φ = η² S₀,     D = 1/(3σ'_t)
//! ```
//!
//! with the fluence φ over η² and Robin's condition on both faces, by finite volumes around the depths.

use super::stack::Stack;

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
        let mut resistances: Vec<[f64; 2]> = Vec::new();
        for (number, sheet) in stack.sheets.iter().enumerate() {
            let square = sheet.layer.eta * sheet.layer.eta;
            let diffusion = 1.0 / (3.0 * (sheet.extinction - sheet.g * sheet.scattering));
            for (node, [_, weight]) in sheet.depths.iter().enumerate() {
                places.push([number, node]);
                widths.push(square * weight);
                losses.push(square * weight * (sheet.layer.absorption + diffusion * stack.k * stack.k));
                resistances.push([0.5 * weight / (square * diffusion); 2]);
            }
        }
        let conductances: Vec<f64> = resistances.windows(2).map(|pair| 1.0 / (pair[0][1] + pair[1][0])).collect();
        let count = places.len();
        let leak = |place: usize, reflectance: f64| {
            let sheet = &stack.sheets[places[place][0]];
            let out = 0.5 * sheet.layer.eta * sheet.layer.eta * (1.0 - reflectance) / (1.0 + reflectance);
            1.0 / (resistances[place][0] + 1.0 / out.max(1e-9))
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
        let mut fluence = Vec::with_capacity(count);
        for (i, [number, node]) in self.places.iter().enumerate() {
            let sheet = &stack.sheets[*number];
            let nodes = sheet.depths.len();
            let first = sheet.place(orders, 0, 0, 0);
            let isotropic: f64 = sheet.weights.iter().enumerate()
                .map(|(ray, weight)| weight * sources[first + ray * nodes + node]).sum();
            let mut right = 2.0 * std::f64::consts::PI * isotropic * self.widths[i];
            if i > 0 {
                right += self.conductances[i - 1] / self.pivots[i - 1] * fluence[i - 1];
            }
            fluence.push(right);
        }
        for i in (0..count).rev() {
            let below = if i + 1 < count { self.conductances[i] * fluence[i + 1] } else { 0.0 };
            fluence[i] = (fluence[i] + below) / self.pivots[i];
        }
        for (i, [number, node]) in self.places.iter().enumerate() {
            let sheet = &stack.sheets[*number];
            let nodes = sheet.depths.len();
            let per_angle = sheet.scattering / (4.0 * std::f64::consts::PI);
            let flux = |i: usize| self.conductances[i] * (fluence[i] - fluence[i + 1]);
            let sides = [(i > 0).then(|| flux(i - 1)), (i + 1 < count).then(|| flux(i))];
            let known = sides.iter().flatten().count().max(1) as f64;
            let square = sheet.layer.eta * sheet.layer.eta;
            let down = sides.iter().flatten().sum::<f64>() / known / square;
            let diffusion = 1.0 / (3.0 * (sheet.extinction - sheet.g * sheet.scattering));
            let aside = -diffusion * stack.k * fluence[i];
            for (ray, mu) in sheet.cosines.iter().enumerate() {
                let at = |parity: usize, order: usize| sheet.place(orders, parity, order, 0) + ray * nodes + node;
                sources[at(0, 0)] += 2.0 * per_angle * fluence[i];
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
