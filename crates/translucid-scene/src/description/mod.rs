//! One description of the things of a scene, and the values that they are read from and written as.
//!
//! A [`Thing`] lists the fields of a light, a camera, a material …: key, meaning, range, default, and place in the thing.
//! From this one list follow reading, writing and checking, the rows of the look-dev page, the tables of the guide, and
//! the types of Python's stub.
//!
//! A [`Value`] comes through one of three doors: a scene file in TOML, a page's JSON, Python's objects.
//! Each door only turns its own values into these; everything behind it is the same, errors included.

mod check;
mod color;
mod field;
mod files;
mod layers;
mod read;
mod table;
#[cfg(test)]
mod tests;
mod value;
mod write;

pub use check::{Counts, List, Part};
pub use color::{hexadecimal_color, linear_from_srgb};
pub(crate) use field::field;
pub use field::{Choice, Fallback, Field, Key, Rule, Slot, Thing, Word};
pub use files::{FileList, FileRequest};
pub use read::{COLOR_KEYS, NORMAL_KEYS, SCALAR_KEYS, read_size};
pub use table::{Item, Provenance, Table};
pub use value::{Content, Entry, Value, quoted};
