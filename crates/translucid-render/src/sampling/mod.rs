//! Random numbers, and directions drawn with them.

mod choose;
mod disk;
mod frame;
mod sampler;

pub(crate) use choose::choose;
pub(crate) use disk::concentric_disk;
pub use frame::Frame;
pub(crate) use sampler::{Reserved, Sampler};
