//! The entry pages of the book, `docs/start`: short, linked, and every command on them runs.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use crate::common::{run, stderr, translucid};
use crate::markdown::{Page, pages_below, root};

const LENGTH: usize = 60;

/// The commands of a page, in their order.
fn commands(page: &Page) -> Vec<String> {
    page.code().into_iter().filter(|block| block.language == "sh").flat_map(|block| block.lines).collect()
}

/// A directory in which the pages' commands find what a clone has.
fn clone() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("scenes")).unwrap();
    std::fs::copy(root().join("scenes/bust.ply"), folder.path().join("scenes/bust.ply")).unwrap();
    folder
}

/// The command with options that make it take a moment in place of its own.
fn quick(words: &str) -> String {
    let quick = match words.split_whitespace().next() {
        Some("render") if !words.contains("--preset list") => "--size 16x12 --spp 1",
        Some("reference") if words.contains("monte-carlo") => "--photons 10000",
        Some("oracle") => "--photons 1000",
        _ => "",
    };
    let mut kept = Vec::new();
    let mut all = words.split_whitespace();
    while let Some(word) = all.next() {
        if quick.split_whitespace().any(|option| option == word) {
            all.next();
        } else {
            kept.push(word);
        }
    }
    kept.extend(quick.split_whitespace());
    kept.join(" ")
}

/// The file or folder that a command writes.
fn output(words: &str) -> Option<&str> {
    words.split_whitespace().skip_while(|word| *word != "-o").nth(1)
}

/// Opens the page in no browser, and waits for its address.
fn view(folder: &Path, words: &str) {
    let mut command = translucid(folder);
    command.args(words.split_whitespace()).arg("--no-open").stdout(Stdio::piped()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let is_open = lines.map_while(Result::ok).any(|line| line.contains("http://"));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(is_open, "{words} prints no address");
}

/// The program of an example, which `.ci/gpu` has built beside the command.
fn example(folder: &Path, words: &str) {
    let (cargo, arguments) = words.split_once(" -- ").expect("arguments after --");
    let name = cargo.rsplit(' ').next().unwrap();
    assert!(cargo.ends_with(&format!("-p translucid-gpu --features device --example {name}")), "{words}");
    assert!(root().join("crates/translucid-gpu/examples").join(name).join("main.rs").exists(), "{words}");
    if cfg!(feature = "gpu") {
        let program = Path::new(env!("CARGO_BIN_EXE_translucid")).with_file_name("examples").join(name);
        let mut command = std::process::Command::new(&program);
        let output = command.current_dir(folder).args(arguments.split_whitespace()).output();
        let output =
            output.unwrap_or_else(|error| panic!("{}: {error}; .ci/gpu builds it", program.display()));
        assert!(output.status.success(), "{words}: {}", stderr(&output));
    }
}

#[test]
fn commands_of_the_entry_pages_run() {
    let pages = pages_below(&root().join("docs/start"));
    assert_eq!(pages.len(), 3);
    for page in pages {
        let clone = clone();
        let folder = clone.path();
        for line in commands(&page) {
            let place = format!("{}: {line}", page.path.display());
            if let Some(path) = line.strip_prefix("cargo install --locked --path ") {
                assert!(root().join(path).join("Cargo.toml").exists(), "{place}");
            } else if line.starts_with("cargo run ") {
                example(folder, &line);
            } else {
                let words = line.strip_prefix("translucid ").unwrap_or_else(|| panic!("{place}"));
                if words.starts_with("view ") {
                    view(folder, words);
                } else if words.starts_with("judge ") {
                    judge(folder, words);
                } else {
                    let made = run(folder, &quick(words));
                    assert!(made.status.success(), "{place}: {}", stderr(&made));
                    assert!(output(words).is_none_or(|name| folder.join(name).exists()), "{place}");
                }
            }
        }
    }
}

/// With a device the example's picture is right in all channels; without one there is no picture, and the options are read.
fn judge(folder: &Path, words: &str) {
    let judged = run(folder, words);
    let text = String::from_utf8_lossy(&judged.stdout);
    if cfg!(feature = "gpu") {
        assert!(judged.status.success(), "{}", stderr(&judged));
        let right = |channel: &str| text.contains(&format!("{channel}: right"));
        assert!(["red", "green", "blue"].into_iter().all(right), "{text}");
    } else {
        assert!(stderr(&judged).contains("pass.exr"), "{}", stderr(&judged));
    }
}

#[test]
fn entry_pages_are_short_and_linked() {
    let [readme, front] = ["README.md", "docs/README.md"]
        .map(|name| (name, std::fs::read_to_string(root().join(name)).unwrap()));
    for page in pages_below(&root().join("docs/start")) {
        let lines = std::fs::read_to_string(&page.path).unwrap().lines().count();
        assert!(lines <= LENGTH, "{} has {lines} lines, but may have {LENGTH}", page.path.display());
        for ((name, text), folder) in [(&readme, "docs/start"), (&front, "start")] {
            let link = format!("({folder}/{}.md)", page.stem());
            assert!(text.contains(&link), "{name} does not link {link}");
        }
    }
}
