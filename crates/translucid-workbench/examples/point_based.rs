//! How point-based subsurface scattering converges to the ray-traced, and what it costs.
//!
//! ```text
//! cargo run --release -p translucid-workbench --example point_based [-- bust still-life head --size 24 --reference 16384]
//! ```
//!
//! Prints a table for each scene and model: number of points, CPU seconds of both passes and of the picture, and
//! the error against a ray-traced picture with many samples and another seed:
//! relMSE = mean of (x − ref)² / (ref² + 0.01) over all channels of the pixels that show a surface, of light from
//! under surfaces alone (the layer `subsurface`), because that is what the method computes.
//! The reference is the mean of two pictures; a quarter of the relMSE of one against the other is its noise, below
//! which no error can be told.
//! A picture of few pixels with many samples separates the error of the method from the noise of pixels.
//! Below the points' rows stand ray-traced pictures, to compare CPU time at equal error.
//! Mean free paths are longer than in the files of the scenes, so that the points of all tolerances are made in minutes.
//! Paths may be long here (`max_depth` 64): where they end early, points are lit by as many events as a surface that
//! is seen directly, and probes in a reflection by fewer.
//! The head is a scan, and left out where it is not there (`docs/inside/scans.md`).

#![allow(clippy::print_stdout, reason = "the table is the example's output")]

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use translucid_image::DisplayTransform;
use translucid_load::{LoadOptions, load_scene, still_life};
use translucid_profile::Model;
use translucid_render::{FilmSums, ImageInfo, PointPass, PreparedScene, internals, layer};
use translucid_scene::{Scene, SubsurfaceMethod, SubsurfaceModel};
use translucid_testing::{asset, cpu_seconds};

const MODELS: [Model; 2] = [Model::NormalizedDiffusion, Model::NormalizedDiffusionRefined];
const TOLERANCES: [f32; 3] = [0.8, 0.2, 0.05];
/// Samples of the ray-traced pictures that are compared at equal error.
const RAY_TRACED: [u32; 3] = [64, 1024, 4096];
const MEMORY: u64 = 8 << 30;

/// The scenes, and the factor on their mean free paths: as if the bust were 4 cm high, the head 6 cm.
const SCENES: [(&str, f32); 3] = [("bust", 5.0), ("still-life", 4.0), ("head", 4.0)];

struct Options {
    scenes: Vec<String>,
    size: u32,
    reference: u32,
    samples: u32,
    pictures: Option<PathBuf>,
}

fn main() {
    let options = options();
    for name in &options.scenes {
        for model in MODELS {
            match load(name, model, options.size) {
                Some(scene) => compare(name, model, &scene, &options),
                None => println!("{name}: left out, its mesh is not in TRANSLUCID_ASSETS"),
            }
        }
    }
}

fn options() -> Options {
    let mut options =
        Options { scenes: Vec::new(), size: 24, reference: 16384, samples: 1024, pictures: None };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || arguments.next().and_then(|n| n.parse().ok()).expect("a number after the option");
        match argument.as_str() {
            "--size" => options.size = number(),
            "--reference" => options.reference = number(),
            "--samples" => options.samples = number(),
            "--pictures" => options.pictures = arguments.next().map(PathBuf::from),
            _ => options.scenes.push(argument),
        }
    }
    if options.scenes.is_empty() {
        options.scenes = SCENES.map(|(name, _)| String::from(name)).to_vec();
    }
    options
}

fn load(name: &str, model: Model, size: u32) -> Option<Scene> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut options = LoadOptions {
        size: Some([size, size]),
        subsurface_model: Some(SubsurfaceModel::Profile(model)),
        ..LoadOptions::default()
    };
    let mut scene = match name {
        "bust" => load_scene(&root.join("scenes/marble.toml"), &options, &mut Vec::new()),
        "still-life" => still_life(&options),
        "head" => {
            options.mesh_overrides = vec![(None, asset("head/head_70k.ply")?)];
            load_scene(&root.join("scenes/head.toml"), &options, &mut Vec::new())
        }
        _ => panic!("the scenes are bust, still-life and head"),
    }
    .unwrap_or_else(|error| panic!("{error}"));
    let factor = SCENES.iter().find(|(known, _)| *known == name).map_or(1.0, |(_, factor)| *factor);
    for material in &mut scene.materials {
        material.subsurface_radius.factor *= factor;
    }
    scene.integrator.max_depth = 64;
    scene.integrator.max_diffuse_depth = 64;
    scene.integrator.subsurface_tail = 1e-5;
    Some(scene)
}

fn compare(name: &str, model: Model, scene: &Scene, options: &Options) {
    let triangles: usize = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
    println!("\n### {name}, {model}, {triangles} triangles, {0}×{0} pixels\n", options.size);
    let ray_traced = PreparedScene::new(scene.clone()).expect("a valid scene");
    let other_seed = |seed| {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        render(&PreparedScene::new(scene).expect("a valid scene"), options.reference / 2).0
    };
    let halves = [other_seed(0x5eed), other_seed(0xfeed)];
    let floor = relative_mse(&halves[0], &subsurface(&halves[1])) / 4.0;
    let reference: Vec<[f64; 3]> = subsurface(&halves[0])
        .iter()
        .zip(subsurface(&halves[1]))
        .map(|(a, b)| std::array::from_fn(|c| 0.5 * (a[c] + b[c])))
        .collect();
    println!("Noise of the reference ({} samples a pixel): {floor:.1e}.\n", options.reference);
    println!("| method | points | pass 1, CPU s | pass 2, CPU s | picture, CPU s | all, CPU s | relMSE |");
    println!("|---|---|---|---|---|---|---|");
    for tolerance in TOLERANCES {
        let mut scene = scene.clone();
        scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
        scene.integrator.point_tolerance = tolerance;
        point_based(scene, &reference, options, &format!("{name}-{model}-{tolerance}"));
    }
    for samples in RAY_TRACED {
        let (film, seconds) = render(&ray_traced, samples);
        let error = relative_mse(&film, &reference);
        println!("| ray-traced, {samples} samples | – | – | – | {seconds:.1} | {seconds:.1} | {error:.2e} |");
        save(&film, scene, options, &format!("{name}-{model}-ray-traced-{samples}"));
    }
}

/// A row of the table.
fn point_based(scene: Scene, reference: &[[f64; 3]], options: &Options, name: &str) {
    let tolerance = scene.integrator.point_tolerance;
    let mut renderer = PreparedScene::new(scene).expect("a valid scene");
    let start = cpu_seconds();
    let second_pass = std::sync::OnceLock::new();
    let report = |progress: translucid_render::PointProgress| {
        if progress.pass == PointPass::Irradiance {
            second_pass.get_or_init(cpu_seconds);
        }
    };
    let view = renderer.view().expect("a valid view");
    let made = renderer.make_points(&view, MEMORY, &report, &AtomicBool::new(false));
    let end = cpu_seconds();
    let points = match made {
        Ok(Some(points)) => points,
        Ok(None) => return,
        Err(error) => return println!("| point-based, {tolerance} | {error} |"),
    };
    let middle = *second_pass.get().unwrap_or(&end);
    let count = points.len();
    renderer.set_points(&points);
    let (film, seconds) = render(&renderer, options.samples);
    let error = relative_mse(&film, reference);
    println!(
        "| point-based, {tolerance}, {} samples | {count} | {:.1} | {:.1} | {seconds:.1} | {:.1} | {error:.2e} |",
        options.samples,
        middle - start,
        end - middle,
        end - start + seconds,
    );
    save(&film, renderer.scene(), options, name);
}

fn render(renderer: &PreparedScene, samples: u32) -> (FilmSums, f64) {
    let film = &renderer.scene().film;
    let mut sums = FilmSums::new(film.width, film.height);
    let start = cpu_seconds();
    internals::add_samples(renderer, &mut sums, samples).expect("a valid view");
    (sums, cpu_seconds() - start)
}

/// Light from under surfaces, pixel by pixel; NaN where no surface is.
fn subsurface(film: &FilmSums) -> Vec<[f64; 3]> {
    let pixels = (0..film.height).flat_map(|y| (0..film.width).map(move |x| (x, y)));
    let light = |(x, y)| {
        let mean = film.mean(x, y);
        let is_surface = mean[layer::SURFACE] > 0.0;
        std::array::from_fn(|c| if is_surface { mean[layer::SUBSURFACE.start + c] } else { f64::NAN })
    };
    pixels.map(light).collect()
}

/// See the head of the file.
fn relative_mse(film: &FilmSums, reference: &[[f64; 3]]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (value, truth) in subsurface(film).iter().flatten().zip(reference.iter().flatten()) {
        if value.is_finite() && truth.is_finite() {
            sum += (value - truth).powi(2) / (truth * truth + 0.01);
            count += 1.0;
        }
    }
    sum / count
}

fn save(film: &FilmSums, scene: &Scene, options: &Options, name: &str) {
    let Some(directory) = &options.pictures else { return };
    let info = ImageInfo {
        scene: name.to_owned(),
        seed: scene.integrator.seed,
        samples: film.samples(),
        command: String::from("example point_based"),
        ..ImageInfo::default()
    };
    let path = directory.join(format!("{name}.png"));
    let display = DisplayTransform { exposure: scene.film.exposure, tone_mapping: scene.film.tone_mapping };
    film.display_picture(&info).save_png(&path, display).unwrap_or_else(|error| panic!("{error}"));
}
