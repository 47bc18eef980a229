//! A scene from a file, be it a scene file or a mesh file.

use std::path::Path;

use translucid_scene::{Scene, SceneError, Warning};

use crate::appearance::warn_of_appearance;
use crate::bare_mesh::load_bare_mesh;
use crate::file::extension;
use crate::kinds::count_kinds;
use crate::loading::Loading;
use crate::options::LoadOptions;
use crate::toml::SceneFile;

/// Loads a scene file (`.toml`), or a mesh file (`.glb`, `.gltf`, `.obj`, `.ply`, `.stl`) as a scene of its own.
///
/// A mesh file gets a material, a camera, lights and a backdrop where it has none.
///
/// # Errors
/// The file cannot be read, or something in it or in the options is wrong: the error names the mistake and its place.
pub fn load_scene(
    path: &Path,
    options: &LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Scene, SceneError> {
    let before = warnings.len();
    let scene = read_scene(path, options, warnings);
    count_kinds(warnings, before);
    let scene = scene?;
    warn_of_appearance(&scene, path, warnings);
    Ok(scene)
}

fn read_scene(path: &Path, options: &LoadOptions, warnings: &mut Vec<Warning>) -> Result<Scene, SceneError> {
    if extension(path) == "toml" {
        let file = SceneFile::read(path)?;
        refuse_mesh_options(path, &file, options)?;
        file.load(options, warnings)
    } else {
        let mut loading = Loading::new(&options.watch, warnings);
        let scene = load_bare_mesh(path, options, &mut loading)?;
        Ok(Scene { files: loading.into_files(), ..scene })
    }
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
