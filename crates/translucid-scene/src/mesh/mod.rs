//! Indexed triangle mesh.

mod check;
mod repair;

use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3, Vec2, Vec3, Vec4};

pub(crate) use check::stays_flat_enough;
pub use repair::repair_mesh;

/// Three indices into the vertex arrays, counter-clockwise seen from outside.
pub type Triangle = [u32; 3];

/// A triangle mesh; the attribute arrays are empty or as long as `positions`.
///
/// Valid: at least one triangle, indices in range, all numbers finite, no triangle of zero area.
/// [`validate`](Self::validate) tells whether it is, and [`repair_mesh`] makes it so; the methods below take any mesh
/// and do not panic.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions \[L\], in [−10⁹, 10⁹].
    pub positions: Vec<Vec3>,
    /// Unit shading normals, or empty: flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, v upward, or empty.
    pub uvs: Vec<Vec2>,
    /// Unit tangents for normal maps, w = ±1 the bitangent's sign, or empty: derived from `uvs`.
    pub tangents: Vec<Vec4>,
    /// Linear vertex colors, in [0, 10⁶], or empty: white.
    pub colors: Vec<Vec3>,
    /// Triangles.
    pub triangles: Vec<Triangle>,
}

impl Mesh {
    /// Smallest axis-aligned box that holds every vertex, as (lowest, highest) corner \[L\].
    ///
    /// A mesh without vertices has its box at the origin.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let Some(&first) = self.positions.first() else { return (Vec3::ZERO, Vec3::ZERO) };
        self.positions.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)))
    }

    /// Bakes an affine map M into the vertices.
    ///
    /// Positions go by M, normals by the inverse transpose, tangents by the linear part.
    /// A mirroring M (determinant < 0) flips every triangle's winding and every tangent's sign, so that
    /// the geometric normal still points out.
    ///
    /// A singular M makes no NaN: a normal that has no image keeps its direction.
    /// It may make triangles of zero area, and a huge M infinite positions; `repair_mesh` removes both.
    pub fn transform(&mut self, world_from_local: &Affine3A) {
        let linear = Mat3::from(world_from_local.matrix3).as_dmat3();
        let map = SurfaceMap::new(&linear);
        for position in &mut self.positions {
            *position = world_from_local.transform_point3(*position);
        }
        self.normals.iter_mut().for_each(|normal| *normal = map.normal(*normal));
        self.tangents.iter_mut().for_each(|tangent| *tangent = map.tangent(*tangent));
        if map.mirrored {
            self.flip_winding();
        }
    }

    /// Bakes an affine map for each vertex into the mesh, as [`transform`](Self::transform) bakes one for all: a skin.
    ///
    /// A triangle's winding is flipped if most of its vertices are mirrored.
    pub fn transform_vertices(&mut self, world_from_local: &[DAffine3]) {
        let maps: Vec<SurfaceMap> =
            world_from_local.iter().map(|map| SurfaceMap::new(&map.matrix3)).collect();
        for (position, map) in self.positions.iter_mut().zip(world_from_local) {
            *position = map.transform_point3(position.as_dvec3()).as_vec3();
        }
        self.normals.iter_mut().zip(&maps).for_each(|(normal, map)| *normal = map.normal(*normal));
        self.tangents.iter_mut().zip(&maps).for_each(|(tangent, map)| *tangent = map.tangent(*tangent));
        let is_mirrored = |vertex: &u32| maps.get(*vertex as usize).is_some_and(|map| map.mirrored);
        for triangle in &mut self.triangles {
            if triangle.iter().filter(|vertex| is_mirrored(vertex)).count() >= 2 {
                triangle.swap(1, 2);
            }
        }
    }

    /// The mesh after [`transform`](Self::transform).
    #[must_use]
    pub fn transformed(mut self, world_from_local: &Affine3A) -> Self {
        self.transform(world_from_local);
        self
    }

    /// Reverses the order of every triangle's vertices: inside becomes outside.
    pub fn flip_winding(&mut self) {
        for [_, b, c] in &mut self.triangles {
            std::mem::swap(b, c);
        }
    }

    /// Smooth vertex normals: the sum of the adjoining triangles' normals, each weighted by its angle at
    /// the vertex (G. Thürmer & C. A. Wüthrich, "Computing Vertex Normals from Polygonal Facets", 1998).
    ///
    /// Only triangles that share a vertex's index count, so that a seam of doubled vertices stays sharp.
    /// A vertex whose triangles cancel out, or that has none, gets (0, 0, 1).
    pub fn smooth_normals(&self) -> Vec<Vec3> {
        let mut sums = vec![Vec3::ZERO; self.positions.len()];
        for triangle in &self.triangles {
            let Some(corners) = self.corners(triangle) else { continue };
            let weighted = angle_weighted_normals(corners);
            for (&vertex, normal) in triangle.iter().zip(weighted) {
                sums[vertex as usize] += normal;
            }
        }
        for normal in &mut sums {
            *normal = normal.normalize_or(Vec3::Z);
        }
        sums
    }

    /// Corners of a triangle in double precision, if its indices are in range.
    pub fn corners(&self, triangle: &Triangle) -> Option<[DVec3; 3]> {
        let corner = |vertex: u32| self.positions.get(vertex as usize).map(|p| p.as_dvec3());
        Some([corner(triangle[0])?, corner(triangle[1])?, corner(triangle[2])?])
    }

    /// Returns `true` if so many uses of the mesh are worth a hierarchy of their own, in which a ray is transformed for each,
    /// in place of their triangles among the others: from 2¹⁸ triangles saved on, some 25 MB.
    pub fn is_worth_sharing(&self, uses: usize) -> bool {
        uses.saturating_sub(1).saturating_mul(self.triangles.len()) >= LEAST_SAVED
    }
}

/// Triangles that sharing a mesh has to save.
const LEAST_SAVED: usize = 1 << 18;

/// How a linear map moves what stands on a surface.
pub(crate) struct SurfaceMap {
    linear: DMat3,
    /// det(M)·M⁻ᵀ: it has the inverse transpose's direction and exists for a singular M too. With the sign by which a
    /// mirrored mesh's normals still point out.
    cofactor: DMat3,
    mirrored: bool,
}

impl SurfaceMap {
    pub(crate) fn new(linear: &DMat3) -> Self {
        let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
        let mirrored = linear.determinant() < 0.0;
        let sign = if mirrored { -1.0 } else { 1.0 };
        Self {
            linear: *linear,
            cofactor: DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign,
            mirrored,
        }
    }

    pub(crate) fn normal(&self, normal: Vec3) -> Vec3 {
        unit_or(self.cofactor * normal.as_dvec3(), normal)
    }

    pub(crate) fn tangent(&self, tangent: Vec4) -> Vec4 {
        let direction = tangent.truncate();
        let sign = if self.mirrored { -tangent.w } else { tangent.w };
        unit_or(self.linear * direction.as_dvec3(), direction).extend(sign)
    }
}

/// Unit vector along `v`, else along `fallback`, else along z.
fn unit_or(v: DVec3, fallback: Vec3) -> Vec3 {
    // Dividing by the largest component first keeps the squares of tiny and huge vectors in range.
    let scaled = v / v.abs().max_element();
    scaled.try_normalize().map_or_else(|| fallback.normalize_or(Vec3::Z), DVec3::as_vec3)
}

/// A triangle's unit normal times its angle at each corner; zero where there is none.
fn angle_weighted_normals([a, b, c]: [DVec3; 3]) -> [Vec3; 3] {
    let unit = |v: DVec3| v.normalize_or_zero();
    let [ab, bc, ca] = [unit(b - a), unit(c - b), unit(a - c)];
    let normal = unit(ab.cross(-ca)).as_vec3();
    let angle = |from: DVec3, to: DVec3| libm::acos((-from.dot(to)).clamp(-1.0, 1.0)) as f32;
    [normal * angle(ca, ab), normal * angle(ab, bc), normal * angle(bc, ca)]
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    #[test]
    fn transforming_each_vertex_alike_is_transforming_the_mesh() {
        let linear = Mat3::from_cols(Vec3::new(-2.0, 0.5, 0.0), Vec3::Y, Vec3::new(0.25, 0.0, 3.0));
        let map = Affine3A::from_mat3_translation(linear, Vec3::new(1.0, 2.0, 3.0));
        let map_64 = DAffine3::from_mat3_translation(linear.as_dmat3(), DVec3::new(1.0, 2.0, 3.0));
        let mesh = tetrahedron();
        let mut each = mesh.clone();
        each.transform_vertices(&vec![map_64; mesh.positions.len()]);
        let all = mesh.transformed(&map);
        assert_eq!((&each.positions, &each.triangles), (&all.positions, &all.triangles));
        assert_eq!((each.normals, each.tangents), (all.normals, all.tangents));
    }

    /// A tetrahedron with one corner at the origin, outward winding, and one tangent frame a vertex.
    fn tetrahedron() -> Mesh {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        mesh.normals = mesh.smooth_normals();
        mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
        mesh
    }

    /// Signed volume: positive if the winding is outward.
    fn volume(mesh: &Mesh) -> f64 {
        let cone = |t| mesh.corners(t).map_or(0.0, |[a, b, c]| a.dot(b.cross(c)) / 6.0);
        mesh.triangles.iter().map(cone).sum()
    }

    fn bitangent(mesh: &Mesh, vertex: usize) -> Vec3 {
        let tangent = mesh.tangents[vertex];
        mesh.normals[vertex].cross(tangent.truncate()) * tangent.w
    }

    #[test]
    fn bounds_hold_every_vertex() {
        assert_eq!(tetrahedron().bounds(), (Vec3::ZERO, Vec3::ONE));
        assert_eq!(Mesh::default().bounds(), (Vec3::ZERO, Vec3::ZERO));
    }

    #[test]
    fn transform_scales_volume_by_the_determinant_and_keeps_it_outward() {
        for scale in [Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 2.0, 3.0), Vec3::new(-1.0, -2.0, -3.0)] {
            let map = Affine3A::from_scale_rotation_translation(
                scale,
                Quat::from_rotation_y(0.3),
                Vec3::new(5.0, -2.0, 1.0),
            );
            let after = volume(&tetrahedron().transformed(&map));
            assert!((after - 1.0).abs() < 1e-5, "{after} for {scale}");
        }
    }

    #[test]
    fn transform_keeps_normals_perpendicular_to_the_surface() {
        let shear = Mat3::from_cols(Vec3::X, Vec3::new(0.7, 1.0, 0.0), Vec3::new(0.0, 0.2, -3.0));
        let mut flat = tetrahedron();
        flat.normals = vec![-Vec3::Z; 4]; // The normal of the first triangle.
        let flat = flat.transformed(&Affine3A::from_mat3(shear));
        let [a, b, c] = flat.corners(&flat.triangles[0]).unwrap();
        let geometric = (b - a).cross(c - a).normalize().as_vec3();
        assert!(flat.normals[0].distance(geometric) < 1e-6, "{} {geometric}", flat.normals[0]);
    }

    #[test]
    fn transform_by_a_mirror_maps_the_whole_tangent_frame() {
        let map = Affine3A::from_scale(Vec3::new(1.0, -1.0, 1.0));
        let before = tetrahedron();
        let after = before.clone().transformed(&map);
        for vertex in 0..4 {
            let expected = map.transform_vector3(bitangent(&before, vertex));
            assert!(bitangent(&after, vertex).distance(expected) < 1e-6);
        }
    }

    #[test]
    fn transform_keeps_normals_unit_for_singular_tiny_and_huge_maps() {
        for scale in [Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::splat(1e-30), Vec3::splat(1e30)] {
            let mesh = tetrahedron().transformed(&Affine3A::from_scale(scale));
            assert!(mesh.normals.iter().all(|n| n.is_normalized()), "{scale}: {:?}", mesh.normals);
            assert!(mesh.tangents.iter().all(|t| t.truncate().is_normalized()), "{scale}");
        }
    }

    #[test]
    fn smooth_normals_do_not_depend_on_how_a_cube_is_cut() {
        // Each corner of the unit cube; each face cut along one diagonal, so that corners have 3 to 6 triangles.
        let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32);
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mesh = Mesh {
            positions: (0..8).map(corner).collect(),
            triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
            ..Mesh::default()
        };
        for (position, normal) in mesh.positions.iter().zip(mesh.smooth_normals()) {
            let expected = (*position - Vec3::splat(0.5)).normalize();
            assert!(normal.distance(expected) < 1e-6, "{position}: {normal}");
        }
    }

    #[test]
    fn smooth_normals_survive_broken_triangles() {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::X],
            triangles: vec![[0, 1, 2], [0, 2, 9], [2, 2, 0]],
            ..Mesh::default()
        };
        assert!(mesh.smooth_normals().iter().all(|n| n.is_normalized()));
    }
}
