//! The gallery keeps its word: every command of `docs/guide/gallery.md` renders, here a few pixels of it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{stderr, translucid};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap()
}

/// The commands of the gallery that render the still life or a scene of `scenes/`.
fn commands() -> Vec<Vec<String>> {
    let page = fs::read_to_string(root().join("docs/guide/gallery.md")).unwrap();
    let scenes = ["translucid render scenes/", "translucid render --"];
    let lines = page.lines().filter(|line| scenes.iter().any(|start| line.starts_with(start)));
    lines.map(|line| line.split_whitespace().skip(1).map(str::to_owned).collect()).collect()
}

#[test]
fn every_command_renders() {
    let mut rendered = 0;
    for words in commands() {
        if words.iter().any(|word| word == "--mesh") {
            // Of a mesh that is not here
            assert!(root().join(&words[1]).exists(), "{words:?}");
            continue;
        }
        let directory = tempfile::tempdir().unwrap();
        let picture = directory.path().join("picture.png");
        let mut command = translucid(&root());
        command.arg("render").args(words[1..].iter().take_while(|word| !word.starts_with("--")));
        command.args(["--size", "16x9", "--spp", "1", "-o"]).arg(&picture);
        let output = command.output().unwrap();
        assert!(output.status.success(), "{words:?}: {}", stderr(&output));
        assert!(picture.exists(), "{words:?}");
        rendered += 1;
    }
    assert!(rendered >= 5, "{rendered}");
}
