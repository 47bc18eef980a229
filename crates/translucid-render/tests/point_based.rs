//! Point-based subsurface scattering against exact answers.
//!
//! The light on the test scenes is such that the points' irradiance has no noise, or hardly any: what is measured is
//! the sum over points.

mod common;

use std::sync::atomic::AtomicBool;

use common::{quad, scene, uniform_environment};
use glam::Vec3;
use translucid_profile::{
    Configuration, Model, NormalizedDiffusion, Parameterization, d_from_surface_albedo,
};
use translucid_render::Renderer;
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel};

const ALBEDO: Vec3 = Vec3::new(0.9, 0.8, 0.6);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.4);
const MEMORY: u64 = 1 << 30;

fn translucent(model: Model) -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: SubsurfaceModel::Profile(model),
        ..Material::default()
    }
}

fn point_based(mut scene: Scene, tolerance: f32) -> Renderer {
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.integrator.point_tolerance = tolerance;
    let renderer = Renderer::new(scene);
    let points = renderer.make_points(MEMORY, &|_| {}, &AtomicBool::new(false));
    let points = points.expect("enough memory").expect("nobody stops it");
    renderer.with_points(&points)
}

fn profile(channel: usize) -> NormalizedDiffusion {
    let (albedo, length) = (f64::from(ALBEDO[channel]), f64::from(LENGTH[channel]));
    let d = d_from_surface_albedo(albedo, length, Parameterization::Mfp, Configuration::Diffuse);
    NormalizedDiffusion::from_d(albedo, d).expect("valid parameters")
}

/// Energy of the profile on a square of half edge h around its center.
fn within_square(channel: usize, h: f64) -> f64 {
    let n = 4000;
    let angle = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * std::f64::consts::FRAC_PI_4;
    (0..n).map(|i| profile(channel).enclosed(h / angle(i).cos())).sum::<f64>() / f64::from(n)
}

/// Mean and rms deviation of the light that leaves around the middle of a square of half edge 8.
fn ripple(tolerance: f32) -> ([f64; 3], [f64; 3]) {
    let mut scene =
        scene(vec![quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0)], translucent(Model::NormalizedDiffusion));
    scene.environment = uniform_environment(Vec3::ONE);
    let renderer = point_based(scene, tolerance);
    let n = 2000;
    let start = std::time::Instant::now();
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for i in 0..n {
        let place = |salt: u32| sobol_burley::sample(i, salt, 7) - 0.5;
        let light = renderer.sample_ray(Vec3::new(place(0), place(1), 1.0), Vec3::NEG_Z, 1, i).radiance();
        for c in 0..3 {
            let relative = f64::from(light[c]) / within_square(c, 8.0);
            sum[c] += relative;
            squares[c] += relative * relative;
        }
    }
    println!("{:?} a sample", start.elapsed() / n);
    let mean = sum.map(|s| s / f64::from(n));
    (mean, std::array::from_fn(|c| (squares[c] / f64::from(n) - mean[c] * mean[c]).max(0.0).sqrt()))
}

#[test]
fn plane_under_uniform_light_returns_surface_albedo() {
    for tolerance in [0.2, 0.05] {
        let (mean, rms) = ripple(tolerance);
        println!("{tolerance} {mean:.4?} {rms:.4?}");
    }
}
