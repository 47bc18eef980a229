//! Instances on a device against the triangles that they stand for, which the processor has in the world.
//!
//! Both have the same random numbers, so that pixels are equal to rounding, wherever it does not lead to other surfaces.

#![allow(clippy::print_stdout, reason = "the figures are for those who ask with --nocapture")]

use std::sync::Arc;

use glam::{Affine3A, EulerRot, Quat, Vec2, Vec3};
use translucid_profile::Model;
use translucid_render::device::{DeviceLimits, DeviceScene, DeviceTrees, Header};
use translucid_render::{FilmLayer, PreparedScene};
use translucid_scene::{
    Camera, Channel, ColorInput, Environment, Film, Material, Mesh, NormalMap, Object, ScalarInput, Scene,
    TextureRef, WalkSurface,
};
use translucid_shapes::{ShapeParameters, build_shape};

use super::Tracer;
use super::profile_tests::{differing, profile};
use super::tests::{lamp, matte, picture, texture, tracer, wax};

/// Stretches of the places: as it is, larger, mirrored, long and flat, mirrored thrice, small.
const SCALES: [Vec3; 6] = [
    Vec3::ONE,
    Vec3::splat(1.3),
    Vec3::new(-1.0, 1.0, 1.0),
    Vec3::new(0.6, 1.0, 1.6),
    Vec3::new(-1.4, -0.7, -1.0),
    Vec3::splat(0.5),
];

/// Bytes of a device's array.
const LIMITS: DeviceLimits = DeviceLimits { array_bytes: 1 << 27 };

/// A torus with all that vertices may have.
fn torus() -> Mesh {
    let parameters = ShapeParameters::new().with("segments", 24.0).with("tube_segments", 16.0);
    let mut mesh = build_shape("torus", &parameters).unwrap();
    // Tangents that differ much within a triangle, with signs of both kinds
    let tangent = |(p, n): (&Vec3, &Vec3)| {
        let along = Vec3::new(1.0, 0.3, 0.0) + (4.0 * *p).map(f32::sin);
        (along - *n * n.dot(along)).normalize().extend(if p.x < 0.0 { -1.0 } else { 1.0 })
    };
    mesh.tangents = mesh.positions.iter().zip(&mesh.normals).map(tangent).collect();
    mesh.uvs = mesh.positions.iter().map(|p| Vec2::new(p.x, p.z)).collect();
    mesh.colors = mesh.positions.iter().map(|p| 0.5 + 0.5 * p.abs().min(Vec3::ONE)).collect();
    mesh
}

fn place(i: usize) -> Affine3A {
    let at = Vec3::new(2.4 * (i % 3) as f32 - 2.4, 2.0 * (i / 3) as f32 - 1.0, 0.3 * i as f32 - 0.7);
    let turn = Quat::from_euler(EulerRot::XYZ, 1.0 + 0.7 * i as f32, 0.5 * i as f32, 0.4);
    // A scale, a turn and another scale are a shear
    let shear = if i == 3 { Vec3::new(1.0, 0.7, 1.0) } else { Vec3::ONE };
    Affine3A::from_scale_rotation_translation(shear, Quat::IDENTITY, at)
        * Affine3A::from_scale_rotation_translation(0.8 * SCALES[i], turn, Vec3::ZERO)
}

/// A torus of two materials in all places, pairs of which are one body, over a block under a lamp.
fn scene(mesh: Mesh, materials: [Material; 2]) -> Scene {
    let mesh = Arc::new(mesh);
    let torus = |i: usize| Object {
        name: format!("torus {i}"),
        mesh: Arc::clone(&mesh),
        world_from_local: place(i),
        material: i % 2,
        subsurface_group: i as u32 / 2,
        is_movable: false,
    };
    let mut block = build_shape("box", &ShapeParameters::new()).unwrap();
    block.positions.iter_mut().for_each(|p| *p = *p * Vec3::new(8.0, 1.0, 8.0) - 2.5 * Vec3::Y);
    let block = Object { mesh: block.into(), material: 2, subsurface_group: 9, ..Object::default() };
    let mut scene = Scene {
        camera: Camera { position: Vec3::new(0.0, 2.0, 8.0), target: Vec3::ZERO, ..Camera::default() },
        film: Film { width: 32, height: 32, ..Film::default() },
        objects: (0..SCALES.len()).map(torus).chain([block]).collect(),
        materials: materials.into_iter().chain([matte()]).collect(),
        environment: Some(Environment { radiance: Vec3::new(0.8, 1.0, 1.2), ..Environment::default() }),
        ..Scene::default()
    };
    scene.lights.push(lamp());
    scene.images.push(Arc::new(texture()));
    scene.integrator.subsurface_sharing = false;
    scene.validate().unwrap();
    scene
}

/// The scene with meshes that have trees of their own, however small they are.
fn shared(mut scene: Scene) -> Scene {
    scene
        .objects
        .iter_mut()
        .for_each(|object| object.is_movable = object.world_from_local != Affine3A::IDENTITY);
    scene
}

fn on_device(scene: &Scene, limits: &DeviceLimits) -> Result<DeviceScene, String> {
    let prepared = PreparedScene::new(scene.clone()).unwrap();
    let view = prepared.view().unwrap();
    DeviceScene::new(&prepared, &view, limits).map_err(|error| error.to_string())
}

fn instances(scene: &DeviceScene) -> usize {
    scene.tables[Header::Instances as usize] as usize
}

/// At most a share of the pixels differs by more than 1e-3 of their light from those of the triangles, and the sum is the same
/// within 6 roots of the sum of squares, beyond which it is in less than 2e^−18 = 3e-8 of all cases, and 1e-3.
fn check(name: &str, scene: &Scene, expected: usize, most: f32, triangles_on: Option<&Arc<Tracer>>) {
    let placed = shared(scene.clone());
    assert_eq!(instances(&on_device(&placed, &LIMITS).unwrap()), expected, "{name}");
    let found = [(scene, triangles_on), (&placed, Some(tracer()))].map(|(scene, device)| {
        let radiance = picture(scene, 4, device).film().layer(FilmLayer::Radiance);
        radiance.chunks(3).map(Vec3::from_slice).collect::<Vec<_>>()
    });
    let share = differing(&found, 1e-3);
    println!("{name}: {share} of the pixels differ");
    assert!(share <= most, "{name}: {share} of the pixels differ");
    for c in 0..3 {
        let pairs = || found[0].iter().zip(&found[1]).map(|(a, b)| (f64::from(a[c]), f64::from(b[c])));
        let sum: f64 = pairs().map(|(a, b)| b - a).sum();
        let squares: f64 = pairs().map(|(a, b)| (b - a).powi(2)).sum();
        let light: f64 = pairs().map(|(a, _)| a).sum();
        assert!(sum.abs() <= 6.0 * squares.sqrt() + 1e-3 * light, "{name}, channel {c}: {sum} of {light}");
    }
}

/// Normals, texture coordinates, colors and normal maps, whose tangents come from the mesh or from texture coordinates.
#[test]
fn surfaces_of_instances_are_the_processors() {
    let map = TextureRef::new(0);
    let painted = Material {
        base_color: ColorInput { factor: Vec3::ONE, texture: Some(map), vertex_color: true },
        geometry_opacity: ScalarInput { factor: 0.9, texture: Some((map, Channel::Alpha)) },
        geometry_normal: Some(NormalMap { texture: map, scale: 0.5 }),
        ..matte()
    };
    let bare = Material { specular_weight: ScalarInput::constant(0.0), ..painted.clone() };
    let without = |mut mesh: Mesh| {
        mesh.tangents.clear();
        mesh
    };
    let flat = |mesh: Mesh| Mesh { normals: Vec::new(), ..without(mesh) };
    for (name, mesh) in
        [("tangents", torus()), ("no tangents", without(torus())), ("no normals", flat(torus()))]
    {
        check(name, &scene(mesh, [painted.clone(), bare.clone()]), 6, 0.03, None);
    }
}

/// Light passes thin walls straight, and those that emit stay in the world.
#[test]
fn walls_and_emitters_are_the_processors() {
    let pane = Material {
        geometry_thin_walled: true,
        transmission_weight: ScalarInput::constant(0.9),
        specular_roughness: ScalarInput::constant(0.0),
        ..matte()
    };
    let glow = Material { emission_luminance: 2.0, specular_weight: ScalarInput::constant(0.0), ..matte() };
    check("walls", &scene(torus(), [pane.clone(), pane.clone()]), 6, 0.1, None);
    // Light samples of both sides differ here, as those of triangles that emit do anywhere
    let lit = scene(torus(), [pane, glow]);
    check("emitters", &lit, 3, 1.0, None);
    check("emitters, on the device alone", &lit, 3, 0.1, Some(tracer()));
}

#[test]
fn walks_in_instances_are_the_processors() {
    let bare = ScalarInput::constant(0.0);
    let wax =
        |surface| Material { specular_weight: bare, subsurface_scatter_anisotropy: 0.3, ..wax(surface) };
    check("walks", &scene(torus(), [wax(WalkSurface::Diffuse), wax(WalkSurface::Clear)]), 6, 0.1, None);
}

/// Two instances are one body.
#[test]
fn profiles_on_instances_are_the_processors() {
    let even = profile(Model::NormalizedDiffusion);
    check("profiles", &scene(torus(), [even.clone(), even]), 6, 0.05, None);
}

/// After edits of a material, of a place and of a mesh.
#[test]
fn edited_scenes_have_the_words_of_new_ones() {
    let mut scene = shared(scene(torus(), [matte(), matte()]));
    let mut trees = DeviceTrees::default();
    let edits: [fn(&mut Scene); 4] = [
        |_| {},
        |scene| scene.materials[0].base_color.factor = Vec3::ONE,
        |scene| scene.objects[1].world_from_local.translation.x += 0.5,
        |scene| scene.objects[6].mesh = torus().into(),
    ];
    for edit in edits {
        edit(&mut scene);
        let prepared = PreparedScene::new(scene.clone()).unwrap();
        let view = prepared.view().unwrap();
        let edited = DeviceScene::edited(&prepared, &view, &LIMITS, &mut trees).unwrap();
        assert!(edited == DeviceScene::new(&prepared, &view, &LIMITS).unwrap());
    }
}

/// Each more has its own words and two nodes; the mesh is there once.
#[test]
fn memory_grows_by_the_words_of_instances() {
    let many = |count: usize| {
        let mut scene = shared(scene(torus(), [matte(), matte()]));
        let place = |i| {
            let world_from_local = Affine3A::from_translation(Vec3::X * (1 + i) as f32);
            Object { world_from_local, ..scene.objects[0].clone() }
        };
        scene.objects = (0..count).map(place).collect();
        on_device(&scene, &LIMITS).unwrap()
    };
    let (one, all) = (many(1), many(1000));
    assert_eq!((instances(&one), instances(&all)), (1, 1000));
    let triangles = torus().triangles.len();
    for scene in [&one, &all] {
        assert_eq!((scene.triangles.len(), scene.attributes.len()), (12 * triangles, one.attributes.len()));
    }
    assert_eq!(one.nodes.len(), 32 + 8 * (1 + 2 * triangles - 1));
    assert_eq!(all.nodes.len() - one.nodes.len(), 999 * (32 + 2 * 8));
    assert_eq!((all.tables.len(), all.images.len()), (one.tables.len(), one.images.len()));
}

/// Small meshes are shared where an array would be too large otherwise, and what is still too large is refused.
#[test]
fn meshes_are_shared_where_memory_is_tight() {
    let scene = scene(torus(), [matte(), matte()]);
    let found = |array_bytes| on_device(&scene, &DeviceLimits { array_bytes });
    let plenty = found(1 << 27).unwrap();
    assert_eq!(instances(&plenty), 0);
    let bytes = 4 * plenty.nodes.len().max(plenty.attributes.len()) as u64;
    let tight = found(bytes / 2).unwrap();
    assert_eq!(instances(&tight), 6);
    assert!(4 * tight.nodes.len().max(tight.attributes.len()) as u64 <= bytes / 2);
    let error = found(bytes / 8).unwrap_err();
    assert!(
        error.contains("triangles, those of shared meshes counted once, but the device holds"),
        "{error}"
    );
}

/// More nodes than a ray has room for never wait: trees that are so high are refused.
#[test]
fn trees_that_are_too_high_are_refused() {
    let mut scene = scene(torus(), [matte(), matte()]);
    let nested = |i: usize| {
        let size = 1.3_f32.powi(i as i32 - 50);
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| (p - 0.3) * size).to_vec();
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        Object { mesh: mesh.into(), ..Object::default() }
    };
    scene.objects = (0..60).map(nested).collect();
    on_device(&scene, &LIMITS).unwrap();
    scene.objects = (0..100).map(nested).collect();
    let error = on_device(&scene, &LIMITS).unwrap_err();
    assert!(
        error.contains("levels of boxes around its triangles but the device holds at most 64"),
        "{error}"
    );
}
