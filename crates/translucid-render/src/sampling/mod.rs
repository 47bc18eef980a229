//! Random numbers, and directions drawn with them.

mod choose;
mod sampler;

pub(crate) use choose::choose;
pub(crate) use sampler::{Reserved, Sampler};
pub use translucid_law::Frame;
pub(crate) use translucid_law::concentric_disk;
