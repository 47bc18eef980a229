//! Profiles on a device against the processor's tables, what exports write, and its pictures.
//!
//! Pictures have the same random numbers on both sides, and the processor shares no light between pixels here, so that pixels
//! are equal to rounding, wherever both find the same entry points.

#![allow(clippy::print_stdout, reason = "the figures are for those who ask with --nocapture")]

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Affine2, Vec2, Vec3};
use translucid_export::{Export, Language, Sizes, Subject, Target};
use translucid_profile::{
    AlbedoTable, AlbedoTableF32, Appearance, Configuration, DirectionalDipoleTable, Model, Parameterization,
    Profile,
};
use translucid_scene::{
    Camera, Channel, ColorInput, ColorSpace, Environment, Film, Image, Light, Material, Mesh, Object, Pixels,
    ProfileRow, ProfileTable, ScalarInput, Scene, SubsurfaceModel, SubsurfaceNormalization,
    SubsurfaceTextureAt, TextureRef,
};

use super::evaluate::Evaluation;
use super::tests::{color_by_place, lamp, matte, picture, scene, shape, texture, tracer};
use crate::program::LAWS;
use translucid_render::FilmLayer;

const COLOR: Vec3 = Vec3::new(0.9, 0.6, 0.3);

/// Words of a kernel before the number of its rows.
const BEFORE_ROWS: usize = 18;

const RADII: &str = "
    let p = profile_of(0u, inputs[i], inputs[i + 1]);
    let within = profile_at(p, p.longest).yz;
    let found = profile_at(p, inputs[i + 2]);
    outputs[o] = found.x;
    outputs[o + 1] = found.y + found.z;
    outputs[o + 2] = p.longest;
    outputs[o + 3] = profile_sample(p, within, inputs[i + 3]);
";

fn table(model: Model, albedos: &[f64]) -> AlbedoTableF32 {
    let profile = |surface_albedo| -> Result<Box<dyn Profile>, _> {
        let parameterization = Parameterization::Mfp;
        let appearance = Appearance { surface_albedo, length: 1.0, parameterization, g: 0.0 };
        model.profile(&appearance, Configuration::Diffuse, 1.0)
    };
    let table = if albedos.is_empty() {
        AlbedoTable::for_every_albedo(profile)
    } else {
        AlbedoTable::new(albedos, profile)
    };
    AlbedoTableF32::from(&table.unwrap())
}

/// Surface albedo, length, radius and random number of many inputs.
fn inputs(albedos: &[f32]) -> Vec<[f32; 4]> {
    let mut random = translucid_testing::SplitMix(7);
    let input = |i: usize| {
        let length = 10f32.powf(6.0 * random.uniform_f32() - 3.0);
        let radius = length * 10f32.powf(5.0 * random.uniform_f32() - 4.0);
        [albedos[i % albedos.len()], length, radius, random.uniform_f32()]
    };
    (0..2000).map(input).collect()
}

fn on_device(
    table: &AlbedoTableF32,
    shaders: &[&str],
    body: &str,
    width: usize,
    inputs: &[[f32; 4]],
) -> Vec<f32> {
    let mut tables = vec![0.0; BEFORE_ROWS];
    tables.push(table.surface_albedos().len() as f32);
    tables.extend(table.words(1e-3));
    let evaluation = Evaluation { shaders, body, tables: &tables, images: &[0], widths: [4, width] };
    evaluation.run(inputs.as_flattened())
}

/// Densities, shares, ends and radii are those of the processor's tables.
#[test]
fn tables_are_those_of_the_processor() {
    let every: Vec<f32> = (0..97).map(|i| i as f32 / 96.0).collect();
    for (model, rows, albedos) in [
        (Model::NormalizedDiffusionRefined, &[0.25, 0.75][..], &[0.25, 0.5, 0.75, 0.9][..]),
        (Model::QuantizedDiffusion, &[], &every[..90]),
        (Model::Gaussians, &[], &every),
    ] {
        let table = table(model, rows);
        let inputs = inputs(albedos);
        let found = on_device(&table, &[include_str!("shaders/profile.wgsl")], RADII, 4, &inputs);
        for ([albedo, length, r, u], found) in inputs.into_iter().zip(found.chunks(4)) {
            let view = table.at(albedo, length);
            let longest = view.truncation_radius(1e-3);
            let expected = [view.pdf(r), view.cdf(r), longest, view.sample_within(u, longest)];
            for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
                // The share of a row's neighbor is that of surface albedos rounded to single precision: next to a row, where it
                // is small, numbers that fall to the neighbor are off by as much more
                let allowed = match k {
                    0 => 2e-4 * expected + 1e-6 / length,
                    3 => 2e-3 * expected,
                    _ => 2e-4 * expected,
                };
                assert!(
                    (found - expected).abs() <= allowed,
                    "{model:?}, A = {albedo}, length {length}, r = {r}, u = {u}, value {k}: {found}, not {expected}"
                );
            }
        }
    }
}

/// The tables that pictures are made by are the profiles that exports write: density and share within.
#[test]
fn tables_are_the_profiles_of_exports() {
    let text = |model: Model| {
        let export = Export {
            target: Target::Text(Language::Wgsl),
            subjects: &[Subject::Profile],
            models: &[model],
            material: None,
            configuration: Configuration::Diffuse,
            g: 0.0,
            eta: 1.0,
            sizes: Sizes::default(),
            command: "a test",
        };
        String::from_utf8(export.bytes().unwrap()).unwrap()
    };
    let burley = "let d = burley_width(inputs[i + 1], burley_scale_mfp_diffuse(inputs[i]));
        outputs[o + 2] = burley_pdf(inputs[i + 2], d); outputs[o + 3] = burley_cdf(inputs[i + 2], d);";
    let refined = "let terms = refined_terms(inputs[i], inputs[i + 1]);
        outputs[o + 2] = refined_pdf(terms, inputs[i + 2]); outputs[o + 3] = refined_cdf(terms, inputs[i + 2]);";
    for (model, body) in [(Model::NormalizedDiffusion, burley), (Model::NormalizedDiffusionRefined, refined)]
    {
        let albedos = [0.2, 0.5, 0.8, 0.95];
        let table = table(model, &albedos);
        let inputs = inputs(&albedos.map(|albedo| albedo as f32));
        let body = format!(
            "let found = profile_at(profile_of(0u, inputs[i], inputs[i + 1]), inputs[i + 2]);
            outputs[o] = found.x; outputs[o + 1] = found.y + found.z;\n{body}"
        );
        let shaders = [include_str!("shaders/profile.wgsl"), &text(model)];
        for (input, found) in inputs.iter().zip(on_device(&table, &shaders, &body, 4, &inputs).chunks(4)) {
            // Cells are exact to 1e-4 of the cdf, and of the density where there is some
            let off = (found[0] - found[2]).abs() * input[1];
            assert!(off <= 2e-3 * found[2] * input[1] + 1e-5, "{model:?} {input:?}: {found:?}");
            assert!((found[1] - found[3]).abs() <= 1e-4, "{model:?} {input:?}: {found:?}");
        }
    }
}

pub(super) fn profile(model: Model) -> Material {
    Material {
        name: "wax".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(COLOR),
        subsurface_radius: ScalarInput::constant(0.3),
        subsurface_radius_scale: ColorInput::constant(Vec3::new(1.0, 0.5, 0.2)),
        subsurface_model: SubsurfaceModel::Profile(model),
        ..Material::default()
    }
}

/// A plane under a sky of radiance 1.
fn plane(material: Material) -> Scene {
    let corners = [
        Vec3::new(-1.0, 0.0, -1.0),
        Vec3::new(-1.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, -1.0),
    ];
    let mesh = Mesh {
        positions: corners.map(|corner| 40.0 * corner).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let mut scene = Scene {
        camera: Camera { position: Vec3::new(0.0, 3.0, 2.0), target: Vec3::ZERO, ..Camera::default() },
        film: Film { width: 8, height: 8, ..Film::default() },
        objects: vec![Object { name: "plane".into(), mesh: mesh.into(), ..Object::default() }],
        materials: vec![material],
        environment: Some(Environment { radiance: Vec3::ONE, ..Environment::default() }),
        ..Scene::default()
    };
    scene.integrator.subsurface_sharing = false;
    scene
}

/// Radiance of each pixel on the processor and on the device.
pub(super) fn both(scene: &Scene, samples: u32) -> [Vec<Vec3>; 2] {
    [None, Some(tracer())].map(|device| {
        let radiance = picture(scene, samples, device).film().layer(FilmLayer::Radiance);
        radiance.chunks(3).map(Vec3::from_slice).collect()
    })
}

/// Share of the pixels that differ by more than a relative bound.
pub(super) fn differing(both: &[Vec<Vec3>; 2], bound: f32) -> f32 {
    let [ours, theirs] = both;
    let is_other = |(a, b): &(&Vec3, &Vec3)| {
        let off = (**a - **b).abs().max_element();
        off.is_nan() || off > bound * a.max_element() + 1e-6
    };
    ours.iter().zip(theirs).filter(is_other).count() as f32 / ours.len() as f32
}

/// Mean of a channel over pixels, with its standard error.
fn mean_and_error(pixels: &[Vec3], channel: usize) -> (f64, f64) {
    let values: Vec<f64> = pixels.iter().map(|pixel| pixel[channel].into()).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (mean, (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

fn materials() -> Vec<(&'static str, Material)> {
    let oblique = profile(Model::NormalizedDiffusionOblique);
    vec![
        ("normalized diffusion", profile(Model::NormalizedDiffusion)),
        ("refined", profile(Model::NormalizedDiffusionRefined)),
        ("dipole", profile(Model::Dipole)),
        (
            "normalized",
            Material {
                subsurface_normalization: SubsurfaceNormalization::Energy,
                ..profile(Model::NormalizedDiffusion)
            },
        ),
        ("oblique", oblique.clone()),
        (
            "oblique, searchlight, diffuse mean free path",
            Material {
                subsurface_configuration: Configuration::Searchlight,
                subsurface_parameter: Parameterization::Dmfp,
                ..oblique.clone()
            },
        ),
        ("oblique, refracted", Material { subsurface_eta: 1.4, ..oblique }),
        (
            "directional dipole, searchlight",
            Material { subsurface_eta: 1.4, ..profile(Model::DirectionalDipole) },
        ),
    ]
}

/// On a plane each pixel is the processor's, and under an even sky the mean is A, but for models that direct light.
///
/// 6 × 3 comparisons with A within 4.5 standard errors: one false alarm in 8,000 runs, and none without a new seed.
#[test]
fn planes_are_those_of_the_processor_and_return_a() {
    for (name, material) in materials() {
        let is_lit_alike = !name.contains("searchlight");
        let found = both(&plane(material), 32);
        // The processor has the factor of oblique light in double precision: where light grazes, single precision is off more
        let bound = if ["oblique", "dipole, searchlight"].iter().any(|kind| name.contains(kind)) {
            1e-3
        } else {
            1e-5
        };
        assert!(differing(&found, bound) <= 0.02, "{name}: {} differ", differing(&found, bound));
        for c in 0..3 {
            let (mean, error) = mean_and_error(&found[1], c);
            let off = (mean - f64::from(COLOR[c])).abs();
            assert!(!is_lit_alike || off <= 4.5 * error + 1e-4, "{name}, channel {c}: {mean} ± {error}");
        }
    }
}

/// A ball that a block reaches into, one body, under a lamp: pixels are the processor's wherever rounding leads to the same hits.
#[test]
fn bodies_are_those_of_the_processor() {
    let radii: Vec<f64> = (0..8).map(|i| 0.02 * 2_f64.powi(i)).collect();
    let row = |surface_albedo: f64| ProfileRow {
        surface_albedo: Some(surface_albedo),
        reflectances: radii.iter().map(|r| surface_albedo * libm::exp(-r) / r).collect(),
        enclosed: radii.iter().map(|r| -surface_albedo * libm::expm1(-r)).collect(),
        radii: radii.clone(),
    };
    let file = ProfileTable { path: "table.csv".into(), rows: vec![row(0.3), row(0.9)] };
    let tabulated = Material { subsurface_model: SubsurfaceModel::Tabulated(0), ..profile(Model::Dipole) };
    for (name, material) in materials().into_iter().chain([("tabulated", tabulated)]) {
        let mut scene = scene(material.clone(), matte());
        scene.objects[1].material = 0;
        scene.objects[1].subsurface_group = 0;
        scene.profile_tables.push(file.clone());
        scene.lights.push(lamp());
        scene.lights.push(Light::Distant {
            direction: Vec3::NEG_ONE.normalize(),
            angular_radius: 0.0,
            irradiance: Vec3::ONE,
        });
        scene.integrator.subsurface_sharing = false;
        let found = both(&scene, 8);
        assert!(differing(&found, 1e-4) <= 0.03, "{name}: {} differ", differing(&found, 1e-4));
        let [ours, theirs] = found.map(|pixels| pixels.iter().sum::<Vec3>());
        assert!((ours - theirs).abs().max_element() <= 3e-3 * ours.max_element(), "{name}: {ours} {theirs}");
    }
}

/// A ball whose colors and lengths a texture and vertex colors vary, and a block of another material that reaches into it, one
/// body: whose parameters count shows, and pixels are the processor's wherever rounding leads to the same hits.
#[test]
fn textured_bodies_are_those_of_the_processor() {
    let map = TextureRef { image_from_uv: Affine2::from_scale(Vec2::new(3.0, 2.0)), ..TextureRef::new(0) };
    let textured = |model, subsurface_texture_at| Material {
        subsurface_color: ColorInput {
            texture: Some(map),
            vertex_color: true,
            ..ColorInput::constant(COLOR)
        },
        subsurface_radius: ScalarInput { factor: 0.5, texture: Some((map, Channel::Alpha)) },
        subsurface_texture_at,
        ..profile(model)
    };
    // In halves, as devices have texels
    let texel =
        |k: usize| [2 * (k % 8), 16 - k, 4 + k % 5, 6 + k / 4].map(|sixteenths| sixteenths as f32 / 16.0);
    let image = Image {
        color_space: ColorSpace::Linear,
        pixels: Pixels::Float((0..16).map(texel).collect()),
        ..texture()
    };
    let rendered = |model, at| {
        let mut scene = scene(textured(model, at), textured(model, at));
        scene.materials[1].subsurface_color.factor = Vec3::new(0.3, 0.5, 0.8);
        scene.objects[1].subsurface_group = 0;
        color_by_place(&mut scene.objects[0]);
        scene.images.push(Arc::new(image.clone()));
        scene.lights.push(lamp());
        scene.integrator.subsurface_sharing = false;
        both(&scene, 8)
    };
    let sums = |pixels: &Vec<Vec3>| pixels.iter().sum::<Vec3>();
    for model in [Model::NormalizedDiffusion, Model::NormalizedDiffusionOblique] {
        let [at_exit, _] = rendered(model, SubsurfaceTextureAt::Exit);
        for at in [SubsurfaceTextureAt::Entry, SubsurfaceTextureAt::Both] {
            let found = rendered(model, at);
            assert!(differing(&found, 1e-4) <= 0.03, "{model:?}, {at:?}: {} differ", differing(&found, 1e-4));
            let [ours, theirs] = found.each_ref().map(sums);
            let off = (ours - theirs).abs().max_element() / ours.max_element();
            assert!(off <= 3e-3, "{model:?}, {at:?}: {ours} {theirs}");
            let shown = differing(&[at_exit.clone(), found[0].clone()], 0.01);
            assert!(shown > 0.3, "{model:?}, {at:?}: {shown} differ from the exit's texture");
            println!(
                "{model:?}, {at:?}: {} differ, {shown} from the exit's texture",
                differing(&found, 1e-4)
            );
        }
    }
}

/// Light from below a normalized ball is A under an even sky, although the ball holds much less of the profile than a plane, and
/// pixels are the processor's to 1e-3: clusters of points are opened in another order there, the more of them stand in for their
/// points the larger the tolerance, and both sums are good to far less than that.
///
/// 12 comparisons with A within 4.5 standard errors and 1 %: less than one false alarm in 12,000 runs, and none without a new seed.
#[test]
fn normalized_shapes_return_a_as_on_the_processor() {
    for (model, tolerance) in [Model::NormalizedDiffusion, Model::Dipole]
        .into_iter()
        .flat_map(|model| [0.05, 0.3].map(|tolerance| (model, tolerance)))
    {
        let mut scene = plane(Material {
            subsurface_normalization: SubsurfaceNormalization::Energy,
            subsurface_radius: ScalarInput::constant(1.0),
            ..profile(model)
        });
        scene.objects = vec![shape("sphere", 1.0, Vec3::ZERO, 0, 0)];
        scene.camera.position = Vec3::new(0.0, 0.0, 1.5);
        scene.integrator.point_tolerance = tolerance;
        let found = both(&scene, 64);
        assert!(differing(&found, 1e-3) <= 0.03, "{model:?}: {} differ", differing(&found, 1e-3));
        scene.materials[0].subsurface_normalization = SubsurfaceNormalization::None;
        let bare = &both(&scene, 64)[1];
        for c in 0..3 {
            let (mean, error) = mean_and_error(&found[1], c);
            println!("{model:?} {c}: {mean} ± {error}, {} without", mean_and_error(bare, c).0);
            let off = (mean - f64::from(COLOR[c])).abs();
            let allowed = 4.5 * error + 0.01 * f64::from(COLOR[c]);
            assert!(off <= allowed, "{model:?}, channel {c}: {mean} ± {error}");
        }
        let lacking = f64::from(COLOR.x) - mean_and_error(bare, 0).0;
        assert!(lacking > 0.3, "{model:?}: {lacking} is made up for");
    }
}

/// The directional dipole is the processor's, for any surface albedo, length, offset and directions.
#[test]
fn directional_dipoles_are_those_of_the_processor() {
    let body = "
        let at = vec3f(inputs[i + 2], inputs[i + 3], inputs[i + 4]);
        let light = vec3f(inputs[i + 5], inputs[i + 6], inputs[i + 7]);
        let n_o = vec3f(inputs[i + 8], inputs[i + 9], inputs[i + 10]);
        outputs[o] = dipole_density(0u, inputs[i], inputs[i + 1], at, light, vec3f(0.0, 0.0, 1.0), n_o);";
    let [kernel, formulas] =
        ["const REFRACTION_ETA = 6u; const IS_DMFP = 2u;", &translucid_export::directional_formulas()];
    let [laws, tables] = LAWS;
    let shaders = [include_str!("shaders/directional_dipole.wgsl"), kernel, formulas, laws, tables];
    let mut random = translucid_testing::SplitMix(11);
    let (mut worst, mut strict) = (0.0_f32, 0);
    for (eta, g, parameterization) in [
        (1.4, 0.0, Parameterization::Mfp),
        (1.4, 0.8, Parameterization::Dmfp),
        (1.0, -0.3, Parameterization::Mfp),
        (0.8, 0.0, Parameterization::Dmfp),
    ] {
        let dipoles = DirectionalDipoleTable::new(eta, g, parameterization).unwrap();
        let (mut six, table) = dipoles.words();
        six[0] = 7.0;
        let tables = [&[2.0], &six[..], &table].concat();
        let mut input = || {
            let mut unit = || loop {
                let v = Vec3::from_array([(); 3].map(|()| 2.0 * random.uniform_f32() - 1.0));
                if (0.01..1.0).contains(&v.length_squared()) {
                    break v.normalize();
                }
            };
            let [offset, mut light, normal] = [unit(), unit(), unit()];
            light.z = light.z.abs().max(0.02);
            let albedo = random.uniform_f32().clamp(1e-3, 0.999);
            let length = 10f32.powf(6.0 * random.uniform_f32() - 3.0);
            let way = offset * length * 10f32.powf(4.0 * random.uniform_f32() - 2.5);
            let [light, normal] = [light.normalize().to_array(), normal.to_array()];
            [&[albedo, length], &way.to_array()[..], &light, &normal].concat()
        };
        let inputs: Vec<Vec<f32>> = (0..4000).map(|_| input()).collect();
        let evaluation =
            Evaluation { shaders: &shaders, body, tables: &tables, images: &[0], widths: [11, 1] };
        let found = evaluation.run(&inputs.concat());
        for (input, found) in inputs.iter().zip(found) {
            let dipole = dipoles.at(input[0], input[1]);
            let [way, light, n_o]: [[f32; 3]; 3] = [2, 5, 8].map(|at| input[at..at + 3].try_into().unwrap());
            let r = Vec3::from(way).length();
            let up = [0.0, 0.0, 1.0];
            let eval = |way, light, n_o| TAU * r * dipole.eval(way, light, up, n_o);
            let expected = eval(way, light, n_o);
            // Where the sources' parts cancel, rounding is that of either, which is about as large as along the normal
            let size = TAU * r * dipole.eval([r, 0.0, 0.0], up, up, up);
            // Inputs that are rounded once more
            let spread = (0..9).map(|k| {
                let mut moved = [way, light, n_o];
                moved[k / 3][k % 3] += f32::EPSILON * if k < 3 { r } else { 1.0 };
                (eval(moved[0], moved[1], moved[2]) - expected).abs()
            });
            let allowed = 1e-5 * expected.max(size) + 2.0 * spread.fold(0.0, f32::max);
            let off = (found - expected).abs();
            worst = worst.max(off / allowed);
            strict += usize::from(off > 1e-5 * expected.max(size));
            assert!(off <= allowed, "{eta} {g} {input:?}: {found}, not {expected} ± {allowed}");
        }
    }
    println!("worst {worst} of what is allowed; {strict} of 16,000 are beyond 1e-5 by their inputs alone");
}
