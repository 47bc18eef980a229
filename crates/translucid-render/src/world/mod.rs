//! The scene as all paths see it, and light between two of its points.

mod block_place;
mod direct_light;
mod passage;
mod path_state;
mod pixel_sample;
mod pixel_width;
mod shadow;

use std::sync::Arc;

use translucid_scene::{Material, Scene};

use crate::light::LightSet;
use crate::ray::{Geometry, Hit, SurfacePoint};
use crate::surface::SurfaceTables;

pub(crate) use block_place::{BLOCK_SIZE, BlockPlace, COHORT_SIZE};
pub(crate) use direct_light::{power_heuristic, weighed};
pub(crate) use passage::Media;
pub(crate) use path_state::{Layer, MisOrigin, PathState};
pub use pixel_sample::{PixelSample, layer};
pub(crate) use pixel_width::PixelWidth;
pub(crate) use shadow::{ShadowMedium, absorbed, absorption_behind, straight_transmittance};

/// A scene with its hierarchy, the tables of its surfaces and its lights, shared by all threads.
pub(crate) struct World {
    pub(crate) scene: Scene,
    /// Shared with threads that look at the scene.
    pub(crate) geometry: Arc<Geometry>,
    pub(crate) surfaces: SurfaceTables,
    pub(crate) media: Media,
    pub(crate) lights: LightSet,
}

impl World {
    /// The material at a point, with its number.
    pub(crate) fn material(&self, point: &SurfacePoint) -> (usize, &Material) {
        let index = self.scene.objects[point.object as usize].material;
        (index, &self.scene.materials[index])
    }

    /// The surface at a hit.
    pub(crate) fn surface_point(&self, hit: &Hit) -> SurfacePoint {
        self.geometry.surface_point(&self.scene, hit)
    }

    /// The point of a triangle nearest to a position in its plane, by the triangle's scene-wide number.
    pub(crate) fn point_on(&self, primitive: u64, position: glam::Vec3) -> SurfacePoint {
        self.geometry.point_on(&self.scene, primitive, position)
    }
}
