//! Regions of pictures on a device against those of the processor.
//!
//! Both sides have the same random numbers and share no light between pixels, so that most samples are the same and the
//! differences of pixels have a small part of the noise of pixels. Where they are not (the processor follows what a surface
//! reflects beside what comes from below, and what glass reflects beside what it lets through, and the device one of both), the
//! noise is that of both, and the differences are skewed: few samples of the device have the light of many of the processor's.
//!
//! A mean is *shown* to be within 0.3 % where its difference and two standard errors are; the table counts these. All others are
//! only not contradicted. Light that comes in samples rarer than one in all of a region's (4,096 a pass) is in neither
//! difference nor error: only more passes find it.

#![allow(clippy::print_stdout, reason = "the figures are for those who ask with --nocapture")]

mod generated;
mod scenes;

use translucid_render::device::{DeviceLimits, DeviceScene};
use translucid_render::{FilmLayer, PreparedScene};
use translucid_scene::Scene;

use super::tests::{picture, tracer};

/// Edge of a region, and of a picture \[pixels\].
const REGION: u32 = 32;
const EDGE: u32 = 2 * REGION;
/// Means: three channels of the regions of a picture, and of the whole.
const CELLS: usize = 3 * (EDGE / REGION).pow(2) as usize + 3;

/// Relative difference of a region's mean that is allowed beside errors.
const ALLOWED: f64 = 3e-3;
/// Standard errors beside it.
const ERRORS: f64 = 5.0;
/// Relative standard error of a region's mean at which no more passes are made.
const PRECISION: f64 = 1e-3;
/// Samples of a pixel in a pass, and the most passes of graphics processors, and of drivers that calculate on the processor.
const SAMPLES: u32 = 4;
const PASSES: (u32, u32) = (1024, 16);
/// Light below which a region is dark.
const DARK: f64 = 1e-5;
/// Scenes drawn at random.
const GENERATED: usize = 20;

/// Sums over the pixels of a region in a channel, and over passes.
#[derive(Clone, Copy, Default)]
struct Cell {
    pixels: f64,
    light: f64,
    difference: f64,
    squares: f64,
    cubes: f64,
}

impl Cell {
    fn add(&mut self, ours: f64, theirs: f64) {
        self.pixels += 1.0;
        self.light += ours;
        self.difference += theirs - ours;
        self.squares += (theirs - ours).powi(2);
        self.cubes += (theirs - ours).powi(3);
    }

    /// The difference and its standard error, over the processor's light.
    fn relative(&self) -> [f64; 2] {
        let light = self.light.max(DARK * self.pixels);
        [self.difference, self.squares.sqrt()].map(|value| value / light)
    }

    /// Returns `true` if the difference is beyond the allowed one by more standard errors than chance has.
    ///
    /// The quotient t of a skewed sum and its error, of skewness γ, is far below normal numbers more often than above where γ > 0;
    /// t + γt²/3 + γ²t³/27 + γ/6 is nearly normal (P. Hall 1992, On the Removal of Skewness by Transformation, JRSS B 54(1)).
    fn is_off(&self) -> bool {
        let [difference, error] = self.relative();
        let excess = difference - difference.clamp(-ALLOWED, ALLOWED);
        if excess == 0.0 {
            return false;
        }
        let (t, skewness) = (excess / error, self.cubes / self.squares.powf(1.5));
        let normal = t + skewness * t * t / 3.0 + skewness.powi(2) * t.powi(3) / 27.0 + skewness / 6.0;
        normal.abs() > ERRORS
    }
}

/// Adds up a pass on both sides.
fn add_pass(scene: &Scene, seed: u64, samples: u32, cells: &mut [Cell; CELLS]) {
    let mut scene = scene.clone();
    scene.integrator.seed = seed;
    scene.integrator.subsurface_sharing = false;
    let radiance = |device| picture(&scene, samples, device).film().layer(FilmLayer::Radiance);
    let [ours, theirs] = [None, Some(tracer())].map(radiance);
    for (index, (a, b)) in ours.into_iter().zip(theirs).enumerate() {
        assert!(a.is_finite() && b.is_finite());
        let (pixel, channel) = (index as u32 / 3, index % 3);
        let [x, y] = [pixel % EDGE, pixel / EDGE].map(|place| place / REGION);
        for cell in [3 * (y * (EDGE / REGION) + x) as usize, CELLS - 3] {
            cells[cell + channel].add(a.into(), b.into());
        }
    }
}

/// Makes passes until every region's mean is as precise as asked for, or so many are made; returns what is wrong.
///
/// Chance alone contradicts one of the 15 means of 28 scenes in 2e-4 of all cases if sums are normal but for their skewness, as they
/// are where a mean's error comes from many samples: 6e-7 for each, and no more where the device's light comes from some 20 bright
/// samples that the processor splits. Where it comes from fewer, the rate grows.
fn judge(name: &str, scene: &Scene, samples: u32, most: u32) -> Option<String> {
    let mut cells = [Cell::default(); CELLS];
    let mut passes = 0;
    while passes < most && (passes < 2 || cells.iter().any(|cell| cell.relative()[1] > PRECISION)) {
        add_pass(scene, 100 + u64::from(passes), samples, &mut cells);
        passes += 1;
    }
    let relative = cells.map(|cell| cell.relative());
    let (regions, picture) = relative.split_at(CELLS - 3);
    let worst = |means: &[[f64; 2]]| {
        let [difference, error] =
            means.iter().copied().max_by(|a, b| a[0].abs().total_cmp(&b[0].abs())).unwrap();
        format!("{:+.3} ± {:.3}", 100.0 * difference, 100.0 * error)
    };
    let greatest = relative.iter().map(|mean| mean[1]).fold(0.0, f64::max);
    let shown =
        relative.iter().filter(|[difference, error]| difference.abs() + 2.0 * error <= ALLOWED).count();
    let samples = passes * samples;
    println!(
        "| {name} | {samples} | {} | {:.3} | {} | {shown} of {CELLS} |",
        worst(regions),
        100.0 * greatest,
        worst(picture)
    );
    let off = cells.iter().position(Cell::is_off)?;
    let [difference, error] = relative[off];
    Some(format!("{name}, mean {}, channel {}: off by {difference} ± {error}", off / 3, off % 3))
}

/// The processor spreads light evenly over a region of which the device has all in bright samples, 20 in the mean: their number has
/// Poisson's distribution.
#[test]
fn bright_samples_raise_as_few_alarms_as_normal_numbers() {
    let (pixels, mean) = (f64::from(REGION * REGION * SAMPLES), 20.0_f64);
    let (mut rate, mut without) = (0.0, 0.0);
    let mut probability = (-mean).exp();
    for bright in 0..100 {
        let count = f64::from(bright);
        let even = mean / pixels;
        let sum = |power: i32| count * (1.0 - even).powi(power) + (pixels - count) * (-even).powi(power);
        let cell = Cell { pixels, light: 1.0, difference: sum(1), squares: sum(2), cubes: sum(3) };
        rate += if cell.is_off() { probability } else { 0.0 };
        without += if (Cell { cubes: 0.0, ..cell }).is_off() { probability } else { 0.0 };
        probability *= mean / (count + 1.0);
    }
    println!("false alarms: {rate:e}, without skewness {without:e}");
    assert!(rate < 6e-7 && without > 1e-4, "{rate} {without}");
}

/// Returns `true` if devices take a scene.
fn is_taken(scene: &Scene) -> bool {
    let prepared = PreparedScene::new(scene.clone()).unwrap();
    let view = prepared.view().unwrap();
    DeviceScene::new(&prepared, &view, &DeviceLimits { array_bytes: 1 << 27 }).is_ok()
}

/// Random scenes that devices take.
fn generated(count: usize) -> impl Iterator<Item = (String, Scene)> {
    let all = (1..).map(|number| (format!("generated {number}"), generated::scene(number)));
    all.filter(|(_, scene)| is_taken(scene)).take(count)
}

/// Prints, in percent, the greatest relative difference of a region with its standard error, the greatest error, and the
/// greatest difference of the whole picture; then how many means are shown to be within 0.3 %. `TRANSLUCID_REGIONS` states a part of the names of the scenes, all of which are
/// rendered then.
#[test]
fn regions_are_those_of_the_processor() {
    println!(
        "| scene | samples | worst region | greatest error | picture | shown |\n|---|---|---|---|---|---|"
    );
    let few =
        || [("spheres".to_owned(), scenes::spheres()), ("slabs".to_owned(), scenes::slabs())].into_iter();
    let wanted = std::env::var("TRANSLUCID_REGIONS").ok();
    let faults: Vec<String> = if translucid_testing::is_thorough() || wanted.is_some() {
        let most = if tracer().gpu.is_graphics_processor() { PASSES.0 } else { PASSES.1 };
        let is_wanted = |(name, _): &(String, _)| wanted.as_ref().is_none_or(|wanted| name.contains(wanted));
        let all = few().chain(scenes::models()).chain(generated(GENERATED)).filter(is_wanted);
        all.filter_map(|(name, scene)| judge(&name, &scene, SAMPLES, most)).collect()
    } else {
        few().chain(generated(1)).filter_map(|(name, scene)| judge(&name, &scene, 2, 1)).collect()
    };
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
