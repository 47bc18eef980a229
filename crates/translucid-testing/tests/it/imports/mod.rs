//! Imports between the files of a crate, read from its text: tokens, modules, names, and the graph that they make.
//!
//! A path counts where it stands in code, be it in a `use` or in an expression; what stands in comments, strings and
//! `#[cfg(test)]` does not.
//! It leads to the file that defines its name, through as many `pub use` as lie between.
//! Methods are not seen: they come with the type that has them.

mod graph;
mod modules;
mod resolution;
mod tokens;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub(crate) use graph::Graph;

/// Text of the files of a crate, by their paths below `src`.
pub(crate) type Sources = BTreeMap<String, String>;

/// The folder `crates` of the workspace.
pub(crate) fn crates() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Names of all crates of the workspace, in order.
pub(crate) fn crate_names() -> Vec<String> {
    let entries = std::fs::read_dir(crates()).unwrap().map(|entry| entry.unwrap());
    let crates = entries.filter(|entry| entry.path().join("Cargo.toml").exists());
    let mut names: Vec<String> = crates.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Imports between the files of a crate of the workspace.
pub(crate) fn of_crate(name: &str) -> Graph {
    let mut sources = Sources::new();
    read(&crates().join(name).join("src"), "", &mut sources);
    of_sources(&sources)
}

/// Imports between the files of each example of a crate of the workspace, by the example's name.
///
/// An example is a file, which may have modules in a folder of its own name, or a folder with a `main.rs`.
pub(crate) fn of_examples(name: &str) -> Vec<(String, Graph)> {
    let folder = crates().join(name).join("examples");
    let Ok(entries) = std::fs::read_dir(&folder) else { return Vec::new() };
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut examples = Vec::new();
    for path in files {
        let modules = path.with_extension("");
        let mut sources = Sources::new();
        if modules.is_dir() {
            read(&modules, "", &mut sources);
        }
        if path.extension().is_some_and(|extension| extension == "rs") {
            sources.insert(String::from("main.rs"), std::fs::read_to_string(&path).unwrap());
        }
        if sources.contains_key("main.rs") {
            let example = modules.file_name().unwrap_or_default().to_string_lossy().into_owned();
            examples.push((example, of_sources(&sources)));
        }
    }
    examples
}

/// Imports between files, from `lib.rs` or `main.rs` on.
pub(crate) fn of_sources(sources: &Sources) -> Graph {
    let mut graph = Graph::default();
    for root in ["lib.rs", "main.rs"] {
        if sources.contains_key(root) {
            resolution::add_imports(&modules::Modules::read(sources, root), &mut graph);
        }
    }
    graph
}

fn read(directory: &Path, prefix: &str, sources: &mut Sources) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{prefix}{}", entry.file_name().into_string().unwrap());
        if entry.path().is_dir() {
            read(&entry.path(), &format!("{name}/"), sources);
        } else if entry.path().extension().is_some_and(|extension| extension == "rs") {
            sources.insert(name, std::fs::read_to_string(entry.path()).unwrap());
        }
    }
}
