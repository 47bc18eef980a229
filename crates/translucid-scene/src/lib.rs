//! Scene description and loaders: files in, validated data out.
//!
//! A [`Scene`] is everything a renderer needs to make a picture, in plain arrays: cameras, meshes in their
//! places, materials with OpenPBR names, images, lights.
//! It comes from a TOML scene file, a glTF, OBJ or PLY mesh, or from code; materials come from MaterialX, too.
//! A scene from a file is valid, and one that is made in code if [`Scene::validate`] says so: every index is in range,
//! every number finite and within its documented range, so a renderer needs no checks of its own.
//!
//! # Units
//! Lengths are in the scene's own unit ([`Scene::unit`]); colors are linear Rec. 709; angles in files
//! are degrees.
//!
//! # Out of scope
//! Tracing rays, sampling, and any knowledge of how a picture is computed.

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

#[cfg(any(test, feature = "testing"))]
pub mod broken;
mod camera;
mod color;
mod conversion;
mod error;
mod image;
mod interval;
mod light;
mod load;
mod material;
mod mesh;
mod object;
mod preset;
mod profile_table;
mod scene;
mod settings;
mod shapes;
mod still_life;
mod texture;
mod viewpoint;

pub use camera::{Camera, Projection};
pub use conversion::{
    ArgumentNames, Conversion, Converted, ConvertedNumber, Setting, conversion_system_names,
};
pub use error::{Place, SceneError, Warning};
pub use image::{ColorSpace, Image, Pixels};
pub use light::{Environment, Light};
pub use load::{
    ExrChannels, ExtendedBase, Floor, LoadOptions, LoadProgress, LoadWatch, MeshFile, NamedCamera, Piece,
    SceneBuilder, SceneFile, Surroundings, UpAxis, decode_image, load_exr, load_gltf, load_image, load_obj,
    load_ply, load_profile_table, load_scene, load_stl, parse_gltf, parse_materialx, parse_obj, parse_ply,
    parse_profile_table, parse_stl, take_files_read,
};
pub use material::{
    CameraVisibility, Configuration, Material, NormalMap, ParameterValue, SubsurfaceModel,
    SubsurfaceNormalization, SubsurfaceParameter, SubsurfaceTextureAt, WalkSurface, WordValue,
};
pub use mesh::{Mesh, Triangle, repair_mesh};
pub use object::Object;
pub use preset::{Preset, preset, presets};
pub use profile_table::{ProfileRow, ProfileTable};
pub use scene::{Scene, Unit};
pub use settings::{Film, FilterKind, Integrator, SubsurfaceMethod};
pub use shapes::{
    FLAT_SHAPES, ShapeParameter, ShapeParameterKind, ShapeParameters, build_shape, shape_names,
    shape_parameters,
};
pub use still_life::still_life;
pub use texture::{Channel, ColorInput, ScalarInput, TextureRef, Wrap};
pub use translucid_image::ToneMapping;
pub use viewpoint::Viewpoint;
