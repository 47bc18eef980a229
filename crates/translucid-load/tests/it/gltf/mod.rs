//! The glTF loader on whole files: what it makes of sound ones and what it says of broken ones.

#![allow(clippy::needless_pass_by_value, reason = "JSON literals are handed over")]

mod alone;
mod broken;
mod builder;
mod draco;
mod geometry;
mod hierarchy;
mod materials;
mod mutation;
mod pose;
