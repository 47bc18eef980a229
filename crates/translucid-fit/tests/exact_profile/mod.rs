//! The exact half space as a profile, for tests, benches and the generator.

use translucid_profile::{Configuration, Profile};
use translucid_reference::exact::HalfSpace;

/// Exact profile for a mean free path of 1, g = 0 and η = 1.
pub(crate) struct ExactHalfSpace(HalfSpace);

impl ExactHalfSpace {
    /// Solves the half space of a surface albedo in (0, 1].
    pub(crate) fn new(surface_albedo: f64, configuration: Configuration) -> Self {
        let half_space = HalfSpace::from_surface_albedo(surface_albedo, configuration.into());
        Self(half_space.expect("a surface albedo in (0, 1]"))
    }
}

impl Profile for ExactHalfSpace {
    fn eval_times_r(&self, r: f64) -> f64 {
        let r = r.max(1e-300);
        r * self.0.eval(r).value
    }

    fn enclosed(&self, r: f64) -> f64 {
        self.0.enclosed(r).value
    }

    fn beyond(&self, r: f64) -> f64 {
        self.0.beyond(r).value
    }

    fn total(&self) -> f64 {
        self.0.total().value
    }

    fn scale(&self) -> f64 {
        1.0
    }

    fn evaluations_to_build(&self) -> u32 {
        1
    }
}
