//! The directory that several pictures and what tells them apart are written to.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use translucid_image::{OutputError, check_writable, write_atomically};
use translucid_scene::SubsurfaceModel;

use super::report::{ERRORS, PAGE, SHEET, TITLE, map_names};
use crate::failure::Failure;
use crate::outputs::{Outputs, input_among, is_own, is_own_page};

/// A file's name and content.
pub(super) type File = (String, Vec<u8>);

/// A directory to write to.
pub(super) struct Directory {
    path: PathBuf,
    /// Whether it was made for this.
    is_new: bool,
    /// Every image that will be written there, then the page and the table.
    images: Vec<PathBuf>,
    texts: [PathBuf; 2],
}

impl Directory {
    /// Makes the directory and finds out whether all files can be written there, before the work.
    pub(super) fn prepare(path: &Path, models: &[SubsurfaceModel]) -> Result<Self, Failure> {
        let is_new = !path.exists();
        fs::create_dir_all(path).map_err(|error| {
            let message = format!("cannot make the directory: {error}");
            OutputError::new(path, message).with_help("name another directory with -o DIR")
        })?;
        let mut directory = Self {
            path: path.to_owned(),
            is_new,
            images: Vec::new(),
            texts: [PAGE, ERRORS].map(|name| path.join(name)),
        };
        for model in models {
            let pictures = directory.outputs(*model);
            directory.images.extend(pictures.images().map(Path::to_owned));
            directory.images.extend(map_names(model.name()).map(|name| path.join(name)));
        }
        directory.images.push(path.join(SHEET));
        directory.check(models).inspect_err(|_| directory.abandon())?;
        Ok(directory)
    }

    fn check(&self, models: &[SubsurfaceModel]) -> Result<(), Failure> {
        self.images.iter().chain(&self.texts).try_for_each(|path| check_writable(path))?;
        for model in models {
            check_writable(&self.outputs(*model).checkpoint)?;
            check_writable(&self.first_half(*model))?;
        }
        self.spare_others()
    }

    /// Refuses to write over files that are not those of earlier pictures side by side.
    fn spare_others(&self) -> Result<(), Failure> {
        let image = self.images.iter().find(|path| path.exists() && !is_own(path));
        let text = || self.texts.iter().find(|path| path.exists() && !is_own_page(&self.texts[0], TITLE));
        match image.or_else(text) {
            Some(path) => {
                let error =
                    OutputError::new(path, "is there already, and is not a file of pictures side by side");
                Err(error.with_help("name another directory with -o DIR").into())
            }
            None => Ok(()),
        }
    }

    /// Refuses to write over a file that the scene was read from.
    pub(super) fn spare<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        match input_among(self.images.iter().chain(&self.texts).map(PathBuf::as_path), inputs) {
            Some(path) => {
                let message = "is a file that the scene is read from, and would be written over";
                Err(OutputError::new(path, message).with_help("name another directory with -o DIR").into())
            }
            None => Ok(()),
        }
    }

    /// The files of the picture with a model.
    pub(super) fn outputs(&self, model: SubsurfaceModel) -> Outputs {
        Outputs::in_directory(&self.path, model.name())
    }

    /// Where the first half of a picture's samples is kept while the work goes on.
    pub(super) fn first_half(&self, model: SubsurfaceModel) -> PathBuf {
        self.half_of(model.name())
    }

    fn half_of(&self, model: &str) -> PathBuf {
        self.path.join(format!("{model}.half.checkpoint"))
    }

    /// Takes away what was kept of a picture for the case of an interruption.
    pub(super) fn remove_checkpoints(&self, model: &str) {
        for path in [Outputs::in_directory(&self.path, model).checkpoint, self.half_of(model)] {
            // The half is not there where there was a single sample
            let _ = fs::remove_file(path);
        }
    }

    /// Takes a directory away that was made for nothing.
    pub(super) fn abandon(&self) {
        if self.is_new {
            // Fails, as it should, where there are pictures already
            let _ = fs::remove_dir(&self.path);
        }
    }

    /// Writes files, the page first: it says whose the others are.
    pub(super) fn write(&self, files: &[File]) -> Result<(), Failure> {
        for (name, content) in files {
            write_atomically(&self.path.join(name), |out| out.write_all(content)).map_err(Failure::late)?;
        }
        Ok(())
    }

    /// The directory.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// The file that shows the others.
    pub(super) fn page(&self) -> PathBuf {
        self.path.join(PAGE)
    }
}
