//! Meshes that objects share: each has a tree of its own, in its own space, and one more is over their places.
//!
//! A ray that meets the box of a place is taken into the mesh's space, where it is not of unit length: distances along it
//! stay those in the world. With A the linear part of the place and T its translation,
//!
//! ```text
//! origin' = A⁻¹ (origin − T)    direction' = A⁻¹ direction
//! ```
//!
//! in single precision, so that in the world the ray is off by some ε |A||A⁻¹| |origin − T|, which offsets from surfaces,
//! boxes and clearances allow for.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use bytemuck::{Pod, Zeroable};
use glam::{DMat3, Mat3, Vec3};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use rayon::prelude::*;
use translucid_scene::{Mesh, Object};

use super::clearance::Clearance;
use super::facets::{Beyond, Crossing, Facet, Facets, Query};
use super::hit::{Hit, offset_at};
use super::primitive::{Block, Primitive, PrimitiveSource};
use super::triangle::{BlockRay, Ray, TriangleBlock, TriangleHit};
use super::wide_tree::{Visitor, WideTree};

/// Ratio of the stretches of a place up to which it is taken for a similarity.
const SIMILAR: f64 = 1.0 + 1e-5;

/// No other object is in the subsurface group.
const ALONE: u32 = 1;
/// The place mirrors the mesh: counter-clockwise is clockwise.
const MIRRORED: u32 = 2;
/// The place keeps angles.
const SIMILARITY: u32 = 4;

/// One object that shares its mesh: first the cache line that rays need, then the one that hits need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C, align(64))]
pub(super) struct InstanceBlock {
    local_from_world: Mat3,
    origin: Vec3,
    object: u32,
    mesh: u32,
    group: u32,
    flags: u32,
    world_from_local: Mat3,
    /// How much greater rounding errors are than those of coordinates as far from the origin: greatest row sum of |A||A⁻¹|.
    amplification: f32,
    /// Least factor by which a length is stretched.
    stretch: f32,
    unused: [u32; 5],
}

impl Block for InstanceBlock {
    const LANES: usize = 1;
}

impl InstanceBlock {
    fn new(object: &Object, number: u32, mesh: u32, is_alone: bool) -> Self {
        let linear = Mat3::from(object.world_from_local.matrix3).as_dmat3();
        let inverse = linear.inverse();
        let size = |m: &DMat3| DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs());
        let rows = (size(&linear) * size(&inverse)).transpose();
        let sums = [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.element_sum());
        let [least, greatest] = object.stretches();
        let flag = |flag: u32, is_set: bool| if is_set { flag } else { 0 };
        Self {
            local_from_world: inverse.as_mat3(),
            origin: object.world_from_local.translation.into(),
            object: number,
            mesh,
            group: object.subsurface_group,
            flags: flag(ALONE, is_alone)
                | flag(MIRRORED, object.is_mirrored())
                | flag(SIMILARITY, greatest <= least * SIMILAR),
            world_from_local: linear.as_mat3(),
            amplification: sums.into_iter().fold(1.0, f64::max) as f32,
            stretch: least as f32,
            unused: [0; 5],
        }
    }

    pub(super) fn object(&self) -> u32 {
        self.object
    }

    #[inline]
    fn local_point(&self, point: Vec3) -> Vec3 {
        self.local_from_world * (point - self.origin)
    }

    #[inline]
    fn world_point(&self, point: Vec3) -> Vec3 {
        self.world_from_local * point + self.origin
    }

    #[inline]
    fn local_ray(&self, ray: &Ray, t_max: f32) -> Ray {
        Ray::segment(self.local_point(ray.origin), self.local_from_world * ray.direction, t_max)
    }

    /// Distance \[L\] that clears rounding errors of a point of the placed mesh.
    #[inline]
    pub(super) fn offset_at(&self, point: Vec3) -> f32 {
        let from_origin = (point - self.origin).abs().max_element() * self.amplification;
        offset_at(from_origin.max(point.abs().max_element()))
    }

    fn hit(&self, line: u32, (hit, leaf): (TriangleHit, u32)) -> Hit {
        let mut barycentric = [hit.b1, hit.b2];
        if self.flags & MIRRORED != 0 {
            barycentric.reverse();
        }
        Hit { t: hit.t, barycentric, leaf, instance: line }
    }

    /// A triangle of the mesh in its place.
    fn placed(&self, local: &Primitive) -> Primitive {
        let mut vertices = local.vertices.map(|vertex| self.world_point(vertex));
        if self.flags & MIRRORED != 0 {
            vertices.swap(1, 2);
        }
        Primitive { vertices, object: self.object, triangle: local.triangle, group: self.group }
    }
}

/// A mesh with its tree, and what walks have to know of it.
pub(super) struct SharedTree {
    mesh: Arc<Mesh>,
    tree: WideTree,
    clearance: OnceLock<Clearance>,
    facets: OnceLock<Facets>,
}

impl SharedTree {
    fn new(mesh: &Arc<Mesh>) -> Self {
        let triangles: Vec<Local<'_>> =
            (0..mesh.triangles.len() as u32).map(|triangle| Local { mesh, triangle }).collect();
        let tree = WideTree::new(&triangles);
        Self { mesh: Arc::clone(mesh), tree, clearance: OnceLock::new(), facets: OnceLock::new() }
    }
}

/// A triangle of a mesh in its own space.
#[derive(Clone, Copy)]
struct Local<'a> {
    mesh: &'a Mesh,
    triangle: u32,
}

impl Local<'_> {
    fn primitive(&self) -> Primitive {
        let corners = self.mesh.triangles[self.triangle as usize];
        let vertices = corners.map(|corner| self.mesh.positions[corner as usize]);
        Primitive { vertices, object: 0, triangle: self.triangle, group: 0 }
    }
}

impl Boundable for Local<'_> {
    fn aabb(&self) -> Aabb {
        self.primitive().aabb()
    }
}

impl PrimitiveSource for Local<'_> {
    type Block = TriangleBlock;

    fn put(&self, block: &mut TriangleBlock, lane: usize) {
        block.set(lane, &self.primitive());
    }
}

/// An object on its way into the tree over places.
struct Placed<'a> {
    object: &'a Object,
    number: u32,
    mesh: u32,
    is_alone: bool,
    low: Vec3,
    high: Vec3,
}

impl<'a> Placed<'a> {
    /// An object whose mesh has these bounds.
    fn new(
        (object, number): (&'a Object, u32),
        mesh: u32,
        is_alone: bool,
        (low, high): (Vec3, Vec3),
    ) -> Self {
        let block = InstanceBlock::new(object, number, mesh, is_alone);
        let columns = block.world_from_local;
        let half = 0.5 * (high - low);
        let reach =
            columns.x_axis.abs() * half.x + columns.y_axis.abs() * half.y + columns.z_axis.abs() * half.z;
        let center = block.world_point(0.5 * (low + high));
        let (low, high) = (center - reach, center + reach);
        // A little room for each, which differs: the builder takes quadratic time over equal boxes
        let jitter = 1.0 + (number.wrapping_mul(0x9e37_79b9) >> 28) as f32 / 16.0;
        let room = jitter * block.offset_at(low).max(block.offset_at(high));
        Self { object, number, mesh, is_alone, low: low - room, high: high + room }
    }
}

impl Boundable for Placed<'_> {
    fn aabb(&self) -> Aabb {
        Aabb::new(self.low.into(), self.high.into())
    }
}

impl PrimitiveSource for Placed<'_> {
    type Block = InstanceBlock;

    fn put(&self, block: &mut InstanceBlock, _: usize) {
        *block = InstanceBlock::new(self.object, self.number, self.mesh, self.is_alone);
    }
}

/// Which of a scene's objects share their meshes.
pub(super) struct Sharing {
    /// Number of each object's mesh among the shared ones; `NONE` where it is not.
    mesh_of_object: Vec<u32>,
    /// The first object of each mesh.
    first_objects: Vec<usize>,
    /// Whether each object is alone in its group.
    is_alone: Vec<bool>,
}

/// Nothing of that kind.
pub(super) const NONE: u32 = u32::MAX;

impl Sharing {
    /// Objects whose meshes have uses enough and can be traced in their own space.
    pub(super) fn new(objects: &[Object], is_worth: impl Fn(&Mesh, usize) -> bool) -> Self {
        let mut uses: HashMap<usize, usize> = HashMap::new();
        let address = |object: &Object| Arc::as_ptr(&object.mesh).addr();
        for object in objects {
            *uses.entry(address(object)).or_insert(0) += 1;
        }
        let is_shared = |object: &Object| {
            let uses = uses[&address(object)];
            uses > 1 && is_worth(&object.mesh, uses) && object.can_be_instanced()
        };
        let mut numbers = HashMap::new();
        let mut first_objects = Vec::new();
        let mut mesh_of_object = Vec::with_capacity(objects.len());
        for (index, object) in objects.iter().enumerate() {
            let number = if is_shared(object) {
                *numbers.entry(address(object)).or_insert_with(|| {
                    first_objects.push(index);
                    first_objects.len() as u32 - 1
                })
            } else {
                NONE
            };
            mesh_of_object.push(number);
        }
        let mut is_alone = Vec::new();
        if !first_objects.is_empty() {
            let mut members: HashMap<u32, usize> = HashMap::new();
            objects.iter().for_each(|object| *members.entry(object.subsurface_group).or_insert(0) += 1);
            is_alone = objects.iter().map(|object| members[&object.subsurface_group] == 1).collect();
        }
        Self { mesh_of_object, first_objects, is_alone }
    }

    /// Whether an object is in the tree over places.
    pub(super) fn is_shared(&self, object: usize) -> bool {
        self.mesh_of_object[object] != NONE
    }
}

/// The objects that share their meshes.
pub(super) struct Instances {
    tree: WideTree<InstanceBlock>,
    meshes: Vec<Arc<SharedTree>>,
    /// Where each object's block is, or `NONE`.
    lines: Vec<u32>,
}

impl Instances {
    /// The trees of shared meshes, those of `old` where it has them, and that over their places; none if nothing is shared.
    pub(super) fn new(objects: &[Object], sharing: &Sharing, old: Option<&Self>) -> Option<Self> {
        if sharing.first_objects.is_empty() {
            return None;
        }
        let known = |mesh: &Arc<Mesh>| {
            let is_same = |shared: &&Arc<SharedTree>| Arc::ptr_eq(&shared.mesh, mesh);
            old.and_then(|old| old.meshes.iter().find(is_same)).cloned()
        };
        let make = |&first: &usize| {
            let mesh = &objects[first].mesh;
            known(mesh).unwrap_or_else(|| Arc::new(SharedTree::new(mesh)))
        };
        let meshes: Vec<Arc<SharedTree>> = sharing.first_objects.par_iter().map(make).collect();
        let placed: Vec<Placed<'_>> = objects
            .par_iter()
            .enumerate()
            .filter(|(index, _)| sharing.is_shared(*index))
            .map(|(index, object)| {
                let mesh = sharing.mesh_of_object[index];
                let bounds = meshes[mesh as usize].tree.bounds();
                Placed::new((object, index as u32), mesh, sharing.is_alone[index], bounds)
            })
            .collect();
        let tree = WideTree::new(&placed);
        let mut lines = vec![NONE; objects.len()];
        tree.for_each_block(|line, block: &InstanceBlock| lines[block.object as usize] = line);
        Some(Self { tree, meshes, lines })
    }

    /// Number of meshes.
    pub(super) fn meshes(&self) -> usize {
        self.meshes.len()
    }

    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        self.tree.bounds()
    }

    pub(super) fn memory(&self) -> usize {
        let trees = self.meshes.iter().map(|mesh| mesh.tree.memory()).sum::<usize>();
        self.tree.memory() + trees + size_of_val(&*self.lines)
    }

    /// The place of a hit.
    pub(super) fn block(&self, line: u32) -> &InstanceBlock {
        self.tree.leaf(line).0
    }

    /// The place of an object, if it is one of those.
    pub(super) fn of_object(&self, object: u32) -> Option<(u32, &InstanceBlock)> {
        let line = self.lines.get(object as usize).copied().filter(|&line| line != NONE)?;
        Some((line, self.block(line)))
    }

    /// The triangle of a hit, in its place.
    pub(super) fn triangle(&self, hit: &Hit) -> Primitive {
        let block = self.block(hit.instance);
        let (triangles, lane) = self.meshes[block.mesh as usize].tree.leaf(hit.leaf);
        block.placed(&triangles.get(lane))
    }

    /// The nearest hit before the one that is known, of a group if one is asked for.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, group: Option<u32>, known: Option<Hit>) -> Option<Hit> {
        let ray = ray.until(known.map_or(ray.t_max, |hit| hit.t));
        let mut nearest = Nearest { instances: self, ray: &ray, group, hit: known };
        self.tree.traverse(&ray, &mut nearest);
        nearest.hit
    }

    /// Whether anything lies on a segment.
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        self.tree.traverse(ray, &mut Any { instances: self, ray })
    }

    /// Calls `found` for every hit of a group.
    pub(super) fn all_in_group(&self, ray: &Ray, group: u32, found: impl FnMut(Hit)) {
        self.tree.traverse(ray, &mut Every { instances: self, ray, group, found });
    }

    /// The body that an object is by itself; none if others belong to it, or it does not share its mesh.
    pub(super) fn alone(&self, object: u32) -> Option<Alone<'_>> {
        let (line, block) = self.of_object(object).filter(|(_, block)| block.flags & ALONE != 0)?;
        Some(Alone { line, block, shared: &self.meshes[block.mesh as usize] })
    }

    /// Whether walks in an object need nothing of its own but its place.
    pub(super) fn needs_no_group(&self, object: u32) -> bool {
        self.alone(object).is_some_and(|alone| alone.block.flags & SIMILARITY != 0)
    }
}

/// An object that shares its mesh and is a body by itself.
#[derive(Clone, Copy)]
pub(super) struct Alone<'a> {
    line: u32,
    block: &'a InstanceBlock,
    shared: &'a SharedTree,
}

impl Alone<'_> {
    /// The nearest hit with the body.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray) -> Option<Hit> {
        let found = self.shared.tree.closest(&self.block.local_ray(ray, ray.t_max))?;
        Some(self.block.hit(self.line, found))
    }

    /// Lower bound of the distance \[L\] from a point to the surface, by a grid of about so many cells.
    pub(super) fn clearance(&self, point: Vec3, cells: f32) -> f32 {
        let grid = self.shared.clearance.get_or_init(|| {
            let Mesh { positions, triangles, .. } = &*self.shared.mesh;
            let vertices = || triangles.iter().map(|t| t.map(|corner| positions[corner as usize]));
            Clearance::new(vertices, cells)
        });
        let local = grid.at(self.block.local_point(point));
        if local == 0.0 { 0.0 } else { (local * self.block.stretch - self.offset_at(point)).max(0.0) }
    }

    /// Distance \[L\] that clears rounding errors of a point of the body.
    pub(super) fn offset_at(&self, point: Vec3) -> f32 {
        self.block.offset_at(point)
    }

    /// Whether [`crossings`](Self::crossings) can be found.
    pub(super) fn keeps_angles(&self) -> bool {
        self.block.flags & SIMILARITY != 0
    }

    /// See [`Facets::crossings`]: the place keeps angles.
    pub(super) fn crossings(&self, query: &Query, mut found: impl FnMut(Crossing)) {
        let Self { block, shared, .. } = self;
        let facets = shared.facets.get_or_init(|| {
            let facet = |triangle: u32| Facet {
                vertices: Local { mesh: &shared.mesh, triangle }.primitive().vertices,
                triangle: (0, triangle),
            };
            Facets::new((0..shared.mesh.triangles.len() as u32).map(facet).collect())
        });
        let scale = block.stretch;
        let (beyond, area) = match query.beyond {
            Beyond::At(place) => (Beyond::At(block.local_point(place)), scale * scale),
            Beyond::Along(direction) => {
                (Beyond::Along((block.local_from_world * direction).normalize()), 1.0)
            }
        };
        let local =
            Query { from: block.local_point(query.from), beyond, reach: query.reach / scale, ..*query };
        facets.crossings(&local, |crossing| {
            found(Crossing {
                direction: (block.world_from_local * crossing.direction).normalize(),
                distance: crossing.distance * scale,
                spread: crossing.spread * area,
                triangle: (block.object, crossing.triangle.1),
                ..crossing
            });
        });
    }
}

/// Looks for the nearest hit.
struct Nearest<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
    group: Option<u32>,
    hit: Option<Hit>,
}

impl Visitor<InstanceBlock> for Nearest<'_> {
    const IS_ORDERED: bool = true;

    #[inline(always)]
    fn visit(&mut self, ray: &mut BlockRay, block: &InstanceBlock, line: u32) -> bool {
        if self.group.is_some_and(|group| group != block.group) {
            return false;
        }
        let shared = &self.instances.meshes[block.mesh as usize];
        if let Some(found) = shared.tree.closest(&block.local_ray(self.ray, ray.t_max)) {
            ray.t_max = found.0.t;
            self.hit = Some(block.hit(line, found));
        }
        false
    }
}

/// Is content with any hit.
struct Any<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
}

impl Visitor<InstanceBlock> for Any<'_> {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, ray: &mut BlockRay, block: &InstanceBlock, _: u32) -> bool {
        self.instances.meshes[block.mesh as usize].tree.occluded(&block.local_ray(self.ray, ray.t_max))
    }
}

/// Reports every hit of a group.
struct Every<'a, F> {
    instances: &'a Instances,
    ray: &'a Ray,
    group: u32,
    found: F,
}

impl<F: FnMut(Hit)> Visitor<InstanceBlock> for Every<'_, F> {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, ray: &mut BlockRay, block: &InstanceBlock, line: u32) -> bool {
        if block.group == self.group {
            let shared = &self.instances.meshes[block.mesh as usize];
            shared.tree.all(&block.local_ray(self.ray, ray.t_max), |hit, leaf| {
                (self.found)(block.hit(line, (hit, leaf)));
            });
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, EulerRot, Quat};
    use translucid_scene::{Material, Scene, ShapeParameters, build_shape};

    use super::*;
    use crate::ray::{Body, FlightEnd, Geometry, SurfacePoint};

    fn random(i: u32, salt: u32) -> f32 {
        sobol_burley::sample(i, salt, 13)
    }

    fn vector(i: u32, salt: u32) -> Vec3 {
        Vec3::new(random(i, salt), random(i, salt + 1), random(i, salt + 2)) - 0.5
    }

    /// Stretches of the places: turned, larger, mirrored, flat and long.
    const SCALES: [Vec3; 6] = [
        Vec3::ONE,
        Vec3::new(2.0, 2.0, 2.0),
        Vec3::new(-1.0, 1.0, 1.0),
        Vec3::new(0.3, 1.0, 2.5),
        Vec3::new(-1.5, -0.5, -1.0),
        Vec3::new(0.02, 0.02, 0.02),
    ];

    /// A torus in many places, with all that vertices may have, and a sphere of its own.
    fn scene() -> Scene {
        let parameters = ShapeParameters::new().with("segments", 32.0);
        let mut mesh =
            build_shape("torus", &parameters).or_else(|_| build_shape("torus", &ShapeParameters::new()));
        let mesh = mesh.as_mut().expect("a torus");
        mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
        mesh.colors = mesh.positions.iter().map(|p| p.abs().min(Vec3::ONE)).collect();
        let mesh = Arc::new(std::mem::take(mesh));
        let place = |i: u32| {
            let turn = Quat::from_euler(EulerRot::XYZ, 6.0 * random(i, 0), 6.0 * random(i, 1), random(i, 2));
            // Not all by similarity: a shear comes of two scales with a turn between them
            let scale = SCALES[i as usize % SCALES.len()];
            let shear = if i % 4 == 3 { Vec3::new(1.0, 0.6, 1.0) } else { Vec3::ONE };
            let far = if i.is_multiple_of(5) { 50.0 } else { 8.0 };
            Affine3A::from_scale_rotation_translation(shear, Quat::IDENTITY, far * vector(i, 3))
                * Affine3A::from_scale_rotation_translation(scale, turn, Vec3::ZERO)
        };
        let mut objects: Vec<Object> = (0..30)
            .map(|i| Object {
                name: format!("torus {i}"),
                mesh: Arc::clone(&mesh),
                world_from_local: if i == 0 { Affine3A::IDENTITY } else { place(i) },
                material: 0,
                // The last six share a group
                subsurface_group: i.min(24),
            })
            .collect();
        let sphere = build_shape("sphere", &ShapeParameters::new()).expect("a sphere");
        objects.push(Object { mesh: sphere.into(), subsurface_group: 24, ..Object::default() });
        let scene = Scene { objects, materials: vec![Material::default()], ..Scene::default() };
        scene.validate().expect("a valid scene");
        scene
    }

    /// A ray toward one of the objects, from outside or near it.
    fn ray(scene: &Scene, i: u32) -> Ray {
        let object = &scene.objects[i as usize % scene.objects.len()];
        let (low, high) = object.bounds();
        let size = (high - low).length();
        let target = 0.5 * (low + high) + (high - low) * vector(i, 20);
        let origin = target + vector(i, 23).normalize() * size * (0.1 + 3.0 * random(i, 26));
        let length = if i.is_multiple_of(3) { f32::INFINITY } else { size * 4.0 * random(i, 27) };
        Ray::segment(origin, (target - origin).normalize(), length)
    }

    /// Differences of what is the same but for rounding.
    fn assert_same(a: &SurfacePoint, b: &SurfacePoint, error: f32) {
        assert_eq!((a.object, a.group), (b.object, b.group));
        assert!(a.position.distance(b.position) <= error, "{a:?} {b:?} {error}");
        if a.triangle == b.triangle {
            assert!(a.geometric_normal.distance(b.geometric_normal) < 1e-3, "{a:?} {b:?}");
            assert!(a.shading_normal.distance(b.shading_normal) < 2e-3, "{a:?} {b:?}");
            assert!(a.uv.distance(b.uv) < 1e-3 && a.color.distance(b.color) < 1e-3, "{a:?} {b:?}");
        }
    }

    /// What a ray meets among instances is what it meets among their triangles, but where it passes an edge as narrowly as
    /// rounding goes.
    #[test]
    fn instances_are_met_as_their_triangles_are() {
        let scene = scene();
        let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
        assert!(shared.memory() < flat.memory() / 8, "{} {}", shared.memory(), flat.memory());
        let (mut hits, mut differ, mut neighbors) = (0, 0, 0);
        for i in 0..60_000 {
            let ray = ray(&scene, i);
            let group = (i / 7) % 25;
            for query in 0..2 {
                let find = |geometry: &Geometry| match query {
                    0 => geometry.closest(&ray),
                    _ => geometry.closest_in_group(&ray, group),
                };
                let (a, b) = (find(&shared), find(&flat));
                let (Some(a), Some(b)) = (a, b) else {
                    differ += u32::from(a.is_some() != b.is_some());
                    continue;
                };
                hits += 1;
                let (p, q) = (shared.surface_point(&scene, &a), flat.surface_point(&scene, &b));
                if p.object != q.object {
                    differ += 1;
                    continue;
                }
                assert_eq!(shared.object(&a), p.object);
                assert_eq!(shared.object_and_triangle_of(&a), (p.object, p.triangle));
                let grazing = ray.direction.dot(q.geometric_normal).abs().max(1e-2);
                let error = (p.offset + 4.0 * f32::EPSILON * a.t) / grazing;
                if (a.t - b.t).abs() > error {
                    // It passes one of two surfaces at its silhouette
                    differ += 1;
                    continue;
                }
                neighbors += u32::from(p.triangle != q.triangle);
                assert_same(&p, &q, 2.0 * error);
                assert!(shared.normal(&a).distance(p.geometric_normal) < 1e-5);
                assert_eq!(shared.position(&a), p.position);
            }
            differ += u32::from(shared.occluded(&ray) != flat.occluded(&ray));
            let count = |geometry: &Geometry| {
                let mut count = 0;
                geometry.all_in_group(&ray, group, |_| count += 1);
                count
            };
            differ += u32::from(count(&shared) != count(&flat));
        }
        assert!(hits > 30_000, "the test meets too few triangles: {hits}");
        assert!(differ < 30 && neighbors < 100, "{hits} hits, {differ} differ, {neighbors} are beside");
    }

    /// Points that are found by their triangle are as far from rounding errors as those that rays find, and numbers go both
    /// ways.
    #[test]
    fn points_on_instances_are_those_of_their_triangles() {
        let scene = scene();
        let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
        for i in 0..2000 {
            let object = i % scene.objects.len() as u32;
            let triangle =
                (random(i, 30) * scene.objects[object as usize].mesh.triangles.len() as f32) as u32;
            let primitive = shared.primitive(object, triangle);
            assert_eq!(primitive, flat.primitive(object, triangle));
            assert_eq!(shared.object_and_triangle(primitive), (object, triangle));
            let center =
                scene.objects[object as usize].vertices(triangle as usize).iter().sum::<Vec3>() / 3.0;
            let (a, b) =
                (shared.point_on(&scene, primitive, center), flat.point_on(&scene, primitive, center));
            assert_eq!(
                (a.position, a.geometric_normal, a.shading_normal, a.uv),
                (b.position, b.geometric_normal, b.shading_normal, b.uv)
            );
            assert!(a.offset >= b.offset);
        }
    }

    /// No ray that starts at an instance's surface meets it again where it started, and none that starts inside gets out
    /// unseen: flights end where they do among triangles.
    #[test]
    fn flights_in_instances_end_as_those_among_triangles() {
        let scene = scene();
        let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
        let (mut ends, mut differ) = (0, 0);
        for i in 0..40_000 {
            let object = i % 30;
            let triangle =
                (random(i, 30) * scene.objects[object as usize].mesh.triangles.len() as f32) as u32;
            let corners = scene.objects[object as usize].vertices(triangle as usize);
            let (u, v) = (0.6 * random(i, 31), 0.35 * random(i, 32));
            let at = corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
            let direction = vector(i, 33).normalize();
            let (low, high) = scene.objects[object as usize].bounds();
            let length = (high - low).length() * random(i, 36).powi(3);
            let end = |geometry: &Geometry| {
                let point = geometry.point_on(&scene, geometry.primitive(object, triangle), at);
                let body = Body::below(&scene, geometry, &point, 1.0);
                let (start, skipped) = body.enter(&point, direction)?;
                match body.fly(start, direction, length) {
                    FlightEnd::Inside(_) => Some((length + skipped, true)),
                    FlightEnd::Boundary { distance, hit } => {
                        let end = geometry.position(&hit);
                        assert!(
                            body.connects(start, end, body.normal(&hit)) || distance < 10.0 * point.offset
                        );
                        Some((distance + skipped, false))
                    }
                }
            };
            let (Some(a), Some(b)) = (end(&shared), end(&flat)) else { continue };
            ends += u32::from(!b.1);
            let extent = (high - low).max_element();
            let is_same = a.1 == b.1 && (a.0 - b.0).abs() <= 2e-3 * extent;
            differ += u32::from(!is_same);
        }
        // Beside an edge a ray may pass on one side or the other
        assert!(ends > 5000 && differ < 60, "{ends} ends, {differ} differ");
    }

    /// Bounds of the distance are below the distance to every vertex, and not all of them are 0.
    #[test]
    fn clearances_of_instances_are_below_distances() {
        let scene = scene();
        let shared = Geometry::sharing_all(&scene.objects);
        let mut positive = 0;
        for i in 0..4000 {
            let object = i % 24;
            let placed = &scene.objects[object as usize];
            let alone = shared.alone(object).expect("an object alone in its group");
            let (low, high) = placed.bounds();
            let point = 0.5 * (low + high) + (high - low) * vector(i, 20);
            let vertices = 0..placed.mesh.positions.len() as u32;
            let nearest = vertices.map(|v| placed.position(v).distance(point)).fold(f32::INFINITY, f32::min);
            let bound = alone.clearance(point, 1e5);
            assert!(bound <= nearest, "{i}: {bound} {nearest}");
            positive += u32::from(bound > 0.0);
        }
        assert!(positive > 300, "{positive}");
        assert!(shared.alone(26).is_none() && shared.alone(30).is_none());
    }

    /// Ways of refracted light into an instance are those into its triangles.
    #[test]
    fn crossings_of_instances_are_those_of_their_triangles() {
        let scene = scene();
        let (shared, flat) = (Geometry::sharing_all(&scene.objects), Geometry::sharing_none(&scene.objects));
        let (mut found, mut missed) = (0, 0);
        for i in 0..3000 {
            let object = i % 24;
            let placed = &scene.objects[object as usize];
            let triangle = (random(i, 30) * placed.mesh.triangles.len() as f32) as u32;
            let center = placed.vertices(triangle as usize).iter().sum::<Vec3>() / 3.0;
            let (low, high) = placed.bounds();
            let size = (high - low).length();
            let beyond = match i % 2 {
                0 => Beyond::Along(vector(i, 40).normalize()),
                _ => Beyond::At(center + vector(i, 43).normalize() * size * (1.0 + random(i, 46))),
            };
            let crossings = |geometry: &Geometry| {
                let point = geometry.point_on(&scene, geometry.primitive(object, triangle), center);
                let body = Body::below(&scene, geometry, &point, 1.0);
                let (start, _) = body.enter(&point, -point.geometric_normal)?;
                let mut found = Vec::new();
                let reach = size * random(i, 47);
                body.crossings(&scene.objects, (start, reach), beyond, 1.4, |c| {
                    found.push((c, body.end_at(start, &c).is_some()));
                });
                found.sort_by_key(|(crossing, _)| crossing.triangle);
                Some((found, point.offset))
            };
            let (Some((a, offset)), Some((b, _))) = (crossings(&shared), crossings(&flat)) else { continue };
            for (crossing, _) in b.iter().filter(|(_, is_met)| *is_met) {
                let Ok(place) = a.binary_search_by_key(&crossing.triangle, |(other, _)| other.triangle)
                else {
                    missed += 1;
                    continue;
                };
                let same = &a[place].0;
                missed += u32::from(!a[place].1);
                // Facets that are barely below the start are not where they are, relative to their distance
                let error = 1e-3 + 10.0 * offset / crossing.distance;
                assert!(
                    (same.distance / crossing.distance - 1.0).abs() < error,
                    "{i}: {same:?} {crossing:?}"
                );
                assert!(
                    (same.spread / crossing.spread - 1.0).abs() < 20.0 * error,
                    "{i}: {same:?} {crossing:?}"
                );
                assert!(same.direction.distance(crossing.direction) < error, "{i}: {same:?} {crossing:?}");
                found += 1;
            }
        }
        assert!(found > 1000 && missed < found / 100, "{found} found, {missed} missed");
    }

    /// Trees of meshes are kept where other objects are moved.
    #[test]
    fn trees_of_meshes_are_kept() {
        let mut scene = scene();
        let before = Geometry::sharing_all(&scene.objects);
        let moved = Affine3A::from_translation(Vec3::new(100.0, 0.0, 0.0));
        scene.objects[3].world_from_local = moved;
        let old = Instances::new(&scene.objects, &Sharing::new(&scene.objects, |_, _| true), None).unwrap();
        let new =
            Instances::new(&scene.objects, &Sharing::new(&scene.objects, |_, _| true), Some(&old)).unwrap();
        assert!(Arc::ptr_eq(&old.meshes[0], &new.meshes[0]) && new.meshes.len() == 1);
        let after = Geometry::sharing_all(&scene.objects);
        let ray = Ray::new(moved.transform_point3(Vec3::new(0.0, 20.0, 0.75)), Vec3::NEG_Y);
        assert!(after.closest(&ray).is_some_and(|hit| after.object(&hit) == 3));
        assert!(before.closest(&ray).is_none() && before.bounds().1.x < 90.0 && after.bounds().1.x > 100.0);
    }
}
