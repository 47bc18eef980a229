//! Scenes as validated data: cameras, meshes, materials, lights.
//!
//! A [`Scene`] is everything a renderer needs to make a picture, in plain arrays: cameras, meshes in their
//! places, materials with OpenPBR names, images, lights.
//! It is made in code, or by `translucid-load` from files; `translucid-shapes` makes meshes by name.
//! [`Scene::validate`] checks it: every index is in range, every number finite and within its documented range, so a
//! renderer needs no checks of its own.
//!
//! # Units
//! Lengths are in the scene's own unit ([`Scene::unit`]); colors are linear Rec. 709.
//!
//! # Out of scope
//! Reading files, tracing rays, sampling, and any knowledge of how a picture is computed.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod camera;
pub mod description;
mod environment;
mod image;
mod light;
mod material;
mod mesh;
mod object;
mod open_body;
mod placement;
mod profile_table;
mod projection;
mod scene;
mod settings;
mod texture;

pub use camera::Camera;
pub use environment::Environment;
pub use image::{ColorSpace, Image, ImageKind, Pixels, SRGB_TABLE, linear_from_srgb};
pub use light::Light;
pub use material::{
    CameraVisibility, Configuration, LayerMedium, Material, SubsurfaceLayer, SubsurfaceModel,
    SubsurfaceNormalization, SubsurfaceParameter, SubsurfaceTextureAt, WalkSurface,
};
pub use mesh::{Mesh, Triangle, repair_mesh};
pub use object::Object;
pub use open_body::OpenBody;
pub use profile_table::ProfileTable;
pub use projection::Projection;
pub use scene::Scene;
pub use settings::{Film, FilterKind, Integrator, SubsurfaceMethod};
pub use texture::{Channel, ColorInput, NormalMap, ScalarInput, TextureFilter, TextureRef, Wrap};
pub use translucid_display::ToneMapping;
pub use translucid_profile::ProfileRow;
pub use translucid_profile::convention::Unit;
pub use translucid_words::{Error as SceneError, Interval, Place, Warning, WholeInterval};
