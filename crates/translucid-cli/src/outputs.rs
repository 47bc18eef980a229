//! The files of a rendering.

use std::ffi::OsStr;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use translucid_image::{Denoised, DisplayTransform, OutputError, check_writable};
use translucid_render::{FilmSums, ImageInfo};
use translucid_scene::Film;

use crate::failure::Failure;

/// The files that a rendering writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outputs {
    /// Float image, if any.
    pub(crate) exr: Option<PathBuf>,
    /// Display image.
    pub(crate) png: PathBuf,
    /// Where an unfinished rendering is kept.
    pub(crate) checkpoint: PathBuf,
}

impl Outputs {
    /// `FILE.exr` means that file and a PNG beside it, `FILE.png` only that.
    pub(crate) fn from_option(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let exr = match extension.as_str() {
            "exr" => Some(path.to_owned()),
            "png" => None,
            _ => {
                let message = format!("--output is {}, but must end in .exr or .png", path.display());
                return Err(Failure::input(message)
                    .with_help("FILE.exr writes that and a PNG beside it, FILE.png only that"));
            }
        };
        let png = if exr.is_some() { path.with_extension("png") } else { path.to_owned() };
        let mut checkpoint = path.as_os_str().to_owned();
        checkpoint.push(".checkpoint");
        Ok(Self { exr, png, checkpoint: checkpoint.into() })
    }

    /// Both images in the current directory.
    pub(crate) fn from_stem(stem: &OsStr) -> Self {
        let file = |end: &str| {
            let mut name = stem.to_owned();
            name.push(end);
            PathBuf::from(name)
        };
        Self { exr: Some(file(".exr")), png: file(".png"), checkpoint: file(".exr.checkpoint") }
    }

    /// Both images in a directory.
    pub(crate) fn in_directory(directory: &Path, stem: &str) -> Self {
        let file = |end: &str| directory.join(format!("{stem}{end}"));
        Self { exr: Some(file(".exr")), png: file(".png"), checkpoint: file(".exr.checkpoint") }
    }

    /// The image files.
    pub(crate) fn images(&self) -> impl Iterator<Item = &Path> {
        self.exr.iter().map(PathBuf::as_path).chain([self.png.as_path()])
    }

    /// Finds out before the work whether its result can be written.
    pub(crate) fn check(&self) -> Result<(), OutputError> {
        self.images().chain([self.checkpoint.as_path()]).try_for_each(check_writable)
    }

    /// Refuses to write over a file that the scene was read from, whatever paths both go by.
    pub(crate) fn spare<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), OutputError> {
        match input_among(self.images().chain([self.checkpoint.as_path()]), inputs) {
            Some(path) => {
                let message = "is a file that the scene is read from, and would be written over";
                Err(OutputError::new(path, message).with_help("name another picture with -o FILE"))
            }
            None => Ok(()),
        }
    }

    /// Refuses to write over pictures that are not this program's own: for names that nobody asked for,
    /// which may be those of a texture beside a mesh.
    pub(crate) fn spare_others(&self) -> Result<(), OutputError> {
        match self.images().find(|path| path.exists() && !is_own(path)) {
            Some(path) => {
                let message = "is there already, and translucid has not made it";
                Err(OutputError::new(path, message).with_help("name the picture with -o FILE"))
            }
            None => Ok(()),
        }
    }

    /// Writes the images.
    pub(crate) fn write(
        &self,
        film: &FilmSums,
        settings: &Film,
        info: &ImageInfo,
    ) -> Result<(), OutputError> {
        if let Some(exr) = &self.exr {
            film.layers_picture(info).save_exr(exr)?;
        }
        film.display_picture(info).save_png(&self.png, display_of(settings))
    }

    /// Writes the images with a denoised picture: beside the layers in the float image, in place of the display image.
    pub(crate) fn write_denoised(
        &self,
        film: &FilmSums,
        denoised: &Denoised,
        settings: &Film,
        info: &ImageInfo,
    ) -> Result<(), OutputError> {
        if let Some(exr) = &self.exr {
            film.layers_picture_with(denoised, info).save_exr(exr)?;
        }
        film.denoised_display_picture(denoised, info).save_png(&self.png, display_of(settings))
    }
}

/// The way to a display that a scene's film asks for.
fn display_of(film: &Film) -> DisplayTransform {
    DisplayTransform { exposure: film.exposure, tone_mapping: film.tone_mapping }
}

/// The first of some files that is one of the inputs, whatever paths both go by, or will be when both are there.
pub(crate) fn input_among<'a, 'b>(
    mut files: impl Iterator<Item = &'b Path>,
    inputs: impl Iterator<Item = &'a Path>,
) -> Option<&'b Path> {
    let inputs: Vec<PathBuf> = inputs.filter_map(place).collect();
    files.find(|path| place(path).is_some_and(|path| inputs.contains(&path)))
}

/// Where a file is, or would be, in a directory that is there.
fn place(path: &Path) -> Option<PathBuf> {
    let of_a_new_file = || {
        let directory =
            path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(fs::canonicalize(directory).ok()?.join(path.file_name()?))
    };
    fs::canonicalize(path).ok().or_else(of_a_new_file)
}

/// Whether a file says at its start, where images keep their notes, that this program has made it.
pub(crate) fn is_own(path: &Path) -> bool {
    const NAME: &[u8] = b"translucid";
    let mut start = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(1 << 16).read_to_end(&mut start));
    read.is_ok() && start.windows(NAME.len()).any(|bytes| bytes == NAME)
}

/// Whether a page says that this program has made it, with a title that begins so.
pub(crate) fn is_own_page(page: &Path, title: &str) -> bool {
    const GENERATOR: &str = "name=\"generator\" content=\"translucid\"";
    const START: u64 = 4096;
    let mut start = Vec::new();
    let read = fs::File::open(page).and_then(|file| file.take(START).read_to_end(&mut start));
    let start = String::from_utf8_lossy(&start);
    read.is_ok() && start.contains(GENERATOR) && start.contains(&format!("<title>{title}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_follow_the_extension() {
        let both = Outputs::from_option(Path::new("out/a.b.EXR")).unwrap();
        assert_eq!(both.exr.as_deref(), Some(Path::new("out/a.b.EXR")));
        assert_eq!(both.png, Path::new("out/a.b.png"));
        assert_eq!(both.checkpoint, Path::new("out/a.b.EXR.checkpoint"));
        let one = Outputs::from_option(Path::new("a.png")).unwrap();
        assert_eq!((one.exr, one.png), (None, PathBuf::from("a.png")));
        for odd in ["a", "a.jpg", "", ".exr/", "exr"] {
            assert!(Outputs::from_option(Path::new(odd)).is_err() || odd == ".exr/", "{odd}");
        }
    }

    #[test]
    fn outputs_of_a_stem_keep_its_dots() {
        let outputs = Outputs::from_stem(OsStr::new("head.v2"));
        assert_eq!(
            outputs.images().collect::<Vec<_>>(),
            [Path::new("head.v2.exr"), Path::new("head.v2.png")]
        );
    }
}
