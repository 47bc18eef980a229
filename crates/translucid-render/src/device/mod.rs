//! A prepared scene as words for a device that traces paths by itself, and the passes that it makes.
//!
//! ```text
//! prepared scene → DeviceScene (words) ─┐
//! view → DeviceCamera ──────────────────┴→ TracingDevice::trace → samples of pixels → film
//! ```
//!
//! The meaning of every word is stated once here, and its place is a constant of the shaders ([`shader_constants`]). Whatever a
//! scene needs and devices lack is refused by name.

mod camera;
mod constants;
mod images;
mod instances;
mod lights;
mod limits;
mod material_words;
mod materials;
mod scene;
mod tables;
mod tree;
mod triangles;

pub use camera::DeviceCamera;
pub use constants::shader_constants;
pub use lights::{LightWords, light_set, lights};
pub use limits::DeviceLimits;
pub use scene::{DeviceScene, Header};
pub use tables::material_tables;
pub use tree::DeviceTrees;

use std::sync::Arc;

use crate::render::PathTracing;

/// A device that traces the paths of scenes.
pub trait TracingDevice: Send + Sync {
    /// Name, as its driver gives it.
    fn name(&self) -> &str;

    /// How much it holds.
    fn limits(&self) -> DeviceLimits;

    /// Takes a scene.
    ///
    /// # Errors
    /// It cannot be used, or the scene is too large.
    fn open(self: Arc<Self>, scene: &DeviceScene) -> Result<Box<dyn PathTracing>, String>;
}
