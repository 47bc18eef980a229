//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-scene`) and the profiles' mathematics (`translucid-profile`).

mod light;
mod output;
mod path;
mod ray;
mod render;
mod sampling;
mod subsurface;
mod surface;
mod world;

pub use light::{EmissiveTriangle, LightHit, LightSample, LightSelection, LightSet};
pub use output::{
    CheckpointInfo, DENOISER_VARIABLE, DenoiseError, Denoised, Denoiser, ImageInfo, OutputError,
    check_writable, display_from_linear, load_checkpoint, save_checkpoint, write_atomically,
    write_denoised_png, write_exr, write_exr_with_denoised, write_png,
};
pub use ray::{Geometry, Hit, Ray};
pub use render::film::{FilmSums, PixelSample, TILE_SIZE, TileSums, layer};
pub use render::renderer::{Goal, Outcome, Progress, Renderer};
pub use sampling::Frame;
pub use subsurface::transport::points::{PointCloud, PointPass, PointProgress, PointsError};
pub use surface::bsdf;
