//! The C library `libtranslucid`: what `include/translucid.h` declares.
//!
//! The header is made of these files by cbindgen, its comments included; `.ci/c` does it and looks whether it is up to
//! date.
//! Handles are opaque, every entry catches panics and returns a [`TranslucidStatus`](status::TranslucidStatus), and
//! the message of a failure is kept for the thread that met it.
//! Names and ranges are those of the Python module and the command.
//!
//! [`ffi_guard`] alone touches the caller's memory.
//!
//! # Units
//! A profile's lengths are in the unit that the caller chose; those of references by walks are mean free paths; angles
//! are degrees.
//!
//! # Out of scope
//! Fits, scenes and pictures.

#![allow(
    clippy::missing_safety_doc,
    reason = "what callers promise of pointers stands once at the head of the header, in cbindgen.toml"
)]

pub mod conversion;
#[cfg(test)]
mod entry_tests;
pub mod exact;
mod ffi_guard;
mod names;
pub mod preset;
pub mod profile;
pub mod status;
pub mod table;
mod threads;
pub mod version;
pub mod walk;
