//! glTF files as scenes of their own: which camera sees them, and what stands around them.

use glam::Vec3;
use serde_json::json;
use translucid_load::{Floor, LoadOptions, Viewpoint, load_scene};
use translucid_scene::{Scene, SceneError, Warning};

use super::builder::File;

fn load(file: &File, options: &LoadOptions) -> Result<(Scene, Vec<Warning>), SceneError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    std::fs::write(&path, file.glb()).unwrap();
    let mut warnings = Vec::new();
    load_scene(&path, options, &mut warnings).map(|scene| (scene, warnings))
}

/// A tetrahedron of a meter with two cameras and a lamp.
fn with_cameras() -> File {
    let mut file = File::tetrahedron();
    let perspective = json!({ "yfov": 1.0, "znear": 0.1 });
    file.push("cameras", json!({ "type": "perspective", "perspective": perspective }));
    file.push("nodes", json!({ "name": "front", "camera": 0, "translation": [0, 0, 4] }));
    file.push("nodes", json!({ "name": "far", "camera": 0, "translation": [0, 0, 40] }));
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([{ "type": "point", "intensity": 683 }]);
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    file.push("nodes", json!({ "translation": [0, 3, 0], "extensions": light }));
    file
}

#[test]
fn the_first_camera_sees_the_file_unless_another_is_named() {
    let file = with_cameras();
    let position = |camera: Option<&str>| {
        let options = LoadOptions { camera: camera.map(String::from), ..LoadOptions::default() };
        load(&file, &options).map(|(scene, _)| scene.camera.position)
    };
    assert_eq!(position(None), Ok(Vec3::new(0.0, 0.0, 4.0)));
    assert_eq!(position(Some("far")), Ok(Vec3::new(0.0, 0.0, 40.0)));
    let error = position(Some("fro")).unwrap_err();
    assert_eq!(error.message, "there is no camera \"fro\"");
    assert!(error.help.unwrap().ends_with("the cameras are front, far") || error.place.is_some());
}

#[test]
fn lamps_are_radiometric_and_stay_alone() {
    let (scene, _) = load(&with_cameras(), &LoadOptions::default()).unwrap();
    let [translucid_scene::Light::Spot { intensity, .. }] = scene.lights[..] else { panic!() };
    assert!((intensity - Vec3::ONE).abs().max_element() < 1e-6, "{intensity}");
    assert!(scene.environment.is_none() && scene.objects.len() == 1);
}

#[test]
fn a_view_frames_the_objects_in_place_of_the_files_camera() {
    let options = LoadOptions {
        viewpoint: Viewpoint::from_text("left"),
        floor: Some(Floor::Backdrop),
        ..LoadOptions::default()
    };
    let (scene, _) = load(&with_cameras(), &options).unwrap();
    let toward = (scene.camera.position - scene.camera.target).normalize();
    assert!(toward.abs_diff_eq(Vec3::NEG_X, 1e-5), "{toward}");
    assert_eq!(scene.objects.len(), 2, "the floor that is asked for");
}

/// A turntable turns the objects; the camera and the lamps of the file stay.
#[test]
fn a_turn_moves_objects_only() {
    let file = with_cameras();
    let (still, _) = load(&file, &LoadOptions::default()).unwrap();
    let (turned, _) = load(&file, &LoadOptions { turn: Some(90.0), ..LoadOptions::default() }).unwrap();
    assert_eq!((still.camera, &still.lights), (turned.camera, &turned.lights));
    let about = Vec3::splat(0.5);
    for (a, b) in still.objects[0].mesh.positions.iter().zip(&turned.objects[0].mesh.positions) {
        let (a, b) = (*a - about, *b - about);
        assert!(b.abs_diff_eq(Vec3::new(a.z, a.y, -a.x), 1e-5), "{a} {b}");
    }
}

#[test]
fn a_file_in_millimeters_is_doubted() {
    let mut file = File::tetrahedron();
    file.json["nodes"][0]["scale"] = json!([250, 250, 250]);
    let (_, warnings) = load(&file, &LoadOptions::default()).unwrap();
    let messages: Vec<&str> = warnings.iter().map(|warning| warning.message.as_str()).collect();
    assert_eq!(messages, ["the mesh is 250 m across: is it in millimeters? --unit mm"]);
}
