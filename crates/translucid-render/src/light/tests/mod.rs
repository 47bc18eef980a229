//! Lights against closed forms, and samples against densities.
//!
//! Draws are independent with fixed seeds. A mean counts as right within four standard errors (false-alarm rate
//! 6e-5 a comparison, below 1 % over all comparisons of this file) plus a relative 2e-5 for single precision.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{DVec3, Mat3, Quat};
use translucid_scene::{
    Camera, ColorSpace, Environment as SceneEnvironment, Film, Image, Integrator, Light, Pixels, Projection,
    Unit,
};

use super::*;
use crate::ray::LightOrigin;
use crate::sampling::Sampler;

mod environment_map;
mod many;

const RADIANCE: Vec3 = Vec3::new(3.0, 2.0, 1.0);

fn light_set(
    lights: Vec<Light>,
    emissive: Vec<EmissiveTriangle>,
    sky: Option<(SceneEnvironment, Vec<Arc<Image>>)>,
) -> LightSet {
    let (environment, images) = sky.map_or((None, Vec::new()), |(e, images)| (Some(e), images));
    let scene = Scene {
        unit: Unit::Millimeter,
        camera: Camera {
            position: Vec3::Z,
            target: Vec3::ZERO,
            up: Vec3::Y,
            projection: Projection::Perspective { horizontal_fov: 45.0 },
            focus_distance: 1.0,
            ..Camera::default()
        },
        film: Film::default(),
        integrator: Integrator::default(),
        objects: Vec::new(),
        materials: Vec::new(),
        images,
        profile_tables: Vec::new(),
        lights,
        environment,
        ..Scene::default()
    };
    LightSet::new(&scene, emissive, (Vec3::splat(-1.0), Vec3::ONE))
}

fn of_light(light: Light) -> LightSet {
    light_set(vec![light], Vec::new(), None)
}

fn rectangle(center: Vec3, edge_x: Vec3, edge_y: Vec3) -> Light {
    Light::Rectangle { center, edge_x, edge_y, radiance: RADIANCE, visible: true }
}

fn ellipse(center: Vec3, edge_x: Vec3, edge_y: Vec3) -> Light {
    Light::Ellipse { center, edge_x, edge_y, radiance: RADIANCE, visible: true }
}

/// A spot with a radius that shines downward.
fn round_spot(position: Vec3, radius: f32, inner_angle: f32, outer_angle: f32) -> Light {
    let (direction, intensity) = (Vec3::NEG_Z, RADIANCE);
    Light::Spot { position, direction, radius, intensity, inner_angle, outer_angle, visible: true }
}

fn sphere(center: Vec3, radius: f32) -> Light {
    Light::Sphere { center, radius, radiance: RADIANCE, visible: true }
}

fn triangle(primitive: u32, vertices: [Vec3; 3]) -> EmissiveTriangle {
    EmissiveTriangle { vertices, radiance: RADIANCE, primitive: primitive.into() }
}

fn constant_sky() -> (SceneEnvironment, Vec<Arc<Image>>) {
    let environment = SceneEnvironment {
        radiance: RADIANCE,
        image: None,
        world_from_environment: Mat3::IDENTITY,
        visible: true,
    };
    (environment, Vec::new())
}

/// A sky with an image, turned in an arbitrary way.
fn image_sky(
    width: u32,
    height: u32,
    color: impl Fn(u32, u32) -> Vec3,
) -> (SceneEnvironment, Vec<Arc<Image>>) {
    let data = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = Pixels::Float(data.map(|(x, y)| color(x, y).extend(1.0).to_array()).collect());
    let image =
        Image { name: "sky".into(), path: None, width, height, color_space: ColorSpace::Linear, pixels };
    let turn = Mat3::from_quat(Quat::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.1));
    let (environment, _) = constant_sky();
    let environment =
        SceneEnvironment { image: Some(0), radiance: Vec3::ONE, world_from_environment: turn, ..environment };
    (environment, vec![Arc::new(image)])
}

/// A gradient with a small sun, black in one corner.
fn sunny(width: u32, height: u32) -> (SceneEnvironment, Vec<Arc<Image>>) {
    image_sky(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        let sun = (u - 0.7).abs() < 0.04 && (v - 0.3).abs() < 0.04;
        let dark = u < 0.2 && v > 0.5;
        if dark {
            Vec3::ZERO
        } else {
            Vec3::new(0.1 + v, 0.2 + u, 0.5) + Vec3::splat(if sun { 300.0 } else { 0.0 })
        }
    })
}

/// Independent uniform numbers: each draw has a scramble of its own.
fn numbers(seed: u64, index: u32) -> [f32; 4] {
    Sampler::new(seed, index, 0, 0).next_4d()
}

/// Mean and standard error of red irradiance on a surface.
fn irradiance(lights: &LightSet, point: Vec3, normal: Vec3, given: Vec3, count: u32) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..count {
        let [a, b, c, _] = numbers(7, index);
        if let Some(light) = lights.sample(point, given, a, [b, c]) {
            let value = f64::from(light.radiance.x * light.direction.dot(normal).max(0.0) / light.pdf);
            sum += value;
            squares += value * value;
        }
    }
    let n = f64::from(count);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

/// Checks the irradiance, both with the normal told to the selection and not.
fn assert_irradiance(name: &str, lights: &LightSet, point: Vec3, normal: Vec3, expected: f64) {
    for given in [normal, Vec3::ZERO] {
        let (mean, error) = irradiance(lights, point, normal, given, 20_000);
        let allowed = 4.0 * error + 2e-5 * expected;
        assert!((mean - expected).abs() <= allowed, "{name}: {mean} ± {error}, expected {expected}");
        assert!(error <= 0.03 * expected, "{name}: too noisy to tell, {mean} ± {error}");
    }
}

/// Irradiance of a polygon of radiance 1 above the horizon [Lambert 1760]: ½ Σ angle × (edge normal · n).
fn polygon(point: Vec3, normal: Vec3, corners: &[DVec3]) -> f64 {
    let at = |i: usize| (corners[i % corners.len()] - point.as_dvec3()).normalize();
    let edge = |i: usize| {
        // By sine and cosine: the arc cosine of small angles has no digits.
        let cross = at(i).cross(at(i + 1));
        let angle = cross.length().atan2(at(i).dot(at(i + 1)));
        angle * cross.normalize().dot(normal.as_dvec3())
    };
    0.5 * (0..corners.len()).map(edge).sum::<f64>().abs()
}

fn corners(center: Vec3, x: Vec3, y: Vec3) -> [DVec3; 4] {
    let (center, x, y) = (center.as_dvec3(), x.as_dvec3() / 2.0, y.as_dvec3() / 2.0);
    [center - x - y, center + x - y, center + x + y, center - x + y]
}

#[test]
fn sphere_irradiance_is_pi_l_sin2_cos() {
    for (center, radius) in [
        (Vec3::Z * 2.0, 1.0),
        (Vec3::new(1.5, -0.5, 2.0), 0.9),
        (Vec3::Z * 1.001, 1.0),
        (Vec3::new(3e3, 0.0, 4e3), 1e-3),
    ] {
        let d2 = center.as_dvec3().length_squared();
        let r2 = f64::from(radius) * f64::from(radius);
        let expected = 3.0 * std::f64::consts::PI * r2 / d2 * f64::from(center.z) / d2.sqrt();
        let name = format!("sphere {center} {radius}");
        assert_irradiance(&name, &of_light(sphere(center, radius)), Vec3::ZERO, Vec3::Z, expected);
    }
}

#[test]
fn rectangle_irradiance_is_lamberts_polygon() {
    let tilt = Quat::from_rotation_x(0.4) * Quat::from_rotation_z(0.3);
    for (center, size, turn) in [
        (Vec3::Z, [1.0, 2.0], Quat::IDENTITY),
        (Vec3::new(4.0, 3.0, 0.2), [6.0, 3.0], Quat::IDENTITY),
        (Vec3::new(0.5, 0.2, 2.0), [1.0, 2.0], tilt),
        (Vec3::Z * 0.01, [5.0, 5.0], Quat::IDENTITY),
        (Vec3::new(0.0, 2e3, 3e3), [1.0, 2.0], tilt),
    ] {
        // Facing down.
        let (x, y) = (turn * (Vec3::X * size[0]), turn * (Vec3::NEG_Y * size[1]));
        let expected = 3.0 * polygon(Vec3::ZERO, Vec3::Z, &corners(center, x, y));
        let name = format!("rectangle {center} {size:?}");
        assert_irradiance(&name, &of_light(rectangle(center, x, y)), Vec3::ZERO, Vec3::Z, expected);
        let back = of_light(rectangle(center, y, x));
        assert_eq!(irradiance(&back, Vec3::ZERO, Vec3::Z, Vec3::Z, 100).0, 0.0, "{name} from behind");
    }
}

#[test]
fn emissive_triangles_irradiance_is_lamberts_polygon() {
    let first = [Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 0.0, 1.5), Vec3::new(-1.0, 0.0, 1.0)];
    let second = [Vec3::new(2.0, 3.0, 2.0), Vec3::new(3.0, 2.0, 2.0), Vec3::new(2.0, 2.0, 2.0)];
    let away = [first[0], first[2], first[1]];
    let lights =
        light_set(Vec::new(), vec![triangle(9, first), triangle(4, second), triangle(2, away)], None);
    let expected = 3.0
        * (polygon(Vec3::ZERO, Vec3::Z, &first.map(|v| v.as_dvec3()))
            + polygon(Vec3::ZERO, Vec3::Z, &second.map(|v| v.as_dvec3())));
    assert_irradiance("triangles", &lights, Vec3::ZERO, Vec3::Z, expected);
}

#[test]
fn distant_irradiance_is_that_of_its_center() {
    let direction = Vec3::new(0.6, 0.0, 0.8);
    for angular_radius in [0.0, 0.005, 0.265, 20.0, 50.0] {
        let lights = of_light(Light::Distant { direction, angular_radius, irradiance: RADIANCE });
        assert_irradiance(&format!("{angular_radius}°"), &lights, Vec3::ZERO, Vec3::Z, 2.4);
    }
}

/// ∫ L cos cos / d² dA over an ellipse, seen from the origin, by strips of a fine grid.
fn ellipse_quadrature(center: Vec3, x: Vec3, y: Vec3, normal: Vec3) -> f64 {
    let n = 1000;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(n) * 2.0 - 1.0;
    let [center, x, y, normal] = [center, x, y, normal].map(Vec3::as_dvec3);
    let area = x.cross(y);
    let mut sum = 0.0;
    for (p, q) in (0..n).flat_map(|i| (0..n).map(move |j| (at(i), at(j)))) {
        if p * p + q * q <= 1.0 {
            let place = center + 0.5 * (p * x + q * y);
            let cosines = -place.dot(area) * place.dot(normal).max(0.0) / place.length_squared();
            sum += 3.0 * cosines.max(0.0) / place.length_squared() / f64::from(n * n);
        }
    }
    sum
}

/// Irradiance at the origin, facing +z, of a spot with a radius that shines along −z: ∫ L cos dω over the directions of the
/// sphere.
fn round_spot_quadrature(center: Vec3, radius: f64, [inner, outer]: [f64; 2]) -> f64 {
    let n = 1000;
    let to_center = center.as_dvec3();
    let axis = to_center.normalize();
    let (x, y) = axis.any_orthonormal_pair();
    let least = (1.0 - (radius / to_center.length()).powi(2)).sqrt();
    let [inner, outer] = [inner, outer].map(|degrees: f64| degrees.to_radians().cos());
    let mut sum = 0.0;
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let cos = least + (1.0 - least) * (f64::from(i) + 0.5) / f64::from(n);
        let (sin_turn, cos_turn) = (std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
        let direction = cos * axis + (1.0 - cos * cos).sqrt() * (cos_turn * x + sin_turn * y);
        let share = ((direction.z - outer) / (inner - outer)).clamp(0.0, 1.0);
        sum += share * share * (3.0 - 2.0 * share) * direction.z.max(0.0);
    }
    let solid_angle = std::f64::consts::TAU * (1.0 - least);
    3.0 / (std::f64::consts::PI * radius * radius) * solid_angle * sum / f64::from(n * n)
}

#[test]
fn ellipse_irradiance_is_that_of_quadrature() {
    for (center, x, y) in [
        (Vec3::new(0.5, 0.2, 2.0), Vec3::X * 2.0, Vec3::NEG_Y),
        (Vec3::new(1.0, 0.0, 0.2), Vec3::X * 3.0, Vec3::NEG_Y * 2.0),
        (Vec3::new(3.0, 1.0, 1.0), Vec3::new(0.0, 0.0, 1.5), Vec3::NEG_Y * 0.5),
        (Vec3::new(30.0, 10.0, 40.0), Vec3::X * 2.0, Vec3::NEG_Y),
    ] {
        let y = if x.z > 0.0 { -y } else { y };
        let lights = of_light(ellipse(center, x, y));
        let normal = Vec3::new(0.0, 0.0, 1.0);
        assert_irradiance("ellipse", &lights, Vec3::ZERO, normal, ellipse_quadrature(center, x, y, normal));
    }
    // On the axis of a disc: π L sin²
    let lights = of_light(ellipse(Vec3::Z, Vec3::X * 2.0, Vec3::NEG_Y * 2.0));
    assert_irradiance("disc", &lights, Vec3::ZERO, Vec3::Z, 3.0 * std::f64::consts::PI * 0.5);
}

/// The light of a disc from near and from afar is drawn evenly: the weights of its draws vary little.
#[test]
fn ellipse_is_drawn_nearly_uniformly_in_solid_angle() {
    for (height, most) in [(10.0, 0.01), (1.0, 0.05), (0.3, 0.15)] {
        for across in [0.0, 0.8] {
            let lights = of_light(ellipse(Vec3::new(across, 0.3, height), Vec3::X * 2.0, Vec3::NEG_Y * 2.0));
            let (mut sum, mut squares, n) = (0.0, 0.0, 20_000);
            for index in 0..n {
                let [a, b, c, _] = numbers(5, index);
                let sample = lights.sample(Vec3::ZERO, Vec3::ZERO, a, [b, c]).expect("no draw is in vain");
                let weight = 1.0 / f64::from(sample.pdf);
                sum += weight;
                squares += weight * weight;
            }
            let variance = squares * f64::from(n) / (sum * sum) - 1.0;
            assert!(variance < most, "{height} {across}: relative variance {variance}");
        }
    }
}

#[test]
fn spot_with_a_radius_is_a_sphere_that_shines_into_a_cone() {
    for (center, radius, angles) in [
        (Vec3::new(0.3, 0.1, 2.0), 0.5, [20.0, 40.0]),
        // At the edge of the cone, where part of the sphere is dark, and with a cone narrower than the sphere
        (Vec3::new(1.6, 0.0, 2.0), 0.5, [20.0, 40.0]),
        (Vec3::new(0.2, 0.0, 1.2), 1.0, [5.0, 15.0]),
    ] {
        let lights = of_light(round_spot(center, radius, angles[0] as f32, angles[1] as f32));
        let expected = round_spot_quadrature(center, radius.into(), angles);
        assert_irradiance("spot with a radius", &lights, Vec3::ZERO, Vec3::Z, expected);
    }
    // Far away it is the spot
    let far = of_light(round_spot(Vec3::Z * 100.0, 0.01, 20.0, 40.0));
    assert_irradiance("far spot", &far, Vec3::ZERO, Vec3::Z, 3.0e-4);
    // Outside the cone there is nothing
    let beside = of_light(round_spot(Vec3::new(5.0, 0.0, 1.0), 0.5, 20.0, 40.0));
    assert!((0..1000).all(|i| beside.sample(Vec3::ZERO, Vec3::Z, 0.5, [numbers(3, i)[0], 0.4]).is_none()));
}

#[test]
fn spot_irradiance_falls_smoothly_between_its_angles() {
    let spot = |inner_angle, outer_angle| {
        let direction = Vec3::NEG_Z;
        let position = Vec3::Z * 2.0;
        of_light(Light::Spot {
            position,
            direction,
            radius: 0.0,
            intensity: RADIANCE,
            inner_angle,
            outer_angle,
            visible: true,
        })
    };
    let lights = spot(20.0, 60.0);
    let at = |degrees: f32| Vec3::X * (2.0 * degrees.to_radians().tan());
    let full = |degrees: f32| 0.75 * f64::from(degrees.to_radians().cos()).powi(3);
    // Half the light where the cosine is the mean of the two.
    let half = ((20.0_f32.to_radians().cos() + 0.5) / 2.0).acos().to_degrees();
    assert_irradiance("axis", &lights, Vec3::ZERO, Vec3::Z, 0.75);
    assert_irradiance("inner", &lights, at(19.9), Vec3::Z, full(19.9));
    assert_irradiance("half", &lights, at(half), Vec3::Z, 0.5 * full(half));
    assert!(lights.sample(at(60.1), Vec3::Z, 0.5, [0.5; 2]).is_none());
    let point = spot(0.0, 180.0);
    assert_irradiance("point light", &point, at(70.0), Vec3::Z, full(70.0));
    assert_irradiance("point light behind", &point, Vec3::Z * 4.0, Vec3::NEG_Z, 0.75);
}

#[test]
fn beam_lights_its_cylinder_in_front_of_the_disc() {
    let direction = Vec3::new(0.6, 0.0, -0.8);
    let lights = of_light(Light::Beam { origin: -direction, direction, radius: 0.5, power: RADIANCE });
    let expected = 3.0 / (std::f64::consts::PI * 0.25) * 0.8;
    assert_irradiance("beam", &lights, Vec3::Y * 0.49, Vec3::Z, expected);
    assert!((lights.sample(Vec3::ZERO, Vec3::Z, 0.0, [0.0; 2]).unwrap().distance - 1.0).abs() < 1e-6);
    for point in [Vec3::Y * 0.51, direction * -1.5] {
        assert!(lights.sample(point, Vec3::Z, 0.5, [0.5; 2]).is_none(), "{point}");
    }
}

#[test]
fn constant_environment_irradiance_is_pi_l() {
    let lights = light_set(Vec::new(), Vec::new(), Some(constant_sky()));
    let normal = Vec3::new(0.48, 0.6, 0.64);
    assert_irradiance("environment", &lights, Vec3::ONE, normal, 3.0 * f64::from(PI));
    let (_, error) = irradiance(&lights, Vec3::ONE, normal, normal, 1000);
    assert!(error < 1e-3, "with the normal there is no noise: {error}");
}

/// Midpoints of a grid, even in solid angle, as (direction, solid angle).
fn directions(rows: u32) -> impl Iterator<Item = (Vec3, f64)> {
    let columns = 2 * rows;
    let solid_angle = 4.0 * std::f64::consts::PI / f64::from(rows * columns);
    (0..rows * columns).map(move |i| (grid_direction(i % columns, i / columns, columns, rows), solid_angle))
}

fn grid_direction(column: u32, row: u32, columns: u32, rows: u32) -> Vec3 {
    let cos = 1.0 - 2.0 * (f64::from(row) + 0.5) / f64::from(rows);
    let (sin_phi, cos_phi) =
        (std::f64::consts::TAU * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
    let sin = (1.0 - cos * cos).sqrt();
    DVec3::new(sin * cos_phi, sin * sin_phi, cos).as_vec3()
}

/// One light of each kind, none in another's way as seen from the origin.
fn each_kind() -> Vec<Light> {
    vec![
        rectangle(Vec3::new(0.0, 0.0, 2.0), Vec3::X, Vec3::NEG_Y),
        rectangle(Vec3::new(0.0, 300.0, 400.0), Vec3::X, Vec3::NEG_Y),
        sphere(Vec3::new(3.0, 0.0, 2.0), 1.0),
        sphere(Vec3::new(-30.0, 1.0, 2.0), 0.1),
        Light::Distant { direction: Vec3::new(0.6, 0.0, 0.8), angular_radius: 5.0, irradiance: RADIANCE },
        Light::Distant { direction: Vec3::Z, angular_radius: 0.0, irradiance: RADIANCE },
        Light::Spot {
            position: Vec3::new(0.0, -1.0, 1.0),
            direction: Vec3::NEG_Z,
            radius: 0.0,
            visible: true,
            intensity: RADIANCE,
            inner_angle: 10.0,
            outer_angle: 90.0,
        },
        Light::Beam { origin: Vec3::Z, direction: Vec3::NEG_Z, radius: 0.3, power: RADIANCE },
        ellipse(Vec3::new(0.0, 4.0, 3.0), Vec3::X * 1.5, Vec3::NEG_Y * 0.75),
        ellipse(Vec3::new(0.0, -300.0, 400.0), Vec3::X, Vec3::NEG_Y),
        round_spot(Vec3::new(2.0, -3.0, 2.0), 0.5, 30.0, 80.0),
    ]
}

/// Lights of every kind, with emissive triangles and a sky.
fn all_kinds() -> (LightSet, Vec<EmissiveTriangle>) {
    let first = [Vec3::new(-2.0, 1.0, 1.0), Vec3::new(-1.0, 1.0, 1.5), Vec3::new(-2.0, 0.0, 1.0)];
    let second = [Vec3::new(-2.0, 2.0, 1.0), Vec3::new(-1.0, 2.0, 1.5), Vec3::new(-2.0, 1.0, 1.0)];
    let triangles = vec![triangle(17, first), triangle(3, second)];
    (light_set(each_kind(), triangles.clone(), Some(sunny(64, 32))), triangles)
}

/// The density that the query functions state for a sample.
fn queried(
    lights: &LightSet,
    triangles: &[EmissiveTriangle],
    at: (Vec3, Vec3),
    sample: &LightSample,
) -> Option<f32> {
    let (point, normal) = at;
    if let Some(primitive) = sample.primitive {
        let [a, b, c] = triangles.iter().find(|t| t.primitive == primitive)?.vertices;
        let hit = point + sample.direction * sample.distance;
        return Some(lights.triangle_pdf(primitive, point, normal, hit, (b - a).cross(c - a).normalize()));
    }
    if sample.distance == f32::INFINITY {
        return Some(lights.environment_pdf(point, normal, sample.direction));
    }
    let hit = lights.intersect(point, sample.direction, f32::INFINITY)?;
    ((hit.t - sample.distance).abs() < 1e-3 * hit.t).then(|| hit.pdf(lights, point, normal))
}

#[test]
fn sample_states_the_density_of_the_queries() {
    let (lights, triangles) = all_kinds();
    assert_queries(&lights, &triangles);
    assert_queries(&lights.clone().with_selection(LightSelection::Tree), &triangles);
}

/// Where the surface does not bend its way, light shines refracted as it does straight.
#[test]
fn lights_shine_through_a_refraction_as_straight() {
    for light in each_kind() {
        let lights = of_light(light);
        let n = 2000;
        let (mut straight, mut refracted) = (0.0, 0.0);
        for index in 0..n {
            let [a, b, c, _] = numbers(19, index);
            if let Some(sample) = lights.sample(Vec3::ZERO, Vec3::ZERO, a, [b, c]) {
                straight += sample.radiance.x / sample.pdf;
            }
            let Some(drawn) = lights.sample_refracted(Vec3::ZERO, a, [b, c]) else { continue };
            let Some(sample) = lights.at_refraction(&drawn, Vec3::ZERO, Vec3::ZERO) else { continue };
            let spread = match drawn.beyond {
                LightOrigin::At(_) => sample.distance * sample.distance,
                LightOrigin::Along(_) => 1.0,
            };
            refracted += sample.radiance.x / (sample.pdf * spread);
        }
        assert!((refracted / straight - 1.0).abs() < 0.02, "{light:?}: {refracted}, straight {straight}");
    }
}

fn assert_queries(lights: &LightSet, triangles: &[EmissiveTriangle]) {
    let (mut compared, mut missed) = (0, 0);
    for at in [(Vec3::ZERO, Vec3::Z), (Vec3::ZERO, Vec3::ZERO), (Vec3::new(0.1, 0.1, 0.2), Vec3::X)] {
        for index in 0..20_000 {
            let [a, b, c, _] = numbers(11, index);
            let Some(sample) = lights.sample(at.0, at.1, a, [b, c]).filter(|sample| !sample.is_delta) else {
                continue;
            };
            let Some(pdf) = queried(lights, triangles, at, &sample) else {
                missed += 1;
                continue;
            };
            assert!((pdf - sample.pdf).abs() <= 1e-3 * sample.pdf, "{pdf} from queries, {sample:?}");
            compared += 1;
        }
    }
    // Rays to the rim of a light may miss it by rounding.
    assert!(compared > 20_000 && missed * 500 < compared, "{compared} compared, {missed} missed");
}

#[test]
fn irradiance_of_all_lights_is_the_sum_over_lights() {
    let (lights, _) = all_kinds();
    assert_sum_of_all(&lights);
    assert_sum_of_all(&lights.with_selection(LightSelection::Tree));
}

fn assert_sum_of_all(lights: &LightSet) {
    let (mean, error) = irradiance(lights, Vec3::ZERO, Vec3::Z, Vec3::Z, 200_000);
    let sky = |(d, w): (Vec3, f64)| w * f64::from(lights.background_radiance(d).x * d.z.max(0.0));
    let mut expected: f64 = directions(800).map(sky).sum();
    let near = corners(Vec3::Z * 2.0, Vec3::X, Vec3::NEG_Y);
    expected += 3.0 * polygon(Vec3::ZERO, Vec3::Z, &near);
    expected += 3.0 * 0.64 / 250_000.0;
    expected += ellipse_quadrature(Vec3::new(0.0, 4.0, 3.0), Vec3::X * 1.5, Vec3::NEG_Y * 0.75, Vec3::Z);
    expected += 3.0 * 0.64 / 250_000.0 * std::f64::consts::FRAC_PI_4;
    expected += round_spot_quadrature(Vec3::new(2.0, -3.0, 2.0), 0.5, [30.0, 80.0]);
    let ball = |r2: f64, d2: f64| 3.0 * std::f64::consts::PI * r2 * 2.0 / d2.powf(1.5);
    expected += ball(1.0, 13.0) + ball(0.01, 905.0);
    expected += 2.4 + 3.0;
    let smooth = |x: f64| x * x * (3.0 - 2.0 * x);
    expected += 3.0 / 2.0 * 0.5_f64.sqrt() * smooth(0.5_f64.sqrt() / 10.0_f64.to_radians().cos());
    expected += 3.0 / (std::f64::consts::PI * 0.09);
    for triangle in all_kinds().1 {
        let [a, b, c] = triangle.vertices;
        let faces = (b - a).cross(c - a).dot(a) < 0.0;
        expected += if faces {
            3.0 * polygon(Vec3::ZERO, Vec3::Z, &triangle.vertices.map(|v| v.as_dvec3()))
        } else {
            0.0
        };
    }
    assert!((mean - expected).abs() < 4.0 * error + 3e-3 * expected, "{mean} ± {error}, {expected}");
    assert!(error < 0.01 * expected, "{mean} ± {error}");
}

#[test]
fn many_lights_shed_the_sum_of_their_light() {
    let center = |i: u32| Vec3::new(i as f32 - 25.0, (i * 7 % 50) as f32 - 25.0, 10.0 + (i % 5) as f32);
    let lights = light_set((0..50).map(|i| sphere(center(i), 0.5)).collect(), Vec::new(), None);
    let one = |c: Vec3| 3.0 * std::f64::consts::PI * 0.25 * f64::from(c.z) / f64::from(c.length()).powi(3);
    let expected: f64 = (0..50).map(|i| one(center(i))).sum();
    assert_irradiance("fifty spheres", &lights, Vec3::ZERO, Vec3::Z, expected);
}

/// Compares how many samples fall in each of 12 × 24 bins of direction with the integral of the density.
///
/// The sum of squared deviations counts as right up to 4.5 of its standard deviations above its mean
/// (false-alarm rate below 1e-4).
fn assert_histogram(name: &str, lights: &LightSet, normal: Vec3, pdf: impl Fn(Vec3) -> f32) {
    let (rows, columns, count, sub) = (12_u32, 24_u32, 40_000_u32, 40_u32);
    let mut counts = vec![0.0_f64; (rows * columns) as usize];
    for index in 0..count {
        let [a, b, c, _] = numbers(13, index);
        let Some(sample) = lights.sample(Vec3::ZERO, normal, a, [b, c]) else { continue };
        let d = sample.direction.as_dvec3();
        let row = ((0.5 - 0.5 * d.z) * f64::from(rows)).min(f64::from(rows - 1)) as u32;
        let turn = d.y.atan2(d.x).rem_euclid(std::f64::consts::TAU) / std::f64::consts::TAU;
        let column = (turn * f64::from(columns)).min(f64::from(columns - 1)) as u32;
        counts[(row * columns + column) as usize] += 1.0;
    }
    let (mut chi2, mut bins, mut total) = (0.0, 0.0, 0.0);
    let solid_angle = 4.0 * std::f64::consts::PI / f64::from(rows * columns * sub * sub);
    for bin in 0..rows * columns {
        let (row, column) = (bin / columns * sub, bin % columns * sub);
        let at = |i: u32| grid_direction(column + i % sub, row + i / sub, columns * sub, rows * sub);
        let share = solid_angle * (0..sub * sub).map(|i| f64::from(pdf(at(i)))).sum::<f64>();
        total += share;
        let expected = share * f64::from(count);
        let found = counts[bin as usize];
        if expected > 10.0 {
            chi2 += (found - expected).powi(2) / expected;
            bins += 1.0;
        } else {
            assert!(found <= 40.0, "{name}: {found} in a bin of {expected}");
        }
    }
    assert!((total - 1.0).abs() < 5e-3, "{name}: density integrates to {total}");
    assert!(chi2 < bins + 4.5 * (2.0_f64 * bins).sqrt(), "{name}: chi² {chi2} of {bins} bins");
}

/// The integral of the density of a light over the directions in which it is met.
fn uniform_share(lights: &LightSet) -> f64 {
    let density = |(d, w): (Vec3, f64)| {
        let hit = lights.intersect(Vec3::ZERO, d, f32::INFINITY);
        w * hit.map_or(0.0, |hit| f64::from(hit.pdf(lights, Vec3::ZERO, Vec3::Z)))
    };
    directions(800).map(density).sum()
}

#[test]
fn samples_follow_the_density() {
    let met = |lights: &LightSet, normal: Vec3, d: Vec3| {
        lights.intersect(Vec3::ZERO, d, f32::INFINITY).map_or(0.0, |hit| hit.pdf(lights, Vec3::ZERO, normal))
    };
    let window = of_light(rectangle(Vec3::new(2.0, 1.0, 1.0), Vec3::X * 6.0, Vec3::NEG_Y * 5.0));
    assert_histogram("rectangle", &window, Vec3::Z, |d| met(&window, Vec3::Z, d));
    for (name, center) in [("ellipse", Vec3::new(2.0, 1.0, 1.0)), ("near ellipse", Vec3::new(2.9, 0.5, 0.05))]
    {
        let disc = of_light(ellipse(center, Vec3::X * 6.0, Vec3::NEG_Y * 5.0));
        assert_histogram(name, &disc, Vec3::Z, |d| met(&disc, Vec3::Z, d));
    }
    for (name, outer) in [("spot", 70.0), ("narrow spot", 50.0)] {
        let spot = of_light(round_spot(Vec3::new(0.5, 0.25, 1.7), 1.4, 20.0, outer));
        // Some directions in a cone narrower than the sphere miss it; four standard deviations are 0.01
        let drawn = (0..40_000).filter(|&i| {
            let [a, b, c, _] = numbers(17, i);
            spot.sample(Vec3::ZERO, Vec3::Z, a, [b, c]).is_some()
        });
        let (total, drawn) = (uniform_share(&spot), drawn.count() as f64 / 40_000.0);
        assert!((total - drawn).abs() < 0.01, "{name}: {total} {drawn}");
    }
    let ball = of_light(sphere(Vec3::new(1.0, 0.5, 1.0), 1.4));
    assert_histogram("sphere", &ball, Vec3::Z, |d| met(&ball, Vec3::Z, d));
    let skies = [("map", sunny(64, 32)), ("large map", sunny(2050, 1030)), ("constant", constant_sky())];
    for (name, sky) in skies {
        let lights = light_set(Vec::new(), Vec::new(), Some(sky));
        for normal in [Vec3::ZERO, Vec3::Z] {
            assert_histogram(name, &lights, normal, |d| lights.environment_pdf(Vec3::ZERO, normal, d));
        }
    }
}

#[test]
fn triangle_density_integrates_to_one_over_the_triangle() {
    let vertices = [Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 0.0, 1.5), Vec3::new(-1.0, 0.0, 1.0)];
    let lights = light_set(Vec::new(), vec![triangle(5, vertices)], None);
    let cross = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
    let normal = cross.normalize();
    // ∫ pdf dω = ∫ pdf cos/d² dA over a grid of points of the triangle.
    let n = 200;
    let mut sum = 0.0;
    for i in 0..n * n {
        let (mut s, mut t) = ((i % n) as f32 + 0.5, (i / n) as f32 + 0.5);
        if s + t > n as f32 {
            (s, t) = (n as f32 - s, n as f32 - t);
        }
        let (s, t) = (s / n as f32, t / n as f32);
        let hit = vertices[0] * (1.0 - s - t) + vertices[1] * s + vertices[2] * t;
        let cos = -hit.normalize().dot(normal);
        let pdf = lights.triangle_pdf(5, Vec3::ZERO, Vec3::Z, hit, normal);
        sum += f64::from(pdf * cos / hit.length_squared() * 0.5 * cross.length()) / f64::from(n * n);
    }
    assert!((sum - 1.0).abs() < 1e-4, "{sum}");
    assert_eq!(lights.triangle_pdf(6, Vec3::ZERO, Vec3::Z, vertices[0], normal), 0.0);
    assert_eq!(lights.triangle_pdf(5, Vec3::ZERO, Vec3::Z, vertices[0], -normal), 0.0);
}

/// Lights of every kind at scales from 1e-30 to 1e30, and black ones.
fn extreme_lights() -> Vec<Light> {
    let mut lights = Vec::new();
    for scale in [0.0, 1e-30, 1e-10, 1.0, 1e10, 1e30] {
        for radiance in [Vec3::ZERO, Vec3::splat(1e-30), Vec3::X, Vec3::splat(1e30)] {
            let (center, edge_x, edge_y) = (Vec3::Z * scale, Vec3::X * scale, Vec3::NEG_Y * scale);
            lights.push(Light::Rectangle { center, edge_x, edge_y, radiance, visible: true });
            lights.push(Light::Rectangle { center: Vec3::Z, edge_x, edge_y, radiance, visible: true });
            lights.push(Light::Sphere { center, radius: scale, radiance, visible: true });
            lights.push(Light::Sphere { center: Vec3::Z, radius: scale, radiance, visible: true });
            lights.push(Light::Beam {
                origin: center,
                direction: Vec3::NEG_Z,
                radius: scale,
                power: radiance,
            });
            let angle = scale.min(89.0);
            let (intensity, irradiance) = (radiance, radiance);
            lights.push(Light::Distant { direction: Vec3::Z, angular_radius: angle, irradiance });
            let (position, direction) = (center, Vec3::NEG_Z);
            let (inner_angle, outer_angle) = (angle, angle + 1.0);
            lights.push(Light::Ellipse { center, edge_x, edge_y, radiance, visible: true });
            lights.push(Light::Ellipse { center: Vec3::Z, edge_x, edge_y, radiance, visible: true });
            for radius in [0.0, scale] {
                let visible = true;
                lights.push(Light::Spot {
                    position,
                    direction,
                    radius,
                    intensity,
                    inner_angle,
                    outer_angle,
                    visible,
                });
            }
        }
    }
    lights
}

fn assert_sane(lights: &LightSet, what: &str) {
    for point in [Vec3::ZERO, Vec3::Z, Vec3::Z * 1e-30, Vec3::splat(1e20), Vec3::new(0.5, 0.0, 1.0)] {
        for normal in [Vec3::ZERO, Vec3::Z, Vec3::NEG_Z, Vec3::X] {
            for index in 0..16 {
                let [a, b, c, d] = numbers(17, index);
                let direction = translucid_law::uniform_sphere([c, d]);
                let environment = lights.environment_pdf(point, normal, direction);
                assert!(environment.is_finite() && environment >= 0.0, "{what} at {point}: {environment}");
                for (u, v) in [(a, [b, c]), (0.0, [0.0; 2]), (0.999_999_94, [0.999_999_94; 2])] {
                    let Some(sample) = lights.sample(point, normal, u, v) else { continue };
                    assert!(sample.is_usable(), "{what} at {point}, {normal}: {sample:?}");
                    assert!(sample.direction.is_normalized(), "{what} at {point}, {normal}: {sample:?}");
                    let Some(hit) = lights.intersect(point, sample.direction, f32::INFINITY) else {
                        continue;
                    };
                    let pdf = hit.pdf(lights, point, normal);
                    assert!(
                        pdf.is_finite() && pdf >= 0.0 && hit.t >= 0.0,
                        "{what} at {point}: {hit:?} {pdf}"
                    );
                }
            }
        }
    }
}

#[test]
fn lights_stay_finite_at_any_scale_and_from_any_point() {
    for light in extreme_lights() {
        assert_sane(&of_light(light), &format!("{light:?}"));
    }
    assert_sane(&light_set(extreme_lights(), Vec::new(), Some(sunny(5, 3))), "all extremes");
    let a_few = extreme_lights().into_iter().step_by(7).collect();
    assert_sane(&light_set(a_few, Vec::new(), Some(constant_sky())), "some extremes");
}

#[test]
fn emissive_triangles_stay_finite_at_any_scale() {
    for scale in [0.0, 1e-20, 1e-6, 1.0, 1e6, 1e18, f32::MAX, f32::NAN] {
        for shift in [Vec3::ZERO, Vec3::Z] {
            let vertices = [Vec3::ZERO, Vec3::NEG_Y * scale, Vec3::X * scale].map(|v| v + shift);
            let lights = light_set(Vec::new(), vec![triangle(0, vertices)], None);
            assert_sane(&lights, &format!("triangle of {scale} at {shift}"));
        }
    }
}

#[test]
fn a_set_without_light_is_empty() {
    let black = Light::Sphere { center: Vec3::ZERO, radius: 1.0, radiance: Vec3::ZERO, visible: true };
    let lights = of_light(black);
    assert!(lights.is_empty());
    assert!(lights.sample(Vec3::Z, Vec3::Z, 0.5, [0.5; 2]).is_none());
    assert_eq!(lights.environment_radiance(Vec3::X), Vec3::ZERO);
    assert_eq!(lights.environment_pdf(Vec3::ZERO, Vec3::Z, Vec3::X), 0.0);
    assert!(!lights.environment_visible());
}

#[test]
fn intersect_finds_the_nearest_emitting_side() {
    let lights = vec![
        rectangle(Vec3::Z * 5.0, Vec3::X, Vec3::NEG_Y),
        rectangle(Vec3::Z * 2.0, Vec3::X, Vec3::Y), // Seen from behind.
        sphere(Vec3::Z * 4.0, 0.5),
    ];
    let lights = light_set(lights, Vec::new(), None);
    let t = |origin, t_max| lights.intersect(origin, Vec3::Z, t_max).map(|hit| hit.t);
    assert_eq!(t(Vec3::ZERO, f32::INFINITY), Some(3.5));
    assert_eq!(t(Vec3::ZERO, 3.5), None);
    // From inside the sphere the rectangle behind it is next.
    assert_eq!(t(Vec3::Z * 4.0, f32::INFINITY), Some(1.0));
    assert_eq!(t(Vec3::Z * 5.5, f32::INFINITY), None);
}
