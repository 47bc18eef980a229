//! How the noise of shared light looks: steps at the borders of blocks, correlation, and the means of regions.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench structure [-- CASE…] [--samples N] [--pictures N] [--write]
//! ```
//!
//! Prints the table of `docs/speed/noise.md`, which explains its columns; `--samples 1 --write` puts it there.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

mod common;

use std::fmt::Write;

use common::{bumpy_ball, scene};
use glam::Vec3;
use translucid_profile::Model;
use translucid_render::{FilmSums, PreparedScene, internals, layer};
use translucid_scene::{ColorInput, Light, Scene, SubsurfaceModel, WalkSurface};
use translucid_testing::write_measured;

/// Edge of the pictures in pixels.
const SIZE: u32 = 128;
/// Diameter of the ball in pixels.
const BALL: f32 = 110.0;
/// Period of the borders that are looked at: that of the blocks of exits that share.
const BLOCK: u32 = 16;
/// Edge of a region in pixels; regions lie half a region off the blocks.
const REGION: u32 = 16;
/// Samples of the picture that errors are relative to: its own noise, which their mean has more of, would hide their largest.
const REFERENCE_SAMPLES: u32 = 256;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    let number = |option: &str| value(option).map(|n| n.parse::<u32>().expect("a number"));
    let (samples, pictures) = (number("--samples"), number("--pictures"));
    let is_word = |a: &&String| !a.starts_with("--") && a.parse::<u32>().is_err();
    let words: Vec<&String> = arguments.iter().filter(is_word).collect();
    let mut table = String::from(
        "| light | samples | noise over that without sharing | step at a border | … without | correlation at 1, 8, 24 pixels | block means over independent pixels' | … without | error of region means over that without |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, scene) in cases() {
        if !words.is_empty() && !words.iter().any(|word| name.contains(word.as_str())) {
            continue;
        }
        let reference = picture(&scene, true, u64::MAX, REFERENCE_SAMPLES);
        for count in samples.map_or(vec![1, 16], |count| vec![count]) {
            // 96, 24 and 12 for 1, 16 and 64
            let pictures = pictures.unwrap_or((96.0 / f64::from(count).sqrt()) as u32).max(3);
            let [shared, alone] = [true, false].map(|shares| {
                let films: Vec<FilmSums> =
                    (0..u64::from(pictures)).map(|seed| picture(&scene, shares, seed, count)).collect();
                Noise::of(&films, &reference)
            });
            let _ = writeln!(
                table,
                "| {name} | {count} | {:.2} | {:.2} | {:.2} | {:.2}, {:.2}, {:.2} | {:.2} | {:.2} | {:.2} ± {:.2} |",
                shared.pixel / alone.pixel,
                shared.step,
                alone.step,
                shared.correlation[0],
                shared.correlation[1],
                shared.correlation[2],
                shared.region / shared.pixel * f64::from(REGION),
                alone.region / alone.pixel * f64::from(REGION),
                shared.region / alone.region,
                shared.region / alone.region * shared.region_error.hypot(alone.region_error),
            );
        }
    }
    println!("{table}");
    if arguments.iter().any(|argument| argument == "--write") {
        let count = samples.map_or_else(String::new, |count| format!("--samples {count} "));
        let command = format!("cargo bench -p translucid-workbench --bench structure -- {count}--write");
        write_measured("docs/speed/noise.md", &command, &table);
    }
}

fn cases() -> Vec<(String, Scene)> {
    let profile = SubsurfaceModel::Profile(Model::NormalizedDiffusion);
    let walk = SubsurfaceModel::RandomWalk(WalkSurface::Diffuse);
    let mut cases = Vec::new();
    for (name, model) in [("profile", profile), ("walk", walk)] {
        for pixels in [1.0, 4.0, 16.0, 64.0, 4.0 * BALL] {
            let mut scene = scene(bumpy_ball(20_000), 2.0 * pixels / BALL, SIZE);
            scene.materials[0].subsurface_model = model;
            cases.push((format!("{name}, {pixels} pixels"), scene));
        }
    }
    for pixels in [8.0, 16.0] {
        let mut scene = scene(bumpy_ball(20_000), 2.0 * pixels / BALL, SIZE);
        scene.materials[0].subsurface_model = walk;
        scene.materials[0].subsurface_color = ColorInput::constant(Vec3::new(0.95, 0.9, 0.8));
        scene.environment = None;
        scene.lights = vec![Light::Rectangle {
            center: Vec3::new(2.0, 5.0, 3.0),
            edge_x: Vec3::X,
            edge_y: Vec3::new(0.0, -0.5, 0.8),
            radiance: Vec3::splat(400.0),
            visible: false,
        }];
        cases.push((format!("walk from behind, {pixels} pixels"), scene));
    }
    cases
}

fn picture(scene: &Scene, shares: bool, seed: u64, samples: u32) -> FilmSums {
    let mut scene = scene.clone();
    scene.integrator.seed = seed;
    scene.integrator.subsurface_sharing = shares;
    let prepared = PreparedScene::new(scene).expect("a valid scene");
    let mut film = FilmSums::new(SIZE, SIZE);
    internals::add_samples(&prepared, &mut film, samples).expect("a valid view");
    film
}

/// Noise of pictures: statistics of their errors, relative to a picture of many samples.
struct Noise {
    /// Root mean square of a pixel.
    pixel: f64,
    /// Mean difference of neighbors across a border over that elsewhere.
    step: f64,
    /// Correlation along rows and columns.
    correlation: [f64; 3],
    /// Root mean square of the mean of a region.
    region: f64,
    /// Standard error of [`region`](Self::region) relative to it, from the differences between pictures.
    region_error: f64,
}

impl Noise {
    fn of(films: &[FilmSums], reference: &FilmSums) -> Self {
        let channels: [Vec<Errors>; 3] = [0, 1, 2].map(|channel| Errors::of(films, reference, channel));
        let mean_of = |pictures: std::ops::Range<usize>, of: &dyn Fn(&Errors, u32, u32) -> Option<f64>| {
            let (mut sum, mut count) = (0.0, 0.0);
            for errors in channels.iter().flat_map(|errors| &errors[pictures.clone()]) {
                for (x, y) in (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE)) {
                    if let Some(value) = of(errors, x, y) {
                        sum += value;
                        count += 1.0;
                    }
                }
            }
            sum / count
        };
        let mean = |of: &dyn Fn(&Errors, u32, u32) -> Option<f64>| mean_of(0..films.len(), of);
        let square = mean(&|e, x, y| e.at(x, y).map(|v| v * v));
        let step = |at_border: bool| {
            let along = |horizontal: bool| {
                mean(&|e, x, y| {
                    let at = if horizontal { x } else { y };
                    let is_border = at % BLOCK == 0;
                    if at == 0 || is_border != at_border {
                        return None;
                    }
                    let (px, py) = if horizontal { (x - 1, y) } else { (x, y - 1) };
                    Some((e.at(x, y)? - e.at(px, py)?).abs())
                })
            };
            along(true) + along(false)
        };
        let correlation = [1, 8, 24].map(|lag| {
            let rows = mean(&|e, x, y| Some(e.at(x, y)? * e.at(x + lag, y)?));
            let columns = mean(&|e, x, y| Some(e.at(x, y)? * e.at(x, y + lag)?));
            (rows + columns) / (2.0 * square)
        });
        let of_region = |e: &Errors, x: u32, y: u32| {
            if x % REGION != REGION / 2 || y % REGION != REGION / 2 {
                return None;
            }
            let mut sum = 0.0;
            for i in 0..REGION * REGION {
                sum += e.at(x + i % REGION, y + i / REGION)?;
            }
            Some((sum / f64::from(REGION * REGION)).powi(2))
        };
        let region = mean(&of_region);
        let n = films.len() as f64;
        let deviations = (0..films.len()).map(|i| (mean_of(i..i + 1, &of_region) / region - 1.0).powi(2));
        Self {
            pixel: square.sqrt(),
            step: step(true) / step(false),
            correlation,
            region: region.sqrt(),
            // Half of the relative error of the square
            region_error: (deviations.sum::<f64>() / (n * (n - 1.0))).sqrt() / 2.0,
        }
    }
}

/// Errors of a channel of a picture from the mean of all, relative to the reference, where the ball fills the pixel.
struct Errors(Vec<Option<f64>>);

impl Errors {
    fn of(films: &[FilmSums], reference: &FilmSums, channel: usize) -> Vec<Self> {
        let n = films.len() as f64;
        let pixels = || (0..SIZE * SIZE).map(|i| (i % SIZE, i / SIZE));
        let means_and_units: Vec<Option<(f64, f64)>> = pixels()
            .map(|(x, y)| {
                let mean = films.iter().map(|film| film.radiance(x, y)[channel]).sum::<f64>() / n;
                let unit = reference.radiance(x, y)[channel].max(0.02);
                films.iter().all(|film| film.mean(x, y)[layer::ALPHA] == 1.0).then_some((mean, unit))
            })
            .collect();
        // Share of a picture's own error in the mean
        let scale = (n / (n - 1.0)).sqrt();
        let of_film = |film: &FilmSums| {
            let error = |((x, y), of_pixel): ((u32, u32), &Option<(f64, f64)>)| {
                of_pixel.map(|(mean, unit)| (film.radiance(x, y)[channel] - mean) / unit * scale)
            };
            Self(pixels().zip(&means_and_units).map(error).collect())
        };
        films.iter().map(of_film).collect()
    }

    fn at(&self, x: u32, y: u32) -> Option<f64> {
        if x < SIZE && y < SIZE { self.0[(y * SIZE + x) as usize] } else { None }
    }
}
