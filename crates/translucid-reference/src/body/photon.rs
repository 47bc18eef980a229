//! The way of one photon.

use std::f64::consts::TAU;

use translucid_profile::fresnel_from_inside;

use super::{Medium, Shape};
use crate::split_mix::SplitMix;

pub(super) type Vector = [f64; 3];

/// A point and a unit direction.
#[derive(Clone, Copy)]
pub(super) struct Ray {
    pub(super) position: Vector,
    pub(super) direction: Vector,
}

/// What became of a photon.
pub(super) struct End {
    /// The part of the surface through which it left; `None` if it was absorbed.
    pub(super) part: Option<usize>,
    /// Collisions, the one that absorbed it included.
    pub(super) collisions: u64,
}

/// Follows a photon until it is out or absorbed.
pub(super) fn follow(shape: &Shape, medium: &Medium, mut ray: Ray, random: &mut SplitMix) -> End {
    let mut collisions = 0;
    loop {
        if let Some(part) = fly(shape, medium.eta, &mut ray, random) {
            return End { part: Some(part), collisions };
        }
        collisions += 1;
        if random.uniform() >= medium.single_scattering_albedo {
            return End { part: None, collisions };
        }
        let cosine = deflection(medium.g, random);
        ray.direction = across(ray.direction, cosine, TAU * random.uniform());
    }
}

/// Flies to the next collision; the part of the surface through which the photon left before it.
fn fly(shape: &Shape, eta: f64, ray: &mut Ray, random: &mut SplitMix) -> Option<usize> {
    let mut flight = -random.uniform().ln();
    while let Some(wall) = shape.wall(ray)
        && wall.distance < flight
    {
        advance(ray, wall.distance);
        flight -= wall.distance;
        let cosine = -dot(wall.inward, ray.direction);
        if random.uniform() >= fresnel_from_inside(cosine.clamp(0.0, 1.0), eta) {
            return Some(wall.part);
        }
        ray.direction = std::array::from_fn(|i| ray.direction[i] + 2.0 * cosine * wall.inward[i]);
    }
    advance(ray, flight);
    None
}

fn advance(ray: &mut Ray, distance: f64) {
    ray.position = std::array::from_fn(|i| ray.position[i] + distance * ray.direction[i]);
}

/// The cosine of a deflection: Henyey and Greenstein's distribution, inverted.
fn deflection(g: f64, random: &mut SplitMix) -> f64 {
    let u = 2.0 * random.uniform() - 1.0;
    // Close to isotropic the inverse loses its digits to cancellation, and is u to within g
    if g.abs() < 1e-9 {
        return u;
    }
    let ratio = (1.0 - g * g) / (1.0 + g * u);
    ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
}

/// The unit vector at an angle of the given cosine from a unit axis, at an azimuth about it; at azimuth 0 it leans
/// from the axis away from +z.
pub(super) fn across(axis: Vector, cosine: f64, azimuth: f64) -> Vector {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin, cos) = azimuth.sin_cos();
    let horizontal = axis[0].hypot(axis[1]);
    let (first, second) = if horizontal > 1e-12 {
        let (x, y) = (axis[0] / horizontal, axis[1] / horizontal);
        ([x * axis[2], y * axis[2], -horizontal], [-y, x, 0.0])
    } else {
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    };
    let turned: Vector =
        std::array::from_fn(|i| cosine * axis[i] + sine * (cos * first[i] + sin * second[i]));
    let length = dot(turned, turned).sqrt();
    turned.map(|x| x / length)
}

pub(super) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
