//! The light that leaves at a point: a sum over all points of its group.
//!
//! ```text
//! B(x) = A Σ_i a_i E_i p(√(|x − p_i|² + b²)) + A cdf(b) Ē(x)
//! ```
//!
//! p(r) = R(r)/A goes like 1/r, so the points nearest to x would count for far too much or too little. The radius is
//! softened by b, half of the points' spacing; then a sum over points in blue noise is as good as the integral. On a
//! plane the softened profile has the energy that the profile has beyond b; the share cdf(b) that is missing comes
//! from the mean irradiance Ē around x on surfaces that face the same way. The plane's energy is then exact, and
//! the error of the softening vanishes with the spacing.
//!
//! A cluster of points around c stands in for its points with the tangent of f(p) = p(√(|x − p|² + b²)) at c, and
//! with half of the second derivative H of f at c times the spread of its area,
//!
//! ```text
//! Σ_i a_i E_i f(p_i) = f(c) Σ a_i E_i + ∇f(c) · Σ a_i E_i (p_i − c) + C + error
//! C = ½ tr(H(c) Σ a_i (p_i − c)(p_i − c)ᵀ) Σ a_i E_i / Σ a_i
//! |error| ≤ ½ K Σ a_i E_i |p_i − c|² + |C|,   K ≥ |p''|, |p'|/r at all radii from √(r_min² + b²) on,
//! ```
//!
//! because the eigenvalues of H are mixtures of p'' and p'/r. r_min is the least distance of the cluster's ball
//! from x. C is right where irradiance changes little within the cluster: it takes most of the error away, and costs a
//! somewhat looser bound. Clusters are opened in the order of their bounds, as lightcuts are [Walter et al. 2005],
//! until the bounds of all together are small enough in every channel. The profile need not fall monotonically.

use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::Arc;

use glam::{DVec3, Vec3};
use translucid_scene::Scene;

use super::super::{SubsurfaceTransport, Tracer};
use super::hierarchy::{PointCluster, PointHierarchy, TreePoint};
use super::smooth_profile::SmoothProfile;
use super::surfels::Surfel;
use crate::ray::SurfacePoint;
use crate::subsurface::exit_point::ExitPoint;
use crate::subsurface::kernel::SubsurfaceKernel;
use crate::subsurface::parameters::Subsurface;
use crate::subsurface::shape_factor::shape_factor;
use crate::world::{Layer, PathState, World};

/// Softening b in spacings.
const SOFTENING: f32 = 0.5;
/// Radius of the neighborhood that Ē is the mean of, in spacings.
const NEIGHBORHOOD: f32 = 2.0;
/// Light need not be exact below this part of the light that the group's mean irradiance would give.
const DARK: f64 = 1e-3;
/// Albedos that a textured material's profile is tabulated for.
const ROWS: usize = 64;

/// An exit point, as the sum needs it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GatherPoint {
    pub(crate) position: Vec3,
    /// Unit geometric normal on the outside.
    pub(crate) normal: Vec3,
    pub(crate) group: u32,
    /// Number of its material.
    pub(crate) material: usize,
    pub(crate) subsurface: Subsurface,
}

impl GatherPoint {
    /// The exit point that a path has met.
    pub(crate) fn at(exit: &ExitPoint<'_>) -> Self {
        let SurfacePoint { position, geometric_normal: normal, group, .. } = *exit.point;
        Self { position, normal, group, material: exit.material, subsurface: exit.subsurface }
    }
}

/// The light gathered at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gathered {
    /// Σ R a E: radiant exitance under the surface; 0 in channels that do not scatter.
    pub(crate) light: Vec3,
    /// Σ R a / A: share of the profile's energy that the group's surfaces hold; 1 on a plane.
    pub(crate) energy: Vec3,
}

/// Points made ready for sums.
pub(crate) struct Gatherer {
    pub(super) tolerance: f64,
    /// Sorted by their numbers.
    pub(super) groups: Vec<PointGroup>,
    /// For each material its profile, if it has one.
    pub(super) profiles: Vec<Option<Arc<MaterialProfile>>>,
}

/// The points of a subsurface group.
pub(super) struct PointGroup {
    pub(super) number: u32,
    pub(super) tree: PointHierarchy,
    /// Length of the tree's unit \[L\].
    spacing: f64,
    /// Exitance that need not be exact, for A = 1.
    dark: DVec3,
}

/// Memory that gathering needs; each thread has its own.
#[derive(Default)]
pub(crate) struct GatherScratch {
    near: Vec<u32>,
    open: BinaryHeap<OpenCluster>,
}

/// Points of a group in the order of the tree, with their spacing.
#[derive(Clone, Copy)]
pub(crate) struct GroupOfPoints<'a> {
    pub(crate) number: u32,
    pub(crate) spacing: f64,
    pub(crate) surfels: &'a [Surfel],
}

impl Gatherer {
    /// Makes points ready; `irradiance` is that of each, or empty for 1 everywhere.
    pub(crate) fn new(
        scene: &Scene,
        transports: &[Arc<SubsurfaceTransport>],
        groups: &[GroupOfPoints<'_>],
        irradiance: &[Vec3],
    ) -> Self {
        let mut start = 0;
        let group = |group: &GroupOfPoints<'_>| {
            let of = |i: usize| irradiance.get(start + i).copied().unwrap_or(Vec3::ONE);
            let tree = PointHierarchy::new(group.surfels, of, group.spacing);
            start += group.surfels.len();
            let mean = tree.nodes.first().map_or(DVec3::ZERO, |root| {
                root.flux.as_dvec3() / f64::from(root.area).max(f64::MIN_POSITIVE)
            });
            PointGroup { number: group.number, tree, spacing: group.spacing, dark: mean * DARK }
        };
        let mut groups: Vec<PointGroup> = groups.iter().map(group).collect();
        groups.sort_by_key(|group| group.number);
        let tolerance = f64::from(scene.integrator.point_tolerance);
        Self { tolerance, groups, profiles: profiles(scene, transports) }
    }

    /// Adds the light from below by the sum over all points, and ends the path; false where there are no points.
    pub(in crate::subsurface) fn scatter<'a, T: Tracer<'a>>(
        &self,
        tracer: &mut T,
        world: &World,
        path: &mut PathState,
        exit: &ExitPoint<'_>,
    ) -> bool {
        let Some(gathered) = self.gather(&GatherPoint::at(exit), &mut tracer.scratch().points) else {
            return false;
        };
        let factor = shape_factor(&world.scene.materials[exit.material], gathered.energy);
        path.add_to(path.layer_after(Layer::Subsurface), path.throughput * gathered.light * factor);
        true
    }

    /// Gathers light and energy at a point; `None` where its group has no points, or its material no profile.
    pub(crate) fn gather(&self, exit: &GatherPoint, scratch: &mut GatherScratch) -> Option<Gathered> {
        let index = self.groups.binary_search_by_key(&exit.group, |group| group.number).ok()?;
        let group = &self.groups[index];
        let profile = self.profiles[exit.material].as_ref()?;
        let channels = [0, 1, 2].map(|c| profile.channel(&exit.subsurface, c, group.spacing));
        let place = group.tree.local(exit.position);
        let mut sum = RunningSum::new(&group.tree, channels, place, exit.normal);
        sum.run(scratch, self.tolerance, group.dark);
        let softening = (f64::from(SOFTENING) * group.spacing) as f32;
        Some(sum.finish(&exit.subsurface, within(&profile.kernel, &exit.subsurface, softening)))
    }
}

/// Share of each channel's energy that leaves within r.
fn within(kernel: &SubsurfaceKernel, subsurface: &Subsurface, r: f32) -> Vec3 {
    let Subsurface { surface_albedo, length } = *subsurface;
    let share = |c: usize| {
        if length[c] <= 0.0 { 0.0 } else { kernel.radial(surface_albedo[c], length[c]).cdf(r) }
    };
    Vec3::new(share(0), share(1), share(2))
}

/// A sum under way, for A = 1.
struct RunningSum<'a> {
    tree: &'a PointHierarchy,
    channels: [ChannelProfile<'a>; 3],
    place: Vec3,
    normal: Vec3,
    light: DVec3,
    energy: DVec3,
    /// Bound of the error of `light`.
    error: DVec3,
    /// Light that enters around the place, weighted, and the sum of the weights.
    near_flux: Vec3,
    near_area: f32,
}

/// A cluster that stands in for its points so far.
struct OpenCluster {
    key: f32,
    node: u32,
    part: ClusterLight,
}

/// Light of a cluster.
#[derive(Clone, Copy)]
struct ClusterLight {
    light: DVec3,
    energy: DVec3,
    error: DVec3,
}

impl<'a> RunningSum<'a> {
    fn new(tree: &'a PointHierarchy, channels: [ChannelProfile<'a>; 3], place: Vec3, normal: Vec3) -> Self {
        let zero = DVec3::ZERO;
        let (near_flux, near_area) = (Vec3::ZERO, 0.0);
        Self { tree, channels, place, normal, light: zero, energy: zero, error: zero, near_flux, near_area }
    }

    /// Sums until the error is within the tolerance, relative to the light or to `dark`, if that is greater.
    fn run(&mut self, scratch: &mut GatherScratch, tolerance: f64, dark: DVec3) {
        scratch.open.clear();
        self.sum_near(scratch, dark);
        while (self.error.cmpgt(self.light.max(dark) * tolerance)).any() {
            let Some(open) = scratch.open.pop() else { break };
            self.light -= open.part.light;
            self.energy -= open.part.energy;
            self.error -= open.part.error;
            let node = &self.tree.nodes[open.node as usize];
            if node.right == 0 {
                self.add_points(node);
            } else {
                self.open(scratch, open.node + 1, dark);
                self.open(scratch, node.right, dark);
            }
        }
    }

    /// Adds the points of all clusters that reach into the neighborhood one by one, and the others as they are.
    fn sum_near(&mut self, scratch: &mut GatherScratch, dark: DVec3) {
        scratch.near.clear();
        scratch.near.extend((!self.tree.nodes.is_empty()).then_some(0));
        while let Some(index) = scratch.near.pop() {
            let node = &self.tree.nodes[index as usize];
            if node.center.distance(self.place) - node.radius > NEIGHBORHOOD {
                self.open(scratch, index, dark);
            } else if node.right == 0 {
                self.add_points(node);
            } else {
                scratch.near.extend([index + 1, node.right]);
            }
        }
    }

    /// Adds a cluster as a whole.
    fn open(&mut self, scratch: &mut GatherScratch, index: u32, dark: DVec3) {
        let part = self.part(&self.tree.nodes[index as usize]);
        self.light += part.light;
        self.energy += part.energy;
        self.error += part.error;
        let relative = part.error / self.light.max(dark).max(DVec3::splat(f64::MIN_POSITIVE));
        scratch.open.push(OpenCluster { key: relative.max_element() as f32, node: index, part });
    }

    /// Light of a cluster taken as a whole, by the formulas at the head of the file.
    fn part(&self, node: &PointCluster) -> ClusterLight {
        let offset = node.center - self.place;
        let squared = offset.length_squared();
        let soft = SOFTENING * SOFTENING;
        let radius = (squared + soft).sqrt();
        let nearest = (squared.sqrt() - node.radius).max(0.0);
        let least = (nearest * nearest + soft).sqrt();
        let along = f64::from(offset.dot(node.spread * offset) / (radius * radius));
        let trace = f64::from(node.spread.x_axis.x + node.spread.y_axis.y + node.spread.z_axis.z);
        let mut part = ClusterLight { light: DVec3::ZERO, energy: DVec3::ZERO, error: DVec3::ZERO };
        for (c, channel) in self.channels.iter().enumerate() {
            let ChannelJet { value, slope, second } = channel.eval(radius);
            let first = f64::from(offset.dot(node.first[c]) / radius);
            let slope_over_radius = slope / f64::from(radius);
            let bend = 0.5 * ((second - slope_over_radius) * along + slope_over_radius * trace);
            part.light[c] = (value + bend) * f64::from(node.flux[c]) + slope * first;
            part.energy[c] = (value + bend) * f64::from(node.area);
            part.error[c] = 0.5 * channel.curvature_from(least) * f64::from(node.second[c])
                + bend.abs() * f64::from(node.flux[c]);
        }
        part
    }

    /// Adds points one by one.
    fn add_points(&mut self, node: &PointCluster) {
        for point in self.tree.points_of(node) {
            let squared = point.position.distance_squared(self.place);
            let radius = (squared + SOFTENING * SOFTENING).sqrt();
            for (c, channel) in self.channels.iter().enumerate() {
                let value = channel.eval(radius).value;
                self.light[c] += value * f64::from(point.flux[c]);
                self.energy[c] += value * f64::from(point.area);
            }
            self.add_to_neighborhood(point, squared);
        }
    }

    fn add_to_neighborhood(&mut self, point: &TreePoint, squared: f32) {
        let inside = 1.0 - squared * (1.0 / (NEIGHBORHOOD * NEIGHBORHOOD));
        if inside > 0.0 {
            // Points that face elsewhere count a little, for edges where nothing else is near
            let weight = inside * inside * (self.normal.dot(point.normal).max(0.0) + 1e-4);
            self.near_flux += point.flux * weight;
            self.near_area += point.area * weight;
        }
    }

    /// The light with the share that enters around the place.
    fn finish(&self, subsurface: &Subsurface, within: Vec3) -> Gathered {
        let mean = if self.near_area > 0.0 { self.near_flux / self.near_area } else { Vec3::ZERO };
        let light = (self.light.as_vec3() + mean * within).max(Vec3::ZERO) * subsurface.surface_albedo;
        let energy = self.energy.as_vec3() + within;
        let is_active = subsurface.length.cmpgt(Vec3::ZERO);
        let finite = |v: Vec3| Vec3::select(v.is_finite_mask() & is_active, v, Vec3::ZERO);
        Gathered { light: finite(light), energy: finite(energy) }
    }
}

/// The profile of materials that share a kernel as smooth tables.
pub(crate) struct MaterialProfile {
    kernel: Arc<SubsurfaceKernel>,
    /// Rows by surface albedo.
    pub(super) rows: Vec<(f32, SmoothProfile)>,
}

/// A channel's profile in the tree's units: a mixture of two rows.
#[derive(Clone, Copy)]
struct ChannelProfile<'a> {
    rows: [Option<TableRow<'a>>; 2],
}

#[derive(Clone, Copy)]
struct TableRow<'a> {
    profile: &'a SmoothProfile,
    /// From the tree's units to the profile's.
    scale: f32,
    /// Share in the mixture times the square of the scale.
    weight: f64,
}

/// Density per area and its derivatives, in the tree's units.
#[derive(Clone, Copy, Default)]
struct ChannelJet {
    value: f64,
    slope: f64,
    second: f64,
}

/// The profile of each material.
fn profiles(scene: &Scene, transports: &[Arc<SubsurfaceTransport>]) -> Vec<Option<Arc<MaterialProfile>>> {
    let kernel = |index: usize| transports[index].probes().map(|probes| &probes.kernel);
    let mut made: Vec<Arc<MaterialProfile>> = Vec::new();
    let profile = |index: usize| {
        let own = kernel(index)?;
        let known = made.iter().find(|profile| Arc::ptr_eq(&profile.kernel, own)).cloned();
        Some(known.unwrap_or_else(|| {
            let is_alike = |other: &usize| kernel(*other).is_some_and(|kernel| Arc::ptr_eq(kernel, own));
            let alike: Vec<usize> = (0..transports.len()).filter(is_alike).collect();
            let row = |albedo: f32| (albedo, SmoothProfile::tabulated(own.radial(albedo, 1.0)));
            let albedos = match own.own() {
                Some(own) => sorted(own.surface_albedo.to_array().to_vec()),
                None => albedos_in_use(scene, &alike),
            };
            let rows = albedos.into_iter().map(row).collect();
            let new = Arc::new(MaterialProfile { kernel: Arc::clone(own), rows });
            made.push(Arc::clone(&new));
            new
        }))
    };
    (0..transports.len()).map(profile).collect()
}

impl MaterialProfile {
    /// The profile of a channel for a tree whose unit is `unit` long \[L\].
    fn channel(&self, subsurface: &Subsurface, channel: usize, unit: f64) -> ChannelProfile<'_> {
        let (albedo, length) = (subsurface.surface_albedo[channel], subsurface.length[channel]);
        if length <= 0.0 {
            return ChannelProfile { rows: [None; 2] };
        }
        let row = |profile, share: f32| TableRow::new(profile, unit / f64::from(length), f64::from(share));
        let rows = &self.rows;
        let upper = rows.partition_point(|(start, _)| *start < albedo).min(rows.len() - 1);
        let lower = if rows[upper].0 > albedo { upper.saturating_sub(1) } else { upper };
        let width = rows[upper].0 - rows[lower].0;
        let mix = if width > 0.0 { (albedo - rows[lower].0) / width } else { 0.0 };
        let second = (mix > 0.0).then(|| row(&rows[upper].1, mix));
        ChannelProfile { rows: [Some(row(&rows[lower].1, 1.0 - mix)), second] }
    }
}

/// The surface albedos of materials: the constant ones, and a grid where one is textured.
fn albedos_in_use(scene: &Scene, materials: &[usize]) -> Vec<f32> {
    let mut albedos: Vec<f32> = Vec::new();
    for &index in materials {
        let color = &scene.materials[index].subsurface_color;
        if color.texture.is_some() || color.vertex_color {
            // Closer to each other towards 0 and 1, as in `AlbedoTable::for_every_albedo`
            let y = |i: usize| i as f32 / (ROWS - 1) as f32;
            albedos.extend((0..ROWS).map(|i| 1.0 - (1.0 - y(i).powi(3)).powi(3)));
        } else {
            albedos.extend(color.factor.clamp(Vec3::ZERO, Vec3::ONE).to_array());
        }
    }
    sorted(albedos)
}

/// Surface albedos in order, each of them once.
fn sorted(mut albedos: Vec<f32>) -> Vec<f32> {
    albedos.sort_by(f32::total_cmp);
    albedos.dedup();
    albedos
}

impl<'a> TableRow<'a> {
    fn new(profile: &'a SmoothProfile, scale: f64, share: f64) -> Self {
        let scale = scale / f64::from(profile.scale());
        Self { profile, scale: scale as f32, weight: share * scale * scale }
    }
}

impl ChannelProfile<'_> {
    /// Density per area and its derivatives at a radius.
    #[inline]
    fn eval(&self, radius: f32) -> ChannelJet {
        let mut sum = ChannelJet::default();
        for row in self.rows.iter().flatten() {
            let jet = row.profile.eval(radius * row.scale);
            let scale = f64::from(row.scale);
            sum.value += row.weight * f64::from(jet.value);
            sum.slope += row.weight * scale * f64::from(jet.slope);
            sum.second += row.weight * scale * scale * f64::from(jet.second);
        }
        sum
    }

    /// No less than the second derivative and slope/radius from a radius on.
    #[inline]
    fn curvature_from(&self, radius: f32) -> f64 {
        let of = |row: &TableRow<'_>| {
            let scale = f64::from(row.scale);
            row.weight * scale * scale * f64::from(row.profile.curvature_from(radius * row.scale))
        };
        self.rows.iter().flatten().map(of).sum()
    }
}

impl PartialEq for OpenCluster {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for OpenCluster {}

impl PartialOrd for OpenCluster {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OpenCluster {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key.total_cmp(&other.key).then(self.node.cmp(&other.node))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use translucid_profile::Model;
    use translucid_scene::{
        ColorInput, Material, Mesh, Object, ScalarInput, SubsurfaceMethod, SubsurfaceModel,
    };

    use super::*;
    use crate::PreparedScene;
    use crate::ray::Geometry;
    use crate::subsurface::Recipes;
    use crate::subsurface::transport::points::hierarchy;
    use crate::subsurface::transport::points::{PixelWidths, PointCloud, PointPlan, PointSettings};

    /// Points at random in a ball of radius 3 with random light in half of it.
    fn soup(count: u32) -> (Vec<Surfel>, Vec<Vec3>) {
        let random = |i: u32, salt: u32| sobol_burley::sample(i, salt, 3);
        let surfel = |i: u32| {
            let at = |salt: u32| 6.0 * random(i, salt) - 3.0;
            let (position, normal) = ([at(0), at(1), at(2)], Vec3::new(at(3), at(4), 4.0).normalize());
            Surfel { position, area: 0.01 * random(i, 6), normal: normal.into(), primitive: i }
        };
        let mut surfels: Vec<Surfel> = (0..count).map(surfel).collect();
        hierarchy::order(&mut surfels);
        let light = |surfel: &Surfel| {
            let x = random(surfel.primitive, 7);
            if surfel.position[0] > 0.0 { Vec3::new(x, x * x, 3.0 * x) } else { Vec3::ZERO }
        };
        let light = surfels.iter().map(light).collect();
        (surfels, light)
    }

    fn scene(model: SubsurfaceModel) -> Scene {
        let material = Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.6, 0.3)),
            subsurface_radius_scale: ColorInput::constant(Vec3::new(2.0, 0.6, 0.3)),
            subsurface_model: model,
            ..Material::default()
        };
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let object = Object {
            name: "o".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 5,
            ..Object::default()
        };
        let mut scene = Scene { materials: vec![material], objects: vec![object], ..Scene::default() };
        scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
        scene
    }

    /// The sum over all points one by one, by the profile itself.
    fn brute_force(
        kernel: &SubsurfaceKernel,
        exit: &GatherPoint,
        spacing: f32,
        surfels: &[Surfel],
        irradiance: &[Vec3],
    ) -> Vec3 {
        let Subsurface { surface_albedo, length } = exit.subsurface;
        let profiles = [0, 1, 2].map(|c| kernel.radial(surface_albedo[c], length[c]));
        let (mut sum, mut near, mut weights) = (DVec3::ZERO, DVec3::ZERO, 0.0);
        for (surfel, light) in surfels.iter().zip(irradiance) {
            let squared = surfel.position().distance_squared(exit.position);
            let r = (squared + (SOFTENING * spacing).powi(2)).sqrt();
            let value = Vec3::from_array(profiles.each_ref().map(|profile| profile.pdf_area(r)));
            sum += (value * *light * surfel.area).as_dvec3();
            let inside = (1.0 - squared / (NEIGHBORHOOD * spacing).powi(2)).max(0.0);
            let weight = inside * inside * surfel.area * (surfel.normal().dot(exit.normal).max(0.0) + 1e-4);
            near += (*light * weight).as_dvec3();
            weights += f64::from(weight);
        }
        let mean = if weights > 0.0 { near / weights } else { DVec3::ZERO };
        let share = within(kernel, &exit.subsurface, SOFTENING * spacing).as_dvec3();
        (sum + mean * share).as_vec3() * surface_albedo
    }

    /// For every model: the error is within the tolerance, and far below it on average.
    #[test]
    fn gather_keeps_its_bound_for_every_model() {
        let (surfels, irradiance) = soup(2000);
        let spacing = 0.05;
        for model in Model::ALL {
            let scene = scene(SubsurfaceModel::Profile(model));
            let transports = Recipes::new(&scene).transports();
            let kernel = &transports[0].probes().expect("a profile").kernel;
            let geometry = Geometry::new(&scene.objects);
            let point = geometry.point_on(&scene, 0, Vec3::new(0.2, 0.2, 0.0));
            let subsurface = transports[0].at(&scene, &scene.materials[0], &point);
            let exits: Vec<(GatherPoint, Vec3)> = (0..20)
                .map(|i| {
                    let at = |salt: u32| 8.0 * sobol_burley::sample(i, salt, 9) - 4.0;
                    let position = Vec3::new(at(0), at(1), at(2));
                    let exit = GatherPoint { position, normal: Vec3::Z, group: 5, material: 0, subsurface };
                    (exit, brute_force(kernel, &exit, spacing as f32, &surfels, &irradiance))
                })
                .collect();
            let group = GroupOfPoints { number: 5, spacing, surfels: &surfels };
            let mut gatherer = Gatherer::new(&scene, &transports, &[group], &irradiance);
            let mut scratch = GatherScratch::default();
            for tolerance in [0.3, 0.05, 0.0] {
                gatherer.tolerance = f64::from(tolerance);
                for (exit, exact) in &exits {
                    let gathered = gatherer.gather(exit, &mut scratch).expect("points");
                    let dark = gatherer.groups[0].dark.as_vec3() * subsurface.surface_albedo;
                    for c in 0..3 {
                        // The smooth table itself is off by up to 1e-3
                        let allowed = (tolerance + 1e-3) * exact[c].max(dark[c]);
                        let error = (gathered.light[c] - exact[c]).abs();
                        assert!(error <= allowed, "{model} {tolerance} {c}: {gathered:?} not {exact}");
                    }
                }
            }
            let elsewhere = GatherPoint { group: 6, ..exits[0].0 };
            assert!(gatherer.gather(&elsewhere, &mut scratch).is_none(), "points of another group");
        }
    }

    /// Without light the energy is that of the profile, and so is the light of irradiance 1.
    #[test]
    fn energy_is_one_in_the_middle_of_a_plane() {
        let mut scene = scene(SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined));
        scene.materials[0].subsurface_color = ColorInput::constant(Vec3::splat(0.5));
        scene.materials[0].subsurface_radius_scale = ColorInput::constant(Vec3::ONE);
        let corners = [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)];
        scene.objects[0].mesh = Mesh {
            positions: corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
        .into();
        scene.integrator.point_tolerance = 0.2;
        let prepared = PreparedScene::new(scene).expect("a valid scene");
        let (world, transports) = prepared.parts();
        let never = AtomicBool::new(false);
        let making = PointSettings { memory: 1 << 30, progress: &|_| {}, stop: &never };
        let plan = PointPlan::new(world, transports.all(), &PixelWidths::default());
        let cloud = PointCloud::laid(world, &plan, &making);
        let gatherer = cloud.expect("memory").expect("not stopped").gatherer(world, transports.all());
        let point = world.point_on(0, Vec3::new(0.3, 0.1, 0.0));
        let subsurface = transports.of(0).at(&world.scene, &world.scene.materials[0], &point);
        let (position, normal) = (point.position, point.geometric_normal);
        let exit = GatherPoint { position, normal, group: 5, material: 0, subsurface };
        let gathered = gatherer.gather(&exit, &mut GatherScratch::default()).expect("points");
        assert!((gathered.energy - 1.0).abs().max_element() < 0.03, "{gathered:?}");
        let ratio = gathered.light / (gathered.energy * subsurface.surface_albedo);
        assert!((ratio - 1.0).abs().max_element() < 1e-4, "{gathered:?}");
    }
}
