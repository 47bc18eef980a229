//! The loop over samples and blocks of pixels.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;
use translucid_image::PixelRect;

use super::exact_sums::ExactSums;
use super::film::FilmSums;
use super::live_film::LiveFilm;
use super::pixel_blocks::{BlockGrid, number_in, pixels_of};
use super::prepared::PreparedScene;
use super::sample_ranges::SampleRanges;
use super::view::View;
use crate::path::PathTracer;
use crate::sampling::Sampler;
use crate::world::{BlockPlace, PixelSample};

/// Samples that may wait until all before them are done, in pixels: 84 MB, or one sample of each pixel if that is more.
const MOST_PENDING: u64 = 1 << 20;

/// When a rendering is done.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Numbers of the samples that each pixel shall have in the end.
    pub samples: Range<u32>,
    /// When to stop even if they are not reached.
    pub deadline: Option<Instant>,
}

/// How far a rendering is.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Camera paths done, those of an earlier run included.
    pub samples_done: u64,
    /// Camera paths in all.
    pub samples_total: u64,
}

/// Why a rendering ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every pixel has its samples.
    Finished,
    /// The deadline came first.
    TimeUp,
    /// The caller asked to stop.
    Interrupted,
}

/// A block of pixels in a sample number's grid.
#[derive(Clone, Copy)]
struct BlockSample {
    /// Number of the sample.
    number: u32,
    /// Place of the sample number among those at hand.
    place: usize,
    /// Number of the block in the grid.
    block: usize,
}

impl PreparedScene {
    /// Adds samples of a view to the film until the goal is reached, on the current rayon pool.
    ///
    /// The film has the size of the view's region. It can be read meanwhile. Of an interrupted rendering it has all samples
    /// that were done, and a rendering that goes on from there gives the same bits as one that was not interrupted: the
    /// sums are exact, and who shares light with whom depends on the samples' numbers alone, so nothing depends on the
    /// number of threads, on where the work was interrupted, or on which part of it was done elsewhere.
    ///
    /// `stop` ends the work within the time of a path.
    pub fn render(
        &self,
        view: &View,
        film: &LiveFilm,
        goal: &Goal,
        progress: &(dyn Fn(Progress) + Sync),
        stop: &AtomicBool,
    ) -> Outcome {
        let region = view.region();
        let Goal { samples: Range { start, end }, deadline } = goal.clone();
        let (grid_of_film, mut taken) = {
            let sums = film.sums();
            (sums.grid().clone(), taken(&sums))
        };
        let lacking =
            |taken: &SampleRanges| -> u64 { taken.missing(start..end).map(|gap| gap.len() as u64).sum() };
        let left: u64 =
            (0..).zip(&taken).map(|(tile, taken)| lacking(taken) * grid_of_film.rect(tile).area()).sum();
        let total = region.area() * (start..end).len() as u64;
        let done = AtomicU64::new(total - left);
        let late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
        let first = |taken: &[SampleRanges]| {
            taken.iter().filter_map(|taken| taken.missing(start..end).next()).map(|gap| gap.start).min()
        };
        let tracers = Mutex::new(Vec::new());
        let most = (MOST_PENDING / region.area().max(1)).max(1);
        while let Some(next) = first(&taken) {
            // A first picture comes soon, and later the threads seldom wait for each other.
            let count = most.min(u64::from((next - start) / 2).clamp(1, 16)) as u32;
            let numbers = next..next.saturating_add(count).min(end);
            let grids: Vec<BlockGrid> =
                numbers.clone().map(|number| BlockGrid::new(view.whole_size(), number)).collect();
            let blocks: Vec<BlockSample> = numbers
                .clone()
                .zip(&grids)
                .enumerate()
                .flat_map(|(place, (number, grid))| {
                    grid.blocks_in(region).map(move |block| BlockSample { number, place, block })
                })
                .collect();
            let samples: Vec<Option<Vec<PixelSample>>> = blocks
                .par_iter()
                .map(|&BlockSample { number, place, block }| {
                    let rect = grids[place].rect(block);
                    let wanted = rect.intersection(&region)?;
                    let mut touched = grid_of_film.touching(within(wanted, region));
                    if touched.all(|tile| taken[tile].contains(number))
                        || stop.load(Ordering::Relaxed)
                        || late()
                    {
                        return None;
                    }
                    let tracer = tracers.lock().unwrap_or_else(PoisonError::into_inner).pop();
                    let mut tracer = tracer.unwrap_or_else(|| self.tracer(view.pixel_width()));
                    let samples = self.trace_block(&mut tracer, view, rect, number, stop);
                    tracers.lock().unwrap_or_else(PoisonError::into_inner).push(tracer);
                    let added = wanted.area();
                    let samples_done = (done.fetch_add(added, Ordering::Relaxed) + added).min(total);
                    progress(Progress { samples_done, samples_total: total });
                    samples
                })
                .collect();
            film.change(|sums| {
                let mut done = blocks.iter().zip(samples).peekable();
                for (place, (number, grid)) in numbers.zip(&grids).enumerate() {
                    let mut traced: Vec<Option<Vec<PixelSample>>> = Vec::new();
                    traced.resize_with(grid.len(), || None);
                    while let Some((block, samples)) = done.next_if(|(block, _)| block.place == place) {
                        traced[block.block] = samples;
                    }
                    add_samples(sums, number, region, grid, &traced);
                }
                let before = std::mem::replace(&mut taken, self::taken(sums));
                taken.iter().zip(before).map(|(now, before)| *now != before).collect()
            });
            if stop.load(Ordering::Relaxed) {
                return Outcome::Interrupted;
            }
            if late() && first(&taken).is_some() {
                return Outcome::TimeUp;
            }
        }
        Outcome::Finished
    }

    /// Traces sample `number` of every pixel of a block; `None` when stopped.
    fn trace_block(
        &self,
        tracer: &mut PathTracer<'_>,
        view: &View,
        rect: PixelRect,
        number: u32,
        stop: &AtomicBool,
    ) -> Option<Vec<PixelSample>> {
        let shares = self.world.scene.integrator.subsurface_sharing;
        let mut samples = Vec::with_capacity(rect.area() as usize);
        for (x, y) in pixels_of(rect) {
            if stop.load(Ordering::Relaxed) {
                tracer.drop_block();
                return None;
            }
            let mut sampler = Sampler::new(view.seed(), x, y, number);
            let ray = view.ray(x, y, sampler.next_4d());
            samples.push(if shares {
                let at = [x - rect.left, y - rect.top];
                let place = BlockPlace { number: samples.len(), at, size: [rect.width, rect.height] };
                tracer.trace_in_block(ray, &mut sampler, place)
            } else {
                tracer.trace(ray, &mut sampler)
            });
        }
        tracer.finish_block(&mut samples, stop);
        (!stop.load(Ordering::Relaxed)).then_some(samples)
    }
}

/// The samples that each tile has.
fn taken(film: &FilmSums) -> Vec<SampleRanges> {
    film.tiles.iter().map(|tile| tile.taken.clone()).collect()
}

/// A rectangle of the whole picture as one of a region's film, in which it lies.
fn within(rect: PixelRect, region: PixelRect) -> PixelRect {
    PixelRect { left: rect.left - region.left, top: rect.top - region.top, ..rect }
}

/// Adds sample `number` to the tiles that do not have it, where every block that a tile has a part in was traced.
fn add_samples(
    film: &mut FilmSums,
    number: u32,
    region: PixelRect,
    grid: &BlockGrid,
    blocks: &[Option<Vec<PixelSample>>],
) {
    let rects: Vec<PixelRect> = (0..film.tiles.len()).map(|index| film.tile_rect(index)).collect();
    film.tiles.par_iter_mut().zip(rects).for_each(|(tile, rect)| {
        let rect = PixelRect { left: rect.left + region.left, top: rect.top + region.top, ..rect };
        let (right, bottom) = (rect.left + rect.width - 1, rect.top + rect.height - 1);
        let corners = [rect.left, right].map(|x| [rect.top, bottom].map(|y| grid.block_of(x, y)));
        if tile.taken.contains(number) || corners.iter().flatten().any(|&block| blocks[block].is_none()) {
            return;
        }
        for (pixel, (x, y)) in rect.pixels().enumerate() {
            let block = grid.block_of(x, y);
            if let Some(samples) = &blocks[block] {
                add(&mut tile.sums, pixel, &samples[number_in(grid.rect(block), x, y)]);
            }
        }
        tile.taken.insert(number);
    });
}

/// Adds a sample to a pixel's sums. A sample that is not finite would spoil the pixel for good; it counts
/// as black (and is a defect: debug builds stop).
fn add(sums: &mut ExactSums, pixel: usize, sample: &PixelSample) {
    debug_assert!(sample.radiance().is_finite(), "a sample is not finite: {sample:?}");
    if sample.radiance().is_finite() {
        let mut values = sample.layers().map(f64::from);
        // 0 unless one of them is not finite
        if values.iter().map(|value| value * 0.0).sum::<f64>() != 0.0 {
            values = values.map(|value| if value.is_finite() { value } else { 0.0 });
        }
        sums.add(pixel, &values);
    }
}
