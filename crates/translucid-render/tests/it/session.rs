//! Sessions: stopped, edited, started again, resumed.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use glam::Vec3;
use translucid_render::{Edit, Event, Fraction, Outcome, Plan, PreparedScene, Session};
use translucid_scene::{Material, ScalarInput, SubsurfaceMethod};
use translucid_workbench::scene_of_everything;

use crate::common::{on_threads, prepare, scene, sphere, uniform_environment};

fn session() -> Session {
    let mut scene = scene_of_everything();
    (scene.film.width, scene.film.height) = (96, 54);
    let prepared = prepare(scene);
    let view = prepared.view().expect("a valid view");
    Session::new(prepared, view)
}

/// Tried until it is quick, because other processes may have the processor: a session that finishes what it has begun never is.
#[test]
fn session_stops_at_once_and_goes_on() {
    let mut session = session();
    let mut least = Duration::MAX;
    for _ in 0..200 {
        let running = session.start(Plan::samples(1 << 20), 2, |_: &Event<'_>| {}).expect("threads");
        std::thread::sleep(Duration::from_millis(60));
        assert!(!running.is_finished());
        let before = Instant::now();
        let result;
        (session, result) = running.stop();
        least = least.min(before.elapsed());
        assert_eq!(result.expect("no error"), Outcome::Interrupted);
        if least < Duration::from_millis(20) {
            break;
        }
    }
    assert!(least < Duration::from_millis(20), "{least:?}");
    // Where it was stopped leaves no trace, whichever later samples of a batch some tiles have
    let film = session.film();
    let last =
        film.sums().tiles.iter().filter_map(|tile| tile.taken.as_slice().last()).map(|range| range.end).max();
    let samples = last.expect("samples") + 1;
    let never = AtomicBool::new(false);
    let plan = Plan::samples(samples);
    assert_eq!(session.run(&plan, &|_: &Event<'_>| {}, &never).expect("no error"), Outcome::Finished);
    let mut whole = self::session();
    whole.run(&plan, &|_: &Event<'_>| {}, &never).expect("no error");
    assert!(*session.film().sums() == *whole.film().sums());
}

#[test]
fn session_is_edited_between_runs() {
    let mut session = session();
    let never = AtomicBool::new(false);
    session.run(&Plan::samples(1), &|_: &Event<'_>| {}, &never).expect("no error");
    let before = session.film();
    let mut material = session.prepared().scene().materials[0].clone();
    material.base_weight *= 0.5;
    session.edit(Edit::Material(0, Box::new(material))).expect("a valid material");
    assert_eq!(session.film().samples(), 0, "the film begins anew");
    assert_eq!(before.samples(), 1, "who reads the old film keeps it");
    session.set_view(session.view().with_region([3, 4, 40, 30]).expect("within the film"));
    session.run(&Plan::samples(1), &|_: &Event<'_>| {}, &never).expect("no error");
    assert_eq!((session.film().sums().width, session.film().sums().height), (37, 26));
}

#[test]
fn session_goes_on_from_its_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("film.checkpoint");
    let never = AtomicBool::new(false);
    let quiet = |_: &Event<'_>| {};
    let mut first = session();
    first.run(&Plan::samples(1), &quiet, &never).expect("no error");
    first.save(&path).expect("written");
    let mut second = session();
    second.resume(&path).expect("its own");
    assert!(second.seconds() > 0.0);
    for session in [&mut first, &mut second] {
        session.run(&Plan::samples(2), &quiet, &never).expect("no error");
    }
    assert!(*first.film().sums() == *second.film().sums());
    let mut other = session();
    other.set_view(other.view().with_region([0, 0, 9, 9]).expect("within the film"));
    assert!(other.resume(&path).is_err(), "a film of another region");
}

#[test]
fn observer_hears_of_points_previews_and_samples() {
    let wax = Material {
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_radius: ScalarInput::constant(0.5),
        ..Material::default()
    };
    let mut scene = scene(vec![sphere(1.0, 12)], wax);
    (scene.film.width, scene.film.height) = (48, 27);
    scene.camera.position = Vec3::Z * 4.0;
    scene.environment = uniform_environment(Vec3::ONE);
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.integrator.point_tolerance = 1.0;
    let prepared = PreparedScene::new(scene).expect("a valid scene");
    let view = prepared.view().expect("a valid view");
    let mut session = Session::new(prepared, view);
    let heard = Mutex::new(Vec::new());
    let observer = |event: &Event<'_>| {
        let word = match event {
            Event::Points(_) => String::from("points"),
            Event::Preview(fraction, film) => format!("{fraction:?} {}x{}", film.width, film.height),
            Event::Samples(progress) => {
                assert!(progress.samples_done <= progress.samples_total);
                String::from("samples")
            }
            Event::Checkpoint(_) | Event::Unsaved(_) | Event::Denoising => String::from("other"),
        };
        let mut heard = heard.lock().expect("no panic");
        if heard.last() != Some(&word) {
            heard.push(word);
        }
    };
    let plan = Plan { previews: vec![Fraction::Eighth, Fraction::Half], ..Plan::samples(1) };
    let never = AtomicBool::new(false);
    let outcome = on_threads(2, || session.run(&plan, &observer, &never)).expect("no error");
    assert_eq!(outcome, Outcome::Finished);
    let words = heard.into_inner().expect("no panic");
    assert_eq!(words, ["points", "Eighth 6x4", "Half 24x14", "samples"]);
    assert!(!never.load(Ordering::Relaxed));
}
