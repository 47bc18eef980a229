//! The spacing of the points, and the memory that they take.

use std::sync::Arc;

use translucid_scene::{Scene, SceneError};

use super::super::SubsurfaceTransport;
use super::patches::Patch;
use crate::ray::SurfacePoint;
use crate::surface;
use crate::world::World;

/// Spacing of the points for a tolerance of 1, over the radius within which half of the narrowest channel's light
/// leaves. It goes with the root of the tolerance, as errors of smooth sums go with the square of the spacing.
const SPACING: f64 = 1.0;
/// Least number of points of a group for a tolerance of 1, in inverse proportion to it: where light travels farther
/// than the body is large, points have to resolve its lit and its shaded side.
const LEAST_POINTS: f64 = 50.0;
/// Greatest spacing that pixels allow, over the width of one, for a tolerance of [`USUAL_TOLERANCE`] or more: light is then
/// blurred by about as much as the film's filter does. It goes with the root of lesser tolerances.
const PIXEL_SPACING: f64 = 0.5;
const USUAL_TOLERANCE: f64 = 0.05;
/// Samples of the light that each half of a point has at least.
pub(super) const LEAST_SAMPLES: u32 = 8;
/// Places of an object at which its profile's width is looked up.
const PLACES: usize = 4096;
/// Memory for each point while they are made, which is when most is needed: candidates, grid, sums, hierarchy.
const BYTES_PER_POINT: f64 = 256.0;

/// The points that a scene needs, and an estimate of their cost.
pub struct PointPlan {
    pub(super) groups: Vec<GroupPlan>,
}

/// The points of the objects that share light under their surfaces.
pub(super) struct GroupPlan {
    pub(super) group: u32,
    /// Numbers of the objects. All of a group take part: light may enter one that has another material.
    pub(super) objects: Vec<usize>,
    /// Root of the area that a point shall stand for \[L\].
    pub(super) spacing: f64,
    /// Width of a pixel there \[L\], if points lie farther apart for it than the profile asks for; else 0.
    pub(super) pixel_width: f64,
    /// Area of all objects \[L²\].
    pub(super) area: f64,
    narrowest: Narrowest,
}

/// The place where light travels least far.
#[derive(Clone, Copy, Debug)]
struct Narrowest {
    object: usize,
    /// Radius within which half of the light leaves, more where it is dark \[L\].
    width: f64,
    /// Length that the material states there \[L\].
    length: f64,
}

/// Widths of pixels on the surfaces that a picture shows, for each subsurface group.
///
/// Points need not lie much closer than that: between them light comes from the neighborhood's mean, see `gather.rs`.
#[derive(Clone, Debug, Default)]
pub(crate) struct PixelWidths {
    /// Least width of a pixel on the group \[L\], sorted by group.
    least: Vec<(u32, f64)>,
}

impl PixelWidths {
    /// Widths on surfaces of groups, as many of each as have been looked at.
    pub(crate) fn new(mut seen: Vec<(u32, f64)>) -> Self {
        seen.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        seen.dedup_by_key(|(group, _)| *group);
        Self { least: seen }
    }

    /// The least width on a group. A group that is not seen has the least width of all; 0 where nothing is seen.
    pub(super) fn on(&self, group: u32) -> f64 {
        let own = self.least.binary_search_by_key(&group, |(group, _)| *group);
        let all = || self.least.iter().map(|(_, width)| *width).reduce(f64::min).unwrap_or(0.0);
        own.map_or_else(|_| all(), |index| self.least[index].1)
    }
}

impl PointPlan {
    /// Plans points for every object whose material has a profile.
    pub(crate) fn new(world: &World, transports: &[Arc<SubsurfaceTransport>], pixels: &PixelWidths) -> Self {
        let scene = &world.scene;
        let mut groups: Vec<GroupPlan> = Vec::new();
        for index in 0..scene.objects.len() {
            let Some(narrowest) = narrowest(world, transports, index) else { continue };
            let group = scene.objects[index].subsurface_group;
            match groups.iter_mut().find(|known| known.group == group) {
                Some(known) if known.narrowest.width <= narrowest.width => {}
                Some(known) => known.narrowest = narrowest,
                None => groups.push(GroupPlan::new(scene, group, narrowest)),
            }
        }
        let tolerance = f64::from(scene.integrator.point_tolerance);
        for group in &mut groups {
            let asked_for = group.narrowest.width * SPACING * tolerance.sqrt();
            let pixel_width = pixels.on(group.group);
            let enough = pixel_width * PIXEL_SPACING * (tolerance / USUAL_TOLERANCE).sqrt().min(1.0);
            let widest = (group.area * tolerance / LEAST_POINTS).sqrt();
            group.spacing = asked_for.max(enough).min(widest);
            group.pixel_width = if group.spacing > asked_for { pixel_width } else { 0.0 };
        }
        groups.retain(|group| group.spacing > 0.0 && group.spacing.is_finite());
        Self { groups }
    }

    /// About how many points there will be.
    pub fn points(&self) -> f64 {
        self.groups.iter().map(GroupPlan::points).sum()
    }

    /// Refuses points that do not fit into so many bytes.
    pub(super) fn require_memory(&self, scene: &Scene, limit: u64) -> Result<(), SceneError> {
        let bytes = self.points() * BYTES_PER_POINT;
        if bytes <= limit as f64 && self.points() < f64::from(u32::MAX / 4) {
            return Ok(());
        }
        Err(self.too_many(scene, self.points(), limit))
    }

    /// Most points that so many bytes hold.
    pub(super) fn most_points(limit: u64) -> usize {
        (limit as f64 / BYTES_PER_POINT).min(f64::from(u32::MAX / 4)) as usize
    }

    /// The error for this many points.
    pub(super) fn too_many(&self, scene: &Scene, points: f64, limit: u64) -> SceneError {
        let most = |a: &&GroupPlan, b: &&GroupPlan| a.points().total_cmp(&b.points());
        let Some(worst) = self.groups.iter().max_by(most) else {
            return SceneError::new("there are too many points");
        };
        let object = &scene.objects[worst.narrowest.object];
        let material = &scene.materials[object.material];
        let mebibytes = |bytes: f64| significant(bytes / f64::from(1 << 20));
        let unit = scene.unit.name();
        let message = format!(
            "points need {} MiB of memory, but may take {} MiB: material {} of object {} has a mean free path of {} {unit}, for which {} points would lie {} {unit} apart on {} {unit}²",
            mebibytes(points * BYTES_PER_POINT),
            mebibytes(limit as f64),
            material.name,
            object.name,
            significant(worst.narrowest.length),
            significant(points),
            significant(worst.spacing),
            significant(worst.area),
        );
        let tolerance =
            f64::from(scene.integrator.point_tolerance) * points * BYTES_PER_POINT / limit as f64 * 1.05;
        let coarser = if tolerance <= 1.0 {
            format!("choose a point_tolerance of {} or more, ", significant(tolerance))
        } else {
            String::new()
        };
        let help = format!(
            "{coarser}raise point_memory if the machine has more, make subsurface_radius larger, or render with subsurface_method = \"ray-traced\""
        );
        SceneError::new(message).with_help(help)
    }
}

impl GroupPlan {
    fn new(scene: &Scene, group: u32, narrowest: Narrowest) -> Self {
        let is_in = |&index: &usize| scene.objects[index].subsurface_group == group;
        let objects: Vec<usize> = (0..scene.objects.len()).filter(is_in).collect();
        let area = objects.iter().map(|&index| area(scene, index)).sum();
        Self { group, objects, spacing: narrowest.width, pixel_width: 0.0, area, narrowest }
    }

    /// About how many points there will be.
    pub(super) fn points(&self) -> f64 {
        self.area / (self.spacing * self.spacing)
    }
}

/// Area of an object's mesh \[L²\].
fn area(scene: &Scene, index: usize) -> f64 {
    let object = &scene.objects[index];
    (0..object.mesh.triangles.len()).map(|triangle| Patch::of_triangle(object, triangle).area()).sum()
}

/// The narrowest profile at some thousand places of an object, evenly by area; `None` where no light travels.
///
/// A dark channel or place may be less exact than a bright one. Errors go with the square of the spacing over the
/// width, so widths count times the root of the greatest albedo over their own.
fn narrowest(world: &World, transports: &[Arc<SubsurfaceTransport>], index: usize) -> Option<Narrowest> {
    let scene = &world.scene;
    let number = scene.objects[index].material;
    let (material, transport) = (&scene.materials[number], &transports[number]);
    let kernel = &transport.probes()?.kernel;
    let mut brightest = 0.0_f32;
    let mut found: Option<Narrowest> = None;
    for_each_place(world, index, |point| {
        let subsurface = transport.at(scene, material, &point);
        let stated = surface::stated_length_at(scene, material, &point);
        for channel in 0..3 {
            let (albedo, length) = (subsurface.surface_albedo[channel], subsurface.length[channel]);
            if length <= 0.0 || albedo <= 0.0 {
                continue;
            }
            brightest = brightest.max(albedo);
            let width = f64::from(kernel.half_radius(albedo, length)) / f64::from(albedo).sqrt();
            if width > 0.0 && found.is_none_or(|known| width < known.width) {
                found = Some(Narrowest { object: index, width, length: f64::from(stated[channel]) });
            }
        }
    });
    found.map(|found| Narrowest { width: found.width * f64::from(brightest).sqrt(), ..found })
}

/// Calls `found` for some thousand points of an object, evenly by area.
fn for_each_place(world: &World, index: usize, mut found: impl FnMut(SurfacePoint)) {
    let scene = &world.scene;
    let object = &scene.objects[index];
    let step = area(scene, index) / PLACES as f64;
    let mut passed = 0.5 * step;
    for triangle in 0..object.mesh.triangles.len() {
        let patch = Patch::of_triangle(object, triangle);
        passed += patch.area();
        let places = (passed / step) as usize;
        passed -= places as f64 * step;
        let primitive = world.geometry.primitive(index as u32, triangle as u32);
        for place in 0..places.min(PLACES) {
            let [u, v, ..] = sobol_burley::sample_4d(place as u32, 0, primitive as u32).map(f64::from);
            found(world.point_on(primitive, patch.point(u, v).as_vec3()));
        }
    }
}

/// A number with three significant digits.
fn significant(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x) {
        let digits =
            if x >= 100.0 || x == 0.0 { 0 } else { (2.0 - libm::log10(x).floor()).clamp(0.0, 6.0) as usize };
        format!("{x:.digits$}")
    } else {
        format!("{x:.2e}")
    }
}
