//! A path tracer that renders subsurface scattering with approximate reflectance profiles.
//!
//! ```text
//! Scene → PreparedScene + View → Session → LiveFilm → picture
//! ```
//!
//! # A picture from code
//! ```
//! use std::sync::atomic::{AtomicBool, Ordering};
//!
//! use glam::Vec3;
//! use translucid_render::{Event, FilmLayer, Plan, PreparedScene, Session};
//! use translucid_scene::{
//!     Camera, ColorInput, Environment, Film, Material, Mesh, Object, ScalarInput, Scene, Unit,
//! };
//!
//! // A pyramid of wax under an even sky, in millimeters
//! let mesh = Mesh {
//!     positions: vec![Vec3::Y * 9.0, Vec3::X * 6.0, Vec3::new(-3.0, 0.0, -5.2), Vec3::new(-3.0, 0.0, 5.2)],
//!     triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
//!     ..Mesh::default()
//! };
//! let wax = Material {
//!     name: "wax".into(),
//!     subsurface_weight: ScalarInput::constant(1.0),
//!     subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.7, 0.4)),
//!     subsurface_radius: ScalarInput::constant(1.5),
//!     ..Material::default()
//! };
//! let scene = Scene {
//!     unit: Unit::Millimeter,
//!     camera: Camera { position: Vec3::new(8.0, 12.0, 24.0), target: Vec3::Y * 4.0, ..Camera::default() },
//!     film: Film { width: 64, height: 48, ..Film::default() },
//!     objects: vec![Object { name: "pyramid".into(), mesh: mesh.into(), ..Object::default() }],
//!     materials: vec![wax],
//!     environment: Some(Environment { radiance: Vec3::splat(0.8), ..Environment::default() }),
//!     ..Scene::default()
//! };
//!
//! // Prepare it; an invalid scene gives an error that names its place
//! let prepared = PreparedScene::new(scene)?;
//! let view = prepared.view()?;
//! let mut session = Session::new(prepared, view);
//!
//! // Render with progress and a stop button, here pressed after two of eight samples
//! let stop = AtomicBool::new(false);
//! let observer = |event: &Event<'_>| {
//!     if let Event::Samples(progress) = event {
//!         println!("{} of {} paths", progress.samples_done, progress.samples_total);
//!         stop.fetch_or(progress.samples_done >= 2 * 64 * 48, Ordering::Relaxed);
//!     }
//! };
//! session.run(&Plan::samples(8), &observer, &stop)?;
//!
//! // Read the picture; another thread could while it was rendered
//! let pixels = session.film().layer(FilmLayer::Radiance);
//! assert!(pixels[(24 * 64 + 32) * 3] > 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Units
//! Lengths in the scene's unit, colors linear Rec. 709, angles in radians unless a name says degrees.
//!
//! # Out of scope
//! Reading scenes (`translucid-load`) and the profiles' mathematics (`translucid-profile`).

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

#[doc(hidden)]
pub mod device;
#[doc(hidden)]
pub mod internals;
mod light;
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
    AT_ONCE, Edit, FilmLayer, FilmSums, Fingerprint, Fraction, Gap, Goal, ImageInfo, LiveFilm,
    MOST_MATTE_SAMPLES, Outcome, PathTracing, Picked, Picker, PreparedScene, Renewed, SampleProgress,
    SampleRanges, ShardHeader, ShardMerge, ShardNotes, ShardReader, ShardRun, TILE_SIZE, TileSums,
    TracedBlock, View, add_samples, content_hash, is_shard, matte_hash, matte_id, save_shard,
};
pub use session::{
    CheckpointPlan, Event, Observer, OnDevice, Plan, RunningSession, Session, available_memory,
};
pub use subsurface::transport::points::{PointCloud, PointPass, PointPlan, PointProgress};
pub use subsurface::{Note, NoteKind};
pub use world::{PixelSample, layer};
