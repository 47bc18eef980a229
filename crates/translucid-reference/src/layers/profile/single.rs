//! Light that is scattered once and leaves straight, in real space.
//!
//! It makes R ~ 1/r, and its transform decays too slowly to be inverted. From the depth z a share
//!
//! ```text
//! (1/4π) σ_s φ₀(z) e^{−τ ρ/z} z/ρ³,     ρ = √(z² + r²)
//! ```
//!
//! leaves per area at the distance r, where φ₀ = e^{−τ} falls from the upper face on.

use std::f64::consts::PI;

use translucid_profile::quadrature::gauss_legendre;

use super::super::Layers;
use super::depths::in_unit;
use crate::Estimate;

/// Scattering layers as the light sees them that leaves through one face.
#[derive(Clone, Debug)]
pub(super) struct Single {
    /// From the face on.
    spans: Vec<Span>,
    /// Optical thickness of all layers, where the beam comes through them towards the face.
    towards: Option<f64>,
}

/// One layer.
#[derive(Clone, Copy, Debug)]
struct Span {
    z: [f64; 2],
    tau: f64,
    extinction: f64,
    scattering: f64,
}

/// Ends of panels, in multiples of r and of the mean free path.
const IN_RADII: [f64; 10] = [0.02, 0.08, 0.25, 0.5, 1.0, 1.6, 3.0, 8.0, 30.0, 150.0];
const IN_MEAN_FREE_PATHS: [f64; 9] = [0.01, 0.1, 0.5, 1.5, 3.0, 6.0, 12.0, 24.0, 45.0];
/// Points of a panel; the coarser rule tells the error.
const POINTS: [usize; 2] = [10, 7];

impl Single {
    /// Seen from above, or from below.
    pub(super) fn new(layers: &Layers, unit: f64, from_below: bool) -> Self {
        let scaled: Vec<_> = layers.layers().iter().map(|layer| in_unit(layer, unit)).collect();
        let order: Vec<_> = if from_below { scaled.iter().rev().collect() } else { scaled.iter().collect() };
        let (mut z, mut tau, mut spans) = (0.0, 0.0, Vec::new());
        for layer in order {
            let (extinction, scattering) = (layer.extinction(), layer.scattering);
            spans.push(Span { z: [z, z + layer.thickness], tau, extinction, scattering });
            z += layer.thickness;
            tau += extinction * layer.thickness;
        }
        Self { spans, towards: from_below.then_some(tau) }
    }

    pub(super) fn eval(&self, r: f64) -> Estimate {
        let [value, coarse] = POINTS.map(|points| self.sum(r, points));
        Estimate { value, error: 0.1 * (value - coarse).abs() + 1e-14 * value }
    }

    fn sum(&self, r: f64, points: usize) -> f64 {
        let rule = gauss_legendre(points);
        let mut sum = 0.0;
        for span in self.spans.iter().filter(|span| span.scattering > 0.0) {
            let [from, to] = span.z;
            let in_radii = IN_RADII.iter().map(|end| end * r);
            let in_mean_free_paths = IN_MEAN_FREE_PATHS.iter();
            let from_face = in_mean_free_paths.clone().map(|end| from + end / span.extinction);
            let from_end = in_mean_free_paths.map(|end| to - end / span.extinction);
            let last = (from + IN_MEAN_FREE_PATHS[8] / span.extinction).min(to);
            let last = if self.towards.is_some() { to } else { last };
            let mut ends: Vec<f64> = in_radii.chain(from_face).chain(from_end).collect();
            ends.retain(|end| *end > from && *end < last);
            ends.extend([from, last]);
            ends.sort_by(f64::total_cmp);
            for panel in ends.windows(2) {
                let width = panel[1] - panel[0];
                for (x, weight) in &rule {
                    let z = panel[0] + width * (0.5 + 0.5 * x);
                    sum += self.density(span, z, r) * 0.5 * width * weight;
                }
            }
        }
        sum
    }

    fn density(&self, span: &Span, z: f64, r: f64) -> f64 {
        let tau = span.tau + span.extinction * (z - span.z[0]);
        let fluence = libm::exp(self.towards.map_or(-tau, |end| tau - end));
        let mu = 1.0 / libm::hypot(1.0, r / z);
        let distance = z / mu;
        span.scattering * fluence * libm::exp(-tau / mu) * mu / (4.0 * PI * distance * distance)
    }
}
