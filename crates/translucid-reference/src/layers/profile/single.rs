//! Light that is scattered once and leaves straight, in real space.
//!
//! It makes R ~ 1/r, and its transform decays too slowly to be inverted. From the depth z a share
//!
//! ```text
//! (1/4π) σ_s φ₀(z) e^{−τ ρ/z} (1 − F) z/ρ³,     ρ = √(z² + r²)
//! ```
//!
//! leaves per area at the distance r.

use std::f64::consts::PI;

use translucid_profile::fresnel_from_inside;
use translucid_profile::quadrature::gauss_legendre;

use super::super::Layers;
use super::cones::Faces;
use super::depths::in_unit;
use super::transform::Beam;
use crate::Estimate;

/// Scattering layers as the light sees them that leaves through one face.
#[derive(Clone, Debug)]
pub(super) struct Single {
    /// From the face on.
    spans: Vec<Span>,
    /// Flux of the beam from the face, and towards it, which begins behind all layers.
    beam: [f64; 2],
    /// Optical thickness of all layers.
    end: f64,
    /// Index of refraction of the layers over that outside.
    eta: f64,
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
    pub(super) fn new(layers: &Layers, faces: Faces, unit: f64, from_below: bool) -> Self {
        let scaled: Vec<_> = layers.layers().iter().map(|layer| in_unit(layer, unit)).collect();
        let order: Vec<_> = if from_below { scaled.iter().rev().collect() } else { scaled.iter().collect() };
        let (mut z, mut tau, mut spans) = (0.0, 0.0, Vec::new());
        for layer in order {
            let (extinction, scattering) = (layer.extinction(), layer.scattering);
            spans.push(Span { z: [z, z + layer.thickness], tau, extinction, scattering });
            z += layer.thickness;
            tau += extinction * layer.thickness;
        }
        let Beam { down, up } = Beam::new(faces, tau);
        let (beam, ratio) = if from_below { ([up, down], faces.bottom) } else { ([down, up], faces.top) };
        Self { spans, beam, end: tau, eta: 1.0 / ratio }
    }

    pub(super) fn eval(&self, r: f64) -> Estimate {
        let [value, coarse] = POINTS.map(|points| self.sum(r, points));
        Estimate { value, error: 0.1 * (value - coarse).abs() + 1e-14 * value }
    }

    fn sum(&self, r: f64, points: usize) -> f64 {
        let rule = gauss_legendre(points);
        let critical = if self.eta > 1.0 { r * (self.eta * self.eta - 1.0).sqrt() } else { 0.0 };
        let mut sum = 0.0;
        for span in self.spans.iter().filter(|span| span.scattering > 0.0) {
            let [from, to] = span.z;
            let in_radii = IN_RADII.iter().map(|end| end * r);
            let in_mean_free_paths = IN_MEAN_FREE_PATHS.iter();
            let from_face = in_mean_free_paths.clone().map(|end| from + end / span.extinction);
            let from_end = in_mean_free_paths.map(|end| to - end / span.extinction);
            let last = (from + IN_MEAN_FREE_PATHS[8] / span.extinction).min(to);
            let last = if self.beam[1] > 0.0 { to } else { last };
            let mut ends: Vec<f64> = in_radii.chain(from_face).chain(from_end).chain([critical]).collect();
            ends.retain(|end| *end > from && *end < last);
            ends.extend([from, last]);
            ends.sort_by(f64::total_cmp);
            for panel in ends.windows(2).filter(|panel| panel[1] > critical) {
                let width = panel[1] - panel[0];
                for (x, weight) in &rule {
                    // Fresnel's transmittance begins like a root
                    let x = 0.5 + 0.5 * x;
                    sum += self.density(span, panel[0] + width * x * x, r) * width * x * weight;
                }
            }
        }
        sum
    }

    fn density(&self, span: &Span, z: f64, r: f64) -> f64 {
        let tau = span.tau + span.extinction * (z - span.z[0]);
        let towards = if self.beam[1] > 0.0 { self.beam[1] * libm::exp(tau - self.end) } else { 0.0 };
        let fluence = self.beam[0] * libm::exp(-tau) + towards;
        let mu = 1.0 / libm::hypot(1.0, r / z);
        let passed = if self.eta == 1.0 { 1.0 } else { 1.0 - fresnel_from_inside(mu, self.eta) };
        let distance = z / mu;
        span.scattering * fluence * libm::exp(-tau / mu) * passed * mu / (4.0 * PI * distance * distance)
    }
}
