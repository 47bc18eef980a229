//! Same scene and seed, same bytes: at any number of threads, however the work is interrupted.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::{Mat3, Vec3};
use translucid_render::{FilmSums, Goal, Outcome};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, ScalarInput, Scene,
    Unit,
};

use crate::common::{on_threads, prepare, render, render_until};

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

fn rendered(threads: usize, steps: &[u32]) -> FilmSums {
    on_threads(threads, || {
        let renderer = prepare(scene());
        let mut film = FilmSums::new(50, 34);
        for &samples in steps {
            assert_eq!(render(&renderer, &mut film, samples), Outcome::Finished);
        }
        film
    })
}

#[test]
fn threads_and_interruptions_leave_no_trace() {
    let reference = rendered(1, &[24]);
    assert!(reference.radiance(25, 20).iter().sum::<f64>() > 0.0);
    assert!(reference == rendered(2, &[24]), "two threads");
    assert!(reference == rendered(5, &[1, 2, 9, 24]), "five threads in steps");
}

#[test]
fn stop_keeps_a_film_that_can_be_continued() {
    let renderer = prepare(scene());
    let mut film = FilmSums::new(50, 34);
    let stop = AtomicBool::new(false);
    let goal = Goal { samples: 24, deadline: None };
    let stop_soon = |progress: translucid_render::Progress| {
        if progress.samples_done * 3 > progress.samples_total {
            stop.store(true, Ordering::Relaxed);
        }
    };
    assert_eq!(render_until(&renderer, &mut film, goal, &stop_soon, &stop), Outcome::Interrupted);
    assert!(film.samples() < 24);
    assert_eq!(render(&renderer, &mut film, 24), Outcome::Finished);
    assert!(film == rendered(1, &[24]));
}

#[test]
fn deadline_ends_the_rendering_in_time() {
    let renderer = prepare(scene());
    let mut film = FilmSums::new(50, 34);
    let start = Instant::now();
    let goal = Goal { samples: 1 << 22, deadline: Some(start + Duration::from_millis(200)) };
    assert_eq!(render_until(&renderer, &mut film, goal, &|_| {}, &AtomicBool::new(false)), Outcome::TimeUp);
    assert!(start.elapsed() < Duration::from_secs(20));
    assert!(film.samples() > 0);
}
