//! Options by which people and programs follow a rendering.

use std::path::{Path, PathBuf};

use clap::Args;
use translucid_files::check_writable;

use crate::failure::Failure;
use crate::files::input_among;

pub(super) const HELP: &str = "\
--json-progress writes one JSON object per line to stderr and nothing else, except errors in the options themselves. Each
has \"event\":
  progress    unit (samples), done, total, fraction in [0, 1] of the work or of --time, seconds, seconds_left; label with
              several models; twice a second
  message, note, warning, error   text; help and place if there are any
  statistics  the fields of --stats
--stats writes one JSON object at the end:
  version, command, scene, outcome (finished, time-up, interrupted), files
  width, height, threads, objects, triangles
  samples_per_pixel (of the pixel with the fewest), samples (of all pixels), earlier runs included
  samples_now, samples_per_second: of this run
  seconds: loading, preparing, rendering (with denoising), writing; and rendering_before, of earlier runs; cpu_seconds of
  the rendering, peak_memory_bytes
  relative_noise: mean of noise^2 / (x^2 + 0.01), estimated from halves of the samples, rather too high; null with --time or
  --denoise, or if this run did not make both halves
Unknown values are null.";

#[derive(Args, Clone, Debug, Default)]
pub(crate) struct WatchArguments {
    /// Write the picture so far to a file every few seconds
    #[arg(long, value_name = "FILE.png")]
    pub(super) preview: Option<PathBuf>,
    /// Write progress and messages to stderr, one JSON object a line
    #[arg(long, conflicts_with_all = ["quiet", "verbose"])]
    pub(super) json_progress: bool,
    /// Write times, samples, memory and noise to a JSON file at the end
    #[arg(long, value_name = "FILE")]
    pub(super) stats: Option<PathBuf>,
}

impl WatchArguments {
    /// Files that are written besides the picture's.
    fn files(&self) -> impl Iterator<Item = (&'static str, &Path)> {
        let preview = self.preview.as_deref().map(|path| ("--preview", path));
        preview.into_iter().chain(self.stats.as_deref().map(|path| ("--stats", path)))
    }

    /// Finds out before the work whether the files can be written, and refuses those that are others' of this rendering, `taken`.
    pub(super) fn check<'a>(&'a self, taken: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        if let Some(path) = &self.preview
            && path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("png"))
        {
            let message = format!("--preview is {}, but must end in .png", path.display());
            return Err(Failure::input(message));
        }
        let mut taken: Vec<&Path> = taken.collect();
        for (option, path) in self.files() {
            if input_among([path].into_iter(), taken.iter().copied()).is_some() {
                let message = format!("{option} is {}, which is written as well", path.display());
                return Err(Failure::input(message).with_help("name a file of its own"));
            }
            check_writable(path)?;
            taken.push(path);
        }
        Ok(())
    }

    /// Refuses to write over a file that the scene was read from.
    pub(super) fn spare<'a>(&self, inputs: impl Iterator<Item = &'a Path>) -> Result<(), Failure> {
        let inputs: Vec<&Path> = inputs.collect();
        for (option, path) in self.files() {
            if input_among([path].into_iter(), inputs.iter().copied()).is_some() {
                let message = format!("{option} is {}, a file that the scene is read from", path.display());
                return Err(Failure::input(message).with_help("name another file"));
            }
        }
        Ok(())
    }
}
