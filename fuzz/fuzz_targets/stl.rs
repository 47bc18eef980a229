//! Any bytes as a STL file: a mesh or an error, never a panic or a flood of memory.
#![no_main]

use std::path::Path;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = translucid_load::parse_stl(bytes, Path::new("input.stl"), &mut Vec::new());
});
