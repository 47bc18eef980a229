//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-scene`) and the profiles' mathematics (`translucid-profile`).

mod light;
#[doc(hidden)]
pub mod measure;
mod output;
mod path;
mod ray;
mod render;
mod sampling;
mod session;
mod shim;
mod subsurface;
mod surface;
mod world;

pub use output::{
    CheckpointInfo, DENOISER_VARIABLE, DenoiseError, Denoised, Denoiser, ImageInfo, OutputError,
    check_writable, display_from_linear, load_checkpoint, save_checkpoint, write_atomically,
    write_denoised_png, write_exr, write_exr_with_denoised, write_png,
};
pub use ray::{Geometry, Hit, Ray};
pub use render::{
    Edit, FilmLayer, FilmSums, Fraction, Goal, LayerSizeError, LiveFilm, Outcome, PixelRect, PreparedScene,
    Progress, Renewed, TILE_SIZE, TileSums, View,
};
pub use session::{CheckpointPlan, Event, Observer, Plan, Rendering, RunningSession, Session, SessionError};
pub use subsurface::transport::points::{PointCloud, PointPass, PointProgress, PointsError};
pub use subsurface::{KernelNote, MaterialNote, NearestParameter, Note, SubsurfaceProfileError};
pub use world::{PixelSample, layer};
