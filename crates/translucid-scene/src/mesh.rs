//! Indexed triangle mesh.

use glam::{Vec2, Vec3, Vec4};

/// Three indices into the vertex arrays, counter-clockwise seen from outside.
pub type Triangle = [u32; 3];

/// A triangle mesh; the attribute arrays are empty or as long as `positions`.
///
/// Valid: at least one triangle, indices in range, all numbers finite, no triangle of zero area.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions [L].
    pub positions: Vec<Vec3>,
    /// Unit shading normals, or empty: flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v upward, or empty.
    pub uvs: Vec<Vec2>,
    /// Unit tangents for normal maps, w = ±1 the bitangent's sign, or empty: derived from `uvs`.
    pub tangents: Vec<Vec4>,
    /// Linear vertex colors, or empty: white.
    pub colors: Vec<Vec3>,
    /// Triangles.
    pub triangles: Vec<Triangle>,
}
