//! Time from nothing to the first pixels, stage by stage.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench startup [-- still-life head dragon dragon-870k spheres busts --runs 7 --shapes]
//! ```
//!
//! For the built-in still life, a thousand spheres, a hundred busts and, where the scans are there (`docs/inside/scans.md`), for the
//! scenes of a head and of a dragon, prints the wall time and the CPU time of loading, of preparing and of the first sample of each pixel at
//! 96×54, on all processors, and what the tables of the materials alone take.
//! Each figure is the least of `--runs` runs, which are in one process, whose most memory so far is that of a scene only
//! where it is the first; `--shapes` adds each shape of the still life.
//! A process's own start and the writing of the picture (a few milliseconds) are not in it.

#![allow(clippy::print_stdout, reason = "the table is the bench's output")]

use std::collections::HashSet;
use std::fs;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use translucid_load::{LoadOptions, SceneFile, load_scene, still_life};
use translucid_profile::Model;
use translucid_render::internals::bsdf::MaterialTables;
use translucid_render::{FilmSums, PreparedScene, internals};
use translucid_scene::{Scene, SubsurfaceModel};
use translucid_shapes::{ShapeParameters, build_shape, shape_names};
use translucid_testing::asset;

/// A scene by name.
struct Case {
    name: &'static str,
    source: Source,
}

/// Where a scene comes from.
enum Source {
    StillLife,
    /// A file, and the mesh that goes into it.
    Files([&'static str; 2]),
    /// So many of a shape, each an object of its own, so far apart.
    Many(&'static str, u32, f32),
}

const CASES: [Case; 6] = [
    Case { name: "still-life", source: Source::StillLife },
    Case { name: "head", source: Source::Files(["scenes/head.toml", "head/head_70k.ply"]) },
    Case { name: "dragon", source: Source::Files(["scenes/dragon.toml", "dragon/dragon_198k.ply"]) },
    Case { name: "dragon-870k", source: Source::Files(["scenes/dragon.toml", "dragon/dragon_870k.ply"]) },
    Case { name: "spheres", source: Source::Many("sphere", 1000, 3.0) },
    Case { name: "busts", source: Source::Many("bust", 100, 40.0) },
];

/// Wall and CPU seconds.
#[derive(Clone, Copy)]
struct Cost {
    wall: f64,
    cpu: f64,
}

impl Cost {
    const NONE: Self = Self { wall: f64::INFINITY, cpu: f64::INFINITY };

    fn least(self, other: Self) -> Self {
        Self { wall: self.wall.min(other.wall), cpu: self.cpu.min(other.cpu) }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let runs =
        arguments.iter().position(|a| a == "--runs").and_then(|at| arguments.get(at + 1)?.parse().ok());
    let runs: usize = runs.unwrap_or(5).max(1);
    let is_case = |argument: &String| CASES.iter().any(|case| case.name == argument);
    let any = arguments.iter().any(is_case);
    println!(
        "| scene | triangles | load | prepare | first pixels | wall in all | CPU in all | tables of materials | peak memory |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for case in CASES.iter().filter(|case| !any || arguments.iter().any(|a| a == case.name)) {
        match options(case) {
            Some(options) => run(case, &options, runs),
            None => println!("| {} | its mesh is not there |", case.name),
        }
    }
    if arguments.iter().any(|a| a == "--shapes") {
        shapes(runs);
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// How to load a case; none where its mesh is not there.
fn options(case: &Case) -> Option<LoadOptions> {
    let profile = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
    let mut options = LoadOptions {
        size: Some([96, 54]),
        subsurface_model: matches!(case.source, Source::StillLife).then_some(profile),
        ..LoadOptions::default()
    };
    if let Source::Files([_, mesh]) = case.source {
        options.mesh_overrides = vec![(None, asset(mesh)?)];
    }
    Some(options)
}

fn load(case: &Case, options: &LoadOptions) -> Scene {
    let scene = match case.source {
        Source::Files([file, _]) => load_scene(&root().join(file), options, &mut Vec::new()),
        Source::StillLife => still_life(options),
        Source::Many(shape, count, step) => {
            let text = many(shape, count, step);
            SceneFile::parse(&text, Path::new("many.toml"))
                .and_then(|file| file.load(options, &mut Vec::new()))
        }
    };
    scene.unwrap_or_else(|error| panic!("{error}"))
}

/// A scene file of a square of equal shapes of marble, each turned otherwise.
fn many(shape: &str, count: u32, step: f32) -> String {
    let side = count.isqrt().max(1);
    let object = |i: u32| {
        let (x, z) = ((i % side) as f32 * step, (i / side) as f32 * step);
        format!(
            "[[object]]\nshape = \"{shape}\"\nmaterial = \"marble\"\ntranslate = [{x:?}, 0, {z:?}]\nrotate = [0, {}, 0]\n",
            37 * i % 360
        )
    };
    let material = "unit = \"cm\"\n[[material]]\nname = \"marble\"\npreset = \"marble\"\n";
    format!("{material}{}", (0..count).map(object).collect::<String>())
}

fn run(case: &Case, options: &LoadOptions, runs: usize) {
    let [mut loading, mut preparing, mut rendering, mut tables, mut all] = [Cost::NONE; 5];
    let mut triangles = 0;
    for _ in 0..runs {
        let start = now();
        let scene = load(case, options);
        let loaded = now();
        triangles = scene.objects.iter().map(|object| object.mesh.triangles.len()).sum();
        let renderer = PreparedScene::new(scene).expect("a valid scene");
        let prepared = now();
        let film = &renderer.scene().film;
        let mut film = FilmSums::new(film.width, film.height);
        internals::add_samples(&renderer, &mut film, 1).expect("a valid view");
        let rendered = now();
        loading = loading.least(between(start, loaded));
        preparing = preparing.least(between(loaded, prepared));
        rendering = rendering.least(between(prepared, rendered));
        all = all.least(between(start, rendered));
        tables = tables.least(cost_of_tables(renderer.scene()));
        black_box(film);
    }
    println!(
        "| {} | {triangles} | {} | {} | {} | {:.0} ms | {:.0} ms | {} | {:.0} MB |",
        case.name,
        cell(loading),
        cell(preparing),
        cell(rendering),
        1e3 * all.wall,
        1e3 * all.cpu,
        cell(tables),
        peak_memory() as f64 * 1e-6
    );
}

/// Cost of the directional albedos of all distinct pairs of indices.
fn cost_of_tables(scene: &Scene) -> Cost {
    let mut known = HashSet::new();
    let start = now();
    for material in &scene.materials {
        if known.insert([material.specular_ior, material.coat_ior].map(f32::to_bits)) {
            black_box(MaterialTables::new(material.specular_ior, material.coat_ior));
        }
    }
    between(start, now())
}

/// Most memory that the process has had, in bytes; 0 where the system does not report it.
fn peak_memory() -> u64 {
    let kilobytes = |text: String| -> Option<u64> {
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.split_whitespace().next()?.parse().ok()
    };
    fs::read_to_string("/proc/self/status").ok().and_then(kilobytes).map_or(0, |kb| kb * 1024)
}

fn shapes(runs: usize) {
    println!("\n| shape | triangles | wall | CPU |\n|---|---|---|---|");
    for name in shape_names() {
        let mut cost = Cost::NONE;
        let mut triangles = 0;
        for _ in 0..runs {
            let start = now();
            let mesh = build_shape(name, &ShapeParameters::new()).unwrap_or_else(|error| panic!("{error}"));
            cost = cost.least(between(start, now()));
            triangles = mesh.triangles.len();
        }
        println!("| {name} | {triangles} | {:.1} ms | {:.1} ms |", 1e3 * cost.wall, 1e3 * cost.cpu);
    }
}

/// Wall time, and in brackets CPU time.
fn cell(cost: Cost) -> String {
    format!("{:.0} ms ({:.0})", 1e3 * cost.wall, 1e3 * cost.cpu)
}

/// A moment, and the CPU seconds of all threads up to it.
fn now() -> (Instant, f64) {
    (Instant::now(), cpu_seconds())
}

fn between(start: (Instant, f64), end: (Instant, f64)) -> Cost {
    Cost { wall: (end.0 - start.0).as_secs_f64(), cpu: end.1 - start.1 }
}

/// CPU time of all threads there are, up to the last tick of the system (a few milliseconds ago); NaN where it does not
/// tell.
fn cpu_seconds() -> f64 {
    let Ok(threads) = fs::read_dir("/proc/self/task") else { return f64::NAN };
    let nanoseconds = |thread: fs::DirEntry| -> Option<f64> {
        let text = fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    threads.flatten().filter_map(nanoseconds).sum::<f64>() * 1e-9
}
