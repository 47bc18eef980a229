//! Which way is up in a mesh file, and turning what is in it.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Mat3, Vec3};
use translucid_scene::{Camera, Light, Object};

use super::mesh_file::MeshFile;

/// The axis of a mesh file that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpAxis {
    /// +x.
    X,
    /// +y, as in glTF.
    Y,
    /// +z, as in most programs for scans, printing and engineering.
    Z,
    /// −x.
    MinusX,
    /// −y.
    MinusY,
    /// −z.
    MinusZ,
}

impl UpAxis {
    /// Every axis by its name, in the order of the variants.
    pub const WORDS: [(&str, Self); 6] = [
        ("x", Self::X),
        ("y", Self::Y),
        ("z", Self::Z),
        ("-x", Self::MinusX),
        ("-y", Self::MinusY),
        ("-z", Self::MinusZ),
    ];

    /// The axis of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(word, _)| *word == name).map(|&(_, axis)| axis)
    }

    /// The axis' name.
    pub fn name(self) -> &'static str {
        Self::WORDS[self as usize].0
    }

    /// Quarter turns that bring the axis to +y; from z the front is −y, as in Blender.
    pub(super) fn rotation(self) -> Mat3 {
        match self {
            Self::X => Mat3::from_cols(Vec3::Y, Vec3::NEG_X, Vec3::Z),
            Self::Y => Mat3::IDENTITY,
            Self::Z => Mat3::from_cols(Vec3::X, Vec3::NEG_Z, Vec3::Y),
            Self::MinusX => Mat3::from_cols(Vec3::NEG_Y, Vec3::X, Vec3::Z),
            Self::MinusY => Mat3::from_cols(Vec3::NEG_X, Vec3::NEG_Y, Vec3::Z),
            Self::MinusZ => Mat3::from_cols(Vec3::X, Vec3::Z, Vec3::NEG_Y),
        }
    }
}

/// Turns all that a file has about the origin.
pub(super) fn turn_model(model: &mut MeshFile, rotation: Mat3) {
    if rotation == Mat3::IDENTITY {
        return;
    }
    turn_objects(&mut model.objects, rotation, DVec3::ZERO);
    for light in &mut model.lights {
        match light {
            Light::Spot { position, direction, .. } => {
                *position = rotation * *position;
                *direction = rotation * *direction;
            }
            Light::Distant { direction, .. } => *direction = rotation * *direction,
            // Mesh files have no others.
            _ => {}
        }
    }
    for named in &mut model.cameras {
        let Camera { position, target, up, .. } = named.camera;
        let [position, target, up] = [position, target, up].map(|vector| rotation * vector);
        named.camera = Camera { position, target, up, ..named.camera };
    }
}

/// Turns objects about a point.
pub(super) fn turn_objects(objects: &mut [Object], rotation: Mat3, about: DVec3) {
    let moved = about - rotation.as_dmat3() * about;
    let map = Affine3A::from_mat3_translation(rotation, moved.as_vec3());
    for object in objects {
        match Arc::get_mut(&mut object.mesh) {
            Some(mesh) if object.world_from_local == Affine3A::IDENTITY => mesh.transform(&map),
            _ => object.world_from_local = map * object.world_from_local,
        }
    }
}

/// Lowest and highest corner of the box about all objects; the box of a mesh is looked for once.
pub(super) fn bounds(objects: &[Object]) -> (Vec3, Vec3) {
    let mut known = HashMap::new();
    let boxes = objects.iter().map(|object| {
        let address = Arc::as_ptr(&object.mesh).addr();
        object.placed_box(*known.entry(address).or_insert_with(|| object.mesh.bounds()))
    });
    boxes.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))).unwrap_or_default()
}

/// Returns whether z is up beyond doubt: the meshes stand on the plane z = 0 with a flat base about the origin, rise at
/// least half as high as they are wide, and have no flat base along y.
///
/// A relief with its back in that plane is no such mesh: it is low. Nor is a box, which could stand on either side.
pub(super) fn stands_along_z(objects: &[Object]) -> bool {
    const FLAT: f32 = 0.005;
    let (low, high) = bounds(objects);
    let extent = high - low;
    let slack = FLAT * extent.max_element();
    let is_about_origin = |axis: usize| low[axis] < -0.1 * extent[axis] && high[axis] > 0.1 * extent[axis];
    low.z.abs() <= slack
        && extent.z >= 0.5 * extent.x.max(extent.y)
        && is_about_origin(0)
        && is_about_origin(1)
        && base_share(objects, 2, low.z + slack, extent) > 0.1
        && base_share(objects, 1, low.y + slack, extent) < 0.02
}

/// Area of the triangles below a coordinate along an axis, as a share of the box's area across it.
fn base_share(objects: &[Object], axis: usize, top: f32, extent: Vec3) -> f64 {
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    let corners = objects
        .iter()
        .flat_map(|object| object.mesh.triangles.iter().filter_map(|triangle| object.mesh.corners(triangle)));
    let base = corners.filter(|corners| corners.iter().all(|corner| corner[axis] <= f64::from(top)));
    let area = |[a, b, c]: [DVec3; 3]| 0.5 * (b - a).cross(c - a)[axis].abs();
    base.map(area).sum::<f64>() / f64::from(extent[u] * extent[v]).max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use translucid_shapes::{ShapeParameters, build_shape};

    use super::*;

    #[test]
    fn every_axis_comes_up_without_a_mirror() {
        for (axis, vector) in UpAxis::WORDS.map(|(_, axis)| axis).into_iter().zip([
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            Vec3::NEG_X,
            Vec3::NEG_Y,
            Vec3::NEG_Z,
        ]) {
            let rotation = axis.rotation();
            assert_eq!((rotation * vector, rotation.determinant()), (Vec3::Y, 1.0), "{axis:?}");
            assert_eq!(UpAxis::from_name(axis.name()), Some(axis));
        }
        assert_eq!(UpAxis::from_name("up"), None);
    }

    /// A cone with its base in the plane y = 0, or another shape there, in the axes of a file with this up.
    fn standing(up: UpAxis, squeeze: Vec3) -> Vec<Object> {
        let (mut positions, mut triangles) = (vec![Vec3::ZERO, Vec3::Y], Vec::new());
        for i in 0..24_u32 {
            let (sine, cosine) = (i as f32 * std::f32::consts::TAU / 24.0).sin_cos();
            positions.push(Vec3::new(0.4 * cosine, 0.0, 0.4 * sine));
            let [this, next] = [2 + i, 2 + (i + 1) % 24];
            triangles.extend([[0, this, next], [1, next, this]]);
        }
        positions.iter_mut().for_each(|p| *p = up.rotation().transpose() * (*p * squeeze));
        vec![Object {
            mesh: translucid_scene::Mesh { positions, triangles, ..translucid_scene::Mesh::default() }.into(),
            ..Object::default()
        }]
    }

    #[test]
    fn only_what_stands_on_the_plane_of_z_has_z_up() {
        assert!(stands_along_z(&standing(UpAxis::Z, Vec3::ONE)));
        for up in [UpAxis::X, UpAxis::Y, UpAxis::MinusY, UpAxis::MinusZ] {
            assert!(!stands_along_z(&standing(up, Vec3::ONE)), "{up:?}");
        }
        // A relief whose back lies there.
        assert!(!stands_along_z(&standing(UpAxis::Z, Vec3::new(1.0, 0.2, 1.0))));
        let mut away = standing(UpAxis::Z, Vec3::ONE);
        turn_objects(&mut away, Mat3::IDENTITY, DVec3::ZERO);
        Arc::make_mut(&mut away[0].mesh).positions.iter_mut().for_each(|p| p.z += 0.3);
        assert!(!stands_along_z(&away), "it floats");
        for shape in ["box", "sphere"] {
            let mut mesh = build_shape(shape, &ShapeParameters::new()).unwrap();
            let lowest = mesh.bounds().0.z;
            mesh.positions.iter_mut().for_each(|p| p.z -= lowest);
            assert!(!stands_along_z(&[Object { mesh: mesh.into(), ..Object::default() }]), "{shape}");
        }
    }
}
