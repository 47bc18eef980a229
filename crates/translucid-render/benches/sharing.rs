//! What sharing light between the pixels of a block is worth, and where it costs.
//!
//! ```text
//! cargo bench -p translucid-render --bench sharing [-- CASE…] [--write]
//! ```
//!
//! Prints the table of `docs/speed/how-fast.md`, which says what its columns are; `--write` puts it there.
//! The even plane and the ball are made here; the still life's wall is a part of `scenes/still-life.toml`.
//! Head and dragon are left out where `../shared/assets` is absent.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::f32::consts::{PI, TAU};
use std::fmt::Write;
use std::path::{Path, PathBuf};

use glam::{Mat3, Vec3};
use translucid_profile::Model;
use translucid_render::{FilmSums, PreparedScene, measure};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, LoadOptions, Material, Mesh, Object,
    ScalarInput, Scene, SubsurfaceModel, Unit, load_scene,
};
use translucid_testing::cpu_seconds;

/// Edge of the pictures in pixels.
const SIZE: u32 = 192;
/// Samples of a pixel in a picture.
const SAMPLES: u32 = 16;
/// Pictures, each of its own seed.
const PICTURES: u64 = 4;
/// Field of view in degrees, and the camera's distance.
const FIELD_OF_VIEW: f32 = 22.0;
const DISTANCE: f32 = 6.0;

const BEGIN: &str = "<!-- measured: cargo bench -p translucid-render --bench sharing -- --write -->";
const END: &str = "<!-- end of what was measured -->";

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut wanted = arguments.iter().filter(|argument| !argument.starts_with("--")).peekable();
    let is_wanted = |name: &str, wanted: &[&String]| {
        wanted.is_empty() || wanted.iter().any(|w| name.contains(w.as_str()))
    };
    let mut table = String::from(
        "| scene | CPU µs a sample | … without sharing | relative variance | … without sharing | variance over that without | time to the same error over that without |\n|---|---|---|---|---|---|---|\n",
    );
    let wanted: Vec<&String> = wanted.by_ref().collect();
    for (name, scene) in cases() {
        let Some(scene) = scene.filter(|_| is_wanted(&name, &wanted)) else { continue };
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
        write(&table);
    }
}

/// Puts the table between the marks of the document.
fn write(table: &str) {
    let path = root().join("docs/speed/how-fast.md");
    let document = std::fs::read_to_string(&path).expect("a document");
    let marks = document.split_once(BEGIN).and_then(|(head, rest)| Some((head, rest.split_once(END)?.1)));
    let (head, tail) = marks.expect("marks in the document");
    std::fs::write(&path, format!("{head}{BEGIN}\n\n{table}\n{END}{tail}")).expect("a document to write");
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// What a scene's pictures cost and are worth.
#[derive(Default)]
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
        measure::add_samples(&prepared, &mut film, SAMPLES).expect("a valid view");
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
    let colored = Vec3::new(1.0, 0.6, 0.4);
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
        cases.push((name, Some(scene(bumpy_ball(100_000), 2.0 * length, colored))));
    }
    for length in [1e-2, 0.1] {
        let mut mesh = bumpy_ball(100_000);
        mesh.positions.iter_mut().for_each(|p| *p = p.normalize());
        cases.push((
            format!("smooth ball, mean free path of {length} diameters"),
            Some(scene(mesh, 2.0 * length, colored)),
        ));
    }
    cases.push(("still life".into(), load("still-life", None)));
    cases.push(("head".into(), load("head", Some("head/head_70k.ply"))));
    cases.push(("dragon".into(), load("dragon", Some("dragon/dragon_198k.ply"))));
    cases
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
    let mut scene = scene(mesh, pixels * pixel, Vec3::new(1.0, 0.6, 0.4));
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
    let mesh: Option<PathBuf> = mesh.map(|mesh| root().join("../shared/assets").join(mesh));
    if mesh.as_ref().is_some_and(|mesh| !mesh.is_file()) {
        return None;
    }
    let options = LoadOptions {
        mesh_overrides: mesh.map(|mesh| (None, mesh)).into_iter().collect(),
        size: Some([SIZE; 2]),
        ..LoadOptions::default()
    };
    let file = root().join("scenes").join(format!("{name}.toml"));
    Some(load_scene(&file, &options, &mut Vec::new()).expect("a scene of ours"))
}

/// A mesh with a mean free path \[L\], by channel, under a lamp and a sky.
fn scene(mesh: Mesh, length: f32, scale: Vec3) -> Scene {
    let material = Material {
        name: "wax".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.8, 0.6, 0.4)),
        subsurface_radius: ScalarInput::constant(length),
        subsurface_radius_scale: ColorInput::constant(scale),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusion),
        ..Material::default()
    };
    Scene {
        unit: Unit::Centimeter,
        camera: Camera {
            position: Vec3::new(0.0, -DISTANCE, 1.0),
            target: Vec3::ZERO,
            up: Vec3::Z,
            horizontal_fov: FIELD_OF_VIEW,
            lens_radius: 0.0,
            focus_distance: DISTANCE,
        },
        film: Film { width: SIZE, height: SIZE, ..Film::default() },
        integrator: Integrator::default(),
        objects: vec![Object { name: "ball".into(), mesh: mesh.into(), material: 0, subsurface_group: 0 }],
        materials: vec![material],
        images: Vec::new(),
        profile_tables: Vec::new(),
        lights: vec![Light::Rectangle {
            center: Vec3::new(4.0, -2.0, 4.0),
            edge_x: Vec3::new(-0.5, 0.7, 0.8),
            edge_y: Vec3::new(0.45, 0.42, -0.086),
            radiance: Vec3::splat(20.0),
            visible: false,
        }],
        environment: Some(Environment {
            radiance: Vec3::splat(0.2),
            image: None,
            world_from_environment: Mat3::IDENTITY,
            visible: false,
        }),
    }
}

fn bumpy_ball(triangles: u64) -> Mesh {
    let rows = ((triangles as f64 / 4.0).sqrt().round() as u32).max(4);
    let columns = 2 * rows;
    let mut mesh = Mesh::default();
    for (i, j) in (0..=rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let (theta, phi) = (PI * i as f32 / rows as f32, TAU * j as f32 / columns as f32);
        let bump = 0.04 * (11.0 * theta).sin() * (9.0 * phi).sin() * theta.sin();
        let direction = Vec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
        mesh.positions.push(direction * (0.96 + bump));
    }
    for (i, j) in (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))) {
        let (a, b) = (i * columns + j, i * columns + (j + 1) % columns);
        if i > 0 {
            mesh.triangles.push([a, a + columns, b]);
        }
        if i + 1 < rows {
            mesh.triangles.push([b, a + columns, b + columns]);
        }
    }
    mesh
}
