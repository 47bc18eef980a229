//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-scene`) and the profiles' mathematics (`translucid-profile`).

pub mod bsdf;
mod camera;
mod checkpoint;
mod directionality;
mod film;
mod fingerprint;
mod frame;
mod geometry;
mod light;
mod material;
mod normalization;
mod path;
mod picture;
mod pixel_blocks;
mod point_based;
mod profile_tables;
mod random_walk;
mod renderer;
mod sampler;
mod shadow;
mod sharing;
mod subsurface;
mod subsurface_pair;
mod subsurface_profile;
mod triangle;
mod wide_tree;

pub use checkpoint::{CheckpointInfo, load_checkpoint, save_checkpoint};
pub use film::{FilmSums, PixelSample, TILE_SIZE, TileSums, layer};
pub use frame::Frame;
pub use geometry::{Geometry, Hit};
pub use light::{EmissiveTriangle, LightHit, LightSample, LightSelection, LightSet};
pub use picture::ImageInfo;
pub use point_based::{PointCloud, PointPass, PointProgress, PointsError};
pub use renderer::{Goal, Outcome, Progress, Renderer};
pub use triangle::Ray;
