//! Vectors, rays and deflections of the slow and obvious walks, in double precision.

use crate::split_mix::SplitMix;

pub(crate) type Vector = [f64; 3];

/// A point and a unit direction.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) position: Vector,
    pub(crate) direction: Vector,
}

impl Ray {
    /// Light that enters a medium of a relative index of refraction, from a cosine and azimuth about the inward normal.
    pub(crate) fn entering(position: Vector, inward: Vector, [cosine, azimuth]: [f64; 2], eta: f64) -> Self {
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt() / eta;
        Self { position, direction: across(inward, (1.0 - sine * sine).max(0.0).sqrt(), azimuth) }
    }

    /// Moves the point along the direction.
    pub(crate) fn advance(&mut self, distance: f64) {
        self.position = std::array::from_fn(|i| self.position[i] + distance * self.direction[i]);
    }
}

/// The unit vector at an angle of the given cosine from a unit axis, at an azimuth about it; at azimuth 0 it leans
/// from the axis away from +z.
pub(crate) fn across(axis: Vector, cosine: f64, azimuth: f64) -> Vector {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(azimuth);
    let horizontal = libm::hypot(axis[0], axis[1]);
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

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Draws the cosine of a deflection: Henyey and Greenstein's distribution, inverted.
pub(crate) fn henyey_greenstein(g: f64, random: &mut SplitMix) -> f64 {
    let u = 2.0 * random.uniform() - 1.0;
    // Close to isotropic the inverse loses its digits to cancellation, and is u to within g
    if g.abs() < 1e-9 {
        return u;
    }
    let ratio = (1.0 - g * g) / (1.0 + g * u);
    ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
}
