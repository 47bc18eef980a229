//! Textured surface albedo and mean free path, where exit and entry have different ones.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in 2,700
//! comparisons).

use std::f64::consts::PI;
use std::sync::Arc;

use glam::{Vec2, Vec3};
use translucid_profile::{Appearance, Configuration, Model, Parameterization};
use translucid_scene::{
    ColorInput, ColorSpace, Image, Light, Material, Mesh, Object, Pixels, ScalarInput, Scene,
    SubsurfaceModel, SubsurfaceTextureAt, TextureRef,
};

use crate::common::{
    assert_within, distant, measure, precision, prepare, quad, samples, scene, uniform_environment,
};

const POLICIES: [SubsurfaceTextureAt; 3] =
    [SubsurfaceTextureAt::Exit, SubsurfaceTextureAt::Entry, SubsurfaceTextureAt::Both];

/// A and ℓ to the left of a step, and to the right of it.
struct Step {
    albedo: [Vec3; 2],
    length: [Vec3; 2],
}

const STEP: Step = Step {
    albedo: [Vec3::new(0.9, 0.3, 0.6), Vec3::new(0.4, 0.8, 0.6)],
    length: [Vec3::new(1.0, 0.5, 0.3), Vec3::new(1.0, 1.0, 0.9)],
};

fn material(model: Model, texture_at: SubsurfaceTextureAt) -> Material {
    Material {
        name: "textured".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_model: SubsurfaceModel::Profile(model),
        // The oblique profile is this one along the normal; the other models get the same parameters
        subsurface_configuration: Configuration::Searchlight,
        subsurface_texture_at: texture_at,
        ..Material::default()
    }
}

/// The plane z = 0 in two halves x < 0 and x > 0, each of which sees one pixel of an image.
fn halves() -> Mesh {
    let mut mesh = Mesh::default();
    for (side, u) in [(-500.0, 0.25), (500.0, 0.75)] {
        let half = quad(Vec3::X * side, Vec3::X * 500.0, Vec3::Y * 1e3);
        let first = mesh.positions.len() as u32;
        mesh.triangles.extend(half.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
        mesh.positions.extend(half.positions);
        mesh.uvs.extend([Vec2::new(u, 0.5); 4]);
    }
    mesh
}

fn image(pixels: &[Vec3]) -> Arc<Image> {
    Arc::new(Image {
        name: "image".into(),
        path: None,
        width: pixels.len() as u32,
        height: 1,
        color_space: ColorSpace::Linear,
        pixels: Pixels::Float(pixels.iter().map(|p| [p.x, p.y, p.z, 1.0]).collect()),
    })
}

fn textured(mut material: Material, meshes: Vec<Mesh>, albedo: &[Vec3], length: &[Vec3]) -> Scene {
    let input =
        |index| ColorInput { texture: Some(TextureRef::new(index)), ..ColorInput::constant(Vec3::ONE) };
    material.subsurface_color = input(0);
    material.subsurface_radius_scale = input(1);
    let mut scene = scene(meshes, material);
    scene.images = vec![image(albedo), image(length)];
    scene.integrator.subsurface_tail = 1e-6;
    scene
}

fn step_scene(material: Material, step: &Step) -> Scene {
    textured(material, vec![halves()], &step.albedo, &step.length)
}

/// Energy of a profile beyond a line at a distance x: ∫ acos(x/r)/π dE, with r = x/cos φ.
fn beyond_line(model: Model, a: f32, length: f32, x: f32) -> f64 {
    if a == 0.0 {
        return 0.0;
    }
    let appearance = Appearance {
        surface_albedo: f64::from(a),
        length: f64::from(length),
        parameterization: Parameterization::Mfp,
        g: 0.0,
    };
    let profile = model.profile(&appearance, Configuration::Searchlight, 1.0).unwrap();
    let n = 4000;
    let beyond = |i: u32| {
        let phi = 0.5 * PI * f64::from(i) / f64::from(n);
        if i == n { 0.0 } else { profile.beyond(f64::from(x) / phi.cos()) }
    };
    (0..n).map(|i| (beyond(i) - beyond(i + 1)) * (f64::from(i) + 0.5) / f64::from(2 * n)).sum()
}

/// Radiosity at a distance x from the step under even irradiance 1, of light that enters on the exit's side and on the other.
fn expected(model: Model, policy: SubsurfaceTextureAt, step: &Step, x: f32) -> Vec3 {
    let exit = usize::from(x > 0.0);
    Vec3::from_array(std::array::from_fn(|c| {
        let [a, l] = [step.albedo, step.length].map(|sides| sides[exit][c]);
        let [b, m] = [step.albedo, step.length].map(|sides| sides[1 - exit][c]);
        let (pair, length) = match policy {
            SubsurfaceTextureAt::Exit => (a, l),
            SubsurfaceTextureAt::Entry => (b, m),
            SubsurfaceTextureAt::Both => ((a * b).sqrt(), (l * m).sqrt()),
        };
        let own = f64::from(a) - beyond_line(model, a, l, x.abs());
        (own + beyond_line(model, pair, length, x.abs())) as f32
    }))
}

#[test]
fn step_follows_the_line_integrals_of_its_policy() {
    // Round profiles in closed form and by table, and the one that follows directions, by which light along the normal
    // is round
    let models = [
        (Model::NormalizedDiffusion, Model::NormalizedDiffusion),
        (Model::NormalizedDiffusionRefined, Model::NormalizedDiffusionRefined),
        (Model::NormalizedDiffusionOblique, Model::NormalizedDiffusionRefined),
    ];
    for (model, shape) in models {
        for policy in POLICIES {
            let mut scene = step_scene(material(model, policy), &STEP);
            scene.lights.push(distant(Vec3::Z));
            let renderer = prepare(scene);
            for x in [-0.6_f32, -0.1, 0.1, 0.6] {
                let result = measure(&renderer, Vec3::new(x, 0.3, 1.0), Vec3::NEG_Z, samples(1 << 15));
                let expected = expected(shape, policy, &STEP, x) / std::f32::consts::PI;
                assert_within(&format!("{model} {policy:?} {x}"), result, expected);
            }
        }
    }
}

/// Light that entered on a bright side leaves on a black one if the entry's albedo counts, and only then.
#[test]
fn black_exit_shows_light_of_a_bright_entry() {
    let step = Step { albedo: [Vec3::splat(0.8), Vec3::ZERO], length: [Vec3::ONE; 2] };
    for policy in POLICIES {
        let model = Model::NormalizedDiffusion;
        let mut scene = step_scene(material(model, policy), &step);
        scene.lights.push(distant(Vec3::Z));
        let (mean, error) = measure(&prepare(scene), Vec3::new(0.3, 0.3, 1.0), Vec3::NEG_Z, 1 << 15);
        if policy == SubsurfaceTextureAt::Entry {
            let expected = expected(model, policy, &step, 0.3) / std::f32::consts::PI;
            assert_within("black", (mean, error), expected);
        } else {
            assert_eq!(mean, Vec3::ZERO, "{policy:?}");
        }
    }
}

/// A narrow beam on one side of a step seen on the other, and the other way around.
#[test]
fn both_is_reciprocal_and_the_others_are_not() {
    let places = [-0.5_f32, 0.4];
    for policy in POLICIES {
        let [there, back] = [places, [places[1], places[0]]].map(|[lit, seen]| {
            let mut scene = step_scene(material(Model::NormalizedDiffusionRefined, policy), &STEP);
            scene.lights.push(Light::Beam {
                origin: Vec3::new(lit, 0.0, 5.0),
                direction: Vec3::NEG_Z,
                radius: 0.15,
                power: Vec3::ONE,
            });
            let renderer = prepare(scene);
            measure(&renderer, Vec3::new(seen, 0.0, 1.0), Vec3::NEG_Z, samples(1 << 17).max(1 << 15))
        });
        let z = (there.0 - back.0) / (there.1 * there.1 + back.1 * back.1).map(f32::sqrt);
        let relative = ((there.0 - back.0) / there.0).abs();
        // Both ways have the same distances of pairs
        if policy == SubsurfaceTextureAt::Both {
            assert!(z.abs().max_element() < 4.0, "{there:?} {back:?}, z = {z}");
            assert!((there.1 / there.0).max_element() < precision() as f32, "too noisy to tell: {there:?}");
        } else {
            assert!(relative.max_element() > 0.3, "{policy:?}: {there:?} {back:?}");
        }
    }
}

#[test]
fn even_textures_are_the_same_by_every_policy() {
    let [albedo, length] = [Vec3::new(0.9, 0.5, 0.2), Vec3::new(1.0, 0.5, 0.25)];
    let point = Vec3::new(3.3, 1.1, 1.0);
    for model in Model::ALL {
        let mut constants = Vec::new();
        for policy in POLICIES {
            let plane = || vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)];
            let constant = Material {
                subsurface_color: ColorInput::constant(albedo),
                subsurface_radius_scale: ColorInput::constant(length),
                ..material(model, policy)
            };
            let mut plain = scene(plane(), constant);
            plain.lights.push(distant(Vec3::Z));
            let renderer = prepare(plain);
            constants.push(measure(&renderer, point, Vec3::NEG_Z, 1 << 10));
            let mut even = textured(material(model, policy), plane(), &[albedo], &[length]);
            even.lights.push(distant(Vec3::Z));
            let result = measure(&prepare(even), point, Vec3::NEG_Z, samples(1 << 14));
            assert_within(&format!("{model} {policy:?}"), result, albedo / std::f32::consts::PI);
        }
        assert_eq!([constants[1], constants[2]], [constants[0]; 2], "{model}: no texture, no difference");
    }
}

/// Vertex colors and a texture of the mean free path's scale and of the radius are all covered by the widest proposal.
#[test]
fn every_kind_of_texture_is_covered() {
    for (name, change) in [
        ("vertex color", (|m| m.subsurface_color = ColorInput::vertex()) as fn(&mut Material)),
        ("vertex length", |m| m.subsurface_radius_scale = ColorInput::vertex()),
        ("radius", |m| {
            let texture = Some((TextureRef::new(1), translucid_scene::Channel::Green));
            m.subsurface_radius = ScalarInput { factor: 1.0, texture };
        }),
    ] {
        let mut material = Material {
            subsurface_color: ColorInput::constant(Vec3::splat(0.6)),
            subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
            ..material(Model::NormalizedDiffusion, SubsurfaceTextureAt::Entry)
        };
        change(&mut material);
        let mut mesh = halves();
        mesh.colors = [[Vec3::splat(0.9); 4], [Vec3::splat(0.3); 4]].concat();
        let mut scene = scene(vec![mesh], material);
        scene.images = vec![image(&[Vec3::ONE]), image(&[Vec3::splat(0.9), Vec3::splat(0.3)])];
        scene.integrator.subsurface_tail = 1e-6;
        scene.lights.push(distant(Vec3::Z));
        let (bright, dim) = (Vec3::splat(0.9), Vec3::splat(0.3));
        let step = if name == "vertex color" {
            Step { albedo: [bright, dim], length: [Vec3::ONE; 2] }
        } else {
            Step { albedo: [Vec3::splat(0.6); 2], length: [bright, dim] }
        };
        let result = measure(&prepare(scene), Vec3::new(0.2, 0.3, 1.0), Vec3::NEG_Z, samples(1 << 16));
        let expected = expected(Model::NormalizedDiffusion, SubsurfaceTextureAt::Entry, &step, 0.2);
        assert_within(name, result, expected / std::f32::consts::PI);
    }
}

/// Lengths of another material do not count: across materials of one group the exit's do.
#[test]
fn across_materials_the_exit_counts() {
    let plane = quad(Vec3::X * 500.0, Vec3::X * 500.0, Vec3::Y * 1e3);
    let other = quad(Vec3::X * -500.0, Vec3::X * 500.0, Vec3::Y * 1e3);
    let [albedo, length] = [Vec3::splat(0.5), Vec3::ONE];
    let both = material(Model::NormalizedDiffusion, SubsurfaceTextureAt::Both);
    let mut scene = textured(both, vec![plane], &[albedo], &[length]);
    scene.materials.push(Material {
        subsurface_weight: ScalarInput::constant(1.0),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusion),
        ..Material::default()
    });
    scene.objects.push(Object {
        name: "other".into(),
        mesh: other.into(),
        material: 1,
        subsurface_group: 0,
        ..Object::default()
    });
    scene.environment = uniform_environment(Vec3::ONE);
    let result = measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, 1 << 15);
    assert_within("two materials", result, albedo);
}
