//! Launching photons, 16 at a time.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, mask32x16};

use super::Problem;
use super::boundary::Interface;
use super::lanes::{Floats, Words, circle, complement, unit};
use super::random::Stream;
use super::scatter::Directions;
use crate::Incidence;

/// Law by which photons start, place and direction just inside the medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PhotonSource {
    directions: StartDirections,
    spot_radius: f32,
}

#[derive(Clone, Copy, Debug)]
enum StartDirections {
    /// One direction, in the plane y = 0.
    Pencil { sine: f32, cosine: f32 },
    /// All directions of equal radiance outside, refracted.
    Cosine { eta: f32, rarer: Interface },
    /// Uniform in the cosine inside.
    UniformCosine,
}

impl PhotonSource {
    pub(crate) fn new(problem: &Problem) -> Self {
        let parameters = problem.parameters();
        let eta = parameters.eta;
        let directions = match parameters.incidence {
            Incidence::Pencil { cos_theta } => {
                let sine = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt() / eta;
                // In a form that keeps its digits near grazing
                let cosine = ((eta - 1.0) * (eta + 1.0) + cos_theta * cos_theta).max(0.0).sqrt() / eta;
                StartDirections::Pencil { sine: sine as f32, cosine: cosine as f32 }
            }
            Incidence::Cosine => {
                StartDirections::Cosine { eta: eta as f32, rarer: Interface::new(eta.min(1.0 / eta)) }
            }
            Incidence::UniformCosine => StartDirections::UniformCosine,
        };
        Self { directions, spot_radius: parameters.spot_radius as f32 }
    }

    /// Draws points of entry.
    #[inline(always)]
    pub(crate) fn positions<S: Simd>(
        &self,
        simd: S,
        streams: &mut Stream<Words<S>>,
    ) -> (Floats<S>, Floats<S>) {
        if self.spot_radius == 0.0 {
            return (Floats::splat(simd, 0.0), Floats::splat(simd, 0.0));
        }
        let radius = unit(streams.next()).sqrt() * self.spot_radius;
        let (x, y) = circle(simd, streams.next());
        (radius * x, radius * y)
    }

    /// Draws directions.
    #[inline(always)]
    pub(crate) fn directions<S: Simd>(&self, simd: S, streams: &mut Stream<Words<S>>) -> Directions<S> {
        let splat = |value| Floats::splat(simd, value);
        match self.directions {
            StartDirections::Pencil { sine, cosine } => {
                Directions { x: splat(sine), y: splat(0.0), z: splat(cosine) }
            }
            StartDirections::UniformCosine => {
                let cosine = unit(streams.next());
                around_normal(simd, complement(cosine), cosine, streams)
            }
            StartDirections::Cosine { eta: 1.0, .. } => {
                let cosine = unit(streams.next()).sqrt();
                around_normal(simd, complement(cosine), cosine, streams)
            }
            StartDirections::Cosine { eta, rarer } => {
                let cosine = transmitted_cosines(simd, rarer, streams);
                if eta < 1.0 {
                    return around_normal(simd, complement(cosine), cosine, streams);
                }
                let sine = complement(cosine) / eta;
                around_normal(simd, sine, complement(sine), streams)
            }
        }
    }
}

/// Directions of given sine and cosine to the normal, with uniform azimuth.
#[inline(always)]
fn around_normal<S: Simd>(
    simd: S,
    sine: Floats<S>,
    cosine: Floats<S>,
    streams: &mut Stream<Words<S>>,
) -> Directions<S> {
    let (x, y) = circle(simd, streams.next());
    Directions { x: sine * x, y: sine * y, z: cosine }
}

/// Cosines μ on the side of lower index with density ∝ μ (1 − F(μ)), seen from that side.
///
/// Light enters so on the rarer side, and by reciprocity of F what light of equal radiance brings to it
/// from the denser. Candidates √u are accepted with probability 1 − F, which is near 1 on this side. A lane
/// that is done draws no more: how often its neighbours try is none of its business.
#[inline(always)]
fn transmitted_cosines<S: Simd>(simd: S, rarer: Interface, streams: &mut Stream<Words<S>>) -> Floats<S> {
    let mut accepted = Floats::splat(simd, 1.0);
    let mut pending = mask32x16::splat(simd, true);
    while pending.any_true() {
        let before = *streams;
        let cosine = unit(streams.next()).sqrt();
        let transmits = unit(streams.next()).simd_gt(rarer.reflectance(simd, cosine));
        accepted = (pending & transmits).select(cosine, accepted);
        for (after, before) in streams.0.iter_mut().zip(before.0) {
            *after = pending.select(*after, before);
        }
        pending &= !transmits;
    }
    accepted
}
