//! Sums of pixel samples, tile by tile.

use translucid_image::PixelRect;

use crate::world::layer;

/// Edge of a tile in pixels: the unit of work of a thread.
pub const TILE_SIZE: u32 = 16;

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
    pub fn new(width: u32, height: u32) -> Self {
        let mut film = Self { width, height, tiles: Vec::new() };
        let count = width.div_ceil(TILE_SIZE) * height.div_ceil(TILE_SIZE);
        for index in 0..count as usize {
            let area = film.tile_rect(index).area() as usize;
            film.tiles.push(TileSums { samples: 0, pixels: vec![[0.0; layer::COUNT]; area] });
        }
        film
    }

    /// Pixels of a tile.
    pub fn tile_rect(&self, index: usize) -> PixelRect {
        let per_row = self.width.div_ceil(TILE_SIZE);
        let x = index as u32 % per_row * TILE_SIZE;
        let y = index as u32 / per_row * TILE_SIZE;
        let (width, height) = (TILE_SIZE.min(self.width - x), TILE_SIZE.min(self.height - y));
        PixelRect { left: x, top: y, width, height }
    }

    /// Mean values of a pixel, layer by layer; zeros where there is no sample.
    pub fn mean(&self, x: u32, y: u32) -> [f64; layer::COUNT] {
        let per_row = self.width.div_ceil(TILE_SIZE);
        let index = (y / TILE_SIZE * per_row + x / TILE_SIZE) as usize;
        let PixelRect { left, top, width, .. } = self.tile_rect(index);
        let tile = &self.tiles[index];
        let sums = &tile.pixels[((y - top) * width + (x - left)) as usize];
        let scale = 1.0 / f64::from(tile.samples.max(1));
        sums.map(|sum| sum * scale)
    }

    /// Linear radiance of a pixel: the sum of the light layers.
    pub fn radiance(&self, x: u32, y: u32) -> [f64; 3] {
        radiance(&self.mean(x, y))
    }

    /// Linear radiance of a pixel, then its coverage, in the precision of files and displays.
    pub fn rgba(&self, x: u32, y: u32) -> [f32; 4] {
        let mean = self.mean(x, y);
        let [red, green, blue] = radiance(&mean);
        [red, green, blue, mean[layer::ALPHA]].map(|value| value as f32)
    }

    /// Camera paths in all pixels together.
    pub fn paths(&self) -> u64 {
        self.tiles.iter().map(|tile| u64::from(tile.samples) * tile.pixels.len() as u64).sum()
    }

    /// Fewest samples that any pixel has.
    pub fn samples(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.samples).min().unwrap_or(0)
    }
}

/// The sum of the light layers.
pub(super) fn radiance(m: &[f64; layer::COUNT]) -> [f64; 3] {
    std::array::from_fn(|c| m[c] + m[3 + c] + m[6 + c] + m[9 + c])
}

/// Mean distance over the samples that see a surface.
pub(super) fn mean_depth(mean: &[f64; layer::COUNT]) -> f64 {
    if mean[layer::SURFACE] > 0.0 { mean[layer::DEPTH] / mean[layer::SURFACE] } else { 0.0 }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A film with five samples a pixel, every sum different.
    pub(crate) fn test_film(width: u32, height: u32) -> FilmSums {
        let mut film = FilmSums::new(width, height);
        let mut value = 0.0;
        for tile in &mut film.tiles {
            tile.samples = 5;
            for sum in tile.pixels.iter_mut().flatten() {
                value = (value + 0.618_033_988_749_895_f64).fract();
                *sum = 5.0 * value;
            }
        }
        film
    }

    #[test]
    fn mean_finds_the_pixel_in_its_tile() {
        let mut film = FilmSums::new(37, 21);
        for index in 0..film.tiles.len() {
            let PixelRect { left, top, width, .. } = film.tile_rect(index);
            film.tiles[index].samples = 2;
            for (number, sums) in film.tiles[index].pixels.iter_mut().enumerate() {
                let (x, y) = (left + number as u32 % width, top + number as u32 / width);
                *sums = [f64::from(2 * (1000 * y + x)); layer::COUNT];
            }
        }
        for (x, y) in [(0, 0), (15, 15), (16, 15), (36, 20), (35, 16), (3, 20)] {
            assert_eq!(film.mean(x, y)[0], f64::from(1000 * y + x));
            assert_eq!(film.radiance(x, y)[0], 4.0 * f64::from(1000 * y + x));
        }
        assert_eq!(film.samples(), 2);
    }
}
