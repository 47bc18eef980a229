//! Surfaces that show the camera only the shadows on them, or nothing.

use glam::Vec3;
use translucid_render::layer;
use translucid_scene::{
    Camera, CameraVisibility, ColorInput, Material, Projection, ScalarInput, Scene, SubsurfaceModel,
    WalkSurface,
};

use crate::common::{
    PreparedScene, distant, pictures, prepare, quad, sample_ray, scene, sphere, uniform_environment,
};

const SAMPLES: u32 = 4096;

/// A plane at z = 0 of some visibility, and a black ball of radius 1 about (0, 0, 2).
fn ball_above(visibility: CameraVisibility) -> Scene {
    let floor = quad(Vec3::ZERO, Vec3::X * 50.0, Vec3::Y * 50.0);
    let mut ball = sphere(1.0, 96);
    for position in &mut ball.positions {
        position.z += 2.0;
    }
    let black = Material { base_weight: 0.0, ..Material::default() };
    let mut scene =
        scene(vec![floor, ball], Material { camera_visibility: visibility, ..Material::default() });
    scene.objects[1].material = 1;
    scene.objects[1].subsurface_group = 1;
    scene.materials.push(black);
    scene
}

/// Mean alpha of the floor at a place, seen from the side.
fn alpha(prepared: &PreparedScene, place: Vec3) -> f64 {
    let direction = Vec3::new(0.0, -0.8, -0.6);
    let sum: f64 = (0..SAMPLES)
        .map(|i| {
            let sample = sample_ray(prepared, place - direction * 0.5, direction, 7, i);
            assert_eq!(sample.radiance(), Vec3::ZERO);
            f64::from(sample.alpha)
        })
        .sum();
    sum / f64::from(SAMPLES)
}

/// A ball of radius r in the height h keeps (r/h)² of an even sky's light from the ground below.
#[test]
fn shadow_covers_as_much_as_light_is_missing() {
    let mut scene = ball_above(CameraVisibility::Shadow);
    scene.environment = uniform_environment(Vec3::ONE);
    let below = Vec3::ZERO;
    // Five standard errors of a binomial, false alarm 6e-7, and the bias of 16 candidates
    let is_near = |found: f64, expected: f64, what: &str| {
        let bound = 5.0 * (expected * (1.0 - expected) / f64::from(SAMPLES)).sqrt() + 0.005;
        assert!((found - expected).abs() < bound, "{what}: {found} for {expected}");
    };
    is_near(alpha(&prepare(scene.clone()), below), 0.25, "sky");
    // A sun at 45°: the middle of the shadow is 2 to the side
    let sun = vec![distant(Vec3::new(1.0, 0.0, 1.0))];
    let prepared = prepare(Scene { environment: None, lights: sun, ..scene });
    is_near(alpha(&prepared, Vec3::new(-2.0, 0.0, 0.0)), 1.0, "in the sun's shadow");
    is_near(alpha(&prepared, Vec3::new(2.0, 0.0, 0.0)), 0.0, "in the sun");
}

#[test]
fn surfaces_that_the_camera_does_not_see_light_others_all_the_same() {
    let through = |visibility: CameraVisibility| {
        let mut scene = ball_above(visibility);
        scene.environment = uniform_environment(Vec3::ONE);
        scene.materials[1] = Material::default();
        let prepared = prepare(scene);
        // The ball from the side, and what is behind the floor
        let ball = sample_ray(&prepared, Vec3::new(5.0, 0.0, 1.2), Vec3::NEG_X, 1, 3);
        let floor = sample_ray(&prepared, Vec3::new(5.0, 0.0, 1.0), Vec3::NEG_Z, 1, 3);
        (ball.radiance(), floor.alpha, floor.depth)
    };
    let seen = through(CameraVisibility::Surface);
    for visibility in [CameraVisibility::Shadow, CameraVisibility::None] {
        assert_eq!(through(visibility).0, seen.0, "{visibility:?}");
        assert_eq!(through(visibility).2, 0.0, "{visibility:?}");
    }
    assert!(seen.2 > 0.0);
}

/// Alpha of a ball before a floor without shadow is the share of the view that the ball keeps, 1 − e^(−2r/ℓ).
#[test]
fn bodies_hide_as_much_as_they_keep() {
    let mut scene = ball_above(CameraVisibility::Shadow);
    scene.materials[1] = Material {
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_radius: ScalarInput::constant(4.0),
        subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
        subsurface_model: SubsurfaceModel::RandomWalk(WalkSurface::Clear),
        ..Material::default()
    };
    scene.lights = vec![distant(Vec3::new(1.0, 0.0, 0.4))];
    scene.camera = Camera {
        position: Vec3::new(0.0, 0.0, 20.0),
        projection: Projection::Perspective { horizontal_fov: 0.5 },
        ..scene.camera
    };
    let (pixels, samples) = (scene.film.width * scene.film.height, 64);
    for shared in [false, true] {
        scene.integrator.subsurface_sharing = shared;
        let films = pictures(&prepare(scene.clone()), 0..1, samples);
        let places = (0..pixels).map(|i| (i % films[0].width, i / films[0].width));
        let mean = places.map(|(x, y)| films[0].mean(x, y)[layer::ALPHA]).sum::<f64>() / f64::from(pixels);
        let expected = 1.0 - (-0.5_f64).exp();
        // Five standard errors of a binomial, false alarm 6e-7
        let bound = 5.0 * (expected * (1.0 - expected) / f64::from(pixels * samples)).sqrt();
        assert!((mean - expected).abs() < bound, "{shared}: {mean} for {expected}");
    }
}

#[test]
fn without_light_nothing_is_missing() {
    let prepared = prepare(ball_above(CameraVisibility::Shadow));
    assert_eq!(alpha(&prepared, Vec3::ZERO), 0.0);
}
