//! Writes the laws of this crate as WGSL: `src/laws.wgsl`.
//!
//! ```sh
//! cargo run -p translucid-law --example laws
//! ```
//!
//! The test of this example fails where that file is out of date.

mod writer;

use std::path::{Path, PathBuf};

fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(name)
}

/// All modules of the crate, in their order, but for the one that has a text of its own in WGSL.
fn laws() -> String {
    let read = |name: &str| std::fs::read_to_string(source(name)).unwrap();
    let modules = writer::modules(&read("lib.rs"));
    let modules = modules.iter().filter(|name| *name != "elementary");
    let files: Vec<_> = modules.map(|name| syn::parse_file(&read(&format!("{name}.rs"))).unwrap()).collect();
    writer::wgsl(&files)
}

fn main() -> std::io::Result<()> {
    std::fs::write(source("laws.wgsl"), laws())
}

#[test]
fn laws_are_those_of_the_sources() {
    assert!(std::fs::read_to_string(source("laws.wgsl")).unwrap() == laws(), "run the example `laws`");
}
