//! All triangles of a scene in one hierarchy, except those of meshes that objects share, with the queries of a path tracer.
//!
//! The rest of the renderer knows only the queries below, so that another hierarchy can take the place of
//! the one at hand.

use glam::{Vec2, Vec3};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use translucid_scene::{Mesh, Object, Scene};

use super::clearance::Clearance;
use super::facets::Facets;
use super::groups::{CELLS, Groups};
use super::hit::{Hit, offset_at};
use super::instances::{InstanceBlock, Instances, LoneInstance, MeshSharing, NONE};
use super::primitive::{BlockNeeds, Primitive, PrimitiveSource};
use super::triangle::TriangleBlock;
use super::wide_tree::WideTree;
use crate::ray::Ray;

/// A point on a surface, as the renderer knows it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    pub(crate) position: Vec3,
    /// Unit geometric normal, on the outside of the mesh.
    pub(crate) geometric_normal: Vec3,
    /// Unit shading normal, within 90° of the geometric one.
    pub(crate) shading_normal: Vec3,
    pub(crate) uv: Vec2,
    pub(crate) color: Vec3,
    /// Distance by which a ray's origin has to leave the surface to clear rounding errors.
    pub(crate) offset: f32,
    pub(crate) object: u32,
    pub(crate) triangle: u32,
    pub(crate) group: u32,
}

impl SurfacePoint {
    /// A ray's origin on the side of the surface that `direction` points to.
    pub(crate) fn ray_origin(&self, direction: Vec3) -> Vec3 {
        let side = self.offset.copysign(self.geometric_normal.dot(direction));
        self.position + self.geometric_normal * side
    }
}

/// The triangles of objects and the tree over them.
///
/// ```
/// use glam::Vec3;
/// use translucid_render::{Geometry, Ray};
/// use translucid_scene::{Mesh, Object};
///
/// let mesh = Mesh {
///     positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
///     triangles: vec![[0, 1, 2]],
///     ..Mesh::default()
/// };
/// let objects = [Object { name: "triangle".into(), mesh: mesh.into(), material: 0, subsurface_group: 0, ..Object::default() }];
/// let geometry = Geometry::new(&objects);
/// let hit = geometry.closest(&Ray::new(Vec3::new(0.2, 0.2, 5.0), Vec3::NEG_Z)).unwrap();
/// assert!((hit.t - 5.0).abs() < 1e-5);
/// ```
pub struct Geometry {
    tree: WideTree,
    /// Objects that share their meshes, if there are any.
    instances: Option<Box<Instances>>,
    /// Number of triangles in the objects before each object, and in all.
    first_triangle: Vec<u64>,
    groups: Groups,
    bounds: (Vec3, Vec3),
}

impl Geometry {
    /// Builds the tree on the current rayon pool. The result does not depend on the number of threads.
    ///
    /// Meshes that are [worth sharing](Mesh::is_worth_sharing) have a tree of their own for all objects.
    pub fn new(objects: &[Object]) -> Self {
        Self::with_sharing(objects, Mesh::is_worth_sharing, None)
    }

    /// The tree over other objects, which takes over the trees of meshes that both share.
    pub(crate) fn renewed(&self, objects: &[Object]) -> Self {
        Self::with_sharing(objects, Mesh::is_worth_sharing, self.instances.as_deref())
    }

    /// Every mesh that more than one object has gets a tree of its own.
    #[cfg(test)]
    pub(super) fn sharing_all(objects: &[Object]) -> Self {
        Self::with_sharing(objects, |_, _| true, None)
    }

    /// No mesh gets a tree of its own.
    #[cfg(test)]
    pub(super) fn sharing_none(objects: &[Object]) -> Self {
        Self::with_sharing(objects, |_, _| false, None)
    }

    fn with_sharing(
        objects: &[Object],
        should_share: impl Fn(&Mesh, usize) -> bool,
        old: Option<&Instances>,
    ) -> Self {
        let sharing = MeshSharing::new(objects, should_share);
        let instances = Instances::new(objects, &sharing, old).map(Box::new);
        let mut first_triangle = vec![0_u64];
        let own =
            |index: usize| if sharing.is_shared(index) { 0 } else { objects[index].mesh.triangles.len() };
        let mut places = Vec::with_capacity((0..objects.len()).map(own).sum());
        for (index, object) in objects.iter().enumerate() {
            let count = object.mesh.triangles.len() as u32;
            if !sharing.is_shared(index) {
                places.extend((0..count).map(|triangle| TrianglePlace {
                    object,
                    index: index as u32,
                    triangle,
                }));
            }
            first_triangle.push(first_triangle[index] + u64::from(count));
        }
        let tree = WideTree::new(&places);
        let needs_group =
            |object: usize| !instances.as_ref().is_some_and(|shared| shared.needs_no_group(object as u32));
        let groups = Groups::new(objects, needs_group);
        let bounds = match &instances {
            None => tree.bounds(),
            Some(shared) if places.is_empty() => shared.bounds(),
            Some(shared) => {
                let ((low, high), (a, b)) = (tree.bounds(), shared.bounds());
                (low.min(a), high.max(b))
            }
        };
        Self { tree, instances, first_triangle, groups, bounds }
    }

    /// Corners of the box around everything.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.bounds
    }

    /// Memory that the trees take, in bytes.
    pub fn memory(&self) -> usize {
        self.tree.memory() + self.instances.as_ref().map_or(0, |instances| instances.memory())
    }

    /// Number of all triangles; those of a shared mesh count for each object.
    pub(crate) fn triangles(&self) -> u64 {
        self.first_triangle.last().copied().unwrap_or(0)
    }

    /// Scene-wide number of an object's triangle.
    pub(crate) fn primitive(&self, object: u32, triangle: u32) -> u64 {
        self.first_triangle[object as usize] + u64::from(triangle)
    }

    /// Object and triangle of a scene-wide number.
    pub(crate) fn object_and_triangle(&self, primitive: u64) -> (u32, u32) {
        let object = self.first_triangle.partition_point(|&first| first <= primitive) - 1;
        (object as u32, (primitive - self.first_triangle[object]) as u32)
    }

    /// The body that an object is by itself and a place of a shared mesh.
    pub(super) fn alone(&self, object: u32) -> Option<LoneInstance<'_>> {
        self.instances.as_ref()?.alone(object)
    }

    /// Cells of the grid of one body.
    pub(super) fn cells(&self) -> f32 {
        let shared = self.instances.as_ref().map_or(0, |instances| instances.meshes());
        CELLS / (self.groups.count() + shared) as f32
    }

    /// How far from a point no surface of a group is, which are those of the objects that this was made for.
    pub(super) fn clearance(&self, objects: &[Object], group: u32) -> Option<&Clearance> {
        self.groups.clearance(objects, group, self.cells())
    }

    /// The facets of a group of the objects that this was made for.
    pub(super) fn facets(&self, objects: &[Object], group: u32) -> Option<&Facets> {
        self.groups.facets(objects, group)
    }

    /// The object that a hit belongs to.
    pub fn object(&self, hit: &Hit) -> u32 {
        match self.instances_of(hit) {
            Some(instances) => instances.block(hit.instance).object(),
            None => self.tree.leaf(hit.leaf).0.object(),
        }
    }

    /// The objects that share their meshes, if a hit is with one of them.
    fn instances_of(&self, hit: &Hit) -> Option<&Instances> {
        self.instances.as_deref().filter(|_| hit.instance != NONE)
    }

    /// The object that a hit belongs to, and its triangle's number there, which do not depend on the tree.
    pub fn object_and_triangle_of(&self, hit: &Hit) -> (u32, u32) {
        let Primitive { object, triangle, .. } = self.triangle(hit);
        (object, triangle)
    }

    /// The nearest surface along a ray.
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let hit = self.tree.closest(ray).map(Hit::alone);
        match &self.instances {
            None => hit,
            Some(instances) => instances.closest(ray, None, hit),
        }
    }

    /// Returns `true` if anything lies on a segment.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.tree.occluded(ray) || self.instances.as_ref().is_some_and(|instances| instances.occluded(ray))
    }

    /// The nearest surface of a subsurface group along a ray.
    pub fn closest_in_group(&self, ray: &Ray, group: u32) -> Option<Hit> {
        let hit = self.tree.closest_in_group(ray, group).map(Hit::alone);
        match &self.instances {
            None => hit,
            Some(instances) => instances.closest(ray, Some(group), hit),
        }
    }

    /// Calls `found` for every hit of a segment with a subsurface group, in the tree's order.
    pub fn all_in_group(&self, ray: &Ray, group: u32, mut found: impl FnMut(Hit)) {
        self.tree.all(ray, |hit, leaf| {
            if self.tree.leaf(leaf).0.group() == group {
                found(Hit::alone((hit, leaf)));
            }
        });
        if let Some(instances) = &self.instances {
            instances.all_in_group(ray, group, found);
        }
    }

    fn triangle(&self, hit: &Hit) -> Primitive {
        match self.instances_of(hit) {
            Some(instances) => instances.triangle(hit),
            None => self.tree.triangle(hit.leaf),
        }
    }

    /// Unit geometric normal of a hit, on the outside of its mesh.
    pub fn normal(&self, hit: &Hit) -> Vec3 {
        self.triangle(hit).normal().normalize_or(Vec3::Z)
    }

    /// Position of a hit, interpolated from the vertices: exact to their rounding errors.
    pub fn position(&self, hit: &Hit) -> Vec3 {
        self.triangle(hit).point(hit.barycentric)
    }

    /// Everything about a hit.
    pub(crate) fn surface_point(&self, scene: &Scene, hit: &Hit) -> SurfacePoint {
        let point = surface_point(scene, &self.triangle(hit), hit.barycentric);
        match self.instances_of(hit) {
            Some(instances) => beyond_errors(point, instances.block(hit.instance)),
            None => point,
        }
    }

    /// The point of a triangle nearest to a position in its plane, by the triangle's scene-wide number.
    pub(crate) fn point_on(&self, scene: &Scene, primitive: u64, position: Vec3) -> SurfacePoint {
        let (object, triangle) = self.object_and_triangle(primitive);
        let owner = &scene.objects[object as usize];
        let leaf = TrianglePlace { object: owner, index: object, triangle }.primitive();
        let point = surface_point(scene, &leaf, barycentric(&leaf.vertices, position));
        match self.instances.as_ref().and_then(|instances| instances.of_object(object)) {
            Some((_, block)) => beyond_errors(point, block),
            None => point,
        }
    }
}

/// The place of a triangle: a third of the size of the triangle itself, of which there may be ten million.
#[derive(Clone, Copy)]
struct TrianglePlace<'a> {
    object: &'a Object,
    index: u32,
    triangle: u32,
}

impl Boundable for TrianglePlace<'_> {
    fn aabb(&self) -> Aabb {
        self.primitive().aabb()
    }
}

impl TrianglePlace<'_> {
    fn primitive(&self) -> Primitive {
        let vertices = self.object.vertices(self.triangle as usize);
        let group = self.object.subsurface_group;
        Primitive { vertices, object: self.index, triangle: self.triangle, group }
    }
}

impl PrimitiveSource for TrianglePlace<'_> {
    type Block = TriangleBlock;

    fn needs(&self) -> Option<BlockNeeds> {
        Some(BlockNeeds::triangle(self.index, self.object.corners(self.triangle as usize)))
    }

    fn place(&self) -> Vec3 {
        self.object.position(self.object.corners(self.triangle as usize)[0])
    }

    fn put(&self, block: &mut TriangleBlock, lane: usize) -> u32 {
        block.set(lane, &self.primitive());
        self.triangle
    }
}

/// A point of a shared mesh, whose rays are less exact.
fn beyond_errors(point: SurfacePoint, instance: &InstanceBlock) -> SurfacePoint {
    SurfacePoint { offset: point.offset.max(instance.offset_at(point.position)), ..point }
}

/// Attributes of a triangle at barycentric coordinates.
fn surface_point(scene: &Scene, leaf: &Primitive, [b1, b2]: [f32; 2]) -> SurfacePoint {
    let object = &scene.objects[leaf.object as usize];
    let mesh = &object.mesh;
    let corners = object.corners(leaf.triangle as usize);
    let weights = [1.0 - b1 - b2, b1, b2];
    let geometric_normal = leaf.normal().normalize_or(Vec3::Z);
    let largest = leaf.vertices.iter().fold(Vec3::ZERO, |m, v| m.max(v.abs())).max_element();
    let mut shading_normal = geometric_normal;
    if !mesh.normals.is_empty() {
        let [a, b, c] = corners.map(|corner| object.normal(corner));
        let normal = a * weights[0] + b * weights[1] + c * weights[2];
        shading_normal = normal.try_normalize().unwrap_or(geometric_normal);
    }
    // A shading normal from the other side (broken input) would turn the surface inside out.
    if shading_normal.dot(geometric_normal) <= 0.0 {
        shading_normal = geometric_normal;
    }
    SurfacePoint {
        position: leaf.point([b1, b2]),
        geometric_normal,
        shading_normal,
        uv: interpolate(&mesh.uvs, corners, weights, Vec2::ZERO),
        color: interpolate(&mesh.colors, corners, weights, Vec3::ONE),
        offset: offset_at(largest),
        object: leaf.object,
        triangle: leaf.triangle,
        group: leaf.group,
    }
}

/// Coordinates of vertices 1 and 2, clamped into the triangle.
fn barycentric(&[a, b, c]: &[Vec3; 3], position: Vec3) -> [f32; 2] {
    // In double precision: fourth powers of lengths.
    let [e1, e2, p] = [b - a, c - a, position - a].map(Vec3::as_dvec3);
    let normal = e1.cross(e2);
    let squared = normal.length_squared();
    if squared == 0.0 {
        return [0.0, 0.0];
    }
    let b1 = ((p.cross(e2).dot(normal) / squared) as f32).clamp(0.0, 1.0);
    let b2 = ((e1.cross(p).dot(normal) / squared) as f32).clamp(0.0, 1.0 - b1);
    [b1, b2]
}

/// Barycentric interpolation of a vertex attribute, `absent` where the mesh has none.
fn interpolate<T>(attribute: &[T], corners: [u32; 3], weights: [f32; 3], absent: T) -> T
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    if attribute.is_empty() {
        return absent;
    }
    let [a, b, c] = corners.map(|corner| attribute[corner as usize]);
    a * weights[0] + b * weights[1] + c * weights[2]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// Random triangles in the unit cube.
    fn soup(count: u32) -> Vec<Object> {
        let mut mesh = Mesh::default();
        for i in 0..count {
            let random = |salt: u32| sobol_burley::sample(i, salt, 3);
            let center = Vec3::new(random(0), random(1), random(2));
            for corner in 0..3 {
                let at = |axis: u32| random(3 + 3 * corner + axis) - 0.5;
                mesh.positions.push(center + Vec3::new(at(0), at(1), at(2)) * 0.1);
            }
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        vec![Object {
            name: "soup".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: i32::MAX as u32,
            ..Object::default()
        }]
    }

    fn random_ray(i: u32) -> Ray {
        let random = |salt: u32| sobol_burley::sample(i, salt, 11);
        let target = Vec3::new(random(0), random(1), random(2));
        let origin = Vec3::new(random(3), random(4), random(5)) * 4.0 - 1.5;
        Ray::segment(origin, (target - origin).normalize(), 0.5 + 4.0 * random(6))
    }

    /// The tree against a loop over all triangles.
    #[test]
    fn queries_agree_with_brute_force() {
        let objects = soup(1000);
        let geometry = Geometry::new(&objects);
        let singles: Vec<_> = (0..objects[0].mesh.triangles.len())
            .map(|number| {
                let mut single = objects[0].clone();
                Arc::make_mut(&mut single.mesh).triangles = vec![objects[0].mesh.triangles[number]];
                Geometry::new(&[single])
            })
            .collect();
        let group = objects[0].subsurface_group;
        let mut hits = 0;
        for i in 0..500 {
            let ray = random_ray(i);
            let mut expected: Vec<f32> =
                singles.iter().filter_map(|single| single.closest(&ray)).map(|hit| hit.t).collect();
            expected.sort_by(f32::total_cmp);
            hits += expected.len();
            let mut found = Vec::new();
            geometry.all_in_group(&ray, group, |hit| found.push(hit.t));
            found.sort_by(f32::total_cmp);
            assert_eq!(found, expected);
            assert_eq!(geometry.closest(&ray).map(|hit| hit.t), expected.first().copied());
            assert_eq!(geometry.occluded(&ray), !expected.is_empty());
            geometry.all_in_group(&ray, group + 1, |_| panic!("a hit in a foreign group"));
            let nearest = geometry.closest_in_group(&ray, group);
            assert_eq!(nearest.map(|hit| hit.t), expected.first().copied());
            assert!(geometry.closest_in_group(&ray, group + 1).is_none());
        }
        assert!(hits > 150, "the test meets too few triangles: {hits}");
    }

    /// Triangles of several groups share leaves and boxes.
    #[test]
    fn closest_in_group_sees_through_other_groups() {
        let mesh = soup(1200).remove(0).mesh;
        let objects: Vec<Object> = (0..3)
            .map(|group| {
                let triangles = mesh.triangles.iter().copied().skip(group).step_by(3).collect();
                let mesh = Mesh { triangles, ..Mesh::clone(&mesh) };
                Object {
                    name: "third".into(),
                    mesh: mesh.into(),
                    material: 0,
                    subsurface_group: group as u32,
                    ..Object::default()
                }
            })
            .collect();
        let geometry = Geometry::new(&objects);
        let mut hits = 0;
        for i in 0..500 {
            let ray = random_ray(i);
            for group in 0..3 {
                let mut nearest = f32::INFINITY;
                geometry.all_in_group(&ray, group, |hit| nearest = nearest.min(hit.t));
                let found = geometry.closest_in_group(&ray, group).map_or(f32::INFINITY, |hit| hit.t);
                assert_eq!(found, nearest);
                hits += u32::from(found.is_finite());
            }
        }
        assert!(hits > 150, "the test meets too few triangles: {hits}");
    }

    #[test]
    fn tree_does_not_depend_on_threads() {
        let objects = soup(5000);
        let build = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
            pool.install(|| Geometry::new(&objects))
        };
        let (one, two) = (build(1), build(2));
        // Empty lanes are NaN, so compare their text.
        assert_eq!(format!("{:?}", one.tree), format!("{:?}", two.tree));
    }

    #[test]
    fn coincident_triangles_build_and_hit() {
        let mut objects = soup(1);
        Arc::make_mut(&mut objects[0].mesh).triangles = vec![[0, 1, 2]; 30_000];
        let mesh = &objects[0].mesh;
        let center = mesh.positions.iter().sum::<Vec3>() / 3.0;
        let geometry = Geometry::new(&objects);
        let [a, b, c] = [0, 1, 2].map(|i| mesh.positions[i]);
        let direction = (b - a).cross(c - a).normalize();
        let mut count = 0;
        geometry.all_in_group(&Ray::new(center - direction, direction), objects[0].subsurface_group, |_| {
            count += 1;
        });
        assert_eq!(count, 30_000);
    }

    #[test]
    fn primitive_numbers_go_both_ways() {
        let mut objects = soup(3);
        objects.extend(soup(4));
        let geometry = Geometry::new(&objects);
        for primitive in 0..7 {
            let (object, triangle) = geometry.object_and_triangle(primitive);
            assert_eq!(geometry.primitive(object, triangle), primitive);
        }
        assert_eq!(geometry.object_and_triangle(3), (1, 0));
    }
}
