//! `--preset list`: the materials that a bare mesh can have.

use std::fmt::Write as _;

use translucid_profile::convention::presets;

use crate::failure::Failure;
use crate::table::print;

/// Prints all presets with their numbers to stdout.
pub(crate) fn print_presets() -> Result<(), Failure> {
    print(&table())
}

fn table() -> String {
    let mut text =
        String::from("name             surface albedo A      mean free path [mm]      index  source\n");
    for preset in presets() {
        let ([a, b, c], [l, m, n]) = (preset.surface_albedo(), preset.mfp_in_millimeters());
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<15}  {:.3} {:.3} {:.3}  {:>7.4} {:>7.4} {:>7.4}  {:<5}  {}",
            preset.name, a, b, c, l, m, n, preset.eta, preset.source
        );
    }
    text
}
