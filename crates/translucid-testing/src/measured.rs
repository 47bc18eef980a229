//! Tables of documents that benches write.

use std::path::Path;

const END: &str = "<!-- end of what was measured -->";

/// Puts a text into a document, whose path begins at the workspace, between the mark that names the command which
/// prints it and the end of what was measured.
///
/// # Panics
/// The document cannot be read or written, or has no such marks.
pub fn write_measured(document: &str, command: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(document);
    let begin = format!("<!-- measured: {command} -->");
    let old = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{document}: {error}"));
    let marks = old.split_once(&begin).and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let (head, tail) = marks.unwrap_or_else(|| panic!("{document} has no marks {begin} … {END}"));
    let new = format!("{head}{begin}\n\n{}\n\n{END}{tail}", text.trim());
    std::fs::write(&path, new).unwrap_or_else(|error| panic!("{document}: {error}"));
}
