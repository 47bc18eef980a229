//! The total error, bias and noise, of profiles and of walks at equal CPU time: which model pictures should have by default.
//!
//! ```text
//! cargo bench -p translucid-workbench --bench total_error [-- dragon "slab 0.3" --size 192 --samples 32 --eta 1.4 --write]
//! ```
//!
//! Prints each walk's total error over those of the profiles, and all that they are made of; `--write` puts the table that
//! decides on the default into `docs/accuracy/total-error.md`, which explains it, if no scenes are named.
//! With `--eta` all materials have that index under their surface.
//! Every model makes two pictures a, of seeds of their own, and so does every truth t:
//!
//! ```text
//! noise of a sample   N (a₁ − a₂)²/2 / (ref² + 0.01)
//! bias²               ½ [(a₁ − t₁)(a₂ − t₂) + (a₁ − t₂)(a₂ − t₁)] / (ref² + 0.01)         ref = (t₁ + t₂)/2
//! total error         bias² + noise / samples that the CPU time buys
//! ```
//!
//! each the mean over all channels of all pixels that are not background. The products have no noise on average, as no
//! two of their factors share a picture; their standard error is that of the means of blocks of 16 × 16 pixels.
//! Scenes of scans that are not there are skipped (`docs/inside/scans.md`).

#![allow(clippy::print_stdout, reason = "the tables are the bench's output")]

use std::fmt::Write;
use std::path::Path;

use translucid_load::{LoadOptions, SceneFile, load_scene, still_life};
use translucid_profile::{Configuration, Model, Parameterization, d_from_surface_albedo};
use translucid_render::{FilmSums, PreparedScene, internals, layer};
use translucid_scene::{Integrator, Scene, SubsurfaceModel, WalkSurface};
use translucid_testing::{asset, cpu_seconds, write_measured};

/// The models that are compared; budgets are counted in samples of the first, the profile of scenes that ask for one and name
/// none.
type Models = [SubsurfaceModel; MODELS];
const MODELS: usize = 4;
const PROFILES: [usize; 2] = [0, 1];
/// The walks, each the truth for its own boundary.
const TRUTHS: [usize; 2] = [2, 3];
/// Samples of the first model whose CPU time all may take.
const BUDGETS: [f64; 3] = [16.0, 64.0, 256.0];
/// Edge of the blocks whose means give a standard error.
const BLOCK: u32 = 16;
/// Surface albedo of spheres and slabs.
const ALBEDO: f64 = 0.8;

/// Two profiles and two walks, of which the second is between matte surfaces; those that refract are rough.
fn models(eta: Option<f32>) -> Models {
    [
        SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined),
        SubsurfaceModel::RandomWalk(WalkSurface::Clear),
        SubsurfaceModel::RandomWalk(if eta.is_some() { WalkSurface::Rough } else { WalkSurface::Diffuse }),
    ]
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let value = |option: &str| arguments.get(arguments.iter().position(|a| a == option)? + 1);
    let number = |option, default| value(option).map_or(default, |n| n.parse().expect("a whole number"));
    let (size, samples) = (number("--size", 192), number("--samples", 32));
    let named = |case: &Case| arguments.contains(&case.name);
    let cases = cases();
    let is_chosen = |case: &&Case| !cases.iter().any(named) || named(case);
    let eta = value("--eta").map(|eta| eta.parse().expect("a number"));
    let models = models(eta);
    let start = cpu_seconds();
    let mut results = Vec::new();
    for case in cases.iter().filter(is_chosen) {
        match case.load(size, eta) {
            Some(scene) => results.push((case.name.as_str(), Findings::of(&scene, &models, samples))),
            None => println!("{}: skipped, its mesh is not in TRANSLUCID_ASSETS", case.name),
        }
    }
    let tables = summary(&models, &results);
    println!("{}\n{}", tables.join("\n"), details(&models, &results));
    println!("{size} pixels wide, {samples} samples, {:.0} CPU s", cpu_seconds() - start);
    if arguments.iter().any(|argument| argument == "--write") {
        assert_eq!(results.len(), cases.len(), "the document has all scenes");
        let of_eta = eta.map_or(String::new(), |eta| format!("--eta {eta} "));
        write_measured(
            "docs/accuracy/total-error.md",
            &format!("cargo bench -p translucid-workbench --bench total_error -- {of_eta}--write"),
            if eta.is_some() { &tables[2] } else { &tables[0] },
        );
    }
}

/// A scene by the name that the tables have for it.
struct Case {
    name: String,
    source: Source,
}

enum Source {
    /// A file of `scenes/` whose object is a scan.
    Mesh {
        scene: &'static str,
        mesh: &'static str,
    },
    /// A file of `scenes/` that finds its mesh and textures in a folder of the scans.
    Folder {
        scene: &'static str,
        folder: &'static str,
    },
    StillLife,
    /// The text of a scene file.
    Text(String),
}

fn cases() -> Vec<Case> {
    let case = |name: &str, source| Case { name: name.into(), source };
    let mut cases = vec![
        case("head", Source::Mesh { scene: "head.toml", mesh: "head/head_70k.ply" }),
        case("ear", Source::Folder { scene: "head-ear.toml", folder: "head" }),
        case("dragon", Source::Mesh { scene: "dragon.toml", mesh: "dragon/dragon_198k.ply" }),
        case("still life", Source::StillLife),
    ];
    cases.extend(
        [0.02, 0.08, 0.3].map(|length| case(&format!("sphere {length}"), Source::Text(sphere(length)))),
    );
    cases.extend(
        [(0.08, 13.0), (0.17, 4.5), (0.3, 3.0)]
            .map(|(width, radiance)| case(&format!("slab {width}"), Source::Text(slab(width, radiance)))),
    );
    cases
}

impl Case {
    /// The scene in a picture of this width, with this index under all surfaces or the scene's own; `None` where its mesh is
    /// missing.
    fn load(&self, width: u32, eta: Option<f32>) -> Option<Scene> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let sized = |size: [u32; 2]| LoadOptions { size: Some(size), ..LoadOptions::default() };
        let loaded = match &self.source {
            Source::Mesh { scene, mesh } => {
                let options = LoadOptions { mesh_overrides: vec![(None, asset(mesh)?)], ..sized([width; 2]) };
                load_scene(&folder.join(scene), &options, &mut Vec::new())
            }
            Source::Folder { scene, folder: assets } => {
                let beside = asset(assets)?;
                let text = std::fs::read_to_string(folder.join(scene)).expect("a scene of the repository");
                SceneFile::parse(&text, &beside.join(scene))
                    .and_then(|file| file.load(&sized([width, width * 5 / 4]), &mut Vec::new()))
            }
            Source::StillLife => still_life(&sized([width * 5 / 4, width * 5 / 4 * 9 / 16])),
            Source::Text(text) => SceneFile::parse(text, Path::new("scene.toml"))
                .and_then(|file| file.load(&sized([width; 2]), &mut Vec::new())),
        };
        let mut scene = loaded.unwrap_or_else(|error| panic!("{error}"));
        // Some of the files limit paths
        scene.integrator = Integrator::default();
        if let Some(eta) = eta {
            scene.materials.iter_mut().for_each(|material| material.subsurface_eta = eta);
        }
        Some(scene)
    }
}

/// A sphere of this mean free path over its radius, before a window and a dim sky.
fn sphere(length: f64) -> String {
    format!(
        "{}
[camera]
position = [0, 0, 8]
target = [0, 0, 0]
fov = 17
[[object]]
shape = \"sphere\"
radius = 1
material = \"wax\"
[[light]]
type = \"rectangle\"
center = [-4, 4, 3]
target = [0, 0, 0]
size = [3, 3]
radiance = 8
visible = false
[environment]
radiance = 0.1
visible = false
",
        wax(length)
    )
}

/// A slab of thickness 1, whose profile has this width d, before a lamp as wide as half of it, which is so bright that the
/// middle comes out at about 0.5.
fn slab(width: f64, radiance: f64) -> String {
    let width_of_length = d_from_surface_albedo(ALBEDO, 1.0, Parameterization::Mfp, Configuration::Diffuse);
    format!(
        "{}
[camera]
position = [0, 0, 30]
target = [0, 0, 0]
fov = 23
[[object]]
shape = \"box\"
width = 12
height = 12
depth = 1
edge_radius = 0
material = \"wax\"
[[light]]
type = \"rectangle\"
center = [0, 0, -3]
target = [0, 0, 0]
size = [6, 6]
radiance = {radiance}
visible = false
",
        wax(width / width_of_length)
    )
}

fn wax(length: f64) -> String {
    format!(
        "unit = \"cm\"
[[material]]
name = \"wax\"
specular_weight = 0
subsurface_weight = 1
subsurface_color = {ALBEDO}
subsurface_radius = {length}
subsurface_radius_scale = 1
"
    )
}

/// Noise, bias and cost of all models in a scene.
struct Findings {
    /// Noise of a sample of each model over the light of each truth, with its standard error.
    noise: [[(f64, f64); MODELS]; TRUTHS.len()],
    /// Bias² of each model against each truth, with its standard error.
    bias: [[(f64, f64); MODELS]; TRUTHS.len()],
    /// CPU time of a sample, over that of the first model.
    cost: [f64; MODELS],
}

/// Two pictures of a model, with the CPU time they took \[s\].
struct Pair {
    films: [FilmSums; 2],
    seconds: f64,
}

impl Findings {
    fn of(scene: &Scene, models: &Models, samples: u32) -> Self {
        let renderers: [[PreparedScene; 2]; MODELS] = std::array::from_fn(|m| {
            [0, 1].map(|picture| {
                let mut scene = scene.clone();
                scene.materials.iter_mut().for_each(|material| material.subsurface_model = models[m]);
                // No two pictures of any models share their random numbers
                scene.integrator.seed = 1 + 2 * m as u64 + picture;
                PreparedScene::new(scene).expect("a valid scene")
            })
        });
        let (width, height) = (scene.film.width, scene.film.height);
        let mut pairs: Vec<Pair> = models
            .iter()
            .map(|_| Pair { films: [0, 1].map(|_| FilmSums::new(width, height)), seconds: 0.0 })
            .collect();
        // In turns, as the machine may have other work
        for part in 1..=4 {
            for (pair, renderers) in pairs.iter_mut().zip(&renderers) {
                let start = cpu_seconds();
                for (film, renderer) in pair.films.iter_mut().zip(renderers) {
                    internals::add_samples(renderer, film, (samples * part).div_ceil(4))
                        .expect("a valid view");
                }
                pair.seconds += cpu_seconds() - start;
            }
        }
        let against = |truth: usize, model: usize| {
            let (truth, pair) = (&pairs[truth].films, &pairs[model].films);
            let samples = f64::from(samples);
            let noise = mean(truth, |p| 0.5 * samples * (p.a(pair, 0) - p.a(pair, 1)).powi(2));
            let bias = mean(truth, |p| {
                let off = |a: usize, t: usize| p.a(pair, a) - p.a(truth, t);
                0.5 * (off(0, 0) * off(1, 1) + off(0, 1) * off(1, 0))
            });
            (noise, bias)
        };
        let found: [[_; MODELS]; TRUTHS.len()] =
            TRUTHS.map(|truth| std::array::from_fn(|model| against(truth, model)));
        Self {
            noise: found.map(|models| models.map(|(noise, _)| noise)),
            bias: std::array::from_fn(|t| {
                std::array::from_fn(|m| if TRUTHS[t] == m { (0.0, 0.0) } else { found[t][m].1 })
            }),
            cost: std::array::from_fn(|m| pairs[m].seconds / pairs[0].seconds),
        }
    }

    /// Total error of a model against a truth, in the CPU time of so many samples of the default.
    fn total(&self, truth: usize, model: usize, budget: f64) -> f64 {
        self.bias[truth][model].0.max(0.0) + self.noise[truth][model].0 * self.cost[model] / budget
    }
}

/// A channel of a pixel.
struct Place {
    x: u32,
    y: u32,
    channel: usize,
}

impl Place {
    fn a(&self, films: &[FilmSums; 2], number: usize) -> f64 {
        films[number].radiance(self.x, self.y)[self.channel]
    }
}

/// Mean of a quantity over ref² + 0.01 where the truth is not background, and its standard error.
fn mean(truth: &[FilmSums; 2], quantity: impl Fn(&Place) -> f64) -> (f64, f64) {
    let (width, height) = (truth[0].width, truth[0].height);
    let mut blocks = Vec::new();
    for top in (0..height).step_by(BLOCK as usize) {
        for left in (0..width).step_by(BLOCK as usize) {
            let (mut sum, mut count) = (0.0, 0.0);
            for y in top..(top + BLOCK).min(height) {
                for x in left..(left + BLOCK).min(width) {
                    if truth[0].mean(x, y)[layer::ALPHA] == 0.0 {
                        continue;
                    }
                    for channel in 0..3 {
                        let place = Place { x, y, channel };
                        let reference = 0.5 * (place.a(truth, 0) + place.a(truth, 1));
                        sum += quantity(&place) / (reference * reference + 0.01);
                        count += 1.0;
                    }
                }
            }
            blocks.push((sum, count));
        }
    }
    let count: f64 = blocks.iter().map(|(_, count)| count).sum();
    let mean = blocks.iter().map(|(sum, _)| sum).sum::<f64>() / count;
    let squares: f64 = blocks.iter().map(|(sum, count)| (sum - mean * count).powi(2)).sum();
    (mean, squares.sqrt() / count)
}

/// For each walk its total error over those of the profiles in the same time, held against itself, and for a rough one also
/// against the other.
fn summary(models: &Models, results: &[(&str, Findings)]) -> Vec<String> {
    let columns: Vec<(usize, f64)> =
        PROFILES.iter().flat_map(|&p| BUDGETS.map(|budget| (p, budget))).collect();
    let mut walks = vec![(0, TRUTHS[0]), (1, TRUTHS[1])];
    if models[TRUTHS[1]] == SubsurfaceModel::RandomWalk(WalkSurface::Rough) {
        walks.push((0, TRUTHS[1]));
    }
    let table = |(t, walk): (usize, usize)| {
        let mut text = String::new();
        let budgets = BUDGETS.map(|samples| format!("{samples}")).join(" | ");
        let heads = PROFILES.map(|profile| format!("over `{}`: {budgets}", models[profile].name()));
        let truth = format!(", held against `{}`", models[TRUTHS[t]].name());
        let truth = if walk == TRUTHS[t] { "" } else { &truth };
        let _ = writeln!(text, "| `{}`{truth} | {} |", models[walk].name(), heads.join(" | "));
        let _ = writeln!(text, "|---|{}", "---|".repeat(columns.len()));
        let ratio = |findings: &Findings, (profile, budget)| {
            findings.total(t, walk, budget) / findings.total(t, profile, budget)
        };
        for (name, findings) in results {
            let ratios = columns.iter().map(|&column| format!("{:.2}", ratio(findings, column)));
            let _ = writeln!(text, "| {name} | {} |", ratios.collect::<Vec<_>>().join(" | "));
        }
        let middles = columns.iter().map(|&column| {
            let sum: f64 = results.iter().map(|(_, findings)| ratio(findings, column).ln()).sum();
            format!("{:.2}", (sum / results.len() as f64).exp())
        });
        let _ = writeln!(text, "| geometric mean | {} |", middles.collect::<Vec<_>>().join(" | "));
        text
    };
    walks.into_iter().map(table).collect()
}

fn details(models: &Models, results: &[(&str, Findings)]) -> String {
    let budgets = BUDGETS.map(|samples| format!("{samples}")).join(" | ");
    let mut text = String::from("| scene | model | CPU |");
    for truth in TRUTHS {
        let _ = write!(text, " `{}`: noise | bias² | {budgets} |", models[truth].name());
    }
    let _ = writeln!(text, "\n|---|---|---|{}", "---|".repeat(TRUTHS.len() * (2 + BUDGETS.len())));
    for (name, result) in results {
        for (m, model) in models.iter().enumerate() {
            let _ = write!(text, "| {name} | `{}` | {:.2} |", model.name(), result.cost[m]);
            for (t, &truth) in TRUTHS.iter().enumerate() {
                let (bias, error) = result.bias[t][m];
                let bias = if truth == m { String::from("–") } else { format!("{bias:.5} ± {error:.5}") };
                let totals = BUDGETS.map(|budget| format!("{:.5}", result.total(t, m, budget))).join(" | ");
                let (noise, deviation) = result.noise[t][m];
                let _ = write!(text, " {noise:.3} ± {deviation:.3} | {bias} | {totals} |");
            }
            text.push('\n');
        }
    }
    text
}
