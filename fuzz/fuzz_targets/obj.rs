//! Any bytes as an OBJ file: a mesh or an error, never a panic or a flood of memory.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // The folder does not exist: material libraries that the input names are missing.
    let _ = translucid_load::parse_obj(bytes, Path::new("no-such-folder/input.obj"), &mut Vec::new());
});
