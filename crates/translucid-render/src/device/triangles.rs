//! The triangles of a scene in the order of the leaves of a binary tree, with their attributes; those of meshes that objects
//! share once, below a tree of their own.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};
use obvhs::Boundable;
use obvhs::aabb::Aabb;
use rayon::prelude::*;
use translucid_scene::{Mesh, Object, Scene, SceneError};

use super::instances::{INSTANCE_WORDS, Instance, Sharing};
use super::limits::DeviceLimits;
use super::tree::{DeviceTrees, Tree};
use crate::ray::Primitive;

/// Words of a node: lowest corner, number of triangles (0: an inner node, 2³² − 1: an instance), highest corner, first child or
/// triangle, or the instance.
pub(super) const NODE_WORDS: u64 = 8;
/// Words of a triangle: three corners, and behind them the material, the number as a light, and the subsurface group, of which
/// those of an instance count in its place.
pub(super) const TRIANGLE_WORDS: u64 = 12;
/// The number of a triangle that is no light.
pub(super) const NO_LIGHT: u32 = u32::MAX;

/// Number of triangles of a node that stands for an instance, whose number is that of the first triangle.
const AN_INSTANCE: u32 = u32::MAX;
/// Greatest height of a tree and those of the meshes below it: as many nodes may wait on the way down.
pub(super) const MOST_LEVELS: u32 = 64;

/// Attributes of a triangle: three normals, then what the scene's materials need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AttributeLayout {
    /// Words of a triangle.
    pub(super) stride: u32,
    /// Where the texture coordinates of the corners begin; 0 if there are none.
    pub(super) uv: u32,
    /// Where the tangent, its sign and two more tangents begin; 0 if there are none.
    pub(super) tangent: u32,
    /// Tangents of a triangle, whose sum counts: one, or those of the corners, each of which a place makes a unit vector anew.
    pub(super) tangents: u32,
    /// Where the colors of the corners begin; 0 if there are none.
    pub(super) color: u32,
}

impl AttributeLayout {
    fn new(scene: &Scene, shared: &[&Arc<Mesh>]) -> Self {
        let mut stride = 9;
        let mut take = |is_needed: bool, words: u32| {
            let at = stride;
            stride += if is_needed { words } else { 0 };
            if is_needed { at } else { 0 }
        };
        let has = |is_there: fn(&Object) -> bool| scene.objects.iter().any(is_there);
        let uv = take(!scene.images.is_empty() && has(|object| !object.mesh.uvs.is_empty()), 6);
        let has_maps = scene.materials.iter().any(|material| material.geometry_normal.is_some());
        let tangents = if shared.iter().any(|mesh| !mesh.tangents.is_empty()) { 3 } else { 1 };
        let tangent = take(has_maps, 3 * tangents + 1);
        let color = take(has(|object| !object.mesh.colors.is_empty()), 9);
        Self { stride, uv, tangent, tangents, color }
    }

    /// Words that a triangle takes at most in one of the arrays.
    fn most_words(&self) -> u64 {
        (2 * NODE_WORDS).max(TRIANGLE_WORDS).max(self.stride.into())
    }
}

/// Nodes, triangles and attributes.
pub(super) struct Triangles {
    /// The words of instances, then the tree over triangles in the world and instances, then those of shared meshes.
    pub(super) nodes: Vec<u32>,
    /// The triangles in the world, then those of each shared mesh in its own space.
    pub(super) triangles: Vec<u32>,
    pub(super) attributes: Vec<f32>,
    pub(super) layout: AttributeLayout,
    /// Number of instances.
    pub(super) instances: usize,
}

impl Triangles {
    /// The triangles of all objects in their places.
    ///
    /// `stays` says whether an object is in the world in any case, and `light_of` gives the number of a triangle of it among the
    /// lights. Trees that are kept are not built anew.
    pub(super) fn new(
        scene: &Scene,
        limits: &DeviceLimits,
        stays: impl Fn(u32) -> bool,
        light_of: impl Fn(u32, u32) -> Option<u32>,
        kept: &mut DeviceTrees,
    ) -> Result<Self, SceneError> {
        let (sharing, layout, [stored, words]) = sorted(scene, limits, stays)?;
        let Sharing { apart, instances, meshes } = sharing;
        let of = |&object: &u32| {
            let triangles = scene.objects[object as usize].mesh.triangles.len() as u32;
            (0..triangles).map(move |number| (object, number))
        };
        let places: Vec<(u32, u32)> = apart.iter().flat_map(of).collect();
        let in_world = |&(object, number): &(u32, u32)| {
            triangle_box(scene.objects[object as usize].vertices(number as usize), number)
        };
        let mut boxes: Vec<Aabb> = places.par_iter().map(in_world).collect();
        boxes.extend(instances.iter().map(|instance| instance.placement.aabb));
        let of_meshes = meshes.iter().map(|mesh| mesh_boxes(mesh));
        let boxes: Vec<Vec<Aabb>> = std::iter::once(boxes).chain(of_meshes).collect();
        let trees = kept.over(&boxes);
        let (world, trees) = (&trees[0], &trees[1..]);
        let levels = world.height() + trees.iter().map(|tree| tree.height()).max().unwrap_or(0);
        let waiting = DeviceLimits { array_bytes: MOST_LEVELS.into() };
        waiting.check("levels of boxes around its triangles", levels.into(), 1)?;

        let mut new = Self {
            nodes: Vec::with_capacity(words),
            triangles: Vec::with_capacity(stored * TRIANGLE_WORDS as usize),
            attributes: Vec::with_capacity(stored * layout.stride as usize),
            layout,
            instances: instances.len(),
        };
        new.nodes.resize(INSTANCE_WORDS * instances.len(), 0);
        let mut leaves = Vec::with_capacity(boxes[0].len());
        for number in &world.order {
            if let Some(&(object, triangle)) = places.get(*number as usize) {
                leaves.push([1, new.count()]);
                let light = light_of(object, triangle).unwrap_or(NO_LIGHT);
                new.push(&scene.objects[object as usize], triangle, light);
            } else {
                leaves.push([AN_INSTANCE, number - places.len() as u32]);
            }
        }
        new.push_nodes(world, |leaf| leaves[leaf as usize]);
        new.push_meshes(&meshes, trees, &instances);
        Ok(new)
    }

    /// Appends shared meshes with their trees, and states the words of their instances.
    fn push_meshes(&mut self, meshes: &[&Arc<Mesh>], trees: &[Arc<Tree>], instances: &[Instance<'_>]) {
        let mut first = self.count();
        let mut starts = Vec::with_capacity(meshes.len());
        for (mesh, tree) in meshes.iter().zip(trees) {
            let start = self.count();
            starts.push([start, self.push_nodes(tree, |leaf| [1, start + leaf])]);
            let object = Object { mesh: Arc::clone(mesh), ..Object::default() };
            tree.order.iter().for_each(|&triangle| self.push(&object, triangle, NO_LIGHT));
        }
        for (words, instance) in self.nodes.as_chunks_mut().0.iter_mut().zip(instances) {
            *words = instance.words(first, starts[instance.mesh]);
            first += instance.triangles();
        }
    }

    /// Number of triangles so far.
    fn count(&self) -> u32 {
        (self.triangles.len() as u64 / TRIANGLE_WORDS) as u32
    }

    /// Appends a tree, whose root's place it returns; `leaf` gives the number of triangles of a leaf, and the first one.
    fn push_nodes(&mut self, tree: &Tree, leaf: impl Fn(u32) -> [u32; 2]) -> u32 {
        let root = (self.nodes.len() as u64 / NODE_WORDS) as u32;
        for node in &tree.nodes {
            let [count, first] =
                if node.is_leaf() { leaf(node.first_index) } else { [0, root + node.first_index] };
            let [low, high] = [node.aabb().min, node.aabb().max];
            let words =
                [[low.x, low.y, low.z], [high.x, high.y, high.z]].map(|corner| corner.map(f32::to_bits));
            for ([x, y, z], word) in words.into_iter().zip([count, first]) {
                self.nodes.extend([x, y, z, word]);
            }
        }
        root
    }

    /// Places of the triangles that are lights, with their materials and numbers as lights.
    pub(super) fn lights(&self) -> impl Iterator<Item = (usize, usize, u32)> {
        let triangles = self.triangles.as_chunks::<{ TRIANGLE_WORDS as usize }>().0.iter().enumerate();
        let all = triangles.map(|(place, words)| (place, words[3] as usize, words[7]));
        all.filter(|&(_, _, light)| light != NO_LIGHT)
    }

    /// Appends a triangle of an object in its place, which is the mesh's own space if the mesh is shared.
    fn push(&mut self, object: &Object, triangle: u32, light: u32) {
        let vertices = object.vertices(triangle as usize);
        let behind = [object.material as u32, light, object.subsurface_group];
        for (corner, word) in vertices.iter().zip(behind) {
            self.triangles.extend(corner.to_array().map(f32::to_bits));
            self.triangles.push(word);
        }
        let mesh = &object.mesh;
        let corners = object.corners(triangle as usize);
        let [a, b, c] = vertices;
        let geometric = (b - a).cross(c - a).normalize_or(Vec3::Z);
        let normal = |corner| if mesh.normals.is_empty() { geometric } else { object.normal(corner) };
        self.attributes.extend(corners.into_iter().flat_map(|corner| normal(corner).to_array()));
        let uv = |corner: u32| mesh.uvs.get(corner as usize).copied().unwrap_or(Vec2::ZERO);
        if self.layout.uv > 0 {
            self.attributes.extend(corners.into_iter().flat_map(|corner| uv(corner).to_array()));
        }
        if self.layout.tangent > 0 {
            let (tangents, sign) = tangents(object, corners);
            let sum = tangents.into_iter().sum::<Vec3>();
            let is_each = self.layout.tangents == 3;
            self.attributes.extend(if is_each { tangents[0] } else { sum }.extend(sign).to_array());
            let others = if is_each { &tangents[1..] } else { &[] };
            self.attributes.extend(others.iter().flat_map(|tangent| tangent.to_array()));
        }
        if self.layout.color > 0 {
            let color = |corner: u32| mesh.colors.get(corner as usize).copied().unwrap_or(Vec3::ONE);
            self.attributes.extend(corners.into_iter().flat_map(|corner| color(corner).to_array()));
        }
    }
}

/// The objects of a scene, the attributes of triangles, the number of these, and that of the words of nodes, as far as a device
/// has room for them.
fn sorted<'a>(
    scene: &'a Scene,
    limits: &DeviceLimits,
    stays: impl Fn(u32) -> bool,
) -> Result<(Sharing<'a>, AttributeLayout, [usize; 2]), SceneError> {
    let all: u64 = scene.objects.iter().map(|object| object.mesh.triangles.len() as u64).sum();
    DeviceLimits { array_bytes: u32::MAX.into() }.check("triangles in all places", all, 1)?;
    let is_tight = all > limits.array_bytes / (4 * AttributeLayout::new(scene, &[]).most_words());
    let sharing = Sharing::new(scene, is_tight, stays);
    let layout = AttributeLayout::new(scene, &sharing.meshes);
    let in_world = sharing.apart.iter().map(|&object| scene.objects[object as usize].mesh.triangles.len());
    let stored: usize = in_world.chain(sharing.meshes.iter().map(|mesh| mesh.triangles.len())).sum();
    let what = "triangles, those of shared meshes counted once,";
    limits.check(what, stored as u64, 4 * layout.most_words())?;
    let instances = sharing.instances.len();
    let words = 2 * NODE_WORDS as usize * (stored + instances) + INSTANCE_WORDS * instances;
    limits.check("bytes of instances and boxes", 4 * words as u64, 1)?;
    Ok((sharing, layout, [stored, words]))
}

/// The box of a triangle of a number, with the processor's room for rounding errors.
fn triangle_box(vertices: [Vec3; 3], triangle: u32) -> Aabb {
    Primitive { vertices, object: 0, triangle, group: 0 }.aabb()
}

fn mesh_boxes(mesh: &Mesh) -> Vec<Aabb> {
    let box_of = |(corners, triangle): (&[u32; 3], u32)| {
        triangle_box(corners.map(|corner| mesh.positions[corner as usize]), triangle)
    };
    mesh.triangles.par_iter().zip(0..mesh.triangles.len() as u32).map(box_of).collect()
}

/// Tangents along u, whose sum counts before it is made perpendicular to the shading normal, and the sign of the bitangent; 0
/// where there is none. See `surface::shading_normal_at`.
fn tangents(object: &Object, corners: [u32; 3]) -> ([Vec3; 3], f32) {
    let mesh = &object.mesh;
    if !mesh.tangents.is_empty() {
        let all = corners.map(|corner| object.tangent(corner));
        return (all.map(Vec4::truncate), all.into_iter().map(|tangent| tangent.w).sum::<f32>().signum());
    }
    let mut found = [Vec3::ZERO; 3];
    if mesh.uvs.is_empty() {
        return (found, 0.0);
    }
    let [p, q, r] = corners.map(|corner| object.position(corner));
    let [s, t, u] = corners.map(|corner| mesh.uvs[corner as usize]);
    let (first, second) = (t - s, u - s);
    let sign = first.perp_dot(second).signum();
    found[0] = ((q - p) * second.y - (r - p) * first.y) * sign;
    (found, sign)
}
