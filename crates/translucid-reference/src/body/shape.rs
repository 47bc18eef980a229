//! Bodies that a ray can leave at one place only: convex ones.

use std::f64::consts::{PI, TAU};

use translucid_profile::{ParameterError, fresnel_from_outside, require};

use super::Lighting;
use super::photon::{Beyond, Wall};
use crate::ray::{Ray, Vector, across, dot};
use crate::split_mix::SplitMix;

/// Rings of equal area into which a sphere is divided, from the one that faces a distant light to the one behind.
pub const SPHERE_RINGS: usize = 10;

/// A convex body; lengths in mean free paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A sphere. Its parts are [`SPHERE_RINGS`] rings.
    Sphere {
        /// Radius, greater than 0 and finite.
        radius: f64,
    },
    /// Two parallel planes. Its parts are the face where light enters, and the other.
    Slab {
        /// Distance of the planes, greater than 0 and finite.
        thickness: f64,
    },
    /// Two half planes that meet in an infinite edge. Its parts are the face where light enters, and the other.
    Wedge {
        /// Angle between the faces, inside, in (0, π).
        angle: f64,
        /// Distance of the point where light enters from the edge, greater than 0 and finite.
        distance: f64,
    },
}

impl Shape {
    pub(super) fn check(&self) -> Result<(), ParameterError> {
        let (name, length) = match *self {
            Self::Sphere { radius } => ("radius", radius),
            Self::Slab { thickness } => ("thickness", thickness),
            Self::Wedge { angle, distance } => {
                require(angle > 0.0 && angle < PI, "angle", angle, "in (0, π)")?;
                ("distance", distance)
            }
        };
        require(length > 0.0 && length.is_finite(), name, length, "greater than 0 and finite")?;
        Ok(())
    }

    /// Returns whether light leaves after finitely many collisions on average, though none absorbs it.
    pub(super) fn is_finite(&self) -> bool {
        !matches!(self, Self::Wedge { .. })
    }

    /// Number of parts of the surface.
    pub fn parts(&self) -> usize {
        match self {
            Self::Sphere { .. } => SPHERE_RINGS,
            Self::Slab { .. } | Self::Wedge { .. } => 2,
        }
    }

    /// The surface that a ray inside meets, of a body with a relative index of refraction; `None` where it meets none.
    pub(super) fn wall(&self, eta: f64, ray: &Ray) -> Option<Wall> {
        let Ray { position, direction } = *ray;
        let (part, distance, inward) = match *self {
            Self::Sphere { radius } => {
                let along = dot(position, direction);
                let squared = along * along + radius * radius - dot(position, position);
                let distance = (squared.max(0.0).sqrt() - along).max(0.0);
                let inward: Vector =
                    std::array::from_fn(|i| -(position[i] + distance * direction[i]) / radius);
                let share = 0.5 * (1.0 + inward[2]);
                let part = ((share * SPHERE_RINGS as f64) as usize).min(SPHERE_RINGS - 1);
                (part, distance, inward)
            }
            Self::Slab { thickness } => {
                let planes = [([0.0, 0.0, 1.0], 0.0), ([0.0, 0.0, -1.0], -thickness)];
                nearest(planes, ray)?
            }
            Self::Wedge { angle, .. } => {
                let planes = [([0.0, 0.0, 1.0], 0.0), ([libm::sin(angle), 0.0, -libm::cos(angle)], 0.0)];
                nearest(planes, ray)?
            }
        };
        Some(Wall { distance, inward, eta, beyond: Beyond::Outside(part) })
    }

    /// Draws the ray along which light enters, already refracted.
    pub(super) fn start(&self, lighting: Lighting, eta: f64, random: &mut SplitMix) -> Ray {
        loop {
            let (position, inward, cosine, azimuth) = self.arrival(lighting, random);
            if random.uniform() >= fresnel_from_outside(cosine, eta) {
                return Ray::entering(position, inward, [cosine, azimuth], eta);
            }
        }
    }

    /// Place where light arrives, the inward normal there, and the direction outside about it.
    fn arrival(&self, lighting: Lighting, random: &mut SplitMix) -> (Vector, Vector, f64, f64) {
        let up = [0.0, 0.0, 1.0];
        let toward = |random: &mut SplitMix| match lighting {
            Lighting::Uniform => (random.uniform().sqrt(), TAU * random.uniform()),
            Lighting::Distant => (1.0, 0.0),
        };
        match *self {
            Self::Sphere { radius } => {
                // Lit all over, or like a disc that faces the light
                let outward_z: f64 = match lighting {
                    Lighting::Uniform => 2.0 * random.uniform() - 1.0,
                    Lighting::Distant => random.uniform().sqrt(),
                };
                let outward = across(up, outward_z, TAU * random.uniform());
                let inward = outward.map(|x| -x);
                // Parallel light goes down along z, whatever the normal: about which `across` has azimuth 0 there
                let (cosine, azimuth) = match lighting {
                    Lighting::Uniform => toward(random),
                    Lighting::Distant => (outward_z, 0.0),
                };
                (outward.map(|x| x * radius), inward, cosine, azimuth)
            }
            Self::Slab { .. } => {
                let (cosine, azimuth) = toward(random);
                ([0.0; 3], up, cosine, azimuth)
            }
            Self::Wedge { distance, .. } => {
                let (cosine, azimuth) = toward(random);
                ([distance, 0.0, 0.0], up, cosine, azimuth)
            }
        }
    }
}

/// The nearer of two planes n·x = offset, with inside where n·x is greater: its number, distance and normal.
pub(super) fn nearest(
    planes: [(Vector, f64); 2],
    Ray { position, direction }: &Ray,
) -> Option<(usize, f64, Vector)> {
    let walls = planes.iter().enumerate().filter_map(|(part, &(inward, offset))| {
        let approach = -dot(inward, *direction);
        let distance = ((dot(inward, *position) - offset) / approach).max(0.0);
        (approach > 0.0).then_some((part, distance, inward))
    });
    walls.min_by(|a, b| a.1.total_cmp(&b.1))
}
