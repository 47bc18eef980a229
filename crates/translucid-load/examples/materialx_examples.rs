//! Reads the example materials of MaterialX and prints how much of each is read; `--write` puts the table into the guide.
//!
//! ```sh
//! git clone --depth 1 --branch v1.39.5 https://github.com/AcademySoftwareFoundation/MaterialX
//! cargo run -p translucid-load --example materialx_examples -- MaterialX/resources/Materials/Examples --write
//! ```

#![allow(clippy::print_stdout, reason = "the table is for those who ask for it")]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use translucid_load::parse_materialx;
use translucid_scene::Unit;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/materialx.md");

/// Where the table is.
const MARKERS: [&str; 2] = [
    "<!-- measured: cargo run -p translucid-load --example materialx_examples -- MaterialX/resources/Materials/Examples --write -->",
    "<!-- end of what was measured -->",
];

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(folder) = arguments.iter().find(|argument| *argument != "--write") else {
        println!("usage: materialx_examples FOLDER [--write]");
        return Ok(());
    };
    let mut files = Vec::new();
    collect(Path::new(folder), &mut files)?;
    files.sort();
    let mut table = String::from("\n| document | what is not read |\n|---|---|\n");
    let mut whole = 0;
    for file in &files {
        let found = read(&std::fs::read(file)?, file);
        whole += usize::from(found == "–");
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        let _ = writeln!(table, "| `{name}` | {found} |");
    }
    let _ = write!(table, "\n{whole} of {} documents are read whole.\n\n", files.len());
    println!("{table}");
    if arguments.iter().any(|argument| argument == "--write") {
        let text = std::fs::read_to_string(PAGE)?;
        let (head, rest) = text.split_once(MARKERS[0]).unwrap_or((&text, ""));
        let (_, tail) = rest.split_once(MARKERS[1]).unwrap_or(("", ""));
        std::fs::write(PAGE, format!("{head}{}{table}{}{tail}", MARKERS[0], MARKERS[1]))?;
    }
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "mtlx") {
            files.push(path);
        }
    }
    Ok(())
}

/// Lists the inputs of a document's materials that are not read.
fn read(bytes: &[u8], path: &Path) -> String {
    let text = String::from_utf8_lossy(bytes);
    let mut found = Vec::new();
    for name in names(&text) {
        let mut warnings = Vec::new();
        if let Err(error) = parse_materialx(bytes, path, name, Unit::Centimeter, &mut warnings) {
            found.push(format!("refused: {}", error.message));
        }
        for warning in warnings {
            // The shader's name says nothing here
            let message = warning.message.split_once("\", ").map_or(&*warning.message, |(_, rest)| rest);
            let message = message.split(" (file_unit").next().unwrap_or(message).to_owned();
            if !found.contains(&message) {
                found.push(message);
            }
        }
    }
    if found.is_empty() { String::from("–") } else { found.join("; ") }
}

/// The materials that a document has, or that its look assigns.
fn names(text: &str) -> Vec<Option<&str>> {
    let behind = |word: &'static str| text.split(word).skip(1).filter_map(|rest| rest.split('"').next());
    let mut names: Vec<&str> = behind("<surfacematerial name=\"").chain(behind(" material=\"")).collect();
    names.dedup();
    if names.is_empty() { vec![None] } else { names.into_iter().map(Some).collect() }
}
