//! A mesh on its way to the places where it is used.

use std::sync::Arc;

use crate::result::Result;

use glam::{Affine3A, Vec3};
use translucid_scene::{Mesh, Object, Place, Warning, repair_mesh};

/// A mesh of several uses, in its own space.
#[derive(Clone, Debug)]
pub(super) struct SharedMesh {
    mesh: Arc<Mesh>,
    /// See [`Mesh::flattest`]; none where it is not worth sharing, and not repaired either: it is baked for each use.
    flattest: Option<[f64; 2]>,
    bounds: (Vec3, Vec3),
}

impl SharedMesh {
    /// A mesh of so many uses, repaired if they share it.
    pub(super) fn new(
        mut mesh: Arc<Mesh>,
        uses: usize,
        place: &Place,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self> {
        let is_shared = mesh.is_worth_sharing(uses);
        // As it is when it is baked; a copy of what a file keeps is made where it must be
        if is_shared && (Arc::get_mut(&mut mesh).is_some() || mesh.validate().is_err()) {
            repair_mesh(Arc::make_mut(&mut mesh), place, warnings)?;
        }
        Ok(Self { flattest: is_shared.then(|| mesh.flattest()), bounds: mesh.bounds(), mesh })
    }

    /// The mesh in its own space.
    pub(super) fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    /// Returns `true` if it is worth sharing.
    pub(super) fn is_shared(&self) -> bool {
        self.flattest.is_some()
    }

    /// A nameless object that shares the mesh; none where its place, or the mesh, has to be baked.
    pub(super) fn placed(&self, world_from_local: &Affine3A) -> Option<Object> {
        let flattest = self.flattest?;
        let world_from_local = *world_from_local;
        let object = Object { mesh: Arc::clone(&self.mesh), world_from_local, ..Object::default() };
        object.check_place(|| flattest, self.bounds).is_ok().then_some(object)
    }
}
