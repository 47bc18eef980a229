//! Photons in a body with a shape of its own: how much light thin and curved things return.
//!
//! A reflectance profile is that of a half space. What it gets wrong on a [`Shape`] only a walk in that shape can
//! tell; this one is slow and obvious, analog, photon by photon in double precision, and shares nothing with the
//! models or the renderer that it judges.
//!
//! ```text
//! enter the body, refracted by its boundary
//! loop
//!   fly to the surface or the next collision, whichever is nearer
//!   at the surface: leave, or be reflected back by Fresnel's formula
//!   at a collision: be absorbed with probability 1 − α, else turn by the phase function
//! ```
//!
//! # What is counted
//! Light that leaves, by part of the surface, and apart from each other light that has been *scattered* and light that
//! passed *straight* through without a collision: a profile knows only the first.
//!
//! # What uniform light says of one point
//! Under the same radiance from everywhere the radiosity at a point, per unit of flux that enters per area, is the
//! share of light entering *there* that leaves anywhere: paths of light can be reversed. So a
//! [`Light::Uniform`] that enters at one point of a slab or wedge tells how bright that point is in even light.
//!
//! ```
//! use translucid_reference::body::{Body, Light, Medium, Shape};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! let medium = Medium { single_scattering_albedo: 0.9, g: 0.0, eta: 1.0 };
//! let sphere = Body::new(Shape::Sphere { radius: 1.0 }, medium, Light::Uniform)?;
//! let tally = sphere.walk(20_000, 1);
//! // Straight through a sphere of diameter 2 goes (1 − (1 + 2) e⁻²)/2 of uniform light
//! let straight = tally.straight();
//! assert!((straight.value - 0.297).abs() < 5.0 * straight.error);
//! # Ok(())
//! # }
//! ```

mod photon;
mod shape;
mod tally;
mod two_halves;

use rayon::prelude::*;
use translucid_profile::ParameterError;

pub use shape::{SPHERE_RINGS, Shape};
pub use tally::Tally;
pub use two_halves::{Half, TwoHalves};

use crate::split_mix::SplitMix;
use photon::{End, follow};

/// Photons that one thread follows in a row.
const CHUNK: u64 = 4096;

/// What a body is made of; lengths are its mean free paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Medium {
    /// Single-scattering albedo α in [0, 1]; below 1 in a wedge, which light would leave after infinitely many
    /// collisions on average.
    pub single_scattering_albedo: f64,
    /// Mean cosine of the phase function in (−1, 1): L. G. Henyey and J. L. Greenstein 1941.
    pub g: f64,
    /// Relative index of refraction n_inside/n_outside in [0.1, 10].
    pub eta: f64,
}

/// How light arrives. What the boundary reflects from outside is left out: a photon is one that has entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Light {
    /// The same radiance from everywhere, all over a sphere; at one point of a slab's first face or of a wedge's.
    Uniform,
    /// Parallel light: on a whole sphere from the direction of its first ring; perpendicular to the first face of a
    /// slab or wedge at one point.
    Distant,
}

/// Shape, medium and light of a walk, known to be valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    shape: Shape,
    medium: Medium,
    light: Light,
}

impl Body {
    /// Checks the parameters.
    ///
    /// # Errors
    /// A parameter is outside the range that [`Shape`] or [`Medium`] states.
    pub fn new(shape: Shape, medium: Medium, light: Light) -> Result<Self, ParameterError> {
        shape.check()?;
        let Medium { single_scattering_albedo: alpha, g, eta } = medium;
        let is_allowed = |holds: bool, name, value, allowed| {
            if holds { Ok(()) } else { Err(ParameterError::new(name, value, allowed)) }
        };
        is_allowed((0.0..=1.0).contains(&alpha), "single_scattering_albedo", alpha, "in [0, 1]")?;
        let ends = alpha < 1.0 || shape.is_finite();
        is_allowed(ends, "single_scattering_albedo", alpha, "below 1 in a wedge")?;
        is_allowed(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        is_allowed((0.1..=10.0).contains(&eta), "eta", eta, "in [0.1, 10]")?;
        Ok(Self { shape, medium, light })
    }

    /// Follows photons on all threads. The counts are a function of seed and number of photons alone.
    pub fn walk(&self, photons: u64, seed: u64) -> Tally {
        let chunk = |number: u64| {
            let first = number * CHUNK;
            let mut tally = Tally::new(self.shape.parts());
            for index in first..(first + CHUNK).min(photons) {
                tally.count(&self.photon(&mut SplitMix::of_photon(seed, index)));
            }
            tally
        };
        let empty = || Tally::new(self.shape.parts());
        (0..photons.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(empty, |all, part| all.merged(&part))
    }

    fn photon(&self, random: &mut SplitMix) -> End {
        let entry = self.shape.entry(self.light, self.medium.eta, random);
        follow(&self.shape, &self.medium, entry, random)
    }
}

#[cfg(test)]
mod laws;
