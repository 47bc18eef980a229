//! The files of a rendering.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use translucid_files::check_writable;
use translucid_image::{DisplayTransform, OutputError, Picture};
use translucid_render::{FilmSums, ImageInfo, is_shard};

use crate::failure::Failure;
use crate::files::{input_among, is_own};
use crate::output_lock::OutputLock;

/// The files that a rendering writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Outputs {
    /// Float image, if any.
    pub(crate) exr: Option<PathBuf>,
    /// Display image; none where the result is a shard.
    pub(crate) png: Option<PathBuf>,
    /// Where an unfinished rendering is kept; the shard that is the result.
    pub(crate) checkpoint: PathBuf,
}

impl Outputs {
    /// `FILE.exr` means that file and a PNG beside it, `FILE.png` only that, `FILE.shard` the samples in place of a picture.
    pub(crate) fn from_option(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let exr = match extension.as_str() {
            "exr" => Some(path.to_owned()),
            "png" => None,
            "shard" => return Ok(Self { exr: None, png: None, checkpoint: path.to_owned() }),
            _ => {
                let message = format!("--output is {}, but must end in .exr, .png or .shard", path.display());
                return Err(Failure::input(message).with_help(
                    "FILE.exr writes that and a PNG beside it, FILE.png only that, FILE.shard samples to be merged",
                ));
            }
        };
        let png = if exr.is_some() { path.with_extension("png") } else { path.to_owned() };
        let mut checkpoint = path.as_os_str().to_owned();
        checkpoint.push(".checkpoint");
        Ok(Self { exr, png: Some(png), checkpoint: checkpoint.into() })
    }

    /// Both images in a directory.
    pub(crate) fn in_directory(directory: &Path, stem: &OsStr) -> Self {
        let file = |end: &str| {
            let mut name = stem.to_owned();
            name.push(end);
            directory.join(name)
        };
        Self { exr: Some(file(".exr")), png: Some(file(".png")), checkpoint: file(".exr.checkpoint") }
    }

    /// The image files.
    pub(crate) fn images(&self) -> impl Iterator<Item = &Path> {
        self.exr.iter().chain(&self.png).map(PathBuf::as_path)
    }

    /// Whether the result is a shard.
    pub(crate) fn is_shard(&self) -> bool {
        self.png.is_none()
    }

    /// The file that stands for all.
    pub(crate) fn main(&self) -> &Path {
        self.images().next().unwrap_or(&self.checkpoint)
    }

    /// All files.
    pub(crate) fn files(&self) -> impl Iterator<Item = &Path> {
        self.images().chain([self.checkpoint.as_path()])
    }

    /// Finds out before the work whether its result can be written, and refuses to write over what is no checkpoint
    /// where one may come to be: nobody has named that file.
    pub(crate) fn check(&self) -> Result<(), OutputError> {
        self.files().try_for_each(check_writable)?;
        spare_others_than_checkpoints([self.checkpoint.as_path()])
    }

    /// Keeps other processes off the files until it is dropped: all pictures have a PNG.
    pub(crate) fn lock(&self) -> Result<OutputLock, Failure> {
        OutputLock::take(self.png.as_ref().unwrap_or(&self.checkpoint))
    }

    /// Refuses to write over a file that the scene was read from, whatever paths both go by.
    pub(crate) fn spare<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), OutputError> {
        match input_among(self.files(), inputs) {
            Some(path) => {
                let message = "is a file that the scene is read from, and would be overwritten";
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
                let message = "exists already, and was not made by translucid";
                Err(OutputError::new(path, message).with_help("name the picture with -o FILE"))
            }
            None => Ok(()),
        }
    }

    /// Writes the images: the layers with a denoised picture beside them, and for a display that in their place.
    ///
    /// The display is that of the PNG.
    pub(crate) fn write(
        &self,
        film: &FilmSums,
        display: impl FnOnce(&Picture<'_>) -> DisplayTransform,
        info: &ImageInfo,
    ) -> Result<(), Failure> {
        let exr = self.exr.as_deref().map_or(Ok(()), |exr| film.layers_picture(info).save_exr(exr));
        // A disk that has no room for the first may have it for the second
        let png = self.png.as_deref().map_or(Ok(()), |png| {
            let picture = film.display_picture(info);
            picture.save_png(png, display(&picture))
        });
        exr.and(png).map_err(Failure::late)
    }

    /// Numbers the files: NAME-001.exr.
    pub(crate) fn numbered(&self, number: u32) -> Result<Self, Failure> {
        let path = self.main();
        let mut name = path.file_stem().unwrap_or_default().to_owned();
        let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
        name.push(format!("-{number:03}.{extension}"));
        Self::from_option(&path.with_file_name(name))
    }
}

/// Refuses files that are there and are no checkpoints.
pub(crate) fn spare_others_than_checkpoints<'a>(
    paths: impl IntoIterator<Item = &'a Path>,
) -> Result<(), OutputError> {
    match paths.into_iter().find(|path| path.exists() && !is_shard(path)) {
        Some(path) => {
            let message = "exists already, and is not a checkpoint or shard of translucid";
            Err(OutputError::new(path, message)
                .with_help("move it away, or name another picture with -o FILE"))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_follow_the_extension() {
        let both = Outputs::from_option(Path::new("out/a.b.EXR")).unwrap();
        assert_eq!(both.exr.as_deref(), Some(Path::new("out/a.b.EXR")));
        assert_eq!(both.png.as_deref(), Some(Path::new("out/a.b.png")));
        assert_eq!(both.checkpoint, Path::new("out/a.b.EXR.checkpoint"));
        let one = Outputs::from_option(Path::new("a.png")).unwrap();
        assert_eq!((one.exr, one.png), (None, Some(PathBuf::from("a.png"))));
        let shard = Outputs::from_option(Path::new("a.shard")).unwrap();
        assert_eq!((shard.images().count(), shard.main()), (0, Path::new("a.shard")));
        let third = both.numbered(3).unwrap();
        assert_eq!(third.exr.as_deref(), Some(Path::new("out/a.b-003.EXR")));
        assert_eq!(third.png.as_deref(), Some(Path::new("out/a.b-003.png")));
        for odd in ["a", "a.jpg", "", ".exr/", "exr"] {
            assert!(Outputs::from_option(Path::new(odd)).is_err() || odd == ".exr/", "{odd}");
        }
    }

    #[test]
    fn outputs_of_a_stem_keep_its_dots() {
        let outputs = Outputs::in_directory(Path::new(""), OsStr::new("head.v2"));
        assert_eq!(
            outputs.images().collect::<Vec<_>>(),
            [Path::new("head.v2.exr"), Path::new("head.v2.png")]
        );
    }
}
