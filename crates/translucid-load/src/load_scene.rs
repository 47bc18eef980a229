//! A scene from a file, be it a scene file or a mesh file.

use std::path::Path;

use translucid_scene::{Scene, SceneError, Warning};

use crate::appearance::{warn_of_appearance, warn_of_panorama};
use crate::bare_mesh::load_bare_mesh;
use crate::file::extension;
use crate::kinds::count_kinds;
use crate::loading::Loading;
use crate::options::LoadOptions;
use crate::orientation::Orientation;
use crate::result::Result;
use crate::toml::SceneFile;

/// Loads a scene file (`.toml`), or a mesh file (`.glb`, `.gltf`, `.obj`, `.ply`, `.stl`) as a scene of its own.
///
/// A mesh file gets a material, a camera, lights and a backdrop where it has none.
///
/// # Errors
/// The file cannot be read, or something in it or in the options is wrong: the error names the mistake and its place.
pub fn load_scene(path: &Path, options: &LoadOptions, warnings: &mut Vec<Warning>) -> Result<Scene> {
    load_oriented(path, options, warnings).map(|(scene, _)| scene)
}

/// Loads as [`load_scene`], and says how a mesh file's mesh is turned; a scene file has no orientation.
///
/// # Errors
/// As [`load_scene`].
pub fn load_oriented(
    path: &Path,
    options: &LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<(Scene, Option<Orientation>)> {
    let before = warnings.len();
    let loaded = read_scene(path, options, warnings);
    count_kinds(warnings, before);
    let (scene, orientation) = loaded?;
    warn_of_appearance(&scene, path, warnings);
    let panorama = scene.environment.and_then(|environment| scene.images.get(environment.image?));
    panorama.iter().for_each(|image| warn_of_panorama(image, warnings));
    Ok((scene, orientation))
}

fn read_scene(
    path: &Path,
    options: &LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<(Scene, Option<Orientation>)> {
    if extension(path) == "toml" {
        let file = SceneFile::read(path)?;
        refuse_mesh_options(path, &file, options)?;
        Ok((file.load(options, warnings)?, None))
    } else {
        let mut loading = Loading::new(&options.watch, warnings);
        let (scene, orientation) = load_bare_mesh(path, options, &mut loading)?;
        Ok((Scene { files: loading.into_files(), ..scene }, Some(orientation)))
    }
}

/// A scene file states its own materials and unit.
fn refuse_mesh_options(path: &Path, file: &SceneFile, options: &LoadOptions) -> Result<()> {
    let on_mesh = file.is_on_mesh();
    let (what, of_mesh, of_scene) = match (&options.preset, options.unit) {
        (Some(_), _) => ("a preset", "preset at the top", "preset in a [[material]]"),
        (None, Some(_)) => ("a unit", "unit at the top", "unit at the top"),
        (None, None) if options.up.is_some() => {
            ("an upward axis", "up at the top", "rotate of an [[object]]")
        }
        (None, None) if options.rotate != [0.0; 3] => {
            ("a rotation", "rotate at the top", "rotate of an [[object]]")
        }
        (None, None) if options.floor.is_some() => {
            ("a floor", "floor at the top", "shape = \"plane\" of an [[object]]")
        }
        (None, None) => return Ok(()),
    };
    let key = if on_mesh { of_mesh } else { of_scene };
    let message = format!("{what} is for a bare mesh, but {} is a scene file", path.display());
    Err(SceneError::new(message).with_help(format!("in a scene file it is the key {key}")))
}
