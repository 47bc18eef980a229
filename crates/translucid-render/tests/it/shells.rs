//! Walks through layers that follow a body's surface, against exact layers, an independent walk through concentric shells,
//! and walks through one medium.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors: a false alarm in 2,700 comparisons, see
//! `random_walk`. What planes and slabs return is known to 0.5 % or better at the whole power, by one standard error.

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use translucid_profile::{AlbedoInversion, Configuration, Parameterization};
use translucid_reference::Incidence;
use translucid_reference::layers::{Ground, Layer, Layers, Totals};
use translucid_render::PixelSample;
use translucid_scene::{
    ColorInput, LayerMedium, Light, Material, Mesh, Object, ScalarInput, Scene, SubsurfaceLayer,
    SubsurfaceModel, WalkSurface,
};
use translucid_testing::{SplitMix, is_thorough, power};

use crate::common::{
    assert_agree, assert_within, distant, flux_of, matte, measure, prepare, quad, samples, scene, sphere,
    uniform_environment,
};

const ALBEDO: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.3);

pub(crate) fn material(surface: WalkSurface, layers: Vec<SubsurfaceLayer>) -> Material {
    Material {
        name: "layered".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: SubsurfaceModel::RandomWalk(surface),
        layers,
        ..Material::default()
    }
}

/// The material below a smooth interface of its own index, with the mean cosine `g`.
fn dielectric(eta: f32, g: f32, layers: Vec<SubsurfaceLayer>) -> Material {
    Material {
        specular_weight: ScalarInput::constant(1.0),
        specular_ior: eta,
        specular_roughness: ScalarInput::constant(0.0),
        subsurface_eta: eta,
        subsurface_scatter_anisotropy: g,
        ..material(WalkSurface::Clear, layers)
    }
}

pub(crate) fn coefficients(
    thickness: f32,
    scattering: [f32; 3],
    absorption: [f32; 3],
    g: f32,
) -> SubsurfaceLayer {
    let medium = LayerMedium::Coefficients { scattering: scattering.into(), absorption: absorption.into() };
    SubsurfaceLayer { thickness, medium, g }
}

/// A dense dark layer over one that is clearer than what is behind it.
pub(crate) fn skin(g: f32) -> Vec<SubsurfaceLayer> {
    let surface_albedo = Vec3::new(0.6, 0.4, 0.7);
    let medium = LayerMedium::Appearance { surface_albedo, mfp: Vec3::new(0.3, 0.5, 0.4) };
    vec![
        coefficients(0.15, [6.0, 3.0, 1.0], [0.4, 1.0, 3.0], g),
        SubsurfaceLayer { thickness: 0.5, medium, g: 0.0 },
        coefficients(0.4, [0.1, 0.0, 0.5], [0.02, 0.0, 0.0], 0.5 * g),
    ]
}

/// The innermost medium of a channel, of the mean cosine g below a boundary of the index that the walk reflects at.
pub(crate) fn innermost(c: usize, g: f32, eta: f32, thickness: f64) -> Layer {
    let inversion = AlbedoInversion::new(g.into(), eta.into(), Configuration::Diffuse).unwrap();
    let (albedo, length) = (f64::from(ALBEDO[c]), f64::from(LENGTH[c]));
    Layer::from_surface_albedo(&inversion, albedo, length, Parameterization::Mfp, thickness).unwrap()
}

/// A layer's medium in a channel.
pub(crate) fn exact_layer(layer: &SubsurfaceLayer, c: usize) -> Layer {
    let thickness = f64::from(layer.thickness);
    match layer.medium {
        LayerMedium::Coefficients { scattering, absorption } => {
            Layer::new(scattering[c].into(), absorption[c].into(), thickness).with_g(layer.g.into())
        }
        LayerMedium::Appearance { surface_albedo, mfp } => {
            let inversion = AlbedoInversion::new(layer.g.into(), 1.0, Configuration::Diffuse).unwrap();
            let (albedo, mfp) = (surface_albedo[c].into(), mfp[c].into());
            Layer::from_surface_albedo(&inversion, albedo, mfp, Parameterization::Mfp, thickness).unwrap()
        }
    }
}

/// What exact layers make of light: those of a material on its innermost medium, and below that, in a slab, the same again.
fn totals(material: &Material, inner_thickness: f64, incidence: Incidence) -> [Totals; 3] {
    let (g, eta) = (material.subsurface_scatter_anisotropy, material.subsurface_eta);
    [0, 1, 2].map(|c| {
        let shells = material.layers.iter().map(|layer| exact_layer(layer, c));
        let mut all: Vec<Layer> = shells.clone().collect();
        all.push(innermost(c, g, eta, inner_thickness));
        let ground = if inner_thickness.is_finite() {
            all.extend(shells.rev());
            Ground::AIR
        } else {
            Ground::None
        };
        let all = all.into_iter().map(|layer| layer.with_eta(eta.into())).collect();
        Layers::new(1.0, all, ground).unwrap().totals(incidence).unwrap()
    })
}

pub(crate) fn per_channel(f: impl Fn(usize) -> f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|c| f(c) as f32))
}

fn scaled((mean, error): (Vec3, Vec3), factor: f32) -> (Vec3, Vec3) {
    (mean * factor, error * factor)
}

/// A point of a plane on no edge.
pub(crate) fn on_plane(_: [f64; 2]) -> (Vec3, Vec3) {
    (Vec3::new(3.3, 1.1, 0.0), Vec3::Z)
}

pub(crate) fn plane(material: Material) -> Scene {
    scene(vec![quad(Vec3::ZERO, Vec3::X * 2e3, Vec3::Y * 2e3)], material)
}

fn slab(thickness: f32, material: Material) -> Scene {
    let top = quad(Vec3::ZERO, Vec3::X * 2e3, Vec3::Y * 2e3);
    let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 2e3, Vec3::X * 2e3);
    scene(vec![top, bottom], material)
}

/// [`assert_within`], with standard errors below 0.5 % at the whole power.
fn assert_exact(name: &str, result: (Vec3, Vec3), expected: Vec3) {
    assert_within(name, result, expected);
    let precision = result.1 / expected;
    assert!(!is_thorough() || precision.max_element() < 5e-3, "{name}: not precise: {precision}");
}

/// A half space in the same light from everywhere returns what exact layers do.
#[test]
fn plane_in_diffuse_light_returns_that_of_exact_layers() {
    let matched =
        |surface, g: f32, layers| Material { subsurface_scatter_anisotropy: g, ..material(surface, layers) };
    for (name, material) in [
        ("clear", matched(WalkSurface::Clear, 0.0, skin(0.0))),
        ("clear, g 0.8", matched(WalkSurface::Clear, 0.8, skin(0.8))),
        ("diffuse, g 0.8", matched(WalkSurface::Diffuse, 0.8, skin(0.8))),
        ("clear, g 0.6, eta 1.4", dielectric(1.4, 0.6, skin(0.6))),
    ] {
        let exact = totals(&material, f64::INFINITY, Incidence::Cosine);
        let mut scene = plane(material);
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        assert!(renderer.notes().is_empty(), "{:?}", renderer.notes());
        let result = flux_of(|sample| sample.subsurface, &renderer, samples(1 << 19), on_plane);
        assert_exact(name, result, per_channel(|c| exact[c].diffuse_reflectance));
    }
}

/// A slab in the same light from both sides, of which light comes through, too.
#[test]
fn slab_in_diffuse_light_returns_that_of_exact_layers() {
    for (name, material, thickness) in [
        ("clear", material(WalkSurface::Clear, skin(0.3)), 2.6_f32),
        ("thin, unlike g", material(WalkSurface::Clear, skin(-0.4)[..1].to_vec()), 0.9),
    ] {
        let shells: f64 = material.layers.iter().map(|layer| f64::from(layer.thickness)).sum();
        let exact = totals(&material, f64::from(thickness) - 2.0 * shells, Incidence::Cosine);
        let mut scene = slab(thickness, material);
        scene.environment = uniform_environment(Vec3::ONE);
        let result = flux_of(PixelSample::radiance, &prepare(scene), samples(1 << 19), on_plane);
        assert_exact(name, result, per_channel(|c| 1.0 - exact[c].absorbed.iter().sum::<f64>()));
    }
}

/// Of a body that is thinner than two of its layers only the layer is there.
#[test]
fn layer_thicker_than_the_body_is_alone() {
    for thick in [3.0_f32, 1e9] {
        let layers = vec![coefficients(thick, [3.0, 2.0, 1.0], [0.1, 0.3, 0.6], 0.5), skin(0.0)[0]];
        let mut scene = slab(1.5, material(WalkSurface::Clear, layers.clone()));
        scene.environment = uniform_environment(Vec3::ONE);
        let result = flux_of(PixelSample::radiance, &prepare(scene), samples(1 << 18), on_plane);
        let expected = per_channel(|c| {
            let layer = Layer { thickness: 1.5, ..exact_layer(&layers[0], c) };
            let layers = Layers::new(1.0, vec![layer], Ground::AIR).unwrap();
            1.0 - layers.totals(Incidence::Cosine).unwrap().absorbed[0]
        });
        assert_within(&format!("{thick}"), result, expected);
    }
}

/// A layer of hardly any thickness is not seen.
#[test]
fn thin_layer_leaves_the_innermost_medium() {
    let layers = vec![coefficients(2e-4, [1.0, 2.0, 0.5], [0.5, 0.1, 2.0], 0.9)];
    let mut scene = plane(material(WalkSurface::Clear, layers));
    scene.environment = uniform_environment(Vec3::ONE);
    let result = flux_of(PixelSample::radiance, &prepare(scene), samples(1 << 18), on_plane);
    assert_within("thin", result, ALBEDO);
}

/// A layer on a black body is seen.
#[test]
fn bright_layer_on_a_black_body_is_seen() {
    let layer = coefficients(0.5, [4.0, 2.0, 1.0], [0.0, 0.1, 1.0], 0.2);
    let mut material = material(WalkSurface::Clear, vec![layer]);
    material.subsurface_color = ColorInput::constant(Vec3::ZERO);
    let mut scene = plane(material);
    scene.environment = uniform_environment(Vec3::ONE);
    let result = flux_of(PixelSample::radiance, &prepare(scene), samples(1 << 18), on_plane);
    let expected = per_channel(|c| {
        let layers = Layers::new(1.0, vec![exact_layer(&layer, c)], Ground::BLACK).unwrap();
        layers.totals(Incidence::Cosine).unwrap().diffuse_reflectance
    });
    assert_within("black", result, expected);
}

/// Layers of the body's own medium are the body.
#[test]
fn equal_layers_are_one_medium() {
    for surface in [WalkSurface::Clear, WalkSurface::Rough] {
        let medium = LayerMedium::Appearance { surface_albedo: ALBEDO, mfp: LENGTH };
        let layer = SubsurfaceLayer { thickness: 0.3, medium, g: 0.0 };
        let pictures = [vec![], vec![layer, layer]].map(|layers| {
            let mut material = material(surface, layers);
            material.subsurface_eta = if surface == WalkSurface::Rough { 1.4 } else { 1.0 };
            let mut scene = scene(vec![sphere(2.0, 32)], material);
            scene.environment = uniform_environment(Vec3::splat(0.5));
            scene.lights.push(distant(Vec3::new(1.0, 0.4, 0.3)));
            measure(&prepare(scene), Vec3::new(0.6, 0.7, 9.0), Vec3::NEG_Z, samples(1 << 18))
        });
        assert_agree(&format!("{surface:?}"), pictures[1], pictures[0]);
    }
}

/// Light from one direction reaches collisions refracted.
#[test]
fn dielectric_plane_in_parallel_light_returns_that_of_exact_layers() {
    for cosine in [1.0_f32, 0.4] {
        let material = dielectric(1.4, 0.3, skin(0.3));
        let exact = totals(&material, f64::INFINITY, Incidence::Pencil { cos_theta: cosine.into() });
        let mut scene = plane(material);
        scene.lights.push(distant(Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)));
        let result = flux_of(|sample| sample.subsurface, &prepare(scene), samples(1 << 18), on_plane);
        let expected = per_channel(|c| exact[c].diffuse_reflectance * f64::from(cosine));
        assert_within(&format!("cos {cosine}"), scaled(result, PI), expected);
    }
}

/// A lamp shines through a slab onto a floor: shadow rays pass the slab straight, as paths do.
#[test]
fn slab_lets_through_what_exact_layers_do() {
    let thickness = 2.4_f32;
    let layered = material(WalkSurface::Clear, skin(0.3));
    let shells: f64 = layered.layers.iter().map(|layer| f64::from(layer.thickness)).sum();
    for cosine in [1.0_f32, 0.5] {
        let incidence = Incidence::Pencil { cos_theta: cosine.into() };
        let exact = totals(&layered, f64::from(thickness) - 2.0 * shells, incidence);
        let mut scene = slab(thickness, layered.clone());
        scene.materials.push(matte(Vec3::splat(1e-3)));
        let mut floor = quad(Vec3::NEG_Z * 5.0, Vec3::X * 500.0, Vec3::Y * 500.0);
        floor.positions.iter_mut().for_each(|p| p.z -= 1.0);
        scene.objects.push(Object {
            mesh: floor.into(),
            material: 1,
            subsurface_group: 1,
            ..Object::default()
        });
        scene.lights.push(distant(Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)));
        (scene.integrator.max_depth, scene.integrator.max_diffuse_depth) = (8, 8);
        let from = Vec3::new(3.3, 1.1, -4.0);
        let result = measure(&prepare(scene), from, Vec3::new(0.2, 0.1, -1.0).normalize(), samples(1 << 19));
        let expected = per_channel(|c| {
            let Totals { collimated_transmittance, diffuse_transmittance, .. } = exact[c];
            (collimated_transmittance + diffuse_transmittance) * f64::from(cosine)
        });
        assert_within(&format!("cos {cosine}"), scaled(result, PI * 1e3), expected);
    }
}

/// A body that absorbs nothing cannot be seen in a closed box that shines: light samples and paths find the light of near
/// lamps together.
#[test]
fn white_layers_in_a_box_of_light_cannot_be_seen() {
    let layers = vec![
        coefficients(0.1, [9.0, 5.0, 1.0], [0.0; 3], 0.5),
        coefficients(0.3, [0.1, 0.5, 2.0], [0.0; 3], -0.3),
    ];
    for eta in [1.0, 1.4] {
        let mut material = material(WalkSurface::Clear, layers.clone());
        material.subsurface_color = ColorInput::constant(Vec3::ONE);
        material.subsurface_eta = eta;
        let mut scene = scene(vec![sphere(1.2, 24)], material);
        (scene.integrator.max_depth, scene.integrator.max_diffuse_depth) = (64, 64);
        for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
            let (x, y) = normal.any_orthonormal_pair();
            // Facing inward
            let (x, y) = if x.cross(y).dot(normal) < 0.0 { (x, y) } else { (y, x) };
            let (center, edge_x, edge_y) = (normal * 1.5, x * 3.0, y * 3.0);
            scene.lights.push(Light::Rectangle {
                center,
                edge_x,
                edge_y,
                radiance: Vec3::ONE,
                visible: true,
            });
        }
        let result = measure(
            &prepare(scene),
            Vec3::new(0.2, 0.3, 1.4),
            Vec3::new(0.1, -0.2, -1.0).normalize(),
            samples(1 << 15),
        );
        assert_within(&format!("eta {eta}"), result, Vec3::ONE);
    }
}

/// What is not as stated is said.
#[test]
fn notes_tell_what_layers_cannot_do() {
    let layers = vec![coefficients(0.1, [1.0; 3], [1.0; 3], 0.0)];
    let notes = |move_to: Vec3, layers: &[SubsurfaceLayer], offset: f32| {
        let meshes = [Vec3::ZERO, Vec3::X * offset].map(|shift| {
            let mut mesh = sphere(1.0, 8);
            mesh.positions.iter_mut().for_each(|p| *p += move_to + shift);
            mesh
        });
        let scene = scene(meshes.to_vec(), material(WalkSurface::Clear, layers.to_vec()));
        prepare(scene).notes().into_iter().map(|note| note.message).collect::<Vec<_>>()
    };
    assert_eq!(notes(Vec3::ZERO, &layers, 3.0), Vec::<String>::new());
    let overlapping = notes(Vec3::ZERO, &layers, 1.5);
    assert!(overlapping.len() == 1 && overlapping[0].starts_with("objects object and object may overlap"));
    let far = notes(Vec3::X * 1e5, &layers, 3.0);
    assert!(far.len() == 1 && far[0].contains("does not resolve such layers"), "{far:?}");
    // Around the origin, too
    for layer in [coefficients(1e-8, [1.0; 3], [1.0; 3], 0.0), coefficients(0.1, [1e6; 3], [1.0; 3], 0.0)] {
        let around = notes(Vec3::ZERO, &[layer], 3.0);
        assert!(around.len() == 1 && around[0].contains("make them thicker or less dense"), "{around:?}");
    }
}

/// Light passes the rim of a body that is clear around what is black.
#[test]
fn clear_layer_around_a_black_core_is_seen_through() {
    let layered = material(WalkSurface::Clear, vec![coefficients(0.3, [0.0; 3], [0.0; 3], 0.0)]);
    let black = Material { subsurface_color: ColorInput::constant(Vec3::ZERO), ..layered };
    let mut scene = scene(vec![sphere(2.0, 64)], black);
    scene.environment = uniform_environment(Vec3::ONE);
    let (mean, error) = measure(&prepare(scene), Vec3::new(1.85, 0.0, 9.0), Vec3::NEG_Z, samples(1 << 14));
    assert!(((mean - 1.0).abs() - 4.0 * error).max_element() < 1e-3, "{mean} {error}");
}

/// A medium of the slow walk in one channel.
#[derive(Clone, Copy)]
struct Medium {
    sigma_t: f64,
    alpha: f64,
    g: f64,
}

impl From<Layer> for Medium {
    fn from(layer: Layer) -> Self {
        let sigma_t = layer.extinction();
        Self { sigma_t, alpha: layer.scattering / sigma_t.max(1e-300), g: layer.phase_function.moment(1) }
    }
}

/// Distance along a ray to a sphere around the origin; infinite where it is missed.
fn to_sphere(from: DVec3, direction: DVec3, radius: f64) -> f64 {
    let (b, c) = (from.dot(direction), from.length_squared() - radius * radius);
    let root = (b * b - c).sqrt();
    let hits = [-b - root, -b + root];
    hits.into_iter().find(|t| *t > 1e-9).unwrap_or(f64::INFINITY)
}

/// Photons of parallel light along −z on concentric shells, each with its outer radius, from outside in: part of those on the
/// cross section that leaves scattered, by equal rings in z, with standard errors.
fn slow_walk<const RINGS: usize>(shells: &[(f64, Medium)], photons: u64, seed: u64) -> [(f64, f64); RINGS] {
    let mut random = SplitMix(seed);
    let mut sums = [[0.0; 2]; RINGS];
    let radius = shells[0].0;
    for _ in 0..photons {
        let (r, phi) = (radius * random.uniform().sqrt(), std::f64::consts::TAU * random.uniform());
        let (x, y) = (r * phi.cos(), r * phi.sin());
        let mut at = DVec3::new(x, y, (radius * radius - r * r).sqrt());
        let (mut direction, mut weight) = (DVec3::NEG_Z, 1.0);
        let mut depth = -random.uniform().ln_1p_negative();
        let mut has_scattered = false;
        let ring = loop {
            // The shell just ahead
            let ahead = (at + direction * 1e-9).length();
            let shell = shells.iter().rposition(|(radius, _)| ahead < *radius);
            let Some(shell) = shell else {
                break Some((((1.0 - at.z / radius) * 0.5 * RINGS as f64) as usize).min(RINGS - 1));
            };
            let medium = shells[shell].1;
            let spheres = shells.iter().map(|(radius, _)| to_sphere(at, direction, *radius));
            let end = spheres.fold(f64::INFINITY, f64::min);
            if depth > end * medium.sigma_t {
                depth -= end * medium.sigma_t;
                at += direction * end;
                continue;
            }
            at += direction * (depth / medium.sigma_t);
            (weight, has_scattered) = (weight * medium.alpha, true);
            if weight < 0.1 {
                if random.uniform() > weight {
                    break None;
                }
                weight = 1.0;
            }
            direction = deflect(direction, medium.g, &mut random);
            depth = -random.uniform().ln_1p_negative();
        };
        if let Some(ring) = ring.filter(|_| has_scattered) {
            sums[ring][0] += weight;
            sums[ring][1] += weight * weight;
        }
    }
    let n = photons as f64;
    sums.map(|[sum, squares]| (sum / n, ((squares / n - (sum / n).powi(2)) / n).sqrt()))
}

/// ln(1 − u) without a NaN.
trait Ln {
    fn ln_1p_negative(self) -> f64;
}

impl Ln for f64 {
    fn ln_1p_negative(self) -> f64 {
        (-self.min(1.0 - f64::EPSILON)).ln_1p()
    }
}

/// Turns by Henyey and Greenstein's phase function.
fn deflect(direction: DVec3, g: f64, random: &mut SplitMix) -> DVec3 {
    let u = random.uniform();
    let cosine = if g.abs() < 1e-6 {
        1.0 - 2.0 * u
    } else {
        (1.0 + g * g - ((1.0 - g * g) / (1.0 - g + 2.0 * g * u)).powi(2)) / (2.0 * g)
    };
    let (sine, phi) = ((1.0 - cosine * cosine).max(0.0).sqrt(), std::f64::consts::TAU * random.uniform());
    let (a, b) = direction.any_orthonormal_pair();
    (a * (sine * phi.cos()) + b * (sine * phi.sin()) + direction * cosine).normalize()
}

/// A sphere in parallel light, by rings. The facets of the mesh lie 1e-4 below the sphere on average.
#[test]
fn sphere_agrees_with_a_slow_walk_through_concentric_shells() {
    const RINGS: usize = 5;
    let radius = 2.0_f32;
    for (g, layers) in
        [(0.0, skin(0.7)), (0.5, vec![skin(0.0)[1], coefficients(0.8, [0.0; 3], [0.0; 3], 0.0)])]
    {
        let layered = Material { subsurface_scatter_anisotropy: g, ..material(WalkSurface::Clear, layers) };
        let expected: [[(f64, f64); RINGS]; 3] = std::array::from_fn(|c| {
            let mut shells = Vec::new();
            let mut outer = f64::from(radius);
            for layer in &layered.layers {
                shells.push((outer, Medium::from(exact_layer(layer, c))));
                outer -= f64::from(layer.thickness);
            }
            shells.push((outer, innermost(c, g, 1.0, 1.0).into()));
            slow_walk(&shells, power(800_000), 7 + c as u64)
        });
        let mut scene = scene(vec![sphere(radius, 96)], layered);
        scene.lights.push(distant(Vec3::Z));
        let renderer = prepare(scene);
        for ring in [0, 2, 4] {
            let place = |[x, y]: [f64; 2]| {
                let z = 1.0 - 2.0 * (ring as f64 + x) / RINGS as f64;
                let (r, phi) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * y);
                let normal = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32).normalize();
                (normal * radius, normal)
            };
            let result = flux_of(PixelSample::radiance, &renderer, samples(1 << 16), place);
            // Light on the cross section πρ² that leaves through the area 4πρ²/n
            let factor = RINGS as f32 / 4.0;
            let expected = (
                per_channel(|c| expected[c][ring].0) * factor,
                per_channel(|c| expected[c][ring].1) * factor,
            );
            let result = scaled(result, PI);
            assert_agree(&format!("g {g}, ring {ring}"), result, expected);
        }
    }
}

/// A mesh that several objects share is as its own.
#[test]
fn shared_meshes_have_layers() {
    let mesh: std::sync::Arc<Mesh> = sphere(1.0, 64).into();
    let measured = |is_movable: bool| {
        let mut scene = scene(vec![], material(WalkSurface::Clear, skin(0.3)));
        let scale = glam::Affine3A::from_scale_rotation_translation(
            Vec3::splat(2.0),
            glam::Quat::from_rotation_x(0.3),
            Vec3::new(4.0, -1.0, 0.5),
        );
        let (mesh, world_from_local) = match is_movable {
            true => (std::sync::Arc::clone(&mesh), scale),
            false => (Mesh::clone(&mesh).transformed(&scale).into(), glam::Affine3A::IDENTITY),
        };
        scene.objects.push(Object { mesh, world_from_local, is_movable, ..Object::default() });
        scene.environment = uniform_environment(Vec3::ONE);
        measure(&prepare(scene), Vec3::new(4.3, -0.6, 9.0), Vec3::NEG_Z, samples(1 << 17))
    };
    assert_agree("movable", measured(true), measured(false));
}
