//! Remakes every figure and every generated table of the documentation.
//!
//! ```text
//! cargo run --release -p translucid-laboratory --example documents [-- --check | --except-times]
//! ```
//!
//! Tables go between the markers of the pages below `docs` and of the README, figures to `docs/figures`.
//! Nothing is written if a marker is missing or unbalanced.
//! The same source gives the same bytes; times do not, and are left alone with `--except-times`.
//! `--check` writes nothing, and fails if anything but a time would change.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a command says what it does")]

mod blocks;
mod charts;
mod generated;
mod lit_shapes;
mod pages;
mod references;
mod tables;

use std::path::Path;
use std::process::ExitCode;

use generated::{Generated, NOISE_PAGE};
use pages::Documents;
use translucid_laboratory::comparison::{Comparison, Watch};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (is_check, has_times) = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => (false, true),
        ["--except-times"] => (false, false),
        ["--check"] => (true, false),
        _ => {
            eprintln!(
                "error: the arguments are --check or --except-times or none, but these are {arguments:?}"
            );
            return ExitCode::from(2);
        }
    };
    match run(is_check, has_times) {
        Ok(()) => ExitCode::SUCCESS,
        Err(messages) => {
            for message in messages {
                eprintln!("error: {message}");
            }
            ExitCode::FAILURE
        }
    }
}

fn run(is_check: bool, has_times: bool) -> Result<(), Vec<String>> {
    let mut documents = Documents::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))?;
    let comparison = Comparison::new(generated::settings(has_times), Watch::default());
    let comparison = comparison.map_err(|stopped| vec![stopped.to_string()])?;
    let noise_page = documents.page(NOISE_PAGE).map_err(|error| vec![error])?;
    let generated = Generated::new(&comparison, noise_page).map_err(|error| vec![error])?;
    let changed = documents.update(&generated)?;
    if changed.is_empty() {
        println!("everything is as it was");
    } else if is_check {
        let command = "cargo run --release -p translucid-laboratory --example documents -- --except-times";
        let mut messages: Vec<String> =
            changed.iter().map(|change| format!("{} is not what is generated", change.path)).collect();
        messages.push(format!("`{command}` remakes it"));
        return Err(messages);
    }
    for change in &changed {
        change.write().map_err(|error| vec![error])?;
        println!("wrote {}", change.path);
    }
    Ok(())
}
