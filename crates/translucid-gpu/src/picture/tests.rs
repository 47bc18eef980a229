//! Pictures of a device against those of the processor.

use std::sync::OnceLock;

use glam::{Affine2, Affine3A, Vec2, Vec3};
use translucid_render::{FilmLayer, OnDevice, Plan, PreparedScene, Session};
use translucid_scene::{
    Camera, CameraVisibility, Channel, ColorInput, ColorSpace, Environment, Film, Image, Light, Material,
    Mesh, NormalMap, Object, Pixels, Projection, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel,
    TextureFilter, TextureRef, WalkSurface, Wrap,
};
use translucid_shapes::{ShapeParameters, build_shape};

use super::*;

/// Channels of all layers.
const CHANNELS: usize = 23;

pub(super) fn tracer() -> &'static Arc<Tracer> {
    static TRACER: OnceLock<Arc<Tracer>> = OnceLock::new();
    TRACER.get_or_init(|| Arc::new(Tracer::new(evaluate::open()).unwrap()))
}

/// Means of a picture's layers, over pixels, in runs with different seeds.
fn means(scene: &Scene, runs: u64, samples: u32, device: Option<&Arc<Tracer>>) -> Vec<[f64; CHANNELS]> {
    let run = |seed: u64| {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        let film = picture(&scene, samples, device).film();
        let mut means = [0.0; CHANNELS];
        let channels = FilmLayer::ALL.into_iter().flat_map(|layer| {
            let (values, n) = (film.layer(layer), layer.channels());
            let pixels = (values.len() / n) as f64;
            (0..n)
                .map(|c| {
                    values.iter().skip(c).step_by(n).map(|value| f64::from(*value)).sum::<f64>() / pixels
                })
                .collect::<Vec<_>>()
        });
        means.iter_mut().zip(channels).for_each(|(mean, channel)| *mean = channel);
        means
    };
    (0..runs).map(run).collect()
}

pub(super) fn picture(scene: &Scene, samples: u32, device: Option<&Arc<Tracer>>) -> Session {
    let prepared = PreparedScene::new(scene.clone()).unwrap();
    let view = prepared.view().unwrap();
    let mut session = Session::new(prepared, view);
    if let Some(device) = device {
        session.set_device(Some(OnDevice::required(Arc::clone(device) as Arc<dyn TracingDevice>))).unwrap();
    }
    session.run(&Plan::samples(samples), &|_| {}, &AtomicBool::new(false)).unwrap();
    session
}

/// Every channel of every layer has the same mean, within 8 standard errors by the differences of 4 runs on each side.
///
/// Most samples are the same on both sides, so that the errors are far above the differences; where they are not (walks share
/// light on the processor, mirrors are followed both ways), Student's t of 6 degrees of freedom is beyond 8 in 2 of 10,000
/// cases, and a test here has some 50 channels that differ.
fn check(name: &str, scene: &Scene, samples: u32) {
    let both = [None, Some(tracer())].map(|device| means(scene, 4, samples, device));
    for channel in 0..CHANNELS {
        let [ours, theirs] = both.each_ref().map(|runs| {
            let n = runs.len() as f64;
            let mean = runs.iter().map(|run| run[channel]).sum::<f64>() / n;
            let squares = runs.iter().map(|run| (run[channel] - mean).powi(2)).sum::<f64>();
            (mean, squares / (n * (n - 1.0)))
        });
        let error = (ours.1 + theirs.1).sqrt();
        // Features that are no random numbers differ by rounding
        let rounding = 2e-5 * ours.0.abs() + 1e-6;
        assert!(
            (theirs.0 - ours.0).abs() <= 8.0 * error + rounding,
            "{name}, channel {channel}: {} on the processor, {} on the device, error {error}",
            ours.0,
            theirs.0
        );
    }
}

pub(super) fn shape(name: &str, size: f32, at: Vec3, material: usize, group: u32) -> Object {
    let mut mesh = build_shape(name, &ShapeParameters::new()).unwrap();
    mesh.positions.iter_mut().for_each(|position| *position = *position * size + at);
    Object { name: name.into(), mesh: mesh.into(), material, subsurface_group: group, ..Object::default() }
}

/// A ball and a block under an even sky.
pub(super) fn scene(ball: Material, block: Material) -> Scene {
    Scene {
        camera: Camera { position: Vec3::new(0.0, 1.0, 4.5), target: Vec3::ZERO, ..Camera::default() },
        film: Film { width: 12, height: 12, ..Film::default() },
        objects: vec![
            shape("sphere", 1.0, Vec3::ZERO, 0, 0),
            shape("box", 1.0, Vec3::new(1.0, -2.0, 0.3), 1, 1),
        ],
        materials: vec![ball, block],
        environment: Some(Environment { radiance: Vec3::new(0.8, 1.0, 1.2), ..Environment::default() }),
        ..Scene::default()
    }
}

pub(super) fn matte() -> Material {
    Material {
        name: "matte".into(),
        base_color: ColorInput::constant(Vec3::new(0.7, 0.3, 0.2)),
        ..Material::default()
    }
}

pub(super) fn wax(surface: WalkSurface) -> Material {
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

pub(super) fn lamp() -> Light {
    Light::Rectangle {
        center: Vec3::new(2.0, 4.0, 2.0),
        edge_x: Vec3::X,
        edge_y: Vec3::Z,
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
    let tinted = Material {
        transmission_color: ColorInput::constant(Vec3::new(0.9, 0.6, 0.3)),
        transmission_depth: 0.5,
        transmission_tint: ColorInput::constant(Vec3::new(0.5, 0.8, 0.9)),
        ..clear.clone()
    };
    let metal = Material { base_metalness: ScalarInput::constant(0.9), ..matte() };
    for (name, ball, caustics) in [
        ("matte", matte(), false),
        ("glass", clear.clone(), false),
        ("glass with caustics", clear, true),
        ("glass with a tint and a depth", tinted, true),
        ("metal", metal, false),
    ] {
        let mut scene = scene(ball, matte());
        scene.integrator.caustics = caustics;
        scene.lights.push(lamp());
        check(name, &scene, 16);
    }
}

/// Software takes minutes for each: the boundaries but the first wait for the whole power of tests.
#[test]
fn walks_have_the_means_of_the_processor() {
    let is_thorough = translucid_testing::is_thorough();
    let surfaces = if is_thorough { &WalkSurface::ALL[..] } else { &WalkSurface::ALL[..1] };
    for &surface in surfaces {
        let mut scene = scene(wax(surface), matte());
        scene.lights.push(lamp());
        check(surface.name_of_walk(), &scene, 16);
    }
    if is_thorough {
        let refracting =
            Material { subsurface_eta: 1.4, subsurface_scatter_anisotropy: 0.6, ..wax(WalkSurface::Clear) };
        check("refracting", &scene(refracting, matte()), 16);
    }
}

/// A cross with letters to tell its corners apart.
pub(super) fn texture() -> Image {
    let texel = |k: u8| [40 * (k % 6), 30 * (k / 4), 255 - 15 * k, 255 - 9 * k];
    Image {
        name: "texture".into(),
        path: None,
        width: 4,
        height: 4,
        color_space: ColorSpace::Srgb,
        pixels: Pixels::Byte((0..16).map(texel).collect()),
    }
}

#[test]
fn textures_have_the_means_of_the_processor() {
    let map = |wrap| TextureRef {
        image_from_uv: Affine2::from_scale_angle_translation(Vec2::new(1.7, -0.6), 0.4, Vec2::new(0.2, -0.3)),
        wrap,
        ..TextureRef::new(0)
    };
    let all =
        [[Wrap::Repeat, Wrap::Mirror], [Wrap::Clamp, Wrap::Repeat], [Wrap::Mirror, Wrap::Clamp]].map(map);
    let all = [TextureRef { filter: TextureFilter::Nearest, ..all[0] }, all[1], all[2]];
    let ball = Material {
        base_color: ColorInput {
            factor: Vec3::new(0.9, 0.7, 0.5),
            texture: Some(all[0]),
            vertex_color: true,
        },
        specular_roughness: ScalarInput { factor: 0.8, texture: Some((all[1], Channel::Green)) },
        geometry_opacity: ScalarInput { factor: 0.9, texture: Some((all[2], Channel::Alpha)) },
        geometry_normal: Some(NormalMap { texture: all[1], scale: 0.5 }),
        ..matte()
    };
    let mut scene = scene(ball, matte());
    color_by_place(&mut scene.objects[0]);
    scene.images.push(Arc::new(texture()));
    check("textures", &scene, 16);
}

/// A ball that is bright in parts, and there in parts, sheds the light on a block that paths find.
#[test]
fn emission_that_varies_has_the_means_of_the_processor() {
    let map = TextureRef { image_from_uv: Affine2::from_scale(Vec2::splat(1.7)), ..TextureRef::new(0) };
    let color = ColorInput { factor: Vec3::new(0.9, 0.7, 0.5), texture: Some(map), vertex_color: true };
    let ball = Material { emission_luminance: 3.0, emission_color: color, ..matte() };
    let partly = ScalarInput { factor: 0.8, texture: Some((map, Channel::Alpha)) };
    for (name, material) in [
        ("a texture and vertex colors", ball.clone()),
        ("opacity", Material { geometry_opacity: partly, ..ball }),
    ] {
        let mut scene = scene(material, matte());
        color_by_place(&mut scene.objects[0]);
        scene.images.push(Arc::new(texture()));
        scene.environment = None;
        check(name, &scene, 16);
    }
}

/// Gives an object texture coordinates and vertex colors that are functions of the place.
pub(super) fn color_by_place(object: &mut Object) {
    let mesh = Arc::make_mut(&mut object.mesh);
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect();
    mesh.colors = mesh.positions.iter().map(|p| p.abs()).collect();
}

/// A pane lets light pass straight, whichever way it comes: the light of lamps with a size and without one.
#[test]
fn thin_walls_have_the_means_of_the_processor() {
    let pane = Material {
        name: "pane".into(),
        geometry_thin_walled: true,
        transmission_weight: ScalarInput::constant(0.9),
        transmission_color: ColorInput::constant(Vec3::new(0.9, 0.7, 0.8)),
        specular_roughness: ScalarInput::constant(0.0),
        ..matte()
    };
    let leaf = Material {
        subsurface_weight: ScalarInput::constant(0.8),
        subsurface_scatter_anisotropy: 0.4,
        specular_roughness: ScalarInput::constant(0.4),
        ..pane.clone()
    };
    for (name, wall, caustics) in
        [("pane", pane.clone(), false), ("pane with caustics", pane, true), ("leaf", leaf, true)]
    {
        let mut scene = scene(matte(), matte());
        scene.materials.push(wall);
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mesh = Mesh {
            positions: corners.map(|[x, y]| Vec3::new(6.0 * x - 3.0, 1.5 + y, 4.0 - 4.0 * y)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        scene.objects.push(Object {
            name: "wall".into(),
            mesh: mesh.into(),
            material: 2,
            ..Object::default()
        });
        scene.integrator.caustics = caustics;
        scene.lights.push(lamp());
        scene.lights.push(Light::Distant {
            direction: -Vec3::Y,
            angular_radius: 0.0,
            irradiance: Vec3::splat(2.0),
        });
        check(name, &scene, 16);
    }
}

/// Shadows of a ball on a block of which nothing else is seen, in light of all kinds, also behind glass and a body of wax.
#[test]
fn shadow_catchers_have_the_means_of_the_processor() {
    let catcher = Material { camera_visibility: CameraVisibility::Shadow, ..matte() };
    let glass = Material {
        transmission_weight: ScalarInput::constant(0.9),
        geometry_opacity: ScalarInput::constant(0.8),
        ..matte()
    };
    let clear = Material { subsurface_radius: ScalarInput::constant(3.0), ..wax(WalkSurface::Clear) };
    for (name, ball) in [("matte", matte()), ("glass", glass), ("wax", clear)] {
        let mut scene = scene(ball, catcher.clone());
        scene.objects[1] = shape("box", 3.0, Vec3::new(0.0, -4.0, 0.0), 1, 1);
        scene.lights = vec![
            lamp(),
            Light::Distant { direction: -Vec3::Y, angular_radius: 0.0, irradiance: Vec3::splat(2.0) },
        ];
        scene.environment = scene.environment.map(|sky| Environment { visible: false, ..sky });
        check(name, &scene, 16);
    }
}

#[test]
fn lights_and_cameras_have_the_means_of_the_processor() {
    let mut scene = scene(matte(), Material { emission_luminance: 0.5, ..matte() });
    let place = Vec3::new(-2.0, 3.0, 2.5);
    scene.lights = vec![
        lamp(),
        Light::Sphere { center: place, radius: 0.4, radiance: Vec3::splat(6.0), visible: true },
        Light::Distant { direction: Vec3::NEG_ONE.normalize(), angular_radius: 0.1, irradiance: Vec3::X },
        Light::Distant { direction: -Vec3::Y, angular_radius: 0.0, irradiance: Vec3::splat(0.2) },
        Light::Spot {
            position: Vec3::new(0.0, 5.0, 1.0),
            direction: -Vec3::Y,
            radius: 0.0,
            intensity: Vec3::splat(4.0),
            inner_angle: 10.0,
            outer_angle: 25.0,
            visible: false,
        },
    ];
    scene.images.push(Arc::new(texture()));
    scene.environment = Some(Environment { image: Some(0), ..scene.environment.unwrap() });
    check("pinhole", &scene, 16);
    scene.camera.lens_radius = 0.2;
    scene.camera.focus_distance = 4.0;
    scene.camera.shift = Vec2::new(0.1, -0.2);
    scene.environment = scene.environment.map(|sky| Environment { visible: false, ..sky });
    check("lens", &scene, 16);
    scene.camera.lens_radius = 1000.0;
    check("widest lens", &scene, 16);
    scene.camera.lens_radius = 0.2;
    scene.camera.projection = Projection::Orthographic { width: 5.0 };
    check("parallel", &scene, 16);
}

/// Rays that are aimed at the edge between two walls meet one of them, also where rounding errors of the far corners are larger
/// than the distance by which they miss the edge.
#[test]
fn edges_of_long_walls_let_no_ray_through() {
    let corners = [-1.0, 0.0, 1.0].into_iter().flat_map(|x| [-20.0, 20.0].map(|y| Vec3::new(x, y, 0.0)));
    let mesh = Arc::new(Mesh {
        positions: corners.collect(),
        triangles: vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]],
        ..Mesh::default()
    });
    let black = Material {
        base_color: ColorInput::constant(Vec3::ZERO),
        specular_weight: ScalarInput::constant(0.0),
        ..matte()
    };
    for is_movable in [false, true] {
        let mut scene = scene(black.clone(), black.clone());
        scene.camera = Camera {
            position: Vec3::new(0.005, -0.01, 0.003),
            target: Vec3::ZERO,
            projection: Projection::Orthographic { width: 4e-6 },
            ..Camera::default()
        };
        let world_from_local = Affine3A::from_translation(if is_movable { Vec3::Y } else { Vec3::ZERO });
        scene.objects =
            vec![Object { mesh: Arc::clone(&mesh), world_from_local, is_movable, ..Object::default() }];
        for device in [None, Some(tracer())] {
            let light = picture(&scene, 16, device).film().layer(FilmLayer::Radiance);
            let lit = light.iter().filter(|&&value| value > 0.0).count();
            assert_eq!(lit, 0, "the sky shines through {lit} of {} channels of pixels", light.len());
        }
    }
}

/// Paths at a time have no part in the bits, and a picture goes on where it was stopped.
#[test]
fn shares_of_work_have_no_part_in_the_bits() {
    let mut scene = scene(wax(WalkSurface::Diffuse), matte());
    (scene.film.width, scene.film.height) = (9, 7);
    let radiance = |session: &Session| session.film().layer(FilmLayer::Radiance);
    let expected = picture(&scene, 5, Some(tracer()));
    let other = Arc::new(Tracer::new(evaluate::open()).unwrap().with_slots(70));
    assert_eq!(radiance(&picture(&scene, 5, Some(&other))), radiance(&expected));
    let mut stopped = picture(&scene, 2, Some(tracer()));
    stopped.run(&Plan::samples(5), &|_| {}, &AtomicBool::new(false)).unwrap();
    assert_eq!(radiance(&stopped), radiance(&expected));
    stopped.run(&Plan::samples(9), &|_| {}, &AtomicBool::new(true)).unwrap();
    assert_eq!(stopped.film().samples(), 5);
}

/// The device's words of refusal.
pub(super) fn refusal(scene: Scene) -> String {
    let prepared = PreparedScene::new(scene).unwrap();
    let limits = DeviceLimits { array_bytes: 1 << 27 };
    let view = prepared.view().unwrap();
    DeviceScene::new(&prepared, &view, &limits).unwrap_err().to_string()
}

#[test]
fn scenes_that_devices_lack_something_for_are_refused_by_name() {
    let mut scene = scene(wax(WalkSurface::Clear), matte());
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    let error = refusal(scene);
    assert!(
        error.contains("integrator.subsurface_method is not \"ray-traced\", which devices lack"),
        "{error}"
    );
}

/// Light without size is not found below a refracting boundary, where no light sample comes; light of any size is.
#[test]
fn light_without_size_is_refused_below_refracting_boundaries() {
    let below = |surface, eta, angular_radius| {
        let mut scene = scene(Material { subsurface_eta: eta, ..wax(surface) }, matte());
        scene.lights.push(Light::Distant { direction: -Vec3::Y, angular_radius, irradiance: Vec3::ONE });
        let prepared = PreparedScene::new(scene).unwrap();
        let view = prepared.view().unwrap();
        DeviceScene::new(&prepared, &view, &DeviceLimits { array_bytes: 1 << 27 }).map(|_| ())
    };
    let error = below(WalkSurface::Clear, 1.4, 0.0).unwrap_err().to_string();
    assert!(error.contains("material wax") && error.contains("lit by a light without size"), "{error}");
    below(WalkSurface::Clear, 1.4, 0.1).unwrap();
    below(WalkSurface::Clear, 1.0, 0.0).unwrap();
    below(WalkSurface::Diffuse, 1.4, 0.0).unwrap();
}
