//! The way of one photon.

use std::f64::consts::TAU;

use translucid_profile::fresnel_from_inside;

use super::Interior;
use super::shape::Shape;
use super::tally::PhotonEnd;
use crate::ray::{Ray, across, dot, henyey_greenstein};
use crate::split_mix::SplitMix;

/// Follows a photon until it is out or absorbed.
pub(super) fn follow(shape: &Shape, interior: &Interior, mut ray: Ray, random: &mut SplitMix) -> PhotonEnd {
    let mut collisions = 0;
    loop {
        if let Some(part) = fly(shape, interior.eta, &mut ray, random) {
            return PhotonEnd { part: Some(part), collisions };
        }
        collisions += 1;
        if random.uniform() >= interior.single_scattering_albedo {
            return PhotonEnd { part: None, collisions };
        }
        let cosine = henyey_greenstein(interior.g, random);
        ray.direction = across(ray.direction, cosine, TAU * random.uniform());
    }
}

/// Flies to the next collision; the part of the surface through which the photon left before it.
fn fly(shape: &Shape, eta: f64, ray: &mut Ray, random: &mut SplitMix) -> Option<usize> {
    let mut flight = -libm::log(random.uniform());
    while let Some(wall) = shape.wall(ray)
        && wall.distance < flight
    {
        ray.advance(wall.distance);
        flight -= wall.distance;
        let cosine = -dot(wall.inward, ray.direction);
        if random.uniform() >= fresnel_from_inside(cosine.clamp(0.0, 1.0), eta) {
            return Some(wall.part);
        }
        ray.direction = std::array::from_fn(|i| ray.direction[i] + 2.0 * cosine * wall.inward[i]);
    }
    ray.advance(flight);
    None
}
