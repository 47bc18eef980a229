//! A mesh file alone, as a scene: with a preset's material, camera, lights and backdrop.

use std::path::Path;

use super::model::Model;
use super::{LoadOptions, is_gltf, load_model};
use crate::frame_mesh::Frame;
use crate::preset::preset;
use crate::{ColorInput, Film, Integrator, Material, Object, Scene, SceneError, Unit, Warning};

/// Material of a mesh without its own where no preset is asked for.
const DEFAULT_PRESET: &str = "marble";

/// Makes a scene of a mesh file.
pub(super) fn load_bare_mesh(
    path: &Path,
    options: &LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Result<Scene, SceneError> {
    if !options.mesh_overrides.is_empty() {
        let message = format!("{} is a mesh itself, so no mesh in it can be replaced", path.display());
        return Err(SceneError::new(message).with_help("mesh paths are for scene files"));
    }
    let wanted = options.preset.as_deref().map(preset).transpose()?;
    let mut model = load_model(path, warnings)?;
    let unit = options.unit.unwrap_or_else(|| usual_unit(path));
    if let Some(preset) = wanted {
        use_preset(&mut model, &preset.material(unit));
    } else if model.materials.is_empty() {
        let default = preset(DEFAULT_PRESET)?;
        use_preset(&mut model, &default.material(unit));
        use_vertex_colors(&mut model);
    }
    Ok(stage(model, unit, options))
}

/// Meters in glTF, by its specification; millimeters where the format says nothing.
fn usual_unit(path: &Path) -> Unit {
    if is_gltf(path) { Unit::Meter } else { Unit::Millimeter }
}

/// The preset's substance for all objects; what the file says of their geometry stays.
fn use_preset(model: &mut Model, preset: &Material) {
    if model.materials.is_empty() {
        model.objects.iter_mut().for_each(|object| object.material = 0);
        model.materials.push(preset.clone());
    }
    for material in &mut model.materials {
        *material = Material {
            geometry_normal: material.geometry_normal,
            geometry_opacity: material.geometry_opacity,
            ..preset.clone()
        };
    }
}

/// Lets vertex colors be the surface albedo of the objects that have them.
fn use_vertex_colors(model: &mut Model) {
    let mut colored = model.materials[0].clone();
    colored.name += " with vertex colors";
    colored.base_color = ColorInput::vertex();
    colored.subsurface_color = ColorInput::vertex();
    let mut any = false;
    for object in model.objects.iter_mut().filter(|object| !object.mesh.colors.is_empty()) {
        object.material = 1;
        any = true;
    }
    if any {
        model.materials.push(colored);
    }
}

/// Adds what the file does not have: a camera, lights, and where both are missing a backdrop.
fn stage(mut model: Model, unit: Unit, options: &LoadOptions) -> Scene {
    let film = options.film(Film::default());
    let frame = Frame::of(&model.objects);
    let aspect = f64::from(film.width) / f64::from(film.height);
    let dark = model.lights.is_empty() && !model.materials.iter().any(|m| m.emission_luminance > 0.0);
    let camera = model.camera_for(aspect).unwrap_or_else(|| frame.camera(&model.objects, aspect));
    if dark {
        model.lights = frame.lights();
        if model.camera.is_none() {
            add_backdrop(&mut model, &frame);
        }
    }
    Scene {
        unit,
        camera,
        film,
        integrator: Integrator::default(),
        objects: model.objects,
        materials: model.materials,
        images: model.images,
        lights: model.lights,
        environment: dark.then(|| frame.environment()),
    }
}

fn add_backdrop(model: &mut Model, frame: &Frame) {
    let (mesh, material) = frame.backdrop();
    let subsurface_group = model.objects.iter().map(|object| object.subsurface_group + 1).max().unwrap_or(0);
    let name = material.name.clone();
    model.objects.push(Object { name, mesh, material: model.materials.len(), subsurface_group });
    model.materials.push(material);
}
