//! Vertices of meshes whose corners have attributes of their own.

use std::collections::HashMap;

use glam::{Vec2, Vec3};
use translucid_scene::Mesh;

/// No number.
pub(super) const NONE: u32 = u32::MAX;

/// Most vertices of a place that are looked through one after the other.
const MOST_LOOKED_THROUGH: usize = 16;

/// A corner of a face: numbers in [`Tables`], or [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
    pub(super) color: u32,
}

/// The values that corners refer to.
#[derive(Debug, Default)]
pub(super) struct Tables {
    pub(super) positions: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    /// If there are any, a corner without one is white.
    pub(super) colors: Vec<Vec3>,
}

/// Makes one vertex of each different corner.
pub(super) struct Welder<'a> {
    tables: &'a Tables,
    /// For each position the mesh that last used it, and its newest vertex there.
    newest: Vec<(u32, u32)>,
    mesh: u32,
    /// For each vertex of the mesh its corner, and the next older vertex of the same position.
    vertices: Vec<(Corner, u32)>,
    /// Vertices of places that have too many to look through.
    crowded: HashMap<Corner, u32>,
}

impl<'a> Welder<'a> {
    pub(super) fn new(tables: &'a Tables) -> Self {
        Self {
            tables,
            newest: vec![(0, NONE); tables.positions.len()],
            mesh: 0,
            vertices: Vec::new(),
            crowded: HashMap::new(),
        }
    }

    /// Makes a mesh of triangles whose positions are in range.
    pub(super) fn weld(&mut self, triangles: impl Iterator<Item = [Corner; 3]>) -> Mesh {
        self.mesh += 1;
        self.vertices.clear();
        self.crowded.clear();
        let mut mesh = Mesh::default();
        mesh.triangles.reserve(triangles.size_hint().0);
        for triangle in triangles {
            let triangle = triangle.map(|corner| self.vertex(corner, &mut mesh));
            mesh.triangles.push(triangle);
        }
        if self.vertices.iter().all(|(corner, _)| corner.uv == NONE) {
            mesh.uvs = Vec::new();
        }
        mesh
    }

    /// The number of a corner's vertex.
    fn vertex(&mut self, corner: Corner, mesh: &mut Mesh) -> u32 {
        let (of, newest) = self.newest[corner.position as usize];
        let newest = if of == self.mesh { newest } else { NONE };
        let (mut candidate, mut looked) = (newest, 0);
        while let Some(&(other, older)) = self.vertices.get(candidate as usize) {
            if other == corner {
                return candidate;
            }
            (candidate, looked) = (older, looked + 1);
            if looked == MOST_LOOKED_THROUGH {
                if let Some(&known) = self.crowded.get(&corner) {
                    return known;
                }
                break;
            }
        }
        let number = self.vertices.len() as u32;
        self.vertices.push((corner, newest));
        if looked == MOST_LOOKED_THROUGH {
            self.crowded.insert(corner, number);
        } else {
            self.newest[corner.position as usize] = (self.mesh, number);
        }
        self.push(corner, mesh);
        number
    }

    fn push(&self, corner: Corner, mesh: &mut Mesh) {
        let Tables { positions, uvs, normals, colors } = self.tables;
        mesh.positions.push(positions[corner.position as usize]);
        mesh.uvs.push(uvs.get(corner.uv as usize).copied().unwrap_or_default());
        if let Some(&normal) = normals.get(corner.normal as usize) {
            mesh.normals.push(normal);
        }
        if !colors.is_empty() {
            mesh.colors.push(colors.get(corner.color as usize).copied().unwrap_or(Vec3::ONE));
        }
    }
}

/// The different ones among values, told apart by their bits, and for each value its number there.
pub(super) fn distinct<T: Copy, const N: usize>(
    values: impl Iterator<Item = T>,
    numbers_of: impl Fn(T) -> [f32; N],
) -> (Vec<T>, Vec<u32>) {
    let (mut different, mut numbers) = (Vec::new(), HashMap::new());
    let number = |value: T| {
        *numbers.entry(numbers_of(value).map(f32::to_bits)).or_insert_with(|| {
            different.push(value);
            different.len() as u32 - 1
        })
    };
    let of_values = values.map(number).collect();
    (different, of_values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weld_makes_one_vertex_of_each_corner_even_where_many_meet() {
        let tables = Tables {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            uvs: (0..100).map(|i| Vec2::splat(i as f32)).collect(),
            ..Tables::default()
        };
        let corner = |position: u32, uv: u32| Corner { position, uv, normal: NONE, color: NONE };
        let triangle = |i: u32| [corner(0, i % 100), corner(1, 0), corner(2, 1)];
        let mut welder = Welder::new(&tables);
        for _ in 0..2 {
            let mesh = welder.weld((0..300).map(triangle));
            assert_eq!((mesh.positions.len(), mesh.triangles.len()), (102, 300));
            for (number, &[a, b, c]) in mesh.triangles.iter().enumerate() {
                assert_eq!(mesh.uvs[a as usize], Vec2::splat((number % 100) as f32));
                assert_eq!([b, c].map(|i| mesh.positions[i as usize]), [Vec3::X, Vec3::Y]);
            }
        }
    }
}
