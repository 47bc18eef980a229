//! The walk once more, slow and obvious: one photon, double precision, straight from the physics.
//!
//! The kernel's judge and its bench's unit. It shares nothing with it but the problem: other random numbers,
//! library functions, absorption drawn at each collision, flights that stop at every face, Fresnel's formula
//! from `translucid-profile`, textbook deflection.

use std::f64::consts::TAU;
use std::ops::Range;

use translucid_profile::{fresnel_from_inside, fresnel_from_outside};

use super::{Parameters, PhotonCounts, PhotonExit, Problem, Side};
use crate::Incidence;
use crate::ray::{Ray, across, deflection};
use crate::split_mix::SplitMix;

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
    let mut ray = enter(parameters, random);
    for order in 0u32.. {
        if let Some(side) = fly(parameters, &mut ray, random) {
            let [x, y, _] = ray.position.map(|coordinate| coordinate as f32);
            let cos_theta = ray.direction[2].abs() as f32;
            return (Some(PhotonExit { x, y, cos_theta, order, side }), u64::from(order));
        }
        if random.uniform() >= albedo {
            return (None, u64::from(order) + 1);
        }
        let cosine = deflection(&parameters.phase_function, random);
        ray.direction = across(ray.direction, cosine, TAU * random.uniform());
    }
    (None, u64::from(u32::MAX))
}

/// Draws the point of entry and the direction inside.
fn enter(parameters: &Parameters, random: &mut SplitMix) -> Ray {
    let radius = parameters.spot_radius * random.uniform().sqrt();
    let around = TAU * random.uniform();
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
    Ray {
        position: [radius * libm::cos(around), radius * libm::sin(around), 0.0],
        direction: [sine * libm::cos(azimuth), sine * libm::sin(azimuth), (1.0 - sine * sine).sqrt()],
    }
}

/// Flies from collision to collision, from face to face; the face through which the photon left.
fn fly(parameters: &Parameters, ray: &mut Ray, random: &mut SplitMix) -> Option<Side> {
    let mut flight = -libm::log(random.uniform());
    loop {
        let (side, face) = if ray.direction[2] < 0.0 {
            (Side::Reflected, 0.0)
        } else {
            (Side::Transmitted, parameters.thickness)
        };
        let to_face = ((face - ray.position[2]) / ray.direction[2]).max(0.0);
        ray.advance(flight.min(to_face));
        if flight <= to_face {
            return None;
        }
        flight -= to_face;
        ray.position[2] = face;
        if random.uniform() >= fresnel_from_inside(ray.direction[2], parameters.eta) {
            return Some(side);
        }
        ray.direction[2] = -ray.direction[2];
    }
}
