//! The files of several pictures and of what tells them apart.

use std::fs;
use std::path::{Path, PathBuf};

use translucid_files::check_writable;
use translucid_scene::SubsurfaceModel;

use super::super::outputs::{Outputs, spare_others_than_checkpoints};
use crate::failure::Failure;
use crate::files::{Directory, input_among, is_own, is_own_page, refusal};

/// The files that are there once.
pub(super) const PAGE: &str = "index.html";
pub(super) const ERRORS: &str = "errors.csv";
pub(super) const SHEET: &str = "sheet.svg";
/// Beginning of the page's title.
pub(super) const TITLE: &str = "Side by side";

/// Files of a model's maps: of ꟻLIP, and of the relative difference.
pub(super) fn map_names(model: &str) -> [String; 2] {
    [format!("{model}-flip.png"), format!("{model}-difference.png")]
}

/// The files of the picture with a model.
pub(super) fn outputs(directory: &Directory, model: &str) -> Outputs {
    Outputs::in_directory(directory.path(), model.as_ref())
}

/// Where the first half of a picture's samples is kept while the work goes on.
pub(super) fn first_half(directory: &Directory, model: &str) -> PathBuf {
    directory.file(&format!("{model}.half.checkpoint"))
}

/// Finds out before the work whether all files can be written, and refuses to write over any that is not one of earlier
/// pictures side by side, or that the scene was read from.
pub(super) fn check<'a>(
    directory: &Directory,
    models: &[SubsurfaceModel],
    inputs: impl Iterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let texts = [PAGE, ERRORS, SHEET].map(|name| directory.file(name));
    let (mut images, mut kept) = (Vec::new(), Vec::new());
    for model in models.iter().map(|model| model.name()) {
        let pictures = outputs(directory, model);
        images.extend(pictures.images().map(Path::to_owned));
        images.extend(map_names(model).map(|name| directory.file(&name)));
        kept.extend([pictures.checkpoint, first_half(directory, model)]);
    }
    images.iter().chain(&texts).chain(&kept).try_for_each(|path| check_writable(path))?;
    let image = images.iter().find(|path| path.exists() && !is_own(path));
    let text = || texts.iter().find(|path| path.exists() && !is_own_page(&texts[0], TITLE));
    if let Some(path) = image.or_else(text) {
        return Err(refusal(path, "exists already, and is not a file of pictures side by side"));
    }
    spare_others_than_checkpoints(kept.iter().map(PathBuf::as_path))?;
    match input_among(images.iter().chain(&texts).map(PathBuf::as_path), inputs) {
        Some(path) => Err(refusal(path, "is a file that the scene is read from, and would be overwritten")),
        None => Ok(()),
    }
}

/// Takes away what was kept of a picture for the case of an interruption.
pub(super) fn remove_checkpoints(directory: &Directory, model: &str) {
    for path in [outputs(directory, model).checkpoint, first_half(directory, model)] {
        // The half is not there where there was a single sample
        let _ = fs::remove_file(path);
    }
}
