//! A session that renders nothing, for fuzzing.

use std::path::Path;
use std::sync::LazyLock;

use translucid_load::{ExtendedBase, SceneFile};
use translucid_render::PreparedScene;

use crate::conversation::{Heard, hear};
use crate::message::Message;
use crate::settings::{Devices, Settings};
use crate::shared::Shared;

const SCENE: &str = r#"
unit = "mm"

[camera]
position = [0, 0, 5]
target = [0, 0, 0]

[[light]]
type = "sphere"
center = [0, 3, 3]
radius = 0.5
radiance = 10

[[material]]
name = "wax"
subsurface_color = [0.8, 0.6, 0.4]
subsurface_radius = 0.3

[[object]]
shape = "sphere"
material = "wax"
"#;

static SESSION: LazyLock<Shared> = LazyLock::new(|| {
    let scene = SceneFile::parse(SCENE, Path::new("scene.toml")).unwrap();
    let scene = scene.load(&Default::default(), &mut Vec::new()).unwrap();
    let base = scene.clone();
    let prepared = PreparedScene::new(scene).unwrap();
    let settings = Settings {
        name: String::from("scene"),
        mesh: None,
        is_metered: false,
        base: ExtendedBase { extends: String::from("scene.toml"), ..ExtendedBase::default() },
        load_base: Box::new(move |_| Ok(base.clone())),
        command: String::new(),
        options: String::new(),
        devices: Devices::default(),
    };
    Shared::new(prepared.scene(), prepared.picker(), Vec::new(), settings).unwrap()
});

/// Hears lines as messages of a page, then has the scene saved, whose text must be read again.
///
/// # Panics
/// The saved scene cannot be read.
pub fn hear_while_fuzzing(lines: &str) {
    SESSION.change(|studio| studio.apply(Message::Reset {})).unwrap();
    for line in lines.lines().take(50) {
        if let Heard::Question(question) = hear(&SESSION, line) {
            question.answer(&SESSION);
        }
    }
    let saved = SESSION.scene_text().unwrap();
    SceneFile::parse(&saved, Path::new("saved.toml")).unwrap();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_that_are_none_and_edits_leave_a_scene_that_can_be_saved() {
        hear_while_fuzzing("");
        hear_while_fuzzing("{}\n[\n{\"type\":\"undo\"}\n{\"type\":\"remove_light\",\"index\":0}");
        hear_while_fuzzing(
            "{\"type\":\"material\",\"index\":0,\"set\":{\"specular_roughness\":0.5}}\n{\"type\":\"frame\"}",
        );
    }
}
