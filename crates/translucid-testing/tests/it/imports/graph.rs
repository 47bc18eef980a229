//! The graph of imports, and circles in it.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;

/// A line of a file that names something of another file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Import {
    /// Path of the file below `src`.
    pub(crate) from: String,
    pub(crate) to: String,
    /// From 1.
    pub(crate) line: usize,
    /// The path in the code.
    pub(crate) path: String,
}

impl fmt::Display for Import {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{} imports {} of {}", self.from, self.line, self.path, self.to)
    }
}

/// Files and the first import from each to each other.
#[derive(Debug, Default)]
pub(crate) struct Graph {
    /// Files by name, with the names of their modules from the root on.
    files: BTreeMap<String, Vec<String>>,
    imports: BTreeMap<(String, String), Import>,
}

impl Graph {
    /// Adds a file, which may be known, with the path of its module.
    pub(super) fn add_file(&mut self, file: &str, module: &[String]) {
        self.files.entry(file.to_owned()).or_insert_with(|| module.to_vec());
    }

    /// Adds an import, unless it is one within a file.
    pub(super) fn add_import(&mut self, from: &str, to: &str, line: usize, path: &str) {
        if from != to {
            let import = || Import { from: from.to_owned(), to: to.to_owned(), line, path: path.to_owned() };
            self.imports.entry((from.to_owned(), to.to_owned())).or_insert_with(import);
        }
    }

    /// All files, with the names of their modules from the root on.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&str, &[String])> {
        self.files.iter().map(|(file, module)| (file.as_str(), module.as_slice()))
    }

    /// All imports, in the order of their files.
    pub(crate) fn imports(&self) -> impl Iterator<Item = &Import> {
        self.imports.values()
    }

    /// Names of the module that a file is, from the root on.
    pub(crate) fn module(&self, file: &str) -> &[String] {
        &self.files[file]
    }

    /// Circles of imports, the shortest first, no import in two of them.
    ///
    /// What a module imports of those below it is not part of any.
    pub(crate) fn circles(&self) -> Vec<Vec<&Import>> {
        let counts = |import: &&Import| !self.module(&import.to).starts_with(self.module(&import.from));
        let mut open: Vec<&Import> = self.imports.values().filter(counts).collect();
        let mut circles = Vec::new();
        while let Some(circle) = shortest_circle(&open) {
            open.retain(|import| !circle.contains(import));
            circles.push(circle);
        }
        circles
    }
}

fn shortest_circle<'a>(imports: &[&'a Import]) -> Option<Vec<&'a Import>> {
    let circles = imports.iter().filter_map(|first| {
        let mut circle = vec![*first];
        circle.extend(shortest_way(imports, &first.to, &first.from)?);
        Some(circle)
    });
    circles.min_by_key(Vec::len)
}

/// The shortest way from a file to another, breadth first.
fn shortest_way<'a>(imports: &[&'a Import], from: &str, to: &str) -> Option<Vec<&'a Import>> {
    let mut reached = BTreeSet::from([from]);
    let mut ways = VecDeque::from([Vec::<&Import>::new()]);
    while let Some(way) = ways.pop_front() {
        let here = way.last().map_or(from, |import| import.to.as_str());
        if here == to {
            return Some(way);
        }
        for import in imports.iter().filter(|import| import.from == here) {
            if reached.insert(&import.to) {
                ways.push_back(way.iter().copied().chain([*import]).collect());
            }
        }
    }
    None
}
