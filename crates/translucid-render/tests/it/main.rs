//! The renderer against exact answers and against itself; see `translucid-workbench` for scenes from files.
//!
//! Tests whose power is a number of samples, pictures or scenes run at an eighth of it, unless `TRANSLUCID_THOROUGH` is
//! `1`; see `translucid_testing`.
//!
//! ```text
//! cargo test -p translucid-render --test it                          all of them
//! cargo test -p translucid-render --test it sharing                  those of one module
//! TRANSLUCID_THOROUGH=1 cargo test -p translucid-render --test it    with their whole power
//! ```

mod common;

mod agreement;
mod broken_scenes;
mod dense;
mod determinism;
mod exact_answers;
mod groups;
mod instances;
mod layered_profiles;
mod many_lights;
mod models;
mod normalization;
mod on_device;
mod point_based;
mod prepared;
mod random_walk;
mod session;
mod shadow_catcher;
mod shards;
mod sharing;
mod shells;
mod textures;
mod thin_walls;
mod transport;
mod views;
