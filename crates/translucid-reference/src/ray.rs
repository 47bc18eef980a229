//! Vectors, rays and deflections of the slow and obvious walks, in double precision.

use crate::phase_function::PhaseFunction;
use crate::split_mix::SplitMix;

pub(crate) type Vector = [f64; 3];

/// A point and a unit direction.
#[derive(Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) position: Vector,
    pub(crate) direction: Vector,
}

impl Ray {
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

/// Draws the cosine of a deflection; where no formula does, from under the greatest value of p that even steps find, with
/// some to spare.
pub(crate) fn deflection(phase_function: &PhaseFunction, random: &mut SplitMix) -> f64 {
    match phase_function {
        PhaseFunction::HenyeyGreenstein { g } => henyey_greenstein(*g, random),
        PhaseFunction::Rayleigh => rejected(1.0, random, |cosine| 0.5 * (1.0 + cosine * cosine)),
        PhaseFunction::TwoTerm { weight, g1, g2 } => {
            let g = if random.uniform() < *weight { *g1 } else { *g2 };
            henyey_greenstein(g, random)
        }
        other => {
            let most = (0..=64).map(|i| other.eval(f64::from(i) / 32.0 - 1.0)).fold(0.0, f64::max);
            rejected(1.5 * most, random, |cosine| other.eval(cosine))
        }
    }
}

fn rejected(most: f64, random: &mut SplitMix, density: impl Fn(f64) -> f64) -> f64 {
    loop {
        let cosine = 2.0 * random.uniform() - 1.0;
        if most * random.uniform() < density(cosine) {
            return cosine;
        }
    }
}
