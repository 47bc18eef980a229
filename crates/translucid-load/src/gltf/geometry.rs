//! Mesh primitives: triangle lists, strips and fans with their vertex attributes.

use glam::{Vec2, Vec3, Vec4};
use translucid_scene::{Mesh, Triangle};

use super::buffers::Arrays;
use super::document::Primitive;
use crate::result::Result;

/// Triangles and vertices that a file may unfold to by instances and shared accessors.
///
/// A scene of this size fills tens of gigabytes; a small damaged file could ask for any number.
pub(super) const MOST: usize = 1 << 28;

/// Rest of an allowance; `None` if there is not so much left.
fn left_of(budget: usize, vertices: usize, triangles: usize) -> Option<usize> {
    budget.checked_sub(vertices.checked_add(triangles)?)
}

/// How a primitive's indices make triangles.
#[derive(Clone, Copy)]
enum Topology {
    List,
    Strip,
    Fan,
}

impl Topology {
    fn triangle_count(self, indices: usize) -> usize {
        match self {
            Self::List => indices / 3,
            Self::Strip | Self::Fan => indices.saturating_sub(2),
        }
    }

    /// Triangles of the indices (glTF 2.0, section 3.7.2.1, "Overview"): every other one of a strip is
    /// turned, so that all wind the same way.
    fn triangles(self, indices: &[u32]) -> Vec<Triangle> {
        match self {
            Self::List => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
            Self::Strip => {
                let turned = |(i, w): (usize, &[u32])| {
                    if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] }
                };
                indices.windows(3).enumerate().map(turned).collect()
            }
            Self::Fan => match indices {
                [center, rim @ ..] => rim.windows(2).map(|w| [w[0], w[1], *center]).collect(),
                [] => Vec::new(),
            },
        }
    }
}

impl Arrays<'_> {
    /// A primitive in its mesh's space, not yet repaired, or `None` (with a warning) if it has no surface.
    ///
    /// `uv_set` is the number of the texture coordinates that the material reads.
    pub(super) fn primitive_mesh(
        &self,
        primitive: &Primitive,
        part: &str,
        uv_set: usize,
        budget: &mut usize,
    ) -> Result<Option<Mesh>> {
        let Some((topology, positions)) = self.surface(primitive, part)? else { return Ok(None) };
        let vertices = self.count(positions, part)?;
        let indices = primitive.indices.map(|accessor| self.count(accessor, part)).transpose()?;
        let triangles = topology.triangle_count(indices.unwrap_or(vertices));
        let Some(left) = left_of(*budget, vertices, triangles) else {
            let message = format!(
                "with this mesh the file has more than {MOST} triangles and vertices, the most allowed"
            );
            return Err(self.notes.error(part, message).with_help("instances count once for each use"));
        };
        *budget = left;
        let mut mesh = Mesh {
            positions: self.attribute(positions, "POSITION", part, Vec3::from_array)?,
            ..Mesh::default()
        };
        mesh.triangles = self.triangles(primitive, topology, mesh.positions.len(), part)?;
        self.read_attributes(primitive, part, uv_set, &mut mesh)?;
        Ok(Some(mesh))
    }

    /// The topology and the accessor of the positions, if the primitive has triangles that can be read.
    fn surface(&self, primitive: &Primitive, part: &str) -> Result<Option<(Topology, usize)>> {
        let topology = match primitive.mode.unwrap_or(4) {
            4 => Topology::List,
            5 => Topology::Strip,
            6 => Topology::Fan,
            mode @ 0..=3 => {
                let kind = if mode == 0 { "points have" } else { "lines have" };
                self.notes.warn(part, format!("{kind} no surface: left out"));
                return Ok(None);
            }
            mode => return Err(self.notes.error(part, format!("its mode is {mode}, but must be in 0 … 6"))),
        };
        let Some(&positions) = primitive.attributes.get("POSITION") else {
            self.notes.warn(part, "a primitive without POSITION is left out");
            return Ok(None);
        };
        Ok(Some((topology, positions)))
    }

    fn attribute<const N: usize, T>(
        &self,
        accessor: usize,
        key: &str,
        part: &str,
        convert: impl Fn([f32; N]) -> T,
    ) -> Result<Vec<T>> {
        let numbers = self.numbers::<N>(accessor, &format!("{key} of {part}"))?;
        Ok(numbers.into_iter().map(convert).collect())
    }

    fn triangles(
        &self,
        primitive: &Primitive,
        topology: Topology,
        vertices: usize,
        part: &str,
    ) -> Result<Vec<Triangle>> {
        let indices = match primitive.indices {
            Some(accessor) => self.indices(accessor, &format!("indices of {part}"))?,
            None => (0..vertices.try_into().unwrap_or(u32::MAX)).collect(),
        };
        if matches!(topology, Topology::List) && !indices.len().is_multiple_of(3) {
            self.notes.warn(
                part,
                format!("{} indices are no whole number of triangles: the rest is left out", indices.len()),
            );
        }
        Ok(topology.triangles(&indices))
    }

    fn read_attributes(
        &self,
        primitive: &Primitive,
        part: &str,
        uv_set: usize,
        mesh: &mut Mesh,
    ) -> Result<()> {
        let find = |key: &str| primitive.attributes.get(key).copied();
        if let Some(accessor) = find("NORMAL") {
            mesh.normals = self.attribute(accessor, "NORMAL", part, Vec3::from_array)?;
        }
        if let Some(accessor) = find("TANGENT") {
            mesh.tangents = self.attribute(accessor, "TANGENT", part, Vec4::from_array)?;
        }
        let key = format!("TEXCOORD_{uv_set}");
        if let Some(accessor) = find(&key) {
            // glTF's v points down, ours up. The tangent frame stays: glTF's bitangent points up in the image.
            mesh.uvs = self.attribute(accessor, &key, part, |[u, v]| Vec2::new(u, 1.0 - v))?;
        }
        if let Some(accessor) = find("COLOR_0") {
            mesh.colors =
                self.attribute(accessor, "COLOR_0", part, |[r, g, b, _]: [f32; 4]| Vec3::new(r, g, b))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_of_a_convex_polygon_wind_one_way() {
        // Corners of a hexagon in order, as a fan; and the same corners as a zigzag strip.
        let corner = |i: u32| Vec2::from_angle(i as f32 * std::f32::consts::TAU / 6.0);
        let area = |t: &Triangle| {
            let [a, b, c] = t.map(corner);
            (b - a).perp_dot(c - a) / 2.0
        };
        let hexagon = 1.5 * 3f32.sqrt();
        for triangles in
            [Topology::Fan.triangles(&[0, 1, 2, 3, 4, 5]), Topology::Strip.triangles(&[0, 1, 5, 2, 4, 3])]
        {
            assert_eq!(triangles.len(), 4);
            assert!(triangles.iter().all(|t| area(t) > 0.0), "{triangles:?}");
            let total: f32 = triangles.iter().map(area).sum();
            assert!((total - hexagon).abs() < 1e-5, "{total}");
        }
    }

    #[test]
    fn topology_counts_the_triangles_it_makes() {
        let indices: Vec<u32> = (0..11).collect();
        for topology in [Topology::List, Topology::Strip, Topology::Fan] {
            for length in 0..indices.len() {
                assert_eq!(topology.triangles(&indices[..length]).len(), topology.triangle_count(length));
            }
        }
    }

    #[test]
    fn budget_refuses_what_exceeds_it_and_keeps_the_rest() {
        assert_eq!(left_of(MOST, 10, MOST - 11), Some(1));
        assert_eq!(left_of(1, 1, 1), None);
        assert_eq!(left_of(MOST, usize::MAX, 1), None);
    }
}
