//! Files that a page brings and takes away.

use std::io::{self, Cursor};
use std::path::Path;

use translucid_image::DisplayTransform;
use translucid_load::{decode_image, warn_of_panorama};
use translucid_render::ImageInfo;
use translucid_scene::{ColorSpace, Image, Place, SceneError};

use crate::shared::{Shared, SideFilm};

/// Most characters of a file's name.
const LONGEST_NAME: usize = 100;

/// A format of pictures.
#[derive(Clone, Copy)]
pub(crate) enum PictureFormat {
    /// OpenEXR with all layers.
    Exr,
    /// PNG as a display shows it.
    Png,
}

impl PictureFormat {
    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Exr => "exr",
            Self::Png => "png",
        }
    }
}

/// The bytes of a side's picture as it is now.
pub(crate) fn encode_picture(shared: &Shared, side: &SideFilm, format: PictureFormat) -> io::Result<Vec<u8>> {
    // A copy, so that the rendering need not wait
    let sums = side.film.sums().clone();
    let info = ImageInfo {
        scene: shared.settings.name.clone(),
        seed: side.view.seed(),
        samples: sums.samples(),
        seconds: side.seconds,
        command: shared.settings.command.clone(),
        place: None,
        denoised: None,
    };
    let mut bytes = Cursor::new(Vec::new());
    match format {
        PictureFormat::Exr => sums.layers_picture(&info).write_exr(&mut bytes)?,
        PictureFormat::Png => {
            let film = shared.studio(|studio| *studio.film());
            let display = DisplayTransform { exposure: film.exposure, tone_mapping: film.tone_mapping };
            sums.display_picture(&info).write_png(&mut bytes, display)?;
        }
    }
    Ok(bytes.into_inner())
}

/// Makes a picture that a page has brought the environment.
///
/// # Errors
/// It is no picture, or one too many.
pub(crate) fn bring_environment(shared: &Shared, name: &str, bytes: &[u8]) -> Result<(), SceneError> {
    let name = file_name(name);
    let place = Place::part(Path::new(""), &name);
    let mut warnings = Vec::new();
    let image = decode_image(&place, bytes, ColorSpace::Srgb, &mut warnings)?;
    warn_of_panorama(&image, &mut warnings);
    let notes = warnings.into_iter().map(|warning| format!("{name}: {}", warning.message)).collect();
    shared.set_image_notes(notes);
    shared.change(|studio| studio.add_environment(Image { name, ..image })).map(drop)
}

/// A file's name without a folder, for people and for the scene that names it: nothing is ever opened by it.
fn file_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or_default();
    let name: String = last.chars().filter(|c| !c.is_control()).take(LONGEST_NAME).collect();
    if name.is_empty() { "environment".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_have_no_folder() {
        assert_eq!(file_name("../../etc/passwd"), "passwd");
        assert_eq!(file_name("C:\\sky.hdr"), "sky.hdr");
        assert_eq!(file_name("a\n\0b.hdr"), "ab.hdr");
        assert_eq!(file_name("/"), "environment");
        assert_eq!(file_name(&"x".repeat(1000)).len(), LONGEST_NAME);
    }
}
