//! The loop over samples and blocks of pixels.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::prelude::*;
use translucid_image::PixelRect;

use super::exact_sums::ExactSums;
use super::film::FilmSums;
use super::live_film::{BlockSamples, LiveFilm};
use super::pixel_blocks::{BlockGrid, number_in, pixels_of};
use super::prepared::PreparedScene;
use super::sample_ranges::SampleRanges;
use super::tile_grid::TileGrid;
use super::traced_block::TracedBlock;
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
pub struct SampleProgress {
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

impl PreparedScene {
    /// Adds samples of a view to the film until the goal is reached, on the current rayon pool.
    ///
    /// The film has the size of the view's region, and can be read meanwhile. An interrupted rendering leaves all samples
    /// in it that were done; a film is of one scene and one view, so the next rendering may use them. One that goes on from
    /// there gives the same bits as one that was not interrupted: the sums are exact, and the samples' numbers alone decide
    /// which pixels share light. So nothing depends on the number of threads, on where the work was interrupted, or on which
    /// part of it was done elsewhere.
    ///
    /// `stop` ends the work within the time of a path.
    pub fn render(
        &self,
        view: &View,
        film: &LiveFilm,
        goal: &Goal,
        progress: &(dyn Fn(SampleProgress) + Sync),
        stop: &AtomicBool,
    ) -> Outcome {
        let (tiles, mut taken) = {
            let sums = film.sums();
            (sums.grid().clone(), taken(&sums))
        };
        let rendering = Rendering::new(self, (view, goal), (tiles, &taken), progress, stop);
        while let Some(batch) = rendering.next_batch(&taken) {
            let traced = rendering.trace(&batch, &taken, film.waiting());
            film.change(|sums| {
                batch.add_to(sums, view.region(), &traced);
                let before = std::mem::replace(&mut taken, self::taken(sums));
                taken.iter().zip(before).map(|(now, before)| *now != before).collect()
            });
            rendering.keep(&batch, traced, &taken, film.waiting());
            if stop.load(Ordering::Relaxed) {
                return Outcome::Interrupted;
            }
            if rendering.is_late() && rendering.first_lacking(&taken).is_some() {
                return Outcome::TimeUp;
            }
        }
        Outcome::Finished
    }

    /// Traces some of the blocks of a sample of a view, in their order, for a film that is [given](LiveFilm::give) them.
    pub fn trace_blocks(&self, view: &View, number: u32, range: Range<usize>) -> Vec<TracedBlock> {
        let grid = BlockGrid::new(view.whole_size(), number);
        let mut tracer = self.tracer(view.pixel_width());
        let stop = AtomicBool::new(false);
        let blocks = grid.blocks_in(view.region()).skip(range.start).take(range.len());
        let trace = |block| {
            let samples = trace_block(self, view, &stop, &mut tracer, (grid.rect(block), number))?;
            Some(TracedBlock { number, block, samples })
        };
        blocks.filter_map(trace).collect()
    }
}

impl View {
    /// Number of blocks that a sample of this view has.
    pub fn block_count(&self, number: u32) -> usize {
        BlockGrid::new(self.whole_size(), number).blocks_in(self.region()).count()
    }
}

/// A rendering under way, shared by all threads.
struct Rendering<'a> {
    prepared: &'a PreparedScene,
    view: &'a View,
    goal: &'a Goal,
    /// The film's tiles.
    tiles: TileGrid,
    /// Camera paths done so far, and in all.
    done: AtomicU64,
    total: u64,
    /// Tracers that no thread uses at present.
    tracers: Mutex<Vec<PathTracer<'a>>>,
    progress: &'a (dyn Fn(SampleProgress) + Sync),
    stop: &'a AtomicBool,
}

impl<'a> Rendering<'a> {
    fn new(
        prepared: &'a PreparedScene,
        (view, goal): (&'a View, &'a Goal),
        (tiles, taken): (TileGrid, &[SampleRanges]),
        progress: &'a (dyn Fn(SampleProgress) + Sync),
        stop: &'a AtomicBool,
    ) -> Self {
        let lacking = |taken: &SampleRanges| -> u64 {
            taken.missing(goal.samples.clone()).map(|gap| gap.len() as u64).sum()
        };
        let left: u64 = (0..).zip(taken).map(|(tile, taken)| lacking(taken) * tiles.rect(tile).area()).sum();
        let total = view.region().area() * goal.samples.len() as u64;
        let tracers = Mutex::new(Vec::new());
        Self {
            prepared,
            view,
            goal,
            tiles,
            done: AtomicU64::new(total - left),
            total,
            tracers,
            progress,
            stop,
        }
    }

    fn is_late(&self) -> bool {
        self.goal.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// The first sample of the goal that some tile lacks.
    fn first_lacking(&self, taken: &[SampleRanges]) -> Option<u32> {
        let first = |taken: &SampleRanges| taken.missing(self.goal.samples.clone()).next();
        taken.iter().filter_map(first).map(|gap| gap.start).min()
    }

    /// The samples to trace next; `None` at the goal.
    fn next_batch(&self, taken: &[SampleRanges]) -> Option<Batch> {
        let Range { start, end } = self.goal.samples;
        let next = self.first_lacking(taken)?;
        // A first picture comes soon, and later the threads seldom wait for each other.
        let most = (MOST_PENDING / self.view.region().area().max(1)).max(1);
        let count = most.min(u64::from((next - start) / 2).clamp(1, 16)) as u32;
        Some(Batch::new(self.view, next..next.saturating_add(count).min(end)))
    }

    /// Traces the blocks of a batch that do not wait already; `None` for those that all tiles have, or that come too late.
    fn trace(
        &self,
        batch: &Batch,
        taken: &[SampleRanges],
        waiting: &Mutex<BlockSamples>,
    ) -> Vec<Option<Vec<PixelSample>>> {
        let trace = |block: &BlockSample| {
            let traced =
                waiting.lock().unwrap_or_else(PoisonError::into_inner).remove(&(block.number, block.block));
            traced.or_else(|| self.trace_if_lacking(block, batch.rect(block), taken))
        };
        batch.blocks.par_iter().map(trace).collect()
    }

    /// Keeps traced blocks of which tiles lack others, and none that they do not lack.
    fn keep(
        &self,
        batch: &Batch,
        traced: Vec<Option<Vec<PixelSample>>>,
        taken: &[SampleRanges],
        waiting: &Mutex<BlockSamples>,
    ) {
        let mut waiting = waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let traced = batch.blocks.iter().zip(traced);
        waiting.extend(traced.filter_map(|(block, samples)| Some(((block.number, block.block), samples?))));
        waiting.retain(|&(number, block), _| {
            let rect = BlockGrid::new(self.view.whole_size(), number).rect(block);
            self.is_lacking(number, rect, taken)
        });
    }

    /// Whether a block has a part in a tile that lacks its sample.
    fn is_lacking(&self, number: u32, rect: PixelRect, taken: &[SampleRanges]) -> bool {
        let region = self.view.region();
        rect.intersection(&region).is_some_and(|wanted| {
            self.tiles.touching(within(wanted, region)).any(|tile| !taken[tile].contains(number))
        })
    }

    fn trace_if_lacking(
        &self,
        block: &BlockSample,
        rect: PixelRect,
        taken: &[SampleRanges],
    ) -> Option<Vec<PixelSample>> {
        if self.stop.load(Ordering::Relaxed) || self.is_late() || !self.is_lacking(block.number, rect, taken)
        {
            return None;
        }
        let tracer = self.tracers.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut tracer = tracer.unwrap_or_else(|| self.prepared.tracer(self.view.pixel_width()));
        let samples = trace_block(self.prepared, self.view, self.stop, &mut tracer, (rect, block.number));
        self.tracers.lock().unwrap_or_else(PoisonError::into_inner).push(tracer);
        let added = rect.intersection(&self.view.region()).map_or(0, |wanted| wanted.area());
        let samples_done = (self.done.fetch_add(added, Ordering::Relaxed) + added).min(self.total);
        (self.progress)(SampleProgress { samples_done, samples_total: self.total });
        samples
    }
}

/// Traces sample `number` of every pixel of a block; `None` when stopped.
fn trace_block(
    prepared: &PreparedScene,
    view: &View,
    stop: &AtomicBool,
    tracer: &mut PathTracer<'_>,
    (rect, number): (PixelRect, u32),
) -> Option<Vec<PixelSample>> {
    let shares = prepared.world.scene.integrator.subsurface_sharing;
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

/// Samples that wait for each other: their numbers, and the blocks of pixels of each number.
struct Batch {
    numbers: Range<u32>,
    /// For each number.
    grids: Vec<BlockGrid>,
    /// The blocks that the view's region has a part in, number by number.
    blocks: Vec<BlockSample>,
}

/// A block of pixels in a sample number's grid.
#[derive(Clone, Copy)]
struct BlockSample {
    /// Number of the sample.
    number: u32,
    /// Place of the sample number in the batch.
    place: usize,
    /// Number of the block in the grid.
    block: usize,
}

impl Batch {
    fn new(view: &View, numbers: Range<u32>) -> Self {
        let region = view.region();
        let grids: Vec<BlockGrid> =
            numbers.clone().map(|number| BlockGrid::new(view.whole_size(), number)).collect();
        let of_number = |(place, (number, grid)): (usize, (u32, &BlockGrid))| {
            grid.blocks_in(region).map(move |block| BlockSample { number, place, block }).collect::<Vec<_>>()
        };
        let blocks = numbers.clone().zip(&grids).enumerate().flat_map(of_number).collect();
        Self { numbers, grids, blocks }
    }

    /// Pixels of a block of the batch.
    fn rect(&self, block: &BlockSample) -> PixelRect {
        self.grids[block.place].rect(block.block)
    }

    /// Adds the traced blocks to the film of a region, number by number.
    fn add_to(&self, film: &mut FilmSums, region: PixelRect, traced: &[Option<Vec<PixelSample>>]) {
        let mut blocks = self.blocks.iter().zip(traced).peekable();
        for (place, (number, grid)) in self.numbers.clone().zip(&self.grids).enumerate() {
            let mut of_number: Vec<Option<&[PixelSample]>> = vec![None; grid.len()];
            while let Some((block, samples)) = blocks.next_if(|(block, _)| block.place == place) {
                of_number[block.block] = samples.as_deref();
            }
            add_samples(film, number, region, grid, &of_number);
        }
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
    blocks: &[Option<&[PixelSample]>],
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
            if let Some(samples) = blocks[block] {
                add(&mut tile.sums, pixel, &samples[number_in(grid.rect(block), x, y)]);
            }
        }
        tile.taken.insert(number);
    });
}

/// Adds a sample to a pixel's sums. A sample that is not finite would spoil the pixel for good; it counts
/// as black (and is a defect: debug builds stop).
pub(super) fn add(sums: &mut ExactSums, pixel: usize, sample: &PixelSample) {
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
