//! Any bytes as an image: the content decides which decoder reads them.
#![no_main]

use std::path::Path;
use translucid_scene::{ColorSpace, Place};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let place = Place::file(Path::new("input"));
    let _ = translucid_load::decode_image(&place, bytes, ColorSpace::Srgb, &mut Vec::new());
});
