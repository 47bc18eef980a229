//! The first samples of a picture without most of their noise, for the eye alone.
//!
//! An edge-avoiding à-trous wavelet filter [Dammertz, Sewtz, Hanika and Lensch 2010: Edge-Avoiding À-Trous Wavelet Transform for
//! fast Global Illumination Filtering], whose edges are those of albedo a and normal n:
//!
//! ```text
//! radiance, a, n ← means of squares of 2×2 pixels
//! c ← (radiance − emission) / max(a, 0.05)
//! for s = 1, 2, 4:                the more samples, the fewer
//!     along rows, then columns:   c_i ← Σ_j h_j w_ij c_j / Σ_j h_j w_ij,   j = i − s, i, i + s,   h = 1/4, 1/2, 1/4
//! radiance of a pixel ← c of its square max(a, 0.05) + emission
//!
//! w_ij = max(0, 1 − |n_i − n_j|² / σ_n² − |a_i − a_j|² / σ_a²)
//! ```
//!
//! A pixel that is less than half like its square takes the mean of its own light and that of the nine squares around it, by
//! their weights; where none is like it, a little of all, so that no pixel is black because its one path found no light.
//!
//! It departs from the paper in four ways.
//! It works at half the resolution, and is separable with three taps, which together is a hundredth of the work; weights are not
//! of the color, which is mostly noise; and light is divided by the albedo, so that textures stay as sharp as they were rendered.

use rayon::prelude::*;
use translucid_render::{FilmSums, layer};

/// Widths σ_n and σ_a of the weights.
const NORMAL_WIDTH: f32 = 0.5;
const ALBEDO_WIDTH: f32 = 0.2;
/// Albedos below this one divide as it does, or the noise of dark surfaces would be that of bright ones' neighbors.
const LEAST_ALBEDO: f32 = 0.05;
/// Weights at the edges of surfaces: a pixel's own light, and the least of a square beside it.
const OWN_WEIGHT: f32 = 0.05;
const LEAST_WEIGHT: f32 = 0.01;

/// Lines of a row: three of light, and of what guides it three of the albedo and three of the normal.
const LIGHT: usize = 3;
const GUIDES: usize = 6;

/// Levels for one sample a pixel at a fraction of the resolution, whose pixels are few.
pub(crate) const PREVIEW_LEVELS: u32 = 2;

/// Levels for a picture of so many samples; none from where on light is blurred more than noise is taken out.
///
/// The test of the still life holds what they gain.
pub(crate) fn levels(samples: u32) -> Option<u32> {
    match samples {
        1 => Some(3),
        2..8 => Some(2),
        8..32 => Some(1),
        _ => None,
    }
}

/// Mean values of a pixel, layer by layer.
pub(crate) type Mean = [f64; layer::COUNT];

/// The light of a film over the albedo, filtered, in squares of 2×2 pixels.
pub(crate) struct SmoothLight {
    /// Squares in a row, and rows.
    width: usize,
    height: usize,
    /// Row by row; in a row line by line, one for each number of a square.
    light: Vec<f32>,
    guides: Vec<f32>,
}

impl SmoothLight {
    /// The light of a film after so many levels of the filter.
    pub(crate) fn new(film: &FilmSums, levels: u32) -> Self {
        let mut light = Self::read(film);
        for level in 0..levels {
            light.filter_rows(1 << level);
            light.filter_columns(1 << level);
        }
        light
    }

    fn read(film: &FilmSums) -> Self {
        let [width, height] = [film.width, film.height].map(|edge| edge.div_ceil(2) as usize);
        let mut light = vec![0.0; LIGHT * width * height];
        let mut guides = vec![0.0; GUIDES * width * height];
        let rows = light.par_chunks_mut(LIGHT * width).zip(guides.par_chunks_mut(GUIDES * width));
        rows.enumerate().for_each(|(row, (light, guides))| {
            for column in 0..width {
                let mut sums = [0.0; layer::COUNT];
                for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                    // At an odd edge a pixel stands for the one that is not there
                    let x = (2 * column as u32 + x).min(film.width - 1);
                    let y = (2 * row as u32 + y).min(film.height - 1);
                    sums.iter_mut().zip(film.mean(x, y)).for_each(|(sum, value)| *sum += value);
                }
                let mean = sums.map(|sum| 0.25 * sum);
                let guides_here = guides_of(&mean);
                let light_here = light_of(&mean, &guides_here);
                (0..LIGHT).for_each(|c| light[c * width + column] = light_here[c]);
                (0..GUIDES).for_each(|c| guides[c * width + column] = guides_here[c]);
            }
        });
        Self { width, height, light, guides }
    }

    /// Each square with those `step` to its left and right.
    fn filter_rows(&mut self, step: usize) {
        let width = self.width;
        let rows = self.light.par_chunks_mut(LIGHT * width).zip(self.guides.par_chunks(GUIDES * width));
        let scratch = || (vec![0.0; width + step], vec![0.0; width], vec![0.0; width + 2 * step]);
        rows.for_each_init(scratch, |(weights, factors, padded), (light, guides)| {
            // Beyond the edges are zeros, of the weights and of the light
            if width > step {
                let lines = guides.chunks_exact(width).map(|line| (&line[..width - step], &line[step..]));
                weigh(lines, &mut weights[step..width]);
            }
            normalize([&weights[..width], &weights[step..]], factors);
            for line in light.chunks_exact_mut(width) {
                padded[step..step + width].copy_from_slice(line);
                let beside = [&padded[..width], &padded[2 * step..]];
                add_neighbors(line, beside, [&weights[..width], &weights[step..]], factors);
            }
        });
    }

    /// Each square with those `step` above and below it.
    fn filter_columns(&mut self, step: usize) {
        let Self { width, height, .. } = *self;
        let guides_of =
            |row: usize| self.guides[GUIDES * width * row..][..GUIDES * width].chunks_exact(width);
        // Weights of each row with the one below, after as many empty rows as there are none above
        let mut weights = vec![0.0; width * (height + step)];
        let inner = weights[width * step..].par_chunks_mut(width).take(height.saturating_sub(step));
        inner
            .enumerate()
            .for_each(|(row, weights)| weigh(guides_of(row).zip(guides_of(row + step)), weights));
        let old = &self.light;
        let mut new = old.clone();
        let rows = new.par_chunks_mut(LIGHT * width).enumerate();
        rows.for_each_init(
            || vec![0.0; width],
            |factors, (row, light)| {
                let weights = [row, row + step].map(|row| &weights[width * row..][..width]);
                normalize(weights, factors);
                let beside = [row.saturating_sub(step), (row + step).min(height - 1)];
                let beside = beside.map(|row| &old[LIGHT * width * row..][..LIGHT * width]);
                for (c, line) in light.chunks_exact_mut(width).enumerate() {
                    add_neighbors(line, beside.map(|row| &row[c * width..][..width]), weights, factors);
                }
            },
        );
        self.light = new;
    }

    /// The radiance of a pixel of the film, whose mean values are these.
    pub(crate) fn radiance(&self, [x, y]: [u32; 2], mean: &Mean) -> [f64; 3] {
        let guides = guides_of(mean);
        let [column, row] = [x as usize / 2, y as usize / 2];
        let light = if self.weight(&guides, column, row) >= 0.5 {
            self.light_at(column, row)
        } else {
            self.light_around(&guides, light_of(mean, &guides), column, row)
        };
        std::array::from_fn(|c| f64::from(light[c] * albedo(&guides, c)) + mean[layer::EMISSION.start + c])
    }

    /// The mean of a pixel's own light and that of the squares around it, by their weights.
    fn light_around(
        &self,
        guides: &[f32; GUIDES],
        own: [f32; LIGHT],
        column: usize,
        row: usize,
    ) -> [f32; LIGHT] {
        let around = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let (mut sum, mut light) = (OWN_WEIGHT, own.map(|value| OWN_WEIGHT * value));
        for row in around(row, self.height) {
            for column in around(column, self.width) {
                let weight = self.weight(guides, column, row).max(LEAST_WEIGHT);
                sum += weight;
                let of_square = self.light_at(column, row);
                light.iter_mut().zip(of_square).for_each(|(light, value)| *light += weight * value);
            }
        }
        light.map(|value| value / sum)
    }

    fn light_at(&self, column: usize, row: usize) -> [f32; LIGHT] {
        std::array::from_fn(|c| self.light[(LIGHT * row + c) * self.width + column])
    }

    /// How much a square is like a pixel of these guides.
    fn weight(&self, guides: &[f32; GUIDES], column: usize, row: usize) -> f32 {
        let difference = |c: usize| guides[c] - self.guides[(GUIDES * row + c) * self.width + column];
        let sum: f32 = (0..GUIDES).map(|c| difference(c) * difference(c)).sum();
        (1.0 - sum).max(0.0)
    }
}

/// Albedo and normal over the widths of their weights.
fn guides_of(mean: &Mean) -> [f32; GUIDES] {
    std::array::from_fn(|c| match c {
        0..3 => mean[layer::ALBEDO.start + c] as f32 * (1.0 / ALBEDO_WIDTH),
        _ => mean[layer::NORMAL.start + c - 3] as f32 * (1.0 / NORMAL_WIDTH),
    })
}

/// Light but for emission, over the albedo.
fn light_of(mean: &Mean, guides: &[f32; GUIDES]) -> [f32; LIGHT] {
    std::array::from_fn(|c| {
        let layers = [layer::DIFFUSE, layer::SPECULAR, layer::SUBSURFACE];
        let light: f64 = layers.map(|layer| mean[layer.start + c]).iter().sum();
        // Nothing that is no number may spread
        (light.max(0.0) as f32).min(1e30) / albedo(guides, c)
    })
}

/// The albedo that light is divided by.
fn albedo(guides: &[f32; GUIDES], c: usize) -> f32 {
    (guides[c] * ALBEDO_WIDTH).max(LEAST_ALBEDO)
}

/// Weights of squares with others, from lines of their guides.
fn weigh<'a>(guides: impl Iterator<Item = (&'a [f32], &'a [f32])>, weights: &mut [f32]) {
    weights.fill(1.0);
    for (ours, theirs) in guides {
        for ((weight, a), b) in weights.iter_mut().zip(ours).zip(theirs) {
            *weight -= (a - b) * (a - b);
        }
    }
    weights.iter_mut().for_each(|weight| *weight = weight.max(0.0));
}

/// Factors that make the weights of a square and its two neighbors sum to 1.
fn normalize([before, after]: [&[f32]; 2], factors: &mut [f32]) {
    for ((factor, a), b) in factors.iter_mut().zip(before).zip(after) {
        *factor = 1.0 / (2.0 + a + b);
    }
}

/// The mean of each value, which counts twice, and of its two neighbors.
fn add_neighbors(line: &mut [f32], [before, after]: [&[f32]; 2], weights: [&[f32]; 2], factors: &[f32]) {
    let before = before.iter().zip(weights[0]);
    let after = after.iter().zip(weights[1]);
    for (((value, (a, to_a)), (b, to_b)), factor) in line.iter_mut().zip(before).zip(after).zip(factors) {
        *value = (2.0 * *value + to_a * a + to_b * b) * factor;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use translucid_load::{LoadOptions, still_life};
    use translucid_render::{Goal, LiveFilm, PreparedScene, SampleRanges, View};

    use super::*;

    /// A film of one sample, whose pixels a function fills by their place.
    fn film(width: u32, height: u32, fill: impl Fn(u32, u32, &mut [f64; layer::COUNT])) -> FilmSums {
        let mut film = FilmSums::new(width, height);
        for index in 0..film.tiles.len() {
            let rect = film.tile_rect(index);
            let tile = &mut film.tiles[index];
            tile.taken = SampleRanges::from(0..1);
            for (at, sums) in (0..).zip(tile.pixels_mut()) {
                fill(rect.left + at % rect.width, rect.top + at / rect.width, sums);
            }
        }
        film
    }

    /// The radiance of all pixels after so many levels or, without, as it was rendered.
    fn radiance(film: &FilmSums, levels: Option<u32>) -> Vec<[f64; 3]> {
        let smooth = levels.map(|levels| SmoothLight::new(film, levels));
        let places = (0..film.height).flat_map(|y| (0..film.width).map(move |x| [x, y]));
        let at = |[x, y]: [u32; 2]| match &smooth {
            Some(light) => light.radiance([x, y], &film.mean(x, y)),
            None => film.radiance(x, y),
        };
        places.map(at).collect()
    }

    /// Makes a pixel that of a surface with a normal and an albedo.
    fn surface(sums: &mut [f64; layer::COUNT], normal: [f64; 3], albedo: f64) {
        sums[layer::NORMAL].copy_from_slice(&normal);
        sums[layer::ALBEDO].fill(albedo);
    }

    #[test]
    fn even_light_keeps_every_texture() {
        let texture = |x: u32, y: u32| if (x / 3 + y / 2).is_multiple_of(2) { 0.2 } else { 0.7 };
        let film = film(67, 35, |x, y, sums| {
            surface(sums, [0.0, 0.0, 1.0], texture(x, y));
            sums[layer::SUBSURFACE].fill(2.0 * texture(x, y));
        });
        for (at, pixel) in (0..).zip(radiance(&film, Some(3))) {
            let expected = 2.0 * texture(at % 67, at / 67);
            assert!(pixel.iter().all(|value| (value - expected).abs() < 1e-5), "{at}: {pixel:?}");
        }
    }

    #[test]
    fn light_of_one_pixel_spreads_over_its_surface_alone() {
        // Two faces of a corner and a shape of another color, whose edges go through squares; one pixel of the first has light
        let film = film(40, 40, |x, y, sums| {
            let normal = if x < 21 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
            surface(sums, normal, if y < 31 { 0.8 } else { 0.2 });
            if [x, y] == [17, 27] {
                sums[layer::DIFFUSE].fill(1.0);
            }
        });
        let radiance = radiance(&film, Some(3));
        let at = |x: usize, y: usize| radiance[40 * y + x][0];
        // At the edges a little comes over, from squares that are half of the surface
        let beyond = |x: usize, y: usize| x > 22 || y > 32;
        assert!((0..40).all(|y| (0..40).all(|x| !beyond(x, y) || at(x, y) == 0.0)));
        let most_at_edge = (0..40).map(|at_edge| at(21, at_edge).max(at(at_edge, 31))).fold(0.0, f64::max);
        assert!(most_at_edge < 0.05 * at(17, 27), "{most_at_edge}");
        // No pixel of the surface within reach is black, and little light is lost
        assert!((13..31).all(|y| (3..21).all(|x| at(x, y) > 0.0)));
        let sum: f64 = radiance.iter().map(|pixel| pixel[0]).sum();
        assert!((sum - 1.0).abs() < 0.25, "{sum}");
    }

    #[test]
    fn pixel_that_is_like_no_other_is_not_black() {
        let film = film(12, 12, |x, y, sums| {
            let is_other = [x, y] == [5, 5];
            surface(sums, if is_other { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }, 0.5);
            sums[layer::DIFFUSE].fill(if is_other { 0.0 } else { 1.0 });
        });
        let radiance = radiance(&film, Some(3));
        assert!(radiance.iter().flatten().all(|value| (0.3..=1.0001).contains(value)), "{radiance:?}");
    }

    #[test]
    fn emitters_and_background_stay_as_they_are() {
        let film = film(9, 9, |x, y, sums| sums[layer::EMISSION].fill(f64::from(7 * x + y)));
        for (at, pixel) in (0..).zip(radiance(&film, Some(3))) {
            assert_eq!(pixel, [f64::from(7 * (at % 9) + at / 9); 3]);
        }
    }

    #[test]
    fn levels_fall_to_none() {
        let all: Vec<_> = (0..7).map(|power| levels(1 << power)).collect();
        assert_eq!(all, [Some(3), Some(2), Some(2), Some(1), Some(1), None, None]);
        assert_eq!([levels(0), levels(u32::MAX)], [None; 2]);
    }

    /// The relative mean squared error of a radiance against a film.
    fn relative_mse(radiance: &[[f64; 3]], truth: &FilmSums) -> f64 {
        let mut sum = 0.0;
        for (at, pixel) in (0..).zip(radiance) {
            for (value, truth) in pixel.iter().zip(truth.radiance(at % truth.width, at / truth.width)) {
                sum += (value - truth).powi(2) / (truth * truth + 0.01);
            }
        }
        sum / (3 * radiance.len()) as f64
    }

    #[test]
    fn smoothed_samples_are_closer_to_the_truth() {
        let scene = still_life(&LoadOptions { size: Some([160, 90]), ..LoadOptions::default() }).unwrap();
        let (camera, film) = (scene.camera, scene.film);
        let prepared = PreparedScene::new(scene).unwrap();
        let render = |seed, samples| {
            let view = View::new(camera, film, seed).unwrap();
            let live = LiveFilm::new(FilmSums::new(160, 90));
            let goal = Goal { samples: 0..samples, deadline: None };
            prepared.render(&view, &live, &goal, &|_| {}, &AtomicBool::new(false));
            live.into_sums()
        };
        let truth = render(99, 32);
        for samples in [1, 2, 4, 8] {
            let sums = render(1, samples);
            let [before, after] =
                [None, levels(samples)].map(|levels| relative_mse(&radiance(&sums, levels), &truth));
            assert!(after < 0.5 * before, "{samples} samples: relMSE {before} as rendered, {after} smoothed");
        }
    }
}
