//! The cost of one to ten thousand lights: a light tree beside the selection by power alone and beside weighing every light
//! at every point.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench lights
//!     [-- --lights 1,10,100 --samples 16 --seeds 4 --reference-samples 512 --write]
//! ```
//!
//! The scene is made here: three translucid balls on the floor of a hall with two walls, and lamps of four kinds
//! (spheres, rectangles, spots, emissive triangles) whose powers spread over two decades and sum to the same for any
//! number of lamps.
//! For each number of lamps and each way of selection the bench prints CPU time for a sample of a pixel, relMSE against
//! a converged image (mean of (x − ref)² / (ref² + 0.01) over channels, pixels and seeds), and their product relative
//! to that of the selection by power: the time to the same error.
//! The ways take turns, seed by seed, on one thread.
//! A second table has the time of single calls, in nanoseconds, from random points of the hall.
//! `--write` puts the first into `docs/speed/many-lights.md`.

#![allow(clippy::print_stdout, reason = "the tables are the bench's output")]

use std::hint::black_box;

use glam::{Mat3, Vec3};
use translucid_profile::Model;
use translucid_render::internals::{EmissiveTriangle, LightSelection, LightSet};
use translucid_render::{FilmSums, PreparedScene, internals};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, Projection,
    ScalarInput, Scene, SubsurfaceModel, Unit,
};
use translucid_shapes::{ShapeParameters, build_shape};
use translucid_testing::{SplitMix, cpu_seconds, write_measured};

/// Total power of all lamps (per channel).
const POWER: f32 = 4000.0;

/// Pixels of the picture.
const SIZE: [u32; 2] = [64, 48];

/// More lamps than this are not weighed one by one.
const MOST_WEIGHED: usize = 1000;

struct Options {
    lights: Vec<usize>,
    samples: u32,
    seeds: u64,
    reference_samples: u32,
    write: bool,
}

impl Options {
    fn new() -> Self {
        let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
        let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
        let number = |option, default| value(option).and_then(|n| n.parse().ok()).unwrap_or(default);
        let list = value("--lights").map(|list| list.split(',').filter_map(|n| n.parse().ok()).collect());
        Self {
            lights: list.unwrap_or_else(|| vec![1, 10, 100, 1000, 10_000]),
            samples: number("--samples", 16),
            seeds: u64::from(number("--seeds", 4)),
            reference_samples: number("--reference-samples", 512),
            write: arguments.iter().any(|a| a == "--write"),
        }
    }
}

fn main() {
    let options = Options::new();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread pool");
    let pictures = pool.install(|| {
        let pictures = pictures(&options);
        calls(&options);
        pictures
    });
    if options.write {
        let command = format!(
            "cargo bench -p translucid-workbench --bench lights -- --seeds {} --reference-samples {} --write",
            options.seeds, options.reference_samples
        );
        write_measured("docs/speed/many-lights.md", &command, &pictures);
    }
}

/// Numbers that depend on the lamp only.
struct Numbers(SplitMix);

impl Numbers {
    fn of(seed: u64) -> Self {
        Self(SplitMix(seed))
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.0.uniform_f32()
    }
}

/// The scene with its triangles that emit.
fn hall(lamps: usize) -> Scene {
    let matte = |color: f32| Material {
        base_color: ColorInput::constant(Vec3::splat(color)),
        specular_weight: ScalarInput::constant(0.0),
        ..Material::default()
    };
    let wax = Material {
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.7, 0.5)),
        subsurface_radius: ScalarInput::constant(0.2),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        ..Material::default()
    };
    let ball = build_shape("sphere", &ShapeParameters::new()).expect("a sphere is built in");
    let balls = [-2.5, 0.0, 2.5].map(|x| (Mesh { ..ball.clone() }, Vec3::new(x, 0.0, 1.0)));
    let mut objects: Vec<Object> = Vec::new();
    for (mut mesh, place) in balls {
        let (low, high) = mesh.bounds();
        let (center, scale) = (low.midpoint(high), 2.0 / (high.x - low.x));
        mesh.positions.iter_mut().for_each(|p| *p = (*p - center) * scale + place);
        objects.push(object(mesh, 0, objects.len() as u32));
    }
    let mut quads = Mesh::default();
    add_quad(&mut quads, Vec3::ZERO, Vec3::X * 11.0, Vec3::Y * 11.0);
    add_quad(&mut quads, Vec3::new(0.0, 4.0, 2.0), Vec3::X * 9.0, Vec3::Z * 2.0);
    add_quad(&mut quads, Vec3::new(-6.0, -3.0, 2.0), Vec3::Y * 5.0, Vec3::Z * 2.0);
    objects.push(object(quads, 1, 3));
    let (lights, shards, radiance) = lamps_of(lamps);
    objects.push(object(shards, 2, 4));
    let shining = Material { emission_luminance: radiance, ..matte(0.0) };
    Scene {
        unit: Unit::Centimeter,
        camera: Camera {
            position: Vec3::new(1.0, -9.0, 4.0),
            target: Vec3::new(0.0, 0.0, 0.8),
            up: Vec3::Z,
            projection: Projection::Perspective { horizontal_fov: 50.0 },
            focus_distance: 9.0,
            ..Camera::default()
        },
        film: Film { width: SIZE[0], height: SIZE[1], ..Film::default() },
        integrator: Integrator::default(),
        objects,
        materials: vec![wax, matte(0.6), shining],
        images: Vec::new(),
        profile_tables: Vec::new(),
        lights,
        environment: Some(Environment {
            radiance: Vec3::splat(0.02),
            image: None,
            world_from_environment: Mat3::IDENTITY,
            visible: false,
        }),
        ..Scene::default()
    }
}

fn object(mesh: Mesh, material: usize, subsurface_group: u32) -> Object {
    Object {
        name: format!("object {subsurface_group}"),
        mesh: mesh.into(),
        material,
        subsurface_group,
        ..Object::default()
    }
}

fn add_quad(mesh: &mut Mesh, center: Vec3, x: Vec3, y: Vec3) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend([center - x - y, center + x - y, center + x + y, center - x + y]);
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// Lamps all over the hall at heights of 0.5 to 4: lights, a mesh of emissive triangles and its radiance.
fn lamps_of(count: usize) -> (Vec<Light>, Mesh, f32) {
    let share = |numbers: &mut Numbers| 10.0_f32.powf(numbers.between(-1.0, 1.0));
    let total: f32 = (0..count).map(|i| share(&mut Numbers::of(i as u64 * 1000))).sum();
    // Triangles differ in area, whose mean is 0.01.
    let radiance = POWER / (count as f32 * 0.01 * std::f32::consts::PI);
    let (mut lights, mut shards) = (Vec::new(), Mesh::default());
    for index in 0..count {
        let mut numbers = Numbers::of(index as u64 * 1000);
        let power = POWER * share(&mut numbers) / total;
        let place =
            Vec3::new(numbers.between(-10.0, 10.0), numbers.between(-10.0, 10.0), numbers.between(2.2, 4.0));
        let down = Vec3::new(numbers.between(-0.7, 0.7), numbers.between(-0.7, 0.7), -1.0).normalize();
        let (x, y) = down.any_orthonormal_pair();
        // x × y = down
        let color = Vec3::new(1.0, 0.9, 0.7);
        match index % 4 {
            0 => {
                let radius = 0.04;
                let radiance = color * (power / (4.0 * std::f32::consts::PI.powi(2) * radius * radius));
                lights.push(Light::Sphere { center: place, radius, radiance, visible: true });
            }
            1 => {
                let radiance = color * (power / (std::f32::consts::PI * 0.02));
                let (edge_x, edge_y) = (x * 0.1, y * 0.2);
                lights.push(Light::Rectangle { center: place, edge_x, edge_y, radiance, visible: true });
            }
            2 => {
                let outer_angle = numbers.between(30.0, 70.0);
                let cap = std::f32::consts::TAU * (1.0 - outer_angle.to_radians().cos());
                lights.push(Light::Spot {
                    radius: 0.0,
                    visible: true,
                    position: place,
                    direction: down,
                    intensity: color * (power / cap),
                    inner_angle: 0.7 * outer_angle,
                    outer_angle,
                });
            }
            _ => {
                let side = (2.0 * power / (std::f32::consts::PI * radiance)).sqrt();
                let first = shards.positions.len() as u32;
                shards.positions.extend([place, place + x * side, place + y * side]);
                shards.triangles.push([first, first + 1, first + 2]);
            }
        }
    }
    (lights, shards, radiance)
}

fn name(way: LightSelection) -> &'static str {
    match way {
        LightSelection::Power => "by power",
        LightSelection::Weighed => "every light weighed",
        LightSelection::Tree => "tree",
        LightSelection::Automatic => "automatic",
    }
}

/// The ways of selection that are tried; that by power alone needs more than a few lights.
fn ways(lamps: usize) -> Vec<LightSelection> {
    let mut ways = vec![LightSelection::Power];
    if (31..=MOST_WEIGHED).contains(&lamps) {
        ways.push(LightSelection::Weighed);
    }
    ways.push(LightSelection::Tree);
    ways
}

fn pictures(options: &Options) -> String {
    let mut table = format!(
        "| lights | selection | CPU µs a sample | relMSE at {} | time to the same error |\n|---|---|---|---|---|\n",
        options.samples
    );
    print!("{table}");
    for &lamps in &options.lights {
        let scene = hall(lamps);
        let seeded = |seed: u64| {
            let mut scene = scene.clone();
            scene.integrator.seed = seed;
            PreparedScene::new(scene).expect("a valid scene")
        };
        let reference = render(&seeded(0xface), options.reference_samples).0;
        let ways = ways(lamps);
        let mut totals = vec![(0.0, 0.0); ways.len()];
        for seed in 0..options.seeds {
            for (way, total) in ways.iter().zip(&mut totals) {
                let mut renderer = seeded(seed);
                internals::select_lights(&mut renderer, *way);
                let (film, seconds) = render(&renderer, options.samples);
                *total = (total.0 + seconds, total.1 + relative_mse(&film, &reference));
            }
        }
        let samples = options.seeds as f64 * f64::from(options.samples * SIZE[0] * SIZE[1]);
        for (way, (seconds, error)) in ways.iter().zip(&totals) {
            let relative = seconds * error / (totals[0].0 * totals[0].1);
            // Few lights are weighed one by one where more go by their power.
            let few = *way == LightSelection::Power && lamps <= 31;
            let row = format!(
                "| {lamps} | {} | {:.2} | {:.2e} | {relative:.3} |\n",
                if few { name(LightSelection::Weighed) } else { name(*way) },
                1e6 * seconds / samples,
                error / options.seeds as f64,
            );
            print!("{row}");
            table += &row;
        }
    }
    table
}

/// Prints the times of single calls.
fn calls(options: &Options) {
    println!(
        "\n| lights | selection | prepare ms | sample ns | density ns | ray ns |\n|---|---|---|---|---|---|"
    );
    for &lamps in &options.lights {
        let scene = hall(lamps);
        let shards = &scene.objects[4].mesh;
        let triangles: Vec<EmissiveTriangle> = (0..shards.triangles.len())
            .map(|index| EmissiveTriangle {
                vertices: shards.triangles[index].map(|corner| shards.positions[corner as usize]),
                radiance: Vec3::splat(scene.materials[2].emission_luminance),
                primitive: index as u64,
            })
            .collect();
        let bounds = (Vec3::new(-11.0, -11.0, 0.0), Vec3::new(11.0, 11.0, 4.0));
        let lights = LightSet::new(&scene, triangles, bounds);
        for way in ways(lamps) {
            let start = cpu_seconds();
            let mut rounds = 0;
            while rounds == 0 || cpu_seconds() - start < 0.3 {
                black_box(lights.clone().with_selection(way));
                rounds += 1;
            }
            let prepare = (cpu_seconds() - start) / f64::from(rounds);
            let lights = lights.clone().with_selection(way);
            let mut numbers = Numbers::of(1);
            let mut receiver = || {
                let point = Vec3::new(
                    numbers.between(-10.0, 10.0),
                    numbers.between(-10.0, 10.0),
                    numbers.between(0.0, 2.0),
                );
                let [a, b, c] = std::array::from_fn(|_| numbers.0.uniform_f32());
                let normal = Vec3::new(a - 0.5, b - 0.5, c).normalize_or(Vec3::Z);
                (point, normal, [numbers.0.uniform_f32(), numbers.0.uniform_f32(), numbers.0.uniform_f32()])
            };
            let receivers: Vec<_> = (0..4096).map(|_| receiver()).collect();
            let sample = nanoseconds(&receivers, |&(point, normal, [u, a, b])| {
                black_box(lights.sample(point, normal, u, [a, b]));
            });
            let density = nanoseconds(&receivers, |&(point, normal, _)| {
                black_box(lights.environment_pdf(point, normal, normal));
            });
            let ray = nanoseconds(&receivers, |&(point, normal, _)| {
                black_box(lights.intersect(point, normal, 30.0));
            });
            let few = way == LightSelection::Power && lamps <= 31;
            let label = if few { name(LightSelection::Weighed) } else { name(way) };
            println!("| {lamps} | {label} | {:.2} | {sample:.0} | {density:.0} | {ray:.0} |", 1e3 * prepare);
        }
    }
}

/// Mean CPU time of a call over at least half a second.
fn nanoseconds<T>(inputs: &[T], mut call: impl FnMut(&T)) -> f64 {
    let start = cpu_seconds();
    let mut rounds = 0_u32;
    while cpu_seconds() - start < 0.5 {
        inputs.iter().for_each(&mut call);
        rounds += 1;
    }
    1e9 * (cpu_seconds() - start) / (f64::from(rounds) * inputs.len() as f64)
}

fn render(renderer: &PreparedScene, samples: u32) -> (FilmSums, f64) {
    let mut film = FilmSums::new(SIZE[0], SIZE[1]);
    let start = cpu_seconds();
    internals::add_samples(renderer, &mut film, samples).expect("a valid view");
    (film, cpu_seconds() - start)
}

/// See the head of the file.
fn relative_mse(film: &FilmSums, reference: &FilmSums) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for y in 0..film.height {
        for x in 0..film.width {
            for (value, truth) in film.radiance(x, y).into_iter().zip(reference.radiance(x, y)) {
                sum += (value - truth).powi(2) / (truth * truth + 0.01);
                count += 1.0;
            }
        }
    }
    sum / count
}
