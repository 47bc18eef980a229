//! Worth and cost of sharing light between the pixels of a block.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench sharing [-- CASE…] [--write]
//! ```
//!
//! Prints the table of `docs/speed/how-fast.md`, which explains its columns; `--write` puts it there.
//! Planes and balls are made here. Head and dragon are scans, and left out where they are not
//! there (`docs/inside/scans.md`).

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

mod common;

use std::fmt::Write;
use std::path::Path;

use common::{DISTANCE, FIELD_OF_VIEW, bumpy_ball, scene};
use glam::Vec3;
use translucid_load::{LoadOptions, load_scene, still_life};
use translucid_profile::Model;
use translucid_render::{FilmSums, PreparedScene, internals};
use translucid_scene::{ColorInput, Light, Mesh, Scene, SubsurfaceModel, WalkSurface};
use translucid_testing::{asset, cpu_seconds, write_measured};

/// Model of the still life, which names none.
const PROFILE: SubsurfaceModel = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
/// Edge of the pictures in pixels.
const SIZE: u32 = 192;
/// Samples of a pixel in a picture.
const SAMPLES: u32 = 16;
/// Pictures, each of its own seed.
const PICTURES: u64 = 8;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&String> = arguments.iter().filter(|argument| !argument.starts_with("--")).collect();
    let is_wanted = |name: &str| words.is_empty() || words.iter().any(|word| name.contains(word.as_str()));
    let mut table = String::from(
        "| scene | CPU µs a sample | … without sharing | relative variance | … without sharing | variance over that without | time to the same error over that without |\n|---|---|---|---|---|---|---|\n",
    );
    for (name, scene) in cases() {
        let Some(scene) = scene.filter(|_| is_wanted(&name)) else { continue };
        let [shared, alone] = measured(&scene);
        let variance = shared.variance / alone.variance;
        let _ = writeln!(
            table,
            "| {name} | {:.2} | {:.2} | {:.2e} | {:.2e} | {variance:.3} | {:.2} |",
            shared.micros,
            alone.micros,
            shared.variance,
            alone.variance,
            variance * shared.micros / alone.micros,
        );
    }
    println!("{table}");
    if arguments.iter().any(|argument| argument == "--write") {
        write_measured(
            "docs/speed/how-fast.md",
            "cargo bench -p translucid-workbench --bench sharing -- --write",
            &table,
        );
    }
}

/// Cost and noise of a scene's pictures.
struct Measured {
    /// CPU µs of a sample of a pixel of the frame.
    micros: f64,
    /// Mean over the pixels and channels of the variance of a picture over the mean squared, but for what is dark.
    variance: f64,
}

/// With sharing and without, in turns.
fn measured(scene: &Scene) -> [Measured; 2] {
    let mut films: [Vec<FilmSums>; 2] = Default::default();
    let mut seconds = [f64::INFINITY; 2];
    for (seed, shares) in (0..PICTURES).flat_map(|seed| [(seed, true), (seed, false)]) {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        scene.integrator.subsurface_sharing = shares;
        let prepared = PreparedScene::new(scene).expect("a valid scene");
        let mut film = FilmSums::new(SIZE, SIZE);
        let start = cpu_seconds();
        internals::add_samples(&prepared, &mut film, SAMPLES).expect("a valid view");
        let which = usize::from(!shares);
        seconds[which] = seconds[which].min(cpu_seconds() - start);
        films[which].push(film);
    }
    [0, 1].map(|which| Measured {
        micros: seconds[which] * 1e6 / f64::from(SIZE * SIZE * SAMPLES),
        variance: relative_variance(&films[which]),
    })
}

fn relative_variance(films: &[FilmSums]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    let n = films.len() as f64;
    for (x, y, c) in (0..SIZE * SIZE * 3).map(|i| (i / 3 % SIZE, i / 3 / SIZE, (i % 3) as usize)) {
        let values = films.iter().map(|film| film.radiance(x, y)[c]);
        let mean = values.clone().sum::<f64>() / n;
        if mean > 0.0 {
            let variance = values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
            sum += variance / (mean * mean + 1e-4);
            count += 1.0;
        }
    }
    sum / count
}

/// Names and scenes, but for those whose meshes are not there.
fn cases() -> Vec<(String, Option<Scene>)> {
    let mut cases = Vec::new();
    for (pixels, lamp) in [(50.0, 0.0), (10.0, 0.0), (3.0, 0.0), (10.0, 0.1), (10.0, 1.0)] {
        let light = match lamp {
            0.0 => "even light",
            1.0 => "a lamp",
            _ => "even light and a tenth of a lamp",
        };
        let name = format!("plane under {light}, mean free path of {pixels} pixels");
        cases.push((name, Some(lit_plane(pixels, lamp))));
    }
    for length in [1e-3, 1e-2, 0.03, 0.1, 1.0] {
        let name = format!("ball with bumps, mean free path of {length} diameters");
        cases.push((name, Some(scene(bumpy_ball(100_000), 2.0 * length, SIZE))));
    }
    for length in [1e-2, 0.1] {
        let mut mesh = bumpy_ball(100_000);
        mesh.positions.iter_mut().for_each(|p| *p = p.normalize());
        cases.push((
            format!("smooth ball, mean free path of {length} diameters"),
            Some(scene(mesh, 2.0 * length, SIZE)),
        ));
    }
    for (name, is_colored) in [("a rough walk", false), ("a rough walk and vertex colors", true)] {
        cases.push((format!("ball with bumps, {name}"), Some(walked_ball(is_colored))));
    }
    cases.push(("still life".into(), load("still-life", None)));
    cases.push(("head".into(), load("head", Some("head/head_70k.ply"))));
    cases.push(("dragon".into(), load("dragon", Some("dragon/dragon_198k.ply"))));
    cases
}

/// A ball that is walked through, with one color or with a spotted pattern of colors like that of skin.
fn walked_ball(is_colored: bool) -> Scene {
    let mut mesh = bumpy_ball(100_000);
    if is_colored {
        let spotted = |p: &Vec3| {
            let wave =
                (9.0 * p.x).sin() * (7.0 * p.y + 1.0).sin() + 0.5 * (40.0 * p.z).sin() * (37.0 * p.x).sin();
            Vec3::new(0.8, 0.6, 0.4) * (1.0 + wave * Vec3::new(0.12, 0.2, 0.25))
        };
        mesh.colors = mesh.positions.iter().map(spotted).collect();
    }
    let mut scene = scene(mesh, 0.2, SIZE);
    let material = &mut scene.materials[0];
    material.subsurface_model = SubsurfaceModel::RandomWalk(WalkSurface::Rough);
    if is_colored {
        material.subsurface_color = ColorInput::vertex();
    }
    scene
}

/// A plane with a mean free path of so many pixels, that so much of the light comes to from a lamp.
fn lit_plane(pixels: f32, lamp: f32) -> Scene {
    let pixel = 2.0 * DISTANCE * (0.5 * FIELD_OF_VIEW).to_radians().tan() / SIZE as f32;
    let mesh = Mesh {
        positions: [[-1e3, -1e3], [1e3, -1e3], [1e3, 1e3], [-1e3, 1e3]]
            .map(|[x, y]| Vec3::new(x, y, 0.0))
            .to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let mut scene = scene(mesh, pixels * pixel, SIZE);
    scene.environment.as_mut().expect("a sky").radiance = Vec3::splat(1.0 - lamp);
    scene.lights = vec![Light::Rectangle {
        center: Vec3::new(3.0, -2.0, DISTANCE),
        edge_x: Vec3::Y,
        edge_y: Vec3::X,
        radiance: Vec3::splat(10.0 * lamp),
        visible: false,
    }];
    scene.camera.position = DISTANCE * Vec3::Z;
    scene.camera.up = Vec3::Y;
    scene
}

fn load(name: &str, mesh: Option<&str>) -> Option<Scene> {
    let mesh = match mesh {
        Some(mesh) => Some(asset(mesh)?),
        None => None,
    };
    let options = LoadOptions {
        size: Some([SIZE; 2]),
        subsurface_model: mesh.is_none().then_some(PROFILE),
        mesh_overrides: mesh.map(|mesh| (None, mesh)).into_iter().collect(),
        ..LoadOptions::default()
    };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"));
    let scene = match name {
        "still-life" => still_life(&options),
        _ => load_scene(&file, &options, &mut Vec::new()),
    };
    Some(scene.expect("a scene of ours"))
}
