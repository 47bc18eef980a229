//! Objects that share a mesh against the same objects with meshes of their own.
//!
//! Every test fixes its seeds, of which both sides have different ones. A mean counts as right within four standard errors:
//! by Student's t a false alarm in 2,700 comparisons.

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use translucid_profile::Model;
use translucid_render::{Edit, FilmSums, Geometry, View, internals};
use translucid_scene::{
    Camera, ColorInput, Film, Light, Material, Mesh, Object, ScalarInput, Scene, SubsurfaceMethod,
    SubsurfaceModel, WalkSurface,
};
use translucid_testing::power;

use crate::common::{
    assert_agree, distant, matte, mean_of, prepare, prepare_with_points, sample_ray, samples, scene, sphere,
    uniform_environment,
};

const SAMPLES: u32 = 1 << 15;

/// Objects in a row, and how far one is from the next.
const COUNT: usize = 16;
const STEP: f32 = 6.0;

/// Stretches of the first ones, which are looked at: a turn, a mirror, and both with three different scales.
const SCALES: [Vec3; 4] =
    [Vec3::ONE, Vec3::new(-1.0, 1.0, 1.0), Vec3::new(0.6, 1.5, 1.0), Vec3::new(-1.4, 0.5, -1.0)];

/// A ball with two bumps, as many triangles as make it worth sharing.
fn body() -> Mesh {
    let mut mesh = sphere(1.0, 70);
    for position in &mut mesh.positions {
        *position += 0.3 * position.x.max(0.0).powi(4) * Vec3::new(1.0, 0.5, 0.0);
        position.z *= 1.0 + 0.2 * position.y;
    }
    mesh.normals = mesh.smooth_normals();
    mesh
}

/// The bodies in a row, each turned otherwise.
fn row(material: Material) -> Scene {
    let mut scene = scene(Vec::new(), material);
    let mesh = Arc::new(body());
    assert!(mesh.is_worth_sharing(COUNT));
    scene.objects = (0..COUNT)
        .map(|i| {
            let turn = Quat::from_rotation_x(0.4 * i as f32) * Quat::from_rotation_z(FRAC_PI_2 * i as f32);
            let place = Vec3::X * (STEP * i as f32);
            Object {
                name: format!("body {i}"),
                mesh: Arc::clone(&mesh),
                world_from_local: Affine3A::from_scale_rotation_translation(
                    SCALES[i % SCALES.len()],
                    turn,
                    place,
                ),
                material: 0,
                subsurface_group: i as u32,
                is_movable: false,
            }
        })
        .collect();
    scene
}

/// The scene with a mesh for each object, in its place.
fn baked(mut scene: Scene) -> Scene {
    for object in &mut scene.objects {
        object.mesh = Arc::new(Mesh::clone(&object.mesh).transformed(&object.world_from_local));
        object.world_from_local = Affine3A::IDENTITY;
    }
    scene
}

fn translucent(model: SubsurfaceModel) -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(Vec3::new(0.9, 0.7, 0.3)),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(0.4, 0.2, 0.05)),
        subsurface_model: model,
        ..Material::default()
    }
}

/// Compares the radiance of each kind of place, from the side that a sun lights and from the other.
fn assert_same_light(name: &str, scene: &Scene) {
    let both = [prepare(scene.clone()), prepare(baked(scene.clone()))];
    for i in 0..SCALES.len() {
        let target = Vec3::X * (STEP * i as f32) + Vec3::new(0.1, 0.2, 0.0);
        for from in [Vec3::new(0.3, 0.6, 3.0), Vec3::new(-0.5, -0.3, -3.0)] {
            let light = |side: usize, seeds: u64| {
                mean_of(power(SAMPLES.into()) as u32, |seed, index| {
                    let direction = -from.normalize();
                    sample_ray(&both[side], target + from, direction, seed + seeds, index).radiance()
                })
            };
            let (shared, flat) = (light(0, 0), light(1, 100_000));
            assert!(shared.0.max_element() > 0.0, "{name}, body {i}: it is dark");
            assert_agree(&format!("{name}, body {i}"), shared, flat);
        }
    }
}

#[test]
fn surfaces_of_instances_are_lit_alike() {
    let mut scene = row(matte(Vec3::new(0.8, 0.5, 0.2)));
    scene.integrator.max_depth = 3;
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.lights.push(distant(Vec3::new(0.5, 1.0, 0.7)));
    assert_same_light("matte", &scene);
}

#[test]
fn probes_in_instances_find_the_same_light() {
    let profile = SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined);
    let mut scene = row(translucent(profile));
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.lights.push(distant(Vec3::new(0.5, 1.0, 0.7)));
    assert_same_light("probes", &scene);
}

#[test]
fn walks_in_instances_find_the_same_light() {
    for surface in [WalkSurface::Clear, WalkSurface::Diffuse] {
        let mut scene = row(translucent(SubsurfaceModel::RandomWalk(surface)));
        scene.environment = uniform_environment(Vec3::splat(0.3));
        scene.lights.push(distant(Vec3::new(0.5, 1.0, 0.7)));
        assert_same_light(&format!("{surface:?} walks"), &scene);
    }
}

/// Light of a sun and of a lamp comes in through the boundary, refracted, which is found facet by facet: in the mesh's own
/// space where that keeps angles, in the world's where not.
#[test]
fn refracted_light_in_instances_is_the_same() {
    let material = Material {
        specular_weight: ScalarInput::constant(1.0),
        specular_ior: 1.4,
        specular_roughness: ScalarInput::constant(0.0),
        subsurface_eta: 1.4,
        ..translucent(SubsurfaceModel::RandomWalk(WalkSurface::Clear))
    };
    for light in [
        distant(Vec3::new(0.5, 1.0, 0.7)),
        Light::Spot {
            radius: 0.0,
            visible: true,
            position: Vec3::new(9.0, 12.0, 9.0),
            direction: Vec3::new(0.0, -0.8, -0.6),
            intensity: Vec3::splat(300.0),
            inner_angle: 80.0,
            outer_angle: 180.0,
        },
    ] {
        let mut scene = row(material.clone());
        scene.lights.push(light);
        assert_same_light("refracted", &scene);
    }
}

/// Overlapping bodies of one group exchange light as those do whose triangles lie in one tree.
#[test]
fn instances_of_one_group_are_one_body() {
    let mut scene = row(translucent(SubsurfaceModel::RandomWalk(WalkSurface::Diffuse)));
    for (i, object) in scene.objects.iter_mut().skip(COUNT / 2).enumerate() {
        object.world_from_local.translation.x = STEP * i as f32 + 0.9;
        object.subsurface_group = i as u32;
    }
    scene.lights.push(distant(Vec3::new(0.5, 1.0, 0.7)));
    assert_same_light("one group", &scene);
}

/// Emissive instances are lamps: they light a wall beside them as their triangles would, by light samples and by paths.
#[test]
fn emissive_instances_shed_the_same_light() {
    let mut scene = row(matte(Vec3::splat(0.5)));
    let lamp = Material { emission_luminance: 2.0, ..matte(Vec3::ZERO) };
    scene.materials.push(lamp);
    scene.objects.iter_mut().skip(1).for_each(|object| object.material = 1);
    scene.integrator.max_depth = 2;
    let both = [prepare(scene.clone()), prepare(baked(scene))];
    let light = |side: usize, seeds: u64| {
        mean_of(samples(SAMPLES), |seed, index| {
            let origin = Vec3::new(0.2, 0.1, 3.0);
            sample_ray(&both[side], origin, Vec3::NEG_Z, seed + seeds, index).radiance()
        })
    };
    let (shared, flat) = (light(0, 0), light(1, 100_000));
    assert!(shared.0.min_element() > 1e-3, "{shared:?}");
    assert_agree("lamps", shared, flat);
}

#[test]
fn points_on_instances_find_the_same_light() {
    let profile = SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined);
    let mut scene = row(translucent(profile));
    scene.integrator.subsurface_method = SubsurfaceMethod::PointBased;
    scene.lights.push(distant(Vec3::new(0.5, 1.0, 0.7)));
    scene.integrator.point_tolerance = 1.0;
    let both = [scene.clone(), baked(scene)].map(|scene| prepare_with_points(scene, 1 << 30).unwrap());
    let target = Vec3::X * STEP;
    let [shared, flat] = [0, 1].map(|side: usize| {
        mean_of(1024, |seed, index| {
            sample_ray(&both[side], target + Vec3::Z * 4.0, Vec3::NEG_Z, seed, index).radiance()
        })
    });
    // The points are thrown alike, and so is the light that enters there
    assert!((shared.0 / flat.0 - 1.0).abs().max_element() < 0.02, "{shared:?} {flat:?}");
}

/// A film of the row.
fn picture(scene: Scene) -> FilmSums {
    let film = Film { width: 64, height: 16, ..Film::default() };
    let camera = Camera {
        position: Vec3::new(0.5 * STEP * COUNT as f32, 30.0, 120.0),
        target: Vec3::new(0.5 * STEP * COUNT as f32, 0.0, 0.0),
        ..Camera::default()
    };
    let scene = Scene { film, camera, ..scene };
    let prepared = translucid_render::PreparedScene::new(scene).unwrap();
    let mut film = FilmSums::new(64, 16);
    internals::add_samples(&prepared, &mut film, 4).unwrap();
    film
}

/// Moving one instance gives the pictures of a scene that is prepared anew; the fingerprint differs with every place.
#[test]
fn moved_instances_are_those_of_a_new_scene() {
    let mut scene = row(matte(Vec3::splat(0.5)));
    scene.environment = uniform_environment(Vec3::ONE);
    let before = picture(scene.clone());
    let mut moved = scene.objects[3].clone();
    moved.world_from_local.translation.y += 2.0;
    let mut edited = translucid_render::PreparedScene::new(scene.clone()).unwrap();
    let view = View::of(&scene).unwrap();
    let old = edited.fingerprint(&view);
    edited.edit(Edit::Object(3, Box::new(moved.clone()))).unwrap();
    assert_ne!(edited.fingerprint(&view), old);
    scene.objects[3] = moved;
    let new = translucid_render::PreparedScene::new(scene.clone()).unwrap();
    assert_eq!(edited.fingerprint(&view), new.fingerprint(&view));
    let pick = |prepared: &translucid_render::PreparedScene| prepared.picker().bounds();
    assert_eq!(pick(&edited), pick(&new));
    let after = picture(scene);
    assert!(before != after);
}

/// A thousand bodies take the memory of one, and a little for each place, on any number of threads.
#[test]
fn a_thousand_instances_take_the_memory_of_one() {
    let mesh = Arc::new(body());
    let object = |i: u32| Object {
        mesh: Arc::clone(&mesh),
        world_from_local: Affine3A::from_translation(Vec3::new((i % 32) as f32, 0.0, (i / 32) as f32) * 3.0),
        subsurface_group: i,
        ..Object::default()
    };
    let one = Geometry::new(&[object(0)]).memory();
    let all: Vec<Object> = (0..1000).map(object).collect();
    let many = Geometry::new(&all).memory();
    assert!(one < 100 * mesh.triangles.len());
    assert!(many < one + 1000 * 300, "{many} bytes of a thousand, {one} of one");
}
