//! Scenes of lights.

use std::sync::Arc;

use glam::{Mat3, Quat, Vec3};
use translucid_render::PreparedScene;
use translucid_scene::{
    ColorInput, ColorSpace, Environment, Image, Light, Material, Mesh, Object, Pixels, Scene,
};
use translucid_testing::SplitMix;

/// Red radiance, intensity or irradiance of a light.
pub(super) const RED: f32 = 3.0;
const COLOR: Vec3 = Vec3::new(RED, 2.0, 1.0);

/// Lights, and points that they shine on.
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) prepared: PreparedScene,
    pub(super) points: Vec<Vec3>,
    /// About where the lights are.
    pub(super) middle: Vec3,
    pub(super) has_surface: bool,
    pub(super) is_infinite: bool,
    /// Greatest radiance.
    pub(super) peak: f32,
    /// Emissive triangles by their number in the scene.
    pub(super) triangles: Vec<[Vec3; 3]>,
}

impl Case {
    fn new(name: &'static str, lights: Vec<Light>, triangles: Vec<[Vec3; 3]>, sky: Option<Sky>) -> Self {
        let mesh = Mesh {
            positions: triangles.concat(),
            triangles: (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
            ..Mesh::default()
        };
        let shining = Material {
            emission_luminance: RED,
            emission_color: ColorInput::constant(COLOR / RED),
            ..Material::default()
        };
        let dark = Mesh {
            positions: vec![Vec3::splat(-0.1), Vec3::X * 0.1, Vec3::Y * 0.1],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let object = |mesh: Mesh, material| Object { mesh: mesh.into(), material, ..Object::default() };
        let mut objects = vec![object(dark, 1)];
        if !triangles.is_empty() {
            objects.insert(0, object(mesh, 0));
        }
        let is_surface = |light: &Light| {
            matches!(light, Light::Rectangle { .. } | Light::Ellipse { .. } | Light::Sphere { .. })
        };
        let has_radius = |light: &Light| matches!(light, Light::Spot { radius, .. } if *radius > 0.0);
        let is_disc =
            |light: &Light| matches!(light, Light::Distant { angular_radius, .. } if *angular_radius > 0.01);
        let case = (
            lights.iter().any(|light| is_surface(light) || has_radius(light)),
            sky.is_some() || lights.iter().any(is_disc),
        );
        let (environment, images) = sky.map_or((None, Vec::new()), |sky| (Some(sky.environment), sky.images));
        let scene = Scene {
            objects,
            materials: vec![shining, Material::default()],
            images,
            lights,
            environment,
            ..Scene::default()
        };
        Self {
            name,
            prepared: PreparedScene::new(scene).unwrap(),
            points: vec![Vec3::ZERO, Vec3::new(0.3, -2.0, 0.6), Vec3::new(-4.0, 3.0, -80.0)],
            middle: Vec3::Z,
            has_surface: case.0,
            is_infinite: case.1,
            peak: RED,
            triangles,
        }
    }

    fn of(name: &'static str, light: Light) -> Self {
        Self::new(name, vec![light], Vec::new(), None)
    }

    fn at(self, points: &[Vec3]) -> Self {
        Self { points: points.to_vec(), ..self }
    }
}

/// An environment with its image.
struct Sky {
    environment: Environment,
    images: Vec<Arc<Image>>,
}

fn constant_sky() -> Sky {
    Sky { environment: Environment { radiance: COLOR, ..Environment::default() }, images: Vec::new() }
}

/// A sky with an image, turned in an arbitrary way.
fn image_sky(width: u32, height: u32, color: impl Fn(u32, u32) -> Vec3) -> Sky {
    let data = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = Pixels::Float(data.map(|(x, y)| color(x, y).extend(1.0).to_array()).collect());
    let color_space = ColorSpace::Linear;
    let image = Image { name: "sky".into(), path: None, width, height, color_space, pixels };
    let world_from_environment =
        Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1).normalize());
    let environment =
        Environment { image: Some(0), world_from_environment, visible: false, ..Environment::default() };
    Sky { environment, images: vec![Arc::new(image)] }
}

/// A gradient with a small sun, black in one corner.
fn sunny(width: u32, height: u32, sun: f32) -> Sky {
    image_sky(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        let is_sun = (u - 0.7).abs() < 0.04 && (v - 0.3).abs() < 0.04;
        if u < 0.2 && v > 0.5 {
            Vec3::ZERO
        } else {
            Vec3::new(0.1 + v, 0.2 + u, 0.5) + Vec3::splat(if is_sun { sun } else { 0.0 })
        }
    })
}

pub(super) fn maps() -> Vec<Case> {
    let case = |name, sky, peak| Case { peak, ..Case::new(name, Vec::new(), Vec::new(), Some(sky)) };
    let points = [Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)];
    vec![
        case("one pixel", image_sky(1, 1, |_, _| COLOR), RED).at(&points),
        case("a few pixels", image_sky(5, 3, |x, y| COLOR * (x + 2 * y) as f32), 8.0 * RED).at(&points),
        case("a sun", sunny(64, 32, 300.0), 300.0).at(&points),
        // More pixels than cells, the last ones of a row and column narrower
        case("a large image", sunny(1500, 1027, 3.0), 4.0).at(&points),
    ]
}

fn rectangle(center: Vec3, edge_x: Vec3, edge_y: Vec3) -> Light {
    Light::Rectangle { center, edge_x, edge_y, radiance: COLOR, visible: true }
}

fn ellipse(center: Vec3, edge_x: Vec3, edge_y: Vec3) -> Light {
    Light::Ellipse { center, edge_x, edge_y, radiance: COLOR, visible: false }
}

fn sphere(center: Vec3, radius: f32) -> Light {
    Light::Sphere { center, radius, radiance: COLOR, visible: true }
}

fn spot(position: Vec3, radius: f32, [inner_angle, outer_angle]: [f32; 2]) -> Light {
    let direction = Vec3::NEG_Z;
    Light::Spot { position, direction, radius, intensity: COLOR, inner_angle, outer_angle, visible: true }
}

fn distant(angular_radius: f32) -> Light {
    Light::Distant { direction: Vec3::new(0.6, 0.0, 0.8), angular_radius, irradiance: COLOR }
}

/// Corners of triangles that shine downward.
fn triangles() -> Vec<[Vec3; 3]> {
    let down = |a: Vec3, b: Vec3, c: Vec3| [a, c, b];
    vec![
        down(Vec3::new(-1.0, -0.5, 1.0), Vec3::new(0.8, -0.4, 1.2), Vec3::new(0.1, 0.9, 1.0)),
        [Vec3::new(-2.0, 1.0, 1.0), Vec3::new(-1.0, 1.0, 1.5), Vec3::new(-2.0, 0.0, 1.0)],
        down(Vec3::new(2.0, 2.0, 1.0), Vec3::new(2.5, 2.0, 1.1), Vec3::new(2.0, 2.01, 1.0)),
    ]
}

/// One light each.
pub(super) fn single_lights() -> Vec<Case> {
    let (middle, turn) = (Vec3::Z, Quat::from_axis_angle(Vec3::new(0.48, 0.6, 0.64), 0.7).normalize());
    // Below, almost in the plane above an edge, just below the middle, beside, far, at the size where the drawing changes
    let around = [
        Vec3::ZERO,
        Vec3::new(0.5, 0.1, 0.999),
        Vec3::new(0.1, 0.2, 0.9999),
        Vec3::new(1.5, 0.3, 0.8),
        Vec3::new(3.0, 0.9, 0.95),
        Vec3::new(30.0, -20.0, -500.0),
        Vec3::new(0.2, 0.1, -8.7),
        Vec3::new(0.2, 0.1, -9.3),
    ];
    let below = [Vec3::ZERO, Vec3::new(1.5, 0.3, -0.8), Vec3::new(30.0, -20.0, -500.0)];
    vec![
        Case::of("rectangle", rectangle(middle, Vec3::X, Vec3::NEG_Y * 1.2)).at(&around),
        Case::of("turned rectangle", rectangle(middle, turn * Vec3::X, turn * Vec3::NEG_Y)).at(&below),
        Case::of("strip", rectangle(middle, Vec3::X * 30.0, Vec3::NEG_Y * 0.02)).at(&around),
        Case::of("upright strip", rectangle(middle, Vec3::X * 0.02, Vec3::NEG_Y * 30.0)).at(&around),
        Case::of("ellipse", ellipse(middle, Vec3::X, Vec3::NEG_Y * 1.2)).at(&around),
        Case::of("narrow ellipse", ellipse(middle, Vec3::X * 6.0, Vec3::NEG_Y * 0.2)).at(&around),
        Case::of("sphere", sphere(middle, 0.5)).at(&[Vec3::ZERO, Vec3::Z * 0.49, Vec3::X * 3000.0]),
        Case::of("wide round spot", spot(middle, 0.3, [20.0, 80.0])).at(&below),
        Case::of("narrow round spot", spot(middle, 0.6, [5.0, 12.0])).at(&[
            Vec3::ZERO,
            Vec3::new(0.1, 0.2, 0.3),
            Vec3::new(8.0, 3.0, -60.0),
        ]),
        Case::of("round lamp", spot(middle, 0.3, [0.0, 180.0])).at(&below),
        Case::of("disc", distant(5.0)),
        Case::of("the sun's disc", distant(0.266)),
        Case::new("even sky", Vec::new(), Vec::new(), Some(constant_sky())),
        Case { has_surface: false, ..Case::new("triangles", Vec::new(), triangles(), None) },
    ]
}

fn each_kind() -> Vec<Light> {
    vec![
        rectangle(Vec3::new(0.0, 0.0, 2.0), Vec3::X, Vec3::NEG_Y),
        ellipse(Vec3::new(0.0, 2.0, 1.0), Vec3::X * 1.5, Vec3::NEG_Y * 0.75),
        sphere(Vec3::new(3.0, 0.0, 2.0), 1.0),
        spot(Vec3::new(2.0, -3.0, 2.0), 0.5, [30.0, 80.0]),
        distant(5.0),
        distant(0.0),
        spot(Vec3::new(0.0, -1.0, 1.0), 0.0, [10.0, 90.0]),
        Light::Beam { origin: Vec3::Z, direction: Vec3::NEG_Z, radius: 0.3, power: COLOR },
    ]
}

/// A light of every kind, with triangles and a sky.
pub(super) fn all_kinds() -> Case {
    Case { peak: 300.0, ..Case::new("all kinds", each_kind(), triangles(), Some(sunny(64, 32, 30.0))) }
}

/// More lights than are weighed one by one.
pub(super) fn many() -> Case {
    let mut random = SplitMix(21);
    let mut lights = each_kind();
    for _ in 0..60 {
        let place = Vec3::from_array([(); 3].map(|()| 6.0 * random.uniform_f32() - 3.0));
        let radius = 0.02 + 0.1 * random.uniform_f32();
        lights.push(sphere(place + 2.0 * Vec3::Z, radius));
    }
    let mut corner = || Vec3::from_array([(); 3].map(|()| random.uniform_f32()));
    let shards = (0..60).map(|_| {
        let place = 6.0 * corner() - 3.0;
        [place, place + 0.3 * corner(), place + 0.3 * corner()]
    });
    let triangles = shards.collect();
    Case { peak: 30.0, ..Case::new("many", lights, triangles, Some(sunny(64, 32, 3.0))) }
}

/// More lights that no tree holds than are weighed one by one, and some that one would hold.
pub(super) fn by_power() -> Case {
    let mut lights = each_kind();
    let distant = |i: usize| Light::Distant {
        direction: Vec3::new((i as f32).cos(), (i as f32).sin(), 1.0).normalize(),
        angular_radius: 3.0,
        irradiance: COLOR * 0.1 * (1 + i % 3) as f32,
    };
    lights.extend((0..40).map(distant));
    Case { peak: 100.0, ..Case::new("by power", lights, triangles(), Some(sunny(64, 32, 3.0))) }
}

/// So many spheres.
pub(super) fn spheres(count: usize) -> Case {
    let lights = (0..count).map(|i| sphere(Vec3::X * (i as f32 + 2.0), 0.1)).collect();
    Case::new("spheres", lights, Vec::new(), None)
}
