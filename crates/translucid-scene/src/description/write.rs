//! Writing the fields of a scene's things as the keys and values of a table.

use glam::{Mat3, Vec3};
use translucid_words::{Entry, Key, Value, digits, is_same};

use super::layers::write_layers;
use super::slot::SceneSlot;
use crate::{ColorInput, NormalMap, Projection, ScalarInput, SubsurfaceModel};

impl SceneSlot<'_> {
    /// The keys with their values, points counted from the origin.
    pub(super) fn write_keys(self, keys: &[Key], origin: [f64; 3]) -> Vec<Entry> {
        let value: Value = match self {
            Self::Point(point) if origin != [0.0; 3] => {
                Value::list(&[0, 1, 2].map(|axis| digits(point[axis]) + origin[axis]))
            }
            Self::Absent | Self::Image(_) | Self::NormalMap(_) => return Vec::new(),
            Self::Flag(flag) => (*flag).into(),
            Self::Count(n, _) => (*n).into(),
            Self::Seed(n) => (*n).into(),
            Self::Size([width, height], _) => Value::list(&[*width, *height]),
            Self::Word(word) => word.name().into(),
            Self::Number(x, _) | Self::Length(x, _) | Self::Angle(x, _) => (*x).into(),
            Self::Pair(pair, _) => Value::list(&pair.to_array()),
            Self::Point(vector) | Self::Vector(vector) => vector.to_array().into(),
            Self::Rgb(color, _) | Self::Triple(color, _) | Self::Radiance(color) | Self::Power(color) => {
                Value::color(color.to_array())
            }
            Self::Scalar(input, _) => input.factor.into(),
            Self::Color(input, _) => Value::color(input.factor.to_array()),
            Self::Direction(direction, _) => return vec![direction_entry(*direction)],
            Self::Edges { edges: [x, y], .. } => {
                return vec![Entry::new("edge_x", x.to_array()), Entry::new("edge_y", y.to_array())];
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

impl SceneSlot<'_> {
    /// The keys by which a value differs from another. An image stays or goes; another one is not written.
    pub(super) fn write_change(old: Self, new: Self, keys: &[Key]) -> Vec<Entry> {
        let key = keys[0].name;
        match (old, new) {
            (Self::Scalar(old, _), Self::Scalar(new, _)) => scalar_change(key, old, new),
            (Self::Color(old, _), Self::Color(new, _)) => color_change(key, old, new),
            (Self::NormalMap(old), Self::NormalMap(new)) => normal_change(key, *old, *new),
            (old, new) => {
                let [old, new] = [old, new].map(|slot| slot.write_keys(keys, [0.0; 3]));
                if is_same(&old, &new) { Vec::new() } else { new }
            }
        }
    }
}

/// A direction, in the form that is not normalized where that would change its bits.
fn direction_entry(direction: Vec3) -> Entry {
    let is_kept = direction.as_dvec3().try_normalize().map(|read| read.as_vec3()) == Some(direction);
    Entry::new(if is_kept { "direction" } else { "unit_direction" }, direction.to_array())
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
        false if new.texture.is_none() => Value::color(new.factor.to_array()),
        vertex_color => {
            let mut entries = Vec::new();
            if old.texture.is_some() && new.texture.is_none() {
                entries.push(Entry::new("file", "none"));
            }
            entries.push(Entry::new("factor", Value::color(new.factor.to_array())));
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
