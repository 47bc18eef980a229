//! Both tables of contents of the book name every page.

use std::path::{Path, PathBuf};

use crate::imports;

/// Markdown files below a folder.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of_path = |path: PathBuf| match path.is_dir() {
        true => pages(&path),
        false => vec![path],
    };
    paths
        .flat_map(of_path)
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect()
}

#[test]
fn tables_of_contents_name_every_page() {
    let book = imports::crates().join("../docs");
    let all = pages(&book);
    for contents in ["README.md", "SUMMARY.md"] {
        let text = std::fs::read_to_string(book.join(contents)).unwrap();
        for page in all.iter().filter(|page| page.parent() != Some(book.as_path())) {
            let name = page.strip_prefix(&book).unwrap().display();
            assert!(text.contains(&format!("({name})")), "docs/{contents} does not name {name}");
        }
    }
}
