//! A film that others may read while it is rendered.

use std::collections::HashMap;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use translucid_image::PixelRect;

use super::film::{FilmSums, mean_depth, radiance};
use super::traced_block::TracedBlock;
use crate::world::{PixelSample, layer};

/// A layer of a picture that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilmLayer {
    /// All light: linear Rec. 709 radiance, 3 channels.
    Radiance,
    /// Light that was reflected by matte surfaces, 3 channels.
    Diffuse,
    /// Light that was reflected or refracted by an interface, 3 channels.
    Specular,
    /// Light that has traveled below a surface, 3 channels.
    Subsurface,
    /// Light straight from emitters, 3 channels.
    Emission,
    /// Coverage, 1 channel.
    Alpha,
    /// Albedo of the first surface, 3 channels.
    Albedo,
    /// World-space shading normal of the first surface, 3 channels.
    Normal,
    /// Mean distance to the first surface \[L\], 1 channel, 0 where there is none.
    Depth,
}

impl FilmLayer {
    /// Every layer.
    pub const ALL: [Self; 9] = [
        Self::Radiance,
        Self::Diffuse,
        Self::Specular,
        Self::Subsurface,
        Self::Emission,
        Self::Alpha,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
    ];

    /// The layer's name, as files and the Python module write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radiance => "radiance",
            Self::Diffuse => "diffuse",
            Self::Specular => "specular",
            Self::Subsurface => "subsurface",
            Self::Emission => "emission",
            Self::Alpha => "alpha",
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Depth => "depth",
        }
    }

    /// The layer of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|layer| layer.name() == name)
    }

    /// Number of channels.
    pub fn channels(self) -> usize {
        match self {
            Self::Alpha | Self::Depth => 1,
            _ => 3,
        }
    }

    /// The layer's channels of a pixel with these mean values.
    pub fn values_of(self, mean: &[f64; layer::COUNT]) -> Vec<f32> {
        self.values(mean)[..self.channels()].iter().map(|value| *value as f32).collect()
    }

    /// A pixel's values; of a layer with one channel the first.
    fn values(self, mean: &[f64; layer::COUNT]) -> [f64; 3] {
        let color = |range: Range<usize>| std::array::from_fn(|c| mean[range.start + c]);
        match self {
            Self::Radiance => radiance(mean),
            Self::Diffuse => color(layer::DIFFUSE),
            Self::Specular => color(layer::SPECULAR),
            Self::Subsurface => color(layer::SUBSURFACE),
            Self::Emission => color(layer::EMISSION),
            Self::Alpha => [mean[layer::ALPHA]; 3],
            Self::Albedo => color(layer::ALBEDO),
            Self::Normal => color(layer::NORMAL),
            Self::Depth => [mean_depth(mean); 3],
        }
    }
}

/// Samples of blocks of pixels, by the sample's number and the block's in its grid.
pub(super) type BlockSamples = HashMap<(u32, usize), Vec<PixelSample>>;

/// Sums over the samples of an image that one rendering adds to and anybody may read.
///
/// The picture is whole at any time: a tile has the same number of samples in all its pixels.
#[derive(Debug)]
pub struct LiveFilm {
    sums: RwLock<FilmSums>,
    /// Blocks that were traced before an interruption, and have a part in tiles that lack others.
    waiting: Mutex<BlockSamples>,
    /// For each tile the number of the change that was its last.
    changed: RwLock<Vec<u64>>,
    changes: AtomicU64,
}

impl LiveFilm {
    /// A film that goes on from these sums.
    pub fn new(sums: FilmSums) -> Self {
        let changed = RwLock::new(vec![0; sums.tiles.len()]);
        Self { sums: RwLock::new(sums), waiting: Mutex::default(), changed, changes: AtomicU64::new(0) }
    }

    /// The sums; nothing is added while they are held.
    pub fn sums(&self) -> RwLockReadGuard<'_, FilmSums> {
        self.sums.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// The sums, once nobody else needs the film.
    pub fn into_sums(self) -> FilmSums {
        self.sums.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fewest samples that any pixel has.
    pub fn samples(&self) -> u32 {
        self.sums().samples()
    }

    /// Copies the mean values of a layer, row by row from the top, the [`channels`](FilmLayer::channels) of a pixel side
    /// by side, as far as the values or the places go.
    pub fn copy_layer(&self, layer: FilmLayer, into: &mut [f32]) {
        let sums = self.sums();
        let pixels = PixelRect::whole([sums.width, sums.height]).pixels();
        for ((x, y), into) in pixels.zip(into.chunks_mut(layer.channels())) {
            into.iter_mut()
                .zip(layer.values(&sums.mean(x, y)))
                .for_each(|(into, value)| *into = value as f32);
        }
    }

    /// The mean values of a layer, as [`copy_layer`](Self::copy_layer) orders them.
    pub fn layer(&self, layer: FilmLayer) -> Vec<f32> {
        // One lock at a time: a second one waits for a writer that waits for the first
        let pixels = {
            let sums = self.sums();
            sums.width as usize * sums.height as usize
        };
        let mut values = vec![0.0; pixels * layer.channels()];
        self.copy_layer(layer, &mut values);
        values
    }

    /// Number of the last change: it grows when tiles get samples.
    pub fn changes(&self) -> u64 {
        self.changes.load(Ordering::Acquire)
    }

    /// Tiles that have changed after the change of this number, in pixels of the film; of 0, all that have samples.
    pub fn tiles_changed_since(&self, change: u64) -> Vec<PixelRect> {
        let sums = self.sums();
        let changed = self.changed.read().unwrap_or_else(PoisonError::into_inner);
        let is_later =
            |tile: &usize| changed[*tile] > change || change == 0 && sums.tiles[*tile].samples() > 0;
        (0..sums.tiles.len()).filter(is_later).map(|tile| sums.tile_rect(tile)).collect()
    }

    /// Gives a block that was traced for this film elsewhere; the next rendering adds it.
    pub fn give(&self, block: TracedBlock) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        waiting.insert((block.number, block.block), block.samples);
    }

    /// Blocks that wait for others, until a rendering puts back those that still do.
    pub(super) fn waiting(&self) -> &Mutex<BlockSamples> {
        &self.waiting
    }

    /// Lets `add` change the sums; it returns for each tile whether it has changed it.
    pub(super) fn change(&self, add: impl FnOnce(&mut FilmSums) -> Vec<bool>) {
        let mut sums: RwLockWriteGuard<'_, FilmSums> =
            self.sums.write().unwrap_or_else(PoisonError::into_inner);
        let is_changed = add(&mut sums);
        let number = self.changes.load(Ordering::Relaxed) + 1;
        let mut changed = self.changed.write().unwrap_or_else(PoisonError::into_inner);
        for (last, is_changed) in changed.iter_mut().zip(is_changed) {
            if is_changed {
                *last = number;
            }
        }
        self.changes.store(number, Ordering::Release);
    }
}
