//! Error against CPU time on the head and the dragon of `scenes/`.
//!
//! ```text
//! cargo bench -p translucid-render --bench convergence [-- head dragon --reference-samples 1024 --model random-walk --alone]
//! ```
//!
//! Prints, for 1, 4, 16 and 64 samples per pixel, CPU seconds, CPU seconds per sample per pixel of the
//! whole frame, and the relative mean square error against an image of our own with at least 1,024
//! samples and another seed: relMSE = mean of (x − ref)² / (ref² + 0.01) over all channels of all pixels
//! that are not background. `--model` takes the place of the scenes' own model; `--alone` shares no light between pixels.
//! The meshes are not part of the project: where `../shared/assets` is absent, the bench says so and
//! skips.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::path::{Path, PathBuf};

use translucid_render::{FilmSums, PreparedScene, layer, measure};
use translucid_scene::{LoadOptions, Scene, SubsurfaceModel, load_scene};
use translucid_testing::cpu_seconds;

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
            None => println!("{}: skipped, ../shared/assets/{} is not there", case.name, case.mesh),
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
    let mesh = root().join("../shared/assets").join(case.mesh);
    if !mesh.is_file() {
        return None;
    }
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
    measure::add_samples(renderer, &mut film, samples).expect("a valid view");
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
