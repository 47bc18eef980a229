//! Broken scenes for tests of other crates; beside them, benches of the renderer and its tests on scenes from files.
//!
//! Readers of files are known to those benches and tests only. The library knows none, and no renderer: a change of a reader
//! compiles no test of the renderer.
//!
//! # Out of scope
//! Helpers without scenes are in `translucid-testing`, on which the tests of every crate depend.

mod broken_scenes;
mod everything;

pub use broken_scenes::{BrokenScene, broken_scenes};
pub use everything::scene_of_everything;
