//! A mesh in its place: what a scene is made of.

use std::sync::Arc;

use glam::{Affine3A, DMat3, DVec3, Mat3, Vec3, Vec4};

use crate::description::{Fallback, Key};
use crate::mesh::{SurfaceMap, Triangle, stays_flat_enough};
use crate::{Mesh, SceneError};
use translucid_words::{Interval, refusal};

/// Greatest ratio of the stretches of a placed mesh: beyond, rays in its own space would be too coarse.
const MOST_DISTORTION: f64 = 100.0;

/// A mesh with its place and its material.
///
/// Objects may share a mesh, each at its own place: however many there are, it is held once, and so is the hierarchy over its
/// triangles where that [saves enough](Mesh::is_worth_sharing).
/// Loaders bake the place of a mesh that is used once into its vertices (mirrored ones flip the winding, so that the
/// geometric normal still points out), and a mesh with several materials becomes several objects.
#[derive(Clone, Debug, Default)]
pub struct Object {
    /// Name for messages and subsurface sets.
    pub name: String,
    /// Geometry in its own space; objects and scenes may share it.
    pub mesh: Arc<Mesh>,
    /// Its place: finite, invertible, and stretching no direction 100 times as much as another. A mirror turns the winding.
    pub world_from_local: Affine3A,
    /// Index into [`Scene::materials`](crate::Scene::materials).
    pub material: usize,
    /// Group of objects that share subsurface scattering: light may enter one and leave another. Any number.
    pub subsurface_group: u32,
    /// Whether its mesh has a hierarchy of its own however few objects share it, so that another place costs next to nothing.
    pub is_movable: bool,
}

/// A key with its default in words.
const fn key(name: &'static str, doc: &'static str, default: &'static str) -> Key {
    Key::new(name, doc, Fallback::Words(default))
}

impl Object {
    /// The keys of its place.
    pub const PLACE_KEYS: &[Key] = &[
        key("translate", "three lengths by which it is moved, scaled and turned", "`[0, 0, 0]`"),
        key("rotate", "three angles about the fixed axes x, then y, then z, after the scale", "`[0, 0, 0]`"),
        key("scale", "number or three, not zero", "1"),
        key(
            "matrix",
            "sixteen numbers, row by row, the last row 0, 0, 0, 1; in place of the three above",
            "none",
        ),
    ];

    /// Every key in a scene file; a shape adds its own parameters.
    pub const KEYS: &[Key] = &[
        key(
            "name",
            "text, unique among the objects; the command's `--mesh NAME=PATH` refers to it",
            "the file's or shape's name",
        ),
        key("file", "path of a .glb, .gltf, .obj, .ply or .stl file", "this or `shape`"),
        key("shape", "name of a built-in shape", "this or `file`"),
        key("material", "name of a material of the scene", "the file's own, else the default of every key"),
        key(
            "unit",
            "unit of the file's coordinates: `\"mm\"`, `\"cm\"` or `\"m\"`",
            "`\"m\"` for glTF, else the scene's",
        ),
        Self::PLACE_KEYS[0],
        Self::PLACE_KEYS[1],
        Self::PLACE_KEYS[2],
        Self::PLACE_KEYS[3],
        key(
            "transforms",
            "tables with the four keys above: the object, placed by its own, stands once at each of them",
            "one place",
        ),
        key(
            "subsurface_group",
            "text: light may enter one object of the group and leave another",
            "by `subsurface_grouping`",
        ),
    ];

    /// Returns `true` if the mesh is elsewhere than in its own space.
    #[inline]
    pub fn is_placed(&self) -> bool {
        self.world_from_local != Affine3A::IDENTITY
    }

    /// Returns `true` if its place mirrors the mesh.
    #[inline]
    pub fn is_mirrored(&self) -> bool {
        self.is_placed() && self.linear().determinant() < 0.0
    }

    fn linear(&self) -> DMat3 {
        Mat3::from(self.world_from_local.matrix3).as_dmat3()
    }

    /// Vertices of a triangle, counter-clockwise seen from outside the placed mesh.
    #[inline]
    pub fn corners(&self, triangle: usize) -> Triangle {
        let [a, b, c] = self.mesh.triangles[triangle];
        if self.is_mirrored() { [a, c, b] } else { [a, b, c] }
    }

    /// Positions of a triangle's [`corners`](Self::corners) in world space \[L\].
    #[inline]
    pub fn vertices(&self, triangle: usize) -> [Vec3; 3] {
        self.corners(triangle).map(|vertex| self.position(vertex))
    }

    /// Position of a vertex in world space \[L\].
    #[inline]
    pub fn position(&self, vertex: u32) -> Vec3 {
        let position = self.mesh.positions[vertex as usize];
        if self.is_placed() { self.world_from_local.transform_point3(position) } else { position }
    }

    /// Unit shading normal of a vertex in world space; the mesh must have normals.
    #[inline]
    pub fn normal(&self, vertex: u32) -> Vec3 {
        let normal = self.mesh.normals[vertex as usize];
        if self.is_placed() { SurfaceMap::new(&self.linear()).normal(normal) } else { normal }
    }

    /// Unit tangent of a vertex in world space with the bitangent's sign; the mesh must have tangents.
    #[inline]
    pub fn tangent(&self, vertex: u32) -> Vec4 {
        let tangent = self.mesh.tangents[vertex as usize];
        if self.is_placed() { SurfaceMap::new(&self.linear()).tangent(tangent) } else { tangent }
    }

    /// A box in world space that holds every vertex, as (lowest, highest) corner \[L\]: the smallest where the mesh is not
    /// placed, else that around the mesh's own.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        self.placed_box(self.mesh.bounds())
    }

    /// The box around a box of the mesh's own space.
    pub fn placed_box(&self, (low, high): (Vec3, Vec3)) -> (Vec3, Vec3) {
        if !self.is_placed() {
            return (low, high);
        }
        let corner = |i: u32| {
            let pick = |axis: u32| if i >> axis & 1 == 0 { low } else { high }[axis as usize];
            self.world_from_local.transform_point3(Vec3::new(pick(0), pick(1), pick(2)))
        };
        let first = corner(0);
        (1..8).map(corner).fold((first, first), |(low, high), p| (low.min(p), high.max(p)))
    }

    /// Least and greatest factor by which its place stretches a length; NaN where it is singular or not finite.
    pub fn stretches(&self) -> [f64; 2] {
        if !self.is_placed() {
            return [1.0, 1.0];
        }
        let linear = self.linear();
        let inverse = linear.inverse();
        if !(linear.is_finite() && inverse.is_finite() && linear.determinant() != 0.0) {
            return [f64::NAN; 2];
        }
        [greatest_stretch(&inverse).recip(), greatest_stretch(&linear)]
    }

    /// Returns `true` if rays can be traced in the mesh's own space as exactly as in the world.
    pub fn can_be_instanced(&self) -> bool {
        let [least, greatest] = self.stretches();
        self.world_from_local.is_finite() && greatest <= MOST_DISTORTION * least
    }

    /// Checks its place; `flattest` are the [least triangles](Mesh::flattest) of its mesh and `bounds` its box.
    pub fn check_place(
        &self,
        flattest: impl FnOnce() -> [f64; 2],
        bounds: (Vec3, Vec3),
    ) -> Result<(), SceneError> {
        if !self.is_placed() {
            return Ok(());
        }
        let refuse = |must_be: String| {
            let error = refusal(
                "world_from_local",
                format_args!("{:?}", self.world_from_local.to_cols_array()),
                must_be,
            );
            Err(error.with_help("Mesh::transform bakes any place into the vertices"))
        };
        if !self.world_from_local.is_finite() {
            return refuse(String::from("finite"));
        }
        let [least, greatest] = self.stretches();
        if least.is_nan() || least <= 0.0 {
            return refuse(String::from("invertible"));
        }
        if greatest > MOST_DISTORTION * least {
            return refuse(format!(
                "a map that stretches no direction more than {MOST_DISTORTION} times as much as another, but it does {:.0} \
                 times",
                greatest / least
            ));
        }
        let (low, high) = self.placed_box(bounds);
        let (reach, range) = (low.abs().max(high.abs()).max_element(), Interval::COORDINATE);
        if !range.contains(f64::from(reach)) {
            return refuse(format!("a map that leaves coordinates in {range}, but one is {reach:e}"));
        }
        let [cross, height] = flattest();
        if !stays_flat_enough(cross * least * least, height * (least / greatest).powi(2)) {
            return refuse(String::from("a map that leaves every triangle an area"));
        }
        Ok(())
    }
}

/// The greatest factor by which a linear map stretches a length: the root of the greatest eigenvalue of MᵀM, which is
/// symmetric [O. K. Smith 1961, "Eigenvalues of a symmetric 3 × 3 matrix", Communications of the ACM 4(4)].
fn greatest_stretch(m: &DMat3) -> f64 {
    // Within range whatever the scale
    let scale =
        [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.abs().max_element()).into_iter().fold(0.0, f64::max);
    if scale == 0.0 {
        return 0.0;
    }
    let m = *m * scale.recip();
    let s = m.transpose() * m;
    let mean = (s.x_axis.x + s.y_axis.y + s.z_axis.z) / 3.0;
    let off = s - DMat3::from_diagonal(DVec3::splat(mean));
    let squares = [off.x_axis, off.y_axis, off.z_axis].map(DVec3::length_squared).into_iter().sum::<f64>();
    let p = (squares / 6.0).sqrt();
    if p == 0.0 {
        return scale * mean.sqrt();
    }
    let half_determinant = (off * p.recip()).determinant() / 2.0;
    let angle = libm::acos(half_determinant.clamp(-1.0, 1.0)) / 3.0;
    scale * (mean + 2.0 * p * libm::cos(angle)).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::Quat;

    use super::*;

    /// A sheet with waves.
    fn waves() -> Mesh {
        const SIDE: u32 = 16;
        let position = |i: u32| {
            let [x, y] = [i % SIDE, i / SIDE].map(|step| step as f32 / 4.0);
            Vec3::new(x, y, (2.0 * x).sin() * (1.5 * y).cos())
        };
        let cell = |i: u32| {
            let corner = i / (SIDE - 1) * SIDE + i % (SIDE - 1);
            [[corner, corner + 1, corner + SIDE], [corner + 1, corner + SIDE + 1, corner + SIDE]]
        };
        let mut mesh = Mesh {
            positions: (0..SIDE * SIDE).map(position).collect(),
            triangles: (0..(SIDE - 1) * (SIDE - 1)).flat_map(cell).collect(),
            ..Mesh::default()
        };
        mesh.normals = mesh.smooth_normals();
        mesh
    }

    fn placed(scale: Vec3) -> Object {
        let mut mesh = waves();
        mesh.tangents = mesh.normals.iter().map(|n| n.any_orthonormal_vector().extend(1.0)).collect();
        let rotation = Quat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0);
        let world_from_local =
            Affine3A::from_scale_rotation_translation(scale, rotation, Vec3::new(3.0, -7.0, 0.5));
        Object { mesh: mesh.into(), world_from_local, ..Object::default() }
    }

    /// What is asked of a placed mesh is what baking makes of it, to the last bit.
    #[test]
    fn placed_meshes_are_as_baked_ones() {
        for scale in
            [Vec3::ONE, Vec3::new(0.2, 3.0, 1.0), Vec3::new(-1.0, 1.0, 1.0), Vec3::new(2.0, -0.5, -1.0)]
        {
            let object = placed(scale);
            let baked = Mesh::clone(&object.mesh).transformed(&object.world_from_local);
            assert_eq!(object.is_mirrored(), scale.x * scale.y * scale.z < 0.0);
            for (i, triangle) in baked.triangles.iter().enumerate() {
                assert_eq!(object.corners(i), *triangle);
                assert_eq!(object.vertices(i), triangle.map(|vertex| baked.positions[vertex as usize]));
            }
            for vertex in 0..baked.positions.len() {
                assert_eq!(object.normal(vertex as u32), baked.normals[vertex]);
                assert_eq!(object.tangent(vertex as u32), baked.tangents[vertex]);
            }
            let ((low, high), (least, most)) = (object.bounds(), baked.bounds());
            assert!((low - 1e-5).cmple(least).all() && (high + 1e-5).cmpge(most).all());
        }
    }

    #[test]
    fn stretches_are_those_of_the_scale() {
        for scale in [Vec3::ONE, Vec3::new(0.2, 3.0, 1.0), Vec3::new(-2.0, 2.0, 2.0), Vec3::splat(1e-8)] {
            let [least, greatest] = placed(scale).stretches();
            let expected = [scale.abs().min_element(), scale.abs().max_element()].map(f64::from);
            assert!((least / expected[0] - 1.0).abs() < 1e-6, "{scale}: {least}");
            assert!((greatest / expected[1] - 1.0).abs() < 1e-6, "{scale}: {greatest}");
        }
        // A shear by 1 stretches by the golden ratio
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
        assert!((greatest_stretch(&shear) - (1.0 + 5f64.sqrt()) / 2.0).abs() < 1e-12);
        assert!(placed(Vec3::new(1.0, 1.0, 0.0)).stretches()[0].is_nan());
        assert!(!placed(Vec3::new(1.0, 1.0, 0.005)).can_be_instanced());
        assert!(!placed(Vec3::splat(f32::NAN)).can_be_instanced());
    }
}
