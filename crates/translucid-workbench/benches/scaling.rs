//! Growth of a picture's cost with its triangles, with the mean free path and with the threads.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench scaling [-- --triangles 1e4,1e5,1e6,1e7 --write]
//! ```
//!
//! Prints the tables of `docs/speed/scaling.md`, which explains their columns; `--write` puts them there.
//! The scene is made here: a ball with bumps, 2 across and seen whole, in normalized diffusion under a lamp and a sky.
//! The bench `lights` measures the cost of lights.

#![allow(clippy::print_stdout, reason = "the tables are the bench's output")]

mod common;

use std::fmt::Write;
use std::time::Instant;

use translucid_render::{FilmSums, PreparedScene, internals};
use translucid_scene::Scene;
use translucid_testing::{cpu_seconds, write_measured};

/// Edge of the pictures in pixels.
const SIZE: u32 = 256;
/// Samples of a pixel in a measured picture.
const SAMPLES: u32 = 4;
/// Pictures of which the fastest counts.
const RUNS: u64 = 8;
/// Mean free path over the ball's diameter, where it is not what changes.
const USUAL_LENGTH: f32 = 0.01;
/// Triangles, where they are not what changes.
const USUAL_TRIANGLES: u64 = 100_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    let numbers = value("--triangles").map_or("1e4,1e5,1e6,1e7", String::as_str);
    let numbers = numbers.split(',').map(|text| text.parse::<f64>().expect("numbers of triangles") as u64);
    let tables = [by_triangles(numbers.collect()), by_length(), by_threads()].concat();
    println!("{tables}");
    if arguments.iter().any(|argument| argument == "--write") {
        write_measured(
            "docs/speed/scaling.md",
            "cargo bench -p translucid-workbench --bench scaling -- --write",
            &tables,
        );
    }
}

fn by_triangles(numbers: Vec<u64>) -> String {
    let mut text = String::from(
        "| triangles | prepare, CPU s | µs a triangle | render, CPU µs a sample | over the first |\n|---|---|---|---|---|\n",
    );
    let mut first = None;
    for triangles in numbers {
        let scene = scene(triangles, USUAL_LENGTH);
        let number = scene.objects[0].mesh.triangles.len();
        let start = cpu_seconds();
        let renderer = PreparedScene::new(scene).expect("a valid scene");
        let prepare = cpu_seconds() - start;
        let sample = Measured::of(&renderer).micros;
        let first = *first.get_or_insert(sample);
        let _ = writeln!(
            text,
            "| {number} | {prepare:.2} | {:.2} | {sample:.2} | {:.2} |",
            prepare * 1e6 / number as f64,
            sample / first
        );
    }
    text + "\n"
}

fn by_length() -> String {
    let mut text = String::from(
        "| mean free path over diameter | CPU µs a sample | … without sharing | relative variance of a sample | … without sharing | time to the same error over that without |\n|---|---|---|---|---|---|\n",
    );
    for length in [1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0, 10.0] {
        let shared =
            Measured::of(&PreparedScene::new(scene(USUAL_TRIANGLES, length)).expect("a valid scene"));
        let mut alone = scene(USUAL_TRIANGLES, length);
        alone.integrator.subsurface_sharing = false;
        let alone = Measured::of(&PreparedScene::new(alone).expect("a valid scene"));
        let _ = writeln!(
            text,
            "| {length:e} | {:.2} | {:.2} | {:.4} | {:.4} | {:.3} |",
            shared.micros,
            alone.micros,
            shared.variance,
            alone.variance,
            shared.micros * shared.variance / (alone.micros * alone.variance)
        );
    }
    text + "\n"
}

fn by_threads() -> String {
    let mut text =
        String::from("| threads | wall s | CPU s | faster by | of the threads |\n|---|---|---|---|---|\n");
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let renderer = PreparedScene::new(scene(USUAL_TRIANGLES, USUAL_LENGTH)).expect("a valid scene");
    let mut first = None;
    let mut threads = 1;
    while threads <= processors {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
        let once = || {
            let (wall, cpu) = (Instant::now(), cpu_seconds());
            pool.install(|| picture(&renderer, 4 * SAMPLES));
            (wall.elapsed().as_secs_f64(), cpu_seconds() - cpu)
        };
        let (wall, cpu) = (0..RUNS).map(|_| once()).min_by(|a, b| a.0.total_cmp(&b.0)).expect("some runs");
        let first = *first.get_or_insert(wall);
        let faster = first / wall;
        let _ = writeln!(
            text,
            "| {threads} | {wall:.2} | {cpu:.2} | {faster:.2} | {:.0} % |",
            100.0 * faster / threads as f64
        );
        threads *= 2;
    }
    text + "\n"
}

/// The cost and the noise of a scene's picture.
struct Measured {
    /// CPU µs of a sample of a pixel of the frame.
    micros: f64,
    /// Mean over the ball's pixels of the variance of a sample over the mean squared.
    variance: f64,
}

impl Measured {
    fn of(renderer: &PreparedScene) -> Self {
        let once = || {
            let start = cpu_seconds();
            picture(renderer, SAMPLES);
            cpu_seconds() - start
        };
        let seconds = (0..RUNS).map(|_| once()).fold(f64::INFINITY, f64::min);
        let samples = f64::from(SIZE * SIZE * SAMPLES);
        // Twice as many samples, of which the first half is known: two pictures that are independent but for the even
        // spread of samples within each
        let (half, whole) = (picture(renderer, SAMPLES), picture(renderer, 2 * SAMPLES));
        let (mut sum, mut count) = (0.0, 0.0);
        for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
            let light = |film: &FilmSums| film.radiance(x, y).iter().sum::<f64>();
            let (first, mean) = (light(&half), light(&whole));
            if mean > 0.0 {
                let second = 2.0 * mean - first;
                sum += 0.5 * (first - second).powi(2) / (mean * mean);
                count += 1.0;
            }
        }
        Self { micros: seconds * 1e6 / samples, variance: sum / count * f64::from(SAMPLES) }
    }
}

fn picture(renderer: &PreparedScene, samples: u32) -> FilmSums {
    let mut film = FilmSums::new(SIZE, SIZE);
    internals::add_samples(renderer, &mut film, samples).expect("a valid view");
    film
}

/// The ball with bumps, of about so many triangles, and a mean free path over its diameter.
fn scene(triangles: u64, length: f32) -> Scene {
    common::scene(common::bumpy_ball(triangles), 2.0 * length, SIZE)
}
