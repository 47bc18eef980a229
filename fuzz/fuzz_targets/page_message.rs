//! Any lines as messages of a page: each is answered, and the scene that they leave can be saved.
#![no_main]

libfuzzer_sys::fuzz_target!(|lines: &str| {
    translucid_view::hear_while_fuzzing(lines);
});
