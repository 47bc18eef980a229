//! Walks on a device: a slab against photons that know no ray of a renderer.

#![allow(clippy::print_stdout, reason = "the figures are for those who ask with --nocapture")]

use std::sync::Arc;

use glam::Vec3;
use translucid_profile::{AlbedoInversion, Configuration};
use translucid_reference::body::{Body, Interior, Lighting, Shape};
use translucid_render::FilmLayer;
use translucid_scene::{
    Camera, ColorInput, Environment, Film, Material, Mesh, Object, Projection, ScalarInput, Scene,
    WalkSurface,
};
use translucid_testing::power;

use super::Tracer;
use super::tests::{picture, tracer, wax};

/// Standard errors that two means may be apart; a false alarm has a probability of 7e-6 a comparison.
const ERRORS: f64 = 4.5;

const ALBEDO: Vec3 = Vec3::new(0.9, 0.7, 0.4);
const LENGTH: Vec3 = Vec3::new(0.5, 0.3, 0.15);

fn material() -> Material {
    Material {
        specular_weight: ScalarInput::constant(0.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius: ScalarInput::constant(1.0),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        ..wax(WalkSurface::Clear)
    }
}

/// A body under an even sky, seen by parallel rays in a square of a width.
fn body(mesh: Mesh, width: f32) -> Scene {
    let mut scene = Scene {
        camera: Camera {
            position: Vec3::new(0.0, 0.0, 9.0),
            target: Vec3::ZERO,
            projection: Projection::Orthographic { width },
            ..Camera::default()
        },
        film: Film { width: 32, height: 32, ..Film::default() },
        objects: vec![Object { name: "body".into(), mesh: mesh.into(), ..Object::default() }],
        materials: vec![material()],
        environment: Some(Environment { radiance: Vec3::ONE, ..Environment::default() }),
        ..Scene::default()
    };
    scene.integrator.subsurface_sharing = false;
    (scene.integrator.max_depth, scene.integrator.max_diffuse_depth) = (64, 64);
    scene
}

/// A layer of each pixel, on a device or on the processor.
fn layer(scene: &Scene, seed: u64, samples: u64, layer: FilmLayer, device: Option<&Arc<Tracer>>) -> Vec<f64> {
    let mut scene = scene.clone();
    scene.integrator.seed = seed;
    let values = picture(&scene, samples as u32, device).film().layer(layer);
    values.into_iter().map(f64::from).collect()
}

/// The mean over a slab, seen perpendicularly under an even sky, is the share of perpendicular light that leaves it after a
/// collision.
///
/// 3 comparisons within 4.5 standard errors and 1e-3: one false alarm in 50,000 seeds, and none with this one.
#[test]
fn a_slab_in_even_light_is_that_of_photons() {
    let inversion = AlbedoInversion::new(0.0, 1.0, Configuration::Diffuse).unwrap();
    let interior = |c: usize| Interior {
        single_scattering_albedo: inversion.single_scattering_albedo(f64::from(ALBEDO[c])),
        g: 0.0,
        eta: 1.0,
    };
    let quad = |z: f32, turn: f32| {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        corners.map(|(x, y)| Vec3::new(500.0 * x * turn, 500.0 * y, z))
    };
    let slab = Mesh {
        positions: [quad(0.0, 1.0), quad(-0.6, -1.0)].concat(),
        triangles: vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]],
        ..Mesh::default()
    };
    let scene = body(slab, 2.0);
    let of = |what, seed| layer(&scene, seed, power(256), what, Some(tracer()));
    let area: f64 = [1, 2].map(|seed| of(FilmLayer::Alpha, seed).iter().sum::<f64>()).iter().sum();
    let lights = [1, 2].map(|seed| of(FilmLayer::Subsurface, seed));
    for c in 0..3 {
        let per_length = 1.0 / f64::from(LENGTH[c]);
        let shape = Shape::Slab { thickness: 0.6 * per_length };
        let truth =
            Body::new(shape, interior(c), Lighting::Distant).unwrap().walk(power(8_000_000), 5).scattered();
        let channel = |run: usize| lights[run].iter().skip(c).step_by(3);
        let found = channel(0).chain(channel(1)).sum::<f64>() / area;
        // Both pictures have the same means, pixel by pixel
        let squares: f64 = channel(0).zip(channel(1)).map(|(a, b)| (a - b).powi(2)).sum();
        let error = squares.sqrt() / area;
        let allowed = ERRORS * error.hypot(truth.error) + 1e-3 * truth.value;
        println!("channel {c}: {found} ± {error}, photons {} ± {}", truth.value, truth.error);
        assert!((found - truth.value).abs() <= allowed, "channel {c}: {found}, not {}", truth.value);
    }
}
