//! Tables of numbers in the book are those that a command writes, so none can go out of date unseen.

use std::path::{Path, PathBuf};

use crate::imports;

/// Parts of the book whose tables of numbers are all written by commands.
const PARTS: [&str; 3] = ["accuracy", "speed", "models"];

/// Starts of the lines before a table that a command writes; the second one's rest is the command.
const GENERATED: &str = "<!-- generated: ";
const MEASURED: &str = "<!-- measured: ";

/// Lines of tables, from 1, that have a number and that no command writes.
fn unwritten_rows(page: &str) -> Vec<usize> {
    let (mut is_code, mut is_written) = (false, false);
    let mut rows = Vec::new();
    for (line, text) in (1..).zip(page.lines()) {
        is_code ^= text.starts_with("```");
        is_written = text.starts_with(GENERATED)
            || text.starts_with(MEASURED)
            || is_written && !text.starts_with("<!-- end");
        if text.starts_with('|') && !is_code && !is_written && text.split('|').any(is_number) {
            rows.push(line);
        }
    }
    rows
}

/// Whether a cell begins with a number, whatever its unit or error.
fn is_number(cell: &str) -> bool {
    let word = cell.split_whitespace().next().unwrap_or_default();
    word.trim_matches(['`', '*', '%', '×']).replace('−', "-").parse::<f64>().is_ok()
}

/// Pages of the book's [`PARTS`] with their text.
fn pages() -> Vec<(PathBuf, String)> {
    let book = imports::crates().join("../docs");
    let pages = PARTS.iter().flat_map(|part| std::fs::read_dir(book.join(part)).unwrap());
    let pages = pages.map(|entry| entry.unwrap().path());
    pages.map(|path| (path.clone(), std::fs::read_to_string(&path).unwrap())).collect()
}

/// The source of a command: a script, or an example or a bench of a crate.
fn source(command: &str) -> Option<PathBuf> {
    let root = imports::crates().join("..");
    let after = |option: &str| command.split_whitespace().skip_while(|word| *word != option).nth(1);
    if let Some(script) = command.split_whitespace().find(|word| word.ends_with(".py")) {
        return Some(root.join(script));
    }
    let (folder, name) = match (after("--example"), after("--bench")) {
        (Some(name), None) => ("examples", name),
        (None, Some(name)) => ("benches", name),
        _ => return None,
    };
    Some(root.join("crates").join(after("-p")?).join(folder).join(name).with_extension("rs"))
}

#[test]
fn numbers_in_tables_are_written_by_commands() {
    let pages = pages();
    assert!(pages.len() > 20, "{}", pages.len());
    let places: Vec<String> = pages
        .iter()
        .flat_map(|(path, text)| {
            unwritten_rows(text).into_iter().map(|row| format!("{}:{row}", path.display()))
        })
        .collect();
    assert!(
        places.is_empty(),
        "give the command that prints these rows a `--write`, and put them between its marks:\n{}",
        places.join("\n")
    );
}

#[test]
fn commands_of_measured_tables_write_them() {
    let writes = |path: &Path| std::fs::read_to_string(path).is_ok_and(|text| text.contains("--write"));
    let mut count = 0;
    for (path, text) in pages() {
        for command in text.lines().filter_map(|line| line.strip_prefix(MEASURED)) {
            count += 1;
            let is_written = source(command).is_some_and(|source| writes(&source));
            assert!(
                is_written,
                "{}: there is no such command, or it has no --write: {command}",
                path.display()
            );
        }
    }
    assert!(count > 10, "{count}");
}

#[test]
fn unwritten_rows_are_found() {
    let page = "| a | 0.5 |\n| b | −3 % |\n| `c` | 1/L² |\n\n<!-- measured: x -->\n\n| d | 1 |\n\n<!-- end of what \
                was measured -->\n\n```text\n| e | 1 |\n```\n\n<!-- generated: y -->\n| f | 1 |\n<!-- end -->\n| 2 ± 1 | g |\n";
    assert_eq!(unwritten_rows(page), [1, 2, 18]);
}
