//! Light shared between the pixels of a block: the same mean as without, and less noise.
//!
//! Seeds are fixed. Pictures of different seeds are independent, so means of regions go with Student's t.

use std::sync::Arc;

use glam::{Vec2, Vec3};
use translucid_profile::Model;
use translucid_render::FilmSums;
use translucid_scene::{
    Camera, ColorInput, ColorSpace, Film, Image, Light, Material, Mesh, Object, Pixels, ProfileRow,
    ProfileTable, Projection, ScalarInput, Scene, SubsurfaceModel, SubsurfaceNormalization,
    SubsurfaceTextureAt, TextureRef, WalkSurface,
};
use translucid_testing::{bound, is_thorough};

use crate::common::{matte, pictures, prepare, quad, scene, sphere, uniform_environment};

/// Edge of a region in pixels: some lie in one block, some across two.
const REGION: u32 = 6;

/// Surface albedos of two squares.
const DARK: Vec3 = Vec3::new(0.2, 0.15, 0.3);
const BRIGHT: Vec3 = Vec3::new(0.95, 0.8, 0.6);

/// Edge of a picture in pixels.
fn size() -> u32 {
    if is_thorough() { 48 } else { 24 }
}

/// Pictures whose spread gives the error of their mean.
fn seeds() -> u64 {
    if is_thorough() { 24 } else { 12 }
}

/// Number of regions.
fn regions() -> u32 {
    (size() / REGION).pow(2)
}

fn translucent(model: SubsurfaceModel, color: Vec3, length: f32) -> Material {
    Material {
        name: "translucent".into(),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(color),
        subsurface_radius: ScalarInput::constant(length),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.5, 0.2)),
        subsurface_model: model,
        ..Material::default()
    }
}

/// Two bodies of different media, one of them glossy, on a matte floor under a lamp and the sky.
fn bodies(model: SubsurfaceModel) -> Scene {
    let mut ball = sphere(1.0, 24);
    ball.positions.iter_mut().for_each(|p| *p += Vec3::Z);
    let mut small = sphere(0.6, 24);
    small.positions.iter_mut().for_each(|p| *p += Vec3::new(0.9, -1.0, 0.5));
    let ground = quad(Vec3::ZERO, Vec3::X * 8.0, Vec3::Y * 8.0);
    let mut scene = scene(Vec::new(), translucent(model, Vec3::new(0.9, 0.6, 0.3), 0.4));
    scene.materials.push(Material {
        specular_weight: ScalarInput::constant(0.0),
        ..translucent(model, Vec3::new(0.3, 0.7, 0.8), 0.1)
    });
    scene.materials.push(matte(Vec3::splat(0.4)));
    for (index, mesh) in [ball, small, ground].into_iter().enumerate() {
        let name = format!("object {index}");
        scene.objects.push(Object {
            name,
            mesh: mesh.into(),
            material: index,
            subsurface_group: index as u32,
            ..Object::default()
        });
    }
    scene.lights.push(Light::Rectangle {
        center: Vec3::new(3.0, 2.0, 3.0),
        edge_x: Vec3::new(-0.5, 0.7, 0.0),
        edge_y: Vec3::new(-0.42, -0.3, 0.8),
        radiance: Vec3::new(19.0, 18.0, 17.0),
        visible: true,
    });
    scene.environment = uniform_environment(Vec3::splat(0.2));
    scene.camera = Camera {
        position: Vec3::new(1.0, -6.0, 2.5),
        target: Vec3::new(0.3, 0.0, 0.7),
        up: Vec3::Z,
        projection: Projection::Perspective { horizontal_fov: 34.0 },
        ..scene.camera
    };
    scene.film = Film { width: size(), height: size(), ..Film::default() };
    scene.integrator.max_depth = 8;
    scene
}

/// Mean radiance of a channel in a region.
fn mean_of(film: &FilmSums, region: u32, channel: usize) -> f64 {
    let per_row = size() / REGION;
    let (left, top) = (region % per_row * REGION, region / per_row * REGION);
    let pixels = (0..REGION * REGION).map(|i| film.radiance(left + i % REGION, top + i / REGION)[channel]);
    pixels.sum::<f64>() / f64::from(REGION * REGION)
}

/// Mean and squared standard error of the mean.
fn statistics(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    (mean, values.map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n)
}

/// A scene whose first ball has texture coordinates, as its front shows.
fn with_coordinates(mut scene: Scene) -> Scene {
    let mut ball = (*scene.objects[0].mesh).clone();
    ball.uvs = ball.positions.iter().map(|p| Vec2::new(0.5 + 0.5 * p.x, 0.5 * p.z)).collect();
    scene.objects[0].mesh = ball.into();
    scene
}

/// A square image of so many columns.
fn image(name: &str, columns: u32, pixels: &[Vec3]) -> Arc<Image> {
    let pixels = Pixels::Float(pixels.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect());
    let (name, color_space) = (name.to_owned(), ColorSpace::Linear);
    Image { name, path: None, width: columns, height: columns, color_space, pixels }.into()
}

/// The bodies as walks, with a texture of so many columns of squares on the larger one's color.
fn checkered(surface: WalkSurface, columns: u32, dark: Vec3, bright: Vec3) -> Scene {
    let mut scene = with_coordinates(bodies(SubsurfaceModel::RandomWalk(surface)));
    let is_dark = |i: u32| (i / columns + i % columns).is_multiple_of(2);
    let squares: Vec<_> = (0..columns * columns).map(|i| if is_dark(i) { dark } else { bright }).collect();
    scene.images = vec![image("squares", columns, &squares)];
    scene.materials[0].subsurface_color =
        ColorInput { texture: Some(TextureRef::new(0)), ..ColorInput::constant(Vec3::ONE) };
    scene
}

/// The bodies, with a texture of bright and dark, wide and narrow patches on the larger one.
fn textured(texture_at: SubsurfaceTextureAt, model: SubsurfaceModel) -> Scene {
    let mut scene = with_coordinates(bodies(model));
    scene.images = vec![
        image(
            "albedo",
            2,
            &[Vec3::ONE, Vec3::new(0.3, 0.9, 0.5), Vec3::new(0.8, 0.1, 1.0), Vec3::new(0.0, 0.5, 0.2)],
        ),
        image("length", 2, &[Vec3::ONE, Vec3::splat(0.4), Vec3::new(0.3, 1.0, 0.6), Vec3::splat(0.7)]),
    ];
    let input =
        |index, factor| ColorInput { texture: Some(TextureRef::new(index)), ..ColorInput::constant(factor) };
    scene.materials[0].subsurface_color = input(0, Vec3::new(0.95, 0.8, 0.6));
    scene.materials[0].subsurface_radius_scale = input(1, Vec3::new(1.0, 0.5, 0.2));
    scene.materials[0].subsurface_texture_at = texture_at;
    scene
}

/// The bodies with a profile from a file; one with holes is not shared.
fn from_file(has_holes: bool) -> Scene {
    let mut scene = bodies(SubsurfaceModel::Tabulated(0));
    let radii: Vec<f64> = (1..=60).map(|i| 0.05 * f64::from(i)).collect();
    let profile = |r: &f64| if has_holes && (r * 2.0).fract() < 0.5 { 0.0 } else { (-r).exp() / r };
    let row =
        ProfileRow { reflectances: radii.iter().map(profile).collect(), radii, ..ProfileRow::default() };
    scene.profile_tables = vec![ProfileTable { path: "file.csv".into(), rows: vec![row] }];
    scene
}

/// Regions (64) × 3 channels × 24 scenes make 4,608 comparisons; |t| > 6 has a probability of 4e-6 with 23 degrees of
/// freedom, so there is a false alarm in one of 54 choices of seeds. With a quarter of the pixels and half of the seeds
/// |t| > 9 has a probability of 2e-6 with 11 degrees of freedom: one of 460.
#[test]
fn sharing_keeps_the_mean_of_every_region() {
    let normalized = |mut scene: Scene| {
        scene.materials[0].subsurface_normalization = SubsurfaceNormalization::Energy;
        scene
    };
    // A pane of tinted glass in front of a part: some exits are found behind it, at another depth, by dimmed light
    let behind_glass = |mut scene: Scene| {
        let center = Vec3::new(1.0, -2.5, 1.2);
        scene.materials.push(Material {
            transmission_weight: ScalarInput::constant(1.0),
            transmission_color: ColorInput::constant(Vec3::new(0.05, 0.4, 0.9)),
            specular_roughness: ScalarInput::constant(0.0),
            specular_ior: 1.0,
            ..Material::default()
        });
        let mesh = quad(center, Vec3::X * 0.8, Vec3::Z * 0.8);
        scene.objects.push(Object {
            name: "pane".into(),
            mesh: mesh.into(),
            material: 3,
            subsurface_group: 3,
            ..Object::default()
        });
        scene.integrator.max_depth = 4;
        scene
    };
    // Both balls are one body: they overlap, or light goes from one to the other through a gap
    let one_body = |mut scene: Scene, shift: f32| {
        let mut small = sphere(0.6, 24);
        small.positions.iter_mut().for_each(|p| *p += Vec3::new(0.9, -1.0 - shift, 0.5));
        scene.objects[1].mesh = small.into();
        scene.objects.iter_mut().take(2).for_each(|object| object.subsurface_group = 0);
        scene
    };
    // Even light, shadows and what lies between: some take part in the sharing, some do not
    let on_translucent_ground = |mut scene: Scene| {
        scene.materials[2] = translucent(scene.materials[0].subsurface_model, Vec3::splat(0.8), 0.3);
        scene
    };
    // Camera and lamp are inside of a ball: the body is all that is around it, and many flights never come back
    let from_inside = |mut scene: Scene| {
        scene.objects.truncate(1);
        scene.materials[0].subsurface_radius = ScalarInput::constant(4.0);
        scene.lights = vec![Light::Rectangle {
            center: Vec3::new(0.3, 0.2, 1.5),
            edge_x: Vec3::X * 0.15,
            edge_y: Vec3::Y * -0.15,
            radiance: Vec3::new(19.0, 18.0, 17.0),
            visible: true,
        }];
        scene.camera.position = Vec3::new(-0.5, -0.3, 1.1);
        scene.camera.target = Vec3::new(1.0, 0.3, 1.0);
        scene
    };
    let (walk, profile) = (SubsurfaceModel::RandomWalk, SubsurfaceModel::Profile);
    let both = SubsurfaceTextureAt::Both;
    let scenes = [
        ("walk", bodies(walk(WalkSurface::Clear))),
        ("diffuse walk", bodies(walk(WalkSurface::Diffuse))),
        ("rough walk behind glass", behind_glass(bodies(walk(WalkSurface::Rough)))),
        ("diffuse walk around a room", from_inside(bodies(walk(WalkSurface::Diffuse)))),
        ("walk in overlapping balls", one_body(bodies(walk(WalkSurface::Clear)), 0.0)),
        ("walk across a gap", one_body(bodies(walk(WalkSurface::Clear)), 0.3)),
        ("diffuse walk across a gap", one_body(bodies(walk(WalkSurface::Diffuse)), 0.3)),
        ("glass", behind_glass(bodies(SubsurfaceModel::Profile(Model::NormalizedDiffusion)))),
        ("normalized diffusion", bodies(SubsurfaceModel::Profile(Model::NormalizedDiffusion))),
        (
            "translucent ground",
            on_translucent_ground(bodies(SubsurfaceModel::Profile(Model::NormalizedDiffusion))),
        ),
        ("oblique", bodies(SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique))),
        ("directional dipole", bodies(SubsurfaceModel::Profile(Model::DirectionalDipole))),
        ("both ends of a texture", textured(both, profile(Model::NormalizedDiffusion))),
        (
            "entries of a texture",
            textured(SubsurfaceTextureAt::Entry, profile(Model::NormalizedDiffusionOblique)),
        ),
        ("walk in a texture", textured(SubsurfaceTextureAt::Exit, walk(WalkSurface::Clear))),
        ("diffuse walk in a texture", textured(SubsurfaceTextureAt::Exit, walk(WalkSurface::Diffuse))),
        ("skin walk in a texture", textured(both, walk(WalkSurface::Skin))),
        ("walk in wide squares", checkered(WalkSurface::Clear, 8, DARK, BRIGHT)),
        ("diffuse walk in wide squares", checkered(WalkSurface::Diffuse, 8, DARK, BRIGHT)),
        ("rough walk in narrow squares", checkered(WalkSurface::Rough, 256, DARK, BRIGHT)),
        ("walk in squares nearly alike", checkered(WalkSurface::Clear, 32, 0.8 * BRIGHT, BRIGHT)),
        ("file", from_file(false)),
        ("file with holes", from_file(true)),
        ("energy", normalized(bodies(SubsurfaceModel::Profile(Model::NormalizedDiffusion)))),
    ];
    let most = if is_thorough() { 6.0 } else { 9.0 };
    for (name, scene) in scenes {
        let shared = pictures(&prepare(scene.clone()), 0..seeds(), 2);
        let mut alone = scene;
        alone.integrator.subsurface_sharing = false;
        let alone = pictures(&prepare(alone), 0..seeds(), 2);
        let mut total = [0.0; 2];
        for (region, channel) in (0..regions()).flat_map(|r| (0..3).map(move |c| (r, c))) {
            let mean = |film| mean_of(film, region, channel);
            // Equal seeds have their exits in common
            let pairs = shared.iter().zip(&alone).map(|(a, b)| mean(a) - mean(b));
            let (difference, squared) = statistics(pairs);
            let t = difference / squared.sqrt().max(1e-6);
            assert!(t.abs() < most, "{name}, region {region}, channel {channel}: {difference} off, t = {t}");
            for (total, films) in total.iter_mut().zip([&shared, &alone]) {
                *total += statistics(films.iter().map(mean)).1;
            }
        }
        // Walks of neighbors are no better for a whole region than its own, and entries of a model's profile are
        let is_model = !["walk", "texture", "file"].iter().any(|kind| name.contains(kind));
        // In the small pictures, by 12 seeds, an eighth is chance: 1.04 here was 0.96 in large ones, and 0.84 was 0.71
        let chance = if is_thorough() { 1.0 } else { 1.25 };
        // What the own medium adds comes from each walk alone: 1.27 times the variance under the skin
        let is_mixed = name.contains("walk in") && !name.contains("balls");
        let most = chance * if is_model { 0.8 } else { 1.1 } * if is_mixed { 1.25 } else { 1.0 };
        assert!(total[0] < most * total[1], "{name}: regions are as noisy, {total:?}");
    }
}

/// Plates of one body, one behind another, in even light: flights go through several, and what is behind a gap is for
/// those there. The last is in another, seen through its holes.
///
/// Two dozen comparisons of Student's t with 23 degrees of freedom, where |t| > 6 has a probability of 4e-6.
#[test]
fn sharing_keeps_the_mean_of_plates() {
    let plate = |(z, size): (f32, f32)| {
        let mut mesh = sphere(size, 24);
        mesh.positions.iter_mut().for_each(|p| *p = *p * Vec3::new(1.0, 1.0, 0.1) + Vec3::Z * z);
        Mesh { normals: Vec::new(), ..mesh }
    };
    let whole_plates = WalkSurface::ALL.map(|surface| (surface, 1.0, 65_536));
    // Given up after fewer flights than share, or as many
    let others = [
        (WalkSurface::Diffuse, 0.5, 65_536),
        (WalkSurface::Clear, 1.0, 2),
        (WalkSurface::Diffuse, 1.0, 3),
        (WalkSurface::Rough, 1.0, 4),
    ];
    for (surface, opacity, flights) in whole_plates.into_iter().chain(others) {
        let material = Material {
            specular_weight: ScalarInput::constant(0.0),
            geometry_opacity: ScalarInput::constant(opacity),
            subsurface_flights: flights as f32,
            ..translucent(SubsurfaceModel::RandomWalk(surface), Vec3::new(0.9, 0.7, 0.5), 0.5)
        };
        let mut scene = scene(
            [(0.0, 1.0), (0.15, 1.0), (0.5, 1.0), (0.8, 1.0), (0.8, 0.8)].map(plate).to_vec(),
            material,
        );
        scene.environment = uniform_environment(Vec3::ONE);
        scene.camera = Camera {
            position: Vec3::new(0.0, -2.5, 4.0),
            projection: Projection::Perspective { horizontal_fov: 24.0 },
            ..scene.camera
        };
        scene.film = Film { width: size(), height: size(), ..Film::default() };
        scene.integrator.max_depth = 4;
        let shared = pictures(&prepare(scene.clone()), 0..24, 8);
        scene.integrator.subsurface_sharing = false;
        let alone = pictures(&prepare(scene), 0..24, 8);
        for channel in 0..3 {
            let whole = |film: &FilmSums| {
                (0..regions()).map(|region| mean_of(film, region, channel)).sum::<f64>()
                    / f64::from(regions())
            };
            let pairs = shared.iter().zip(&alone).map(|(a, b)| whole(a) - whole(b));
            let (difference, squared) = statistics(pairs);
            let (mean, error) = (statistics(alone.iter().map(whole)).0, squared.sqrt());
            let name = format!("{surface:?}, {flights} flights, channel {channel}");
            assert!(error < 4e-3 * mean, "{name}: too noisy to tell, {error}");
            let t = difference / error.max(1e-6);
            assert!(t.abs() < 6.0, "{name}: {difference} of {mean} off, t = {t}");
        }
    }
}

/// A texture of one color makes the picture of that color, shared and alone, and so do vertex colors.
#[test]
fn sharing_in_an_even_texture_is_that_in_its_color() {
    for surface in [WalkSurface::Clear, WalkSurface::Skin] {
        let mut even = bodies(SubsurfaceModel::RandomWalk(surface));
        even.materials[0].subsurface_color = ColorInput::constant(BRIGHT);
        let mut colored = even.clone();
        colored.materials[0].subsurface_color = ColorInput::vertex();
        let mut mesh = sphere(1.0, 24);
        mesh.positions.iter_mut().for_each(|p| *p += Vec3::Z);
        mesh.colors = vec![BRIGHT; mesh.positions.len()];
        colored.objects[0].mesh = mesh.into();
        for shared in [true, false] {
            let picture = |mut scene: Scene| {
                scene.integrator.subsurface_sharing = shared;
                pictures(&prepare(scene), 0..1, 4).remove(0)
            };
            let expected = picture(even.clone());
            for other in [checkered(surface, 2, BRIGHT, BRIGHT), colored.clone()].map(picture) {
                for (x, y) in (0..size()).flat_map(|y| (0..size()).map(move |x| (x, y))) {
                    let (a, b) = (expected.radiance(x, y), other.radiance(x, y));
                    // But for rounding, by which a flight may miss what another hits
                    let off = (0..3).map(|c| (a[c] - b[c]).abs() / (a[c].abs() + 1.0)).fold(0.0, f64::max);
                    assert!(off < 0.01, "{surface:?}, {shared}, pixel {x} {y}: {a:?} {b:?}");
                }
            }
        }
    }
}

/// Noise as a viewer sees it is the variance of each pixel relative to its square. Without a fixed seed the ratios,
/// 0.12, 0.26, 0.25, 0.19, 0.74, 0.34, 0.39 and 0.77 here and 0.13, 0.24, 0.24, 0.21, 0.86, 0.46, 0.5 and 0.84 if thorough,
/// would vary by a few percent.
#[test]
fn sharing_takes_most_of_the_noise_away() {
    let noise = |scene: &Scene, is_shared: bool| {
        let mut scene = scene.clone();
        scene.integrator.subsurface_sharing = is_shared;
        // A lamp behind the bodies, as close as a pixel sees little of the body
        scene.camera.projection = Projection::Perspective { horizontal_fov: 0.25 * size() as f32 };
        let films = pictures(&prepare(scene), 0..seeds(), 2);
        let mut sum = 0.0;
        for (x, y) in (0..size()).flat_map(|y| (0..size()).map(move |x| (x, y))) {
            let (mean, error) = statistics(films.iter().map(|film| film.radiance(x, y).iter().sum()));
            sum += error / (mean * mean + 0.01);
        }
        sum
    };
    // Of a mean free path of half a pixel and more at any size of the picture
    let fine = |mut scene: Scene| {
        scene.materials.iter_mut().for_each(|m| m.subsurface_radius = ScalarInput::constant(0.02));
        scene
    };
    let walk = SubsurfaceModel::RandomWalk;
    let normalized = SubsurfaceModel::Profile(Model::NormalizedDiffusion);
    for (name, scene, most) in [
        ("profile", bodies(normalized), 0.25),
        ("both ends of a texture", textured(SubsurfaceTextureAt::Both, normalized), 0.4),
        ("entries of a texture", textured(SubsurfaceTextureAt::Entry, normalized), 0.4),
        ("file", from_file(false), 0.25),
        ("walk", bodies(walk(WalkSurface::Clear)), 1.0),
        ("diffuse walk", bodies(walk(WalkSurface::Diffuse)), 0.9),
        ("diffuse walk in squares", checkered(WalkSurface::Diffuse, 8, 0.7 * BRIGHT, BRIGHT), 0.97),
        ("diffuse walk below a pixel", fine(bodies(walk(WalkSurface::Diffuse))), 0.9),
    ] {
        let (shared, alone) = (noise(&scene, true), noise(&scene, false));
        assert!(shared < most * alone, "{name}: {shared} {alone}");
    }
}

/// Edge of the pictures in which borders are looked for, two blocks of pixels.
const FINE: u32 = 128;

/// Errors of pictures with one sample a pixel relative to their mean, where a body fills them whose light travels so far.
fn errors(model: SubsurfaceModel, pixels: f32, is_shared: bool) -> Vec<Vec<f64>> {
    let mut scene = bodies(model);
    scene.film = Film { width: FINE, height: FINE, ..Film::default() };
    scene.camera.target = Vec3::new(0.0, 0.0, 1.0);
    scene.camera.projection = Projection::Perspective { horizontal_fov: 11.0 };
    let distance = scene.camera.position.distance(scene.camera.target) - 1.0;
    let pixel = 2.0 * distance * 5.5_f32.to_radians().tan() / FINE as f32;
    scene.materials[0].subsurface_radius = ScalarInput::constant(pixels * pixel);
    scene.materials[0].specular_weight = ScalarInput::constant(0.0);
    scene.objects.remove(1);
    scene.integrator.subsurface_sharing = is_shared;
    let films = pictures(&prepare(scene), 0..seeds(), 1);
    let of_pixel = |i: u32| {
        let value = |film: &FilmSums| film.radiance(i % FINE, i / FINE).iter().sum::<f64>();
        let mean = statistics(films.iter().map(value)).0;
        films.iter().map(|film| value(film) / mean.max(0.02) - mean / mean.max(0.02)).collect()
    };
    (0..FINE * FINE).map(of_pixel).collect()
}

/// Mean square, over pictures and places, of a function of the errors around a place.
fn mean_square(
    errors: &[Vec<f64>],
    places: impl Iterator<Item = (u32, u32)> + Clone,
    of: impl Fn(&dyn Fn(u32, u32) -> f64) -> f64,
) -> f64 {
    let count = places.clone().count() * errors[0].len();
    let one = |(x, y): (u32, u32)| {
        let in_film = |film: usize| of(&|dx, dy| errors[((y + dy) * FINE + x + dx) as usize][film]).powi(2);
        (0..errors[0].len()).map(in_film).sum::<f64>()
    };
    places.map(one).sum::<f64>() / count as f64
}

/// Where light travels far the squares of pixels that share do not show: steps between neighbors are 1.00 to 1.04 times as
/// high across their borders as elsewhere. They would be 1.3 to 2 times as high if each square shared on its own.
#[test]
fn sharing_leaves_no_borders() {
    let model = SubsurfaceModel::Profile(Model::NormalizedDiffusion);
    for pixels in [16.0, 64.0, 800.0] {
        let errors = errors(model, pixels, true);
        let across = |is_border: bool| {
            let places = (0..FINE * (FINE - 1)).map(|i| (i % (FINE - 1), i / (FINE - 1)));
            let places = places.filter(|(x, _)| ((x + 1) % 16 == 0) == is_border);
            mean_square(&errors, places, |error| error(1, 0) - error(0, 0))
        };
        let step = (across(true) / across(false)).sqrt();
        assert!(step < 1.1, "mean free path of {pixels} pixels: {step}");
    }
}

/// The mean of a region is as certain as without sharing, except where light travels about as far as the region is wide:
/// which entries lie on which side of its edge is a matter of chance that a pixel alone does not have.
#[test]
fn sharing_keeps_regions_as_certain() {
    let profile = SubsurfaceModel::Profile(Model::NormalizedDiffusion);
    let walk = SubsurfaceModel::RandomWalk(WalkSurface::Diffuse);
    for (model, pixels, most) in [
        (profile, 1.0, 1.1),
        (profile, 4.0, 1.25),
        (profile, 16.0, 1.1),
        (profile, 64.0, 1.1),
        (profile, 800.0, 1.1),
        (walk, 16.0, 1.1),
    ] {
        let [shared, alone] = [true, false].map(|is_shared| {
            let errors = errors(model, pixels, is_shared);
            let places = (0..49).map(|i| (8 + i % 7 * 16, 8 + i / 7 * 16));
            let mean = |error: &dyn Fn(u32, u32) -> f64| {
                (0..256).map(|i| error(i % 16, i / 16)).sum::<f64>() / 256.0
            };
            mean_square(&errors, places, mean).sqrt()
        });
        assert!(shared < most * alone, "{model:?}, mean free path of {pixels} pixels: {shared} {alone}");
    }
}

/// A plane under a uniform sky and a small lamp.
fn plane(model: SubsurfaceModel) -> Scene {
    let material = Material {
        specular_weight: ScalarInput::constant(0.0),
        ..translucent(model, Vec3::new(0.9, 0.5, 0.1), 0.3)
    };
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 200.0, Vec3::Y * 200.0)], material);
    scene.lights.push(Light::Rectangle {
        center: Vec3::new(1.0, 2.0, 5.0),
        edge_x: Vec3::Y,
        edge_y: Vec3::X,
        radiance: Vec3::splat(2.5),
        visible: false,
    });
    scene.environment = uniform_environment(Vec3::ONE);
    scene.camera.position = Vec3::new(0.0, -1.5, 2.0);
    scene.film = Film { width: size(), height: size(), ..Film::default() };
    scene.integrator.max_depth = 2;
    scene
}

/// Where light is even a pixel alone has almost no noise: its 16 samples complement each other. The ratio is
/// 1.00 here; without a fixed seed it would vary by a few percent.
#[test]
fn sharing_adds_no_noise_to_even_light() {
    let scene = plane(SubsurfaceModel::Profile(Model::NormalizedDiffusion));
    let noise = |is_shared: bool| {
        let mut scene = scene.clone();
        scene.integrator.subsurface_sharing = is_shared;
        let films = pictures(&prepare(scene), 0..6, 16);
        let pixels = (0..size() * size()).map(|i| (i % size(), i / size()));
        pixels.map(|(x, y)| statistics(films.iter().map(|film| film.radiance(x, y)[0])).1).sum::<f64>()
    };
    let (shared, alone) = (noise(true), noise(false));
    assert!(shared < 1.1 * alone, "{shared} {alone}");
}

/// Even light on a plane: A leaves wherever it entered, exactly, whatever the weights of entries.
///
/// Nine comparisons of Student's t with 23 degrees of freedom, where |t| > 5 has a probability of 5e-5, or 11, where it
/// has 4e-4.
#[test]
fn sharing_returns_the_surface_albedo_of_a_plane() {
    let color = Vec3::new(0.9, 0.5, 0.1);
    let profiles = [Model::NormalizedDiffusion, Model::PhotonBeamDiffusion].map(SubsurfaceModel::Profile);
    // Seen through a clear surface, a plane returns more or less by the angle
    let walk = SubsurfaceModel::RandomWalk(WalkSurface::Diffuse);
    let models = profiles.map(|profile| (profile, 2)).into_iter().chain([(walk, 6)]);
    for (model, samples) in models {
        let mut scene = plane(model);
        scene.lights.clear();
        let films = pictures(&prepare(scene), 0..seeds(), samples);
        for channel in 0..3 {
            let whole = |film: &FilmSums| {
                (0..regions()).map(|region| mean_of(film, region, channel)).sum::<f64>()
                    / f64::from(regions())
            };
            let (mean, squared) = statistics(films.iter().map(whole));
            let (error, expected) = (squared.sqrt(), f64::from(color[channel]));
            assert!(
                error < bound(6e-3) * expected,
                "{model:?}, channel {channel}: too noisy to tell, {error}"
            );
            let t = (mean - expected) / error.max(1e-5);
            assert!(t.abs() < 5.0, "{model:?}, channel {channel}: {mean} ± {error}, t = {t}");
        }
    }
}
