//! The modules of a crate: what each defines, takes from elsewhere, and names.

use std::collections::{BTreeMap, BTreeSet};

use super::Sources;
use super::tokens::{Token, tokens};

/// A path that stands in code, as `a::b::C`, and its line.
#[derive(Clone, Debug)]
pub(super) struct CodePath {
    pub(super) names: Vec<String>,
    pub(super) line: usize,
}

/// A name that a `use` brings into a module.
#[derive(Clone, Debug)]
pub(super) struct Use {
    /// The name in this module, `*` for all that its target has.
    pub(super) name: String,
    pub(super) target: CodePath,
}

/// A module, be it a file or inline.
#[derive(Debug, Default)]
pub(super) struct Module {
    pub(super) file: String,
    /// Names from the root to here.
    pub(super) path: Vec<String>,
    pub(super) parent: Option<usize>,
    pub(super) children: BTreeMap<String, usize>,
    /// Names of the items that are defined here.
    pub(super) items: BTreeSet<String>,
    pub(super) uses: Vec<Use>,
    /// Paths in code beside its `use`.
    pub(super) paths: Vec<CodePath>,
    /// Single words, by which names that come with a `*` are known.
    pub(super) words: BTreeMap<String, usize>,
}

/// All modules of a crate; the first is its root.
#[derive(Debug, Default)]
pub(super) struct Modules(pub(super) Vec<Module>);

impl Modules {
    /// Reads modules from a root file on. Modules whose files are missing are left out.
    pub(super) fn read(sources: &Sources, root: &str) -> Self {
        let mut modules = Self::default();
        modules.add_file(sources, root, None, Vec::new());
        modules
    }

    fn add_file(&mut self, sources: &Sources, file: &str, parent: Option<usize>, path: Vec<String>) {
        let index = self.add(file.to_owned(), parent, path);
        let tokens = tokens(&sources[file]);
        self.read_module(sources, index, &mut Cursor { tokens: &tokens, next: 0 });
    }

    fn add(&mut self, file: String, parent: Option<usize>, path: Vec<String>) -> usize {
        let index = self.0.len();
        if let (Some(parent), Some(name)) = (parent, path.last()) {
            self.0[parent].children.insert(name.clone(), index);
        }
        self.0.push(Module { file, path, parent, ..Module::default() });
        index
    }

    /// Reads a module up to the brace that closes it, or to the end of its file.
    fn read_module(&mut self, sources: &Sources, index: usize, cursor: &mut Cursor) {
        let mut depth = 0;
        while let Some(token) = cursor.take() {
            let is_item = depth == 0 && !cursor.is_behind("::");
            match token.text.as_str() {
                "{" => depth += 1,
                "}" if depth == 0 => return,
                "}" => depth -= 1,
                "use" if !cursor.is_at("<") => self.0[index].uses.extend(cursor.use_tree(Vec::new())),
                "mod" if is_item => self.read_child(sources, index, cursor),
                keyword if is_item && DEFINING.contains(&keyword) => {
                    if let Some(name) = cursor.name() {
                        self.0[index].items.insert(name);
                    }
                }
                _ if token.is_word() => self.read_path(index, token, cursor),
                _ => {}
            }
        }
    }

    /// Reads what follows `mod`: a name with a block, or one with a file of its own.
    fn read_child(&mut self, sources: &Sources, index: usize, cursor: &mut Cursor) {
        let Some(name) = cursor.name() else { return };
        let mut path = self.0[index].path.clone();
        path.push(name);
        let inline = cursor.take().is_some_and(|token| token.is("{"));
        if inline {
            let child = self.add(self.0[index].file.clone(), Some(index), path);
            self.read_module(sources, child, cursor);
            return;
        }
        let files = [format!("{}.rs", path.join("/")), format!("{}/mod.rs", path.join("/"))];
        if let Some(file) = files.iter().find(|file| sources.contains_key(*file)) {
            self.add_file(sources, file, Some(index), path);
        }
    }

    /// Reads a path whose first word is `first`.
    fn read_path(&mut self, index: usize, first: &Token, cursor: &mut Cursor) {
        if cursor.is_behind("::") || cursor.is_behind(".") {
            return;
        }
        let mut names = vec![first.text.clone()];
        while cursor.is_at("::") && cursor.tokens.get(cursor.next + 1).is_some_and(Token::is_word) {
            names.push(cursor.tokens[cursor.next + 1].text.clone());
            cursor.next += 2;
        }
        let module = &mut self.0[index];
        if names.len() > 1 {
            module.words.entry(names[0].clone()).or_insert(first.line);
            module.paths.push(CodePath { names, line: first.line });
        } else {
            module.words.entry(first.text.clone()).or_insert(first.line);
        }
    }
}

/// Words behind which the name of a new item stands.
const DEFINING: [&str; 9] =
    ["const", "enum", "fn", "macro_rules", "static", "struct", "trait", "type", "union"];

/// A place among the tokens of a file.
struct Cursor<'a> {
    tokens: &'a [Token],
    next: usize,
}

impl<'a> Cursor<'a> {
    fn take(&mut self) -> Option<&'a Token> {
        let token = self.tokens.get(self.next);
        self.next += 1;
        token
    }

    fn is_at(&self, text: &str) -> bool {
        self.tokens.get(self.next).is_some_and(|token| token.is(text))
    }

    /// Whether `text` stands before the token that was taken last.
    fn is_behind(&self, text: &str) -> bool {
        self.next >= 2 && self.tokens[self.next - 2].is(text)
    }

    /// Takes a name, and the `!` of a macro before it, if there is one.
    fn name(&mut self) -> Option<String> {
        if self.is_at("!") {
            self.next += 1;
        }
        let token = self.tokens.get(self.next).filter(|token| token.is_word())?;
        if DEFINING.contains(&token.text.as_str()) {
            return None;
        }
        self.next += 1;
        Some(token.text.clone())
    }

    /// Takes the tree behind `use`, or a branch of it below `prefix`, up to the `;`, `,` or `}` that ends it.
    fn use_tree(&mut self, prefix: Vec<String>) -> Vec<Use> {
        let mut names = prefix;
        let mut uses = Vec::new();
        while let Some(token) = self.take() {
            match token.text.as_str() {
                "{" => {
                    while !self.is_at("}") && self.next < self.tokens.len() {
                        uses.extend(self.use_tree(names.clone()));
                        if self.is_at(",") {
                            self.next += 1;
                        }
                    }
                    self.next += 1;
                    return uses;
                }
                "as" => {
                    let name = self.take().map_or_else(String::new, |token| token.text.clone());
                    let target = CodePath { names, line: token.line };
                    return vec![Use { name, target }];
                }
                "::" => {}
                "self" if !names.is_empty() => {}
                _ => names.push(token.text.clone()),
            }
            if [";", ",", "}"].iter().any(|end| self.is_at(end)) {
                let name = names.last().cloned().unwrap_or_default();
                if name == "*" {
                    names.pop();
                }
                let target = CodePath { names, line: token.line };
                return vec![Use { name, target }];
            }
        }
        uses
    }
}
