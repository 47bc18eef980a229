//! The Monte Carlo walk and the path tracer on graphics processors, in WGSL: with the feature `device` on every GPU that wgpu
//! knows (Vulkan, Metal, DirectX 12), and in browsers by a page's script, which [`program`] is for.
//!
//! *Photons have the same bits on every device.* The white walk of [`translucid_reference::walk`] through half spaces and slabs
//! is a function of seed and index, in arithmetic of which each bit is prescribed (`shaders/arithmetic.wgsl`), and what a table
//! counts are whole numbers: neither the device, nor how many photons walk at a time, nor where a run was cut has a part in the
//! result. A twin in Rust states what the bits are; tests hold it against the exact solution on any machine, and a device
//! against the twin. Slabs thinner than 0.01 mean free paths with a reflecting boundary, |g| above 0.9999, and radii that single
//! precision does not tell apart are refused.
//!
//! *Pictures have the same light on every device.* A `Tracer` takes a prepared scene of
//! `translucid-render` and gives samples of pixels back.
//!
//! # Out of scope
//! The meaning of a table (`translucid-reference`), of a scene's words, and films (`translucid-render`).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

// In a browser a page's script drives devices, with the program alone.
#[cfg(not(target_family = "wasm"))]
mod choice;
#[cfg(not(target_family = "wasm"))]
mod description;
#[cfg(feature = "device")]
mod device;
#[cfg(feature = "device")]
mod picture;
pub mod program;
#[cfg(all(test, feature = "translation"))]
mod translation_tests;
#[cfg(test)]
mod twin;
#[cfg(any(test, feature = "device"))]
mod walk_numbers;

#[cfg(not(target_family = "wasm"))]
pub use choice::{Choice, devices};
#[cfg(not(target_family = "wasm"))]
pub use description::DeviceDescription;
#[cfg(feature = "device")]
pub use device::Gpu;
#[cfg(feature = "device")]
pub use picture::Tracer;
