//! The documentation is what the example `documents` generates.

use std::path::Path;

#[path = "../../examples/documents/blocks.rs"]
mod blocks;
#[path = "../../examples/documents/charts.rs"]
mod charts;
#[path = "../../examples/documents/generated.rs"]
pub(crate) mod generated;
#[path = "../../examples/documents/lit_shapes.rs"]
mod lit_shapes;
#[path = "../../examples/documents/pages.rs"]
#[allow(dead_code, reason = "the example writes files, this looks at them")]
mod pages;
#[path = "../../examples/documents/references.rs"]
mod references;
#[path = "../../examples/documents/tables.rs"]
mod tables;

use crate::whole::WHOLE;

/// Shows what a change to a model or a number leaves to do.
#[test]
fn documentation_is_what_is_generated() {
    let mut documents = pages::Documents::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")).unwrap();
    let noise_page = documents.page(generated::NOISE_PAGE).unwrap();
    let generated = generated::Generated::new(&WHOLE.0, noise_page).unwrap();
    let changed = documents.update(&generated).unwrap();
    let changed: Vec<&str> = changed.iter().map(|change| change.path.as_str()).collect();
    let command = "cargo run --release -p translucid-laboratory --example documents -- --except-times";
    assert!(changed.is_empty(), "not what is generated: {changed:?}; `{command}` remakes them");
}
