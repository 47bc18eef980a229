//! The random walk against an independent volumetric path tracer, Mitsuba 3, sixteenth by sixteenth of the picture.
//!
//! The built-in bust is compared in every checkout: `benches/measure/truth.py` has written how bright it is, with standard
//! errors. Head and dragon are scans, whose truth is pictures: see [`scans`].
//! Each sixteenth's mean here is that of sixteen pictures with seeds of their own, which give its standard error.
//! Means of bust and truth count as equal within five standard errors of their difference: by Student's t with fifteen
//! degrees of freedom a false alarm in 6,000, and one in 130 over all comparisons. A mean free path that is a tenth longer
//! fails, and so does a surface albedo that is 0.01 higher.

#![allow(clippy::print_stdout, reason = "--nocapture shows what was found")]

use std::fs::read_to_string;
use std::path::{Path, PathBuf};

use glam::{DVec3, Vec3};
use translucid_load::{LoadOptions, load_scene};
use translucid_render::{FilmSums, layer};
use translucid_scene::Scene;

use crate::common::{pictures, prepare};

/// Pictures of a scene, each of a seed.
const SEEDS: u64 = 16;
/// Regions along each edge of the picture.
const ACROSS: usize = 4;

/// Mean radiance of a region, and its standard error.
#[derive(Clone, Copy)]
struct Brightness {
    mean: Vec3,
    error: Vec3,
}

/// Brightness of the regions of a scene's picture, with so much `light` in each pixel.
fn rendered(scene: &Scene, samples: u32, light: impl Fn(&FilmSums, usize, usize) -> Vec3) -> Vec<Brightness> {
    let size = [scene.film.width, scene.film.height].map(|pixels| pixels as usize);
    let means = |film: FilmSums| regions(size, |x, y| light(&film, x, y));
    let renderings: Vec<Vec<Vec3>> =
        pictures(&prepare(scene.clone()), 0..SEEDS, samples).into_iter().map(means).collect();
    let brightness = |region: usize| {
        let mean = renderings.iter().map(|means| means[region]).sum::<Vec3>() / SEEDS as f32;
        let squares = renderings.iter().map(|means| (means[region] - mean).powf(2.0)).sum::<Vec3>();
        Brightness { mean, error: (squares / (SEEDS * (SEEDS - 1)) as f32).map(f32::sqrt) }
    };
    (0..ACROSS * ACROSS).map(brightness).collect()
}

/// All the light of a pixel.
fn radiance(film: &FilmSums, x: usize, y: usize) -> Vec3 {
    DVec3::from_array(film.radiance(x as u32, y as u32)).as_vec3()
}

/// Means over the regions of a picture of so many pixels.
fn regions(size: [usize; 2], pixel: impl Fn(usize, usize) -> Vec3) -> Vec<Vec3> {
    let [width, height] = size.map(|pixels| pixels / ACROSS);
    let mean = |region: usize| {
        let (left, top) = (region % ACROSS * width, region / ACROSS * height);
        let sum: Vec3 = (0..width * height).map(|i| pixel(left + i % width, top + i / width)).sum();
        sum / (width * height) as f32
    };
    (0..ACROSS * ACROSS).map(mean).collect()
}

/// Asserts that regions are as bright as in truth, within five standard errors and a share of the truth, and the whole
/// picture within another share.
fn assert_as_bright(found: &[Brightness], truth: &[Brightness], share: f32, share_of_all: f32) {
    let (mut compared, mut wrong) = (0, Vec::new());
    for (region, (found, truth)) in found.iter().zip(truth).enumerate() {
        for c in 0..3 {
            let allowed = 5.0 * found.error[c].hypot(truth.error[c]) + share * truth.mean[c];
            let off = found.mean[c] - truth.mean[c];
            if off.abs() > allowed + 1e-5 {
                wrong.push(format!(
                    "region {region}, channel {c}: {} is not {}",
                    found.mean[c], truth.mean[c]
                ));
            }
            compared += u32::from(allowed < 0.2 * truth.mean[c]);
        }
    }
    let total = |regions: &[Brightness]| regions.iter().map(|region| region.mean).sum::<Vec3>();
    let ratio = total(found) / total(truth);
    println!("{compared} means of regions; whole picture over the truth's: {ratio}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(compared > 15, "too noisy to tell: {compared}");
    assert!((ratio - 1.0).abs().max_element() < share_of_all, "{ratio}");
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// The bust of the truth.
fn bust() -> Scene {
    load_scene(&data("bust.toml"), &LoadOptions::default(), &mut Vec::new()).unwrap()
}

/// Content of the file that `benches/measure/truth.py` writes.
fn bust_truth() -> Vec<Brightness> {
    let text = read_to_string(data("bust-truth.csv")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with(|first: char| first.is_ascii_digit()));
    let brightness = |row: &str| {
        let numbers: Vec<f32> = row.split(',').map(|number| number.parse().unwrap()).collect();
        Brightness { mean: Vec3::from_slice(&numbers[2..5]), error: Vec3::from_slice(&numbers[5..8]) }
    };
    rows.map(brightness).collect()
}

#[test]
fn bust_agrees_with_an_independent_renderer() {
    assert_as_bright(&rendered(&bust(), 32, radiance), &bust_truth(), 0.0, 0.012);
}

/// Meshes and pictures that are not part of the project.
///
/// The truth's own noise is unknown. Each region counts as right within five standard errors and 1.5 % of the truth, whose
/// noise is in that; pixels of the truth that outshine all their neighbors are left out of both.
mod scans {
    use exr::prelude::*;
    use translucid_profile::roots::falling_root;
    use translucid_profile::{Configuration, Model, half_space_surface_albedo};
    use translucid_scene::{ColorInput, Integrator, SubsurfaceModel, WalkSurface};
    use translucid_testing::scan;

    use super::*;

    /// Pixels of the picture here, and of the truth's for each of them.
    const SIZE: usize = 128;
    const BLOCK: usize = 4;

    /// The truth's relation of A and α, H. C. van de Hulst, *Multiple Light Scattering*, 1980:
    /// A = (1 − s)(1 − 0.139 s)/(1 + 1.17 s), s = √(1 − α); the surface albedo here of the same α.
    fn same_medium(surface_albedo: f32) -> f32 {
        let of_root = |s: f64| (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
        let target = f64::from(surface_albedo);
        let s = falling_root(|s| of_root(s) - target, [1.0 - target, -target], |_| 1e-12);
        half_space_surface_albedo(1.0 - s * s, Configuration::Diffuse) as f32
    }

    /// A scene walked through, in the truth's medium.
    fn walked(scene: &str, mesh: &str) -> Scene {
        let options = LoadOptions {
            mesh_overrides: vec![(None, scan(mesh))],
            size: Some([SIZE as u32; 2]),
            subsurface_model: Some(SubsurfaceModel::RandomWalk(WalkSurface::Clear)),
            ..LoadOptions::default()
        };
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(scene);
        let mut scene = load_scene(&file, &options, &mut Vec::new()).unwrap();
        for material in &mut scene.materials {
            let color = &mut material.subsurface_color;
            *color = ColorInput::constant(Vec3::from_array(color.factor.to_array().map(same_medium)));
        }
        // The truth has no such limits
        scene.integrator.max_depth = 64;
        scene.integrator.max_diffuse_depth = 32;
        scene
    }

    /// The truth's pixels, averaged to those of the picture here.
    fn truth(file: &str) -> Vec<Vec3> {
        let image = read_first_rgba_layer_from_file(
            scan("truth").join(file),
            |size, _| vec![vec![Vec3::ZERO; size.width()]; size.height()],
            |rows: &mut Vec<Vec<Vec3>>, at, (r, g, b, _): (f32, f32, f32, f32)| {
                rows[at.y()][at.x()] = Vec3::new(r, g, b);
            },
        )
        .unwrap();
        let rows = image.layer_data.channel_data.pixels;
        let pixel = |x: usize, y: usize| {
            let inside = 0..BLOCK * BLOCK;
            let sum: Vec3 = inside.map(|i| rows[y * BLOCK + i / BLOCK][x * BLOCK + i % BLOCK]).sum();
            sum / (BLOCK * BLOCK) as f32
        };
        (0..SIZE * SIZE).map(|i| pixel(i % SIZE, i / SIZE)).collect()
    }

    /// Tells whether a pixel outshines all its neighbors by far: a single path of the truth's that met a light by great luck.
    fn is_speck(pixels: &[Vec3], x: usize, y: usize) -> bool {
        let brightness = |x: usize, y: usize| pixels[y * SIZE + x].max_element();
        let neighbors = (y.saturating_sub(1)..=(y + 1).min(SIZE - 1))
            .flat_map(|j| (x.saturating_sub(1)..=(x + 1).min(SIZE - 1)).map(move |i| (i, j)));
        let others = neighbors.filter(|&at| at != (x, y));
        brightness(x, y) > 4.0 * others.map(|(i, j)| brightness(i, j)).fold(0.0, f32::max)
    }

    fn compare(scene: &Scene, truth: &[Vec3], samples: u32) {
        let counts = |x, y| !is_speck(truth, x, y);
        // Here a hidden lamp or sky is seen through a body as through glass; in the truth it is not
        let light = |film: &FilmSums, x, y| {
            let straight = &film.mean(x as u32, y as u32)[layer::EMISSION];
            let scattered = radiance(film, x, y) - DVec3::from_slice(straight).as_vec3();
            if counts(x, y) { scattered } else { Vec3::ZERO }
        };
        let means = regions([SIZE; 2], |x, y| if counts(x, y) { truth[y * SIZE + x] } else { Vec3::ZERO });
        let truth: Vec<_> = means.into_iter().map(|mean| Brightness { mean, error: Vec3::ZERO }).collect();
        assert_as_bright(&rendered(scene, samples, light), &truth, 0.015, 0.02);
    }

    #[test]
    #[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
    fn head_agrees_with_an_independent_renderer() {
        compare(&walked("scenes/head.toml", "head/head_70k.ply"), &truth("head_volume.exr"), 4);
    }

    #[test]
    #[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
    fn dragon_agrees_with_an_independent_renderer() {
        compare(&walked("scenes/dragon.toml", "dragon/dragon_198k.ply"), &truth("dragon_volume.exr"), 4);
    }

    #[test]
    #[ignore = "needs the scans of docs/inside/scans.md: run .ci/scans"]
    fn default_depths_lose_hardly_any_light() {
        let mut scene = walked("scenes/dragon.toml", "dragon/dragon_198k.ply");
        let oblique = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
        for model in [SubsurfaceModel::RandomWalk(WalkSurface::Clear), oblique] {
            scene.materials[0].subsurface_model = model;
            let Integrator { max_depth, max_diffuse_depth, .. } = Integrator::default();
            let light = |scene: &Scene| -> Vec3 {
                let film = &pictures(&prepare(scene.clone()), 0..1, 4)[0];
                (0..SIZE * SIZE).map(|i| radiance(film, i % SIZE, i / SIZE)).sum()
            };
            // Equal seeds trace equal paths, so their noise is equal, too, as far as they go
            let all = light(&scene);
            let mut limited = scene.clone();
            (limited.integrator.max_depth, limited.integrator.max_diffuse_depth) =
                (max_depth, max_diffuse_depth);
            let lost = Vec3::ONE - light(&limited) / all;
            println!("{}: {lost} lost", model.name());
            assert!(lost.abs().max_element() < 3e-3, "{}: {lost}", model.name());
        }
    }
}
