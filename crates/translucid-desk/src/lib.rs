//! The desk: every question that translucid answers.
//!
//! A question is a file here: a [`Thing`](translucid_words::Thing), which describes all that a user may say, and a function
//! that answers it. Doors (the command, Python, JavaScript) make their options, signatures, documentation and errors from
//! the description, pass values on, and show the [`Answer`].
//!
//! # Out of scope
//! Options, progress bars, formats of tables, threads: those are the doors'. Computing: that is of the crates below.

mod answer;
mod conversion_table;
mod convert;
mod files;
mod layers;
mod phase_function;
mod spectra;
mod stack;
#[doc(hidden)]
pub mod wrong;

pub use answer::{Answer, Ask, Control, NamedFile, Prepared, Question, Unanswered};
pub use convert::CONVERT;
#[cfg(not(target_family = "wasm"))]
pub use layers::load_layers;
pub use layers::{LAYERS, stated_layers};
pub use phase_function::{is_phase_file, read_phase_file};
pub use stack::STACK;

/// Every question.
pub const QUESTIONS: [&dyn Ask; 3] = [&LAYERS, &STACK, &CONVERT];
