//! The part of a scene that is edited: materials, lights, environment, paths.

use translucid_render::Edit;
use translucid_scene::{Environment, Integrator, Light, Material, Scene};

/// Everything of a scene but its geometry, its images and how it is looked at.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Look {
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
    pub(crate) environment: Option<Environment>,
    pub(crate) integrator: Integrator,
}

impl Look {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self {
            materials: scene.materials.clone(),
            lights: scene.lights.clone(),
            environment: scene.environment,
            integrator: scene.integrator,
        }
    }

    /// The edits that turn a prepared scene with this look into one with another: as many materials, and no more than what
    /// differs.
    pub(crate) fn edits_to(&self, other: &Self) -> Vec<Edit> {
        let mut edits = Vec::new();
        // First, as it prepares all materials anew
        if paths(self.integrator) != paths(other.integrator) {
            edits.push(Edit::Integrator(other.integrator));
        }
        for (index, (old, new)) in self.materials.iter().zip(&other.materials).enumerate() {
            if old != new {
                edits.push(Edit::Material(index, Box::new(new.clone())));
            }
        }
        if self.lights != other.lights {
            edits.push(Edit::Lights(other.lights.clone()));
        }
        if self.environment != other.environment {
            edits.push(Edit::Environment(other.environment));
        }
        edits
    }

    /// Whether pictures of both have other pixels, however many samples they have.
    pub(crate) fn differs(&self, other: &Self) -> bool {
        !self.edits_to(other).is_empty() || self.integrator.seed != other.integrator.seed
    }
}

/// The settings that a prepared scene depends on.
fn paths(integrator: Integrator) -> Integrator {
    Integrator { samples_per_pixel: 1, seed: 0, ..integrator }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use translucid_load::{LoadOptions, still_life};

    use super::*;

    #[test]
    fn edits_are_what_differs_and_no_more() {
        let look = Look::of(&still_life(&LoadOptions::default()).unwrap());
        let mut other = look.clone();
        assert!(look.edits_to(&other).is_empty());
        other.integrator.samples_per_pixel += 1;
        assert!(!look.differs(&other));
        other.integrator.seed = 9;
        assert!(look.differs(&other) && look.edits_to(&other).is_empty());
        other.materials[2].subsurface_radius.factor = 3.0;
        other.environment.as_mut().unwrap().radiance = Vec3::ONE;
        let edits = look.edits_to(&other);
        assert!(matches!(&edits[..], [Edit::Material(2, _), Edit::Environment(Some(_))]), "{edits:?}");
    }
}
