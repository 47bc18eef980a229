//! Pictures of a device against those of the processor.

use std::sync::OnceLock;

use translucid_render::{FilmLayer, Plan, PreparedScene, Session};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Light, Material, Object, ScalarInput, Scene, SubsurfaceModel,
    WalkSurface,
};
use translucid_shapes::{ShapeParameters, build_shape};
use wgpu::naga;

use super::*;

/// The stride of slots is that of the shaders.
#[test]
fn slots_have_the_size_of_the_shaders() {
    let module = match naga::front::wgsl::parse_str(&text()) {
        Ok(module) => module,
        Err(error) => panic!("{}", error.emit_to_string(&text())),
    };
    let span = module.types.iter().find_map(|(_, kind)| match (&kind.name, &kind.inner) {
        (Some(name), naga::TypeInner::Struct { span, .. }) if name == "Slot" => Some(*span),
        _ => None,
    });
    assert_eq!(span.map(u64::from), Some(SLOT_BYTES));
}

fn tracer() -> &'static Arc<Tracer> {
    static TRACER: OnceLock<Arc<Tracer>> = OnceLock::new();
    TRACER.get_or_init(|| Arc::new(Tracer::new(evaluate::open()).unwrap()))
}

/// Means of a picture's layers, over pixels, in runs with different seeds.
fn means(scene: &Scene, runs: u64, samples: u32, device: Option<&Arc<Tracer>>) -> Vec<[f64; 25]> {
    let run = |seed: u64| {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        let film = picture(&scene, samples, device).film();
        let mut means = [0.0; 25];
        let channels = FilmLayer::ALL.into_iter().flat_map(|layer| {
            let (values, n) = (film.layer(layer), layer.channels());
            let pixels = (values.len() / n) as f64;
            (0..n)
                .map(|c| values.iter().skip(c).step_by(n).map(|value| f64::from(*value)).sum::<f64>() / pixels)
                .collect::<Vec<_>>()
        });
        means.iter_mut().zip(channels).for_each(|(mean, channel)| *mean = channel);
        means
    };
    (0..runs).map(run).collect()
}

fn picture(scene: &Scene, samples: u32, device: Option<&Arc<Tracer>>) -> Session {
    let prepared = PreparedScene::new(scene.clone()).unwrap();
    let view = prepared.view().unwrap();
    let mut session = Session::new(prepared, view);
    if let Some(device) = device {
        session.set_device(Some(Arc::clone(device) as Arc<dyn TracingDevice>)).unwrap();
    }
    session.run(&Plan::samples(samples), &|_| {}, &AtomicBool::new(false)).unwrap();
    session
}

/// Every channel of every layer has the same mean, within 5 standard errors of the runs' differences.
///
/// With 8 runs on each side, Welch's t of a channel is beyond 7 by chance in less than 1 of 1e5 cases.
fn check(name: &str, scene: &Scene, samples: u32) {
    let runs = 8;
    let both = [None, Some(tracer())].map(|device| means(scene, runs, samples, device));
    for channel in 0..25 {
        let [ours, theirs] = both.each_ref().map(|runs| {
            let n = runs.len() as f64;
            let mean = runs.iter().map(|run| run[channel]).sum::<f64>() / n;
            let squares = runs.iter().map(|run| (run[channel] - mean).powi(2)).sum::<f64>();
            (mean, squares / (n * (n - 1.0)))
        });
        let error = (ours.1 + theirs.1).sqrt();
        let difference = theirs.0 - ours.0;
        // Features that are no random numbers differ by rounding
        let rounding = 1e-5 * ours.0.abs() + 1e-7;
        if std::env::var("PRINT").is_ok() && ours.0 != 0.0 {
            println!("{name} {channel}: {:.6} {:.6} z {:.2}, error {:.2} %", ours.0, theirs.0, difference / error, 100.0 * error / ours.0);
        }
        assert!(
            difference.abs() <= 7.0 * error + rounding,
            "{name}, channel {channel}: {} on the processor, {} on the device, error {error}",
            ours.0,
            theirs.0
        );
    }
}

fn shape(name: &str, size: f32, at: Vec3, material: usize, group: u32) -> Object {
    let mut mesh = build_shape(name, &ShapeParameters::new()).unwrap();
    mesh.positions.iter_mut().for_each(|position| *position = *position * size + at);
    Object { name: name.into(), mesh: mesh.into(), material, subsurface_group: group, ..Object::default() }
}

/// A ball and a block under an even sky.
fn scene(ball: Material, block: Material) -> Scene {
    Scene {
        camera: Camera { position: Vec3::new(0.0, 1.0, 4.5), target: Vec3::ZERO, ..Camera::default() },
        film: Film { width: 12, height: 12, ..Film::default() },
        objects: vec![shape("sphere", 1.0, Vec3::ZERO, 0, 0), shape("box", 1.0, Vec3::new(1.0, -2.0, 0.3), 1, 1)],
        materials: vec![ball, block],
        environment: Some(Environment { radiance: Vec3::new(0.8, 1.0, 1.2), ..Environment::default() }),
        ..Scene::default()
    }
}

fn matte() -> Material {
    Material {
        name: "matte".into(),
        base_color: ColorInput::constant(Vec3::new(0.7, 0.3, 0.2)),
        ..Material::default()
    }
}

fn wax(surface: WalkSurface) -> Material {
    Material {
        name: "wax".into(),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.7, 0.4)),
        subsurface_radius: ScalarInput::constant(0.3),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.5, 0.2)),
        subsurface_model: SubsurfaceModel::RandomWalk(surface),
        ..Material::default()
    }
}

fn lamp() -> Light {
    Light::Rectangle {
        center: Vec3::new(2.0, 4.0, 2.0),
        edge_x: Vec3::Z,
        edge_y: Vec3::X,
        radiance: Vec3::splat(20.0),
        visible: true,
    }
}

#[test]
fn surfaces_have_the_means_of_the_processor() {
    let clear = Material {
        name: "glass".into(),
        transmission_weight: ScalarInput::constant(0.8),
        coat_weight: ScalarInput::constant(0.5),
        coat_color: ColorInput::constant(Vec3::new(0.9, 0.8, 0.7)),
        coat_roughness: ScalarInput::constant(0.2),
        ..matte()
    };
    let metal = Material { base_metalness: ScalarInput::constant(0.9), ..matte() };
    for (name, ball, caustics) in
        [("matte", matte(), false), ("glass", clear.clone(), false), ("glass with caustics", clear, true), ("metal", metal, false)]
    {
        let mut scene = scene(ball, matte());
        scene.integrator.caustics = caustics;
        scene.lights.push(lamp());
        check(name, &scene, 64);
    }
}

#[test]
fn walks_have_the_means_of_the_processor() {
    for surface in WalkSurface::ALL {
        let mut scene = scene(wax(surface), matte());
        scene.lights.push(lamp());
        check(surface.name_of_walk(), &scene, 64);
    }
    let refracting = Material { subsurface_eta: 1.4, subsurface_scatter_anisotropy: 0.6, ..wax(WalkSurface::Clear) };
    check("refracting", &scene(refracting, matte()), 64);
}
