//! Light that is scattered once and leaves without a reflection, in real space.
//!
//! It makes R ~ 1/r, and its transform decays too slowly to be inverted. Rays that leave with p = η sin θ come to the
//! distance r from one depth z(p), so that
//!
//! ```text
//! R₁(r) = (1/r) ∫ σ_s(z) [F(z) p(−μ) + F'(z) p(μ)] Π(1 − F_j) e^{−Σ τ_j/μ_j} dp/η(z)
//! ```
//!
//! with the fluxes F of the beam against the leaving light and F' along with it, and the faces' reflectances F_j.

use translucid_profile::fresnel_from_outside;
use translucid_profile::quadrature::gauss_legendre;

use super::super::{Ground, Layer, Layers};
use super::chain::{beam, etas};
use super::depths::in_unit;
use super::stack::without_peak;
use crate::Estimate;
use crate::phase_function::PhaseFunction;

/// Layers as the light sees them that leaves through one face.
#[derive(Clone, Debug)]
pub(super) struct Single {
    /// Index of refraction outside.
    eta: f64,
    /// From the face on.
    spans: Vec<Span>,
}

/// One layer.
#[derive(Clone, Debug)]
struct Span {
    eta: f64,
    thickness: f64,
    extinction: f64,
    scattering: f64,
    phase_function: PhaseFunction,
    /// The beam's flux against the leaving light at the near face, and along with it at the far face.
    beam: [f64; 2],
}

/// Points of a panel; the coarser rule tells the error.
const POINTS: [usize; 2] = [10, 7];
/// Number of panels that shrink towards the ends of a piece, and by what factor.
const GRADES: i32 = 8;
const GRADE: f64 = 0.3;
/// Optical depth behind which nothing counts.
const DEEPEST: f64 = 60.0;

impl Single {
    /// Light that leaves above, and below, where phase functions have so many moments.
    pub(super) fn sides(layers: &Layers, unit: f64, moments: usize) -> [Self; 2] {
        let scaled: Vec<Layer> = layers.layers().iter().map(|layer| in_unit(layer, unit)).collect();
        let extinction = |layer: &Layer| without_peak(layer, moments);
        let (beams, _) = beam(layers, scaled.iter().map(|layer| extinction(layer) * layer.thickness));
        let span = |(layer, [down, up]): (&Layer, [f64; 2])| Span {
            eta: layer.eta,
            thickness: layer.thickness,
            extinction: extinction(layer),
            scattering: layer.scattering,
            phase_function: layer.phase_function.clone(),
            beam: [down, up],
        };
        let spans: Vec<Span> = scaled.iter().zip(beams).map(span).collect();
        let from_below = |span: &Span| Span { beam: [span.beam[1], span.beam[0]], ..span.clone() };
        let below = match layers.ground() {
            Ground::Medium { .. } => spans.iter().rev().map(from_below).collect(),
            _ => Vec::new(),
        };
        let etas = etas(layers);
        [Self { eta: etas[0], spans }, Self { eta: etas[etas.len() - 1], spans: below }]
    }

    pub(super) fn eval(&self, r: f64) -> Estimate {
        let ends = self.panels(r);
        let [value, coarse] = POINTS.map(|points| {
            let rule = gauss_legendre(points);
            let panel = |ends: &[f64]| -> f64 {
                let half = 0.5 * (ends[1] - ends[0]);
                rule.iter()
                    .map(|(x, weight)| weight * half * self.density(ends[0] + half * (1.0 + x), r))
                    .sum()
            };
            ends.windows(2).map(panel).sum::<f64>() / r
        });
        Estimate { value, error: 0.1 * (value - coarse).abs() + 1e-13 * value }
    }

    /// Ends of panels of p, between which the integrand is smooth.
    fn panels(&self, r: f64) -> Vec<f64> {
        let mut most = self.eta;
        let mut breaks = vec![];
        let mut extinction: f64 = 0.0;
        for (i, span) in self.spans.iter().enumerate() {
            most = most.min(span.eta);
            breaks.push(most);
            extinction = extinction.max(span.extinction);
            if span.thickness.is_finite() {
                breaks.extend(self.ray_across(i, r, most));
            }
        }
        let most = self.spans.first().map_or(0.0, |span| span.eta.min(self.eta));
        let scattering = |span: &&Span| span.scattering > 0.0;
        let least =
            self.spans.iter().filter(scattering).map(|span| span.extinction).fold(extinction, f64::min);
        let first = (r * least / DEEPEST).min(0.5) * most;
        // Deep sources of the beam
        let mut ends = vec![0.0, most];
        let mut end = 0.5 * most;
        while end > first {
            ends.push(end);
            end *= 0.5;
        }
        breaks.retain(|end| *end > 0.0 && *end <= most);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        let mut below = 0.0;
        for end in breaks {
            let width = end - below;
            for step in 1..=GRADES {
                let part = width * GRADE.powi(step);
                ends.push(end - part);
                if below > 0.0 {
                    ends.push(below + part);
                }
            }
            ends.push(end);
            below = end;
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup();
        ends
    }

    /// p of the ray that crosses the layers up to one within the distance r.
    fn ray_across(&self, last: usize, r: f64, most: f64) -> Option<f64> {
        let distance = |p: f64| -> f64 {
            self.spans[..=last]
                .iter()
                .map(|span| span.thickness * p / (span.eta * span.eta - p * p).sqrt())
                .sum()
        };
        let (mut low, mut high) = (0.0, most);
        if distance(most) < r {
            return None;
        }
        // In ln p, where p is small
        for _ in 0..200 {
            let middle = if low > 0.0 { (low * high).sqrt() } else { 0.5 * high };
            if middle <= low || middle >= high {
                break;
            }
            if distance(middle) < r {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }

    /// Integrand at p.
    fn density(&self, p: f64, r: f64) -> f64 {
        let (mut eta_before, mut before) = (self.eta, 0.0);
        let (mut exponent, mut passed) = (0.0, 1.0);
        for span in &self.spans {
            let square = 1.0 - p * p / (span.eta * span.eta);
            if square <= 0.0 {
                return 0.0;
            }
            let mu = square.sqrt();
            if span.eta != eta_before {
                passed *= 1.0 - fresnel_from_outside(mu, eta_before / span.eta);
            }
            let tangent = p / (span.eta * mu);
            let across = span.thickness * tangent;
            if before + across > r {
                if span.scattering == 0.0 {
                    return 0.0;
                }
                let x = (r - before) / tangent;
                let light = |flux: f64, way: f64, cosine: f64| {
                    if flux == 0.0 {
                        0.0
                    } else {
                        flux * libm::exp(-span.extinction * way) * span.phase_function.eval(cosine)
                    }
                };
                let light = light(span.beam[0], x, -mu) + light(span.beam[1], span.thickness - x, mu);
                return span.scattering / span.eta
                    * light
                    * passed
                    * libm::exp(-exponent - span.extinction * x / mu);
            }
            exponent += span.extinction * span.thickness / mu;
            (before, eta_before) = (before + across, span.eta);
        }
        0.0
    }
}
