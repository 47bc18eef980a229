//! A mesh file, whatever its format: the reader is chosen by the file's extension.

use std::path::Path;

use glam::DVec3;
use translucid_scene::{Mesh, Object, Place, SceneError, Unit};

use crate::file::{extension, stem};
use crate::gltf::read_gltf;
use crate::loading::Loading;
use crate::mesh_file::MeshFile;
use crate::obj::read_obj;
use crate::origin::settle;
use crate::ply::read_ply;
use crate::stl::read_stl;

/// The formats of meshes, as messages list them.
pub(crate) const MESHES: &str = ".glb, .gltf, .obj, .ply or .stl";

/// Formats of scenes and solids that other programs write.
const FOREIGN: [&str; 17] = [
    "3ds", "3mf", "abc", "amf", "dae", "fbx", "iges", "igs", "max", "off", "step", "stp", "usd", "usda",
    "usdc", "usdz", "x3d",
];

/// Returns `true` if the file's extension is that of a mesh format.
pub(crate) fn is_mesh(path: &Path) -> bool {
    matches!(extension(path).as_str(), "glb" | "gltf" | "obj" | "ply" | "stl")
}

pub(crate) fn is_gltf(path: &Path) -> bool {
    matches!(extension(path).as_str(), "gltf" | "glb")
}

/// Loads a mesh file by its extension; its lengths are as the file has them.
pub(crate) fn load_model(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile, SceneError> {
    let mut model = read_model(path, loading)?;
    settle(&mut model);
    Ok(model)
}

fn read_model(path: &Path, loading: &mut Loading<'_>) -> Result<MeshFile, SceneError> {
    if is_gltf(path) {
        return read_gltf(path, Unit::Meter, loading);
    }
    if extension(path) == "obj" {
        return read_obj(path, loading);
    }
    let of_one_object = |(mesh, origin): (Mesh, DVec3)| {
        let object = Object { name: stem(path), mesh: mesh.into(), ..Object::default() };
        MeshFile { origin, objects: vec![object], ..MeshFile::default() }
    };
    if extension(path) == "ply" {
        return read_ply(&loading.read(path)?, path, loading.warnings).map(of_one_object);
    }
    if extension(path) == "stl" {
        return read_stl(&loading.read(path)?, path, loading.warnings).map(of_one_object);
    }
    let extension = extension(path);
    let message = match extension.as_str() {
        "" => String::from("a file without extension is neither a scene nor a mesh"),
        other => format!("a .{other} file is neither a scene nor a mesh"),
    };
    let formats = format!("scenes are .toml, meshes are {MESHES}");
    let help = match extension.as_str() {
        "blend" => format!("export glTF (.glb) from Blender, or render there with the extension; {formats}"),
        other if FOREIGN.contains(&other) => {
            format!("export glTF (.glb) from the program that wrote it, or from Blender; {formats}")
        }
        _ => formats,
    };
    Err(SceneError::at(Place::file(path), message).with_help(help))
}
