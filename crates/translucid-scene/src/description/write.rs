//! Writing a thing's fields as the keys and values of a table.

use glam::{DVec3, Mat3, Vec3};

use super::field::{Field, Key, Slot, Thing};
use super::layers::write_layers;
use super::value::{Entry, Value, digits};
use crate::{ColorInput, NormalMap, Projection, ScalarInput, SubsurfaceModel};

impl<T: Clone> Thing<T> {
    /// Every key with its value, from which the thing is read again, but for its images.
    pub fn write(&self, thing: &T) -> Vec<Entry> {
        self.write_at(thing, DVec3::ZERO)
    }

    /// As [`write`](Self::write), of a thing in a scene of this [origin](crate::Scene::origin).
    pub fn write_at(&self, thing: &T, origin: DVec3) -> Vec<Entry> {
        let mut copy = thing.clone();
        let entries = |field: &Field<T>| match (field.slot)(&mut copy) {
            Slot::Point(point) if origin != DVec3::ZERO => {
                let from_world = [0, 1, 2].map(|axis| digits(point[axis]) + origin[axis]);
                vec![Entry::new(field.key(), Value::list(&from_world))]
            }
            slot => slot.write(field.keys),
        };
        self.fields.iter().flat_map(entries).collect()
    }

    /// The value of a key, as messages have it.
    pub(super) fn shown(&self, thing: &T, key: &str) -> String {
        let entry = self.write(thing).into_iter().find(|entry| entry.key == key);
        entry.map_or(String::new(), |entry| format!("{:#}", entry.value))
    }

    /// The keys by which a thing differs from another, with their values.
    pub fn write_changes(&self, from: &T, to: &T) -> Vec<Entry> {
        let (mut from, mut to) = (from.clone(), to.clone());
        let changes = |field: &Field<T>| {
            let (old, new) = ((field.slot)(&mut from), (field.slot)(&mut to));
            match (old, new) {
                (Slot::Scalar(old, _), Slot::Scalar(new, _)) => scalar_change(field.key(), old, new),
                (Slot::Color(old, _), Slot::Color(new, _)) => color_change(field.key(), old, new),
                (Slot::NormalMap(old), Slot::NormalMap(new)) => normal_change(field.key(), *old, *new),
                (old, new) => {
                    let (old, new) = (old.write(field.keys), new.write(field.keys));
                    if is_same(&old, &new) { Vec::new() } else { new }
                }
            }
        };
        self.fields.iter().flat_map(changes).collect()
    }
}

/// Whether entries are written alike: 0 and -0 are not.
fn is_same(old: &[Entry], new: &[Entry]) -> bool {
    old.len() == new.len() && old.iter().zip(new).all(|(old, new)| old.to_string() == new.to_string())
}

impl Slot<'_> {
    /// The keys with their values.
    pub fn write(self, keys: &[Key]) -> Vec<Entry> {
        let value: Value = match self {
            Self::Absent | Self::Image(_) | Self::NormalMap(_) => return Vec::new(),
            Self::Flag(flag) => (*flag).into(),
            Self::Count(n, _) => (*n).into(),
            Self::Seed(n) => (*n).into(),
            Self::Size([width, height], _) => Value::list(&[*width, *height]),
            Self::Word(word) => word.name().into(),
            Self::Number(x, _) | Self::Length(x, _) | Self::Angle(x, _) => (*x).into(),
            Self::Pair(pair, _) => Value::list(&pair.to_array()),
            Self::Point(vector) | Self::Vector(vector) => (*vector).into(),
            Self::Radiance(color) | Self::Power(color) => Value::color(*color),
            Self::Scalar(input, _) => input.factor.into(),
            Self::Color(input, _) => Value::color(input.factor),
            Self::Direction(direction, _) => return vec![direction_entry(*direction)],
            Self::Edges { edges: [x, y], .. } => {
                return vec![Entry::new("edge_x", *x), Entry::new("edge_y", *y)];
            }
            Self::Projection(Projection::Perspective { horizontal_fov }) => {
                return vec![Entry::new("fov", *horizontal_fov)];
            }
            Self::Projection(Projection::Orthographic { width }) => {
                return vec![Entry::new("projection", "orthographic"), Entry::new("width", *width)];
            }
            Self::Rotation(matrix) => return vec![rotation_entry(*matrix)],
            Self::Model(SubsurfaceModel::Tabulated(_)) => return Vec::new(),
            Self::Model(model) => model.name().into(),
            Self::Layers(layers) => write_layers(layers),
        };
        vec![Entry::new(keys[0].name, value)]
    }
}

/// A direction, in the form that is not normalized where that would change its bits.
fn direction_entry(direction: Vec3) -> Entry {
    let is_kept = direction.as_dvec3().try_normalize().map(|read| read.as_vec3()) == Some(direction);
    Entry::new(if is_kept { "direction" } else { "unit_direction" }, direction)
}

fn rotation_entry(matrix: Mat3) -> Entry {
    match degrees(matrix) {
        Some(angle) => Entry::new("rotation", angle),
        None => Entry::new("matrix", Value::list(&matrix.transpose().to_cols_array())),
    }
}

/// The angle about y that gives the very bits of a rotation, with few digits if there is such a one.
fn degrees(rotation: Mat3) -> Option<f32> {
    let bits = |matrix: Mat3| matrix.to_cols_array().map(f32::to_bits);
    let angle = libm::atan2(f64::from(rotation.z_axis.x), f64::from(rotation.z_axis.z)).to_degrees();
    let rounded = (0..6).map(|digits| 10_f64.powi(digits)).map(|unit| ((angle * unit).round() / unit) as f32);
    let exact = (-4..=4).map(|step| f32::from_bits((angle as f32).to_bits().wrapping_add_signed(step)));
    rounded.chain(exact).find(|angle| bits(Mat3::from_rotation_y(angle.to_radians())) == bits(rotation))
}

/// The value of a scalar that differs. An image stays or goes; another one is not written.
fn scalar_change(key: &str, old: &ScalarInput, new: &ScalarInput) -> Vec<Entry> {
    if old.texture == new.texture && old.factor.to_bits() == new.factor.to_bits() {
        return Vec::new();
    }
    let factor = Value::from(new.factor);
    let is_textured = new.texture.is_some();
    vec![Entry::new(key, if is_textured { vec![Entry::new("factor", factor)].into() } else { factor })]
}

/// The value of a color that differs. An image stays or goes; another one is not written.
fn color_change(key: &str, old: &ColorInput, new: &ColorInput) -> Vec<Entry> {
    let bits = |color: Vec3| color.to_array().map(f32::to_bits);
    let is_same_kind = old.texture == new.texture && old.vertex_color == new.vertex_color;
    if is_same_kind && bits(old.factor) == bits(new.factor) {
        return Vec::new();
    }
    let value = match new.vertex_color {
        true if new.texture.is_none() && new.factor == Vec3::ONE => "vertex".into(),
        false if new.texture.is_none() => Value::color(new.factor),
        vertex_color => {
            let mut entries = Vec::new();
            if old.texture.is_some() && new.texture.is_none() {
                entries.push(Entry::new("file", "none"));
            }
            entries.push(Entry::new("factor", Value::color(new.factor)));
            entries.push(Entry::new("vertex_color", vertex_color));
            entries.into()
        }
    };
    vec![Entry::new(key, value)]
}

fn normal_change(key: &str, old: Option<NormalMap>, new: Option<NormalMap>) -> Vec<Entry> {
    match (old, new) {
        (Some(_), None) => vec![Entry::new(key, "none")],
        (Some(old), Some(new)) if old.scale.to_bits() != new.scale.to_bits() => {
            vec![Entry::new(key, vec![Entry::new("scale", new.scale)])]
        }
        _ => Vec::new(),
    }
}
