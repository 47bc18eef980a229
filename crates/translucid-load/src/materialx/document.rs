//! A MaterialX document as elements with names and places, and what is found wrong with it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use crate::result::Result;

use roxmltree::{Document, Node, NodeId};
use translucid_scene::{Place, SceneError, Warning};

/// Most elements, attributes' texts and comments of a document.
pub(super) const MOST_NODES: u32 = 1 << 20;

/// Most warnings of a document; a damaged one could make one for every number in it.
const MOST_WARNINGS: usize = 256;

/// The kinds of elements that have names of their own within a scope.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Input,
    Output,
    /// Nodes, node graphs and materials.
    Node,
}

impl Kind {
    fn of(element: Node<'_, '_>) -> Self {
        match element.tag_name().name() {
            "input" => Self::Input,
            "output" => Self::Output,
            _ => Self::Node,
        }
    }
}

/// Elements of a scope by kind and name; none where several have the name.
type Names<'d> = HashMap<(Kind, &'d str), Option<Node<'d, 'd>>>;

/// A document that is being read.
pub(super) struct Source<'d> {
    pub(super) document: &'d Document<'d>,
    path: &'d Path,
    text: Arc<str>,
    scopes: RefCell<HashMap<NodeId, Names<'d>>>,
    warnings: RefCell<Vec<Warning>>,
}

impl<'d> Source<'d> {
    pub(super) fn new(document: &'d Document<'d>, path: &'d Path) -> Self {
        let text = Arc::from(document.input_text());
        Self { document, path, text, scopes: RefCell::default(), warnings: RefCell::default() }
    }

    pub(super) fn into_warnings(self) -> Vec<Warning> {
        self.warnings.into_inner()
    }

    /// Place of an element: that of an input as a whole, else of its tag's name.
    pub(super) fn place(&self, element: Node<'_, '_>) -> Place {
        let range = element.range();
        let end = match element.has_children() {
            true => range.start + 1 + element.tag_name().name().len(),
            false => range.end,
        };
        Place::span(self.path, &self.text, range.start..end)
    }

    pub(super) fn error(&self, element: Node<'_, '_>, message: impl Into<String>) -> SceneError {
        SceneError::at(self.place(element), message)
    }

    /// Says something of an element, once.
    pub(super) fn warn(&self, element: Node<'_, '_>, message: impl Into<String>) {
        let mut warnings = self.warnings.borrow_mut();
        if warnings.len() >= MOST_WARNINGS {
            return;
        }
        let message = match warnings.len() + 1 {
            MOST_WARNINGS => {
                format!("more than {MOST_WARNINGS} inputs cannot be translated: no more are listed")
            }
            _ => message.into(),
        };
        let warning = Warning { message, place: Some(self.place(element)) };
        if !warnings.contains(&warning) {
            warnings.push(warning);
        }
    }

    /// The element of a kind and name in a scope, if there is one.
    ///
    /// # Errors
    /// Several have the name.
    pub(super) fn child(&self, scope: Node<'d, 'd>, kind: Kind, name: &str) -> Result<Option<Node<'d, 'd>>> {
        let mut scopes = self.scopes.borrow_mut();
        let names = scopes.entry(scope.id()).or_insert_with(|| names_in(scope));
        match names.get(&(kind, name)) {
            Some(None) => {
                let message = format!("{} has several elements named \"{}\"", title(scope), shown(name));
                Err(self.error(scope, message))
            }
            Some(Some(element)) => Ok(Some(*element)),
            None => Ok(None),
        }
    }

    /// The element of a kind and name that another refers to.
    ///
    /// # Errors
    /// There is none, or several.
    pub(super) fn referred(
        &self,
        from: Node<'_, '_>,
        scope: Node<'d, 'd>,
        kind: Kind,
        name: &str,
    ) -> Result<Node<'d, 'd>> {
        self.child(scope, kind, name)?.ok_or_else(|| {
            let what = match kind {
                Kind::Input => "input",
                Kind::Output => "output",
                Kind::Node => "node",
            };
            let message = format!("{} has no {what} named \"{}\"", title(scope), shown(name));
            self.error(from, message)
        })
    }
}

fn names_in<'d>(scope: Node<'d, 'd>) -> Names<'d> {
    let mut names = Names::new();
    for element in scope.children().filter(Node::is_element) {
        if let Some(name) = element.attribute("name") {
            let only = !names.contains_key(&(Kind::of(element), name));
            names.insert((Kind::of(element), name), only.then_some(element));
        }
    }
    names
}

/// The value of an attribute of an element, or of the nearest one around it that has it.
pub(super) fn inherited<'d>(element: Node<'d, 'd>, attribute: &str) -> Option<&'d str> {
    element.ancestors().find_map(|ancestor| ancestor.attribute(attribute))
}

/// An element as messages call it: its category and name.
pub(super) fn title(element: Node<'_, '_>) -> String {
    let category = shown(element.tag_name().name());
    match element.attribute("name") {
        Some(name) => format!("{category} \"{}\"", shown(name)),
        None if element.tag_name().name() == "materialx" => String::from("the document"),
        None => category,
    }
}

/// Text of the document as a message shows it: one line, not too long.
pub(super) fn shown(text: &str) -> String {
    clipped(text, 60)
}

/// The first `longest` characters of a text, on one line.
pub(super) fn clipped(text: &str, longest: usize) -> String {
    let line: String = text.chars().take(longest).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(longest).is_some() { format!("{line}…") } else { line }
}
