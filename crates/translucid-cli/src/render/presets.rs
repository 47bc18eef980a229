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
    let width = presets().iter().map(|preset| preset.name.len()).max().unwrap_or_default();
    let mut text = format!(
        "{:width$}  surface albedo A     mean free path [mm]        index  roughness  coat  source\n",
        "name"
    );
    let mut group = None;
    for preset in presets() {
        // Writing to a string cannot fail.
        if group != Some(preset.group) {
            group = Some(preset.group);
            let _ = writeln!(text, "\n# {}", preset.group.name());
        }
        let numbers = |numbers: [f64; 3], decimals: usize| numbers.map(|x| format!("{x:.decimals$}"));
        let (albedo, mfp) = (numbers(preset.surface_albedo(), 3), numbers(preset.mfp_in_millimeters(), 2));
        let [coat, _] = preset.coat;
        let _ = writeln!(
            text,
            "{:width$}  {}  {:>8} {:>8} {:>8}  {:<5}  {:<9}  {:<4}  {}",
            preset.name,
            albedo.join(" "),
            mfp[0],
            mfp[1],
            mfp[2],
            preset.eta,
            preset.roughness,
            coat,
            preset.source
        );
    }
    text
}
