//! Sums of pixel samples, tile by tile.

use glam::Vec3;

/// Edge of a tile in pixels: the unit of work of a thread.
pub const TILE_SIZE: u32 = 16;

/// Indices of the layers within a pixel's sums.
pub mod layer {
    use std::ops::Range;

    /// Light whose last event before the camera was a diffuse reflection.
    pub const DIFFUSE: Range<usize> = 0..3;
    /// … a specular reflection or transmission.
    pub const SPECULAR: Range<usize> = 3..6;
    /// … subsurface scattering.
    pub const SUBSURFACE: Range<usize> = 6..9;
    /// Light straight from an emitter, the visible environment included.
    pub const EMISSION: Range<usize> = 9..12;
    /// Coverage.
    pub const ALPHA: usize = 12;
    /// Albedo of the first surface seen.
    pub const ALBEDO: Range<usize> = 13..16;
    /// World-space shading normal of the first surface seen.
    pub const NORMAL: Range<usize> = 16..19;
    /// Distance to the first surface seen \[L\], summed over the samples that see one.
    pub const DEPTH: usize = 19;
    /// Number of sums per pixel.
    pub const COUNT: usize = 20;
}

/// What one camera path brings; the beauty image is the sum of the four light layers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PixelSample {
    /// See [`layer::DIFFUSE`].
    pub diffuse: Vec3,
    /// See [`layer::SPECULAR`].
    pub specular: Vec3,
    /// See [`layer::SUBSURFACE`].
    pub subsurface: Vec3,
    /// See [`layer::EMISSION`].
    pub emission: Vec3,
    /// 1 where a surface or a visible environment is seen, 0 where nothing is.
    pub alpha: f32,
    /// See [`layer::ALBEDO`].
    pub albedo: Vec3,
    /// See [`layer::NORMAL`].
    pub normal: Vec3,
    /// Distance to the first surface \[L\], 0 where none is seen.
    pub depth: f32,
}

impl PixelSample {
    /// All light of the sample.
    #[must_use]
    pub fn radiance(&self) -> Vec3 {
        self.diffuse + self.specular + self.subsurface + self.emission
    }
}

/// Sums over the samples of one tile, in double precision so that a million samples lose nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSums {
    /// Samples that each pixel of the tile has received.
    pub samples: u32,
    /// Sums per pixel, row by row.
    pub pixels: Vec<[f64; layer::COUNT]>,
}

/// Sums over all samples of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmSums {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Tiles in rows from the top left; those at the right and bottom edge may be smaller.
    pub tiles: Vec<TileSums>,
}

impl FilmSums {
    /// A film without samples.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        let mut film = Self { width, height, tiles: Vec::new() };
        let count = width.div_ceil(TILE_SIZE) * height.div_ceil(TILE_SIZE);
        for index in 0..count as usize {
            let (_, _, w, h) = film.tile_rect(index);
            film.tiles.push(TileSums { samples: 0, pixels: vec![[0.0; layer::COUNT]; (w * h) as usize] });
        }
        film
    }

    /// Left, top, width and height of a tile in pixels.
    #[must_use]
    pub fn tile_rect(&self, index: usize) -> (u32, u32, u32, u32) {
        let per_row = self.width.div_ceil(TILE_SIZE);
        let x = index as u32 % per_row * TILE_SIZE;
        let y = index as u32 / per_row * TILE_SIZE;
        (x, y, TILE_SIZE.min(self.width - x), TILE_SIZE.min(self.height - y))
    }

    /// Mean values of a pixel, layer by layer; zeros where there is no sample.
    #[must_use]
    pub fn mean(&self, x: u32, y: u32) -> [f64; layer::COUNT] {
        let per_row = self.width.div_ceil(TILE_SIZE);
        let index = (y / TILE_SIZE * per_row + x / TILE_SIZE) as usize;
        let (left, top, width, _) = self.tile_rect(index);
        let tile = &self.tiles[index];
        let sums = &tile.pixels[((y - top) * width + (x - left)) as usize];
        let scale = 1.0 / f64::from(tile.samples.max(1));
        sums.map(|sum| sum * scale)
    }

    /// Linear radiance of a pixel: the sum of the light layers.
    #[must_use]
    pub fn radiance(&self, x: u32, y: u32) -> [f64; 3] {
        let m = self.mean(x, y);
        std::array::from_fn(|c| m[c] + m[3 + c] + m[6 + c] + m[9 + c])
    }

    /// Fewest samples that any pixel has.
    #[must_use]
    pub fn samples(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.samples).min().unwrap_or(0)
    }
}
