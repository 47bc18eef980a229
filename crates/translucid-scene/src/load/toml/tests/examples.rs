//! The scene files that are handed out: those in `scenes/` and the one in the description of the format.

use std::path::{Path, PathBuf};

use glam::Vec3;

use crate::{
    Configuration, Light, LoadOptions, Scene, SceneError, SceneFile, SubsurfaceParameter, load_scene,
};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Loads an example with its mesh in the shared assets; `None` where these are not.
#[allow(clippy::print_stdout, reason = "a skipped test says so")]
fn load_example(name: &str, mesh: &str) -> Option<Scene> {
    let mesh = workspace().join("../shared/assets").join(mesh);
    if !mesh.is_file() {
        println!("skipped: there is no {}", mesh.display());
        return None;
    }
    let options = LoadOptions { mesh_overrides: vec![(None, mesh)], ..LoadOptions::default() };
    let path = workspace().join("scenes").join(name);
    Some(load_scene(&path, &options, &mut Vec::new()).unwrap_or_else(|error| panic!("{error}")))
}

#[test]
fn example_head_is_the_scene_of_the_comparisons() {
    let Some(scene) = load_example("head.toml", "head/head_70k.ply") else { return };
    assert_eq!(scene.objects[0].mesh.triangles.len(), 70_736);
    let material = &scene.materials[scene.objects[0].material];
    assert_eq!(material.subsurface_color.factor, Vec3::new(0.625, 0.3836, 0.2394));
    let mfp = material.subsurface_radius.factor * material.subsurface_radius_scale.factor;
    assert_eq!(mfp, Vec3::new(2.5907, 1.9048, 1.3423));
    assert_eq!(material.specular_weight.factor, 0.0);
    assert_eq!(material.subsurface_parameter, SubsurfaceParameter::Mfp);
    assert_eq!(material.subsurface_configuration, Configuration::Diffuse);
    assert_eq!((scene.camera.horizontal_fov, scene.camera.target), (22.0, Vec3::new(6.0, 72.0, 0.0)));
    assert!(scene.environment.is_some_and(|e| !e.visible && e.radiance == Vec3::new(0.05, 0.055, 0.07)));
}

#[test]
fn example_dragon_stands_on_its_floor() {
    let Some(scene) = load_example("dragon.toml", "dragon/dragon_198k.ply") else { return };
    let floor = &scene.objects[1];
    let (low, high) = floor.mesh.bounds();
    assert!(low.distance(Vec3::new(-3000.0, 0.0, -3000.0)) < 1e-2, "{low}");
    assert!(high.distance(Vec3::new(3000.0, 0.0, 3000.0)) < 1e-2, "{high}");
    assert!(floor.mesh.normals.iter().all(|n| n.distance(Vec3::Y) < 1e-6));
    assert_eq!(scene.materials[floor.material].base_color.factor, Vec3::splat(0.25));
    assert_eq!(scene.objects[0].mesh.triangles.len(), 198_476);
    let Light::Rectangle { center, edge_x, edge_y, .. } = scene.lights[0] else { panic!() };
    let normal = edge_x.cross(edge_y).normalize();
    assert!(normal.distance((Vec3::new(0.0, 60.0, 0.0) - center).normalize()) < 1e-6);
    assert!((edge_x.length() - 160.0).abs() < 1e-3 && edge_x.y == 0.0);
}

#[test]
fn example_without_its_mesh_says_how_to_give_it() {
    let options = LoadOptions { mesh_overrides: vec![(None, "absent.ply".into())], ..LoadOptions::default() };
    let error = load_head(&options);
    assert_eq!(error.message, "the file absent.ply does not exist");
    let help = "put the mesh there, or give its path with --mesh head=PATH";
    assert_eq!(error.help.as_deref(), Some(help));
}

#[test]
fn example_overrides_name_an_object_of_the_scene() {
    let named = |name: &str| LoadOptions {
        mesh_overrides: vec![(Some(name.into()), "absent.ply".into())],
        ..LoadOptions::default()
    };
    let error = load_head(&named("haed"));
    assert_eq!(error.message, "there is no object \"haed\" with a mesh file");
    assert_eq!(error.help.as_deref(), Some("did you mean \"head\"?"));
    assert_eq!(load_head(&named("head")).message, "the file absent.ply does not exist");
}

fn load_head(options: &LoadOptions) -> SceneError {
    let path = workspace().join("scenes/head.toml");
    load_scene(&path, options, &mut Vec::new()).map(drop).unwrap_err()
}

#[test]
fn example_of_the_format_description_is_a_valid_scene() {
    let page = std::fs::read_to_string(workspace().join("docs/guide/scene-files.md")).unwrap();
    let examples: Vec<&str> =
        page.split("```toml\n").skip(1).map(|rest| rest.split("```").next().unwrap_or("")).collect();
    let whole: Vec<&&str> = examples.iter().filter(|text| text.contains("unit =")).collect();
    assert_eq!(whole.len(), 1, "the page has one whole scene");
    let file = SceneFile::parse(whole[0], Path::new("docs/guide/scene-files.md"));
    let file = file.unwrap_or_else(|error| panic!("{error}"));
    let scene = file.load(&LoadOptions::default(), &mut Vec::new()).unwrap_or_else(|error| panic!("{error}"));
    assert!(scene.objects.len() >= 2);
}

#[test]
fn format_description_names_every_key() {
    use super::super::{camera, input, light, material, object, settings};
    let page = std::fs::read_to_string(workspace().join("docs/guide/scene-files.md")).unwrap();
    let lists = [
        super::super::KEYS,
        camera::KEYS,
        settings::FILM_KEYS,
        settings::INTEGRATOR_KEYS,
        material::KEYS,
        object::KEYS,
        input::COLOR_KEYS,
        input::SCALAR_KEYS,
        input::NORMAL_KEYS,
        light::RECTANGLE_KEYS,
        light::SPHERE_KEYS,
        light::DISTANT_KEYS,
        light::SPOT_KEYS,
        light::POINT_KEYS,
        light::BEAM_KEYS,
        light::ENVIRONMENT_KEYS,
    ];
    for key in lists.into_iter().flatten() {
        assert!(page.contains(&format!("`{key}`")), "docs/guide/scene-files.md does not describe {key}");
    }
}

#[test]
fn description_has_every_shape() {
    let page = std::fs::read_to_string(workspace().join("docs/guide/scene-files.md")).unwrap();
    for name in crate::shape_names() {
        let row = format!("| `{name}` | {} |", crate::shape_meaning(name).unwrap());
        assert!(page.contains(&row), "docs/guide/scene-files.md lacks the row {row}");
    }
}
