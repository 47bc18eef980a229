//! Finds out whether the meshes that some tests need are there.

use std::path::Path;

fn main() {
    println!("cargo::rustc-check-cfg=cfg(shared_assets)");
    println!("cargo::rerun-if-changed=build.rs");
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/assets");
    if assets.is_dir() {
        println!("cargo::rustc-cfg=shared_assets");
        println!("cargo::rerun-if-changed={}", assets.display());
    }
}
