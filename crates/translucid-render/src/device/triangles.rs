//! The triangles of a scene in the order of the leaves of a binary tree, with their attributes.

use glam::{Vec2, Vec3, Vec4};
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use translucid_scene::{Object, Scene, SceneError};

use super::limits::DeviceLimits;
use crate::ray::BinaryBuilder;

/// Words of a node: lowest corner, number of triangles (0: an inner node), highest corner, first child or triangle.
pub(super) const NODE_WORDS: u64 = 8;
/// Words of a triangle: three corners, and behind them the material, the number as a light, and the subsurface group.
pub(super) const TRIANGLE_WORDS: u64 = 12;
/// The number of a triangle that is no light.
pub(super) const NO_LIGHT: u32 = u32::MAX;

/// Attributes of a triangle: three normals, then what the scene's materials need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AttributeLayout {
    /// Words of a triangle.
    pub(super) stride: u32,
    /// Where the texture coordinates of the corners begin; 0 if there are none.
    pub(super) uv: u32,
    /// Where the tangent and its sign begin; 0 if there are none.
    pub(super) tangent: u32,
    /// Where the colors of the corners begin; 0 if there are none.
    pub(super) color: u32,
}

impl AttributeLayout {
    fn new(scene: &Scene) -> Self {
        let mut stride = 9;
        let mut take = |is_needed: bool, words: u32| {
            let at = stride;
            stride += if is_needed { words } else { 0 };
            if is_needed { at } else { 0 }
        };
        let has = |is_there: fn(&Object) -> bool| scene.objects.iter().any(is_there);
        let uv = take(!scene.images.is_empty() && has(|object| !object.mesh.uvs.is_empty()), 6);
        let has_maps = scene.materials.iter().any(|material| material.geometry_normal.is_some());
        let tangent = take(has_maps, 4);
        let color = take(has(|object| !object.mesh.colors.is_empty()), 9);
        Self { stride, uv, tangent, color }
    }
}

/// Nodes, triangles and attributes.
pub(super) struct Triangles {
    pub(super) nodes: Vec<u32>,
    pub(super) triangles: Vec<u32>,
    pub(super) attributes: Vec<f32>,
    pub(super) layout: AttributeLayout,
}

impl Triangles {
    /// The triangles of all objects in their places.
    ///
    /// `light_of` gives the number of an object's triangle among the lights.
    pub(super) fn new(
        scene: &Scene,
        limits: &DeviceLimits,
        light_of: impl Fn(u32, u32) -> Option<u32>,
    ) -> Result<Self, SceneError> {
        let layout = AttributeLayout::new(scene);
        let count: u64 = scene.objects.iter().map(|object| object.mesh.triangles.len() as u64).sum();
        let words = (2 * NODE_WORDS).max(TRIANGLE_WORDS).max(layout.stride.into());
        limits.check("triangles, those of shared meshes counted once for each object,", count, 4 * words)?;
        let places: Vec<(u32, u32)> = (0..)
            .zip(&scene.objects)
            .flat_map(|(index, object)| {
                (0..object.mesh.triangles.len() as u32).map(move |number| (index, number))
            })
            .collect();
        let boxes: Vec<_> = places
            .par_iter()
            .map(|&(object, number)| {
                let [a, b, c] = scene.objects[object as usize].vertices(number as usize);
                Triangle { v0: a.into(), v1: b.into(), v2: c.into() }.aabb()
            })
            .collect();
        let mut builder = BinaryBuilder::default();
        if !boxes.is_empty() {
            builder.build(&boxes);
        }
        let (nodes, order) = builder.into_parts();
        let nodes = nodes.iter().flat_map(|node| {
            let [low, high] = [node.aabb().min, node.aabb().max];
            [
                low.x.to_bits(),
                low.y.to_bits(),
                low.z.to_bits(),
                node.prim_count,
                high.x.to_bits(),
                high.y.to_bits(),
                high.z.to_bits(),
                node.first_index,
            ]
        });
        let mut new = Self {
            nodes: nodes.collect(),
            triangles: Vec::with_capacity(places.len() * TRIANGLE_WORDS as usize),
            attributes: Vec::with_capacity(places.len() * layout.stride as usize),
            layout,
        };
        for &number in &order {
            let (object, triangle) = places[number as usize];
            let light = light_of(object, triangle).unwrap_or(NO_LIGHT);
            new.push(&scene.objects[object as usize], triangle, light);
        }
        Ok(new)
    }

    /// Places of the triangles that are lights, with their materials and numbers as lights.
    pub(super) fn lights(&self) -> impl Iterator<Item = (usize, usize, u32)> {
        let triangles = self.triangles.as_chunks::<{ TRIANGLE_WORDS as usize }>().0.iter().enumerate();
        let all = triangles.map(|(place, words)| (place, words[3] as usize, words[7]));
        all.filter(|&(_, _, light)| light != NO_LIGHT)
    }

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
            self.attributes.extend(tangent(object, corners).to_array());
        }
        if self.layout.color > 0 {
            let color = |corner: u32| mesh.colors.get(corner as usize).copied().unwrap_or(Vec3::ONE);
            self.attributes.extend(corners.into_iter().flat_map(|corner| color(corner).to_array()));
        }
    }
}

/// Tangent along u, before it is made perpendicular to the shading normal, and the sign of the bitangent; 0 where there is
/// none. See `surface::shading_normal_at`.
fn tangent(object: &Object, corners: [u32; 3]) -> Vec4 {
    let mesh = &object.mesh;
    if !mesh.tangents.is_empty() {
        let sum = corners.into_iter().map(|corner| object.tangent(corner)).sum::<Vec4>();
        return sum.truncate().extend(sum.w.signum());
    }
    if mesh.uvs.is_empty() {
        return Vec4::ZERO;
    }
    let [p, q, r] = corners.map(|corner| object.position(corner));
    let [s, t, u] = corners.map(|corner| mesh.uvs[corner as usize]);
    let (first, second) = (t - s, u - s);
    let sign = first.perp_dot(second).signum();
    (((q - p) * second.y - (r - p) * first.y) * sign).extend(sign)
}
