//! Loaders seen from outside.

#![allow(missing_docs, reason = "a test binary has no public items")]

mod files;
mod gltf;
mod scans;
