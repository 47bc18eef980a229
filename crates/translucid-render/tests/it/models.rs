//! Every model in the renderer against its own profile: A of a plane, transmission of a slab, constant and textured.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in 2,700 comparisons).

use std::sync::Arc;

use glam::Vec3;
use translucid_profile::{
    Appearance, Configuration, DirectionalDipole, Model, ObliqueDiffusion, Parameterization,
    half_space_single_scattering_albedo,
};
use translucid_reference::exact::ObliqueHalfSpace;
use translucid_render::NoteKind;
use translucid_scene::{
    ColorInput, ColorSpace, Image, Light, Material, Mesh, Pixels, ProfileRow, ProfileTable, ScalarInput,
    Scene, SubsurfaceMethod, SubsurfaceModel, SubsurfaceNormalization, SubsurfaceTextureAt, TextureRef,
    WalkSurface,
};

use crate::common::{
    assert_within, distant, measure, prepare, quad, sample_ray, samples, scene, sphere, uniform_environment,
};

const DIRECTIONAL: SubsurfaceModel = SubsurfaceModel::Profile(Model::DirectionalDipole);
const OBLIQUE: SubsurfaceModel = SubsurfaceModel::Profile(Model::NormalizedDiffusionOblique);
/// Models that know where light comes from.
const DIRECTED: [Model; 2] = [Model::DirectionalDipole, Model::NormalizedDiffusionOblique];
const ALBEDO: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.4);

/// A translucent material without a specular interface.
fn material(model: SubsurfaceModel) -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: model,
        ..Material::default()
    }
}

/// Replaces a scene's color by an image of it, so that the renderer has to expect any.
fn textured(mut scene: Scene) -> Scene {
    scene.images.push(Arc::new(Image {
        name: "color".into(),
        path: None,
        width: 1,
        height: 1,
        color_space: ColorSpace::Linear,
        pixels: Pixels::Float(vec![[ALBEDO.x, ALBEDO.y, ALBEDO.z, 1.0]]),
    }));
    let texture = Some(TextureRef::new(0));
    scene.materials[0].subsurface_color = ColorInput { texture, ..ColorInput::constant(Vec3::ONE) };
    scene
}

/// Energy that leaves beyond the distance t, per channel, without a phase function and a boundary.
fn beyond(model: Model, t: f32) -> Vec3 {
    beyond_with(model, t, 0.0, 1.0)
}

/// Energy that leaves beyond the distance t, per channel, with a phase function and a boundary.
fn beyond_with(model: Model, t: f32, g: f64, eta: f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|c| {
        let appearance = Appearance {
            surface_albedo: f64::from(ALBEDO[c]),
            length: f64::from(LENGTH[c]),
            parameterization: Parameterization::Mfp,
            g,
        };
        let profile = model.profile(&appearance, Configuration::Diffuse, eta).unwrap();
        profile.beyond(f64::from(t)) as f32
    }))
}

fn slab(material: Material, thickness: f32) -> Scene {
    let top = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 1e3, Vec3::X * 1e3);
    let mut scene = scene(vec![top, bottom], material);
    scene.integrator.subsurface_tail = 1e-6;
    scene.lights.push(distant(Vec3::NEG_Z));
    scene
}

#[test]
fn plane_under_uniform_light_returns_surface_albedo() {
    for model in SubsurfaceModel::ALL {
        // Their energy depends on where light comes from, or goes; the default is one of them
        let follows_directions =
            [WalkSurface::Clear, WalkSurface::Rough, WalkSurface::Skin].map(SubsurfaceModel::RandomWalk);
        let is_other = [DIRECTIONAL, SubsurfaceModel::Default].contains(&model);
        if is_other || follows_directions.contains(&model) {
            continue;
        }
        let mut plain = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material(model));
        plain.environment = uniform_environment(Vec3::ONE);
        // A profile of layers takes no textures
        let with_texture = (model != SubsurfaceModel::Layers).then(|| ("textured", textured(plain.clone())));
        for (name, scene) in [("constant", plain)].into_iter().chain(with_texture) {
            let point = Vec3::new(3.3, 1.1, 0.0);
            let result = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 14);
            assert_within(&format!("{} {name}", model.name()), result, ALBEDO);
        }
    }
}

/// White with a diffuse mean free path is a limit that no medium reaches: radial and directional profiles stop at the same
/// albedo below it, so that no sample counts for hundreds.
#[test]
fn white_with_a_dmfp_is_no_noisier_than_nearly_white() {
    for texture in [false, true] {
        let errors = [0.9999, 1.0].map(|a| {
            let mut white = material(OBLIQUE);
            white.subsurface_color = ColorInput::constant(Vec3::splat(a));
            white.subsurface_parameter = Parameterization::Dmfp;
            white.subsurface_radius_scale = ColorInput::constant(Vec3::splat(1e3));
            let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], white);
            scene.environment = uniform_environment(Vec3::ONE);
            if texture {
                scene = textured(scene);
                Arc::make_mut(&mut scene.images[0]).pixels = Pixels::Float(vec![[a, a, a, 1.0]]);
            }
            let point = Vec3::new(3.3, 1.1, 0.0);
            let (mean, error) = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 14);
            assert_within(&format!("texture {texture} A {a}"), (mean, error), Vec3::splat(a));
            error.max_element()
        });
        assert!(errors[1] < 1.5 * errors[0], "texture {texture}: {errors:?}");
    }
}

/// A slab lit from behind transmits the profile's energy beyond its thickness.
#[test]
fn slab_transmits_what_every_profile_says() {
    for model in Model::ALL.into_iter().filter(|model| !DIRECTED.contains(model)) {
        for thickness in [0.1, 0.7] {
            let plain = slab(material(SubsurfaceModel::Profile(model)), thickness);
            let expected = beyond(model, thickness) / std::f32::consts::PI;
            for (name, scene) in [("constant", plain.clone()), ("textured", textured(plain))] {
                let result =
                    measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, samples(1 << 17));
                assert_within(&format!("{model} {name} {thickness}"), result, expected);
            }
        }
    }
}

/// Both forms of normalized diffusion with a phase function and a boundary; parameters that they are not fitted for count
/// as the nearest that they are, with a note.
#[test]
fn normalized_diffusion_knows_phase_function_and_boundary() {
    let thickness = 1.5;
    for model in [Model::NormalizedDiffusion, Model::NormalizedDiffusionRefined] {
        for (g, eta, used, notes) in
            [(0.75, 1.375, [0.75, 1.375], vec![]), (0.97, 2.0, [0.9, 1.5], vec![NoteKind::NearestParameters])]
        {
            let material = Material {
                subsurface_scatter_anisotropy: g,
                subsurface_eta: eta,
                ..material(SubsurfaceModel::Profile(model))
            };
            let plain = slab(material, thickness);
            let expected = beyond_with(model, thickness, used[0], used[1]) / std::f32::consts::PI;
            for (name, scene) in [("constant", plain.clone()), ("textured", textured(plain))] {
                let renderer = prepare(scene);
                let kinds: Vec<_> = renderer.notes().iter().map(|note| note.kind).collect();
                assert_eq!(kinds, notes);
                let result = measure(&renderer, Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, samples(1 << 16));
                assert_within(&format!("{model} {name} {g} {eta}"), result, expected);
            }
        }
    }
}

/// A walk has no profile to gather from points, to pair or to normalize: keys that ask for one give a note.
#[test]
fn walk_says_which_keys_do_not_concern_it() {
    let notes = |material: Material, method| {
        let mut scene = slab(material, 1.0);
        scene.integrator.subsurface_method = method;
        let notes = prepare(scene).notes();
        notes.iter().map(|note| (note.kind, note.to_string())).collect::<Vec<_>>()
    };
    let walk = material(SubsurfaceModel::RandomWalk(WalkSurface::Clear));
    assert_eq!(notes(walk.clone(), SubsurfaceMethod::RayTraced), []);
    let asking = Material {
        subsurface_texture_at: SubsurfaceTextureAt::Both,
        subsurface_normalization: SubsurfaceNormalization::Energy,
        ..walk
    };
    let [(kind, words)] = &notes(asking, SubsurfaceMethod::PointBased)[..] else { panic!("one note") };
    assert_eq!(*kind, NoteKind::NoProfile);
    for key in ["subsurface_method = \"point-based\"", "subsurface_texture_at", "subsurface_normalization"] {
        assert!(words.contains(key), "{words}");
    }
}

/// Where positions have no digits for a mean free path, a note says that the surface is Lambertian.
#[test]
fn bodies_beyond_single_precision_are_told_of() {
    let notes = |far: f32, model| {
        let mut scene = slab(material(model), 1.0);
        let mesh = Arc::make_mut(&mut scene.objects[0].mesh);
        mesh.positions.iter_mut().for_each(|position| position.x += far);
        let kinds = prepare(scene).notes();
        kinds.into_iter().map(|note| note.kind).collect::<Vec<_>>()
    };
    for model in [
        SubsurfaceModel::RandomWalk(WalkSurface::Clear),
        SubsurfaceModel::Profile(Model::NormalizedDiffusion),
    ] {
        assert_eq!(notes(1e3, model), []);
        assert_eq!(notes(1e6, model), [NoteKind::Unresolved]);
    }
}

/// A lamp and a camera in the middle of a body are told of; those in a cavity, and outside, are not.
#[test]
fn lamps_and_cameras_inside_bodies_are_told_of() {
    let body = |meshes: Vec<Mesh>, at: Vec3, weight: f32| {
        let material = Material {
            subsurface_weight: ScalarInput::constant(weight),
            ..material(SubsurfaceModel::RandomWalk(WalkSurface::Clear))
        };
        let mut scene = scene(meshes, material);
        scene.objects.iter_mut().for_each(|object| object.subsurface_group = 0);
        scene.camera.position = at;
        let radiance = Vec3::ONE;
        scene.lights = vec![
            distant(Vec3::Z),
            Light::Sphere { center: at + 0.1 * Vec3::X, radius: 0.05, radiance, visible: true },
        ];
        prepare(scene).notes().into_iter().map(|note| note.to_string()).collect::<Vec<_>>()
    };
    let inside = body(vec![sphere(3.0, 24)], Vec3::new(0.5, 0.2, -0.3), 1.0);
    let [camera, light] = &inside[..] else { panic!("{inside:?}") };
    assert!(camera.contains("the camera may see nothing"), "{camera}");
    assert!(light.contains("light 1 (sphere) lights nothing"), "{light}");
    let mut cavity = sphere(1.0, 24);
    cavity.flip_winding();
    assert_eq!(body(vec![sphere(3.0, 24), cavity], Vec3::new(0.5, 0.2, -0.3), 1.0), [""; 0]);
    assert_eq!(body(vec![sphere(3.0, 24)], Vec3::new(5.0, 0.2, -0.3), 1.0), [""; 0]);
    assert_eq!(body(vec![sphere(3.0, 24)], Vec3::new(0.5, 0.2, -0.3), 0.0), [""; 0]);
}

/// A camera in an opaque body without light is told of; one in a lit room, in a room with a window or outside is not.
#[test]
fn cameras_inside_dark_bodies_are_told_of() {
    let notes = |mesh: Mesh, at: Vec3, change: &dyn Fn(&mut Scene)| {
        let mut scene = scene(vec![mesh], Material::default());
        scene.camera.position = at;
        scene.lights = vec![distant(Vec3::Z)];
        change(&mut scene);
        prepare(scene).notes().into_iter().map(|note| note.to_string()).collect::<Vec<_>>()
    };
    let at = Vec3::new(0.5, 0.2, -0.3);
    let [camera] = &notes(sphere(3.0, 24), at, &|_| {})[..] else { panic!("one note") };
    assert!(
        camera.contains("nothing but the inside of object") && camera.contains("--view front"),
        "{camera}"
    );
    let none = [""; 0];
    assert_eq!(notes(sphere(3.0, 24), Vec3::new(5.0, 0.2, -0.3), &|_| {}), none);
    let lamp = Light::Sphere { center: Vec3::ZERO, radius: 0.1, radiance: Vec3::ONE, visible: true };
    assert_eq!(notes(sphere(3.0, 24), at, &|scene| scene.lights.push(lamp)), none);
    assert_eq!(notes(sphere(3.0, 24), at, &|scene| scene.materials[0].emission_luminance = 1.0), none);
    assert_eq!(notes(sphere(3.0, 24), at, &|scene| scene.materials[0].geometry_opacity.factor = 0.5), none);
    let glass = |scene: &mut Scene| scene.materials[0].transmission_weight.factor = 1.0;
    assert_eq!(notes(sphere(3.0, 24), at, &glass), none);
    let mut room = sphere(3.0, 24);
    room.triangles.truncate(room.triangles.len() * 9 / 10);
    assert_eq!(notes(room, at, &|_| {}), none);
    let mut cavity = sphere(3.0, 24);
    cavity.flip_winding();
    assert_eq!(notes(cavity, at, &|_| {}), none);
}

/// Without a named model, the picture is that of the model that the scene implies, and every key is honored.
#[test]
fn default_renders_what_it_stands_for() {
    let sample = |scene: &Scene| {
        let prepared = prepare(scene.clone());
        assert_eq!(prepared.notes(), []);
        let sample =
            |index| sample_ray(&prepared, Vec3::new(3.3, 1.1, 1.0), Vec3::NEG_Z, 1, index).radiance();
        (0..64).map(sample).sum::<Vec3>()
    };
    let plain = material(SubsurfaceModel::Default);
    let both = Material { subsurface_texture_at: SubsurfaceTextureAt::Both, ..plain.clone() };
    let [glazed, glazed_both] =
        [&plain, &both].map(|material| Material { subsurface_eta: 1.4, ..material.clone() });
    for (material, model) in [
        (plain, SubsurfaceModel::RandomWalk(WalkSurface::Clear)),
        (both, OBLIQUE),
        (glazed, SubsurfaceModel::RandomWalk(WalkSurface::Rough)),
        (glazed_both, SubsurfaceModel::Profile(Model::NormalizedDiffusionRefined)),
    ] {
        let mut scene = slab(material, 1.0);
        scene.lights.push(distant(Vec3::Z));
        let by_default = sample(&scene);
        scene.materials[0].subsurface_model = model;
        assert_eq!(by_default, sample(&scene), "{}", model.name());
        assert!(by_default.min_element() > 0.0, "{by_default}");
    }
}

#[test]
fn directional_dipole_returns_surface_albedo_along_the_normal() {
    let mut plain = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material(DIRECTIONAL));
    plain.lights.push(distant(Vec3::Z));
    for (name, scene) in [("constant", plain.clone()), ("textured", textured(plain))] {
        let point = Vec3::new(3.3, 1.1, 0.0);
        let result = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 14);
        assert_within(name, result, ALBEDO / std::f32::consts::PI);
    }
}

/// Diffuse light returns A under a boundary, too, which keeps light from grazing below it.
#[test]
fn oblique_diffusion_returns_surface_albedo_under_a_boundary() {
    let material = Material { subsurface_eta: 1.4, ..material(OBLIQUE) };
    let mut plain = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material);
    plain.environment = uniform_environment(Vec3::ONE);
    for (name, scene) in [("constant", plain.clone()), ("textured", textured(plain))] {
        let point = Vec3::new(3.3, 1.1, 0.0);
        let result = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 15);
        assert_within(name, result, ALBEDO);
    }
}

/// Light along the normal returns the albedo of the configuration that is made for it, in every channel, however far the
/// others reach.
#[test]
fn oblique_diffusion_returns_surface_albedo_along_the_normal() {
    let material = Material { subsurface_configuration: Configuration::Searchlight, ..material(OBLIQUE) };
    let mut plain = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material);
    plain.lights.push(distant(Vec3::Z));
    for (name, scene) in [("constant", plain.clone()), ("textured", textured(plain))] {
        let point = Vec3::new(3.3, 1.1, 0.0);
        let result = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 15);
        assert_within(name, result, ALBEDO / std::f32::consts::PI);
    }
}

/// A narrow beam on a plane of A = 0.7 for light along the normal, ℓ = 1.
struct SlantingBeam {
    toward_light: Vec3,
    radius: f32,
    scene: Scene,
}

impl SlantingBeam {
    fn new(model: SubsurfaceModel, eta: f32) -> Self {
        let toward_light = Vec3::new(-0.8, 0.0, 0.6);
        let radius = 0.1;
        let gray = Material {
            subsurface_color: ColorInput::constant(Vec3::splat(0.7)),
            subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
            subsurface_configuration: Configuration::Searchlight,
            subsurface_eta: eta,
            ..material(model)
        };
        let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], gray);
        scene.integrator.subsurface_tail = 1e-6;
        let (origin, direction) = (toward_light * 5.0, -toward_light);
        scene.lights.push(Light::Beam { origin, direction, radius, power: Vec3::ONE });
        Self { toward_light, radius, scene }
    }

    /// Radiance at an exit for a profile R(x, y): the mean over the beam's ellipse, by points of equal area.
    fn radiance(&self, exit: Vec3, profile: impl Fn(f64, f64) -> f64) -> f32 {
        let points = 4000;
        let sum: f64 = (0..points)
            .map(|i| {
                let r = f64::from(self.radius) * ((f64::from(i) + 0.5) / f64::from(points)).sqrt();
                let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
                profile(f64::from(exit.x) - r * cos / 0.6, f64::from(exit.y) - r * sin)
            })
            .sum();
        (sum / f64::from(points) / std::f64::consts::PI) as f32
    }
}

const EXITS: [Vec3; 3] = [Vec3::new(0.8, 0.0, 0.0), Vec3::new(-0.8, 0.0, 0.0), Vec3::new(0.3, 0.6, 0.0)];

/// A beam that arrives at a slant leaves to the right and to the left of it as the directional dipole predicts.
#[test]
fn directional_dipole_leaves_where_it_says() {
    let beam = SlantingBeam::new(DIRECTIONAL, 1.3);
    let renderer = prepare(beam.scene.clone());
    let appearance =
        Appearance { surface_albedo: 0.7, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
    let dipole = DirectionalDipole::new(&appearance, 1.3).unwrap();
    let up = [0.0, 0.0, 1.0];
    let toward_light = beam.toward_light.to_array().map(f64::from);
    let expected =
        EXITS.map(|exit| beam.radiance(exit, |x, y| dipole.eval([x, y, 0.0], toward_light, up, up)));
    for (exit, expected) in EXITS.into_iter().zip(expected) {
        let result = measure(&renderer, exit + Vec3::Z, Vec3::NEG_Z, samples(1 << 20));
        assert_within(&format!("exit {exit}"), result, Vec3::splat(expected));
    }
    assert!(expected[0] > 2.0 * expected[1], "{expected:?}");
}

/// A slanting beam leaves as oblique normalized diffusion predicts, which is the truth to within the model's error, with and without
/// refraction.
#[test]
fn oblique_diffusion_leaves_where_the_exact_solution_says() {
    let configuration = Configuration::Searchlight;
    let alpha = half_space_single_scattering_albedo(0.7, configuration);
    for eta in [1.0, 1.3] {
        let beam = SlantingBeam::new(OBLIQUE, eta);
        let renderer = prepare(beam.scene.clone());
        let cos_theta = (1.0 - (0.8 / f64::from(eta)).powi(2)).sqrt();
        let model = ObliqueDiffusion::new(0.7, 1.0, Parameterization::Mfp, configuration, cos_theta).unwrap();
        let exact = ObliqueHalfSpace::new(alpha, 1.0, cos_theta).unwrap();
        for exit in EXITS {
            let expected = beam.radiance(exit, |x, y| model.eval(x.hypot(y), y.atan2(x)));
            let result = measure(&renderer, exit + Vec3::Z, Vec3::NEG_Z, samples(1 << 18));
            assert_within(&format!("η {eta} exit {exit}"), result, Vec3::splat(expected));
            let (r, phi) = (f64::from(exit.length()), f64::from(exit.y.atan2(exit.x)));
            let error = model.eval(r, phi) / exact.eval(r, phi).value - 1.0;
            assert!(error.abs() < 0.1, "η {eta} exit {exit}: {error}");
        }
    }
}

/// A table of the dipole's numbers gives the dipole's picture.
#[test]
fn table_from_a_file_gives_the_picture_of_its_model() {
    let row = |a: f64| {
        let appearance =
            Appearance { surface_albedo: a, length: 1.0, parameterization: Parameterization::Mfp, g: 0.0 };
        let profile = Model::Dipole.profile(&appearance, Configuration::Diffuse, 1.0).unwrap();
        let radii: Vec<f64> = (0..240).map(|i| 1e-3 * 1.045_f64.powi(i)).collect();
        let reflectances = radii.iter().map(|&r| profile.eval(r)).collect();
        ProfileRow { surface_albedo: Some(a), radii, reflectances, ..ProfileRow::default() }
    };
    let mut scene = slab(material(SubsurfaceModel::Tabulated(0)), 0.7);
    let rows = [0.2, 0.5, 0.9].map(row).to_vec();
    scene.profile_tables.push(ProfileTable { path: "dipole.csv".into(), rows });
    let result = measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, samples(1 << 17));
    assert_within("table", result, beyond(Model::Dipole, 0.7) / std::f32::consts::PI);
}

/// A profile too narrow for positions to resolve is a Lambertian surface, whatever the unit of its file.
#[test]
fn narrow_table_is_the_lambertian_limit() {
    for unit in [1e-98, 1e-30, 1e-12] {
        let row = ProfileRow {
            surface_albedo: None,
            radii: [0.1, 1.0, 2.0, 4.0].map(|r| r * unit).to_vec(),
            reflectances: vec![5.0, 1.0, 0.4, 0.05],
            enclosed: Vec::new(),
        };
        let plane = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
        let mut scene = scene(vec![plane], material(SubsurfaceModel::Tabulated(0)));
        scene.profile_tables = vec![ProfileTable { path: "narrow.csv".into(), rows: vec![row] }];
        scene.environment = uniform_environment(Vec3::ONE);
        let point = Vec3::new(3.3, 1.1, 0.0);
        let result = measure(&prepare(scene), point + Vec3::Z, Vec3::NEG_Z, 1 << 12);
        assert_within(&format!("unit {unit:e}"), result, ALBEDO);
    }
}
