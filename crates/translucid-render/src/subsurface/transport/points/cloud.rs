//! The cloud that both passes make: points with the light that enters there.

use std::sync::atomic::AtomicBool;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use translucid_scene::SceneError;

use super::super::{SubsurfaceTransport, Tracing};
use super::gather::{Gatherer, GroupOfPoints};
use super::hierarchy;
use super::irradiance::irradiance;
use super::plan::Plan;
use super::surfels::{Surfel, Unfinished, cover};
use crate::world::World;

/// Points over all surfaces that light travels under, with their transmitted irradiance.
///
/// It belongs to a scene but for its camera, film and samples per pixel: other views of the scene can use it.
#[derive(Clone, Debug, PartialEq)]
pub struct PointCloud {
    /// Fingerprint of all that decides the points and their light.
    pub(super) fingerprint: u64,
    pub(super) groups: Vec<CloudGroup>,
    /// Group by group, in the order of the hierarchy.
    pub(super) surfels: Vec<Surfel>,
    /// Transmitted irradiance of each.
    pub(super) irradiance: Vec<Vec3>,
}

/// The points of a subsurface group.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct CloudGroup {
    pub(super) number: u32,
    pub(super) count: u32,
    /// Root of the area that a point stands for \[L\].
    pub(super) spacing: f64,
}

/// The two passes that make points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointPass {
    /// Points are laid over the surfaces.
    Points,
    /// Light that enters at them is computed.
    Irradiance,
}

/// How far the making of points is.
#[derive(Clone, Copy, Debug)]
pub struct PointProgress {
    /// Which pass.
    pub pass: PointPass,
    /// Points or paths done.
    pub done: u64,
    /// About how many there are in all.
    pub total: u64,
}

/// How points are made.
#[derive(Clone, Copy)]
pub(crate) struct Making<'a> {
    /// Fingerprint of all that decides the points and their light.
    pub(crate) fingerprint: u64,
    /// Most bytes that they may take.
    pub(crate) memory: u64,
    pub(crate) progress: &'a (dyn Fn(PointProgress) + Sync),
    pub(crate) stop: &'a AtomicBool,
}

/// Most triangles of a scene with points, those of shared meshes counted for each object: all of them are looked at.
const MOST_TRIANGLES: u64 = 1 << 28;

/// Most objects of a scene with points.
const MOST_OBJECTS: usize = 1 << 16;

/// Refuses scenes in which too much would have to be looked at.
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

impl PointCloud {
    /// Number of points.
    pub fn len(&self) -> usize {
        self.surfels.len()
    }

    /// Whether no surface needs points.
    pub fn is_empty(&self) -> bool {
        self.surfels.is_empty()
    }

    /// Makes the points of a scene, lit by paths of tracers; `None` when stopped.
    pub(crate) fn new<'a, T: Tracing<'a>>(
        world: &World,
        transports: &[SubsurfaceTransport],
        tracer: impl Fn() -> T + Sync,
        making: &Making<'_>,
    ) -> Result<Option<Self>, SceneError> {
        let Some(mut cloud) = Self::without_light(world, transports, making)? else {
            return Ok(None);
        };
        let Making { progress, stop, .. } = *making;
        let counts: Vec<usize> = cloud.groups.iter().map(|group| group.count as usize).collect();
        let report = |done, total| progress(PointProgress { pass: PointPass::Irradiance, done, total });
        let Some(light) = irradiance(world, tracer, &counts, &cloud.surfels, &report, stop) else {
            return Ok(None);
        };
        cloud.irradiance = light;
        Ok(Some(cloud))
    }

    /// Pass 1 alone: as if light of 1 entered everywhere.
    pub(crate) fn without_light(
        world: &World,
        transports: &[SubsurfaceTransport],
        making: &Making<'_>,
    ) -> Result<Option<Self>, SceneError> {
        let Making { fingerprint, memory, progress, stop } = *making;
        let scene = &world.scene;
        require_few(world.geometry.triangles(), scene.objects.len())?;
        let plan = Plan::new(world, transports);
        plan.require_memory(scene, memory)?;
        let mut cloud = Self { fingerprint, groups: Vec::new(), surfels: Vec::new(), irradiance: Vec::new() };
        for group in &plan.groups {
            let most = Plan::most_points(memory) - cloud.surfels.len();
            let report = |part: f64| {
                let done = (cloud.surfels.len() as f64 + part * group.points()) as u64;
                let total = plan.points() as u64;
                progress(PointProgress { pass: PointPass::Points, done: done.min(total), total });
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
            let (number, count, spacing) = (group.group, surfels.len() as u32, group.spacing);
            cloud.groups.push(CloudGroup { number, count, spacing });
            cloud.surfels.append(&mut surfels);
        }
        Ok(Some(cloud))
    }

    /// The points made ready for sums.
    pub(crate) fn gatherer(&self, world: &World, transports: &[SubsurfaceTransport]) -> Gatherer {
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
