//! Ways from a scene to light: along a ray, or as a picture.
//!
//! All that the tests call of the renderer stands here, but for what single tests are about.

use std::sync::atomic::AtomicBool;

use glam::Vec3;
pub(crate) use translucid_render::Renderer;
use translucid_render::{FilmSums, Goal, Outcome, PixelSample, PointCloud, PointsError, Progress};
use translucid_scene::Scene;

/// Makes a scene ready to be rendered.
pub(crate) fn prepare(scene: Scene) -> Renderer {
    Renderer::new(scene)
}

/// Traces sample `index` of a seed along a ray.
pub(crate) fn sample_ray(
    renderer: &Renderer,
    origin: Vec3,
    direction: Vec3,
    seed: u64,
    index: u32,
) -> PixelSample {
    renderer.sample_ray(origin, direction, seed, index)
}

/// Renders a picture of a scene, of its film's size.
pub(crate) fn picture(scene: &Scene, samples: u32) -> FilmSums {
    let mut film = FilmSums::new(scene.film.width, scene.film.height);
    assert_eq!(render(&prepare(scene.clone()), &mut film, samples), Outcome::Finished);
    film
}

/// Renders the picture of a scene with each of so many seeds.
pub(crate) fn pictures(scene: &Scene, seeds: u64, samples: u32) -> Vec<FilmSums> {
    let seeded = |seed| {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        picture(&scene, samples)
    };
    (0..seeds).map(seeded).collect()
}

/// Renders until each pixel has so many samples.
pub(crate) fn render(renderer: &Renderer, film: &mut FilmSums, samples: u32) -> Outcome {
    render_until(renderer, film, Goal { samples, deadline: None }, &|_| {}, &AtomicBool::new(false))
}

/// Renders until a goal is reached or somebody stops it.
pub(crate) fn render_until(
    renderer: &Renderer,
    film: &mut FilmSums,
    goal: Goal,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Outcome {
    renderer.render(film, goal, progress, stop)
}

/// Makes the points that a scene asks for, within so many bytes.
pub(crate) fn make_points(renderer: &Renderer, memory: u64) -> Result<PointCloud, PointsError> {
    let points = renderer.make_points(memory, &|_| {}, &AtomicBool::new(false))?;
    Ok(points.expect("nobody stops it"))
}

/// Gathers light from points.
pub(crate) fn with_points(renderer: Renderer, points: &PointCloud) -> Renderer {
    renderer.with_points(points)
}

/// Makes a scene ready to be rendered, with points if it asks for them, within so many bytes.
pub(crate) fn prepare_with_points(scene: Scene, memory: u64) -> Result<Renderer, PointsError> {
    let renderer = prepare(scene);
    if !renderer.wants_points() {
        return Ok(renderer);
    }
    let points = make_points(&renderer, memory)?;
    Ok(with_points(renderer, &points))
}

/// Runs on a pool of so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
    pool.install(work)
}
