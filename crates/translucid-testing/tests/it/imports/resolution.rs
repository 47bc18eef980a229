//! Names to the files that define them.

use super::graph::Graph;
use super::modules::{CodePath, Modules};

/// What a path leads to.
#[derive(Clone, Copy)]
enum Found<'a> {
    Module(usize),
    /// An item of a module.
    Item(usize, &'a str),
}

/// Adds all imports between the files of a crate to a graph.
pub(super) fn add_imports(modules: &Modules, graph: &mut Graph) {
    for (index, module) in modules.0.iter().enumerate() {
        graph.add_file(&module.file, &module.path);
        let targets = module.uses.iter().filter(|found| found.name != "*").map(|found| found.target.clone());
        for path in targets.chain(module.paths.iter().cloned()).chain(by_star(modules, index)) {
            // A module that is only named is imported where a name of it is.
            if let Some(Found::Item(defining, _)) = modules.resolve(index, &path.names, 0) {
                graph.add_import(&module.file, &modules.0[defining].file, path.line, &path.names.join("::"));
            }
        }
    }
}

/// Paths of the names of a module that come with a `*`.
fn by_star(modules: &Modules, index: usize) -> Vec<CodePath> {
    let module = &modules.0[index];
    let stars = module.uses.iter().filter(|found| found.name == "*");
    let of_star = |star: &super::modules::Use| {
        let path = |(word, line): (&String, &usize)| CodePath {
            names: star.target.names.iter().chain([word]).cloned().collect(),
            line: *line,
        };
        let is_new = |(word, _): &(&String, &usize)| {
            !module.items.contains(*word) && !module.children.contains_key(*word)
        };
        module.words.iter().filter(is_new).map(path).collect::<Vec<_>>()
    };
    // A path of a word that the star does not bring leads to the module itself, or nowhere.
    let leads = |path: &CodePath| matches!(modules.resolve(index, &path.names, 0), Some(Found::Item(_, name)) if path.names.last().is_some_and(|last| last == name));
    stars.flat_map(of_star).filter(leads).collect()
}

/// How many `use` a name may go through: more are a circle.
const MOST_USES: usize = 32;

impl Modules {
    /// Finds what a path means in a module; `None` if it leads out of the crate.
    fn resolve<'a>(&'a self, from: usize, names: &[String], uses: usize) -> Option<Found<'a>> {
        let (first, rest) = names.split_first()?;
        let mut found = match first.as_str() {
            "crate" => Found::Module(0),
            "self" => Found::Module(from),
            "super" => Found::Module(self.0[from].parent?),
            name => self.named(from, name, uses)?,
        };
        for name in rest {
            let Found::Module(module) = found else { break };
            found = match (name.as_str(), self.0[module].parent) {
                ("super", Some(parent)) => Found::Module(parent),
                // A name that is not found comes out of a macro: of this module, as far as can be known.
                _ => self.named(module, name, uses).unwrap_or(Found::Item(module, "")),
            };
        }
        Some(found)
    }

    /// Finds what a name means in a module.
    fn named(&self, module: usize, name: &str, uses: usize) -> Option<Found<'_>> {
        if uses > MOST_USES {
            return None;
        }
        let scope = &self.0[module];
        if let Some(item) = scope.items.get(name) {
            return Some(Found::Item(module, item));
        }
        if let Some(child) = scope.children.get(name) {
            return Some(Found::Module(*child));
        }
        let by_name = scope.uses.iter().find(|found| found.name == name && found.target.names != [name]);
        if let Some(found) = by_name {
            return self.resolve(module, &found.target.names, uses + 1);
        }
        // The head of a star's path does not come by a star, or two stars would ask each other without end
        let has_head = |path: &CodePath| match path.names[0].as_str() {
            "crate" | "self" | "super" => true,
            head => scope.children.contains_key(head) || scope.uses.iter().any(|found| found.name == head),
        };
        let stars = scope.uses.iter().filter(|found| found.name == "*" && has_head(&found.target));
        let mut sources = stars.filter_map(|star| match self.resolve(module, &star.target.names, uses + 1) {
            Some(Found::Module(source)) if source != module => self.named(source, name, uses + 1),
            _ => None,
        });
        sources.next()
    }
}
