//! Tests of the scene file; the broken ones have a file of their own.

mod broken;
mod documents;
mod examples;
mod extending;
mod far;
mod mutation;
mod transforms;
mod valid;
mod written;

use std::path::Path;

use translucid_scene::Scene;

use super::SceneFile;
use crate::LoadOptions;
use crate::result::Result;

const PATH: &str = "scenes/test.toml";
/// The least object.
const BALL: &str = "[[object]]\nshape = \"sphere\"\n";

fn parse(text: &str) -> Result<SceneFile> {
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

/// Rows of a table of faults: a text, in which "\n" ends lines | the message | what it underlines | advice, if there is any.
fn cases(list: &str) -> impl Iterator<Item = [String; 4]> {
    list.lines().map(str::trim).filter(|row| !row.is_empty()).map(|row| {
        let mut parts = row.split(" | ").map(|part| part.replace("\\n", "\n"));
        [(); 4].map(|()| parts.next().unwrap_or_default())
    })
}
