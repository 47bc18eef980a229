//! Thin-walled surfaces against closed forms: leaves lit from both sides, panes before the camera and before lights.

use std::f32::consts::PI;

use glam::Vec3;
use translucid_scene::{ColorInput, Integrator, Light, Material, Object, ScalarInput, Scene};

use crate::common::{
    GRAY, assert_within, distant, matte, measure, on_threads, picture, prepare, quad, samples, scene,
    uniform_environment,
};

const ALBEDO: Vec3 = Vec3::new(0.8, 0.5, 0.3);

/// A sheet that scatters light without an interface.
fn leaf(g: f32) -> Material {
    Material {
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_scatter_anisotropy: g,
        geometry_thin_walled: true,
        ..Material::default()
    }
}

/// A sheet of clear glass.
fn pane(color: Vec3, roughness: f32) -> Material {
    Material {
        specular_roughness: ScalarInput::constant(roughness),
        transmission_weight: ScalarInput::constant(1.0),
        transmission_color: ColorInput::constant(color),
        geometry_thin_walled: true,
        ..Material::default()
    }
}

/// A wide sheet at z = 0.
fn sheet(material: Material) -> Scene {
    scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material)
}

/// Reflectance F of a face of index 1.5 at a cosine, and the cosine inside.
fn fresnel(cos: f32) -> (f32, f32) {
    let inside = (1.0 - (1.0 - cos * cos) / 2.25).sqrt();
    let s = (cos - 1.5 * inside) / (cos + 1.5 * inside);
    let p = (inside - 1.5 * cos) / (inside + 1.5 * cos);
    (0.5 * (s * s + p * p), inside)
}

/// Transmittance and reflectance of a pane.
fn slab(cos: f32, color: Vec3) -> (Vec3, Vec3) {
    let (f, inside) = fresnel(cos);
    let c = color.powf(1.0 / inside);
    let passed = c * (1.0 - f).powi(2) / (1.0 - c * c * f * f);
    (passed, f + c * f * passed)
}

#[test]
fn white_sheet_disappears_in_white_light() {
    let white = |material: Material| Material {
        subsurface_color: ColorInput::constant(Vec3::ONE),
        base_color: ColorInput::constant(Vec3::ONE),
        ..material
    };
    let with_interface = Material {
        specular_weight: ScalarInput::constant(1.0),
        coat_weight: ScalarInput::constant(0.5),
        ..leaf(0.3)
    };
    let half = ScalarInput::constant(0.5);
    let mixed = Material { transmission_weight: half, subsurface_weight: half, ..pane(Vec3::ONE, 0.4) };
    for material in [leaf(0.0), with_interface, pane(Vec3::ONE, 0.0), pane(Vec3::ONE, 0.5), mixed] {
        let mut scene = sheet(white(material.clone()));
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        for direction in [Vec3::NEG_Z, Vec3::Z, Vec3::new(0.8, 0.0, -0.6)] {
            let (mean, error) = measure(&renderer, -direction, direction, samples(1 << 16));
            // The tables of rough interfaces are good to 0.5 %.
            assert!(
                ((mean - 1.0).abs() - 4.0 * error).max_element() < 5e-3,
                "{material:?} {direction}: {mean} ± {error}"
            );
        }
    }
}

#[test]
fn leaf_passes_its_share_of_light_from_behind() {
    for g in [0.0, 0.7, -0.4] {
        for (weight, toward) in [(1.0, Vec3::Z), (0.5, Vec3::new(0.0, 0.6, 0.8))] {
            let material = Material { subsurface_weight: ScalarInput::constant(weight), ..leaf(g) };
            let mut scene = sheet(Material { base_color: ColorInput::constant(GRAY), ..material });
            scene.lights.push(distant(toward));
            let renderer = prepare(scene);
            let light = toward.z / PI;
            let scattered = ALBEDO * (0.5 * weight);
            let in_front = GRAY * (1.0 - weight) + scattered * (1.0 - g);
            for direction in [Vec3::NEG_Z, Vec3::new(0.6, 0.0, -0.8)] {
                let front = measure(&renderer, -direction, direction, 1 << 8);
                assert_within("in front", front, in_front * light);
                let behind = measure(&renderer, direction, -direction, 1 << 8);
                assert_within("behind", behind, scattered * ((1.0 + g) * light));
            }
        }
    }
}

/// Light samples and paths share the light of a sphere and of the sky.
#[test]
fn leaf_passes_light_of_spheres_and_of_the_sky() {
    let mut scene = sheet(leaf(0.2));
    scene.environment = uniform_environment(Vec3::splat(0.1));
    scene.lights.push(Light::Sphere {
        center: Vec3::NEG_Z * 2.0,
        radius: 1.5,
        radiance: Vec3::ONE,
        visible: true,
    });
    let result = measure(&prepare(scene), Vec3::Z, Vec3::NEG_Z, samples(1 << 18));
    // Irradiance of a sphere: π L (r / d)²; it hides as much of the sky
    let expected = ALBEDO * (0.4 * 0.1 + 0.6 * (0.1 + 0.9 * 0.5625));
    assert_within("leaf before a sphere", result, expected);
}

#[test]
fn pane_reflects_and_passes_as_a_slab() {
    let color = Vec3::new(0.9, 0.6, 0.2);
    for roughness in [0.0, 0.3] {
        for cos in [1.0_f32, 0.5] {
            let direction = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos);
            let mut scene = sheet(pane(color, roughness));
            // All light from below, or none
            let floor = quad(Vec3::NEG_Z, Vec3::X * 1e4, Vec3::Y * 1e4);
            scene.objects.push(Object {
                name: "floor".into(),
                mesh: floor.into(),
                material: 1,
                ..Object::default()
            });
            scene.materials.push(Material { emission_luminance: 1.0, ..matte(Vec3::ZERO) });
            let (passed, reflected) = slab(cos, color);
            let result = measure(&prepare(scene.clone()), -direction, direction, samples(1 << 16));
            let (mean, error) = result;
            let off = (mean - passed).abs() - 4.0 * error;
            assert!(off.max_element() < 5e-3, "passed {roughness} {cos}: {mean} ± {error}, {passed}");
            scene.materials[1] = matte(Vec3::ZERO);
            scene.environment = uniform_environment(Vec3::ONE);
            let (mean, error) = measure(&prepare(scene), -direction, direction, samples(1 << 16));
            let off = (mean - reflected).abs() - 4.0 * error;
            assert!(off.max_element() < 5e-3, "reflected {roughness} {cos}: {mean} ± {error}, {reflected}");
        }
    }
}

/// A floor below a pane at the depth `max_depth`, seen from between them.
fn below_pane(pane: Material, caustics: bool) -> Scene {
    let mut scene = sheet(pane);
    let floor = quad(Vec3::NEG_Z, Vec3::X * 1e3, Vec3::Y * 1e3);
    scene.objects.push(Object { name: "floor".into(), mesh: floor.into(), material: 1, ..Object::default() });
    scene.materials.push(matte(GRAY));
    scene.integrator = Integrator { caustics, ..scene.integrator };
    scene
}

#[test]
fn light_reaches_a_floor_through_a_pane() {
    let color = Vec3::new(0.9, 0.6, 0.2);
    for caustics in [true, false] {
        for cos in [1.0_f32, 0.6] {
            let mut scene = below_pane(pane(color, 0.0), caustics);
            scene.lights.push(distant(Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos)));
            let expected = GRAY * slab(cos, color).0 * (cos / PI);
            let result = measure(&prepare(scene), Vec3::NEG_Z * 0.5, Vec3::NEG_Z, 1 << 8);
            assert_within(&format!("caustics {caustics}, cos {cos}"), result, expected);
        }
    }
}

/// Light samples and paths pass the same pane: together they find the light once.
#[test]
fn spheres_and_the_sky_reach_a_floor_through_a_pane_once() {
    for caustics in [true, false] {
        let mut scene = below_pane(pane(Vec3::ONE, 0.0), caustics);
        scene.environment = uniform_environment(Vec3::splat(0.1));
        scene.lights.push(Light::Sphere {
            center: Vec3::Z * 2.0,
            radius: 1.8,
            radiance: Vec3::ONE,
            visible: true,
        });
        let result = measure(&prepare(scene), Vec3::NEG_Z * 0.5, Vec3::NEG_Z, samples(1 << 18));
        // The sphere fills a cone of sin² = (1.8 / 3)² around the normal
        let light = |from: f32, to: f32| {
            let n = 10_000;
            let at = |i: u16| from + (to - from) * (f32::from(i) + 0.5) / f32::from(n);
            (0..n).map(|i| slab(at(i), Vec3::ONE).0.x * at(i)).sum::<f32>() * 2.0 * (to - from) / f32::from(n)
        };
        let expected = GRAY * (light(0.8, 1.0) + 0.1 * light(0.0, 0.8));
        assert_within(&format!("caustics {caustics}"), result, expected);
    }
}

#[test]
fn pane_keeps_the_medium_around_it() {
    let clear = Material {
        specular_ior: 1.0,
        transmission_weight: ScalarInput::constant(1.0),
        transmission_color: ColorInput::constant(GRAY),
        transmission_depth: 1.0,
        ..Material::default()
    };
    let (front, back) =
        (quad(Vec3::Z, Vec3::X * 1e3, Vec3::Y * 1e3), quad(Vec3::NEG_Z, Vec3::Y * 1e3, Vec3::X * 1e3));
    let mut scene = scene(vec![front, back], clear);
    let inner = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    scene.objects.push(Object { name: "pane".into(), mesh: inner.into(), material: 1, ..Object::default() });
    scene.materials.push(Material { specular_ior: 1.0, ..pane(Vec3::ONE, 0.0) });
    scene.integrator.max_depth = 4;
    scene.environment = uniform_environment(Vec3::ONE);
    let result = measure(&prepare(scene), Vec3::Z * 2.0, Vec3::NEG_Z, 1 << 8);
    // Rays start a little beside such wide surfaces
    assert!((result.0 - 0.25).abs().max_element() < 1e-3, "two lengths of glass: {result:?}");
}

#[test]
fn pictures_of_sheets_are_the_same_on_any_number_of_threads() {
    let mut scene = below_pane(pane(ALBEDO, 0.0), true);
    scene.materials[1] = leaf(0.3);
    scene.camera.position = Vec3::new(0.0, -1.0, 2.0);
    scene.integrator.max_depth = 5;
    scene.environment = uniform_environment(Vec3::ONE);
    let one = on_threads(1, || picture(&scene, 4));
    assert_eq!(on_threads(3, || picture(&scene, 4)), one);
}
