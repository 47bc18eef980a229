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
    /// Share of the samples that see a surface, so that depth / surface is the mean distance even where a
    /// visible environment covers the rest of the pixel.
    pub const SURFACE: usize = 20;
    /// Number of sums per pixel.
    pub const COUNT: usize = 21;
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

    /// The sample as values in the order of [`layer`].
    #[must_use]
    pub fn layers(&self) -> [f32; layer::COUNT] {
        let mut values = [0.0; layer::COUNT];
        for (range, color) in [
            (layer::DIFFUSE, self.diffuse),
            (layer::SPECULAR, self.specular),
            (layer::SUBSURFACE, self.subsurface),
            (layer::EMISSION, self.emission),
            (layer::ALBEDO, self.albedo),
            (layer::NORMAL, self.normal),
        ] {
            values[range].copy_from_slice(&color.to_array());
        }
        values[layer::ALPHA] = self.alpha;
        values[layer::DEPTH] = self.depth;
        values[layer::SURFACE] = if self.depth > 0.0 { 1.0 } else { 0.0 };
        values
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
    fn layers_hold_every_part_of_a_sample() {
        let sample = PixelSample {
            diffuse: Vec3::new(1.0, 2.0, 3.0),
            specular: Vec3::new(4.0, 5.0, 6.0),
            subsurface: Vec3::new(7.0, 8.0, 9.0),
            emission: Vec3::new(10.0, 11.0, 12.0),
            alpha: 13.0,
            albedo: Vec3::new(14.0, 15.0, 16.0),
            normal: Vec3::new(17.0, 18.0, 19.0),
            depth: 20.0,
        };
        let expected: [f32; layer::COUNT] =
            std::array::from_fn(|i| if i == layer::SURFACE { 1.0 } else { i as f32 + 1.0 });
        assert_eq!(sample.layers(), expected);
        assert_eq!(PixelSample { depth: 0.0, ..sample }.layers()[layer::SURFACE], 0.0);
    }

    #[test]
    fn mean_finds_the_pixel_in_its_tile() {
        let mut film = FilmSums::new(37, 21);
        for index in 0..film.tiles.len() {
            let (left, top, width, _) = film.tile_rect(index);
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
