//! Error against CPU time on the head and the dragon of `scenes/`.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench convergence [-- --curve --write | head dragon --reference-samples 1024 --model random-walk --alone]
//! ```
//!
//! Prints, for 1, 4, 16 and 64 samples per pixel, CPU seconds, CPU seconds per sample per pixel of the
//! whole frame, and the relative mean square error against an image of our own with at least 1,024
//! samples and another seed: relMSE = mean of (x − ref)² / (ref² + 0.01) over all channels of all pixels
//! that are not background. `--model` takes the place of the scenes' own model; `--alone` shares no light between pixels.
//!
//! With `--curve` it prints the table of `docs/speed/noise.md` instead, which explains its columns: errors up to 4,096
//! samples, and how they fall. `--write` puts it there.
//!
//! The meshes are scans, which are not part of the project (`docs/inside/scans.md`). A mesh that is not there is skipped.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::path::{Path, PathBuf};

use translucid_load::{LoadOptions, load_scene};
use translucid_profile::Model;
use translucid_render::{FilmSums, PreparedScene, internals, layer};
use translucid_scene::{Film, Scene, SubsurfaceModel, WalkSurface};
use translucid_testing::{asset, cpu_seconds, write_measured};

struct Case {
    name: &'static str,
    scene: &'static str,
    mesh: &'static str,
}

const CASES: [Case; 2] = [
    Case { name: "head", scene: "scenes/head.toml", mesh: "head/head_70k.ply" },
    Case { name: "dragon", scene: "scenes/dragon.toml", mesh: "dragon/dragon_198k.ply" },
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    if arguments.iter().any(|a| a == "--curve") {
        return curve(arguments.iter().any(|a| a == "--write"));
    }
    let reference_samples = value("--reference-samples").and_then(|n| n.parse().ok()).unwrap_or(1024);
    let model = value("--model").map(|name| {
        SubsurfaceModel::from_name(name).unwrap_or_else(|| panic!("--model {name}: there is no such model"))
    });
    let chosen =
        |case: &Case| !arguments.iter().any(|a| is_case(a)) || arguments.iter().any(|a| a == case.name);
    for case in CASES.iter().filter(|case| chosen(case)) {
        match load(case, model) {
            Some(mut scene) => {
                scene.integrator.subsurface_sharing &= !arguments.iter().any(|a| a == "--alone");
                run(case, &scene, reference_samples);
            }
            None => println!("{}: skipped, {} is not in TRANSLUCID_ASSETS", case.name, case.mesh),
        }
    }
}

fn is_case(argument: &str) -> bool {
    CASES.iter().any(|case| case.name == argument)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn load(case: &Case, model: Option<SubsurfaceModel>) -> Option<Scene> {
    let mesh = asset(case.mesh)?;
    let options =
        LoadOptions { mesh_overrides: vec![(None, mesh)], subsurface_model: model, ..LoadOptions::default() };
    match load_scene(&root().join(case.scene), &options, &mut Vec::new()) {
        Ok(scene) => Some(scene),
        Err(error) => panic!("{error}"),
    }
}

fn run(case: &Case, scene: &Scene, reference_samples: u32) {
    let (width, height) = (scene.film.width, scene.film.height);
    let start = cpu_seconds();
    let renderer = PreparedScene::new(scene.clone()).expect("a valid scene");
    println!("{}: {width}×{height}, prepared in {:.2} CPU s", case.name, cpu_seconds() - start);
    let mut other_seed = scene.clone();
    other_seed.integrator.seed ^= 0x5eed;
    let (reference, seconds) =
        render(&PreparedScene::new(other_seed).expect("a valid scene"), width, height, reference_samples);
    println!("reference: {reference_samples} spp in {seconds:.0} CPU s");
    println!("| spp | CPU s | CPU s per sample per pixel of the frame | relMSE |");
    println!("|---|---|---|---|");
    for samples in [1, 4, 16, 64] {
        let (film, seconds) = render(&renderer, width, height, samples);
        let error = relative_mse(&film, &reference);
        println!("| {samples} | {seconds:.2} | {:.3} | {error:.3e} |", seconds / f64::from(samples));
    }
}

fn render(renderer: &PreparedScene, width: u32, height: u32, samples: u32) -> (FilmSums, f64) {
    let mut film = FilmSums::new(width, height);
    let start = cpu_seconds();
    internals::add_samples(renderer, &mut film, samples).expect("a valid view");
    (film, cpu_seconds() - start)
}

/// See the head of the file.
fn relative_mse(film: &FilmSums, reference: &FilmSums) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..film.height {
        for x in 0..film.width {
            if reference.mean(x, y)[layer::ALPHA] == 0.0 {
                continue;
            }
            for (value, truth) in film.radiance(x, y).into_iter().zip(reference.radiance(x, y)) {
                sum += (value - truth).powi(2) / (truth * truth + 0.01);
                count += 1.0;
            }
        }
    }
    sum / count
}

/// Edge of the curve's pictures in pixels, and the part of the whole picture's width that they show.
const CURVE_SIZE: u32 = 64;
const CURVE_PART: f32 = 1.0 / 3.0;
/// Powers of four up to the most samples.
const CURVE_STEPS: u32 = 7;
/// Pictures of each kind, each of its own seed.
const CURVE_SEEDS: u64 = 3;
/// Edge of the squares of pixels that are left out in turn for the error of a slope.
const SQUARE: u32 = 8;

/// Prints how errors fall with the number of samples.
fn curve(is_to_write: bool) {
    let oblique = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
    let kinds = [(oblique, true), (oblique, false), (SubsurfaceModel::RandomWalk(WalkSurface::Clear), true)];
    let curves: Option<Vec<Curve>> =
        kinds.iter().map(|&(model, shares)| Some(Curve::of(load(&CASES[0], Some(model))?, shares))).collect();
    let Some(curves) = curves else {
        return println!("skipped, {} is not in TRANSLUCID_ASSETS", CASES[0].mesh);
    };
    let mut table = String::from(
        "| samples | normalized-diffusion-oblique | the same without sharing | random-walk |\n|---|---|---|---|\n",
    );
    let mut row = |name: String, cell: &dyn Fn(&Curve) -> String| {
        let cells: Vec<String> = curves.iter().map(cell).collect();
        table.push_str(&format!("| {name} | {} |\n", cells.join(" | ")));
    };
    for step in 0..CURVE_STEPS {
        row(samples_at(step).to_string(), &|curve| format!("{:.3e}", curve.error(step, None)));
    }
    for first in [0, CURVE_STEPS / 2] {
        row(format!("slope from {} on", samples_at(first)), &|curve| {
            let (slope, error) = curve.slope(first);
            format!("{slope:.3} ± {error:.3}")
        });
    }
    println!("{table}");
    if is_to_write {
        let command = "cargo bench -p translucid-workbench --bench convergence -- --curve --write";
        write_measured("docs/speed/noise.md", command, &table);
    }
}

fn samples_at(step: u32) -> u32 {
    4_u32.pow(step)
}

/// Relative squared errors of a kind of pictures, summed over each square of pixels, by number of samples.
struct Curve {
    /// Sums by square, and numbers of terms.
    sums: Vec<Vec<f64>>,
    counts: Vec<f64>,
}

impl Curve {
    fn of(mut scene: Scene, shares: bool) -> Self {
        scene.film = Film { width: CURVE_SIZE, height: CURVE_SIZE, ..scene.film };
        scene.camera.projection = scene.camera.projection.widened(f64::from(CURVE_PART));
        scene.integrator.subsurface_sharing = shares;
        let of_seed = |seed| {
            let mut scene = scene.clone();
            scene.integrator.seed = seed;
            let prepared = PreparedScene::new(scene).expect("a valid scene");
            let mut film = FilmSums::new(CURVE_SIZE, CURVE_SIZE);
            let grown = (0..CURVE_STEPS).map(|step| {
                internals::add_samples(&prepared, &mut film, samples_at(step)).expect("a valid view");
                film.clone()
            });
            grown.collect::<Vec<_>>()
        };
        let films: Vec<Vec<FilmSums>> = (0..CURVE_SEEDS).map(of_seed).collect();
        let per_row = CURVE_SIZE / SQUARE;
        let squares = (per_row * per_row) as usize;
        let mut curve =
            Self { sums: vec![vec![0.0; squares]; CURVE_STEPS as usize], counts: vec![0.0; squares] };
        let n = CURVE_SEEDS as f64;
        for (x, y) in (0..CURVE_SIZE * CURVE_SIZE).map(|i| (i % CURVE_SIZE, i / CURVE_SIZE)) {
            let last = |films: &Vec<FilmSums>| films[films.len() - 1].mean(x, y)[layer::ALPHA];
            if films.iter().any(|films| last(films) == 0.0) {
                continue;
            }
            let square = (y / SQUARE * per_row + x / SQUARE) as usize;
            for channel in 0..3 {
                let mean =
                    |step: usize| films.iter().map(|f| f[step].radiance(x, y)[channel]).sum::<f64>() / n;
                let truth = mean(CURVE_STEPS as usize - 1);
                for (step, sums) in curve.sums.iter_mut().enumerate() {
                    let mean = mean(step);
                    let squared =
                        films.iter().map(|f| (f[step].radiance(x, y)[channel] - mean).powi(2)).sum::<f64>();
                    sums[square] += squared / (n - 1.0) / (truth * truth + 0.01);
                }
                curve.counts[square] += 1.0;
            }
        }
        curve
    }

    /// Mean relative squared error, without one of the squares if so asked.
    fn error(&self, step: u32, without: Option<usize>) -> f64 {
        let sums = &self.sums[step as usize];
        let kept = (0..sums.len()).filter(|square| Some(*square) != without);
        let (sum, count) = kept.fold((0.0, 0.0), |(s, n), i| (s + sums[i], n + self.counts[i]));
        sum / count
    }

    /// Slope of the error's logarithm over that of the number of samples by least squares, with its standard error
    /// (jackknife over squares).
    fn slope(&self, first: u32) -> (f64, f64) {
        let fitted = |without| {
            let points = (first..CURVE_STEPS)
                .map(|step| [f64::from(step) * 4.0_f64.ln(), self.error(step, without).ln()]);
            let n = f64::from(CURVE_STEPS - first);
            let [x, y] = points.clone().fold([0.0; 2], |[x, y], p| [x + p[0] / n, y + p[1] / n]);
            let [xx, xy] =
                points.fold([0.0; 2], |[xx, xy], p| [xx + (p[0] - x).powi(2), xy + (p[0] - x) * (p[1] - y)]);
            xy / xx
        };
        let squares: Vec<usize> = (0..self.counts.len()).filter(|i| self.counts[*i] > 0.0).collect();
        let n = squares.len() as f64;
        let slopes: Vec<f64> = squares.iter().map(|square| fitted(Some(*square))).collect();
        let mean = slopes.iter().sum::<f64>() / n;
        let variance = slopes.iter().map(|slope| (slope - mean).powi(2)).sum::<f64>() * (n - 1.0) / n;
        (fitted(None), variance.sqrt())
    }
}
