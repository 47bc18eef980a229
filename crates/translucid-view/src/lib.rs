//! `translucid view`: a page that renders a scene live in the browser while its materials and lights are edited.
//!
//! ```text
//! page ⇄ socket → Studio (state, undo) → Engine (renderer's thread) → frames → page
//! ```
//!
//! In WebAssembly a worker stands for the socket, and one thread does everything.
//!
//! One server, one renderer, one state: all pages that are open show the same. `PROTOCOL.md` beside this crate's manifest
//! says what pages and server exchange.
//!
//! # Safety
//! It listens on this machine only, and answers nobody who does not know the token in its address, comes by another name
//! or from another site. A page can name no file: what it brings comes as bytes, within limits, to loaders that are made for
//! hostile ones. Every message is checked before it changes anything.
//!
//! # Out of scope
//! The command line, and messages on a terminal (`translucid-cli`).

mod base;
mod clock;
mod conversation;
mod engine;
mod files;
#[cfg(any(fuzzing, test))]
mod fuzz;
mod json;
mod look;
mod message;
mod meter;
mod numbers;
#[cfg(not(target_family = "wasm"))]
mod page;
mod page_state;
mod profile_panel;
#[cfg(not(target_family = "wasm"))]
mod serve;
#[cfg(not(target_family = "wasm"))]
mod server;
mod settings;
mod shared;
mod smooth;
mod studio;
mod value;
mod view;
#[cfg(target_family = "wasm")]
mod worker;

#[cfg(any(fuzzing, test))]
pub use fuzz::hear_while_fuzzing;
#[cfg(not(target_family = "wasm"))]
pub use serve::{Page, ViewError};
pub use settings::{Devices, LoadTurned, MeshToTurn, OpenDevice, ScriptDevice, Settings};
pub use view::comparable;
