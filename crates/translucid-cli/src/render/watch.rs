//! Options by which people and programs follow a rendering.

use std::path::{Path, PathBuf};

use clap::Args;
use translucid_files::check_writable;

use crate::failure::Failure;
use crate::files::input_among;

pub(super) const HELP: &str = "\
--json-progress writes one JSON object a line to stderr and nothing else, but for mistakes in the options themselves. Each
has \"event\":
  progress    unit (samples), done, total, fraction in [0, 1] of the work or of --time, seconds, seconds_left, and label
              where there are several models; twice a second
  message, note, warning, error   text, and help and place where there are any
  statistics  as --stats
--stats writes one JSON object at the end:
  version, command, scene, outcome (finished, time-up, interrupted), files
  width, height, threads, objects, triangles
  samples_per_pixel, samples: fewest of any pixel and all, earlier runs included; samples_now, samples_per_second: of this
  seconds: loading, preparing, rendering (with denoising), writing; and rendering_before, of earlier runs; cpu_seconds of
  the rendering, peak_memory_bytes
  relative_noise: the mean square of the noise over (x^2 + 0.01), estimated from halves of the samples, rather too high;
  null where the samples of --spp or the scene were not reached, were begun by another run, or are denoised
What is not known is null.";

#[derive(Args, Clone, Debug, Default)]
pub(crate) struct WatchArguments {
    /// Keep the picture so far in a file, whole every few seconds
    #[arg(long, value_name = "FILE.png")]
    pub(super) preview: Option<PathBuf>,
    /// Write progress and messages to stderr as JSON, an object a line
    #[arg(long, conflicts_with_all = ["quiet", "verbose"])]
    pub(super) json_progress: bool,
    /// Write times, samples, memory and noise as JSON at the end
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
