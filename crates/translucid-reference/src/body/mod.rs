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
//! # Counts
//! Light that leaves, by part of the surface, and apart from each other light that has been *scattered* and light that
//! passed *straight* through without a collision: a profile knows only the first.
//!
//! # Uniform light and one point
//! Under the same radiance from everywhere the radiosity at a point, per unit of flux that enters per area, is the
//! share of light entering *there* that leaves anywhere: paths of light can be reversed. So a
//! [`Lighting::Uniform`] that enters at one point of a slab or wedge tells how bright that point is in even light.
//!
//! ```
//! use translucid_reference::body::{Body, Interior, Lighting, Shape};
//!
//! # fn main() -> Result<(), translucid_profile::ParameterError> {
//! let interior = Interior { single_scattering_albedo: 0.9, g: 0.0, eta: 1.0 };
//! let sphere = Body::new(Shape::Sphere { radius: 1.0 }, interior, Lighting::Uniform)?;
//! let tally = sphere.walk(20_000, 1);
//! // Straight through a sphere of diameter 2 goes (1 − (1 + 2) e⁻²)/2 of uniform light
//! let straight = tally.straight();
//! assert!((straight.value - 0.297).abs() < 5.0 * straight.error);
//! # Ok(())
//! # }
//! ```

#[cfg(test)]
pub(crate) mod layered;
pub(crate) mod photon;
mod shape;
mod tally;
mod two_halves;

use std::f64::consts::TAU;

use translucid_profile::{ParameterError, require};

pub use shape::{SPHERE_RINGS, Shape};
pub use tally::Tally;
pub use two_halves::{Half, TwoHalves};

use crate::ray::{Ray, Vector, across, henyey_greenstein};
use crate::split_mix::SplitMix;
use photon::{PhotonEnd, Space, Wall, follow};

/// Substance of a body, whose mean free path is the unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interior {
    /// Single-scattering albedo α in [0, 1]; below 1 in a wedge, which light would leave after infinitely many
    /// collisions on average.
    pub single_scattering_albedo: f64,
    /// Mean cosine of the phase function in (−1, 1): L. G. Henyey and J. L. Greenstein 1941.
    pub g: f64,
    /// Relative index of refraction n_inside/n_outside in [0.1, 10].
    pub eta: f64,
}

/// Way in which light arrives. The part that the boundary reflects from outside is left out: a photon is one that has
/// entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// Equal radiance from everywhere, all over a sphere; at one point of a slab's first face or of a wedge's.
    Uniform,
    /// Parallel light: on a whole sphere from the direction of its first ring; perpendicular to the first face of a
    /// slab or wedge at one point.
    Distant,
}

/// Shape, substance and light of a walk, known to be valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    shape: Shape,
    interior: Interior,
    lighting: Lighting,
}

impl Body {
    /// Checks the parameters.
    ///
    /// # Errors
    /// A parameter is outside the range that [`Shape`] or [`Interior`] states.
    pub fn new(shape: Shape, interior: Interior, lighting: Lighting) -> Result<Self, ParameterError> {
        shape.check()?;
        let Interior { single_scattering_albedo: alpha, g, eta } = interior;
        require((0.0..=1.0).contains(&alpha), "single_scattering_albedo", alpha, "in [0, 1]")?;
        let ends = alpha < 1.0 || shape.is_finite();
        require(ends, "single_scattering_albedo", alpha, "below 1 in a wedge")?;
        require(g > -1.0 && g < 1.0, "g", g, "in (-1, 1)")?;
        require((0.1..=10.0).contains(&eta), "eta", eta, "in [0.1, 10]")?;
        Ok(Self { shape, interior, lighting })
    }

    /// Follows photons on all threads. The counts are a function of seed and number of photons alone.
    pub fn walk(&self, photons: u64, seed: u64) -> Tally {
        Tally::of_photons(self.shape.parts(), photons, seed, |random| self.photon(random))
    }

    fn photon(&self, random: &mut SplitMix) -> PhotonEnd {
        let start = self.shape.start(self.lighting, self.interior.eta, random);
        follow(self, 0, start, random)
    }
}

/// One region, whose mean free path is the unit of length.
impl Space for Body {
    fn single_scattering_albedo(&self, _: usize) -> f64 {
        self.interior.single_scattering_albedo
    }

    fn scatter(&self, _: usize, direction: Vector, random: &mut SplitMix) -> Vector {
        let cosine = henyey_greenstein(self.interior.g, random);
        across(direction, cosine, TAU * random.uniform())
    }

    fn wall(&self, _: usize, ray: &Ray) -> Option<Wall> {
        self.shape.wall(self.interior.eta, ray)
    }
}

#[cfg(test)]
mod laws;
