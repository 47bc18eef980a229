//! The values of a scene's fields, by their kinds.

use glam::{Mat3, Vec2, Vec3};
use translucid_words::{Choice, Entry, Error, Interval, Key, Kinds, Slot, Table, WholeInterval};

use super::files::FileList;
use super::parts::Counts;
use crate::{ColorInput, NormalMap, Projection, ScalarInput, SubsurfaceLayer, SubsurfaceModel};

/// The family of a scene's things.
#[derive(Clone, Copy, Debug)]
pub struct Scenes;

/// A thing of a scene.
pub type Thing<T> = translucid_words::Thing<T, Scenes>;
/// A field of a scene's thing.
pub type Field<T> = translucid_words::Field<T, Scenes>;

impl Kinds for Scenes {
    type Slot<'a> = SceneSlot<'a>;
    type Context = FileList;
    type Lists = Counts;
}

/// The value of a field, by its kind.
pub enum SceneSlot<'a> {
    /// There is none.
    Absent,
    /// True or false.
    Flag(&'a mut bool),
    /// A whole number.
    Count(&'a mut u32, WholeInterval),
    /// A whole number of 64 bits.
    Seed(&'a mut u64),
    /// Width and height in pixels.
    Size([&'a mut u32; 2], WholeInterval),
    /// A word.
    Word(&'a mut dyn Choice),
    /// A number without a unit.
    Number(&'a mut f32, Interval),
    /// A length in the scene's unit.
    Length(&'a mut f32, Interval),
    /// An angle in degrees.
    Angle(&'a mut f32, Interval),
    /// Two numbers.
    Pair(&'a mut Vec2, Interval),
    /// A point in space.
    Point(&'a mut Vec3),
    /// A direction of any length.
    Vector(&'a mut Vec3),
    /// A color: a number, three numbers, or `"#rrggbb"`.
    Rgb(&'a mut Vec3, Interval),
    /// A number, or three for red, green and blue.
    Triple(&'a mut Vec3, Interval),
    /// A color of radiance or irradiance, which is as bright in a scene of any size.
    Radiance(&'a mut Vec3),
    /// A color of intensity or power, which grows with the square of a scene's size.
    Power(&'a mut Vec3),
    /// A unit direction, along a vector or from a point to another.
    Direction(&'a mut Vec3, Option<Vec3>),
    /// The edges of a rectangle about its center.
    Edges {
        /// Its center.
        center: Vec3,
        /// Its edges.
        edges: [&'a mut Vec3; 2],
    },
    /// The projection of a camera.
    Projection(&'a mut Projection),
    /// A rotation.
    Rotation(&'a mut Mat3),
    /// An image, by its index.
    Image(&'a mut Option<usize>),
    /// A number or an image.
    Scalar(&'a mut ScalarInput, Interval),
    /// A color, an image or vertex colors.
    Color(&'a mut ColorInput, Interval),
    /// A normal map.
    NormalMap(&'a mut Option<NormalMap>),
    /// A model of subsurface scattering, or a table of profiles.
    Model(&'a mut SubsurfaceModel),
    /// Layers below a surface.
    Layers(&'a mut Vec<SubsurfaceLayer>),
}

impl Slot for SceneSlot<'_> {
    type Context = FileList;
    type Lists = Counts;

    fn absent() -> Self {
        Self::Absent
    }

    fn read(self, table: &Table<'_>, keys: &[Key], files: &mut FileList) -> Result<(), Error> {
        self.read_keys(table, keys, files)
    }

    fn fall_back(self, number: f64) {
        if let Self::Number(slot, _) | Self::Length(slot, _) | Self::Angle(slot, _) = self {
            *slot = number as f32;
        }
    }

    fn write(self, keys: &[Key], origin: [f64; 3]) -> Vec<Entry> {
        self.write_keys(keys, origin)
    }

    fn changes(old: Self, new: Self, keys: &[Key]) -> Vec<Entry> {
        Self::write_change(old, new, keys)
    }

    fn check(self, key: &str, counts: &Counts) -> Result<(), Error> {
        self.check_all(key, *counts)
    }
}
