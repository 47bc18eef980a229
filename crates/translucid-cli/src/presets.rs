//! `--preset list`: the materials that a bare mesh can have.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use translucid_scene::presets;

use crate::failure::Failure;

/// Prints all presets with their numbers to stdout.
pub(crate) fn print_presets() -> Result<(), Failure> {
    match io::stdout().lock().write_all(table().as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::work(format!("cannot write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

fn table() -> String {
    let mut text =
        String::from("name             surface albedo A      mean free path [mm]      index  source\n");
    for preset in presets() {
        let (a, l) = (preset.surface_albedo(), preset.mfp_in_millimeters());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<15}  {:.3} {:.3} {:.3}  {:>7.4} {:>7.4} {:>7.4}  {:<5}  {}",
            preset.name, a.x, a.y, a.z, l.x, l.y, l.z, preset.eta, preset.source
        );
    }
    text
}
