//! `--preview`: the picture as it grows, in a file.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use translucid_image::{DisplayTransform, OutputError, Picture, PictureChannel, PixelRect};
use translucid_render::LiveFilm;

use super::showing::{Screen, Showing};
use crate::failure::Failure;
use crate::messages;

/// Shows a film in a PNG that is written whole again and again; `place` is the film's in a picture of a size.
///
/// # Errors
/// The thread cannot be started.
pub(super) fn show(
    path: &Path,
    film: Arc<LiveFilm>,
    place: (PixelRect, [u32; 2]),
    display: impl Fn(&Picture<'_>) -> DisplayTransform + Send + Sync + 'static,
) -> Result<Showing, Failure> {
    let (path, display) = (path.to_owned(), Box::new(display));
    let screen = PreviewScreen { path, film, place, display, shown: 0, is_given_up: false, pool: None };
    Showing::start(screen)
        .map_err(|error| Failure::work(format!("--preview: cannot start a thread: {error}")))
}

/// A picture in a file.
struct PreviewScreen {
    path: PathBuf,
    film: Arc<LiveFilm>,
    place: (PixelRect, [u32; 2]),
    /// How the picture so far is made ready for a display.
    display: Box<dyn Fn(&Picture<'_>) -> DisplayTransform + Send + Sync>,
    /// The film's change that was written last.
    shown: u64,
    /// Whether the file cannot be written.
    is_given_up: bool,
    /// This thread as a pool of its own.
    pool: Option<rayon::ThreadPool>,
}

impl Screen for PreviewScreen {
    const NAME: &'static str = "preview";
    const INTERVAL: Duration = Duration::from_secs(2);

    fn begin(&mut self) {
        // What a picture does in parallel it does on this thread: the others render
        self.pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().ok();
    }

    fn show(&mut self, _: &mut dyn FnMut() -> bool) {
        self.write_changes();
    }

    fn finish(&mut self) {
        self.write_changes();
    }
}

impl PreviewScreen {
    fn write_changes(&mut self) {
        let change = self.film.changes();
        if change == self.shown || self.is_given_up {
            return;
        }
        self.shown = change;
        if let Err(error) = self.write() {
            self.is_given_up = true;
            messages::print_warning(&format!("{}; previews stop here", error.located_message()));
        }
    }

    fn write(&self) -> Result<(), OutputError> {
        let (region, whole) = self.place;
        // A row at a time: the rendering waits while the film is read
        let fill = |y: u32, values: &mut [f64]| {
            let sums = self.film.sums();
            for (x, pixel) in (0..).zip(values.chunks_exact_mut(4)) {
                pixel.copy_from_slice(&sums.rgba(x, y - region.top).map(f64::from));
            }
        };
        let channels = ["R", "G", "B", "A"].map(PictureChannel::single);
        let picture = Picture::new([region.width, region.height], channels.to_vec(), fill)
            .within(region, whole)
            .with_metadata(concat!("translucid ", env!("CARGO_PKG_VERSION")), Vec::new());
        picture.save_png(&self.path, (self.display)(&picture))
    }
}
