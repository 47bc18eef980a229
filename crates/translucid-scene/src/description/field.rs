//! The fields of a thing: for each its keys, their meaning, range and default, and its place in the thing.

use glam::{Mat3, Vec2, Vec3};

use crate::interval::{Interval, WholeInterval};
use crate::{ColorInput, NormalMap, Projection, ScalarInput, SubsurfaceLayer, SubsurfaceModel};

/// A thing of a scene by its fields: the one list from which it is read, written, checked, shown and documented.
pub struct Thing<T: 'static> {
    /// Its name: of a light the `type`, else the table's.
    pub name: &'static str,
    /// Its description, in a line.
    pub doc: &'static str,
    /// A valid one, with the default of every field that has one of its own.
    pub plain: fn() -> T,
    /// Its fields, in the order in which they are written.
    pub fields: &'static [Field<T>],
    /// Requirements on several fields at once.
    pub rules: &'static [Rule<T>],
}

/// A field of a thing.
pub struct Field<T> {
    /// Its keys: one, or several that place it together.
    pub keys: &'static [Key],
    /// Its value, or [`Slot::Absent`] where `T` is now a variant without it.
    pub slot: fn(&mut T) -> Slot<'_>,
    /// The effect on other fields of a value that is given.
    pub when_given: Option<fn(&mut T)>,
    /// The default that follows from other fields, where there is no value of its own.
    pub when_missing: Option<fn(&mut T)>,
}

/// A key of a table.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// Its meaning in Markdown, with its unit; `{range}` and `{words}` stand for those of the slot.
    pub doc: &'static str,
    /// What counts where it is missing.
    pub fallback: Fallback,
}

/// The value of a key that is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fallback {
    /// There is none: it is an error.
    Required,
    /// That of the plain thing.
    Plain,
    /// A number other than that of the plain thing.
    Number(f32),
    /// Something else, in words.
    Words(&'static str),
}

/// A requirement on several fields at once, which is an error of one of them.
pub struct Rule<T> {
    /// The key that the error is about.
    pub key: &'static str,
    /// The requirement on its value, if it is broken: "must be …".
    pub broken: fn(&T) -> Option<String>,
    /// Advice where the key was not given.
    pub help: &'static str,
}

/// The value of a field, by its kind.
pub enum Slot<'a> {
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

/// A type whose values have names.
pub trait Word: Copy + PartialEq + 'static {
    /// Every value by its name.
    const WORDS: &'static [(&'static str, Self)];
}

/// A value out of a few with names, whatever its type.
pub trait Choice {
    /// All names.
    fn names(&self) -> Vec<&'static str>;
    /// The name of the value.
    fn name(&self) -> &'static str;
    /// Sets the value by the number of its name.
    fn choose(&mut self, number: usize);
}

impl<T: Word> Choice for T {
    fn names(&self) -> Vec<&'static str> {
        T::WORDS.iter().map(|(name, _)| *name).collect()
    }

    fn name(&self) -> &'static str {
        T::WORDS.iter().find(|(_, value)| value == self).map_or("", |(name, _)| name)
    }

    fn choose(&mut self, number: usize) {
        *self = T::WORDS[number].1;
    }
}

impl<T> Field<T> {
    /// The field with an effect of its value on others.
    pub(crate) const fn when_given(self, effect: fn(&mut T)) -> Self {
        Self { when_given: Some(effect), ..self }
    }

    /// The field with a default that follows from others.
    pub(crate) const fn when_missing(self, default: fn(&mut T)) -> Self {
        Self { when_missing: Some(default), ..self }
    }

    /// The key that names the field.
    pub fn key(&self) -> &'static str {
        self.keys[0].name
    }
}

impl<T> Thing<T> {
    /// Every key, in the order of the fields.
    pub fn keys(&self) -> Vec<&'static str> {
        self.fields.iter().flat_map(|field| field.keys).map(|key| key.name).collect()
    }
}

/// A [`Field`] of a type or of a variant: `field!(Light::Sphere { radius } => slot, meaning, fallback)`, whose key is the
/// name of the field; or `field!(Light::Beam { direction, origin } => slot; KEYS)`, for which several belong together.
macro_rules! field {
    ($owner:path { $first:ident } => $slot:expr, $doc:expr, $fallback:expr) => {
        field!($owner { $first } => $slot; &[$crate::description::Key {
            name: stringify!($first),
            doc: $doc,
            fallback: $fallback,
        }])
    };
    ($owner:path { $($part:ident),+ } => $slot:expr; $keys:expr) => {
        $crate::description::Field {
            keys: $keys,
            slot: |thing| match thing {
                $owner { $($part,)+ .. } => $slot,
                #[allow(unreachable_patterns, reason = "a type of one variant has no others")]
                _ => $crate::description::Slot::Absent,
            },
            when_given: None,
            when_missing: None,
        }
    };
}

pub(crate) use field;
