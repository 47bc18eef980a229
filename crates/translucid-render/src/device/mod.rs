//! A prepared scene as words for a device that traces paths by itself.

mod lights;

pub use lights::{LIGHT_CONSTANTS, LightWords, light_set, lights};
