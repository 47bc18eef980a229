//! The things of a scene by their fields, and the values that they are read from and written as.
//!
//! A [`Thing`] lists the fields of a light, a camera, a material …: key, meaning, range, default, and place in the thing.
//! From this one list follow reading, writing and checking, the rows of the look-dev page, the tables of the guide, and
//! the types of Python's stub.

mod check;
mod files;
mod layers;
mod parts;
mod read;
mod slot;
#[cfg(test)]
mod tests;
mod vectors;
mod visit;
mod write;

pub use files::{FileList, FileRequest, image_value};
pub use parts::{Counts, List, Part};
pub use read::{COLOR_KEYS, NORMAL_KEYS, SCALAR_KEYS, read_size};
pub use slot::{Field, SceneSlot, Scenes, Thing};
pub(crate) use translucid_words::field;
pub use translucid_words::{
    Choice, Content, Entry, Fallback, Item, Key, Object, Provenance, Rule, Slot, Table, Value, Word,
    hexadecimal_color, linear_from_srgb, quoted,
};
pub use vectors::Vectors;
pub use visit::Visit;
