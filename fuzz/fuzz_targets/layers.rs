//! Any text as a file of layers.
#![no_main]

libfuzzer_sys::fuzz_target!(|text: &str| {
    let path = std::env::temp_dir().join(format!("translucid-fuzz-{}.toml", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let _ = translucid_desk::load_layers(&path);
});
