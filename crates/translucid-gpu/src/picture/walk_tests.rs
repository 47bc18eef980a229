//! Walks on a device: a slab against photons that know no ray of a renderer, pictures against the processor pixel by pixel, and
//! the random numbers of late events.

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
use translucid_testing::{SplitMix, power};

use super::Tracer;
use super::evaluate::Evaluation;
use super::profile_tests::{both, differing};
use super::tests::{lamp, matte, picture, scene, tracer, wax};

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

/// A ball under a lamp is the processor's in nearly every pixel, as its walks have the same numbers: rounding leads few of them
/// to other surfaces.
#[test]
fn walks_are_those_of_the_processor() {
    let surfaces =
        if translucid_testing::is_thorough() { &WalkSurface::ALL[..] } else { &WalkSurface::ALL[..2] };
    for &surface in surfaces {
        let bare = ScalarInput::constant(0.0);
        let ball = Material { specular_weight: bare, subsurface_scatter_anisotropy: 0.3, ..wax(surface) };
        let mut scene = scene(ball, Material { specular_weight: bare, ..matte() });
        scene.lights.push(lamp());
        scene.integrator.subsurface_sharing = false;
        let found = both(&scene, 4);
        let share = differing(&found, 1e-3);
        println!("{}: {share} of the pixels differ", surface.name_of_walk());
        assert!(share <= 0.1, "{}: {share} of the pixels differ", surface.name_of_walk());
    }
}

/// Numbers behind the stratified ones are those of SplitMix64 in their order.
#[test]
fn late_numbers_are_split_mix() {
    let evaluation = Evaluation {
        shaders: &[SETTINGS, include_str!("shaders/sampler.wgsl")],
        body: "let low = hash_combine(hash_combine(u32(inputs[i]), u32(inputs[i + 1])), u32(inputs[i + 2]));
            let u = independent(Sampler(u32(inputs[i]), u32(inputs[i + 2])), u32(inputs[i + 1]), 2u * u32(inputs[i + 3]));
            for (var k = 0u; k < 4u; k += 1u) { outputs[o + k] = u[k]; }
            outputs[o + 4] = bitcast<f32>(low); outputs[o + 5] = bitcast<f32>(hash_combine(low ^ 0x5bd1e995u, u32(inputs[i + 2])));",
        tables: &[0.0],
        images: &[0],
        widths: [4, 6],
    };
    let inputs: Vec<f32> =
        (0..400_u16).flat_map(|i| [i * 37, i % 24, i * 5, i % 50].map(f32::from)).collect();
    for (input, found) in inputs.chunks(4).zip(evaluation.run(&inputs).chunks(6)) {
        let mut random = SplitMix(u64::from(found[4].to_bits()) | u64::from(found[5].to_bits()) << 32);
        let words: Vec<u64> = (0..2 * (input[3] as usize + 1)).map(|_| random.bits()).collect();
        let last = &words[words.len() - 2..];
        let expected = [last[0], last[0] >> 32, last[1], last[1] >> 32];
        let expected = expected.map(|bits| (bits & 0xff_ffff) as f32 / 16_777_216.0);
        assert_eq!(found[..4], expected, "{input:?}");
    }
}

/// Names of other shaders that the sampler's shader has, for a test that uses none of them.
const SETTINGS: &str = "struct Settings { seed: vec2u }
const settings = Settings(vec2u(0u));
const SOBOL = 0u;
fn head(place: u32) -> u32 { return u32(tables[place]); }
";
