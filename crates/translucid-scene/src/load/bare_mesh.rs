//! A mesh file alone, as a scene: with a preset's material, camera, lights and backdrop.

use std::path::Path;
use std::sync::Arc;

use super::mesh_file::MeshFile;
use super::{LoadOptions, is_gltf, load_model};
use crate::load::stage::Stage;
use crate::preset::preset;
use crate::{ColorInput, Film, Material, Object, Scene, SceneError, Unit, Warning};

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
    let mut model = load_model(path, &options.watch, warnings)?;
    // Meters in glTF, by its specification; millimeters where the format says nothing.
    let unit = options.unit.unwrap_or(if is_gltf(path) { Unit::Meter } else { Unit::Millimeter });
    if let Some(preset) = wanted {
        use_preset(&mut model, &preset.material(unit));
    } else if model.materials.is_empty() {
        let default = preset(DEFAULT_PRESET)?;
        use_preset(&mut model, &default.material(unit));
        use_vertex_colors(&mut model);
    }
    options.finish(stage(model, unit, options)).map_err(|error| error.or_at(path))
}

/// The preset's substance for all objects; what the file says of their geometry stays.
fn use_preset(model: &mut MeshFile, preset: &Material) {
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
fn use_vertex_colors(model: &mut MeshFile) {
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
fn stage(mut model: MeshFile, unit: Unit, options: &LoadOptions) -> Scene {
    let film = options.film(Film::default());
    let frame = Stage::of(&model.objects);
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
        objects: model.objects,
        materials: model.materials,
        images: model.images.into_iter().map(Arc::new).collect(),
        lights: model.lights,
        environment: dark.then(|| frame.environment()),
        ..Scene::default()
    }
}

fn add_backdrop(model: &mut MeshFile, frame: &Stage) {
    let (mesh, material) = frame.backdrop();
    if mesh.validate().is_err() {
        return; // It would reach beyond the coordinates that meshes may have.
    }
    let subsurface_group = model.objects.iter().map(|object| object.subsurface_group + 1).max().unwrap_or(0);
    let name = material.name.clone();
    model.objects.push(Object {
        name,
        mesh: mesh.into(),
        material: model.materials.len(),
        subsurface_group,
        ..Object::default()
    });
    model.materials.push(material);
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use glam::Vec3;
    use tempfile::TempDir;

    use super::*;
    use crate::load_scene;
    use crate::{ScalarInput, SubsurfaceModel};

    const TETRAHEDRON: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

    /// A file in a folder of its own, which goes when the test ends.
    fn file(name: &str, content: &str) -> (TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        (folder, path)
    }

    fn options(preset: &str, unit: Option<Unit>) -> LoadOptions {
        LoadOptions { preset: Some(preset.into()), unit, ..LoadOptions::default() }
    }

    fn refuse(path: &Path, options: &LoadOptions) -> SceneError {
        load_scene(path, options, &mut Vec::new()).map(drop).unwrap_err()
    }

    #[test]
    fn bare_mesh_gets_a_material_a_camera_lights_and_a_backdrop() {
        let (_folder, path) = file("pyramid.obj", TETRAHEDRON);
        let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        let names: Vec<&str> = scene.objects.iter().map(|object| object.name.as_str()).collect();
        assert_eq!(names, ["pyramid", "backdrop"]);
        assert_eq!(scene.unit, Unit::Millimeter);
        let [mesh, backdrop] = [0, 1].map(|i| &scene.materials[scene.objects[i].material]);
        assert_eq!((mesh.name.as_str(), mesh.subsurface_weight), ("marble", ScalarInput::constant(1.0)));
        assert_eq!(mesh.model(&scene.integrator).name(), "random-walk");
        assert_eq!(backdrop.subsurface_weight, ScalarInput::constant(0.0));
        assert_ne!(scene.objects[0].subsurface_group, scene.objects[1].subsurface_group);
        assert!(scene.lights.len() == 2 && scene.environment.is_some());
        assert!(scene.camera.position.z > 1.0);
    }

    #[test]
    fn bare_mesh_takes_preset_and_unit() {
        let (_folder, path) = file("a.obj", TETRAHEDRON);
        let scene = load_scene(&path, &options("skin1", Some(Unit::Meter)), &mut Vec::new()).unwrap();
        assert_eq!(scene.unit, Unit::Meter);
        let skin = &scene.materials[scene.objects[0].material];
        let mfp = skin.subsurface_radius.factor * skin.subsurface_radius_scale.factor;
        assert!((mfp - Vec3::new(1.2953e-3, 0.9524e-3, 0.6711e-3)).abs().max_element() < 1e-7, "{mfp}");
        assert_eq!(skin.specular_ior, 1.3);
    }

    #[test]
    fn bare_mesh_preset_replaces_substance_and_keeps_opacity() {
        let library = "newmtl glass\nKd 1 0 0\nd 0.5\n";
        let (folder, path) = file("a.obj", &format!("mtllib a.mtl\nusemtl glass\n{TETRAHEDRON}"));
        std::fs::write(folder.path().join("a.mtl"), library).unwrap();
        let plain = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        let own = &plain.materials[plain.objects[0].material];
        assert_eq!(own.name, "glass");
        let scene = load_scene(&path, &options("jade", None), &mut Vec::new()).unwrap();
        let jade = &scene.materials[scene.objects[0].material];
        assert_eq!((jade.name.as_str(), jade.geometry_opacity), ("jade", own.geometry_opacity));
    }

    #[test]
    fn bare_mesh_shows_its_vertex_colors() {
        let colored =
            TETRAHEDRON.replace("\nv", " 0.5 0.2 0.1\nv").replace("0 0 1\nf", "0 0 1 0.5 0.2 0.1\nf");
        let (_folder, path) = file("a.obj", &colored);
        let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        assert!(!scene.objects[0].mesh.colors.is_empty());
        assert_eq!(scene.materials[scene.objects[0].material].subsurface_color, ColorInput::vertex());
    }

    #[test]
    fn bare_mesh_model_and_size_can_be_chosen() {
        let (_folder, path) = file("a.obj", TETRAHEDRON);
        let options = LoadOptions {
            subsurface_model: Some(SubsurfaceModel::None),
            size: Some([64, 32]),
            ..LoadOptions::default()
        };
        let scene = load_scene(&path, &options, &mut Vec::new()).unwrap();
        assert!(scene.materials.iter().all(|m| m.subsurface_model == SubsurfaceModel::None));
        assert_eq!((scene.film.width, scene.film.height), (64, 32));
    }

    #[test]
    fn options_that_do_not_fit_are_refused() {
        let (_folder, mesh) = file("a.obj", TETRAHEDRON);
        let error = refuse(&mesh, &options("skinn", None));
        assert_eq!(error.message, "there is no preset \"skinn\"");
        let overrides = vec![(None, mesh.clone())];
        let error = refuse(&mesh, &LoadOptions { mesh_overrides: overrides, ..LoadOptions::default() });
        assert!(error.message.ends_with("is a mesh itself, so no mesh in it can be replaced"));
        let (_folder, scene) = file("a.toml", "unit = \"mm\"\n[[object]]\nshape = \"sphere\"\n");
        let error = refuse(&scene, &options("skin", None));
        assert!(error.message.starts_with("a preset is for a bare mesh, but "), "{error}");
        let error = refuse(&scene, &LoadOptions { unit: Some(Unit::Meter), ..LoadOptions::default() });
        assert_eq!(error.help.as_deref(), Some("in a scene file it is the key unit at the top"));
        let overrides = vec![(None, mesh)];
        let error = refuse(&scene, &LoadOptions { mesh_overrides: overrides, ..LoadOptions::default() });
        assert_eq!(error.message, "the scene has no object with a mesh file to replace");
    }

    #[test]
    fn files_that_are_no_scenes_are_refused() {
        for (name, message) in [
            ("a.fbx", "a .fbx file is neither a scene nor a mesh"),
            ("a", "a file without extension is neither a scene nor a mesh"),
        ] {
            let (_folder, path) = file(name, "");
            let error = refuse(&path, &LoadOptions::default());
            assert_eq!(error.message, message);
            assert_eq!(error.place.unwrap().path, path);
            assert_eq!(
                error.help.as_deref(),
                Some("scenes are .toml, meshes are .glb, .gltf, .obj, .ply or .stl")
            );
        }
        for name in ["absent.toml", "absent.ply", "absent.obj", "absent.glb"] {
            let error = refuse(Path::new(name), &LoadOptions::default());
            assert_eq!(error.place.as_ref().unwrap().path, Path::new(name));
            assert!(error.message.contains("read"), "{error}");
        }
        let (_folder, path) = file("a.toml", "");
        std::fs::write(&path, b"unit = \"mm\"\n\xff\n").unwrap();
        let error = refuse(&path, &LoadOptions::default());
        assert_eq!(error.place.unwrap().part.as_deref(), Some("byte 12"));
    }

    #[test]
    fn scene_files_place_meshes_in_their_unit() {
        let (folder, _) = file("a.obj", TETRAHEDRON);
        let text = "unit = \"mm\"\n[[object]]\nfile = \"a.obj\"\nunit = \"cm\"\nscale = 2\n\
                    [[object]]\nname = \"same\"\nfile = \"a.obj\"\ntranslate = [5, 0, 0]\n";
        let path = folder.path().join("a.toml");
        std::fs::write(&path, text).unwrap();
        let scene = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        assert_eq!(scene.objects[0].mesh.bounds(), (Vec3::ZERO, Vec3::splat(20.0)));
        assert_eq!(scene.objects[1].mesh.bounds(), (Vec3::new(5.0, 0.0, 0.0), Vec3::new(6.0, 1.0, 1.0)));
        assert_eq!([0, 1].map(|i| scene.objects[i].name.as_str()), ["a", "same"]);
        assert_ne!(scene.objects[0].subsurface_group, scene.objects[1].subsurface_group);
    }
}
