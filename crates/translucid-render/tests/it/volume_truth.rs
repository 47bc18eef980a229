//! The random walk against images of an independent volumetric path tracer, region by region.
//!
//! The images and meshes are not part of the project: where `shared/assets` is absent, the tests are ignored.
//! Each region's mean is that of sixteen pictures with seeds of their own, which tell its standard error; it counts as
//! right within five of them (by Student's t a false alarm in 6,000, and 1.5 % over all comparisons) and 1.5 % of the
//! truth, whose own noise is in that; pixels of the truth that outshine all their neighbors are left out of both.

#![allow(clippy::print_stdout, reason = "--nocapture shows what was found")]

use std::path::Path;

use exr::prelude::*;
use glam::Vec3;
use translucid_profile::roots::falling_root;
use translucid_profile::{Configuration, Model, half_space_surface_albedo};
use translucid_render::FilmSums;
use translucid_scene::{
    ColorInput, Integrator, LoadOptions, Scene, SubsurfaceModel, WalkSurface, load_scene,
};
use translucid_testing::{asset, with_shared_assets};

use crate::common::{pictures, prepare};

/// Pixels of the picture here, and of the truth's for each of them.
const SIZE: usize = 128;
const BLOCK: usize = 4;
/// Pixels of a region.
const REGION: usize = 32;
const SEEDS: u64 = 16;

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
        mesh_overrides: vec![(None, asset(mesh))],
        size: Some([SIZE as u32; 2]),
        subsurface_model: Some(SubsurfaceModel::RandomWalk(WalkSurface::Clear)),
        ..LoadOptions::default()
    };
    let mut scene = load_scene(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(scene),
        &options,
        &mut Vec::new(),
    )
    .unwrap();
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
        asset("truth").join(file),
        |size, _| vec![vec![Vec3::ZERO; size.width()]; size.height()],
        |rows: &mut Vec<Vec<Vec3>>, at, (r, g, b, _): (f32, f32, f32, f32)| {
            rows[at.y()][at.x()] = Vec3::new(r, g, b);
        },
    )
    .unwrap();
    let rows = image.layer_data.channel_data.pixels;
    let pixel = |x: usize, y: usize| {
        let sum: Vec3 = (0..BLOCK * BLOCK).map(|i| rows[y * BLOCK + i / BLOCK][x * BLOCK + i % BLOCK]).sum();
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

/// Means over regions.
fn regions(pixel: impl Fn(usize, usize) -> Vec3) -> Vec<Vec3> {
    let across = SIZE / REGION;
    let mean = |region: usize| {
        let (left, top) = (region % across * REGION, region / across * REGION);
        let sum: Vec3 = (0..REGION * REGION).map(|i| pixel(left + i % REGION, top + i / REGION)).sum();
        sum / (REGION * REGION) as f32
    };
    (0..across * across).map(mean).collect()
}

fn compare(scene: &Scene, truth: &[Vec3], samples: u32) {
    let means = |film: FilmSums| {
        regions(|x, y| {
            let radiance = film.radiance(x as u32, y as u32).map(|value| value as f32);
            if is_speck(truth, x, y) { Vec3::ZERO } else { Vec3::from_array(radiance) }
        })
    };
    let renderings: Vec<Vec<Vec3>> =
        pictures(&prepare(scene.clone()), 0..SEEDS, samples).into_iter().map(means).collect();
    let truth = regions(|x, y| if is_speck(truth, x, y) { Vec3::ZERO } else { truth[y * SIZE + x] });
    let (mut compared, mut sums, mut wrong) = (0, [Vec3::ZERO; 2], Vec::new());
    for (region, expected) in truth.iter().enumerate() {
        let mean = renderings.iter().map(|r| r[region]).sum::<Vec3>() / SEEDS as f32;
        let square = |r: &Vec<Vec3>| (r[region] - mean) * (r[region] - mean);
        let variance = renderings.iter().map(square).sum::<Vec3>() / (SEEDS * (SEEDS - 1)) as f32;
        sums[0] += mean;
        sums[1] += *expected;
        for c in 0..3 {
            let allowed = 5.0 * variance[c].sqrt() + 0.015 * expected[c];
            let off = mean[c] - expected[c];
            if off.abs() > allowed + 1e-5 {
                wrong.push(format!("region {region}, channel {c}: {} is not {}", mean[c], expected[c]));
            }
            compared += u32::from(allowed < 0.2 * expected[c]);
        }
    }
    println!("{compared} means of regions; whole picture over the truth's: {}", sums[0] / sums[1]);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(compared > 15, "too noisy to tell: {compared}");
    assert!((sums[0] / sums[1] - 1.0).abs().max_element() < 0.02, "{sums:?}");
}

with_shared_assets! {
    fn head_agrees_with_an_independent_renderer() {
        compare(&walked("scenes/head.toml", "head/head_70k.ply"), &truth("head_volume.exr"), 4);
    }

    fn dragon_agrees_with_an_independent_renderer() {
        compare(&walked("scenes/dragon.toml", "dragon/dragon_198k.ply"), &truth("dragon_volume.exr"), 4);
    }

    fn default_depths_lose_hardly_any_light() {
        let mut scene = walked("scenes/dragon.toml", "dragon/dragon_198k.ply");
        let oblique = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
        for model in [SubsurfaceModel::RandomWalk(WalkSurface::Clear), oblique] {
            scene.materials[0].subsurface_model = model;
            let Integrator { max_depth, max_diffuse_depth, .. } = Integrator::default();
            let light = |scene: &Scene| -> Vec3 {
                let film = &pictures(&prepare(scene.clone()), 0..1, 4)[0];
                let radiance = |i: u32| film.radiance(i % SIZE as u32, i / SIZE as u32).map(|value| value as f32);
                (0..(SIZE * SIZE) as u32).map(|i| Vec3::from_array(radiance(i))).sum()
            };
            // The same paths: their noise is the same, too, as far as they go
            let all = light(&scene);
            let mut limited = scene.clone();
            (limited.integrator.max_depth, limited.integrator.max_diffuse_depth) = (max_depth, max_diffuse_depth);
            let lost = Vec3::ONE - light(&limited) / all;
            println!("{}: {lost} lost", model.name());
            assert!(lost.abs().max_element() < 3e-3, "{}: {lost}", model.name());
        }
    }
}
