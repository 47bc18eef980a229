//! The automatic camera, lights and environment of a scene, which the loader makes anew for a bare mesh that is turned.

use glam::Vec3;
use translucid_load::Orientation;
use translucid_scene::{Camera, Environment, Light, Scene};

use crate::look::Look;

/// The camera, lights and environment of a scene as it was loaded.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    /// How the bare mesh is turned; none of another scene.
    pub(crate) orientation: Option<Orientation>,
    pub(crate) camera: Camera,
    /// Center and radius of what the scene is about.
    pub(crate) bounds: (Vec3, f32),
    /// Number of materials, which stays.
    pub(crate) materials: usize,
    lights: Vec<Light>,
    environment: Option<Environment>,
}

impl Base {
    pub(crate) fn of(scene: &Scene, orientation: Option<Orientation>) -> Self {
        Self {
            orientation,
            camera: scene.camera,
            bounds: bounds(scene),
            materials: scene.materials.len(),
            lights: scene.lights.clone(),
            environment: scene.environment,
        }
    }

    /// A look with what is automatic in it as another base has it: what a person has changed stays.
    pub(crate) fn follow(&self, other: &Self, look: &mut Look) {
        if look.lights == self.lights {
            look.lights.clone_from(&other.lights);
        }
        if look.environment == self.environment {
            look.environment = other.environment;
        }
    }
}

/// A sphere around everything that is translucent or, where nothing is, around everything.
fn bounds(scene: &Scene) -> (Vec3, f32) {
    let about = |is_in: &dyn Fn(usize) -> bool| {
        let objects = scene.objects.iter().filter(|object| is_in(object.material));
        objects.map(|object| object.bounds()).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    };
    let (low, high) = about(&|material| scene.materials[material].has_subsurface())
        .or_else(|| about(&|_| true))
        .unwrap_or_default();
    (0.5 * (low + high), 0.5 * (high - low).length())
}
