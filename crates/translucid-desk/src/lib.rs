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
#[cfg(not(target_family = "wasm"))]
mod judge;
mod layers;
#[cfg(not(target_family = "wasm"))]
mod oracle;
#[cfg(not(target_family = "wasm"))]
mod phase_function;
#[cfg(target_family = "wasm")]
#[path = "no_phase_function.rs"]
mod phase_function;
#[cfg(not(target_family = "wasm"))]
mod skin;
mod spectra;
mod stack;
#[doc(hidden)]
pub mod wrong;

pub use answer::{About, Answer, Ask, Control, Form, NamedFile, Prepared, Question, Unanswered};
pub use convert::CONVERT;
pub use files::{broken_csv, read_at_most};
#[cfg(not(target_family = "wasm"))]
pub use judge::JUDGE;
#[cfg(not(target_family = "wasm"))]
pub use layers::load_layers;
pub use layers::{LAYERS, stated_layers};
#[cfg(not(target_family = "wasm"))]
pub use oracle::ORACLE;
#[cfg(not(target_family = "wasm"))]
pub use phase_function::{is_phase_file, read_phase_file};
#[cfg(not(target_family = "wasm"))]
pub use skin::SKIN;
pub use stack::STACK;

/// Every question.
#[cfg(not(target_family = "wasm"))]
pub const QUESTIONS: [&dyn Ask; 6] = [&LAYERS, &STACK, &CONVERT, &SKIN, &ORACLE, &JUDGE];
/// Every question.
#[cfg(target_family = "wasm")]
pub const QUESTIONS: [&dyn Ask; 3] = IN_WASM;

/// Questions that WebAssembly has, where the reference has no walks.
pub const IN_WASM: [&dyn Ask; 3] = [&LAYERS, &STACK, &CONVERT];
