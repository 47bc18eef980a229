use std::path::Path;

use super::SceneFile;
use crate::{LoadOptions, Scene, SceneError};

const PATH: &str = "scenes/test.toml";
const BALL: &str = "[[object]]\nshape = \"sphere\"\n";

fn parse(text: &str) -> Result<SceneFile, SceneError> {
    SceneFile::parse(text, Path::new(PATH))
}

/// Loads a scene that needs no files.
fn load(text: &str) -> Scene {
    let mut warnings = Vec::new();
    let scene = parse(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let scene =
        scene.load(&LoadOptions::default(), &mut warnings).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(warnings, []);
    scene
}

#[test]
fn scene_file_of_a_ball_is_complete() {
    let scene = load(&format!("unit = \"cm\"\n{BALL}"));
    assert_eq!(scene.objects.len(), 1);
    assert_eq!(scene.objects[0].name, "sphere");
    assert_eq!(scene.unit.name(), "cm");
    assert!(!scene.lights.is_empty() && scene.environment.is_some());
}
