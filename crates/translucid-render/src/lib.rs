//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-scene`) and the profiles' mathematics (`translucid-profile`).

mod light;
mod path;
mod ray;
mod render;
mod sampling;
mod subsurface;
mod surface;
mod world;

pub use light::{EmissiveTriangle, LightHit, LightSample, LightSelection, LightSet};
pub use ray::{Geometry, Hit, Ray};
pub use render::checkpoint::{CheckpointInfo, load_checkpoint, save_checkpoint};
pub use render::film::{FilmSums, PixelSample, TILE_SIZE, TileSums, layer};
pub use render::picture::ImageInfo;
pub use render::renderer::{Goal, Outcome, Progress, Renderer};
pub use sampling::Frame;
pub use subsurface::transport::points::{PointCloud, PointPass, PointProgress, PointsError};
pub use surface::bsdf;
