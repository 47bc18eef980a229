//! Pictures of a device against those of the processor.

use translucid_testing as _;
use wgpu::naga;

use super::*;

/// The stride of slots is that of the shaders.
#[test]
fn slots_have_the_size_of_the_shaders() {
    let module = match naga::front::wgsl::parse_str(&SHADERS.concat()) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(&SHADERS.concat())),
    };
    let span = module.types.iter().find_map(|(_, kind)| match (&kind.name, &kind.inner) {
        (Some(name), naga::TypeInner::Struct { span, .. }) if name == "Slot" => Some(*span),
        _ => None,
    });
    assert_eq!(span.map(u64::from), Some(SLOT_BYTES));
}
