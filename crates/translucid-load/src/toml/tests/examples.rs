//! The scene files that are handed out: those in `scenes/` and the one in the description of the format.

use std::path::{Path, PathBuf};

use translucid_scene::SceneError;
use translucid_scene::description::{COLOR_KEYS, NORMAL_KEYS, SCALAR_KEYS};

use crate::{LoadOptions, SceneFile, load_scene};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
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
    let extending: Vec<&&str> = examples.iter().filter(|text| text.contains("extends =")).collect();
    assert_eq!(extending.len(), 1, "the page has one file that extends another");
    let file = SceneFile::parse(extending[0], Path::new("docs/guide/scene-files.md"));
    file.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn format_description_names_every_key() {
    use super::super::extend;
    let page = std::fs::read_to_string(workspace().join("docs/guide/scene-files.md")).unwrap();
    let lists = [super::super::KEYS, extend::KEYS, &["index"], COLOR_KEYS, SCALAR_KEYS, NORMAL_KEYS];
    for key in lists.into_iter().flatten() {
        assert!(page.contains(&format!("`{key}`")), "docs/guide/scene-files.md does not describe {key}");
    }
}

#[test]
fn description_has_every_shape() {
    let page = std::fs::read_to_string(workspace().join("docs/guide/scene-files.md")).unwrap();
    for name in translucid_shapes::shape_names() {
        let row = format!("| `{name}` | ");
        assert!(page.contains(&row), "docs/guide/scene-files.md lacks the row {row}");
    }
}
