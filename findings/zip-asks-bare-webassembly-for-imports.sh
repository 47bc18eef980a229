#!/usr/bin/env bash
# zip, without features, brings wasm-bindgen into a bare WebAssembly module, which then cannot be instantiated alone.
#
# Version: zip 9.4.1 (crates.io; its getrandom 0.4 with the feature "wasm_js"), Rust with the target wasm32-unknown-unknown.
# Expected: a library that reads archives, with default-features = false, adds no import to a module of
#           wasm32-unknown-unknown, which has no host; who encrypts archives asks for random numbers by a feature.
# Seen: with full link-time optimization the module imports __wbindgen_describe and three functions of
#       __wbindgen_externref_xform__, although it is called from plain code and never asks for a random number.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir src
cat > Cargo.toml <<'TOML'
[package]
name = "reader"
version = "0.1.0"
edition = "2024"

[lib]
crate-type = ["cdylib"]

[dependencies]
zip = { version = "=9.4.1", default-features = false }

[profile.release]
lto = "fat"
codegen-units = 1
panic = "abort"
TOML
cat > src/lib.rs <<'RUST'
use std::io::Cursor;

#[unsafe(no_mangle)]
pub extern "C" fn members() -> usize {
    let empty: &[u8] = b"PK\x05\x06\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0";
    zip::ZipArchive::new(Cursor::new(empty)).map_or(usize::MAX, |archive| archive.len())
}
RUST
cargo build --quiet --release --target wasm32-unknown-unknown
cat > imports.mjs <<'JS'
import { readFileSync } from "node:fs";
const module = new WebAssembly.Module(readFileSync("target/wasm32-unknown-unknown/release/reader.wasm"));
for (const { module: from, name } of WebAssembly.Module.imports(module)) console.log(from, name);
JS
node imports.mjs | tee imports.txt
grep -q '^__wbindgen_placeholder__ __wbindgen_describe$' imports.txt
