//! Bodies whose mean free path is far below a pixel's width: the light of walks at the cost of a diffuse surface.
//!
//! The same picture of few and of many pixels: light travels a small part of a pixel, and is not walked with, or many pixels.
//! Seeds are fixed.

use glam::Vec3;
use translucid_render::FilmSums;
use translucid_scene::{
    Camera, ColorInput, Film, FilterKind, Light, Material, Object, Projection, ScalarInput, Scene,
    SubsurfaceModel, WalkSurface,
};
use translucid_testing::is_thorough;

use crate::common::{matte, pictures, prepare, quad, scene, sphere, uniform_environment};

const ALBEDO: Vec3 = Vec3::new(0.9, 0.6, 0.3);

/// Mean free path of the ball of radius 1.
const LENGTH: f32 = 0.008;

/// Edges of pictures in pixels: light travels a twentieth of a pixel, or more than one.
const COARSE: u32 = 8;
const FINE: u32 = 384;

/// Regions along each edge.
const REGIONS: u32 = 4;

/// A ball and a thin plate before a lamp, on a matte floor, under another lamp and the sky.
fn bodies(model: SubsurfaceModel, edge: u32) -> Scene {
    let mut ball = sphere(1.0, 96);
    ball.positions.iter_mut().for_each(|p| *p += Vec3::new(-0.3, 0.0, 1.0));
    // A box: its faces six mean free paths apart
    let mut plate = sphere(1.0, 2);
    let corners: Vec<Vec3> = (0..8_u8)
        .map(|i| Vec3::new(f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2 & 1)))
        .map(|p| Vec3::new(0.9, -0.5, 0.2) + p * Vec3::new(1.0, 6.0 * LENGTH, 1.2))
        .collect();
    plate.positions = corners;
    plate.normals.clear();
    plate.uvs.clear();
    plate.triangles = vec![
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];
    let ground = quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0);
    let translucent = Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius: ScalarInput::constant(LENGTH),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.8, 0.6)),
        subsurface_model: model,
        ..Material::default()
    };
    let mut scene = scene(Vec::new(), translucent);
    scene.materials.push(matte(Vec3::splat(0.4)));
    for (index, mesh) in [ball, plate, ground].into_iter().enumerate() {
        scene.objects.push(Object {
            name: format!("object {index}"),
            mesh: mesh.into(),
            material: index / 2,
            subsurface_group: index as u32,
            ..Object::default()
        });
    }
    let lamp = |center: Vec3, radiance: f32| Light::Rectangle {
        center,
        edge_x: Vec3::new(-0.5, 0.7, 0.0),
        edge_y: Vec3::new(-0.42, -0.3, 0.8),
        radiance: Vec3::splat(radiance),
        visible: false,
    };
    scene.lights.push(lamp(Vec3::new(3.0, -2.0, 3.0), 12.0));
    scene.lights.push(lamp(Vec3::new(1.5, 3.0, 2.0), 12.0));
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.camera = Camera {
        position: Vec3::new(1.0, -6.0, 2.5),
        target: Vec3::new(0.3, 0.0, 0.8),
        up: Vec3::Z,
        projection: Projection::Perspective { horizontal_fov: 30.0 },
        ..scene.camera
    };
    let (filter, filter_radius) = (FilterKind::Box, 0.5);
    scene.film = Film { width: edge, height: edge, filter, filter_radius, ..Film::default() };
    scene.integrator.max_depth = 8;
    scene
}

/// Mean radiance of a channel in a region.
fn mean_of(film: &FilmSums, region: u32, channel: usize) -> f64 {
    let edge = film.width / REGIONS;
    let (left, top) = (region % REGIONS * edge, region / REGIONS * edge);
    let pixels = (0..edge * edge).map(|i| film.radiance(left + i % edge, top + i / edge)[channel]);
    pixels.sum::<f64>() / f64::from(edge * edge)
}

/// Mean and squared standard error of the mean.
fn statistics(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

/// Walks and what stands in for them agree in every region, within 0.2 % and the noise.
///
/// Regions (16) × 3 channels × 2 models make 96 comparisons; |t| > 6 has a probability of 4e-6 with 23 degrees of freedom,
/// and |t| > 12 one of 6e-6 with 7: a false alarm in one of 2,600 choices of seeds, or 1,700.
#[test]
fn regions_are_as_bright_as_with_walks() {
    let (seeds, samples, allowed) = if is_thorough() { (24, 4, 6.0) } else { (8, 1, 12.0) };
    for surface in [WalkSurface::Clear, WalkSurface::Skin] {
        let model = SubsurfaceModel::RandomWalk(surface);
        let fine = pictures(&prepare(bodies(model, FINE)), 0..seeds, samples);
        let coarse = pictures(&prepare(bodies(model, COARSE)), 100..100 + seeds, samples << 12);
        for (region, channel) in (0..REGIONS * REGIONS).flat_map(|region| (0..3).map(move |c| (region, c))) {
            let of = |films: &[FilmSums]| {
                statistics(&films.iter().map(|film| mean_of(film, region, channel)).collect::<Vec<_>>())
            };
            let ((walked, of_walks), (found, of_found)) = (of(&fine), of(&coarse));
            if walked == 0.0 {
                assert_eq!(found, 0.0, "{surface:?} {region} {channel}");
                continue;
            }
            let (off, noise) = ((found - walked).abs(), (of_walks + of_found).sqrt());
            assert!(
                off < 2e-3 * walked + allowed * noise,
                "{surface:?} {region} {channel}: {found} {walked} ± {noise}"
            );
        }
    }
}

/// Mean over pixels of the relative variance of a picture of the ball in which light travels a sixth of a pixel.
fn relative_variance(model: SubsurfaceModel) -> f64 {
    let edge = 32;
    let mut scene = bodies(model, edge);
    scene.objects.remove(1);
    let films = pictures(&prepare(scene), 0..32, 4);
    let of = |pixel: u32| {
        let value = |film: &FilmSums| film.radiance(pixel % edge, pixel / edge)[0];
        let (mean, squared) = statistics(&films.iter().map(value).collect::<Vec<_>>());
        if mean > 0.0 { squared / (mean * mean) } else { 0.0 }
    };
    (0..edge * edge).map(of).sum::<f64>() / f64::from(edge * edge)
}

/// Walks of hundreds of collisions have two to four times the variance of a diffuse surface.
#[test]
fn noise_is_near_that_of_a_diffuse_surface() {
    let diffuse = relative_variance(SubsurfaceModel::None);
    for surface in [WalkSurface::Clear, WalkSurface::Diffuse, WalkSurface::Rough, WalkSurface::Skin] {
        let found = relative_variance(SubsurfaceModel::RandomWalk(surface));
        assert!(found < 1.4 * diffuse, "{surface:?}: {found} {diffuse}");
    }
}
