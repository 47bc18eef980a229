//! Walks through layers on a device: distances against those of all triangles, slabs against exact layers, pictures against the
//! processor.

#![allow(clippy::print_stdout, reason = "the figures are for those who ask with --nocapture")]

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use translucid_profile::{AlbedoInversion, Configuration, Parameterization};
use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers, Totals};
use translucid_render::FilmLayer;
use translucid_render::PreparedScene;
use translucid_render::device::{DeviceLimits, DeviceScene, Header};
use translucid_scene::{
    Camera, ColorInput, Environment, Film, LayerMedium, Light, Material, Mesh, Object, Projection,
    ScalarInput, Scene, SubsurfaceLayer, WalkSurface,
};
use translucid_shapes::{ShapeParameters, build_shape};
use translucid_testing::{SplitMix, bound, is_thorough, power};

use super::Tracer;
use super::evaluate::Evaluation;
use super::profile_tests::{both, differing};
use super::tests::{matte, picture, scene, shape, tracer, wax};

/// Standard errors that two means may be apart; a false alarm has a probability of 7e-6 a comparison.
const ERRORS: f64 = 4.5;

const ALBEDO: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.3);

fn layer(thickness: f32, scattering: [f32; 3], absorption: [f32; 3], g: f32) -> SubsurfaceLayer {
    let medium = LayerMedium::Coefficients { scattering: scattering.into(), absorption: absorption.into() };
    SubsurfaceLayer { thickness, medium, g }
}

/// A dense dark layer over one that is clearer than what is behind it.
fn skin(g: f32) -> Vec<SubsurfaceLayer> {
    let surface_albedo = Vec3::new(0.6, 0.4, 0.7);
    let medium = LayerMedium::Appearance { surface_albedo, mfp: Vec3::new(0.3, 0.5, 0.4) };
    vec![
        layer(0.15, [6.0, 3.0, 1.0], [0.4, 1.0, 3.0], g),
        SubsurfaceLayer { thickness: 0.5, medium, g: 0.0 },
        layer(0.4, [0.1, 0.0, 0.5], [0.02, 0.0, 0.0], 0.5 * g),
    ]
}

fn layered(surface: WalkSurface, layers: Vec<SubsurfaceLayer>) -> Material {
    Material {
        specular_weight: ScalarInput::constant(0.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius: ScalarInput::constant(1.0),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        layers,
        ..wax(surface)
    }
}

/// A wide square that faces up or down.
fn square(size: f32, z: f32, turn: f32) -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    Mesh {
        positions: corners.map(|(x, y)| Vec3::new(size * x * turn, size * y, z)).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

/// A slab from z = 0 downwards, in which a square is seen by parallel rays from above.
fn slab(material: Material, thickness: f32) -> Scene {
    let side = |z, turn| Object { mesh: square(500.0, z, turn).into(), ..Object::default() };
    let mut scene = Scene {
        camera: Camera {
            position: Vec3::new(3.3, 1.1, 9.0),
            target: Vec3::new(3.3, 1.1, 0.0),
            projection: Projection::Orthographic { width: 2.0 },
            ..Camera::default()
        },
        film: Film { width: 32, height: 32, ..Film::default() },
        objects: vec![side(0.0, 1.0), side(-thickness, -1.0)],
        materials: vec![material],
        ..Scene::default()
    };
    scene.integrator.subsurface_sharing = false;
    (scene.integrator.max_depth, scene.integrator.max_diffuse_depth) = (64, 64);
    scene
}

/// Exact layers of a slab's material in each channel: those on the innermost medium, then the same again.
fn exact(material: &Material, thickness: f32, incidence: Incidence) -> [Totals; 3] {
    let whole = f64::from(thickness);
    let g = f64::from(material.subsurface_scatter_anisotropy);
    [0, 1, 2].map(|c| {
        let mut all = Vec::new();
        let mut depth = 0.0;
        for of in &material.layers {
            // Halves meet where layers are thicker than the slab
            let part = f64::from(of.thickness).min(0.5 * whole - depth);
            depth += part;
            all.push(match of.medium {
                LayerMedium::Coefficients { scattering, absorption } => {
                    Layer::new(scattering[c].into(), absorption[c].into(), part).with_g(of.g.into())
                }
                LayerMedium::Appearance { surface_albedo, mfp } => {
                    let inversion = AlbedoInversion::new(of.g.into(), 1.0, Configuration::Diffuse).unwrap();
                    let (albedo, mfp) = (surface_albedo[c].into(), mfp[c].into());
                    Layer::from_surface_albedo(&inversion, albedo, mfp, Parameterization::Mfp, part).unwrap()
                }
            });
        }
        all.retain(|of| of.thickness > 0.0);
        let back: Vec<Layer> = all.iter().rev().cloned().collect();
        let rest = whole - 2.0 * depth;
        if rest > 0.0 {
            let albedo = f64::from(material.subsurface_color.factor[c]);
            let length = f64::from(LENGTH[c]);
            all.push(if albedo > 0.0 {
                let inversion = AlbedoInversion::new(g, 1.0, Configuration::Diffuse).unwrap();
                Layer::from_surface_albedo(&inversion, albedo, length, Parameterization::Mfp, rest).unwrap()
            } else {
                Layer::new(0.0, 1.0 / length, rest)
            });
        }
        all.extend(back);
        Layers::new(1.0, all, Ground::AIR).unwrap().totals(incidence).unwrap()
    })
}

/// Means of a picture's channels by a device, with their standard errors: of two pictures with different seeds, whose pixels have
/// the same means.
fn means(scene: &Scene, samples: u64, device: Option<&Arc<Tracer>>) -> [(f64, f64); 3] {
    let of = |seed: u64| {
        let mut scene = scene.clone();
        scene.integrator.seed = seed;
        let film = picture(&scene, samples as u32, device).film();
        let values = film.layer(FilmLayer::Radiance);
        values.into_iter().map(f64::from).collect::<Vec<_>>()
    };
    let pictures = [1, 2].map(of);
    let pixels = pictures[0].len() as f64 / 3.0;
    [0, 1, 2].map(|c| {
        let channel = |run: usize| pictures[run].iter().skip(c).step_by(3);
        let mean = channel(0).chain(channel(1)).sum::<f64>() / (2.0 * pixels);
        let squares: f64 = channel(0).zip(channel(1)).map(|(a, b)| (a - b).powi(2)).sum();
        (mean, squares.sqrt() / (2.0 * pixels))
    })
}

/// Means that are the expected ones within the bounds, and known well enough to tell.
fn assert_exact(name: &str, found: [(f64, f64); 3], expected: [f64; 3]) {
    for (c, ((mean, error), expected)) in found.into_iter().zip(expected).enumerate() {
        println!("{name}, channel {c}: {mean:.5} ± {error:.5}, exactly {expected:.5}");
        assert!(error < bound(4e-3) * expected + bound(5e-4), "{name}, channel {c}: error {error}");
        let allowed = ERRORS * error + 1e-3 * expected + 1e-5;
        assert!((mean - expected).abs() <= allowed, "{name}, channel {c}: {mean}, not {expected}");
    }
}

/// Slabs in even light, seen perpendicularly, have the light that exact layers do not absorb.
///
/// 7 slabs of 3 channels within 4.5 standard errors and 1e-3: one false alarm in 7,000 seeds, and none with these.
#[test]
fn slabs_in_even_light_are_exact_layers() {
    let on_black = Material {
        subsurface_color: ColorInput::constant(Vec3::ZERO),
        ..layered(WalkSurface::Clear, vec![layer(0.5, [4.0, 2.0, 1.0], [0.0, 0.1, 1.0], 0.2)])
    };
    let thick = vec![layer(3.0, [3.0, 2.0, 1.0], [0.1, 0.3, 0.6], 0.5), skin(0.0)[0]];
    let forward = Material { subsurface_scatter_anisotropy: 0.6, ..layered(WalkSurface::Clear, skin(0.3)) };
    for (name, material, thickness) in [
        ("three layers", forward, 2.6),
        ("behind a matte surface", layered(WalkSurface::Diffuse, skin(0.3)), 2.6),
        ("thicker than the slab", layered(WalkSurface::Clear, thick), 1.5),
        ("empty", layered(WalkSurface::Clear, vec![layer(0.4, [0.0; 3], [0.0; 3], 0.0)]), 1.6),
        ("black", layered(WalkSurface::Clear, vec![layer(0.2, [0.0; 3], [1.0, 2.0, 4.0], 0.0)]), 1.6),
        ("bright on black", on_black, 2.0),
        ("thin", layered(WalkSurface::Clear, vec![layer(2e-3, [1.0, 2.0, 0.5], [0.5, 0.1, 2.0], 0.9)]), 1.0),
    ] {
        let incidence =
            if name.contains("matte") { Incidence::Cosine } else { Incidence::Pencil { cos_theta: 1.0 } };
        let exact = exact(&material, thickness, incidence);
        let mut scene = slab(material, thickness);
        scene.environment = Some(Environment { radiance: Vec3::ONE, ..Environment::default() });
        let expected = exact.map(|totals| 1.0 - totals.absorbed.iter().sum::<f64>());
        assert_exact(name, means(&scene, power(64), Some(tracer())), expected);
    }
}

/// A distant light shines through a slab onto a floor: light samples pass it straight, and come to collisions in it, if any.
///
/// The dark one is black behind its layers, where light samples have to look all the same: on the processor, too.
///
/// 12 comparisons as above: one false alarm in 12,000 seeds.
#[test]
fn slabs_let_through_what_exact_layers_do() {
    let scattering = layered(WalkSurface::Clear, skin(0.3));
    let dark = [([6.0, 3.0, 1.0], 0.15), ([1.0, 0.2, 2.0], 0.5), ([0.1, 0.0, 0.5], 0.2)];
    let dark = dark.map(|(absorption, thickness)| layer(thickness, [0.0; 3], absorption, 0.0));
    let absorbing = Material {
        subsurface_color: ColorInput::constant(Vec3::ZERO),
        ..layered(WalkSurface::Clear, dark.to_vec())
    };
    for (material, cosine, device) in [
        (&absorbing, 0.8_f32, None),
        (&absorbing, 0.8, Some(tracer())),
        (&scattering, 1.0, Some(tracer())),
        (&scattering, 0.5, Some(tracer())),
    ] {
        let exact = exact(material, 2.2, Incidence::Pencil { cos_theta: cosine.into() });
        let mut scene = slab(material.clone(), 2.2);
        scene.camera.position.z = -4.0;
        scene.camera.target.z = -6.0;
        scene.materials.push(Material {
            specular_weight: ScalarInput::constant(0.0),
            base_color: ColorInput::constant(Vec3::splat(1e-3)),
            ..matte()
        });
        scene.objects.push(Object {
            mesh: square(500.0, -6.0, 1.0).into(),
            material: 1,
            subsurface_group: 1,
            ..Object::default()
        });
        let direction = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        scene.lights.push(Light::Distant { direction, angular_radius: 0.0, irradiance: Vec3::ONE });
        let to_floor = std::f64::consts::PI * 1e3;
        let found = means(&scene, power(64), device).map(|(mean, error)| (mean * to_floor, error * to_floor));
        let expected = exact.map(|totals| {
            (totals.collimated_transmittance + totals.diffuse_transmittance) * f64::from(cosine)
        });
        assert_exact(&format!("cosine {cosine}"), found, expected);
    }
}

/// A ball and a box with corners of one group, of which each has its own layers, under a wide lamp.
fn bodies(material: Material, has_sky: bool) -> Scene {
    let other = Material { layers: skin(0.5)[..1].to_vec(), ..material.clone() };
    let mut scene = scene(material, Material { specular_weight: ScalarInput::constant(0.0), ..matte() });
    scene.materials.push(other);
    scene.objects.push(shape("box", 0.7, Vec3::new(-1.1, 0.9, 0.4), 2, 2));
    scene.objects.push(shape("sphere", 0.5, Vec3::new(1.0, 0.9, 0.3), 2, 0));
    scene.lights.push(Light::Rectangle {
        center: Vec3::new(2.0, 3.5, 2.5),
        edge_x: Vec3::X * 4.0,
        edge_y: Vec3::new(0.0, -2.0, 3.0),
        radiance: Vec3::ONE,
        visible: true,
    });
    if !has_sky {
        scene.environment = None;
    }
    scene.integrator.subsurface_sharing = false;
    scene
}

/// Behind matte surfaces walks have the processor's numbers one by one: pixels are the same but where rounding leads a walk to
/// another surface.
#[test]
fn walks_behind_matte_surfaces_are_those_of_the_processor() {
    let surfaces = [WalkSurface::Diffuse, WalkSurface::Rough, WalkSurface::Skin];
    for surface in if is_thorough() { &surfaces[..] } else { &surfaces[..1] } {
        let material = Material {
            subsurface_scatter_anisotropy: 0.3,
            subsurface_eta: 1.4,
            subsurface_radius: ScalarInput::constant(0.4),
            ..layered(*surface, skin(0.6))
        };
        let found = both(&bodies(material, true), 4);
        let share = differing(&found, 1e-3);
        println!("{}: {share} of the pixels differ", surface.name_of_walk());
        assert!(share <= 0.1, "{}: {share} of the pixels differ", surface.name_of_walk());
    }
}

/// Between clear surfaces the light is the processor's.
///
/// 9 sums of differences within 4.5 roots of their squares and 1e-3: one false alarm in 15,000 seeds.
#[test]
fn walks_between_clear_surfaces_have_the_light_of_the_processor() {
    for (name, eta, has_sky) in [("lamp", 1.0, false), ("lamp and sky", 1.0, true), ("refracting", 1.4, true)]
    {
        let material = Material {
            subsurface_scatter_anisotropy: 0.3,
            subsurface_eta: eta,
            subsurface_radius: ScalarInput::constant(0.4),
            ..layered(WalkSurface::Clear, skin(0.6))
        };
        let mut scene = bodies(material, has_sky);
        if eta > 1.0 {
            scene.lights.clear();
        }
        let [ours, theirs] = both(&scene, power(256) as u32);
        for c in 0..3 {
            let pairs = || ours.iter().zip(&theirs).map(|(a, b)| (f64::from(a[c]), f64::from(b[c])));
            let light: f64 = pairs().map(|(a, _)| a).sum();
            let off = pairs().map(|(a, b)| b - a).sum::<f64>() / light;
            let error = pairs().map(|(a, b)| (b - a).powi(2)).sum::<f64>().sqrt() / light;
            println!("{name}, channel {c}: {off:.5} ± {error:.5} of the light");
            assert!(
                error < bound(0.015) && off.abs() <= ERRORS * error + 1e-3,
                "{name}, channel {c}: {off} ± {error}"
            );
        }
    }
}

/// Objects of a body with layers are in the world, whatever share their mesh, and whichever of them has the layers.
#[test]
fn bodies_with_layers_share_no_mesh() {
    let instances = |layers: Vec<SubsurfaceLayer>| {
        let parameters = ShapeParameters::new().with("segments", 256.0).with("tube_segments", 128.0);
        let mesh = Arc::new(build_shape("torus", &parameters).unwrap());
        let object = |i: u32| Object {
            mesh: Arc::clone(&mesh),
            world_from_local: Affine3A::from_translation(Vec3::X * 4.0 * i as f32),
            material: usize::from(i == 1),
            subsurface_group: i / 2,
            ..Object::default()
        };
        let scene = Scene {
            objects: (0..6).map(object).collect(),
            materials: vec![layered(WalkSurface::Clear, vec![]), layered(WalkSurface::Clear, layers)],
            ..Scene::default()
        };
        let prepared = PreparedScene::new(scene).unwrap();
        let view = prepared.view().unwrap();
        let device = DeviceScene::new(&prepared, &view, &DeviceLimits { array_bytes: 1 << 27 }).unwrap();
        device.tables[Header::Instances as usize]
    };
    assert_eq!([instances(vec![]), instances(skin(0.0))], [6.0, 4.0]);
}

/// Distances from points to the triangles of a group are those of a loop over all of them.
#[test]
fn distances_are_those_of_all_triangles() {
    let mut random = SplitMix(3);
    let mut number = move || random.uniform() as f32;
    let mut point = move || Vec3::new(number(), number(), number()) - 0.5;
    let mut mesh = |count: u32, scale: Vec3| {
        let mut positions = Vec::new();
        for i in 0..count {
            let (at, size) = (2.0 * point(), if i % 8 == 0 { 3.0 } else { 0.4 });
            positions.extend([0, 1, 2].map(|_| (at + size * point()) * scale));
        }
        let triangles = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Arc::new(Mesh { positions, triangles, ..Mesh::default() })
    };
    for scale in [Vec3::ONE, Vec3::new(1.0, 1.0, 0.003), Vec3::splat(1e4)] {
        let meshes = [mesh(40, scale), mesh(20, scale)];
        let objects = meshes.iter().zip([7, 2]).map(|(mesh, group)| Object {
            mesh: Arc::clone(mesh),
            subsurface_group: group,
            ..Object::default()
        });
        let scene = Scene {
            objects: objects.collect(),
            materials: vec![layered(WalkSurface::Clear, skin(0.0))],
            ..Scene::default()
        };
        let prepared = PreparedScene::new(scene).unwrap();
        let view = prepared.view().unwrap();
        let device = DeviceScene::new(&prepared, &view, &DeviceLimits { array_bytes: 1 << 27 }).unwrap();
        let (nodes, triangles) = (device.nodes.len() / 4, device.triangles.len() / 4);
        let stubs = format!(
            "const NEVER = 1e30; const STACK = 64u; const AN_INSTANCE = 0xffffffffu; const INSTANCE_ROWS = 8u;
            const INSTANCES = 0u; fn head(place: u32) -> u32 {{ return 0u; }}
            var<private> nodes: array<vec4u, {nodes}>; var<private> triangles: array<vec4u, {triangles}>;\n"
        );
        let body = format!(
            "for (var k = 0u; k < {nodes}u; k += 1u) {{
                nodes[k] = vec4u(images[4u * k], images[4u * k + 1u], images[4u * k + 2u], images[4u * k + 3u]);
            }}
            for (var k = 0u; k < {triangles}u; k += 1u) {{
                let at = 4u * (k + {nodes}u);
                triangles[k] = vec4u(images[at], images[at + 1u], images[at + 2u], images[at + 3u]);
            }}
            outputs[o] = distance_to_group(vec3f(inputs[i], inputs[i + 1], inputs[i + 2]), 7u, inputs[i + 3]);"
        );
        let evaluation = Evaluation {
            shaders: &[&stubs, include_str!("shaders/depth.wgsl")],
            body: &body,
            tables: &[0.0],
            images: &[&device.nodes[..], &device.triangles[..]].concat(),
            widths: [4, 1],
        };
        let size = scale.max_element();
        let mut numbers = SplitMix(5);
        let mut from = || numbers.uniform() as f32 - 0.5;
        let inputs: Vec<f32> = (0..2000)
            .flat_map(|i| {
                let at = Vec3::new(from(), from(), from()) * 3.0 * scale;
                at.extend(if i % 2 == 0 { 1e18 } else { 0.2 * size }).to_array()
            })
            .collect();
        let mut cut = 0;
        for (input, found) in inputs.chunks(4).zip(evaluation.run(&inputs)) {
            let least = (0..40).map(|i| {
                let corner = |k: usize| meshes[0].positions[3 * i + k].as_dvec3();
                distance([corner(0), corner(1), corner(2)], Vec3::from_slice(input).as_dvec3())
            });
            let expected = least.fold(f64::from(input[3]), f64::min);
            cut += u32::from(expected == f64::from(input[3]));
            let allowed = 2e-5 * expected + 1e-6 * f64::from(size);
            assert!((f64::from(found) - expected).abs() <= allowed, "{input:?}: {found}, not {expected}");
        }
        assert!((10..990).contains(&cut), "{cut} are cut");
    }
}

/// Distance from a point to a triangle: by the plane where the foot is inside, else by the edges.
fn distance([a, b, c]: [DVec3; 3], from: DVec3) -> f64 {
    let normal = (b - a).cross(c - a).normalize();
    let edges = [(a, b), (b, c), (c, a)];
    if edges.iter().all(|(start, end)| normal.dot((*end - *start).cross(from - *start)) >= 0.0) {
        return normal.dot(from - a).abs();
    }
    let to_edge = |(start, end): (DVec3, DVec3)| {
        let edge = end - start;
        let along = ((from - start).dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
        (start + edge * along - from).length()
    };
    edges.into_iter().map(to_edge).fold(f64::INFINITY, f64::min)
}
