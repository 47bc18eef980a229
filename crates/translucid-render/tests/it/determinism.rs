//! Same scene and seed, same bytes: at any number of threads, however the work is interrupted.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::{Mat3, Vec3};
use translucid_render::{FilmSums, Goal, Outcome, Progress};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, ScalarInput, Scene,
    SubsurfaceMethod, SubsurfaceModel, SubsurfaceNormalization, Unit,
};

use crate::common::{on_threads, prepare, prepare_with_points, render, render_until};

const MEMORY: u64 = 1 << 30;

/// A bumpy translucent sheet with a glossy interface, lit by a rectangle and the sky.
fn scene() -> Scene {
    let mut mesh = Mesh::default();
    let n = 40;
    for i in 0..=n {
        for j in 0..=n {
            let (x, y) = (i as f32 / n as f32 * 4.0 - 2.0, j as f32 / n as f32 * 4.0 - 2.0);
            mesh.positions.push(Vec3::new(x, y, 0.3 * (3.0 * x).sin() * (2.0 * y).cos()));
        }
    }
    for i in 0..n {
        for j in 0..n {
            let a = i * (n + 1) + j;
            mesh.triangles.extend([[a, a + n + 1, a + 1], [a + 1, a + n + 1, a + n + 2]]);
        }
    }
    let material = Material {
        subsurface_weight: ScalarInput::constant(0.7),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.6, 0.3)),
        subsurface_radius: ScalarInput::constant(0.3),
        ..Material::default()
    };
    Scene {
        unit: Unit::Millimeter,
        camera: Camera {
            position: Vec3::new(1.0, -4.0, 3.0),
            target: Vec3::ZERO,
            up: Vec3::Z,
            horizontal_fov: 40.0,
            lens_radius: 0.05,
            focus_distance: 5.0,
        },
        film: Film { width: 50, height: 34, ..Film::default() },
        integrator: Integrator::default(),
        objects: vec![Object { name: "sheet".into(), mesh, material: 0, subsurface_group: 0 }],
        materials: vec![material],
        images: Vec::new(),
        profile_tables: Vec::new(),
        lights: vec![Light::Rectangle {
            center: Vec3::new(2.0, 2.0, 3.0),
            edge_x: Vec3::Y,
            edge_y: Vec3::X,
            radiance: Vec3::new(9.0, 8.0, 7.0),
            visible: true,
        }],
        environment: Some(Environment {
            radiance: Vec3::splat(0.3),
            image: None,
            world_from_environment: Mat3::IDENTITY,
            visible: true,
        }),
    }
}

/// The scene by every way that light can take below its surface.
fn ways() -> [(&'static str, Scene); 5] {
    let changed = |change: fn(&mut Scene)| {
        let mut scene = scene();
        change(&mut scene);
        scene
    };
    [
        ("shared", changed(|scene| scene.integrator.subsurface_sharing = true)),
        ("alone", changed(|scene| scene.integrator.subsurface_sharing = false)),
        (
            "normalized",
            changed(|s| s.materials[0].subsurface_normalization = SubsurfaceNormalization::Energy),
        ),
        ("walk", changed(|scene| scene.materials[0].subsurface_model = SubsurfaceModel::RandomWalk)),
        (
            "points",
            changed(|scene| {
                scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
                scene.integrator.point_tolerance = 0.5;
            }),
        ),
    ]
}

fn empty_film() -> FilmSums {
    FilmSums::new(50, 34)
}

/// The picture of a scene made ready and rendered on so many threads, in steps to these numbers of samples.
fn rendered(scene: &Scene, threads: usize, steps: &[u32]) -> FilmSums {
    on_threads(threads, || {
        let renderer = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
        let mut film = empty_film();
        for &samples in steps {
            assert_eq!(render(&renderer, &mut film, samples), Outcome::Finished);
        }
        film
    })
}

/// A film whose rendering somebody has stopped after a third.
fn interrupted(scene: &Scene, threads: usize, samples: u32) -> FilmSums {
    let mut film = empty_film();
    let stop = AtomicBool::new(false);
    let stop_soon = |progress: Progress| {
        if progress.samples_done * 3 > progress.samples_total {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let goal = Goal { samples, deadline: None };
    let outcome = on_threads(threads, || {
        let renderer = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
        render_until(&renderer, &mut film, goal, &stop_soon, &stop)
    });
    assert_eq!(outcome, Outcome::Interrupted);
    assert!(film.samples() < samples);
    film
}

#[test]
fn threads_and_steps_leave_no_trace() {
    for (name, scene) in ways() {
        let reference = rendered(&scene, 1, &[9]);
        assert!(reference.radiance(25, 20).iter().sum::<f64>() > 0.0, "{name}");
        assert!(reference == rendered(&scene, 2, &[9]), "{name}, two threads");
        assert!(reference == rendered(&scene, 3, &[1, 2, 6, 9]), "{name}, three threads in steps");
    }
}

/// The ways are ways: each has a picture of its own.
#[test]
fn ways_differ() {
    let pictures = ways().map(|(name, scene)| (name, rendered(&scene, 2, &[1])));
    for (index, (name, film)) in pictures.iter().enumerate() {
        for (other_name, other) in &pictures[..index] {
            assert!(film != other, "{name} {other_name}");
        }
    }
}

#[test]
fn interrupted_film_is_continued_by_another_renderer() {
    for (name, scene) in ways() {
        let mut film = interrupted(&scene, 2, 9);
        let outcome = on_threads(3, || {
            let renderer = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
            render(&renderer, &mut film, 9)
        });
        assert_eq!(outcome, Outcome::Finished);
        assert!(film == rendered(&scene, 1, &[9]), "{name}");
    }
}

#[test]
fn deadline_ends_the_rendering_in_time() {
    let renderer = prepare(scene());
    let mut film = empty_film();
    let start = Instant::now();
    let goal = Goal { samples: 1 << 22, deadline: Some(start + Duration::from_millis(200)) };
    assert_eq!(render_until(&renderer, &mut film, goal, &|_| {}, &AtomicBool::new(false)), Outcome::TimeUp);
    assert!(start.elapsed() < Duration::from_secs(20));
    assert!(film.samples() > 0);
}
