//! Pages whose pictures a device traces: a stand-in that sees the same light in every sample, or is lost.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use glam::Vec3;
use translucid_load::{ExtendedBase, LoadOptions, SceneFile};
use translucid_render::device::{DeviceLimits, DeviceScene, TracingDevice};
use translucid_render::{PathTracing, PixelSample, PreparedScene, View};
use translucid_scene::Scene;

use super::Engine;
use crate::conversation::{Heard, hear};
use crate::message::Side;
use crate::settings::{Devices, Settings};
use crate::shared::Shared;

const BALL: &str = "unit = 'cm'\nfilm.size = [40, 30]\nintegrator.samples_per_pixel = 3\nenvironment.radiance = 1\n\
    [[object]]\nname = 'ball'\nshape = 'sphere'\nradius = 1\nmaterial = 'wax'\n\
    [[material]]\nname = 'wax'\nbase_color = 0.5\n";

#[derive(Default)]
struct StandIn {
    is_lost: AtomicBool,
}

impl TracingDevice for StandIn {
    fn name(&self) -> &str {
        "stand-in"
    }

    fn limits(&self) -> DeviceLimits {
        DeviceLimits { array_bytes: 1 << 27 }
    }

    fn open(self: Arc<Self>, _: &DeviceScene) -> Result<Box<dyn PathTracing>, String> {
        Ok(Box::new(SameLight(self)))
    }
}

struct SameLight(Arc<StandIn>);

impl PathTracing for SameLight {
    fn trace(
        &mut self,
        view: &View,
        numbers: Range<u32>,
        _: &dyn Fn(u64),
        _: &AtomicBool,
    ) -> Result<Option<Vec<PixelSample>>, String> {
        if self.0.is_lost.load(Ordering::Relaxed) {
            return Err("the device was lost".to_owned());
        }
        let sample = PixelSample { diffuse: Vec3::splat(7.0), alpha: 1.0, ..PixelSample::default() };
        Ok(Some(vec![sample; view.region().area() as usize * numbers.len()]))
    }
}

/// The finished picture's middle, and the page's notes.
fn rendered(engine: &mut Engine<'_>, shared: &Shared) -> (f64, String) {
    while engine.step(None) != Some(Duration::MAX) {}
    let film = shared.side(Side::A).unwrap().film;
    assert_eq!(film.samples(), 3);
    let notes = shared.state.borrow().parts["notes"].to_string();
    (film.sums().radiance(20, 15)[0], notes)
}

fn say(shared: &Shared, text: &str) -> String {
    let Heard::Answer(answer) = hear(shared, text) else { panic!("no answer to {text}") };
    answer
}

#[test]
fn pages_choose_who_traces() {
    let device = Arc::new(StandIn::default());
    let opened = Arc::clone(&device);
    let devices = Devices {
        names: vec!["stand-in".to_owned(), "broken".to_owned()],
        open: Box::new(move |name| match name {
            "stand-in" => Ok(opened.clone()),
            _ => Err("its driver is too old".to_owned()),
        }),
        first: Some(device.clone()),
        by_script: None,
    };
    let settings = Settings {
        name: String::from("ball"),
        base: ExtendedBase::default(),
        load_base: Box::new(|_| Ok(Scene::default())),
        mesh: None,
        is_metered: false,
        command: String::new(),
        options: String::new(),
        devices,
    };
    let file = SceneFile::parse(BALL, Path::new("ball.toml")).unwrap();
    let prepared = PreparedScene::new(file.load(&LoadOptions::default(), &mut Vec::new()).unwrap()).unwrap();
    let shared = Shared::new(prepared.scene(), prepared.picker(), Vec::new(), settings).unwrap();
    assert!(shared.hello.contains(r#""devices":["cpu","stand-in","broken"]"#), "{}", shared.hello);
    let quit = AtomicBool::new(false);
    let mut engine = Engine::new(&shared, prepared, &quit);
    assert_eq!(rendered(&mut engine, &shared), (7.0, "[]".to_owned()));

    say(&shared, r#"{"type":"device","name":"cpu"}"#);
    let (by_processor, notes) = rendered(&mut engine, &shared);
    assert!(by_processor < 1.0 && notes == "[]", "{by_processor} {notes}");
    say(&shared, r#"{"type":"device","name":"stand-in"}"#);
    assert_eq!(rendered(&mut engine, &shared).0, 7.0);

    // What cannot be used, and what is lost on the way, leaves the work to the processor, which pages are told
    say(&shared, r#"{"type":"device","name":"broken"}"#);
    let (picture, notes) = rendered(&mut engine, &shared);
    assert!(
        picture == by_processor && notes.contains("the processor traces: its driver is too old"),
        "{notes}"
    );
    say(&shared, r#"{"type":"device","name":"stand-in"}"#);
    device.is_lost.store(true, Ordering::Relaxed);
    let (picture, notes) = rendered(&mut engine, &shared);
    assert!(
        picture == by_processor && notes.contains("the processor traces: the device was lost"),
        "{notes}"
    );

    let answer = say(&shared, r#"{"type":"device","name":"gpu"}"#);
    assert!(answer.contains("must be one of cpu, stand-in, broken"), "{answer}");
}
