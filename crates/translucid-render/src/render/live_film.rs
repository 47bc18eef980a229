//! A film that others may read while it is rendered.

use std::fmt;
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use translucid_image::PixelRect;

use super::film::FilmSums;
use crate::world::layer;

/// A layer of a picture, for those who read it.
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

    /// Number of channels.
    #[must_use]
    pub fn channels(self) -> usize {
        match self {
            Self::Alpha | Self::Depth => 1,
            _ => 3,
        }
    }

    /// Writes a pixel's mean values.
    fn write(self, mean: &[f64; layer::COUNT], out: &mut [f32]) {
        let mut copy = |range: Range<usize>| {
            for (out, value) in out.iter_mut().zip(&mean[range]) {
                *out = *value as f32;
            }
        };
        match self {
            Self::Radiance => {
                for (c, out) in out.iter_mut().enumerate() {
                    *out = (mean[c] + mean[3 + c] + mean[6 + c] + mean[9 + c]) as f32;
                }
            }
            Self::Diffuse => copy(layer::DIFFUSE),
            Self::Specular => copy(layer::SPECULAR),
            Self::Subsurface => copy(layer::SUBSURFACE),
            Self::Emission => copy(layer::EMISSION),
            Self::Alpha => copy(layer::ALPHA..layer::ALPHA + 1),
            Self::Albedo => copy(layer::ALBEDO),
            Self::Normal => copy(layer::NORMAL),
            Self::Depth => out[0] = (mean[layer::DEPTH] / mean[layer::SURFACE].max(f64::MIN_POSITIVE)) as f32,
        }
    }
}

/// A buffer that does not have the length of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerSizeError {
    /// Numbers that the layer has: width × height × channels.
    pub needed: usize,
    /// Length of the buffer.
    pub given: usize,
}

impl fmt::Display for LayerSizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the buffer has room for {} numbers, but must have it for {}", self.given, self.needed)
    }
}

impl std::error::Error for LayerSizeError {}

/// Sums over the samples of an image that one rendering adds to and anybody may read.
///
/// The picture is whole at any time: a tile has the same number of samples in all its pixels.
#[derive(Debug)]
pub struct LiveFilm {
    sums: RwLock<FilmSums>,
    /// For each tile the number of the change that was its last.
    changed: RwLock<Vec<u64>>,
    changes: AtomicU64,
}

impl LiveFilm {
    /// A film that goes on from these sums.
    #[must_use]
    pub fn new(sums: FilmSums) -> Self {
        let changed = RwLock::new(vec![0; sums.tiles.len()]);
        Self { sums: RwLock::new(sums), changed, changes: AtomicU64::new(0) }
    }

    /// The sums; nothing is added while they are held.
    pub fn sums(&self) -> RwLockReadGuard<'_, FilmSums> {
        self.sums.read().unwrap_or_else(PoisonError::into_inner)
    }

    /// The sums, once nobody else needs the film.
    #[must_use]
    pub fn into_sums(self) -> FilmSums {
        self.sums.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fewest samples that any pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.sums().samples()
    }

    /// Copies the mean values of a layer, row by row from the top, the channels of a pixel side by side.
    ///
    /// # Errors
    /// `out` does not have width × height × [`FilmLayer::channels`] numbers.
    pub fn copy_layer(&self, layer: FilmLayer, out: &mut [f32]) -> Result<(), LayerSizeError> {
        let sums = self.sums();
        let needed = sums.width as usize * sums.height as usize * layer.channels();
        if out.len() != needed {
            return Err(LayerSizeError { needed, given: out.len() });
        }
        for ((x, y), out) in
            PixelRect::whole([sums.width, sums.height]).pixels().zip(out.chunks_exact_mut(layer.channels()))
        {
            layer.write(&sums.mean(x, y), out);
        }
        Ok(())
    }

    /// Number of the last change: it grows when tiles get samples.
    #[must_use]
    pub fn changes(&self) -> u64 {
        self.changes.load(Ordering::Acquire)
    }

    /// Tiles that have changed after the change of this number, in pixels of the film; of 0, all that have samples.
    #[must_use]
    pub fn tiles_changed_since(&self, change: u64) -> Vec<PixelRect> {
        let sums = self.sums();
        let changed = self.changed.read().unwrap_or_else(PoisonError::into_inner);
        let is_later = |tile: &usize| changed[*tile] > change || change == 0 && sums.tiles[*tile].samples > 0;
        (0..sums.tiles.len()).filter(is_later).map(|tile| sums.tile_rect(tile)).collect()
    }

    /// Has `add` add to the sums; it says which tiles it has changed.
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
