//! Light transport against exact answers: furnaces, clear bodies, opacity, emitters, normal maps.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in
//! 2,700 comparisons).

use std::sync::Arc;

use glam::{Vec2, Vec3};
use translucid_profile::Model;
use translucid_scene::{
    ColorInput, ColorSpace, Image, Light, Material, Mesh, NormalMap, Object, Pixels, ScalarInput,
    SubsurfaceModel, TextureRef,
};

use crate::common::{
    GRAY, assert_within, distant, matte, measure, prepare, quad, sample_ray, scene, sphere,
    uniform_environment,
};

fn clear(ior: f32) -> Material {
    Material {
        transmission_weight: ScalarInput::constant(1.0),
        specular_roughness: ScalarInput::constant(0.0),
        specular_ior: ior,
        ..Material::default()
    }
}

/// The inside of an emitting sphere of albedo ρ is as bright as the sum of all bounces, L / (1 − ρ).
#[test]
fn closed_furnace_sums_all_bounces() {
    let mut inside_out = sphere(1.0, 24);
    for corners in &mut inside_out.triangles {
        corners.swap(1, 2);
    }
    inside_out.normals.clear();
    let mut scene =
        scene(vec![inside_out], Material { emission_luminance: 1.0, ..matte(Vec3::new(0.5, 0.8, 0.0)) });
    scene.integrator.max_depth = 200;
    scene.integrator.max_diffuse_depth = 200;
    let result = measure(&prepare(scene), Vec3::new(0.1, 0.2, 0.3), Vec3::X, 1 << 15);
    assert_within("closed furnace", result, Vec3::new(2.0, 5.0, 1.0));
}

/// A clear body under uniform light is invisible, whatever its index and roughness.
#[test]
fn clear_sphere_vanishes_in_uniform_light() {
    for (ior, roughness, loss) in [(1.0, 0.0, 0.0), (1.5, 0.0, 0.0), (2.4, 0.0, 0.0), (1.5, 0.4, 0.02)] {
        let material = Material { specular_roughness: ScalarInput::constant(roughness), ..clear(ior) };
        let mut scene = scene(vec![sphere(1.0, 128)], material);
        scene.environment = uniform_environment(Vec3::ONE);
        scene.integrator.max_depth = 100;
        let renderer = prepare(scene);
        for x in [0.0, 0.4, 0.8] {
            let (mean, error) = measure(&renderer, Vec3::new(x, 0.1, 3.0), Vec3::NEG_Z, 1 << 14);
            let tolerance = 4.0 * error.x + loss + 2e-3;
            assert!(
                (mean.x - 1.0).abs() < tolerance,
                "ior {ior}, roughness {roughness}, x {x}: {mean} ± {error}"
            );
        }
    }
}

/// Both faces of clear glass mirror a lamp: 2 R / (1 + R) of its light, all orders together.
///
/// If each sample drew either the reflection or the refraction, it would have the lamp's light or none, with a relative
/// variance of 12.
#[test]
fn lamp_mirrored_by_clear_glass_has_little_noise() {
    let [top, bottom] =
        [quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3), quad(Vec3::NEG_Z, Vec3::Y * 1e3, Vec3::X * 1e3)];
    let lamp = quad(Vec3::Z * 5.0, Vec3::Y * 1e3, Vec3::X * 1e3);
    let mut scene = scene(vec![top, bottom, lamp], clear(1.5));
    scene.materials.push(Material { emission_luminance: 1.0, ..matte(Vec3::ZERO) });
    scene.objects[2].material = 1;
    scene.integrator.max_depth = 20;
    let renderer = prepare(scene);
    let of_face = 0.2_f32.powi(2);
    let expected = 2.0 * of_face / (1.0 + of_face);
    let (mean, error) = measure(&renderer, Vec3::Z, Vec3::NEG_Z, 1 << 12);
    assert_within("mirrored lamp", (mean, error), Vec3::splat(expected));
    let light = |seed| sample_ray(&renderer, Vec3::Z, Vec3::NEG_Z, seed, 0).radiance().x / expected;
    let variance = (0..1024).map(|seed| (light(seed) - 1.0).powi(2)).sum::<f32>() / 1024.0;
    assert!(variance < 0.03, "{variance}");
}

/// A flame of which the camera sees a part shows that part of its light in every sample.
#[test]
fn partly_opaque_emitter_has_no_noise() {
    let flame = Material {
        emission_luminance: 1.0,
        geometry_opacity: ScalarInput::constant(0.3),
        ..matte(Vec3::ZERO)
    };
    let renderer = prepare(scene(vec![quad(Vec3::ZERO, Vec3::X, Vec3::Y)], flame));
    for seed in 0..64 {
        let light = sample_ray(&renderer, Vec3::Z, Vec3::NEG_Z, seed, 0).radiance();
        assert!((light - 0.3).abs().max_element() < 1e-6, "{light}");
    }
}

/// Beer–Lambert: after `transmission_depth` the light has `transmission_color`; each face tints it besides.
#[test]
fn clear_slab_absorbs_by_its_depth() {
    let (color, tint) = (Vec3::new(0.8, 0.5, 0.1), Vec3::new(0.5, 0.75, 1.0));
    let material = Material {
        transmission_color: ColorInput::constant(color),
        transmission_depth: 2.0,
        transmission_tint: ColorInput::constant(tint),
        ..clear(1.0)
    };
    let top = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let bottom = quad(Vec3::NEG_Z * 3.0, Vec3::Y * 1e3, Vec3::X * 1e3);
    let mut slab = scene(vec![top.clone(), bottom.clone()], material.clone());
    slab.environment = uniform_environment(Vec3::ONE);
    slab.integrator.max_depth = 10;
    let expected = tint * tint * color.powf(1.5);
    let (mean, _) = measure(&prepare(slab), Vec3::Z, Vec3::NEG_Z, 256);
    // Rays start a rounding error off the surface: 2e-3 of a slab 3 thick between quads 2,000 wide.
    assert!(((mean - expected) / expected).abs().max_element() < 3e-3, "seen through: {mean}, {expected}");

    // Between a lamp and a floor, light passes the slab straight, with the same color.
    let mut lit = scene(vec![top, bottom, quad(Vec3::NEG_Z * 9.0, Vec3::X * 1e3, Vec3::Y * 1e3)], material);
    lit.materials.push(matte(GRAY));
    lit.objects[2].material = 1;
    lit.lights.push(distant(Vec3::Z));
    let (mean, _) = measure(&prepare(lit.clone()), Vec3::NEG_Z * 8.0, Vec3::NEG_Z, 256);
    let expected = GRAY / std::f32::consts::PI * expected;
    assert!(((mean - expected) / expected).abs().max_element() < 3e-3, "shadow: {mean}, {expected}");

    // With caustics on, a clear body casts a shadow: only paths that find the light bring it.
    lit.integrator.caustics = true;
    let (mean, _) = measure(&prepare(lit), Vec3::NEG_Z * 8.0, Vec3::NEG_Z, 256);
    assert_eq!(mean, Vec3::ZERO);
}

#[test]
fn opacity_shows_what_is_behind_in_proportion() {
    let veil = Material { geometry_opacity: ScalarInput::constant(0.3), ..matte(Vec3::ZERO) };
    let mut scene = scene(
        vec![
            quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3),
            quad(Vec3::NEG_Z * 5.0, Vec3::X * 1e3, Vec3::Y * 1e3),
        ],
        veil,
    );
    scene.materials.push(matte(GRAY));
    scene.objects[1].material = 1;
    scene.lights.push(distant(Vec3::Z));
    // The veil takes its share of the light on the way down and of the view on the way up.
    let expected = GRAY / std::f32::consts::PI * 0.7 * 0.7;
    let result = measure(&prepare(scene), Vec3::Z, Vec3::NEG_Z, 1 << 16);
    assert_within("veil", result, expected);
}

/// An emitting quad and a rectangle light of the same size light a floor equally, by light samples and by
/// paths that hit them: the factor of a square of edge a at height h over the floor point below its center
/// is (4/π) · 2 · (b/√(1+b²)) atan(b/√(1+b²)) / 2 with b = a/(2h).
#[test]
fn emitting_mesh_lights_like_a_rectangle() {
    let (edge, height) = (2.0_f32, 1.5_f32);
    let b = f64::from(edge / (2.0 * height));
    let root = (1.0 + b * b).sqrt();
    let form_factor = 4.0 / std::f64::consts::PI * (b / root) * (b / root).atan();
    let expected = GRAY * (3.0 * form_factor) as f32;
    let floor = || quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let origin = Vec3::new(0.0, 0.7, 1.2);
    let direction = -origin.normalize();

    let mut by_rectangle = scene(vec![floor()], matte(GRAY));
    by_rectangle.lights.push(Light::Rectangle {
        center: Vec3::Z * height,
        edge_x: Vec3::Y * edge,
        edge_y: Vec3::X * edge,
        radiance: Vec3::splat(3.0),
        visible: true,
    });
    let result = measure(&prepare(by_rectangle), origin, direction, 1 << 15);
    assert_within("rectangle", result, expected);

    let lamp = quad(Vec3::Z * height, Vec3::Y * (edge / 2.0), Vec3::X * (edge / 2.0));
    let mut by_mesh = scene(vec![floor(), lamp], matte(GRAY));
    by_mesh.materials.push(Material { emission_luminance: 3.0, ..matte(Vec3::ZERO) });
    by_mesh.objects[1].material = 1;
    let result = measure(&prepare(by_mesh.clone()), origin, direction, 1 << 15);
    assert_within("emitting mesh", result, expected);

    // Direct view of the emitter: its radiance, and nothing from its back.
    let renderer = prepare(by_mesh);
    assert_eq!(sample_ray(&renderer, Vec3::Z * 0.5, Vec3::Z, 1, 0).emission, Vec3::splat(3.0));
    assert_eq!(sample_ray(&renderer, Vec3::Z * 9.0, Vec3::NEG_Z, 1, 0).emission, Vec3::ZERO);
}

/// A normal map that tilts by an angle turns a Lambertian plane's brightness into that of a tilted one.
#[test]
fn normal_map_tilts_the_shading_normal() {
    let tilt = 0.5_f32;
    let byte = |x: f32| ((x * 0.5 + 0.5) * 255.0).round() as u8;
    let mut mesh: Mesh = quad(Vec3::ZERO, Vec3::X * 10.0, Vec3::Y * 10.0);
    mesh.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let mut scene = scene(vec![mesh], matte(Vec3::ONE));
    scene.images.push(Arc::new(Image {
        name: "tilt".into(),
        path: None,
        width: 1,
        height: 1,
        color_space: ColorSpace::Linear,
        pixels: Pixels::Byte(vec![[byte(tilt.sin()), byte(0.0), byte(tilt.cos()), 255]]),
    }));
    scene.materials[0].geometry_normal = Some(NormalMap { texture: TextureRef::new(0), scale: 1.0 });
    scene.lights.push(distant(Vec3::new(tilt.sin(), 0.0, tilt.cos())));
    let (mean, _) = measure(&prepare(scene), Vec3::Z, Vec3::NEG_Z, 64);
    assert!((mean.x * std::f32::consts::PI - 1.0).abs() < 1e-3, "{mean}");
}

/// A camera ray that misses everything sees the environment, and has alpha 1, only if that is visible.
#[test]
fn background_is_black_and_transparent_unless_visible() {
    for visible in [false, true] {
        let out_of_sight = quad(Vec3::Z * 50.0, Vec3::X, Vec3::Y);
        let mut scene = scene(vec![out_of_sight], matte(GRAY));
        scene.environment = uniform_environment(GRAY).map(|e| translucid_scene::Environment { visible, ..e });
        let sample = sample_ray(&prepare(scene), Vec3::ZERO, Vec3::X, 0, 0);
        let expected = if visible { (GRAY, 1.0) } else { (Vec3::ZERO, 0.0) };
        assert_eq!((sample.radiance(), sample.alpha), expected);
    }
}

/// Layers add up to the beauty and hold the light that they are named after.
#[test]
fn layers_hold_what_their_names_say() {
    let glossy = Material {
        subsurface_weight: ScalarInput::constant(0.5),
        subsurface_radius: ScalarInput::constant(0.01),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique),
        ..Material::default()
    };
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], glossy);
    scene.objects.push(Object {
        name: "lamp".into(),
        mesh: quad(Vec3::new(0.0, 9.0, 9.0), Vec3::X, Vec3::new(0.0, -1.0, 1.0)).into(),
        material: 1,
        subsurface_group: 1,
        ..Object::default()
    });
    scene.materials.push(Material { emission_luminance: 5.0, ..matte(Vec3::ZERO) });
    let renderer = prepare(scene);
    let (mut diffuse, mut specular, mut subsurface) = (0.0, 0.0, 0.0);
    for index in 0..2000 {
        let sample =
            sample_ray(&renderer, Vec3::new(0.0, -2.0, 2.0), Vec3::new(0.0, 1.0, -1.0).normalize(), 3, index);
        diffuse += sample.diffuse.y;
        specular += sample.specular.y;
        subsurface += sample.subsurface.y;
        assert_eq!(sample.emission, Vec3::ZERO);
        assert!((sample.depth - 8.0_f32.sqrt()).abs() < 1e-3 && sample.normal == Vec3::Z);
    }
    assert!(diffuse > 0.0 && specular > 0.0 && subsurface > 0.0, "{diffuse} {specular} {subsurface}");
}
