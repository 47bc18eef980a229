//! The point cloud: points on the surface, with the light that enters there.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
use translucid_scene::SceneError;

use super::super::{SubsurfaceTransport, Tracer};
use super::gather::{Gatherer, GroupOfPoints};
use super::hierarchy;
use super::irradiance::irradiance;
use super::plan::{GroupPlan, PixelWidths, PointPlan};
use super::surfels::{Surfel, Unfinished, cover};
use crate::world::World;

/// Points over all surfaces that light travels under, with their transmitted irradiance.
///
/// It belongs to a scene but for its camera, film and samples per pixel: other views of the scene can use it.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCloud {
    pub(super) groups: Vec<CloudGroup>,
    /// Group by group, in the order of the hierarchy.
    pub(super) surfels: Vec<Surfel>,
    /// Transmitted irradiance ∫ L T(ω) cosθ / (π T̄) dω of each point; empty until it is computed.
    irradiance: Vec<Vec3>,
}

/// The points of a subsurface group.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CloudGroup {
    pub(super) number: u32,
    pub(super) count: u32,
    /// Root of the area that a point stands for \[L\].
    pub(super) spacing: f64,
    /// Width of pixels that points so far apart are made for \[L\]; 0 where they serve any.
    pub(super) pixel_width: f64,
}

/// The two passes that make points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointPass {
    /// Points are laid over the surfaces.
    Points,
    /// Light that enters at them is computed.
    Irradiance,
}

/// Progress of making points.
#[derive(Clone, Copy, Debug)]
pub struct PointProgress {
    /// Which pass.
    pub pass: PointPass,
    /// Part that is done, in [0, 1]; it never falls.
    pub part: f64,
    /// About how many points or paths there are in all.
    pub total: u64,
}

/// Settings for making points.
#[derive(Clone, Copy)]
pub(crate) struct PointSettings<'a> {
    /// Most bytes that they may take.
    pub(crate) memory: u64,
    pub(crate) progress: &'a (dyn Fn(PointProgress) + Sync),
    pub(crate) stop: &'a AtomicBool,
}

/// Most triangles of a scene with points, those of shared meshes counted for each object: making points visits all of them.
const MOST_TRIANGLES: u64 = 1 << 28;

/// How much finer pixels may be than those that points are made for: a camera that moves a little keeps its points.
const PIXEL_SLACK: f64 = 1.25;

/// Most objects of a scene with points.
const MOST_OBJECTS: usize = 1 << 16;

/// Refuses scenes with too many triangles or objects.
fn require_few(triangles: u64, objects: usize) -> Result<(), SceneError> {
    if triangles <= MOST_TRIANGLES && objects <= MOST_OBJECTS {
        return Ok(());
    }
    let message = format!(
        "points are laid over every object, of which there are {objects} with {triangles} triangles, but at most \
         {MOST_OBJECTS} with {MOST_TRIANGLES} are allowed"
    );
    Err(SceneError::new(message).with_help("render with subsurface_method = \"ray-traced\""))
}

/// Returns `true` if points lie close enough for pixels of these widths: much finer pixels would show their spacing.
pub(crate) fn serve(groups: &[CloudGroup], pixels: &PixelWidths) -> bool {
    groups.iter().all(|group| group.pixel_width <= pixels.on(group.number) * PIXEL_SLACK)
}

impl PointCloud {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.surfels.len()
    }

    /// Returns `true` if no surface needs points.
    pub fn is_empty(&self) -> bool {
        self.surfels.is_empty()
    }

    /// The groups that it covers.
    pub(crate) fn groups(&self) -> &[CloudGroup] {
        &self.groups
    }

    /// Computes the light of the points, along paths of the tracers; `None` when stopped.
    pub(crate) fn lit<'a, T: Tracer<'a>>(
        self,
        world: &World,
        tracer: impl Fn() -> T + Sync,
        progress: &(dyn Fn(PointProgress) + Sync),
        stop: &AtomicBool,
    ) -> Option<Self> {
        let counts: Vec<usize> = self.groups.iter().map(|group| group.count as usize).collect();
        let report = |part, total| progress(PointProgress { pass: PointPass::Irradiance, part, total });
        let irradiance = irradiance(world, tracer, &counts, &self.surfels, &report, stop)?;
        Some(Self { irradiance, ..self })
    }

    /// Lays points over the surfaces of a scene; until they are [lit](Self::lit), irradiance 1 enters everywhere. `None` when
    /// stopped.
    pub(crate) fn laid(
        world: &World,
        plan: &PointPlan,
        making: &PointSettings<'_>,
    ) -> Result<Option<Self>, SceneError> {
        let PointSettings { memory, progress, stop } = *making;
        let scene = &world.scene;
        require_few(world.geometry.triangles(), scene.objects.len())?;
        plan.require_memory(scene, memory)?;
        let mut cloud = Self { groups: Vec::new(), surfels: Vec::new(), irradiance: Vec::new() };
        for group in &plan.groups {
            let most = PointPlan::most_points(memory) - cloud.surfels.len();
            let report = |part: f64| {
                let part = (cloud.surfels.len() as f64 + part * group.points()) / plan.points();
                let total = plan.points() as u64;
                progress(PointProgress { pass: PointPass::Points, part: part.min(1.0), total });
            };
            let mut surfels = match cover(scene, &world.geometry, group, most, &report, stop) {
                Ok(surfels) => surfels,
                Err(Unfinished::Stopped) => return Ok(None),
                Err(Unfinished::TooMany) => {
                    let points = plan.points().max(2.0 * (cloud.surfels.len() + most) as f64);
                    return Err(plan.too_many(scene, points, memory));
                }
            };
            hierarchy::order(&mut surfels);
            let GroupPlan { group: number, spacing, pixel_width, .. } = *group;
            cloud.groups.push(CloudGroup { number, count: surfels.len() as u32, spacing, pixel_width });
            cloud.surfels.append(&mut surfels);
        }
        Ok(Some(cloud))
    }

    /// The points made ready for sums.
    pub(crate) fn gatherer(&self, world: &World, transports: &[Arc<SubsurfaceTransport>]) -> Gatherer {
        let mut rest = &self.surfels[..];
        let group = |group: &CloudGroup| {
            let (surfels, others) = rest.split_at(group.count as usize);
            rest = others;
            GroupOfPoints { number: group.number, spacing: group.spacing, surfels }
        };
        let groups: Vec<GroupOfPoints<'_>> = self.groups.iter().map(group).collect();
        Gatherer::new(&world.scene, transports, &groups, &self.irradiance)
    }
}
