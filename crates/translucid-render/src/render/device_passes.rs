//! The loop over samples on a device that traces whole pictures at once.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use translucid_image::PixelRect;

use super::film::TileSums;
use super::live_film::LiveFilm;
use super::passes::{Goal, Outcome, SampleProgress, add};
use super::view::View;
use crate::world::PixelSample;

/// Samples of pixels that are traced at once, at the most: 40 MB.
pub const AT_ONCE: u64 = 1 << 19;

/// A scene on a device that traces its paths.
pub trait PathTracing: Send + Sync {
    /// Traces samples of some numbers of every pixel of a view's region: number by number, row by row. `progress` hears how
    /// many of them are done; `None` when stopped.
    ///
    /// A sample is a function of the view's seed, its pixel and its number.
    ///
    /// # Errors
    /// The device failed; the message says how.
    fn trace(
        &mut self,
        view: &View,
        numbers: Range<u32>,
        progress: &dyn Fn(u64),
        stop: &AtomicBool,
    ) -> Result<Option<Vec<PixelSample>>, String>;
}

/// Adds samples of a view that a device traces to the film until the goal is reached.
///
/// As with [`PreparedScene::render`](super::PreparedScene::render), sums are exact: where the work was interrupted has no part
/// in them.
///
/// # Errors
/// The device failed; samples that were done before are in the film.
pub(crate) fn render_on(
    device: &mut dyn PathTracing,
    view: &View,
    film: &LiveFilm,
    goal: &Goal,
    progress: &(dyn Fn(SampleProgress) + Sync),
    stop: &AtomicBool,
) -> Result<Outcome, String> {
    let region = view.region();
    let samples_total = region.area() * goal.samples.len() as u64;
    let is_late = || goal.deadline.is_some_and(|deadline| Instant::now() >= deadline);
    while let Some(gap) = first_gap(film, &goal.samples) {
        if stop.load(Ordering::Relaxed) {
            return Ok(Outcome::Interrupted);
        }
        if is_late() {
            return Ok(Outcome::TimeUp);
        }
        // A first picture comes soon
        let most = (AT_ONCE / region.area().max(1)).max(1);
        let count = most.min(u64::from((gap.start - goal.samples.start) / 2).max(1)) as u32;
        let numbers = gap.start..gap.end.min(gap.start.saturating_add(count));
        let before = region.area() * u64::from(gap.start - goal.samples.start);
        let report = |done: u64| progress(SampleProgress { samples_done: before + done, samples_total });
        let Some(samples) = device.trace(view, numbers.clone(), &report, stop)? else {
            return Ok(Outcome::Interrupted);
        };
        add_samples(film, region, numbers, &samples);
    }
    Ok(Outcome::Finished)
}

/// The first numbers that some tile lacks.
fn first_gap(film: &LiveFilm, wanted: &Range<u32>) -> Option<Range<u32>> {
    let sums = film.sums();
    let first = |tile: &TileSums| tile.taken.missing(wanted.clone()).next();
    sums.tiles.iter().filter_map(first).min_by_key(|gap| (gap.start, gap.end))
}

/// Adds samples of all pixels of a region that were traced elsewhere, number by number and row by row, to the tiles that lack
/// them.
pub fn add_samples(film: &LiveFilm, region: PixelRect, numbers: Range<u32>, samples: &[PixelSample]) {
    film.change(|sums| {
        let rects: Vec<PixelRect> = (0..sums.tiles.len()).map(|index| sums.tile_rect(index)).collect();
        let of_tile = |(tile, rect): (&mut TileSums, PixelRect)| {
            let mut is_changed = false;
            for (number, picture) in numbers.clone().zip(samples.chunks(region.area() as usize)) {
                if tile.taken.contains(number) {
                    continue;
                }
                for (pixel, (x, y)) in rect.pixels().enumerate() {
                    add(&mut tile.sums, pixel, &picture[(y * region.width + x) as usize]);
                }
                tile.taken.insert(number);
                is_changed = true;
            }
            is_changed
        };
        sums.tiles.par_iter_mut().zip(rects).map(of_tile).collect()
    });
}
