//! The floors of the renderer: each room knows those below it.

use crate::imports::{self, Graph};

/// Rooms of the renderer from the top floor down: modules, with all that is below them.
///
/// A room may import from its own floor and from those below.
const FLOORS: [&[&str]; 8] = [
    &["session", "internals", "device"],
    &["render"],
    &["path"],
    &["subsurface"],
    &["world"],
    &["surface", "light"],
    &["ray"],
    &["sampling"],
];

/// The floor that a module stands on, counted from the top.
fn floor(floors: &[&[&str]], module: &[String]) -> Option<usize> {
    let path = module.join("::");
    let holds = |room: &&str| path == **room || path.starts_with(&format!("{room}::"));
    floors.iter().position(|rooms| rooms.iter().any(holds))
}

/// Imports that lead up, and modules below the root that stand on no floor, one line for each.
fn faults(floors: &[&[&str]], graph: &Graph) -> String {
    let mut text = String::new();
    for (file, module) in graph.files() {
        if !module.is_empty() && floor(floors, module).is_none() {
            text += &format!("{file} stands on no floor\n");
        }
    }
    for import in graph.imports() {
        let ends = [&import.from, &import.to].map(|file| floor(floors, graph.module(file)));
        if let [Some(from), Some(to)] = ends
            && from > to
        {
            text +=
                &format!("{import}, which is {} above\n", if from - to == 1 { "a floor" } else { "floors" });
        }
    }
    text
}

#[test]
fn floors_of_the_renderer_know_those_below() {
    let faults = faults(&FLOORS, &imports::of_crate("translucid-render"));
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn floors_are_told_apart() {
    let files = [
        ("lib.rs", "mod top; mod middle; mod low; mod cellar;"),
        ("top.rs", "use crate::low::L; pub struct T;"),
        ("middle/mod.rs", "mod room; pub struct M;"),
        ("middle/room.rs", "use crate::top::T; use super::M;"),
        ("low.rs", "use crate::middle::M; use crate::cellar::C; pub struct L;"),
        ("cellar.rs", "pub struct C;"),
    ];
    let sources = files.map(|(name, text)| (name.to_owned(), text.to_owned())).into_iter().collect();
    let found = faults(&[&["top"], &["middle"], &["low"]], &imports::of_sources(&sources));
    let expected = "cellar.rs stands on no floor\nlow.rs:1 imports crate::middle::M of middle/mod.rs, which is a floor \
                    above\nmiddle/room.rs:1 imports crate::top::T of top.rs, which is a floor above\n";
    assert_eq!(found, expected);
}
