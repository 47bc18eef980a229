//! Files that are whole or not there.
//!
//! [`write_atomically`] writes a file beside its target and then renames it onto it: no reader meets half of one, and a
//! failure leaves the older file as it was. [`check_writable`] finds out beforehand whether that would succeed.
//!
//! # Out of scope
//! The content and the format of the files: callers bring bytes.

mod atomic_file;
mod error;

pub use atomic_file::{check_writable, write_atomically};
pub use error::OutputError;
