//! A table of weights whose arrays have changed, with checksums that fit.
#![no_main]

use std::io::{Cursor, Read, Write};
use std::path::Path;
use std::sync::LazyLock;

use translucid_fuzz::edited;
use translucid_reference::walk::{Control, Layout, Parameters, Problem, WhiteTable};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// The arrays of a small table, with their names.
static ARRAYS: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let problem = Problem::new(Parameters { thickness: 0.7, ..Parameters::default() }).unwrap();
    let mut table = WhiteTable::new(problem, Layout::new(&[0.1, 0.3], 2).unwrap(), 0.9).unwrap();
    table.run(1, 500, &Control::default()).unwrap();
    let mut bytes = Vec::new();
    table.write(&mut bytes).unwrap();
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let read = |index| {
        let mut file = archive.by_index(index).unwrap();
        let mut content = Vec::new();
        file.read_to_end(&mut content).unwrap();
        (file.name().unwrap().into_owned(), content)
    };
    (0..count).map(read).collect()
});

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Some((&which, edits)) = bytes.split_first() else { return };
    let which = usize::from(which) % ARRAYS.len();
    let mut out = ZipWriter::new(Cursor::new(Vec::new()));
    for (index, (name, content)) in ARRAYS.iter().enumerate() {
        out.start_file(name, SimpleFileOptions::default()).unwrap();
        let content = if index == which { edited(content, edits) } else { content.clone() };
        out.write_all(&content).unwrap();
    }
    let bytes = out.finish().unwrap().into_inner();
    if let Ok(table) = WhiteTable::read(&bytes[..], Path::new("table.npz")) {
        let mut again = Vec::new();
        table.write(&mut again).unwrap();
        assert!(WhiteTable::read(&again[..], Path::new("again.npz")).is_ok());
    }
});
