//! Jobs of a page's script, done by a stand-in that sees the same light in every sample.

use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use translucid_gpu::program;
use translucid_load::{ExtendedBase, LoadOptions, SceneFile};
use translucid_render::PreparedScene;
use translucid_render::device::DeviceLimits;
use translucid_scene::Scene;

use super::Engine;
use crate::conversation::{Heard, hear};
use crate::message::Side;
use crate::settings::{Devices, ScriptDevice, Settings};
use crate::shared::Shared;

const BALL: &str = "unit = 'cm'\nfilm.size = [40, 30]\nintegrator.samples_per_pixel = 3\nenvironment.radiance = 1\n\
    [[object]]\nname = 'ball'\nshape = 'sphere'\nradius = 1\nmaterial = 'wax'\n\
    [[material]]\nname = 'wax'\nsubsurface_weight = 1\nsubsurface_color = 0.5\nsubsurface_radius = 0.1\n\
    subsurface_model = 'random-walk'\n";

fn shared(scene: &PreparedScene) -> Shared {
    let limits = DeviceLimits { array_bytes: 1 << 27 };
    let device = ScriptDevice { name: "WebGPU".to_owned(), limits, is_first: true };
    let devices = Devices { names: vec![device.name.clone()], by_script: Some(device), ..Devices::default() };
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
    Shared::new(scene.scene(), scene.picker(), Vec::new(), settings).unwrap()
}

fn say(shared: &Shared, text: &str) {
    let Heard::Answer(answer) = hear(shared, text) else { panic!("no answer to {text}") };
    assert!(answer.contains("applied"), "{answer}");
}

/// Samples of a job, whose diffuse light is 7.
fn samples(job: &[u32]) -> Vec<u32> {
    let mut sample = [0; program::SAMPLE_WORDS];
    sample[..3].fill(7.0f32.to_bits());
    sample[12] = 1.0f32.to_bits();
    vec![sample; job[2] as usize].into_flattened()
}

/// Works until nothing is left to do, the script doing its jobs; how many of them came with a scene.
fn work(engine: &mut Engine<'_>) -> (u32, u32) {
    let (mut jobs, mut scenes) = (0, 0);
    while engine.step(None) != Some(Duration::MAX) {
        while let Some(job) = engine.next_job() {
            jobs += 1;
            scenes += job[3];
            assert!(engine.next_job().is_none() && engine.wants_job(job[0]));
            engine.finish_job(job[0], &samples(&job));
        }
    }
    (jobs, scenes)
}

fn middle(shared: &Shared) -> f64 {
    let film = shared.side(Side::A).unwrap().film;
    assert_eq!(film.samples(), 3);
    film.sums().radiance(20, 15)[0]
}

#[test]
fn script_traces_what_it_can_and_the_processor_the_rest() {
    let quit = AtomicBool::new(false);
    let file = SceneFile::parse(BALL, Path::new("ball.toml")).unwrap();
    let prepared = PreparedScene::new(file.load(&LoadOptions::default(), &mut Vec::new()).unwrap()).unwrap();
    let shared = shared(&prepared);
    let mut engine = Engine::new(&shared, prepared, &quit);
    // The processor goes ahead until the kernels are made
    assert!(engine.wants_kernels() && engine.next_job().is_none());
    assert_eq!(work(&mut engine), (0, 0));
    let by_processor = middle(&shared);
    assert!(by_processor < 1.0);
    engine.begin_script();
    assert!(!engine.wants_kernels());

    // A scene is handed over once, however the camera moves
    let camera = r#"{"type":"camera","camera":{"position":[0,20,70],"target":[0,0,0],"up":[0,1,0],"fov":40,"shift":[0,0],"lens_radius":0,"focus_distance":60}}"#;
    say(&shared, r#"{"type":"integrator","set":{"seed":7}}"#);
    assert!(matches!(work(&mut engine), (2.., 1)));
    assert_eq!(middle(&shared), 7.0);
    say(&shared, camera);
    assert!(matches!(work(&mut engine), (2.., 0)));
    assert_eq!(middle(&shared), 7.0);

    // A job whose film is not wanted any more is given up
    say(&shared, r#"{"type":"integrator","set":{"seed":8}}"#);
    engine.step(None);
    let job = engine.next_job().unwrap();
    say(&shared, r#"{"type":"material","index":0,"set":{"base_color":[0.1,0.1,0.1]}}"#);
    assert!(!engine.wants_job(job[0]));
    engine.finish_job(job[0], &samples(&job));
    engine.finish_job(job[0] + 5, &samples(&job));
    assert!(shared.side(Side::A).unwrap().film.samples() == 0);
    // Too few samples are none
    let job = engine.next_job().unwrap();
    engine.finish_job(job[0], &samples(&job)[1..]);
    assert!(matches!(work(&mut engine), (2.., 0)));

    // What the device cannot take, and all once it is lost, is the processor's, and pages are told
    let notes = || shared.state.borrow().parts["notes"].to_string();
    say(&shared, r#"{"type":"material","index":0,"set":{"subsurface_model":"dipole"}}"#);
    say(&shared, r#"{"type":"integrator","set":{"subsurface_method":"point-based"}}"#);
    assert_eq!(work(&mut engine), (0, 0), "{}", notes());
    assert!(notes().contains("the processor traces: integrator.subsurface_method"), "{}", notes());
    say(&shared, r#"{"type":"integrator","set":{"subsurface_method":"ray-traced"}}"#);
    engine.lose_script("it hung");
    assert_eq!(work(&mut engine), (0, 0));
    assert!(middle(&shared) < 1.0 && notes().contains("the processor traces: it hung"), "{}", notes());
    say(&shared, r#"{"type":"device","name":"cpu"}"#);
    work(&mut engine);
    assert_eq!(notes(), "[]");
    say(&shared, r#"{"type":"device","name":"WebGPU"}"#);
    work(&mut engine);
    assert!(notes().contains("it hung"), "{}", notes());
}
