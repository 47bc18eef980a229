//! No circle of imports between the files of a crate or of an example, but for a module with those below it.

use crate::imports::{self, Graph, Sources};

/// Describes the circles of a crate, one line for each import.
fn described(name: &str, graph: &Graph) -> String {
    let mut text = String::new();
    for (i, circle) in graph.circles().iter().enumerate() {
        text += &format!("{name}, circle {} of {} files:\n", i + 1, circle.len());
        for import in circle {
            text += &format!("  {import}\n");
        }
    }
    text
}

#[test]
fn circles_are_in_no_crate() {
    let circles: String =
        imports::crate_names().iter().map(|name| described(name, &imports::of_crate(name))).collect();
    assert!(circles.is_empty(), "\n{circles}");
}

#[test]
fn circles_are_in_no_example() {
    let names = imports::crate_names();
    let examples = names.iter().flat_map(|name| imports::of_examples(name)).collect::<Vec<_>>();
    let circles: String = examples.iter().map(|(name, graph)| described(name, graph)).collect();
    assert!(circles.is_empty(), "\n{circles}");
    // Those with modules have been read with them
    for (name, module) in [("documents", "tables.rs"), ("fit_oblique", "shape_fit.rs")] {
        let found = examples
            .iter()
            .any(|(example, graph)| example == name && graph.files().any(|(file, _)| file == module));
        assert!(found, "{name} is not read with its {module}");
    }
}

/// Imports between synthetic files.
fn graph(files: &[(&str, &str)]) -> Graph {
    let sources: Sources =
        files.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
    imports::of_sources(&sources)
}

fn circles(files: &[(&str, &str)]) -> String {
    described("x", &graph(files))
}

#[test]
fn circle_of_two_files_is_found_with_its_lines() {
    let found = circles(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "// A comment\nuse crate::b::B;\npub struct A;"),
        ("b.rs", "pub struct B;\nfn f() {}\nfn g(a: &super::a::A) {}"),
    ]);
    let expected = "x, circle 1 of 2 files:\n  a.rs:2 imports crate::b::B of b.rs\n  b.rs:3 imports super::a::A of a.rs\n";
    assert_eq!(found, expected);
}

#[test]
fn circle_of_three_files_is_found() {
    let found = circles(&[
        ("main.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::{B, self};\npub struct A;"),
        ("b.rs", "pub struct B;\nfn f() -> u8 { crate::c::g() }"),
        ("c.rs", "use super::a; pub fn g() -> u8 { a::A::new() }"),
    ]);
    assert_eq!(found.lines().count(), 4, "{found}");
    assert!(found.contains("c.rs:1 imports a::A::new of a.rs"), "{found}");
}

#[test]
fn circle_through_exports_is_found() {
    let found = circles(&[
        ("lib.rs", "mod a; mod b; pub use a::A;"),
        ("a/mod.rs", "mod inner; pub use inner::{Inner as A}; pub use inner::*;"),
        ("a/inner.rs", "use crate::b::B; pub struct Inner; pub struct Other;"),
        ("b.rs", "use crate::A; pub struct B;"),
    ]);
    assert!(found.contains("b.rs:1 imports crate::A of a/inner.rs"), "{found}");
    let starred = circles(&[
        ("lib.rs", "mod a; mod b;"),
        ("a/mod.rs", "mod inner; pub use inner::*;"),
        ("a/inner.rs", "use crate::b::B; pub struct Other;"),
        ("b.rs", "use crate::a::*; pub struct B(Other);"),
    ]);
    assert!(starred.contains("b.rs:1 imports crate::a::Other of a/inner.rs"), "{starred}");
}

#[test]
fn circle_with_a_macro_is_found() {
    let found = circles(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "macro_rules! m { () => {} }\npub(crate) use m; use crate::b::B;"),
        ("b.rs", "use crate::a::m; pub struct B;"),
    ]);
    assert_eq!(found.lines().count(), 3, "{found}");
}

#[test]
fn circles_are_shown_once() {
    let found = circles(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::B; use crate::c::C; pub struct A;"),
        ("b.rs", "use crate::a::A; pub struct B;"),
        ("c.rs", "use crate::a::A; pub struct C;"),
    ]);
    assert_eq!(found.matches("circle").count(), 2, "{found}");
}

#[test]
fn modules_may_know_those_below_them() {
    let found = circles(&[
        ("lib.rs", "mod a; pub struct Root; use a::A;"),
        ("a.rs", "mod b; use b::B; pub struct A; use crate::Root;"),
        ("a/b.rs", "mod c; use super::A; use crate::Root; pub struct B; use c::C;"),
        ("a/b/c.rs", "use crate::a::A; use super::B; pub struct C;"),
    ]);
    assert_eq!(found, "");
}

#[test]
fn tests_comments_and_strings_import_nothing() {
    let found = circles(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; pub struct A; pub fn f() {}"),
        (
            "b.rs",
            "//! [crate::a::A]\npub struct B; /* crate::a::A */ const S: &str = \"crate::a::A\";\n\
             #[cfg(test)] mod tests { use crate::a::A; }\n#[cfg(test)] use crate::a::f;",
        ),
    ]);
    assert_eq!(found, "");
}

#[test]
fn inline_modules_are_part_of_their_file() {
    let found = circles(&[
        ("lib.rs", "mod a { pub mod inner { use super::super::b::B; pub struct I; } } mod b;"),
        ("b.rs", "use crate::a::inner::I; pub struct B;"),
    ]);
    assert_eq!(found, "");
    assert_eq!(graph(&[("lib.rs", "mod a; mod b {}"), ("a.rs", "use crate::b::X;")]).imports().count(), 1);
}
