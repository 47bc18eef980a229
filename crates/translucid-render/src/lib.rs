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
mod path;
mod ray;
mod render;
mod sampling;
mod session;
mod subsurface;
mod surface;
mod world;

pub use ray::{Geometry, Hit, Ray};
pub use render::{
    CheckpointInfo, Edit, FilmLayer, FilmSums, Fraction, Goal, ImageInfo, LayerSizeError, LiveFilm, Outcome,
    PixelRect, PreparedScene, Progress, Renewed, TILE_SIZE, TileSums, View, load_checkpoint, save_checkpoint,
};
pub use session::{CheckpointPlan, Event, Observer, Plan, Rendering, RunningSession, Session, SessionError};
pub use subsurface::transport::points::{PointCloud, PointPass, PointProgress, PointsError};
pub use subsurface::{KernelNote, MaterialNote, NearestParameter, Note, SubsurfaceProfileError};
pub use world::{PixelSample, layer};
