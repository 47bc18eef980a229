//! Sums of pixel samples, tile by tile.
//!
//! Sums are exact, then rounded: films of parts of the samples, or of the picture, join to the bits of one film of all.

use translucid_image::PixelRect;

use super::exact_sums::ExactSums;
use super::sample_ranges::SampleRanges;
use super::tile_grid::TileGrid;
use crate::world::layer;

/// Sums over the samples of one tile: the exact sums, rounded, so that the order of the samples does not matter.
#[derive(Clone, Debug, PartialEq)]
pub struct TileSums {
    /// Samples that each pixel of the tile has received.
    pub taken: SampleRanges,
    pub(super) sums: ExactSums,
}

impl TileSums {
    /// How many samples each pixel has received.
    pub fn samples(&self) -> u32 {
        self.taken.count()
    }

    /// Sums per pixel, row by row.
    pub fn pixels(&self) -> &[[f64; layer::COUNT]] {
        &self.sums.rounded
    }

    /// The sums, to be set by hand.
    pub fn pixels_mut(&mut self) -> &mut [[f64; layer::COUNT]] {
        &mut self.sums.rounded
    }
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
    grid: TileGrid,
}

impl FilmSums {
    /// A film without samples.
    pub fn new(width: u32, height: u32) -> Self {
        Self::on(TileGrid::new(width, height))
    }

    /// A film without samples on other tiles.
    pub(super) fn on(grid: TileGrid) -> Self {
        let [width, height] = grid.size();
        let sums = |index| ExactSums::new(grid.rect(index).area() as usize);
        let tile = |index| TileSums { taken: SampleRanges::default(), sums: sums(index) };
        Self { width, height, tiles: (0..grid.len()).map(tile).collect(), grid }
    }

    /// The places of the tiles.
    pub(super) fn grid(&self) -> &TileGrid {
        &self.grid
    }

    /// Pixels of a tile.
    pub fn tile_rect(&self, index: usize) -> PixelRect {
        self.grid.rect(index)
    }

    /// Mean values of a pixel, layer by layer; zeros where there is no sample.
    pub fn mean(&self, x: u32, y: u32) -> [f64; layer::COUNT] {
        let index = self.grid.index_of(x, y);
        let PixelRect { left, top, width, .. } = self.tile_rect(index);
        let tile = &self.tiles[index];
        let sums = &tile.sums.rounded[((y - top) * width + (x - left)) as usize];
        let scale = 1.0 / f64::from(tile.samples().max(1));
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
        self.tiles.iter().map(|tile| u64::from(tile.samples()) * tile.pixels().len() as u64).sum()
    }

    /// Fewest samples that any pixel has.
    pub fn samples(&self) -> u32 {
        self.tiles.iter().map(TileSums::samples).min().unwrap_or(0)
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
            (0..5).for_each(|number| tile.taken.insert(number));
            for sum in tile.pixels_mut().iter_mut().flatten() {
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
            (0..2).for_each(|number| film.tiles[index].taken.insert(number));
            for (number, sums) in film.tiles[index].pixels_mut().iter_mut().enumerate() {
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
