//! The entry pages of the book, `docs/start`: short, linked, and every command on them runs.

use std::collections::HashSet;
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

/// Folders whose files commands read.
const INPUTS: [&str; 6] =
    ["scenes", "examples", "examples/judge", "examples/layers", "examples/photographs", "examples/stack"];

/// A directory in which the pages' commands find what a clone has.
fn clone() -> tempfile::TempDir {
    let clone = tempfile::tempdir().unwrap();
    for input in INPUTS {
        let place = clone.path().join(input);
        std::fs::create_dir_all(&place).unwrap();
        for entry in std::fs::read_dir(root().join(input)).unwrap().map(Result::unwrap) {
            if entry.file_type().unwrap().is_file() {
                std::fs::copy(entry.path(), place.join(entry.file_name())).unwrap();
            }
        }
    }
    clone
}

/// Whether a command needs no file, or only such as a clone has.
fn has_its_files(folder: &Path, words: &str) -> bool {
    const ENDS: [&str; 9] = [".csv", ".exr", ".mci", ".npz", ".obj", ".ply", ".glb", ".png", ".toml"];
    let made = output(words);
    let named = words.split_whitespace().filter(|word| ENDS.iter().any(|end| word.ends_with(end)));
    named.filter(|word| Some(*word) != made).all(|word| folder.join(word).exists())
}

/// The command with options that make it take a moment in place of its own.
fn quick(words: &str) -> String {
    let quick = match words.split_whitespace().next() {
        Some("render") if words.contains("--preset list") => "",
        Some("render") if words.contains("--samples") => "--size 16x12",
        Some("render") if words.contains("--time") => "--size 16x12 --time 0.1",
        Some("render") => "--size 16x12 --spp 1",
        Some("skin") if !words.contains("--what color") => "--photons 100",
        Some("measure") if words.contains("--scene") => "--spp 4",
        Some("reference") if words.contains("monte-carlo") && !words.contains("..") => "--photons 10000",
        Some("sample") => "--count 1000",
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
            } else if line == "pip install pyoidn" {
                // The denoiser, which needs a network
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

/// The shipped picture and, with a device, the example's are right in all channels; where there is no picture, the options are
/// read.
fn judge(folder: &Path, words: &str) {
    let judged = run(folder, words);
    let text = String::from_utf8_lossy(&judged.stdout);
    if cfg!(feature = "gpu") || has_its_files(folder, words) {
        assert!(judged.status.success(), "{}", stderr(&judged));
        let right = |channel: &str| text.contains(&format!("{channel}: right"));
        assert!(["red", "green", "blue"].into_iter().all(right), "{text}");
    } else {
        assert!(stderr(&judged).contains("pass.exr"), "{}", stderr(&judged));
    }
}

/// Commands that take a moment run; of the others the files are there, or made by a line before.
#[test]
fn computations_of_the_readme_find_their_files_and_run() {
    let clone = clone();
    let folder = clone.path();
    let mut ran = Vec::new();
    let mut made: Vec<String> = Vec::new();
    for line in commands(&Page::read(&root().join("README.md"))) {
        let words = line.split(" # ").next().unwrap_or_default().trim_end();
        let Some(words) = words.strip_prefix("translucid ") else { continue };
        let verb = words.split_whitespace().next().unwrap_or_default();
        if ["profile", "sample", "reference", "stack", "convert", "oracle"].contains(&verb) {
            let done = run(folder, &quick(words));
            assert!(done.status.success(), "{line}: {}", stderr(&done));
            ran.push(verb.to_owned());
        } else {
            let is_input = |word: &&str| [".toml", ".ply", ".exr"].iter().any(|end| word.ends_with(end));
            for input in words.split_whitespace().filter(is_input) {
                let is_made = made.iter().any(|name| name == input) || output(words) == Some(input);
                assert!(is_made || root().join(input).exists(), "{line}: {input} is not there");
            }
        }
        made.extend(output(words).map(str::to_owned));
    }
    assert_eq!(ran, ["profile", "sample", "reference", "stack", "convert", "oracle"]);
}

/// Words of examples that do not run here: they take minutes, and other tests run something smaller, or they need another
/// program, a shell, or files of another help or of one's own.
const LEFT_OUT: [&str; 12] = [
    "compare",
    "fit --config",
    "fit --family",
    "half-space",
    "oracle",
    "--error",
    "photon-beam",
    "part-",
    "node-",
    "--tev",
    " > ",
    "pass.exr",
];

/// Every example in a help runs, but for slow ones.
#[test]
fn examples_of_help_run() {
    let clone = clone();
    let folder = clone.path();
    // A scene and a mesh of one's own
    std::fs::copy(folder.join("scenes/bust.ply"), folder.join("head.ply")).unwrap();
    let scene = "unit = \"cm\"\n[[object]]\nname = \"head\"\nfile = \"scenes/bust.ply\"\n";
    std::fs::write(folder.join("scene.toml"), scene).unwrap();
    // Textures of one's own
    for name in ["albedo.png", "freckles.png"] {
        let encoder = png::Encoder::new(std::fs::File::create(folder.join(name)).unwrap(), 2, 1);
        encoder.write_header().unwrap().write_image_data(&[51, 204]).unwrap();
    }
    exr::prelude::write_rgb_file(folder.join("mfp.exr"), 2, 1, |_, _| (1.0_f32, 0.5_f32, 0.25_f32)).unwrap();
    let helped = |words: &str| String::from_utf8(run(folder, words).stdout).unwrap();
    let verbs = helped("--help");
    let verbs = verbs.split("Commands:").nth(1).unwrap().lines().filter_map(|line| line.strip_prefix("  "));
    let verbs = verbs.take_while(|line| !line.starts_with("translucid"));
    let verbs = verbs.filter(|line| !line.starts_with(' ')).filter_map(|line| line.split_whitespace().next());
    let (mut ran, mut left_out) = (HashSet::new(), 0);
    for verb in [""].into_iter().chain(verbs.filter(|verb| *verb != "help")) {
        let help = helped(&format!("{verb} --help"));
        let Some(examples) = help.split("Examples:").nth(1) else { continue };
        // A long one goes on in the next line; a paragraph ends them
        let examples = examples.trim_start().split("\n\n").next().unwrap();
        let examples = examples.split_whitespace().collect::<Vec<_>>().join(" ");
        for words in examples.split("translucid ").map(str::trim).filter(|words| !words.is_empty()) {
            let verb = words.split_whitespace().next().unwrap();
            if LEFT_OUT.iter().any(|part| words.contains(part)) {
                left_out += 1;
            } else if !ran.insert(words.to_owned()) {
                // The command's own help has examples of its verbs
            } else if verb == "view" {
                view(folder, &words.replace("--no-open --port 8080", ""));
            } else {
                let made = run(folder, &quick(&words.replace('*', "000000-000032")));
                assert!(made.status.success(), "{words}: {}", stderr(&made));
            }
        }
    }
    assert!(ran.len() >= 80, "{} ran, {left_out} did not", ran.len());
}

/// A guide shows the file that its commands read.
#[test]
fn files_of_the_guide_of_layers_are_shipped() {
    let page = Page::read(&root().join("docs/guide/layers.md"));
    let blocks: Vec<String> = page.code().iter().map(|block| block.lines.join("\n") + "\n").collect();
    for name in ["paint.toml", "skin.toml", "skin.mci"] {
        let file = std::fs::read_to_string(root().join("examples/layers").join(name)).unwrap();
        assert!(blocks.contains(&file), "{name}");
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
