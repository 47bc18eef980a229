//! The renderer on scenes from files: extreme ones, and one of which an independent path tracer has given the truth.
//!
//! Tests whose power is a number of samples, pictures or scenes run at an eighth of it, unless `TRANSLUCID_THOROUGH` is
//! `1`; see `translucid_testing`.

#[allow(dead_code, reason = "the renderer's own tests use the rest")]
#[path = "../../../translucid-render/tests/it/common/rendering.rs"]
mod common;

mod fuzzed_scenes;
mod volume_truth;
