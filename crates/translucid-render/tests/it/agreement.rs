//! Light samples and paths have to agree on what light meets on its way: emitters that are clear or partly
//! opaque, absorbing media, lights that the camera does not see, scenes far from the origin.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in
//! 2,700 comparisons).

use std::f32::consts::{FRAC_1_PI, FRAC_PI_2};
use std::sync::Arc;

use glam::{Vec3, Vec4};
use translucid_scene::{ColorInput, Light, Material, Mesh, ScalarInput, Scene};

use crate::common::{GRAY, assert_within, distant, matte, measure, prepare, quad, sample_ray, scene};

/// Clear, without a step of the index.
fn straight() -> Material {
    Material {
        transmission_weight: ScalarInput::constant(1.0),
        specular_roughness: ScalarInput::constant(0.0),
        specular_ior: 1.0,
        ..Material::default()
    }
}

/// A matte gray floor in the plane z = 0 with something of another material over it.
fn floor_and(mesh: Mesh, material: Material) -> Scene {
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 10.0, Vec3::Y * 10.0), mesh], matte(GRAY));
    scene.materials.push(material);
    scene.objects[1].material = 1;
    scene
}

/// Radiance of a floor under the middle of a square lamp of edge 2 and radiance 1 at height ½ (the form
/// factor of emitting_mesh_lights_like_a_rectangle with b = 2): light samples and paths share the work.
fn near_lamp() -> Vec3 {
    let root = 2.0 / 5.0_f32.sqrt();
    GRAY * (2.0 * root * root.atan() / FRAC_PI_2)
}

fn lamp() -> Mesh {
    quad(Vec3::Z * 0.5, Vec3::Y, Vec3::X)
}

/// Looks at the floor's middle from below the lamp.
fn look(scene: Scene) -> (Vec3, Vec3) {
    let origin = Vec3::new(0.0, 0.3, 0.3);
    measure(&prepare(scene), origin, -origin.normalize(), 1 << 15)
}

#[test]
fn emitter_sheds_its_light_whatever_it_is_made_of() {
    for (name, material) in [("black", matte(Vec3::ZERO)), ("clear", straight())] {
        for opacity in [1.0, 0.4] {
            let material = Material {
                emission_luminance: 1.0,
                geometry_opacity: ScalarInput::constant(opacity),
                ..material.clone()
            };
            let result = look(floor_and(lamp(), material));
            assert_within(&format!("{name}, opacity {opacity}"), result, near_lamp() * opacity);
        }
    }
}

/// Shadow rays start off a large floor by its rounding error; the lamp must not shadow itself for that.
#[test]
fn lamp_close_to_a_large_floor_is_not_its_own_obstacle() {
    let emitter = Material { emission_luminance: 1.0, ..matte(Vec3::ZERO) };
    let mut by_mesh = floor_and(lamp(), emitter);
    by_mesh.objects[0].mesh = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3).into();
    let mut by_rectangle = scene(vec![Mesh::clone(&by_mesh.objects[0].mesh)], matte(GRAY));
    by_rectangle.lights.push(Light::Rectangle {
        center: Vec3::Z * 0.5,
        edge_x: Vec3::Y * 2.0,
        edge_y: Vec3::X * 2.0,
        radiance: Vec3::ONE,
        visible: true,
    });
    for (name, scene) in [("mesh", by_mesh), ("rectangle", by_rectangle)] {
        let (mean, _) = look(scene);
        // Paths start 2e-3 off the floor.
        assert!((mean.x / near_lamp().x - 1.0).abs() < 3e-3, "{name}: {mean}, expected {}", near_lamp());
    }
}

/// Lights inside an absorbing body: the light has the way from the light to the body's surface to go.
#[test]
fn light_inside_a_clear_body_is_absorbed() {
    let color = Vec3::new(0.8, 0.5, 0.1);
    // The body is above its lower face at z = ¼; there is no upper one.
    let face = quad(Vec3::Z * 0.25, Vec3::Y * 100.0, Vec3::X * 100.0);
    let medium =
        Material { transmission_color: ColorInput::constant(color), transmission_depth: 1.0, ..straight() };
    let mut by_spot = floor_and(face.clone(), medium.clone());
    by_spot.lights.push(Light::Spot {
        radius: 0.0,
        visible: true,
        position: Vec3::Z * 2.25,
        direction: Vec3::NEG_Z,
        intensity: Vec3::ONE,
        inner_angle: 10.0,
        outer_angle: 20.0,
    });
    let (mean, _) = measure(&prepare(by_spot), Vec3::Z * 0.2, Vec3::NEG_Z, 256);
    let expected = GRAY * FRAC_1_PI / (2.25 * 2.25) * color * color;
    assert!(((mean - expected) / expected).abs().max_element() < 2e-3, "{mean}, expected {expected}");

    let with_lamp = |height: f32| {
        let mut scene = floor_and(face.clone(), medium.clone());
        scene.lights.push(Light::Rectangle {
            center: Vec3::Z * height,
            edge_x: Vec3::Y * 200.0,
            edge_y: Vec3::X * 200.0,
            radiance: Vec3::ONE,
            visible: true,
        });
        look_at_floor(scene)
    };
    // Under a ceiling that is a slab of thickness τ away: albedo · 2 ∫ exp(−τ/μ) μ dμ = albedo · 2 E₃(τ).
    let thickness = 0.5;
    let tau = color.to_array().map(|c| -f64::from(c.ln()) * thickness);
    let expected = Vec3::from_array(tau.map(|t| (0.5 * twice_e3(t)) as f32));
    let (mean, _) = with_lamp(0.25 + thickness as f32);
    // Rays start a rounding error of the face's size off it: 2e-4, times the absorption coefficient.
    assert!(((mean - expected) / expected).abs().max_element() < 1e-3, "lamp: {mean}, expected {expected}");
}

fn look_at_floor(scene: Scene) -> (Vec3, Vec3) {
    measure(&prepare(scene), Vec3::Z * 0.2, Vec3::NEG_Z, 1 << 15)
}

/// 2 E₃(τ) = 2 ∫₀¹ exp(−τ/μ) μ dμ by midpoints.
fn twice_e3(tau: f64) -> f64 {
    let n = 100_000;
    (0..n).map(|i| (f64::from(i) + 0.5) / f64::from(n)).map(|mu| 2.0 * mu * (-tau / mu).exp()).sum::<f64>()
        / f64::from(n)
}

/// Directions keep their digits wherever the scene may be.
#[test]
fn distant_light_shines_far_from_the_origin() {
    for far in [1e5, 1e7, 9e8] {
        let center = Vec3::new(far, -far, far);
        let mut scene = scene(vec![quad(center, Vec3::X * far * 0.1, Vec3::Y * far * 0.1)], matte(GRAY));
        scene.lights.push(distant(Vec3::new(0.6, 0.0, 0.8)));
        let (mean, _) = measure(&prepare(scene), center + Vec3::Z * far * 0.01, Vec3::NEG_Z, 64);
        let expected = 0.5 * 0.8 * FRAC_1_PI;
        assert!((mean.x / expected - 1.0).abs() < 1e-4, "{far}: {mean}, expected {expected}");
    }
}

#[test]
fn camera_looks_through_invisible_lights_to_visible_ones() {
    let out_of_sight = quad(Vec3::X * 50.0, Vec3::X, Vec3::Y);
    let mut scene = scene(vec![out_of_sight], matte(GRAY));
    for (height, visible) in [(1.0, false), (0.0, true)] {
        scene.lights.push(Light::Rectangle {
            center: Vec3::Z * height,
            edge_x: Vec3::X,
            edge_y: Vec3::Y,
            radiance: Vec3::splat(height + 2.0),
            visible,
        });
    }
    let sample = sample_ray(&prepare(scene), Vec3::Z * 3.0, Vec3::NEG_Z, 0, 0);
    assert_eq!((sample.emission, sample.alpha), (Vec3::splat(2.0), 1.0));
}

/// Depth is the distance from the camera, also through a surface that is not there.
#[test]
fn depth_counts_from_the_camera() {
    let veil = Material { geometry_opacity: ScalarInput::constant(0.0), ..matte(GRAY) };
    let scene = floor_and(quad(Vec3::Z, Vec3::X, Vec3::Y), veil);
    let sample = sample_ray(&prepare(scene), Vec3::Z * 3.0, Vec3::NEG_Z, 0, 0);
    assert!((sample.depth - 3.0).abs() < 1e-5, "{}", sample.depth);
}

#[test]
fn fingerprint_sees_tangents() {
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X, Vec3::Y)], matte(GRAY));
    let fingerprint = |scene| {
        let prepared = prepare(scene);
        prepared.fingerprint(&prepared.view().expect("a valid view"))
    };
    let before = fingerprint(scene.clone());
    Arc::make_mut(&mut scene.objects[0].mesh).tangents = vec![Vec4::new(1.0, 0.0, 0.0, 1.0); 4];
    assert_ne!(fingerprint(scene), before);
}
