//! Pictures lit by hundreds of lights: the same at any number of threads and by any way of selection.

use glam::Vec3;
use translucid_render::FilmSums;
use translucid_render::internals::{self, LightSelection};
use translucid_scene::{Camera, Light, Material, Object, ScalarInput, Scene};
use translucid_testing::{bound, power};

use crate::common::{PreparedScene, matte, on_threads, pictures, prepare, quad, render, scene};

/// A matte floor under 300 lamps of three kinds and 200 emissive triangles of all powers, behind a wall in part.
fn hall() -> Scene {
    let floor = quad(Vec3::ZERO, Vec3::X * 6.0, Vec3::Y * 6.0);
    let wall = quad(Vec3::new(1.0, 0.0, 0.5), Vec3::Y * 4.0, Vec3::Z * 0.5);
    let mut hall = scene(vec![floor, wall], matte(Vec3::splat(0.7)));
    let place = |i: u32| {
        let (a, b, c) = (i * 7919 % 1009, i * 104_729 % 1013, i * 1_299_709 % 1019);
        Vec3::new(a as f32 / 101.0 - 5.0, b as f32 / 101.3 - 5.0, 0.5 + c as f32 / 509.5)
    };
    let brightness = |i: u32| Vec3::new(1.0, 0.8, 0.5) * 10.0_f32.powi((i % 4) as i32 - 1);
    for i in 0..300 {
        let (center, radiance) = (place(i), brightness(i));
        hall.lights.push(match i % 3 {
            0 => Light::Sphere { center, radius: 0.05, radiance, visible: false },
            1 => Light::Rectangle {
                center,
                edge_x: Vec3::X * 0.1,
                edge_y: Vec3::new(0.0, -0.1, 0.05),
                radiance,
                visible: false,
            },
            _ => Light::Spot {
                radius: 0.0,
                visible: true,
                position: center,
                direction: Vec3::new(0.3, 0.2, -1.0).normalize(),
                intensity: radiance * 0.01,
                inner_angle: 20.0,
                outer_angle: 50.0,
            },
        });
    }
    let mut shards = quad(Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    (shards.positions, shards.triangles) = (Vec::new(), Vec::new());
    for i in 0..200 {
        let a = place(1000 + i);
        let size = 0.02 + 0.001 * (i % 100) as f32;
        shards.positions.extend([a, a + Vec3::Y * size, a + Vec3::X * size]);
        shards.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let emitting = Material {
        emission_luminance: 5.0,
        base_weight: 0.0,
        specular_weight: ScalarInput::constant(0.0),
        ..Material::default()
    };
    hall.materials.push(emitting);
    hall.objects.push(Object {
        name: "shards".into(),
        mesh: shards.into(),
        material: 1,
        subsurface_group: 1,
        ..Object::default()
    });
    hall.camera =
        Camera { position: Vec3::new(0.0, -9.0, 6.0), target: Vec3::ZERO, up: Vec3::Z, ..hall.camera };
    hall.integrator.max_depth = 3;
    hall.film.width = 24;
    hall.film.height = 16;
    hall
}

fn rendered(renderer: &PreparedScene, threads: usize, samples: u32) -> FilmSums {
    let mut film = FilmSums::new(24, 16);
    on_threads(threads, || render(renderer, &mut film, samples));
    film
}

#[test]
fn picture_is_the_same_at_any_number_of_threads() {
    let renderer = prepare(hall());
    let [one, three] = [1, 3].map(|threads| rendered(&renderer, threads, 8));
    for y in 0..16 {
        for x in 0..24 {
            assert_eq!(one.radiance(x, y), three.radiance(x, y), "pixel {x}, {y}");
        }
    }
}

/// Means over the picture by the tree and by weighing every light, each from 16 seeds, within four and a half
/// standard errors (by Student's t of 30 degrees of freedom a false alarm in 10,000).
#[test]
fn picture_is_the_same_by_any_selection() {
    let brightness = |way: LightSelection, first_seed: u64| -> (f64, f64) {
        let mut prepared = prepare(hall());
        internals::select_lights(&mut prepared, way);
        let mean_of = |film: &FilmSums| {
            let pixels = (0..16).flat_map(|y| (0..24).map(move |x| (x, y)));
            pixels.map(|(x, y)| film.radiance(x, y)[0]).sum::<f64>() / 384.0
        };
        let films = pictures(&prepared, first_seed..first_seed + 16, power(32) as u32);
        let means: Vec<f64> = films.iter().map(mean_of).collect();
        let mean = means.iter().sum::<f64>() / 16.0;
        let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / 15.0;
        (mean, variance / 16.0)
    };
    let (tree, tree_variance) = brightness(LightSelection::Tree, 0);
    let (weighed, weighed_variance) = brightness(LightSelection::Weighed, 100);
    let error = (tree_variance + weighed_variance).sqrt();
    assert!((tree - weighed).abs() < 4.5 * error, "{tree}, {weighed} ± {error}");
    assert!(error < bound(0.02) * weighed, "too noisy to tell: {tree}, {weighed} ± {error}");
}
