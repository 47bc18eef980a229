//! Any bytes as a MaterialX document: what is accepted is a valid material.
#![no_main]

use std::path::Path;

use translucid_load::parse_materialx;
use translucid_scene::Unit;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let (path, unit) = (Path::new("input.mtlx"), Unit::Millimeter);
    let Ok((material, images)) = parse_materialx(bytes, path, None, unit, &mut Vec::new()) else { return };
    material.validate(images.len(), 0).expect("what is accepted is valid");
});
