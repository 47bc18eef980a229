//! The layout that Rust and the shaders share.

use translucid_render::device::shader_constants;
use wgpu::naga;

use super::*;

/// The stride of slots is that of the shaders.
#[test]
fn slots_have_the_size_of_the_shaders() {
    let text = text();
    let module = match naga::front::wgsl::parse_str(&text) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(&text)),
    };
    let span = module.types.iter().find_map(|(_, kind)| match (&kind.name, &kind.inner) {
        (Some(name), naga::TypeInner::Struct { span, .. }) if name == "Slot" => Some(*span),
        _ => None,
    });
    assert_eq!(span.map(u64::from), Some(SLOT_BYTES));
}

/// The shaders read all that they are given: a new field of a material has to be used there, or has no words.
#[test]
fn constants_are_read() {
    let text = text();
    let words: Vec<&str> = text.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    for (name, _) in shader_constants() {
        assert!(words.iter().filter(|word| **word == name).count() > 1, "{name}");
    }
}
