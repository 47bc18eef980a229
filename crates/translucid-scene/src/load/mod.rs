//! Readers of the file formats, each from bytes to validated data.

mod bare_mesh;
mod extent;
mod file_request;
mod gltf;
mod image;
mod materialx;
mod mesh_file;
mod mtl;
mod number;
mod obj;
mod options;
mod orientation;
mod ply;
mod polygon;
mod profile_table;
mod shared_mesh;
mod stage;
mod stl;
mod toml;
mod watch;

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

pub use gltf::{load_gltf, parse_gltf};
pub use image::{ExrChannels, decode_image, load_exr, load_image};
pub use materialx::parse_materialx;
pub use mesh_file::{MeshFile, NamedCamera};
pub use obj::{load_obj, parse_obj};
pub use options::{Floor, LoadOptions, Surroundings};
pub use orientation::UpAxis;
pub use ply::{load_ply, parse_ply};
pub use profile_table::{load_profile_table, parse_profile_table};
pub use stl::{load_stl, parse_stl};
pub use toml::{ExtendedBase, Piece, SceneBuilder, SceneFile};
pub use watch::{LoadProgress, LoadWatch};

use crate::{Mesh, Object, Place, Scene, SceneError, Unit, Warning};

/// Loads a scene file (`.toml`), or a mesh file (`.glb`, `.gltf`, `.obj`, `.ply`, `.stl`) as a scene of its own.
///
/// A mesh file gets a material, a camera, lights and a backdrop where it has none.
///
/// # Errors
/// The file cannot be read, or something in it or in the options is wrong: the error says what and where.
pub fn load_scene(
    path: &Path,
    options: &LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Scene, SceneError> {
    if extension(path) != "toml" {
        return bare_mesh::load_bare_mesh(path, options, warnings);
    }
    let file = SceneFile::read(path)?;
    refuse_mesh_options(path, &file, options)?;
    file.load(options, warnings)
}

/// A scene file states its own materials and unit.
fn refuse_mesh_options(path: &Path, file: &SceneFile, options: &LoadOptions) -> Result<(), SceneError> {
    let (what, key) = match (&options.preset, options.unit) {
        (Some(_), _) if file.is_on_mesh() => ("a preset", "preset at the top"),
        (Some(_), _) => ("a preset", "preset in a [[material]]"),
        (None, Some(_)) => ("a unit", "unit at the top"),
        (None, None) if options.up.is_some() => ("an upward axis", "rotate of an [[object]]"),
        (None, None) if options.rotate != [0.0; 3] => ("a rotation", "rotate of an [[object]]"),
        (None, None) if options.floor.is_some() => ("a floor", "shape = \"plane\" of an [[object]]"),
        (None, None) => return Ok(()),
    };
    let message = format!("{what} is for a bare mesh, but {} is a scene file", path.display());
    Err(SceneError::new(message).with_help(format!("in a scene file it is the key {key}")))
}

fn extension(path: &Path) -> String {
    path.extension().and_then(OsStr::to_str).unwrap_or_default().to_lowercase()
}

/// A file's name without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn is_gltf(path: &Path) -> bool {
    matches!(extension(path).as_str(), "gltf" | "glb")
}

/// Loads a mesh file by its extension; its lengths are as the file has them.
fn load_model(path: &Path, watch: &LoadWatch, warnings: &mut Vec<Warning>) -> Result<MeshFile, SceneError> {
    if is_gltf(path) {
        return gltf::load_watched(path, Unit::Meter, watch, warnings);
    }
    if extension(path) == "obj" {
        return load_obj(path, warnings);
    }
    let of_one_object = |mesh: Mesh| {
        let object = Object { name: stem(path), mesh: mesh.into(), ..Object::default() };
        MeshFile { objects: vec![object], ..MeshFile::default() }
    };
    if extension(path) == "ply" {
        return load_ply(path, warnings).map(of_one_object);
    }
    if extension(path) == "stl" {
        return load_stl(path, warnings).map(of_one_object);
    }
    let message = match extension(path).as_str() {
        "" => String::from("a file without extension is neither a scene nor a mesh"),
        other => format!("a .{other} file is neither a scene nor a mesh"),
    };
    let help = "scenes are .toml, meshes are .glb, .gltf, .obj, .ply or .stl";
    Err(SceneError::at(Place::file(path), message).with_help(help))
}

/// Reads a file whole.
///
/// # Errors
/// The file is missing, cannot be read, or is not a file: a pipe would keep the reader waiting.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, SceneError> {
    let failure = |reason: String| SceneError::at(Place::file(path), format!("cannot be read: {reason}"));
    let metadata = std::fs::metadata(path).map_err(|error| failure(error.to_string()))?;
    if !metadata.is_file() {
        return Err(failure(String::from("not a file")));
    }
    // What is read and what becomes of it are there at the same time: of text of quadrilaterals seven times its size. Asked
    // for and given back, as a loader that finds no memory on its way could only end the process
    let needed = usize::try_from(metadata.len()).unwrap_or(usize::MAX).saturating_mul(8);
    if Vec::<u8>::new().try_reserve_exact(needed).is_err() {
        let mebibytes = needed as f64 / f64::from(1 << 20);
        let reason = format!("that takes about {mebibytes:.0} MiB of memory, which this process cannot have");
        return Err(failure(reason));
    }
    let content = std::fs::read(path).map_err(|error| failure(error.to_string()))?;
    FILES_READ.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned());
    Ok(content)
}

/// Files that loaders have read: they lie deep in each other, and some are known by names in files only.
static FILES_READ: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// The files that all loaders of the process have read since this was called before: what another machine needs to load the
/// same scene.
pub fn take_files_read() -> Vec<PathBuf> {
    std::mem::take(&mut *FILES_READ.lock().unwrap_or_else(PoisonError::into_inner)).into_iter().collect()
}
