//! Scenes and materials from files: TOML, glTF, OBJ, PLY, STL, MaterialX, images, tables of profiles.
//!
//! [`load_scene`] makes a validated [`Scene`](translucid_scene::Scene) of a scene file or a mesh file,
//! [`SceneBuilder`] one of pieces of scene files, and [`still_life`] is the scene that is built in.
//! Every reader goes from bytes to data, or to an error that names the file, the place, the value found and the values allowed.
//!
//! # Units
//! Lengths are in the scene's own unit; angles in files are degrees.
//!
//! # Out of scope
//! Pictures of scenes, and profiles of other than tables.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod appearance;
mod bare_mesh;
mod bodies;
mod creases;
mod extent;
mod file;
#[cfg(target_family = "wasm")]
mod given_files;
mod gltf;
mod image;
mod kinds;
mod load_scene;
mod loading;
mod materialx;
mod mesh_file;
mod metal;
mod model;
mod mtl;
mod number;
mod obj;
mod options;
mod orientation;
mod origin;
mod ply;
mod polygon;
mod primaries;
mod profile_table;
mod result;
mod shared_mesh;
mod stage;
mod still_life;
mod stl;
mod toml;
mod vertex_colors;
mod viewpoint;
mod watch;
mod weld;
mod winding;
mod writer;

pub use appearance::warn_of_panorama;
pub use file::nearest_file;
#[cfg(target_family = "wasm")]
pub use given_files::give_file;
pub use gltf::{load_gltf, parse_gltf};
pub use image::{ExrChannels, decode_image, load_exr, load_image, load_plain_image};
pub use load_scene::{load_oriented, load_scene};
pub use materialx::parse_materialx;
pub use mesh_file::{MeshFile, NamedCamera};
pub use obj::{load_obj, parse_obj};
pub use options::{Floor, LoadOptions, Surroundings};
pub use orientation::{Orientation, UpAxis};
pub use ply::{load_ply, parse_ply};
pub use profile_table::{load_profile_table, parse_profile_table};
pub use still_life::still_life;
pub use stl::{load_stl, parse_stl};
pub use toml::{ExtendedBase, MeshBase, Piece, SceneBuilder, SceneFile, load_toml, name_after_preset};
pub use viewpoint::Viewpoint;
pub use watch::{LoadProgress, LoadWatch};
