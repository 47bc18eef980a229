//! Any bytes as a glTF file, text or binary.
#![no_main]

use std::path::Path;
use translucid_scene::Unit;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    // The folder does not exist: files that the input names are missing.
    let path = Path::new("no-such-folder/input.glb");
    let _ = translucid_load::parse_gltf(bytes, path, Unit::Meter, &mut Vec::new());
});
