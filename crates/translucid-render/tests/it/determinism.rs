//! Same scene and seed, same bytes: at any number of threads, however the work is interrupted.

use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::{Mat3, Vec3};
use translucid_profile::Model;
use translucid_render::{FilmSums, Goal, Outcome, SampleProgress};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Integrator, Light, Material, Mesh, Object, Projection,
    ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel, SubsurfaceNormalization, Unit, WalkSurface,
};

use crate::common::{on_threads, prepare, prepare_with_points, render, render_until};

const MEMORY: u64 = 1 << 30;
/// Size of the film in pixels, which is no multiple of that of blocks and tiles.
const WIDTH: u32 = 37;
const HEIGHT: u32 = 25;
const SAMPLES: u32 = 5;

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
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        ..Material::default()
    };
    Scene {
        unit: Unit::Millimeter,
        camera: Camera {
            position: Vec3::new(1.0, -4.0, 3.0),
            target: Vec3::ZERO,
            up: Vec3::Z,
            projection: Projection::Perspective { horizontal_fov: 40.0 },
            lens_radius: 0.05,
            focus_distance: 5.0,
            ..Camera::default()
        },
        film: Film { width: WIDTH, height: HEIGHT, ..Film::default() },
        integrator: Integrator::default(),
        objects: vec![Object {
            name: "sheet".into(),
            mesh: mesh.into(),
            material: 0,
            subsurface_group: 0,
            ..Object::default()
        }],
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
        ..Scene::default()
    }
}

/// A way of light below the surface, and its picture by one thread without interruption.
struct Way {
    name: &'static str,
    scene: Scene,
    reference: FilmSums,
}

static WAYS: LazyLock<Vec<Way>> = LazyLock::new(|| {
    type Change = fn(&mut Scene);
    let changes: [(&'static str, Change); 5] = [
        ("shared", |scene| scene.integrator.subsurface_sharing = true),
        ("alone", |scene| scene.integrator.subsurface_sharing = false),
        ("normalized", |scene| {
            scene.materials[0].subsurface_normalization = SubsurfaceNormalization::Energy;
        }),
        ("walk", |scene| {
            scene.materials[0].subsurface_model = SubsurfaceModel::RandomWalk(WalkSurface::Clear);
        }),
        ("points", |scene| {
            scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
            scene.integrator.point_tolerance = 0.5;
        }),
    ];
    let way = |(name, change): (&'static str, fn(&mut Scene))| {
        let mut scene = scene();
        change(&mut scene);
        let reference = rendered(&scene, 1, &[SAMPLES]);
        Way { name, scene, reference }
    };
    changes.into_iter().map(way).collect()
});

fn empty_film() -> FilmSums {
    FilmSums::new(WIDTH, HEIGHT)
}

/// The picture of a scene made ready and rendered on so many threads, in steps to these numbers of samples.
fn rendered(scene: &Scene, threads: usize, steps: &[u32]) -> FilmSums {
    on_threads(threads, || {
        let prepared = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
        let mut film = empty_film();
        for &samples in steps {
            assert_eq!(render(&prepared, &mut film, samples), Outcome::Finished);
        }
        film
    })
}

/// A film whose rendering on several threads was stopped after a third.
fn interrupted(scene: &Scene, threads: usize) -> FilmSums {
    let mut film = empty_film();
    let stop = AtomicBool::new(false);
    let stop_soon = |progress: SampleProgress| {
        if progress.samples_done * 3 > progress.samples_total {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let goal = Goal { samples: 0..SAMPLES, deadline: None };
    let outcome = on_threads(threads, || {
        let prepared = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
        render_until(&prepared, &mut film, &goal, &stop_soon, &stop)
    });
    assert_eq!(outcome, Outcome::Interrupted);
    assert!(film.samples() < SAMPLES);
    film
}

/// Ways with pictures of their own; without these, the tests below would not cover some way.
#[test]
fn ways_differ() {
    for (index, way) in WAYS.iter().enumerate() {
        assert!(way.reference.radiance(18, 12).iter().sum::<f64>() > 0.0, "{}", way.name);
        for other in &WAYS[..index] {
            assert!(way.reference != other.reference, "{} {}", way.name, other.name);
        }
    }
}

#[test]
fn threads_and_steps_leave_no_trace() {
    for Way { name, scene, reference } in WAYS.iter() {
        assert!(*reference == rendered(scene, 2, &[SAMPLES]), "{name}, two threads");
        assert!(*reference == rendered(scene, 3, &[1, 2, SAMPLES]), "{name}, three threads in steps");
    }
}

#[test]
fn interrupted_film_is_continued_on_other_threads() {
    for Way { name, scene, reference } in WAYS.iter() {
        let mut film = interrupted(scene, 2);
        let outcome = on_threads(3, || {
            let prepared = prepare_with_points(scene.clone(), MEMORY).expect("enough memory");
            render(&prepared, &mut film, SAMPLES)
        });
        assert_eq!(outcome, Outcome::Finished);
        assert!(film == *reference, "{name}");
    }
}

#[test]
fn deadline_ends_the_rendering_in_time() {
    let prepared = prepare(scene());
    let mut film = empty_film();
    let start = Instant::now();
    let goal = Goal { samples: 0..1 << 22, deadline: Some(start + Duration::from_millis(200)) };
    assert_eq!(render_until(&prepared, &mut film, &goal, &|_| {}, &AtomicBool::new(false)), Outcome::TimeUp);
    assert!(start.elapsed() < Duration::from_secs(300), "it hangs");
    assert!(film.samples() > 0);
}
