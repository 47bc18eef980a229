//! Instances: the places of meshes that objects share, as words.
//!
//! ```text
//! instance   rows of three numbers and a word:
//!            0 to 2 columns of the map into the mesh's space, 3 origin in the world, 4 to 6 columns of the map back;
//!            number of the first triangle, place of the mesh's first triangle, root of the mesh's tree, material,
//!            subsurface group, factor on rounding errors far from the origin, -1 of a mirror and 1 of others; 7 nothing
//! ```

use std::collections::HashMap;
use std::sync::Arc;

use glam::Vec3;
use translucid_scene::{Mesh, Object, Scene};

use crate::ray::{MeshSharing, Placement};

/// Words of an instance: those of four nodes, among which it stands.
pub(super) const INSTANCE_WORDS: usize = 32;

/// An object that is a place of a mesh.
pub(super) struct Instance<'a> {
    object: &'a Object,
    /// Number of its mesh.
    pub(super) mesh: usize,
    pub(super) placement: Placement,
}

impl Instance<'_> {
    /// Number of its triangles.
    pub(super) fn triangles(&self) -> u32 {
        self.object.mesh.triangles.len() as u32
    }

    /// Its words: the number of its first triangle is given, and where the triangles and the tree of its mesh begin.
    pub(super) fn words(&self, first: u32, [triangles, root]: [u32; 2]) -> [u32; INSTANCE_WORDS] {
        let Placement { rows, amplification, is_mirrored, .. } = &self.placement;
        let handedness = if *is_mirrored { -1.0_f32 } else { 1.0 };
        let Object { material, subsurface_group, .. } = self.object;
        let (amplification, handedness) = (amplification.to_bits(), handedness.to_bits());
        let behind = [first, triangles, root, *material as u32, *subsurface_group, amplification, handedness];
        let mut words = [0; INSTANCE_WORDS];
        for ((row, vector), word) in words.as_chunks_mut::<4>().0.iter_mut().zip(rows).zip(behind) {
            let [x, y, z] = vector.to_array().map(f32::to_bits);
            *row = [x, y, z, word];
        }
        words
    }
}

/// The objects of a scene: those whose triangles are in the world, and those that are places of shared meshes.
#[derive(Default)]
pub(super) struct Sharing<'a> {
    /// Numbers of the objects in the world.
    pub(super) apart: Vec<u32>,
    pub(super) instances: Vec<Instance<'a>>,
    pub(super) meshes: Vec<&'a Arc<Mesh>>,
}

impl<'a> Sharing<'a> {
    /// Objects share what they share on the processor, or whatever they can where memory is `tight`; not those that `stay` in
    /// the world: they emit, so that their triangles are lights, or distances to their triangles are asked for.
    pub(super) fn new(scene: &'a Scene, is_tight: bool, stay: impl Fn(u32) -> bool) -> Self {
        let should_share = |mesh: &Mesh, uses| is_tight || mesh.is_worth_sharing(uses);
        let sharing = MeshSharing::new(&scene.objects, should_share);
        let mut new = Self::default();
        let mut known: HashMap<u32, (usize, (Vec3, Vec3))> = HashMap::new();
        for (index, object) in (0..).zip(&scene.objects) {
            let shared = sharing.mesh_of(index as usize);
            match shared.filter(|_| !object.mesh.triangles.is_empty() && !stay(index)) {
                None => new.apart.push(index),
                Some(number) => {
                    let (mesh, bounds) = *known.entry(number).or_insert_with(|| {
                        new.meshes.push(&object.mesh);
                        (new.meshes.len() - 1, object.mesh.bounds())
                    });
                    new.instances.push(Instance { object, mesh, placement: Placement::new(object, bounds) });
                }
            }
        }
        new
    }
}
