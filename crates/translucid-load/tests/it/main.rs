//! Loaders seen from outside.

#![allow(missing_docs, reason = "a test binary has no public items")]

mod doubling;
mod files;
mod gltf;
mod scans;
