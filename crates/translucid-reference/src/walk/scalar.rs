//! The walk once more, slow and obvious: one photon, double precision, straight from the physics.
//!
//! The kernel's judge and its bench's unit. It shares nothing with it but the problem: other random numbers,
//! library functions, absorption drawn at each collision, flights that stop at every face, Fresnel's formula
//! from `translucid-profile`, textbook deflection (L. Wang, S. L. Jacques and L. Zheng 1995, *MCML – Monte
//! Carlo modeling of light transport in multi-layered tissues*, §3.5).

use std::f64::consts::TAU;
use std::ops::Range;

use translucid_profile::{fresnel_from_inside, fresnel_from_outside};

use super::{Parameters, PhaseFunction, PhotonCounts, PhotonExit, Problem, Side};
use crate::Incidence;
use crate::split_mix::SplitMix;

type Vector = [f64; 3];

/// Walks the photons of a range, as [`super::trace()`] does.
pub(crate) fn trace_scalar(
    problem: &Problem,
    reference_albedo: f64,
    seed: u64,
    photons: Range<u64>,
    exits: &mut impl FnMut(&PhotonExit),
) -> PhotonCounts {
    let mut counts = PhotonCounts::default();
    for index in photons {
        let mut random = SplitMix::of_photon(seed, index);
        let (exit, collisions) = walk(problem.parameters(), reference_albedo, &mut random);
        counts.launched += 1;
        counts.collisions += collisions;
        match exit {
            Some(exit) => exits(&exit),
            None => counts.absorbed += 1,
        }
    }
    counts
}

/// One photon, until it is out or absorbed.
fn walk(parameters: &Parameters, albedo: f64, random: &mut SplitMix) -> (Option<PhotonExit>, u64) {
    let mut position = point_of_entry(parameters, random);
    let mut direction = direction_of_entry(parameters, random);
    for order in 0u32.. {
        if let Some(side) = fly(parameters, &mut position, &mut direction, random) {
            let [x, y, _] = position.map(|coordinate| coordinate as f32);
            let cos_theta = direction[2].abs() as f32;
            return (Some(PhotonExit { x, y, cos_theta, order, side }), u64::from(order));
        }
        if random.uniform() >= albedo {
            return (None, u64::from(order) + 1);
        }
        let cosine = deflection(parameters.phase_function, random);
        direction = turn(direction, cosine, TAU * random.uniform());
    }
    (None, u64::from(u32::MAX))
}

fn point_of_entry(parameters: &Parameters, random: &mut SplitMix) -> Vector {
    let radius = parameters.spot_radius * random.uniform().sqrt();
    let azimuth = TAU * random.uniform();
    [radius * azimuth.cos(), radius * azimuth.sin(), 0.0]
}

fn direction_of_entry(parameters: &Parameters, random: &mut SplitMix) -> Vector {
    let eta = parameters.eta;
    let (sine, azimuth) = match parameters.incidence {
        Incidence::Pencil { cos_theta } => ((1.0 - cos_theta * cos_theta).sqrt() / eta, 0.0),
        Incidence::Cosine => loop {
            let cosine = random.uniform().sqrt();
            if random.uniform() >= fresnel_from_outside(cosine, eta) {
                break ((1.0 - cosine * cosine).sqrt() / eta, TAU * random.uniform());
            }
        },
        Incidence::UniformCosine => {
            let cosine = random.uniform();
            ((1.0 - cosine * cosine).sqrt(), TAU * random.uniform())
        }
    };
    [sine * azimuth.cos(), sine * azimuth.sin(), (1.0 - sine * sine).sqrt()]
}

/// Flies from collision to collision, from face to face; the face through which the photon left.
fn fly(
    parameters: &Parameters,
    position: &mut Vector,
    direction: &mut Vector,
    random: &mut SplitMix,
) -> Option<Side> {
    let mut flight = -random.uniform().ln();
    loop {
        let (side, face) = if direction[2] < 0.0 {
            (Side::Reflected, 0.0)
        } else {
            (Side::Transmitted, parameters.thickness)
        };
        let to_face = ((face - position[2]) / direction[2]).max(0.0);
        let step = flight.min(to_face);
        for (coordinate, cosine) in position.iter_mut().zip(*direction) {
            *coordinate += step * cosine;
        }
        if flight <= to_face {
            return None;
        }
        flight -= to_face;
        position[2] = face;
        if random.uniform() >= fresnel_from_inside(direction[2], parameters.eta) {
            return Some(side);
        }
        direction[2] = -direction[2];
    }
}

/// The cosine of a deflection.
fn deflection(phase_function: PhaseFunction, random: &mut SplitMix) -> f64 {
    match phase_function {
        PhaseFunction::HenyeyGreenstein { g: 0.0 } => 2.0 * random.uniform() - 1.0,
        PhaseFunction::HenyeyGreenstein { g } => {
            let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * random.uniform());
            ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
        }
        PhaseFunction::Rayleigh => loop {
            let cosine = 2.0 * random.uniform() - 1.0;
            if 2.0 * random.uniform() < 1.0 + cosine * cosine {
                break cosine;
            }
        },
    }
}

/// Wang, Jacques and Zheng 1995, equations 3.22 and 3.23.
fn turn([ux, uy, uz]: Vector, cosine: f64, azimuth: f64) -> Vector {
    let sine = (1.0 - cosine * cosine).sqrt();
    let (sin_phi, cos_phi) = azimuth.sin_cos();
    let turned = if uz.abs() > 0.99999 {
        [sine * cos_phi, sine * sin_phi, cosine * uz.signum()]
    } else {
        let root = (1.0 - uz * uz).sqrt();
        [
            sine * (ux * uz * cos_phi - uy * sin_phi) / root + ux * cosine,
            sine * (uy * uz * cos_phi + ux * sin_phi) / root + uy * cosine,
            -sine * cos_phi * root + uz * cosine,
        ]
    };
    let length = turned.iter().map(|c| c * c).sum::<f64>().sqrt();
    turned.map(|cosine| cosine / length)
}
