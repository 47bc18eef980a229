//! The WebAssembly module of the npm package `translucid`, whose `package/translucid.js` alone calls it.
//!
//! A call is a text and numbers that the package writes into memory of this module ([`calls`]), and so is its answer.
//! Names, ranges and messages are those of the command and the Python module, in the spelling of JavaScript:
//! `surface_albedo` is `surfaceAlbedo`.
//!
//! # Units
//! Lengths are in any one unit that the caller keeps to.
//!
//! # Out of scope
//! Threads, files, scenes, pictures, walks and tilted beams.

mod ask;
pub mod calls;
mod conversion;
mod exact;
mod export;
mod options;
mod profile;
