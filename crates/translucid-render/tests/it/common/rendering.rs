//! Ways from a scene to light: along a ray, or as a picture.
//!
//! All calls of the renderer stand here, except those that single tests are about.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use glam::Vec3;
pub(crate) use translucid_render::PreparedScene;
use translucid_render::{
    FilmSums, Goal, LiveFilm, Outcome, PixelSample, PointCloud, SampleProgress, View, internals,
};
use translucid_scene::{Scene, SceneError};

/// Makes a scene ready to be rendered.
pub(crate) fn prepare(scene: Scene) -> PreparedScene {
    PreparedScene::new(scene).expect("a valid scene")
}

/// Traces sample `index` of a seed along a ray.
pub(crate) fn sample_ray(
    prepared: &PreparedScene,
    origin: Vec3,
    direction: Vec3,
    seed: u64,
    index: u32,
) -> PixelSample {
    internals::sample_ray(prepared, origin, direction, seed, index)
}

/// Renders a picture of a scene, of its film's size.
pub(crate) fn picture(scene: &Scene, samples: u32) -> FilmSums {
    let mut film = FilmSums::new(scene.film.width, scene.film.height);
    assert_eq!(render(&prepare(scene.clone()), &mut film, samples), Outcome::Finished);
    film
}

/// Renders the picture that a scene states with other seeds.
pub(crate) fn pictures(prepared: &PreparedScene, seeds: Range<u64>, samples: u32) -> Vec<FilmSums> {
    let Scene { camera, film, .. } = *prepared.scene();
    let seeded = |seed| {
        let view = View::new(camera, film, seed).expect("a valid view");
        let live = LiveFilm::new(FilmSums::new(film.width, film.height));
        let goal = Goal { samples: 0..samples, deadline: None };
        let outcome = prepared.render(&view, &live, &goal, &|_| {}, &AtomicBool::new(false));
        assert_eq!(outcome, Outcome::Finished);
        live.into_sums()
    };
    seeds.map(seeded).collect()
}

/// Renders until each pixel has so many samples.
pub(crate) fn render(prepared: &PreparedScene, film: &mut FilmSums, samples: u32) -> Outcome {
    render_until(
        prepared,
        film,
        &Goal { samples: 0..samples, deadline: None },
        &|_| {},
        &AtomicBool::new(false),
    )
}

/// Renders until a goal is reached or somebody stops it.
pub(crate) fn render_until(
    prepared: &PreparedScene,
    film: &mut FilmSums,
    goal: &Goal,
    progress: &(dyn Fn(SampleProgress) + Sync),
    stop: &AtomicBool,
) -> Outcome {
    let view = prepared.view().expect("a valid view");
    let live = LiveFilm::new(film.clone());
    let outcome = prepared.render(&view, &live, goal, progress, stop);
    *film = live.into_sums();
    outcome
}

/// Makes the points that a scene asks for, within so many bytes.
pub(crate) fn make_points(prepared: &PreparedScene, memory: u64) -> Result<PointCloud, SceneError> {
    let view = prepared.view()?;
    let points = prepared.make_points(&view, memory, &|_| {}, &AtomicBool::new(false))?;
    Ok(points.expect("nobody stops it"))
}

/// Gathers light from points.
pub(crate) fn with_points(mut prepared: PreparedScene, points: &PointCloud) -> PreparedScene {
    prepared.set_points(points);
    prepared
}

/// Makes a scene ready to be rendered, with points if it asks for them, within so many bytes.
pub(crate) fn prepare_with_points(scene: Scene, memory: u64) -> Result<PreparedScene, SceneError> {
    let prepared = prepare(scene);
    if !prepared.wants_points() {
        return Ok(prepared);
    }
    let points = make_points(&prepared, memory)?;
    Ok(with_points(prepared, &points))
}

/// Runs on a pool of so many threads.
pub(crate) fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool");
    pool.install(work)
}
