//! Normalization of profiles by the shape of the body.
//!
//! ```text
//! N(x) = ∫ R(|x − x'|) dA' / A          over all surfaces of the group around x
//! ```
//!
//! is 1 on a plane, less on a sphere, more on a slab. Light that leaves at x, divided by N(x), is A under even light.
//! N is a sum over points in blue noise, those of the point-based method without their light.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::{Material, SceneError, SubsurfaceNormalization};

use super::shape_factor::shape_factor;
use super::transport::SubsurfaceTransport;
use super::transport::points::{
    GatherPoint, GatherScratch, Gatherer, PixelWidths, PointCloud, PointPlan, PointSettings,
};
use crate::world::World;

/// Most memory for points, in bytes, whatever the scene allows: half a million.
///
/// A body that needs more is hundreds of profile widths across, and N is 1 except where it is thinnest.
const MOST_MEMORY: u64 = 128 << 20;

/// The points by which a scene's materials are normalized.
pub(crate) struct Normalizer {
    points: Gatherer,
}

impl Normalizer {
    /// `None` where no material asks for it.
    ///
    /// # Errors
    /// The points would take more than [`MOST_MEMORY`], or than the scene allows for points.
    pub(crate) fn new(
        world: &World,
        transports: &[Arc<SubsurfaceTransport>],
    ) -> Result<Option<Self>, SceneError> {
        let is_asked_for = |material: &Material| {
            material.subsurface_normalization == SubsurfaceNormalization::Energy && material.has_subsurface()
        };
        if !world.scene.materials.iter().any(is_asked_for) {
            return Ok(None);
        }
        let memory = (u64::from(world.scene.integrator.point_memory) << 20).min(MOST_MEMORY);
        let never = AtomicBool::new(false);
        let making = PointSettings { memory, progress: &|_| {}, stop: &never };
        // The factors serve every view
        let plan = PointPlan::new(world, transports, &PixelWidths::default());
        let cloud = PointCloud::laid(world, &plan, &making)?;
        Ok(cloud.map(|cloud| Self { points: cloud.gatherer(world, transports) }))
    }

    /// The points, for a device.
    pub(crate) fn gatherer(&self) -> &Gatherer {
        &self.points
    }

    /// Factor on the light that leaves at a point of a material.
    pub(crate) fn factor(
        &self,
        material: &Material,
        exit: &GatherPoint,
        scratch: &mut GatherScratch,
    ) -> Vec3 {
        if material.subsurface_normalization == SubsurfaceNormalization::None {
            return Vec3::ONE;
        }
        let gathered = self.points.gather(exit, scratch);
        gathered.map_or(Vec3::ONE, |gathered| shape_factor(material, gathered.energy))
    }
}
