//! Translucent bodies whose surface has holes.

use std::collections::{HashMap, HashSet};
use std::fmt;
use std::sync::Arc;

use glam::Vec3;

use crate::{Object, Scene, SubsurfaceModel};

/// A translucent body whose surface has edges of one face only, so that it has no inside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OpenBody {
    /// Name of the body's first object.
    pub object: String,
    /// Number of its objects.
    pub objects: usize,
    /// Edges of one face.
    pub open_edges: usize,
    /// All edges.
    pub edges: usize,
}

impl fmt::Display for OpenBody {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { object, objects, open_edges, edges } = self;
        write!(f, "object {object}")?;
        if *objects > 1 {
            write!(f, " and the others of its body")?;
        }
        let share = 100.0 * *open_edges as f64 / *edges as f64;
        let are = if *open_edges == 1 { "edge has" } else { "edges have" };
        write!(
            f,
            ": {open_edges} {are} one face only ({share:.2} % of all): light that gets out through the holes is "
        )?;
        write!(f, "lost, and a walk that finds no surface ends two diagonals of the scene away")
    }
}

impl Scene {
    /// Bodies under whose surfaces random walks find the light, but which are not closed.
    ///
    /// Vertices at the same place are one. The time grows with the number of triangles.
    pub fn open_bodies(&self) -> Vec<OpenBody> {
        let is_walked = |object: &Object| {
            self.materials.get(object.material).is_some_and(|material| {
                material.has_subsurface()
                    && matches!(material.model(&self.integrator), SubsurfaceModel::RandomWalk(_))
            })
        };
        let walked: HashSet<u32> = self
            .objects
            .iter()
            .filter(|object| is_walked(object))
            .map(|object| object.subsurface_group)
            .collect();
        let mut numbers: HashMap<u32, usize> = HashMap::new();
        let mut bodies: Vec<Vec<&Object>> = Vec::new();
        for object in self.objects.iter().filter(|object| walked.contains(&object.subsurface_group)) {
            let number = *numbers.entry(object.subsurface_group).or_insert(bodies.len());
            bodies.resize_with(bodies.len().max(number + 1), Vec::new);
            bodies[number].push(object);
        }
        // Meshes that bodies share are counted once
        let mut known: HashMap<usize, [usize; 2]> = HashMap::new();
        let open_body = |body: Vec<&Object>| {
            let [open_edges, edges] = match *body {
                [object] => *known.entry(Arc::as_ptr(&object.mesh).addr()).or_insert_with(|| count(&body)),
                _ => count(&body),
            };
            let object = body[0].name.clone();
            (open_edges > 0).then_some(OpenBody { object, objects: body.len(), open_edges, edges })
        };
        bodies.into_iter().filter_map(open_body).collect()
    }
}

/// Number of edges of one face, and of all, of objects together.
fn count(objects: &[&Object]) -> [usize; 2] {
    // 0 and −0 are the same place
    let bits = |position: Vec3| (position + 0.0).to_array().map(f32::to_bits);
    let mut places = HashMap::new();
    let mut faces: HashMap<[usize; 2], usize> = HashMap::new();
    for object in objects {
        for triangle in 0..object.mesh.triangles.len() {
            let mut place = |vertex: Vec3| {
                let next = places.len();
                *places.entry(bits(vertex)).or_insert(next)
            };
            let [a, b, c] = object.vertices(triangle).map(&mut place);
            for (from, to) in [(a, b), (b, c), (c, a)].into_iter().filter(|(from, to)| from != to) {
                *faces.entry([from.min(to), from.max(to)]).or_insert(0) += 1;
            }
        }
    }
    [faces.values().filter(|&&count| count == 1).count(), faces.len()]
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::*;
    use crate::{Material, Mesh, ScalarInput, WalkSurface};

    /// A scene of walked tetrahedra, of which each has these faces of its own vertices.
    fn scene(bodies: &[(&[usize], u32)]) -> Scene {
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let object = |&(chosen, subsurface_group): &(&[usize], u32)| {
            let positions =
                chosen.iter().flat_map(|&face| faces[face].map(|corner| corners[corner])).collect();
            let triangles = (0..chosen.len() as u32).map(|face| [0, 1, 2].map(|i| 3 * face + i)).collect();
            let mesh = Mesh { positions, triangles, ..Mesh::default() };
            Object {
                name: format!("of {}", chosen.len()),
                mesh: mesh.into(),
                subsurface_group,
                ..Object::default()
            }
        };
        let material = Material {
            subsurface_weight: ScalarInput::constant(1.0),
            subsurface_model: SubsurfaceModel::RandomWalk(WalkSurface::Diffuse),
            ..Material::default()
        };
        Scene { objects: bodies.iter().map(object).collect(), materials: vec![material], ..Scene::default() }
    }

    #[test]
    fn holes_are_counted_for_each_body() {
        // Closed; without a face; closed by two objects
        let scene = scene(&[(&[0, 1, 2, 3], 0), (&[0, 1, 3], 1), (&[0, 1], 2), (&[2, 3], 2)]);
        let open = scene.open_bodies();
        assert_eq!(open, [OpenBody { object: "of 3".into(), objects: 1, open_edges: 3, edges: 6 }]);
        assert_eq!(
            open[0].to_string(),
            "object of 3: 3 edges have one face only (50.00 % of all): light that gets out through the holes is lost, \
             and a walk that finds no surface ends two diagonals of the scene away"
        );
    }

    #[test]
    fn shared_meshes_and_opaque_bodies_count_as_they_are() {
        let mut scene = scene(&[(&[0], 0), (&[0], 1)]);
        scene.objects[1].mesh = Arc::clone(&scene.objects[0].mesh);
        scene.objects[1].world_from_local = Affine3A::from_translation(Vec3::new(5.0, 0.1, 0.0));
        assert_eq!(scene.open_bodies().len(), 2);
        scene.materials[0].subsurface_weight = ScalarInput::constant(0.0);
        assert!(scene.open_bodies().is_empty());
    }
}
