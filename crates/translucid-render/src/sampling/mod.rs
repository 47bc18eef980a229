//! Random numbers and what directions are drawn with.

mod choose;
mod disk;
mod frame;
mod sampler;
mod split_mix;

pub(crate) use choose::choose;
pub(crate) use disk::concentric_disk;
pub use frame::Frame;
pub(crate) use sampler::{Reserved, Sampler};
pub(crate) use split_mix::{SPLIT_MIX_STEP, split_mix};
