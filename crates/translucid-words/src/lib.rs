//! Values with their places, and things described once.
//!
//! A [`Value`] comes through one of several doors: a file in TOML, the options of a command, a page's JSON, Python's objects.
//! Each door only turns its own values into these; everything behind it is the same, errors included.
//!
//! A [`Thing`] lists the fields of a light, a layer, a question …: key, meaning, range, default, and place in the thing.
//! From this one list follow reading, writing and checking, and whatever shows or documents it.
//!
//! It knows the names and errors of the crates of numbers below it, and nothing else, so that editing it recompiles none of
//! what computes.
//!
//! # Out of scope
//! Reading files, and any knowledge of what the things are.

mod ask;
mod color;
mod data_table;
mod error;
mod interval;
mod table;
mod thing;
mod value;
mod word;

pub use ask::{
    Context, Described, Kind, Load, Parse, Placed, QuestionSlot, Questions, Varied, Vary, describe, document,
    flag, number, numbers, optional, optional_word, parsed, path, table, text, texts, things, varied, whole,
    word, words,
};
pub use color::{hexadecimal_color, linear_from_srgb};
pub use data_table::{Cell, Column, DataTable, exact};
pub use error::{Error, Place, Warning};
pub use interval::{Interval, WholeInterval, check_index, refusal};
pub use table::{Item, Provenance, Spelling, Table};
pub use thing::{Fallback, Field, Key, Kinds, Rule, Slot, Thing, is_same, one_of};
pub use value::{Content, Entry, Object, Value, digits, quoted};
pub use word::{Choice, Word};
