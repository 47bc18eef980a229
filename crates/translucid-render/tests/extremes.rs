//! Random scenes of extreme but valid parameters: whatever is rendered ends, and is finite.

mod common;

use std::sync::atomic::AtomicBool;

use common::{quad, scene, sphere};
use glam::{Mat3, Vec2, Vec3};
use translucid_render::{FilmSums, Goal, Outcome, Renderer, layer};
use translucid_scene::{
    Camera, ColorInput, Configuration, Environment, Film, FilterKind, Integrator, Light, Material, Mesh,
    ScalarInput, Scene, SubsurfaceModel, SubsurfaceParameter,
};

const SCENES: u64 = 150;

/// SplitMix64 [Steele, Lea & Flood 2014].
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1 << 24) as f32
    }

    fn chance(&mut self, probability: f32) -> bool {
        self.unit() < probability
    }

    fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.next() as usize % choices.len()]
    }

    /// Most often at or next to an end of [0, 1].
    fn weight(&mut self) -> f32 {
        let between = self.unit();
        self.pick(&[0.0, 0.0, 1e-6, 0.5, between, 1.0 - 1e-6, 1.0, 1.0])
    }

    fn color(&mut self) -> Vec3 {
        if self.chance(0.3) {
            Vec3::splat(self.weight())
        } else {
            Vec3::new(self.weight(), self.weight(), self.weight())
        }
    }

    fn direction(&mut self) -> Vec3 {
        if self.chance(0.3) {
            return self.pick(&[Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z]);
        }
        (self.inside() * 2.0 - Vec3::ONE).normalize_or(Vec3::Y)
    }

    /// A point of the unit cube.
    fn inside(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit())
    }
}

fn material(random: &mut Random, scale: f32) -> Material {
    let scalar = |random: &mut Random| ScalarInput::constant(random.weight());
    let color = |random: &mut Random| ColorInput::constant(random.color());
    let ior = |random: &mut Random| random.pick(&[1.0, 1.0001, 1.002, 1.5, 4.0]);
    let glass = if random.chance(0.4) { random.weight() } else { 0.0 };
    let opacity = if random.chance(0.3) { random.weight() } else { 1.0 };
    Material {
        base_weight: random.weight(),
        base_color: color(random),
        base_metalness: if random.chance(0.3) { scalar(random) } else { ScalarInput::constant(0.0) },
        specular_weight: scalar(random),
        specular_color: color(random),
        specular_roughness: ScalarInput::constant(random.pick(&[0.0, 1e-3, 0.03, 0.032, 0.3, 1.0])),
        specular_ior: ior(random),
        transmission_weight: ScalarInput::constant(glass),
        transmission_color: color(random),
        transmission_depth: random.pick(&[0.0, 0.0, 1e-9, 1.0, 1e9]) * scale,
        subsurface_weight: ScalarInput::constant(random.pick(&[0.0, 0.5, 1.0, 1.0])),
        subsurface_color: color(random),
        subsurface_radius: ScalarInput::constant(random.pick(&[0.0, 1e-9, 1e-3, 0.1, 1.0, 1e9]) * scale),
        subsurface_radius_scale: color(random),
        subsurface_model: random.pick(&SubsurfaceModel::ALL),
        subsurface_parameter: random.pick(&[SubsurfaceParameter::Mfp, SubsurfaceParameter::Dmfp]),
        subsurface_configuration: random.pick(&[Configuration::Searchlight, Configuration::Diffuse]),
        coat_weight: if random.chance(0.3) { scalar(random) } else { ScalarInput::constant(0.0) },
        coat_color: color(random),
        coat_roughness: scalar(random),
        coat_ior: ior(random),
        emission_luminance: random.pick(&[0.0, 0.0, 0.0, 1e-6, 1.0, 1e6]),
        emission_color: color(random),
        geometry_opacity: ScalarInput::constant(opacity),
        ..Material::default()
    }
}

/// Closed, open, flat, needle-shaped or coincident.
fn mesh(random: &mut Random, scale: f32) -> Mesh {
    let center = (random.inside() - Vec3::splat(0.5)) * (2.0 * scale);
    let size = random.pick(&[1e-6, 1e-2, 0.5, 1.0, 30.0]) * scale;
    let mut mesh = match random.next() % 5 {
        0 => sphere(size, 4),
        1 => quad(Vec3::ZERO, Vec3::X * size, Vec3::Y * size),
        2 => {
            let mut open = sphere(size, 4);
            open.triangles.truncate(12);
            open
        }
        3 => quad(Vec3::ZERO, random.direction() * size, random.direction() * (size * 1e-4)),
        _ => {
            let mut twice = quad(Vec3::ZERO, Vec3::Z * size, Vec3::Y * size);
            twice.triangles.extend(twice.triangles.clone());
            twice
        }
    };
    if random.chance(0.2) {
        mesh.flip_winding();
    }
    if random.chance(0.2) {
        mesh.normals = mesh.positions.iter().map(|_| random.direction()).collect();
    }
    if random.chance(0.2) {
        mesh.uvs = vec![Vec2::ONE; mesh.positions.len()];
        mesh.colors = mesh.positions.iter().map(|_| random.color()).collect();
    }
    // The limit that loaders set.
    mesh.positions.iter_mut().for_each(|p| *p = (*p + center).clamp(Vec3::splat(-1e9), Vec3::splat(1e9)));
    mesh
}

fn light(random: &mut Random, scale: f32) -> Light {
    let at = (random.inside() - Vec3::splat(0.5)) * (random.pick(&[0.0, 1.0, 4.0, 100.0]) * scale);
    let size = random.pick(&[1e-6, 0.1, 1.0, 1e3]) * scale;
    let bright = random.color() * random.pick(&[1e-6, 1.0, 1e6]);
    let direction = random.direction();
    let visible = random.chance(0.5);
    match random.next() % 5 {
        0 => {
            let edge_x = direction.any_orthonormal_vector();
            let edge_y = direction.cross(edge_x) * size * random.pick(&[1.0, 1e-4]);
            Light::Rectangle { center: at, edge_x: edge_x * size, edge_y, radiance: bright, visible }
        }
        1 => Light::Sphere { center: at, radius: size, radiance: bright, visible },
        2 => {
            let angular_radius = random.pick(&[0.0, 1e-3, 0.25, 89.9]);
            Light::Distant { direction, angular_radius, irradiance: bright }
        }
        3 => {
            let (inner_angle, outer_angle) = random.pick(&[(0.0, 1e-3), (10.0, 30.0), (0.0, 180.0)]);
            let intensity = bright * (scale * scale);
            Light::Spot { position: at, direction, intensity, inner_angle, outer_angle }
        }
        _ => Light::Beam { origin: at, direction, radius: size, power: bright * (scale * scale) },
    }
}

fn camera(random: &mut Random, scale: f32) -> Camera {
    // Within the objects, among them, or far from them.
    let distance = random.pick(&[1e-3, 0.7, 3.0, 50.0]);
    let position = random.direction() * (distance * scale);
    let target = if random.chance(0.7) { Vec3::ZERO } else { position + random.direction() * scale };
    Camera {
        position,
        target,
        up: random.direction(),
        horizontal_fov: random.pick(&[1e-3, 45.0, 179.9]),
        lens_radius: random.pick(&[0.0, 0.0, 0.1]) * scale,
        focus_distance: scale,
    }
}

/// The scene of a seed.
fn random_scene(seed: u64) -> Scene {
    let mut random = Random(seed);
    let scale = random.pick(&[1.0, 1.0, 1e-3, 1e4, 1e8]);
    let count = 1 + random.next() % 4;
    let mut scene =
        scene((0..count).map(|_| mesh(&mut random, scale)).collect(), material(&mut random, scale));
    for index in 1..scene.objects.len() {
        scene.materials.push(material(&mut random, scale));
        scene.objects[index].material = random.next() as usize % scene.materials.len();
        scene.objects[index].subsurface_group = random.pick(&[0, 1]);
    }
    let lights = random.pick(&[0, 1, 3, 40]);
    scene.lights = (0..lights).map(|_| light(&mut random, scale)).collect();
    scene.environment = random.chance(0.5).then(|| Environment {
        radiance: random.color(),
        image: None,
        world_from_environment: Mat3::IDENTITY,
        visible: random.chance(0.5),
    });
    scene.camera = camera(&mut random, scale);
    scene.film = Film {
        width: 16,
        height: 16,
        filter: random.pick(&[FilterKind::Box, FilterKind::Gaussian, FilterKind::BlackmanHarris]),
        filter_radius: random.pick(&[1e-3, 0.5, 8.0]),
        ..Film::default()
    };
    scene.integrator = Integrator {
        max_depth: random.pick(&[1, 4, 12, 100]),
        max_diffuse_depth: random.pick(&[0, 1, 4, 100]),
        caustics: random.chance(0.5),
        subsurface_tail: random.pick(&[1e-30, 1e-6, 1e-3, 0.1]),
        seed,
        ..Integrator::default()
    };
    scene
}

/// Renders the scene of a seed; what is wrong with the film.
fn complaint(seed: u64) -> Option<String> {
    let renderer = Renderer::new(random_scene(seed));
    let mut film = FilmSums::new(16, 16);
    let goal = Goal { samples: 2, deadline: None };
    let outcome = renderer.render(&mut film, goal, &|_| {}, &AtomicBool::new(false));
    if outcome != Outcome::Finished {
        return Some(format!("{outcome:?}"));
    }
    let signed = layer::NORMAL;
    film.tiles.iter().flat_map(|tile| &tile.pixels).enumerate().find_map(|(pixel, sums)| {
        let good = |(index, sum): (usize, &f64)| sum.is_finite() && (*sum >= 0.0 || signed.contains(&index));
        (!sums.iter().enumerate().all(good)).then(|| format!("pixel {pixel}: {sums:?}"))
    })
}

#[test]
fn extreme_scenes_end_and_stay_finite() {
    let failures: Vec<String> = (0..SCENES)
        .filter_map(|seed| {
            // A panic, too, shall tell its seed.
            let result = std::panic::catch_unwind(|| complaint(seed));
            let complaint = result.unwrap_or_else(|_| Some("panics".into()))?;
            Some(format!("seed {seed}: {complaint}"))
        })
        .collect();
    assert!(failures.is_empty(), "{} of {SCENES} scenes:\n{}", failures.len(), failures.join("\n"));
}
