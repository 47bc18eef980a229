//! A mesh file alone, as a scene: with a preset's material, camera, lights and backdrop.

use std::path::Path;
use std::sync::Arc;

use glam::{EulerRot, Mat3, Vec3};
use translucid_profile::convention::preset;
use translucid_scene::{
    Camera, CameraVisibility, ColorInput, Film, Material, Object, Place, ScalarInput, Scene, SceneError,
    Unit, Warning,
};

use super::extent::{warn_of_extent, warn_of_meters};
use super::mesh_file::{MeshFile, NamedCamera};
use super::orientation::{Orientation, UpAxis, axis_of_underside, turn_model, turn_objects};
use super::{Floor, LoadOptions};
use crate::appearance::warn_of_darkened;
use crate::loading::Loading;
use crate::model::{is_gltf, load_model};
use crate::result::Result;
use crate::stage::{BackdropShape, Stage};

/// Material of a mesh without its own where no preset is asked for.
const DEFAULT_PRESET: &str = "marble";

/// Makes a scene of a mesh file, and says how the mesh is turned in it.
pub(super) fn load_bare_mesh(
    path: &Path,
    options: &LoadOptions,
    loading: &mut Loading<'_>,
) -> Result<(Scene, Orientation)> {
    if !options.mesh_overrides.is_empty() {
        let message = format!("{} is a mesh itself, so no mesh in it can be replaced", path.display());
        return Err(SceneError::new(message).with_help("mesh paths are for scene files"));
    }
    let wanted = options.preset.as_deref().map(preset).transpose()?;
    let mut model = load_model(path, loading)?;
    // Meters in glTF, by its specification; millimeters where the format says nothing.
    let unit = options.unit.unwrap_or(if is_gltf(path) { Unit::Meter } else { Unit::Millimeter });
    if wanted.is_none() {
        warn_of_darkened(&model, path, loading.warnings);
    }
    if let Some(preset) = wanted {
        use_preset(&mut model, &Material::of_preset(preset, unit));
    } else if model.materials.is_empty() {
        let default = preset(DEFAULT_PRESET)?;
        use_preset(&mut model, &Material::of_preset(default, unit));
        use_vertex_colors(&mut model);
    }
    let place = Place::file(path);
    let advice = |unit: Unit| format!("--unit {}", unit.name());
    warn_of_extent((&model.objects, &model.materials), [unit; 2], advice, &place, loading.warnings);
    if is_gltf(path) && options.unit.is_none() {
        warn_of_meters((&model.objects, &model.materials), &place, loading.warnings);
    }
    let up = up_axis(path, &model, options, loading.warnings);
    turn_model(&mut model, up.rotation());
    let origin = up.rotation().as_dmat3() * model.origin;
    let mut scene = options
        .finish(Scene { origin, ..stage(model, unit, options).map_err(|error| error.or_at(path))? })
        .map_err(|error| error.or_at(path))?;
    options.surroundings.apply(&mut scene, loading)?;
    Ok((scene, Orientation { up, rotate: options.rotate }))
}

/// The axis that points up: the requested one, that of the format, or a guess with a warning.
fn up_axis(path: &Path, model: &MeshFile, options: &LoadOptions, warnings: &mut Vec<Warning>) -> UpAxis {
    if let Some(axis) = options.up {
        return axis;
    }
    if is_gltf(path) {
        return UpAxis::Y;
    }
    let shown = axis_of_underside(&model.objects);
    let message = match shown {
        Some(UpAxis::Y) => return UpAxis::Y,
        Some(axis) => {
            let name = axis.name();
            format!(
                "the mesh has a flat underside across {name}, so {name} is taken for up: --up {name} says so, --up y not"
            )
        }
        None => String::from(
            "y is taken for up: say --up z if the mesh lies, or --up y (in a scene file by the key up)",
        ),
    };
    warnings.push(Warning { message, place: Some(Place::file(path)) });
    shown.unwrap_or(UpAxis::Y)
}

/// The preset's substance for all objects, opacity included; what pictures in the file say of their geometry stays.
fn use_preset(model: &mut MeshFile, preset: &Material) {
    if model.materials.is_empty() {
        model.objects.iter_mut().for_each(|object| object.material = 0);
        model.materials.push(preset.clone());
    }
    for material in &mut model.materials {
        *material = Material {
            geometry_normal: material.geometry_normal,
            geometry_opacity: ScalarInput {
                texture: material.geometry_opacity.texture,
                ..preset.geometry_opacity
            },
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
fn stage(mut model: MeshFile, unit: Unit, options: &LoadOptions) -> Result<Scene> {
    let film = options.film(Film::default());
    let aspect = f64::from(film.width) / f64::from(film.height);
    let own = NamedCamera::choose(&model.cameras, options.camera.as_deref())?;
    let own = own.filter(|_| options.viewpoint.is_none()).map(|own| own.for_aspect(aspect));
    let [x, y, z] = options.rotate.map(f32::to_radians);
    turn(&mut model.objects, Mat3::from_euler(EulerRot::XYZEx, x, y, z));
    let frame = Stage::of(&model.objects).seen_by(own.as_ref()).turning(options.turn.is_some());
    let frame = frame.seen_from(options.viewpoint);
    let camera = own.unwrap_or_else(|| frame.camera(&model.objects, aspect));
    turn(&mut model.objects, Mat3::from_rotation_y(options.turn.unwrap_or(0.0).to_radians() as f32));
    let glows = model.materials.iter().any(|material| material.emission_luminance > 0.0);
    let is_dark = model.lights.is_empty() && !glows && options.surroundings.file.is_none();
    if is_dark {
        model.lights = frame.lights();
    }
    add_floor(
        &mut model,
        &frame,
        &camera,
        options.floor.unwrap_or(match own {
            None if is_dark => Floor::Backdrop,
            _ => Floor::None,
        }),
    );
    let mut environment = is_dark.then(|| frame.environment());
    if let Some(environment) =
        environment.as_mut().filter(|_| matches!(options.floor, Some(Floor::None | Floor::Shadow)))
    {
        environment.visible = false;
    }
    Ok(Scene {
        unit,
        camera,
        film,
        objects: model.objects,
        materials: model.materials,
        images: model.images.into_iter().map(Arc::new).collect(),
        lights: model.lights,
        environment,
        ..Scene::default()
    })
}

/// Turns objects about their middle.
fn turn(objects: &mut [Object], rotation: Mat3) {
    if rotation != Mat3::IDENTITY {
        let middle = Stage::of(objects).center();
        turn_objects(objects, rotation, middle);
    }
}

/// Color that a floor reflects onto the mesh without being visible itself.
const SHADOW_FLOOR_COLOR: Vec3 = Vec3::splat(0.5);

fn add_floor(model: &mut MeshFile, frame: &Stage, camera: &Camera, floor: Floor) {
    let color = match floor {
        Floor::None => return,
        Floor::Backdrop => Stage::BACKDROP_COLOR,
        Floor::Shadow => SHADOW_FLOOR_COLOR,
        Floor::Color(color) => Vec3::from_array(color),
    };
    if !frame.is_above_floor(camera) {
        return; // It would hide the mesh.
    }
    let shape = if floor == Floor::Shadow { BackdropShape::Flat } else { BackdropShape::Sweep };
    let (mesh, mut material) = frame.backdrop(color, shape);
    if floor == Floor::Shadow {
        material.camera_visibility = CameraVisibility::Shadow;
    }
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

    use tempfile::TempDir;
    use translucid_scene::SubsurfaceModel;

    use super::*;
    use crate::{Viewpoint, load_scene};

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
    fn bare_mesh_preset_replaces_substance_and_opacity() {
        let library = "newmtl glass\nKd 1 0 0\nd 0.5\n";
        let (folder, path) = file("a.obj", &format!("mtllib a.mtl\nusemtl glass\n{TETRAHEDRON}"));
        std::fs::write(folder.path().join("a.mtl"), library).unwrap();
        let plain = load_scene(&path, &LoadOptions::default(), &mut Vec::new()).unwrap();
        let own = &plain.materials[plain.objects[0].material];
        assert_eq!(own.name, "glass");
        let scene = load_scene(&path, &options("jade", None), &mut Vec::new()).unwrap();
        let jade = &scene.materials[scene.objects[0].material];
        assert_eq!(own.geometry_opacity, ScalarInput::constant(0.5));
        assert_eq!((jade.name.as_str(), jade.geometry_opacity), ("jade", ScalarInput::constant(1.0)));
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

    /// A pyramid on the plane z = 0, half as large again in height.
    const STANDING: &str = "s 1\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv 0 0 3\nf 1 3 2\nf 1 4 3\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

    #[test]
    fn bare_mesh_is_turned_up_by_wish_or_where_it_stands_on_the_plane_of_z() {
        let (_folder, path) = file("a.obj", STANDING);
        let load = |options: &LoadOptions| {
            let mut warnings = Vec::new();
            let scene = load_scene(&path, options, &mut warnings).unwrap();
            let apex = scene.objects[0].mesh.positions[4];
            (apex, warnings.into_iter().map(|warning| warning.message).collect::<Vec<_>>())
        };
        let (apex, messages) = load(&LoadOptions::default());
        assert_eq!(apex, Vec3::new(0.0, 3.0, 0.0));
        assert!(messages.len() == 1 && messages[0].contains("--up y"), "{messages:?}");
        for (up, there) in
            [(UpAxis::Z, Vec3::Y), (UpAxis::Y, Vec3::Z), (UpAxis::MinusZ, Vec3::NEG_Y), (UpAxis::X, Vec3::Z)]
        {
            let (apex, messages) = load(&LoadOptions { up: Some(up), ..LoadOptions::default() });
            assert_eq!((apex, messages), (3.0 * there, vec![]), "{up:?}");
        }
        let rotate = [90.0, 0.0, 0.0];
        let (apex, _) = load(&LoadOptions { up: Some(UpAxis::Z), rotate, ..LoadOptions::default() });
        // About the middle of the box, at half the height.
        assert!(apex.abs_diff_eq(Vec3::new(0.0, 1.5, 1.5), 1e-5), "{apex}");
    }

    #[test]
    fn mesh_that_shows_no_underside_is_told_of_unless_its_axis_is_known() {
        // Without its base the pyramid has no flat side.
        let pointed = STANDING.replace("f 1 3 2\nf 1 4 3\n", "").replace("0 0 3", "0.5 0.5 3");
        let (folder, path) = file("a.obj", &pointed);
        let messages = |path: &Path, up: Option<UpAxis>| {
            let mut warnings = Vec::new();
            load_scene(path, &LoadOptions { up, ..LoadOptions::default() }, &mut warnings).unwrap();
            let messages = warnings.into_iter().map(|warning| warning.message);
            messages.filter(|message| message.contains("taken for up")).collect::<Vec<_>>()
        };
        let expected =
            "y is taken for up: say --up z if the mesh lies, or --up y (in a scene file by the key up)";
        assert_eq!(messages(&path, None), [expected]);
        assert_eq!(messages(&path, Some(UpAxis::Y)), [""; 0]);
        let scene = folder.path().join("a.toml");
        for (text, count) in [("extends = 'a.obj'\n", 1), ("extends = 'a.obj'\nup = 'y'\n", 0)] {
            std::fs::write(&scene, text).unwrap();
            assert_eq!(messages(&scene, None).len(), count, "{text}");
        }
    }

    #[test]
    fn bare_mesh_is_seen_from_any_side_with_its_lights_and_on_any_floor() {
        let (_folder, path) = file("a.obj", TETRAHEDRON);
        let load = |options: LoadOptions| load_scene(&path, &options, &mut Vec::new()).unwrap();
        for (_, viewpoint) in Viewpoint::WORDS {
            let scene = load(LoadOptions { viewpoint: Some(viewpoint), ..LoadOptions::default() });
            let toward = (scene.camera.position - scene.camera.target).normalize().as_dvec3();
            assert!(toward.distance(viewpoint.direction()) < 1e-5, "{viewpoint:?}");
            // From below the floor would hide the mesh.
            let is_below = viewpoint.elevation < -45.0;
            assert_eq!(scene.objects.len(), if is_below { 1 } else { 2 }, "{viewpoint:?}");
        }
        let scene = load(LoadOptions { floor: Some(Floor::None), ..LoadOptions::default() });
        assert_eq!((scene.objects.len(), scene.lights.len()), (1, 2));
        assert!(!scene.environment.unwrap().visible, "nothing is to be seen around it");
        let scene =
            load(LoadOptions { floor: Some(Floor::Color([1.0, 0.0, 0.0])), ..LoadOptions::default() });
        assert_eq!(scene.materials[scene.objects[1].material].base_color.factor, Vec3::X);
    }

    /// On a turntable lights and camera stay, and the mesh fits into the picture at every angle.
    #[test]
    fn bare_mesh_on_a_turntable_stays_in_the_picture() {
        let (_folder, path) = file("a.obj", &TETRAHEDRON.replace("v 1 0 0", "v 7 0 0"));
        let load = |turn: f64| {
            load_scene(&path, &LoadOptions { turn: Some(turn), ..LoadOptions::default() }, &mut Vec::new())
                .unwrap()
        };
        let first = load(0.0);
        for turn in [0.0, 30.0, 90.0, 200.0] {
            let scene = load(turn);
            assert_eq!((scene.camera, &scene.lights), (first.camera, &first.lights), "{turn}");
            let Camera { position, target, projection, .. } = scene.camera;
            let backward = (position - target).normalize();
            let [right, tangent] =
                [Vec3::Y.cross(backward).normalize(), Vec3::splat(projection.width_at(0.5) as f32)];
            for p in &scene.objects[0].mesh.positions {
                let depth = (position - *p).dot(backward);
                assert!((*p - position).dot(right).abs() < 0.8 * tangent.x * depth, "{turn}: {p}");
            }
        }
    }

    #[test]
    fn bare_mesh_smaller_than_its_mean_free_path_is_doubted() {
        let small =
            TETRAHEDRON.replace("v 1", "v 0.1").replace("0 1 0", "0 0.1 0").replace("0 0 1\n", "0 0 0.1\n");
        let (folder, path) = file("a.obj", &small);
        let messages = |path: &Path, options: &LoadOptions| {
            let mut warnings = Vec::new();
            load_scene(path, options, &mut warnings).unwrap();
            warnings.into_iter().map(|warning| warning.message).collect::<Vec<_>>()
        };
        let expected = "the mesh is 0.1 mm across, smaller than its mean free path of 0.456 mm: is it in meters? --unit m";
        assert_eq!(messages(&path, &LoadOptions::default()), [expected]);
        let right = LoadOptions { unit: Some(Unit::Meter), ..LoadOptions::default() };
        assert_eq!(messages(&path, &right), [""; 0]);
        let scene = folder.path().join("a.toml");
        let text = "unit = 'mm'\n[[material]]\nname = 'm'\npreset = 'marble'\n[[object]]\nfile = 'a.obj'\nmaterial = 'm'\n";
        std::fs::write(&scene, text).unwrap();
        assert_eq!(messages(&scene, &LoadOptions::default()), [expected.replace("--unit m", "unit = \"m\"")]);
        std::fs::write(&scene, format!("{text}unit = 'm'\n")).unwrap();
        assert_eq!(messages(&scene, &LoadOptions::default()), [""; 0]);
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
        for options in [
            LoadOptions { up: Some(UpAxis::Z), ..LoadOptions::default() },
            LoadOptions { rotate: [1.0, 0.0, 0.0], ..LoadOptions::default() },
            LoadOptions { floor: Some(Floor::None), ..LoadOptions::default() },
        ] {
            assert!(refuse(&scene, &options).message.contains(" is for a bare mesh, but "));
        }
        let overrides = vec![(None, mesh)];
        let error = refuse(&scene, &LoadOptions { mesh_overrides: overrides, ..LoadOptions::default() });
        assert_eq!(error.message, "the scene has no object with a mesh file to replace");
    }

    #[test]
    fn files_that_are_no_scenes_are_refused() {
        let formats = "scenes are .toml, meshes are .glb, .gltf, .obj, .ply or .stl";
        let export = format!("export glTF (.glb) from the program that wrote it, or from Blender; {formats}");
        for (name, message, help) in [
            ("a.fbx", "a .fbx file is neither a scene nor a mesh", export.as_str()),
            ("a.xyz", "a .xyz file is neither a scene nor a mesh", formats),
            ("a", "a file without extension is neither a scene nor a mesh", formats),
        ] {
            let (_folder, path) = file(name, "");
            let error = refuse(&path, &LoadOptions::default());
            assert_eq!(error.message, message);
            assert_eq!(error.place.unwrap().path, path);
            assert_eq!(error.help.as_deref(), Some(help));
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
