//! Point-based subsurface scattering against exact answers.
//!
//! The light on the test scenes is such that the points' irradiance has hardly any noise: the tests measure the sum over
//! points.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::Vec3;
use translucid_profile::{
    Configuration, Model, NormalizedDiffusion, Parameterization, d_from_surface_albedo,
};
use translucid_render::{PointPass, PointProgress, Session, View};
use translucid_scene::{ColorInput, Material, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel};

use crate::common::{
    PreparedScene, distant, make_points, measure, on_threads, prepare, prepare_with_points, quad, sample_ray,
    scene, sphere, uniform_environment, with_points,
};

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

fn point_based(mut scene: Scene, tolerance: f32) -> PreparedScene {
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.integrator.point_tolerance = tolerance;
    prepare_with_points(scene, MEMORY).expect("enough memory")
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

/// On a plane the sum is the energy of the profile, wherever the points happen to lie around.
#[test]
fn plane_under_uniform_light_returns_surface_albedo() {
    let square = quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0);
    let mut scene = scene(vec![square], translucent(Model::NormalizedDiffusion));
    scene.environment = uniform_environment(Vec3::ONE);
    let renderer = point_based(scene, 0.05);
    let n = 500;
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    let expected: [f64; 3] = std::array::from_fn(|c| within_square(c, 8.0));
    for i in 0..n {
        let place = |salt: u32| sobol_burley::sample(i, salt, 7) - 0.5;
        let light = sample_ray(&renderer, Vec3::new(place(0), place(1), 1.0), Vec3::NEG_Z, 1, i).radiance();
        for c in 0..3 {
            let relative = f64::from(light[c]) / expected[c];
            sum[c] += relative;
            squares[c] += relative * relative;
        }
    }
    #[allow(clippy::print_stdout, reason = "--nocapture shows what the plane returns")]
    for c in 0..3 {
        let mean = sum[c] / f64::from(n);
        let ripple = (squares[c] / f64::from(n) - mean * mean).max(0.0).sqrt();
        println!("plane, channel {c}: mean {mean:.5}, ripple {ripple:.5}");
        // Where points lie in the way of the 1/r of the narrowest channel, it ripples by 0.8 %
        assert!((mean - 1.0).abs() < 0.005, "channel {c}: {mean}");
        assert!(ripple < 0.012, "channel {c}: {ripple}");
    }
}

/// Where there is no light, points take no more samples than they need to find that.
#[test]
fn points_without_light_are_soon_black() {
    let square = quad(Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 4.0);
    let mut scene = scene(vec![square], translucent(Model::NormalizedDiffusion));
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    let renderer = prepare(scene);
    let most = std::sync::atomic::AtomicU64::new(0);
    let hear = |progress: PointProgress| {
        if progress.pass == PointPass::Irradiance {
            most.fetch_max((progress.part * progress.total as f64) as u64, Ordering::Relaxed);
        }
    };
    let view = renderer.view().expect("a valid view");
    let points = renderer.make_points(&view, MEMORY, &hear, &AtomicBool::new(false));
    let points = points.expect("enough memory").expect("nobody stops it");
    assert!(most.into_inner() <= 16 * points.len() as u64);
    let renderer = with_points(renderer, &points);
    let light = sample_ray(&renderer, Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, 1, 0).radiance();
    assert_eq!(light, Vec3::ZERO);
}

/// Energy of a unit profile that falls on a half plane at distance x ≥ 0 from its edge:
/// (1/4π)(Ki₁(x/d) + 3 Ki₁(x/3d)) with Ki₁(x) = ∫₀^∞ e^{−x cosh t}/cosh t dt, the integral of K₀.
fn half_plane(x: f64, d: f64) -> f64 {
    let ki = |x: f64| {
        let step = 1e-3;
        (0..20_000)
            .map(|i| (f64::from(i) + 0.5) * step)
            .map(|t| (-x * t.cosh()).exp() / t.cosh())
            .sum::<f64>()
            * step
    };
    (ki(x / d) + 3.0 * ki(x / (3.0 * d))) / (4.0 * std::f64::consts::PI)
}

#[test]
fn step_edge_of_light_follows_bessel_integral() {
    let plane = quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0);
    let roof = quad(Vec3::new(1e3, 0.0, 50.0), Vec3::X * 1e3, Vec3::Y * 2e3);
    let mut scene = scene(vec![plane, roof], translucent(Model::NormalizedDiffusion));
    scene.objects[1].subsurface_group = 1;
    scene.objects[1].material = 1;
    scene.materials.push(Material::default());
    scene.lights.push(distant(Vec3::Z));
    let renderer = point_based(scene, 0.05);
    for x in [-2.0_f32, -1.0, -0.3, 0.3, 1.0, 2.0] {
        // Along the edge, where the truth is the same
        let places = (0..32).map(|i| Vec3::new(x, i as f32 / 16.0 - 1.0, 1.0));
        let light = places.map(|place| sample_ray(&renderer, place, Vec3::NEG_Z, 1, 0).radiance());
        let mean = light.sum::<Vec3>() / 32.0 * std::f32::consts::PI / ALBEDO;
        for c in 0..3 {
            let far = half_plane(f64::from(x.abs()), profile(c).d());
            let expected = if x > 0.0 { far } else { 1.0 - far };
            // The square holds all but 1 % of the widest channel's light
            let edge = 1.0 - within_square(c, 6.0) / f64::from(ALBEDO[c]);
            let error = (f64::from(mean[c]) - expected).abs();
            assert!(error < 0.01 + edge, "x = {x}, channel {c}: {} instead of {expected}", mean[c]);
        }
    }
}

#[test]
fn slab_transmits_what_the_profile_says() {
    for thickness in [0.3_f32, 1.0, 2.0] {
        let top = quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0);
        let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 8.0, Vec3::X * 8.0);
        let mut scene = scene(vec![top, bottom], translucent(Model::NormalizedDiffusion));
        scene.lights.push(distant(Vec3::NEG_Z));
        let renderer = point_based(scene, 0.05);
        let places = (0..64).map(|i| Vec3::new((i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0, 1.0));
        let light = places.map(|place| sample_ray(&renderer, place, Vec3::NEG_Z, 1, 0).radiance());
        let mean = light.sum::<Vec3>() / 64.0 * std::f32::consts::PI;
        for c in 0..3 {
            let whole = f64::from(ALBEDO[c]);
            let expected = whole - profile(c).enclosed(f64::from(thickness));
            let edge = whole - within_square(c, 6.5);
            let error = (f64::from(mean[c]) - expected).abs();
            assert!(error < 0.01 * whole + edge, "{thickness}, channel {c}: {} not {expected}", mean[c]);
        }
    }
}

/// Every model's points and probes agree on a ball with shadows; directional models are left out.
#[test]
fn points_agree_with_probes_for_every_model() {
    for model in Model::ALL {
        if [Model::DirectionalDipole, Model::NormalizedDiffusionOblique].contains(&model) {
            continue;
        }
        let ball = sphere(2.0, 24);
        let mut scene = scene(vec![ball], translucent(model));
        scene.lights.push(distant(Vec3::new(1.0, 0.0, 1.0)));
        let (origin, direction) = (Vec3::new(0.5, 0.6, 5.0), Vec3::NEG_Z);
        let (probes, error) = measure(&prepare(scene.clone()), origin, direction, 1 << 13);
        let points = sample_ray(&point_based(scene, 0.1), origin, direction, 0, 0).radiance();
        for c in 0..3 {
            let difference = (points[c] - probes[c]).abs();
            // Five standard errors of the probes (45 comparisons: 3e-5), and 3 % for the points
            let allowed = 5.0 * error[c] + 0.03 * probes[c];
            assert!(difference < allowed, "{model}, channel {c}: {points} against {probes} ± {error}");
        }
    }
}

/// Pictures of points tend to those of probes: a ball with shadow and sky, seen along fixed rays.
///
/// relMSE = mean of (x − ref)² / (ref² + 0.01); the reference's own part of it is taken off.
#[test]
#[allow(clippy::print_stdout, reason = "--nocapture shows how fast pictures converge")]
fn points_converge_to_probes_as_the_tolerance_shrinks() {
    let mut scene = scene(vec![sphere(2.0, 24)], translucent(Model::NormalizedDiffusionRefined));
    scene.lights.push(distant(Vec3::new(1.0, 0.3, 0.5)));
    scene.environment = uniform_environment(Vec3::new(0.1, 0.2, 0.3));
    scene.integrator.max_depth = 8;
    scene.integrator.max_diffuse_depth = 8;
    scene.integrator.subsurface_tail = 1e-5;
    let rays: Vec<Vec3> =
        (0..36).map(|i| Vec3::new((i % 6) as f32 * 0.5 - 1.25, (i / 6) as f32 * 0.5 - 1.25, 5.0)).collect();
    let ray_traced = prepare(scene.clone());
    let references: Vec<(Vec3, Vec3)> =
        rays.iter().map(|&ray| measure(&ray_traced, ray, Vec3::NEG_Z, 1 << 14)).collect();
    let over = |value: Vec3, truth: Vec3| (value * value / (truth * truth + 0.01)).element_sum() / 3.0;
    let noise =
        references.iter().map(|&(truth, error)| over(error, truth)).sum::<f32>() / references.len() as f32;
    let mut before = f32::INFINITY;
    for tolerance in [0.8, 0.2, 0.05] {
        let renderer = point_based(scene.clone(), tolerance);
        let light = |ray: &Vec3| sample_ray(&renderer, *ray, Vec3::NEG_Z, 1, 0).radiance();
        let errors = rays.iter().zip(&references).map(|(ray, &(truth, _))| over(light(ray) - truth, truth));
        let error = errors.sum::<f32>() / rays.len() as f32;
        println!("tolerance {tolerance}: relMSE {error:.2e}, noise of the reference {noise:.1e}");
        // A quarter of the tolerance leaves less than half of the error
        assert!(error - noise < 0.5 * before, "tolerance {tolerance}: {error:e} after {before:e}");
        before = error;
    }
    assert!(before < 1e-3, "{before:e}");
}

#[test]
fn points_do_not_depend_on_threads() {
    let ball = sphere(2.0, 24);
    let mut scene = scene(vec![ball], translucent(Model::NormalizedDiffusionRefined));
    scene.lights.push(distant(Vec3::new(1.0, 0.0, 1.0)));
    scene.environment = uniform_environment(Vec3::splat(0.1));
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.integrator.point_tolerance = 0.2;
    let make = |threads: usize| {
        on_threads(threads, || make_points(&prepare(scene.clone()), MEMORY).expect("enough memory"))
    };
    let one = make(1);
    assert!(one.len() > 500, "{}", one.len());
    assert!(one == make(3));
}

#[test]
fn making_points_stops_when_asked() {
    let mut scene = scene(vec![sphere(2.0, 24)], translucent(Model::NormalizedDiffusion));
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    let renderer = prepare(scene);
    let view = renderer.view().expect("a valid view");
    for pass in [PointPass::Points, PointPass::Irradiance] {
        let stop = AtomicBool::new(false);
        let stop_there = |progress: PointProgress| {
            assert!((0.0..=1.0).contains(&progress.part));
            stop.fetch_or(progress.pass == pass, Ordering::Relaxed);
        };
        assert!(renderer.make_points(&view, MEMORY, &stop_there, &stop).expect("enough memory").is_none());
    }
}

#[test]
fn progress_of_points_never_falls() {
    let mut scene = scene(vec![sphere(2.0, 24)], translucent(Model::NormalizedDiffusionRefined));
    scene.lights.push(distant(Vec3::new(1.0, 0.0, 1.0)));
    scene.environment = uniform_environment(Vec3::splat(0.1));
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.integrator.point_tolerance = 0.2;
    let renderer = prepare(scene);
    let view = renderer.view().expect("a valid view");
    let told = Mutex::new(Vec::new());
    let hear = |progress: PointProgress| told.lock().expect("no panic").push(progress);
    on_threads(1, || renderer.make_points(&view, MEMORY, &hear, &AtomicBool::new(false)).map(drop))
        .expect("enough memory");
    // Few points are laid in few steps
    for (pass, least) in [(PointPass::Points, 2), (PointPass::Irradiance, 6)] {
        let told = told.lock().expect("no panic");
        let parts: Vec<f64> = told.iter().filter(|at| at.pass == pass).map(|at| at.part).collect();
        assert!(parts.len() >= least && parts.is_sorted(), "{pass:?}: {parts:?}");
        assert!(parts.iter().all(|part| (0.0..=1.0).contains(part)), "{pass:?}: {parts:?}");
    }
}

/// Points lie no closer than half a pixel, where that is wider than the profile asks for, and serve pixels as wide.
#[test]
fn points_are_as_close_as_pixels_need_them() {
    let small = Material {
        subsurface_radius: ScalarInput::constant(0.05),
        ..translucent(Model::NormalizedDiffusion)
    };
    let mut scene = scene(vec![sphere(2.0, 24)], small);
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    let renderer = prepare(scene);
    let whole = renderer.view().expect("a valid view");
    let view = |width: u32| {
        let film = translucid_scene::Film { width, height: width, ..*whole.film() };
        View::new(*whole.camera(), film, 0).expect("a valid view")
    };
    let points_for = |width: u32| renderer.plan_points(&view(width)).points();
    let [coarse, fine, finest] = [16, 64, 4096].map(points_for);
    // Four times as many pixels along an edge
    assert!((fine / coarse / 16.0 - 1.0).abs() < 0.01, "{coarse}, {fine}");
    // Then the mean free path decides
    assert!(finest > 4.0 * fine && finest == points_for(8192), "{fine}, {finest}");
    let never = AtomicBool::new(false);
    let points =
        renderer.make_points(&view(64), MEMORY, &|_| {}, &never).expect("memory").expect("not stopped");
    assert!((points.len() as f64 / fine - 1.0).abs() < 0.15, "{} for {fine}", points.len());
    for (width, serves) in [(16, true), (64, true), (78, true), (90, false)] {
        assert_eq!(renderer.points_serve(&points, &view(width)), serves, "{width}");
    }
    let mut session = Session::new(renderer, view(64));
    session.set_points(&points);
    session.set_view(view(60));
    assert!(!session.prepared().wants_points());
    session.set_view(view(90));
    assert!(session.prepared().wants_points());
}

#[test]
fn too_little_memory_is_an_error_that_says_what_to_do() {
    for radius in [1e-4, 1e-2] {
        let material =
            Material { subsurface_radius: ScalarInput::constant(radius), ..translucent(Model::Dipole) };
        let mut scene = scene(vec![sphere(2.0, 24)], material);
        scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
        let renderer = prepare(scene);
        let error = make_points(&renderer, 1 << 20).expect_err("too little");
        for part in ["points need", "may take 1.00 MiB", "material translucent of object object"] {
            assert!(error.message.contains(part), "{error}");
        }
        assert!(error.help.as_deref().unwrap_or_default().contains("subsurface_radius"), "{error}");
    }
}
