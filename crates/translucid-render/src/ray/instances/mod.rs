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
use super::facets::{Crossing, Facet, Facets, LightOrigin, Query};
use super::hit::{Hit, offset_at};
use super::primitive::{Block, BlockNeeds, Primitive, PrimitiveSource};
use super::simd::SimdToken;
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
    /// Factor on the rounding errors of coordinates as far from the origin: greatest row sum of |A||A⁻¹|.
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

/// A mesh with its tree, and with the clearance and facets that walks need.
pub(super) struct SharedTree {
    mesh: Arc<Mesh>,
    tree: WideTree,
    clearance: OnceLock<Clearance>,
    facets: OnceLock<Facets>,
}

impl SharedTree {
    fn new(mesh: &Arc<Mesh>) -> Self {
        let triangles: Vec<LocalTriangle<'_>> =
            (0..mesh.triangles.len() as u32).map(|triangle| LocalTriangle { mesh, triangle }).collect();
        let tree = WideTree::new(&triangles);
        Self { mesh: Arc::clone(mesh), tree, clearance: OnceLock::new(), facets: OnceLock::new() }
    }
}

/// A triangle of a mesh in its own space.
#[derive(Clone, Copy)]
struct LocalTriangle<'a> {
    mesh: &'a Mesh,
    triangle: u32,
}

impl LocalTriangle<'_> {
    fn primitive(&self) -> Primitive {
        let corners = self.mesh.triangles[self.triangle as usize];
        let vertices = corners.map(|corner| self.mesh.positions[corner as usize]);
        Primitive { vertices, object: 0, triangle: self.triangle, group: 0 }
    }
}

impl Boundable for LocalTriangle<'_> {
    fn aabb(&self) -> Aabb {
        self.primitive().aabb()
    }
}

impl PrimitiveSource for LocalTriangle<'_> {
    type Block = TriangleBlock;

    fn needs(&self) -> Option<BlockNeeds> {
        Some(BlockNeeds::triangle(0, self.mesh.triangles[self.triangle as usize]))
    }

    fn place(&self) -> Vec3 {
        self.mesh.positions[self.mesh.triangles[self.triangle as usize][0] as usize]
    }

    fn put(&self, block: &mut TriangleBlock, lane: usize) -> u32 {
        block.set(lane, &self.primitive());
        self.triangle
    }
}

/// An object to be sorted into the tree over places.
struct PlacedObject<'a> {
    object: &'a Object,
    number: u32,
    mesh: u32,
    is_alone: bool,
    low: Vec3,
    high: Vec3,
}

impl<'a> PlacedObject<'a> {
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
        let room = block.offset_at(low).max(block.offset_at(high));
        Self { object, number, mesh, is_alone, low: low - room, high: high + room }
    }
}

impl Boundable for PlacedObject<'_> {
    fn aabb(&self) -> Aabb {
        Aabb::new(self.low.into(), self.high.into())
    }
}

impl PrimitiveSource for PlacedObject<'_> {
    type Block = InstanceBlock;

    fn needs(&self) -> Option<BlockNeeds> {
        None
    }

    fn place(&self) -> Vec3 {
        self.low
    }

    fn put(&self, block: &mut InstanceBlock, _: usize) -> u32 {
        *block = InstanceBlock::new(self.object, self.number, self.mesh, self.is_alone);
        self.number
    }
}

/// A place of a mesh, for devices that trace it there themselves.
pub(crate) struct Placement {
    /// Columns of the map into the mesh's space, its origin in the world, and columns of the map back.
    pub(crate) rows: [Vec3; 7],
    /// Factor on the rounding errors of coordinates as far from the origin.
    pub(crate) amplification: f32,
    /// Whether the place mirrors the mesh.
    pub(crate) is_mirrored: bool,
    /// A box around the mesh there, with room for rounding errors.
    pub(crate) aabb: Aabb,
}

impl Placement {
    /// The place of an object whose mesh has these bounds.
    pub(crate) fn new(object: &Object, bounds: (Vec3, Vec3)) -> Self {
        let InstanceBlock { local_from_world, origin, world_from_local, amplification, flags, .. } =
            InstanceBlock::new(object, 0, 0, false);
        let [a, b, c] = [local_from_world.x_axis, local_from_world.y_axis, local_from_world.z_axis];
        let [x, y, z] = [world_from_local.x_axis, world_from_local.y_axis, world_from_local.z_axis];
        Self {
            rows: [a, b, c, origin, x, y, z],
            amplification,
            is_mirrored: flags & MIRRORED != 0,
            aabb: PlacedObject::new((object, 0), 0, false, bounds).aabb(),
        }
    }
}

/// The objects of a scene that share their meshes.
pub(crate) struct MeshSharing {
    /// Number of each object's mesh among the shared ones; `NONE` where it is not.
    mesh_of_object: Vec<u32>,
    /// The first object of each mesh.
    first_objects: Vec<usize>,
    /// For each object, `true` if it is alone in its group.
    is_alone: Vec<bool>,
}

/// The number of no mesh or block.
pub(super) const NONE: u32 = u32::MAX;

impl MeshSharing {
    /// Finds objects whose meshes have enough uses and can be traced in their own space.
    pub(crate) fn new(objects: &[Object], should_share: impl Fn(&Mesh, usize) -> bool) -> Self {
        let mut uses: HashMap<usize, usize> = HashMap::new();
        let address = |object: &Object| Arc::as_ptr(&object.mesh).addr();
        for object in objects {
            *uses.entry(address(object)).or_insert(0) += 1;
        }
        let is_shared = |object: &Object| {
            let uses = uses[&address(object)];
            let is_wanted = object.is_movable || uses > 1 && should_share(&object.mesh, uses);
            is_wanted && object.can_be_instanced()
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

    /// Returns `true` if an object is in the tree over places.
    pub(super) fn is_shared(&self, object: usize) -> bool {
        self.mesh_of(object).is_some()
    }

    /// Number of an object's mesh among the shared ones.
    pub(crate) fn mesh_of(&self, object: usize) -> Option<u32> {
        Some(self.mesh_of_object[object]).filter(|&mesh| mesh != NONE)
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
    pub(super) fn new(objects: &[Object], sharing: &MeshSharing, old: Option<&Self>) -> Option<Self> {
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
        let placed: Vec<PlacedObject<'_>> = objects
            .par_iter()
            .enumerate()
            .filter(|(index, _)| sharing.is_shared(*index))
            .map(|(index, object)| {
                let mesh = sharing.mesh_of_object[index];
                let bounds = meshes[mesh as usize].tree.bounds();
                PlacedObject::new((object, index as u32), mesh, sharing.is_alone[index], bounds)
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
        block.placed(&self.meshes[block.mesh as usize].tree.triangle(hit.leaf))
    }

    /// The nearest hit before the one that is known, of a group if one is asked for.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, group: Option<u32>, known: Option<Hit>) -> Option<Hit> {
        let ray = ray.until(known.map_or(ray.t_max, |hit| hit.t));
        let mut nearest = NearestInstance { instances: self, ray: &ray, group, hit: known };
        self.tree.traverse(&ray, &mut nearest);
        nearest.hit
    }

    /// Returns `true` if anything lies on a segment.
    pub(super) fn occluded(&self, ray: &Ray) -> bool {
        self.tree.traverse(ray, &mut AnyInstance { instances: self, ray })
    }

    /// Calls `found` for every hit of a group.
    pub(super) fn all_in_group(&self, ray: &Ray, group: u32, found: impl FnMut(Hit)) {
        self.tree.traverse(ray, &mut EveryInstance { instances: self, ray, group, found });
    }

    /// The body that an object forms on its own; `None` if others belong to it, or the object does not share its mesh.
    pub(super) fn alone(&self, object: u32) -> Option<LoneInstance<'_>> {
        let (line, block) = self.of_object(object).filter(|(_, block)| block.flags & ALONE != 0)?;
        Some(LoneInstance { line, block, shared: &self.meshes[block.mesh as usize] })
    }

    /// Returns `true` if walks in an object need only its place besides its mesh.
    pub(super) fn needs_no_group(&self, object: u32) -> bool {
        self.alone(object).is_some_and(|alone| alone.block.flags & SIMILARITY != 0)
    }
}

/// An object that shares its mesh and is a body by itself.
#[derive(Clone, Copy)]
pub(super) struct LoneInstance<'a> {
    line: u32,
    block: &'a InstanceBlock,
    shared: &'a SharedTree,
}

impl<'a> LoneInstance<'a> {
    /// The facets of the mesh, in its own space.
    pub(super) fn facets(&self) -> &'a Facets {
        let shared = self.shared;
        shared.facets.get_or_init(|| {
            let facet = |triangle: u32| Facet {
                vertices: LocalTriangle { mesh: &shared.mesh, triangle }.primitive().vertices,
                triangle: (0, triangle),
            };
            Facets::new((0..shared.mesh.triangles.len() as u32).map(facet).collect())
        })
    }

    /// The nearest hit with the body.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray) -> Option<Hit> {
        let found = self.shared.tree.closest(&self.block.local_ray(ray, ray.t_max))?;
        Some(self.block.hit(self.line, found))
    }

    /// Lower bound of the distance \[L\] from a point to the surface, by a grid of about so many cells.
    pub(super) fn clearance(&self, point: Vec3, cells: f32) -> f32 {
        let local = self.grid(cells).at(self.block.local_point(point));
        if local == 0.0 { 0.0 } else { (local * self.block.stretch - self.offset_at(point)).max(0.0) }
    }

    /// 1 where the surface is closed and looks out, -1 where it looks in, else 0; `cells` as for
    /// [`clearance`](Self::clearance).
    pub(super) fn orientation(&self, cells: f32) -> f32 {
        self.grid(cells).orientation
    }

    fn grid(&self, cells: f32) -> &Clearance {
        self.shared.clearance.get_or_init(|| {
            let Mesh { positions, triangles, .. } = &*self.shared.mesh;
            let vertices = || triangles.iter().map(|t| t.map(|corner| positions[corner as usize]));
            Clearance::new(vertices, cells)
        })
    }

    /// Distance \[L\] that clears rounding errors of a point of the body.
    pub(super) fn offset_at(&self, point: Vec3) -> f32 {
        self.block.offset_at(point)
    }

    /// Returns `true` if [`crossings`](Self::crossings) can be found.
    pub(super) fn keeps_angles(&self) -> bool {
        self.block.flags & SIMILARITY != 0
    }

    /// Distance \[L\] from a point to the nearest of the body's facets, or `reach`: the place keeps angles.
    pub(super) fn distance(&self, facets: &Facets, point: Vec3, reach: f32) -> f32 {
        facets.distance(self.block.local_point(point), reach / self.block.stretch) * self.block.stretch
    }

    /// See [`Facets::crossings`]: the place keeps angles.
    pub(super) fn crossings(&self, query: &Query, mut found: impl FnMut(Crossing)) {
        let (block, facets) = (self.block, self.facets());
        let scale = block.stretch;
        let (beyond, area) = match query.beyond {
            LightOrigin::At(place) => (LightOrigin::At(block.local_point(place)), scale * scale),
            LightOrigin::Along(direction) => {
                (LightOrigin::Along((block.local_from_world * direction).normalize()), 1.0)
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

/// Finds the nearest hit.
struct NearestInstance<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
    group: Option<u32>,
    hit: Option<Hit>,
}

impl Visitor<InstanceBlock> for NearestInstance<'_> {
    const IS_ORDERED: bool = true;

    #[inline(always)]
    fn visit(&mut self, _: impl SimdToken, ray: &mut BlockRay, block: &InstanceBlock, line: u32) -> bool {
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

/// Stops at any hit.
struct AnyInstance<'a> {
    instances: &'a Instances,
    ray: &'a Ray,
}

impl Visitor<InstanceBlock> for AnyInstance<'_> {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, _: impl SimdToken, ray: &mut BlockRay, block: &InstanceBlock, _: u32) -> bool {
        self.instances.meshes[block.mesh as usize].tree.occluded(&block.local_ray(self.ray, ray.t_max))
    }
}

/// Reports every hit of a group.
struct EveryInstance<'a, F> {
    instances: &'a Instances,
    ray: &'a Ray,
    group: u32,
    found: F,
}

impl<F: FnMut(Hit)> Visitor<InstanceBlock> for EveryInstance<'_, F> {
    const IS_ORDERED: bool = false;

    #[inline(always)]
    fn visit(&mut self, _: impl SimdToken, ray: &mut BlockRay, block: &InstanceBlock, line: u32) -> bool {
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
mod tests;
