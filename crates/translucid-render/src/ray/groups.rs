//! Clearance and facets of each subsurface group, which walks need; made when they are first asked for.

use std::sync::OnceLock;

use translucid_scene::Object;

use super::clearance::Clearance;
use super::facets::{Facet, Facets};

/// Cells of all grids together: two million bytes.
pub(super) const CELLS: f32 = 2_097_152.0;

/// The subsurface groups of a scene.
pub(super) struct Groups(Vec<GroupSurfaces>);

struct GroupSurfaces {
    number: u32,
    /// Numbers of its objects.
    objects: Vec<usize>,
    clearance: OnceLock<Clearance>,
    facets: OnceLock<Facets>,
}

impl Groups {
    /// The groups of those objects that need one.
    pub(super) fn new(objects: &[Object], needs_group: impl Fn(usize) -> bool) -> Self {
        let mut order: Vec<usize> = (0..objects.len()).filter(|&object| needs_group(object)).collect();
        order.sort_by_key(|&index| objects[index].subsurface_group);
        let group = |objects_of_group: &[usize]| GroupSurfaces {
            number: objects[objects_of_group[0]].subsurface_group,
            objects: objects_of_group.to_vec(),
            clearance: OnceLock::new(),
            facets: OnceLock::new(),
        };
        let is_same = |a: &usize, b: &usize| objects[*a].subsurface_group == objects[*b].subsurface_group;
        Self(order.chunk_by(is_same).map(group).collect())
    }

    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// The clearance grid of a group of the objects that this was made for, of about so many cells.
    pub(super) fn clearance(&self, objects: &[Object], group: u32, cells: f32) -> Option<&Clearance> {
        let group = self.of(group)?;
        let vertices = || group.facets(objects).map(|facet| facet.vertices);
        Some(group.clearance.get_or_init(|| Clearance::new(vertices, cells)))
    }

    /// The facets of a group of the objects that this was made for.
    pub(super) fn facets(&self, objects: &[Object], group: u32) -> Option<&Facets> {
        let group = self.of(group)?;
        Some(group.facets.get_or_init(|| Facets::new(group.facets(objects).collect())))
    }

    fn of(&self, group: u32) -> Option<&GroupSurfaces> {
        let index = self.0.binary_search_by_key(&group, |group| group.number).ok()?;
        Some(&self.0[index])
    }
}

impl GroupSurfaces {
    fn facets<'a>(&'a self, objects: &'a [Object]) -> impl Iterator<Item = Facet> + 'a {
        self.objects.iter().flat_map(|&number| {
            let object = &objects[number];
            (0..object.mesh.triangles.len()).map(move |triangle| Facet {
                vertices: object.vertices(triangle),
                triangle: (number as u32, triangle as u32),
            })
        })
    }
}
