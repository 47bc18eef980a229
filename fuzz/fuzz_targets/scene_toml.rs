//! Any text as a scene file: read, checked against every rule, and its built-in shapes made.
#![no_main]

use std::path::Path;
use translucid_load::SceneFile;

libfuzzer_sys::fuzz_target!(|text: &str| {
    // The folder does not exist: files that the input names are missing.
    let path = Path::new("no-such-folder/input.toml");
    let _ = SceneFile::parse(text, path);
});
