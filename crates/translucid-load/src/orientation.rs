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

/// How a bare mesh is turned: first its axis up, then by angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// The axis of the file that points up.
    pub up: UpAxis,
    /// Angles about x, then y, then z by which the objects are turned about their middle, once y is up \[degrees\].
    pub rotate: [f32; 3],
}

/// The axis that the flat underside of meshes without an axis of their own shows to be up, if one does.
///
/// The underside is the largest flat side by far, below the middle, of meshes that are not low above it: a relief lies on its
/// back, and a box could stand on each side. Meshes that could stand on the opposite end, too, such as tables, do so if
/// that is the lower one. A flat side at the lowest y is as good as any other.
pub(super) fn axis_of_underside(objects: &[Object]) -> Option<UpAxis> {
    /// Least share of the box across.
    const LEAST: f64 = 0.1;
    let (low, high) = bounds(objects);
    let extent = high - low;
    let slack = FLAT * extent.max_element();
    let sides = [0, 1, 2].map(|axis| Side::both(objects, axis, (low, high), slack));
    let share = |axis: usize| sides[axis][0].share.max(sides[axis][1].share);
    let axis = [1, 2, 0].into_iter().max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
    let largest = share(axis);
    if largest < LEAST {
        return None;
    }
    if sides[1][0].share > 0.9 * largest {
        return Some(UpAxis::Y);
    }
    let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
    // What stands on the plane of zero about the origin was put there
    let is_about_zero = |axis: usize| low[axis] < -0.1 * extent[axis] && high[axis] > 0.1 * extent[axis];
    let was_put = low[axis].abs() <= slack && is_about_zero(u) && is_about_zero(v);
    let least_height = if was_put { 0.5 } else { 0.75 } * extent[u].max(extent[v]);
    if share(u).max(share(v)) > 0.5 * largest || extent[axis] < least_height {
        return None;
    }
    let [lower, upper] = &sides[axis];
    let is_upright = lower.share > 0.5 * upper.share || lower.supports((low, high), LEAST);
    let base = if lower.share > 0.5 * upper.share { lower } else { upper };
    base.supports((low, high), 0.0).then_some(match (axis, is_upright) {
        (0, true) => UpAxis::X,
        (0, false) => UpAxis::MinusX,
        (1, true) => UpAxis::Y,
        (1, false) => UpAxis::MinusY,
        (_, true) => UpAxis::Z,
        (_, false) => UpAxis::MinusZ,
    })
}

/// Depth of what counts as one flat side, as a share of the longest edge of the box.
const FLAT: f32 = 0.005;

/// The triangles that lie in one side of the box.
#[derive(Clone, Copy)]
struct Side {
    axis: usize,
    /// Their area as a share of the box's across.
    share: f64,
    /// The box about what touches the side.
    touching: (DVec3, DVec3),
}

impl Side {
    /// The sides at the low and the high end of an axis.
    fn both(objects: &[Object], axis: usize, (low, high): (Vec3, Vec3), slack: f32) -> [Self; 2] {
        let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let mut sides = [Self { axis, share: 0.0, touching: nothing }; 2];
        let triangles = objects.iter().flat_map(|object| {
            object.mesh.triangles.iter().filter_map(|triangle| object.mesh.corners(triangle))
        });
        let levels = [f64::from(low[axis] + slack), f64::from(high[axis] - slack)];
        for corners in triangles {
            let is_in = |corner: &DVec3| [corner[axis] <= levels[0], corner[axis] >= levels[1]];
            for (number, side) in sides.iter_mut().enumerate() {
                let mut is_flat = true;
                for corner in &corners {
                    if is_in(corner)[number] {
                        side.touching = (side.touching.0.min(*corner), side.touching.1.max(*corner));
                    } else {
                        is_flat = false;
                    }
                }
                if is_flat {
                    let [a, b, c] = corners;
                    side.share += 0.5 * (b - a).cross(c - a)[axis].abs();
                }
            }
        }
        let extent = (high - low).as_dvec3();
        let across = (extent[(axis + 1) % 3] * extent[(axis + 2) % 3]).max(f64::MIN_POSITIVE);
        sides.map(|side| Self { share: side.share / across, ..side })
    }

    /// Whether the middle of the box is above what touches the side, which is wide enough to stand on.
    fn supports(&self, (low, high): (Vec3, Vec3), least: f64) -> bool {
        let middle = 0.5 * (low + high).as_dvec3();
        let (from, to) = self.touching;
        let across = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        let shares = across
            .map(|axis| (to[axis] - from[axis]) / f64::from(high[axis] - low[axis]).max(f64::MIN_POSITIVE));
        across.iter().all(|&axis| from[axis] <= middle[axis] && middle[axis] <= to[axis])
            && shares[0] * shares[1] > least
    }
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

    /// Objects moved by a vector.
    fn moved(mut objects: Vec<Object>, by: Vec3) -> Vec<Object> {
        Arc::make_mut(&mut objects[0].mesh).positions.iter_mut().for_each(|p| *p += by);
        objects
    }

    #[test]
    fn underside_shows_any_axis_wherever_it_is() {
        for (_, up) in UpAxis::WORDS {
            assert_eq!(axis_of_underside(&standing(up, Vec3::ONE)), Some(up));
            let away = moved(standing(up, Vec3::ONE), Vec3::new(0.3, -7.0, 3.0));
            assert_eq!(axis_of_underside(&away), Some(up));
        }
    }

    #[test]
    fn relief_is_not_taken_for_what_stands_on_its_back() {
        // Low ones, and what is half as high as wide unless it was put on the plane of zero
        for (height, is_sure) in [(0.2, false), (0.5, true), (0.8, true)] {
            let relief = standing(UpAxis::Z, Vec3::new(1.0, height, 1.0));
            assert_eq!(axis_of_underside(&relief).is_some(), is_sure, "{height}");
            let away = axis_of_underside(&moved(relief, Vec3::splat(2.0)));
            assert_eq!(away.is_some(), is_sure && height > 0.6, "{height}");
        }
    }

    fn built_in(shape: &str) -> Vec<Object> {
        let mesh = build_shape(shape, &ShapeParameters::new()).unwrap();
        vec![Object { mesh: mesh.into(), ..Object::default() }]
    }

    #[test]
    fn what_stands_on_any_side_stays_and_what_is_round_shows_nothing() {
        assert_eq!(axis_of_underside(&built_in("box")), Some(UpAxis::Y));
        assert_eq!(axis_of_underside(&built_in("sphere")), None);
        assert_eq!(axis_of_underside(&[]), None);
    }

    /// Boxes between corners.
    fn boxes(corners: &[[Vec3; 2]]) -> Vec<Object> {
        let object = |[low, high]: &[Vec3; 2]| {
            let mut object = built_in("box").remove(0);
            let (from, to) = object.mesh.bounds();
            let place = |p: Vec3| *low + (p - from) / (to - from) * (*high - *low);
            Arc::make_mut(&mut object.mesh).positions.iter_mut().for_each(|p| *p = place(*p));
            object
        };
        corners.iter().map(object).collect()
    }

    /// A table has its large flat side above, and still stands on its legs; a bust has a square plinth.
    #[test]
    fn table_stands_on_its_legs_and_a_bust_on_its_plinth() {
        let leg = |x: f32, z: f32| [Vec3::new(x, 0.0, z), Vec3::new(x + 0.05, 0.9, z + 0.05)];
        let mut table = boxes(&[
            [Vec3::new(0.0, 0.9, 0.0), Vec3::ONE],
            leg(0.0, 0.0),
            leg(0.95, 0.0),
            leg(0.0, 0.95),
            leg(0.95, 0.95),
        ]);
        assert_eq!(axis_of_underside(&table), Some(UpAxis::Y));
        turn_objects(&mut table, UpAxis::Z.rotation().transpose(), DVec3::ZERO);
        assert_eq!(axis_of_underside(&table), Some(UpAxis::Z));
        let mut bust = boxes(&[[Vec3::new(-0.6, -0.2, -0.6), Vec3::new(0.6, 0.0, 0.6)]]);
        bust.extend(standing(UpAxis::Y, Vec3::splat(1.2)));
        turn_objects(&mut bust, UpAxis::Z.rotation().transpose(), DVec3::ZERO);
        assert_eq!(axis_of_underside(&bust), Some(UpAxis::Z));
    }
}
