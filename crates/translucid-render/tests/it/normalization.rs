//! Profiles normalized by shape: in even light every surface returns A.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in 2,700 comparisons)
//! plus the error that a sum over points may have.

use glam::Vec3;
use translucid_profile::{Appearance, Configuration, Model, Parameterization};
use translucid_render::NoteKind;
use translucid_scene::{
    ColorInput, Integrator, Material, Mesh, ScalarInput, Scene, SubsurfaceModel, SubsurfaceNormalization,
};

use crate::common::{distant, measure, prepare, quad, scene, sphere, uniform_environment};

const A: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.8);
/// Relative error that N may have: the points are blue noise with a finite spacing.
const POINTS: f32 = 0.03;

fn material(model: Model, normalization: SubsurfaceNormalization) -> Material {
    Material {
        name: "normalized".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(A),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: SubsurfaceModel::Profile(model),
        subsurface_normalization: normalization,
        ..Material::default()
    }
}

fn even(meshes: Vec<Mesh>, material: Material) -> Scene {
    let mut scene = scene(meshes, material);
    scene.environment = uniform_environment(Vec3::ONE);
    scene.integrator.subsurface_tail = 1e-5;
    scene
}

/// Two faces, twice `half` wide.
fn slab(thickness: f32, half: f32) -> Vec<Mesh> {
    let top = quad(Vec3::ZERO, Vec3::X * half, Vec3::Y * half);
    vec![top, quad(Vec3::NEG_Z * thickness, Vec3::Y * half, Vec3::X * half)]
}

fn assert_near(name: &str, (mean, error): (Vec3, Vec3), expected: Vec3, tolerance: f32) {
    for c in 0..3 {
        let off = (mean[c] - expected[c]).abs();
        assert!(off < 4.0 * error[c] + tolerance * expected[c], "{name} {c}: {mean} ± {error}, {expected}");
    }
}

#[test]
fn even_light_returns_the_surface_albedo_from_any_shape() {
    let bodies = [
        ("sphere", vec![sphere(1.0, 64)], 3.0),
        ("slab", slab(0.5, 2.5), 3.0),
        ("plane", slab(90.0, 4.0), 3.0),
    ];
    for model in [Model::NormalizedDiffusionOblique, Model::NormalizedDiffusion, Model::Dipole] {
        for (name, meshes, height) in bodies.clone() {
            let scene = even(meshes, material(model, SubsurfaceNormalization::Energy));
            let renderer = prepare(scene);
            assert!(renderer.notes().is_empty(), "{:?}", renderer.notes());
            let result = measure(&renderer, Vec3::new(0.11, 0.07, height), Vec3::NEG_Z, 1 << 13);
            assert_near(&format!("{model} {name}"), result, A, POINTS);
        }
    }
}

/// Without it a sphere returns what the profile has within its diameter, and a slab what it has beyond its thickness
/// besides A: the figures of the page on thin parts are the renderer's.
#[test]
fn thin_things_return_what_the_profile_says() {
    let model = Model::NormalizedDiffusionRefined;
    let energies = |energy: fn(&dyn translucid_profile::Profile) -> f64| {
        Vec3::from_array(std::array::from_fn(|c| {
            let appearance = Appearance {
                surface_albedo: f64::from(A[c]),
                length: f64::from(LENGTH[c]),
                parameterization: Parameterization::Mfp,
                g: 0.0,
            };
            energy(model.profile(&appearance, Configuration::Diffuse, 1.0).unwrap().as_ref()) as f32
        }))
    };
    let origin = Vec3::new(0.11, 0.07, 3.0);
    let ball = even(vec![sphere(1.0, 128)], material(model, SubsurfaceNormalization::None));
    let result = measure(&prepare(ball), origin, Vec3::NEG_Z, 1 << 15);
    // The sphere is one of flat faces
    assert_near("sphere", result, energies(|profile| profile.enclosed(2.0)), 0.005);
    let sheet = even(slab(0.5, 1e3), material(model, SubsurfaceNormalization::None));
    let result = measure(&prepare(sheet), origin, Vec3::NEG_Z, 1 << 15);
    assert_near("slab", result, energies(|profile| profile.surface_albedo() + profile.beyond(0.5)), 0.002);
}

/// Light from behind a slab and from before it keep their proportion.
#[test]
fn normalization_is_a_factor_of_the_exit() {
    let means = [SubsurfaceNormalization::None, SubsurfaceNormalization::Energy].map(|normalization| {
        [Vec3::Z, Vec3::NEG_Z].map(|toward| {
            let mut scene = scene(slab(0.5, 4.0), material(Model::NormalizedDiffusionRefined, normalization));
            scene.lights.push(distant(toward));
            measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, 1 << 14).0
        })
    });
    let ratios = means.map(|[front, back]| back / front);
    // Equal seeds draw equal paths
    assert!((ratios[0] / ratios[1] - 1.0).abs().max_element() < 1e-3, "{ratios:?}");
    assert!((means[1][0] / means[0][0]).cmplt(Vec3::splat(0.95)).all(), "{means:?}");
}

/// Points that do not fit into memory leave the picture without normalization, and give a note.
#[test]
fn points_without_room_are_noted() {
    let narrow = Material {
        subsurface_radius: ScalarInput::constant(1e-3),
        ..material(Model::NormalizedDiffusion, SubsurfaceNormalization::Energy)
    };
    let mut scene = even(slab(0.5, 20.0), narrow);
    scene.integrator = Integrator { point_memory: 1, ..scene.integrator };
    let renderer = prepare(scene);
    let note = &renderer.notes()[0];
    assert_eq!(note.kind, NoteKind::NoNormalization, "{note}");
    assert!(note.to_string().starts_with("subsurface_normalization is left out: "), "{note}");
    let result = measure(&renderer, Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, 1 << 10);
    assert_near("plane", result, A, 0.0);
}
