//! `translucid models`: the models, a line each.

use std::fmt::Write as _;

use translucid_scene::SubsurfaceModel;

use crate::failure::Failure;
use crate::table::print;

/// Prints the names of all models, and what each is.
pub(crate) fn run() -> Result<(), Failure> {
    let mut text = String::new();
    for model in SubsurfaceModel::ALL {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{:<29} {}", model.name(), model.description());
    }
    print(&text)
}
