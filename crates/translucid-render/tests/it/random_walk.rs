//! The random walk against exact answers and an independent walk.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors, which come from 32 blocks of samples:
//! by Student's t a false alarm in 2,700 per comparison, and below 3 % over the 75 comparisons of this file.

use std::sync::LazyLock;

use glam::Vec3;
use translucid_profile::{AlbedoInversion, Configuration, half_space_surface_albedo};
use translucid_reference::body::{Body, Interior, Lighting, SPHERE_RINGS, Shape, Tally};
use translucid_reference::exact::{HalfSpace, ObliqueHalfSpace};
use translucid_reference::{Estimate, Incidence};
use translucid_render::PixelSample;
use translucid_render::internals::bsdf::{Ggx, fresnel_dielectric};
use translucid_scene::{
    ColorInput, Environment, Light, Material, Mesh, Object, ScalarInput, Scene, SubsurfaceModel,
    SubsurfaceParameter, WalkSurface,
};
use translucid_testing::{SplitMix, power};

use crate::common::{
    GRAY, PreparedScene, assert_agree, assert_within, distant, even, flux_of, matte, measure, on_threads,
    picture, prepare, quad, samples, scene, sphere, uniform_environment,
};

const ALBEDO: Vec3 = Vec3::new(0.9, 0.5, 0.05);
const LENGTH: Vec3 = Vec3::new(1.0, 0.6, 0.4);

/// A translucent material without a specular interface, walked through.
fn material() -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: SubsurfaceModel::RandomWalk(WalkSurface::Clear),
        ..Material::default()
    }
}

fn white(material: Material) -> Material {
    Material { subsurface_color: ColorInput::constant(Vec3::ONE), ..material }
}

fn plane(material: Material) -> Scene {
    scene(vec![quad(Vec3::ZERO, Vec3::X * 2e3, Vec3::Y * 2e3)], material)
}

/// α of each channel of the material above, without a boundary.
static SINGLE_SCATTERING_ALBEDOS: LazyLock<[f64; 3]> = LazyLock::new(|| {
    let inversion = AlbedoInversion::new(0.0, 1.0, Configuration::Diffuse).unwrap();
    ALBEDO.to_array().map(|a| inversion.single_scattering_albedo(f64::from(a)))
});

fn per_channel(f: impl Fn(usize) -> f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|c| f(c) as f32))
}

/// Mean radiance over cosine-distributed directions, which is the radiosity over π, at points with a normal that `place`
/// draws by two random numbers.
fn flux(renderer: &PreparedScene, samples: u32, place: impl Fn([f64; 2]) -> (Vec3, Vec3)) -> (Vec3, Vec3) {
    flux_of(PixelSample::radiance, renderer, samples, place)
}

/// Light from everywhere that the camera sees, too.
fn seen(radiance: Vec3) -> Option<Environment> {
    uniform_environment(radiance).map(|environment| Environment { visible: true, ..environment })
}

/// A point of a plane on no edge.
fn on_plane(_: [f64; 2]) -> (Vec3, Vec3) {
    (Vec3::new(3.3, 1.1, 0.0), Vec3::Z)
}

fn scaled((mean, error): (Vec3, Vec3), factor: f32) -> (Vec3, Vec3) {
    (mean * factor, error * factor)
}

/// With a boundary but no interface above, nothing weighs light by Fresnel's transmittance on its way to the camera: that
/// is below 8e-4 in A for these media by the solution of the transfer equation, a third of a standard error here.
#[test]
fn plane_under_uniform_light_returns_surface_albedo() {
    for (g, eta, parameter) in [
        (0.0, 1.0, SubsurfaceParameter::Mfp),
        (0.0, 1.0, SubsurfaceParameter::Dmfp),
        (0.8, 1.0, SubsurfaceParameter::Mfp),
        (0.0, 1.4, SubsurfaceParameter::Mfp),
        (0.8, 1.4, SubsurfaceParameter::Mfp),
    ] {
        let mut material = material();
        material.subsurface_scatter_anisotropy = g;
        material.subsurface_eta = eta;
        material.subsurface_parameter = parameter;
        let mut scene = plane(material);
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        assert!(renderer.notes().is_empty(), "{:?}", renderer.notes());
        let result = flux(&renderer, samples(1 << 17), on_plane);
        assert_within(&format!("g {g} eta {eta} {parameter:?}"), result, ALBEDO);
    }
}

/// Seen from one direction a half space shows the albedo of a pencil that enters there.
#[test]
fn plane_seen_along_the_normal_returns_the_albedo_of_a_pencil() {
    let mut scene = plane(material());
    scene.environment = uniform_environment(Vec3::ONE);
    let alphas = *SINGLE_SCATTERING_ALBEDOS;
    let expected = per_channel(|c| half_space_surface_albedo(alphas[c], Configuration::Searchlight));
    let result = measure(&prepare(scene), Vec3::new(3.3, 1.1, 1.0), Vec3::NEG_Z, 1 << 15);
    assert_within("normal", result, expected);
}

/// In the middle of a perpendicular beam, the light that leaves is a pencil's light within the beam's radius.
#[test]
fn beam_returns_the_enclosed_energy_of_the_exact_profile() {
    let half_spaces =
        SINGLE_SCATTERING_ALBEDOS.map(|alpha| HalfSpace::new(alpha, Incidence::NORMAL).unwrap());
    for radius in [0.2_f32, 0.6, 1.5, 4.0] {
        let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 200.0, Vec3::Y * 200.0)], material());
        let irradiance = 1.0 / (std::f32::consts::PI * radius * radius);
        let origin = Vec3::new(3.3, 1.1, 50.0);
        scene.lights.push(Light::Beam { origin, direction: Vec3::NEG_Z, radius, power: Vec3::ONE });
        let expected = per_channel(|c| half_spaces[c].enclosed(f64::from(radius / LENGTH[c])).value);
        let result = flux(&prepare(scene), samples(1 << 16), on_plane);
        let result = scaled(result, std::f32::consts::PI / irradiance);
        assert_within(&format!("radius {radius}"), result, expected);
    }
}

/// Every path out of a body that absorbs nothing ends in the same light.
#[test]
fn white_body_in_uniform_light_cannot_be_seen() {
    for (g, eta) in [(0.0, 1.0), (0.7, 1.0), (0.0, 1.5)] {
        let mut material = white(material());
        material.subsurface_scatter_anisotropy = g;
        material.subsurface_eta = eta;
        let mut scene = scene(vec![sphere(3.0, 24)], material);
        scene.integrator.max_depth = 64;
        scene.integrator.max_diffuse_depth = 64;
        scene.environment = seen(Vec3::new(1.0, 0.7, 0.2));
        let renderer = prepare(scene);
        for (origin, toward) in
            [(Vec3::X * 9.0, Vec3::ZERO), (Vec3::new(9.0, 1.0, 2.0), Vec3::new(0.0, 2.5, 0.5))]
        {
            let result = measure(&renderer, origin, (toward - origin).normalize(), 1 << 13);
            assert_within(&format!("g {g} eta {eta}"), result, Vec3::new(1.0, 0.7, 0.2));
        }
    }
}

/// Photons of an independent walk in each channel's medium: enough to be a little surer than the samples that they judge.
fn independent(shape: impl Fn(f64) -> Shape, light: Lighting, photons: u64, seed: u64) -> [Tally; 3] {
    [0, 1, 2].map(|c| {
        let medium = Interior { single_scattering_albedo: SINGLE_SCATTERING_ALBEDOS[c], g: 0.0, eta: 1.0 };
        let shape = shape(f64::from(LENGTH[c]).recip());
        Body::new(shape, medium, light).unwrap().walk(power(photons), seed)
    })
}

/// Values and errors of the channels.
fn estimates(estimate: impl Fn(usize) -> Estimate) -> (Vec3, Vec3) {
    (per_channel(|c| estimate(c).value), per_channel(|c| estimate(c).error))
}

/// A slab in the same light from both sides, with and without unscattered light, against an independent walk: a camera that
/// does not see the environment sees it through the slab all the same, as through clear glass.
#[test]
fn slab_agrees_with_an_independent_walk() {
    let thickness = 1.2_f32;
    let top = quad(Vec3::ZERO, Vec3::X * 2e3, Vec3::Y * 2e3);
    let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 2e3, Vec3::X * 2e3);
    let mut scene = scene(vec![top, bottom], material());
    let slab = |scale| Shape::Slab { thickness: f64::from(thickness) * scale };
    let tallies = independent(slab, Lighting::Uniform, 400_000, 1);
    for environment in [uniform_environment(Vec3::ONE), seen(Vec3::ONE)] {
        scene.environment = environment;
        let renderer = prepare(scene.clone());
        let result = flux_of(|sample| sample.subsurface, &renderer, samples(1 << 15), on_plane);
        assert_agree("scattered", result, estimates(|c| tallies[c].scattered()));
        let result = flux(&renderer, samples(1 << 15), on_plane);
        assert_agree("all", result, estimates(|c| tallies[c].leaving()));
    }
}

/// A sphere in parallel light, by rings, against an independent walk. The mesh has 0.1 % less surface than the sphere.
#[test]
fn sphere_agrees_with_an_independent_walk() {
    let radius = 2.0_f32;
    let mut scene = scene(vec![sphere(radius, 96)], material());
    scene.lights.push(distant(Vec3::Z));
    let renderer = prepare(scene);
    let ball = |scale| Shape::Sphere { radius: f64::from(radius) * scale };
    let tallies = independent(ball, Lighting::Distant, 1_600_000, 2);
    for ring in [0, 3, 5, 7, 9] {
        let place = |[x, y]: [f64; 2]| {
            let z = 1.0 - 2.0 * (ring as f64 + x) / SPHERE_RINGS as f64;
            let (r, phi) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * y);
            let normal = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32).normalize();
            (normal * radius, normal)
        };
        let result = scaled(flux(&renderer, samples(1 << 15), place), std::f32::consts::PI);
        // Light on the cross section πρ² that leaves through the area 4πρ²/n
        let expected = estimates(|c| tallies[c].scattered_through(ring));
        assert_agree(&format!("ring {ring}"), result, scaled(expected, SPHERE_RINGS as f32 / 4.0));
    }
}

/// Closed meshes of a group that overlap are one body.
#[test]
fn overlapping_meshes_of_a_group_are_one_body() {
    let shifted = |offset: Vec3| {
        let mut mesh = sphere(2.0, 32);
        mesh.positions.iter_mut().for_each(|p| *p += offset);
        mesh
    };
    let measured = |meshes: Vec<Mesh>| {
        let mut scene = scene(meshes, material());
        scene.environment = uniform_environment(Vec3::ONE);
        measure(&prepare(scene), Vec3::new(0.1, 9.0, 0.2), Vec3::NEG_Y, 1 << 15)
    };
    let once = measured(vec![shifted(Vec3::ZERO)]);
    // Within the first one all the way
    let mut inner = sphere(1.2, 16);
    inner.positions.iter_mut().for_each(|p| p.x += 0.4);
    let twice = measured(vec![shifted(Vec3::ZERO), inner]);
    let (difference, error) = (twice.0 - once.0, (twice.1 * twice.1 + once.1 * once.1).powf(0.5));
    for c in 0..3 {
        assert!(difference[c].abs() < 4.0 * error[c], "channel {c}: {once:?} {twice:?}");
    }
    // White, and more than a sphere: nothing is lost between them
    let mut pair = scene(vec![shifted(Vec3::X), shifted(Vec3::NEG_X)], white(material()));
    pair.environment = seen(Vec3::ONE);
    pair.integrator.max_depth = 64;
    pair.integrator.max_diffuse_depth = 64;
    let result = measure(&prepare(pair), Vec3::new(0.1, 9.0, 0.2), Vec3::NEG_Y, 1 << 13);
    assert_within("pair", result, Vec3::ONE);
}

#[test]
fn picture_does_not_depend_on_threads() {
    let mut scene = scene(vec![sphere(0.3, 24)], material());
    scene.environment = uniform_environment(Vec3::splat(0.3));
    scene.lights.push(distant(Vec3::ONE));
    scene.materials[0].subsurface_radius = ScalarInput::constant(0.1);
    (scene.film.width, scene.film.height) = (40, 40);
    let [one, three] = [1, 3].map(|threads| on_threads(threads, || picture(&scene, 3)));
    let mut lit = 0;
    for (x, y) in (0..40).flat_map(|y| (0..40).map(move |x| (x, y))) {
        assert_eq!(one.radiance(x, y), three.radiance(x, y));
        lit += u32::from(one.radiance(x, y)[0] > 0.0);
    }
    assert!(lit > 100, "{lit}");
}

#[test]
fn notes_tell_what_a_walk_cannot_do() {
    let notes = |g: f32, eta: f32| {
        let mut material = material();
        (material.subsurface_scatter_anisotropy, material.subsurface_eta) = (g, eta);
        let mut scene = plane(material);
        scene.lights.push(distant(Vec3::Z));
        prepare(scene).notes().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert!(notes(0.5, 1.0).is_empty());
    assert_eq!(
        notes(0.99, 0.9),
        [
            "material translucent: random-walk does not reach so far: subsurface_scatter_anisotropy is 0.99, taken for 0.95; subsurface_eta is 0.9, taken for 1"
        ]
    );
    assert!(notes(0.0, 1.4).is_empty());
}

/// The material below a smooth interface of its own index, as dielectrics are.
fn dielectric(eta: f32) -> Material {
    Material {
        specular_weight: ScalarInput::constant(1.0),
        specular_ior: eta,
        specular_roughness: ScalarInput::constant(0.0),
        subsurface_eta: eta,
        ..material()
    }
}

/// Media of a [`dielectric`]'s channels.
fn interiors(eta: f32) -> [Interior; 3] {
    let eta = f64::from(eta);
    let inversion = AlbedoInversion::new(0.0, eta, Configuration::Diffuse).unwrap();
    ALBEDO.to_array().map(|a| Interior {
        single_scattering_albedo: inversion.single_scattering_albedo(f64::from(a)),
        g: 0.0,
        eta,
    })
}

/// Share of light from an angle of this cosine that a boundary lets in.
fn let_in(cosine: f32, eta: f32) -> f32 {
    1.0 - fresnel_dielectric(cosine, eta)
}

/// Light from one direction, which no ray can meet, reaches collisions refracted: a plane returns the light of the transfer
/// equation's solution.
#[test]
fn dielectric_plane_in_parallel_light_returns_the_exact_albedo() {
    for (eta, cosine) in [(1.05, 0.6_f32), (1.33, 1.0), (1.4, 0.5), (1.8, 0.2)] {
        let mut scene = plane(dielectric(eta));
        let toward = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        scene.lights.push(distant(toward));
        let result = flux(&prepare(scene), samples(1 << 15), on_plane);
        let expected = per_channel(|c| {
            let alpha = interiors(eta)[c].single_scattering_albedo;
            let exact = ObliqueHalfSpace::new(alpha, eta.into(), cosine.into()).unwrap();
            exact.total().value * f64::from(cosine * let_in(cosine, eta))
        });
        assert_within(&format!("eta {eta} cos {cosine}"), scaled(result, std::f32::consts::PI), expected);
    }
}

/// In the middle of a perpendicular beam, the light that leaves is a pencil's light within the beam's radius.
#[test]
fn beam_on_a_dielectric_returns_the_enclosed_energy_of_the_exact_profile() {
    let eta = 1.4;
    let exact = interiors(eta)
        .map(|interior| ObliqueHalfSpace::new(interior.single_scattering_albedo, interior.eta, 1.0).unwrap());
    for radius in [0.3_f32, 1.0] {
        let mut scene = plane(dielectric(eta));
        let irradiance = 1.0 / (std::f32::consts::PI * radius * radius);
        let origin = Vec3::new(3.3, 1.1, 50.0);
        scene.lights.push(Light::Beam { origin, direction: Vec3::NEG_Z, radius, power: Vec3::ONE });
        let expected = per_channel(|c| exact[c].enclosed(f64::from(radius / LENGTH[c])).value);
        let result = flux(&prepare(scene), samples(1 << 15), on_plane);
        let result = scaled(result, std::f32::consts::PI / (irradiance * let_in(1.0, eta)));
        assert_within(&format!("radius {radius}"), result, expected);
    }
}

/// A dielectric sphere in light from one direction, which no ray can meet, or from a disc of the sky, which shadow rays and
/// paths both find, against an independent walk. Left out for the first: light that crosses the sphere unscattered and is
/// reflected inside before it collides, 1e-3 of the light that enters.
#[test]
fn dielectric_sphere_agrees_with_an_independent_walk() {
    let (radius, eta) = (2.0_f32, 1.4);
    let tallies: [Tally; 3] = std::array::from_fn(|c| {
        let shape = Shape::Sphere { radius: f64::from(radius / LENGTH[c]) };
        Body::new(shape, interiors(eta)[c], Lighting::Distant).unwrap().walk(power(1_600_000), 3)
    });
    // Per cross section πρ²
    let steps = 10_000_u16;
    let cosine = |i: u16| ((f32::from(i) + 0.5) / f32::from(steps)).sqrt();
    let entering = (0..steps).map(|i| let_in(cosine(i), eta)).sum::<f32>() / f32::from(steps);
    for angular_radius in [0.0, 1.0] {
        let mut scene = scene(vec![sphere(radius, 96)], dielectric(eta));
        scene.lights.push(Light::Distant { direction: Vec3::Z, angular_radius, irradiance: Vec3::ONE });
        let renderer = prepare(scene);
        for ring in [0, 4, 9] {
            let place = |[x, y]: [f64; 2]| {
                let z = 1.0 - 2.0 * (f64::from(ring) + x) / SPHERE_RINGS as f64;
                let (r, phi) = ((1.0 - z * z).sqrt(), std::f64::consts::TAU * y);
                let normal = Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32).normalize();
                (normal * radius, normal)
            };
            let result = scaled(flux(&renderer, samples(1 << 14), place), std::f32::consts::PI);
            let expected = estimates(|c| tallies[c].scattered_through(ring as usize));
            let expected = scaled(expected, entering * SPHERE_RINGS as f32 / 4.0);
            assert_agree(&format!("{angular_radius}, ring {ring}"), result, expected);
        }
    }
}

/// Lights of each kind near a dielectric that absorbs nothing: in a closed box that shines it cannot be seen, whether the
/// box is made of rectangle lights or of triangles that emit.
#[test]
fn white_dielectric_in_a_box_of_light_cannot_be_seen() {
    let faces = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(|normal| {
        let (x, y) = normal.any_orthonormal_pair();
        // Facing inward
        let (x, y) = if x.cross(y).dot(normal) < 0.0 { (x, y) } else { (y, x) };
        (normal * 2.5, x * 2.5, y * 2.5)
    });
    let mut white_dielectric = white(material());
    white_dielectric.subsurface_eta = 1.5;
    let body = || {
        let mut scene = scene(vec![sphere(1.5, 24)], white_dielectric.clone());
        scene.integrator.max_depth = 64;
        scene.integrator.max_diffuse_depth = 64;
        scene
    };
    let mut of_rectangles = body();
    of_rectangles.lights = faces
        .map(|(center, x, y)| Light::Rectangle {
            center,
            edge_x: 2.0 * x,
            edge_y: 2.0 * y,
            radiance: Vec3::ONE,
            visible: true,
        })
        .to_vec();
    let mut of_triangles = body();
    let lamp = Material {
        base_weight: 0.0,
        specular_weight: ScalarInput::constant(0.0),
        emission_luminance: 1.0,
        ..matte(Vec3::ZERO)
    };
    of_triangles.materials.push(lamp);
    for (center, x, y) in faces {
        let object =
            Object { mesh: quad(center, x, y).into(), material: 1, subsurface_group: 1, ..Object::default() };
        of_triangles.objects.push(object);
    }
    for (name, scene) in [("rectangles", of_rectangles), ("triangles", of_triangles)] {
        let result = measure(&prepare(scene), Vec3::new(2.2, 0.3, 0.4), Vec3::NEG_X, samples(1 << 14));
        assert_within(name, result, Vec3::ONE);
    }
}

/// A small ball of light is a point of light, and both light a dielectric from near by.
#[test]
fn small_lamp_lights_a_dielectric_as_a_point_does() {
    let position = Vec3::new(0.4, -0.3, 2.9);
    let lit = |light: Light| {
        let mut scene = scene(vec![sphere(2.0, 48)], dielectric(1.4));
        scene.lights.push(light);
        let renderer = prepare(scene);
        flux(&renderer, samples(1 << 14), |_| (Vec3::Z * 2.0, Vec3::Z))
    };
    let radius = 0.05_f32;
    let intensity = Vec3::splat(std::f32::consts::PI * radius * radius);
    let lamp = lit(Light::Sphere { center: position, radius, radiance: Vec3::ONE, visible: false });
    for outer_angle in [180.0, 60.0] {
        let direction = Vec3::NEG_Z;
        let point = Light::Spot {
            position,
            direction,
            radius: 0.0,
            intensity,
            inner_angle: 59.0,
            outer_angle,
            visible: true,
        };
        assert_agree(&format!("{outer_angle}"), lamp, lit(point));
    }
}

/// Exponential integral E₃(x) = ∫₁^∞ e^{−xt} t⁻³ dt by the midpoint rule in 1/t.
fn exponential_integral_3(x: f64) -> f64 {
    let steps = 100_000;
    (0..steps)
        .map(|i| {
            let mu = (f64::from(i) + 0.5) / f64::from(steps);
            mu * (-x / mu).exp() / f64::from(steps)
        })
        .sum()
}

/// A matte floor below a slab of the material, of one diffuse event: light comes to it straight or not at all.
fn floor_below_a_slab(thickness: f32) -> Scene {
    let wide = |z: f32| quad(Vec3::Z * z, Vec3::X * 2e3, Vec3::Y * 2e3);
    let mut bottom = wide(5.0);
    bottom.triangles.iter_mut().for_each(|corners| corners.reverse());
    let mut scene = scene(vec![wide(5.0 + thickness), bottom, wide(0.0)], material());
    scene.materials.push(matte(GRAY));
    scene.objects[2].material = 1;
    scene.objects[2].subsurface_group = 1;
    scene.integrator.max_diffuse_depth = 1;
    scene
}

/// Radiance of the floor's middle.
fn floor_radiance(scene: Scene, samples: u32) -> (Vec3, Vec3) {
    measure(&prepare(scene), Vec3::new(0.3, 0.2, 1.0), Vec3::new(0.1, 0.0, -1.0).normalize(), samples)
}

/// Shadow rays bring the unscattered light through a body, of lights of any kind; paths that pass the body are weighted
/// against them.
#[test]
fn light_that_passes_a_body_straight_is_found_by_shadow_rays_and_by_paths() {
    let thickness = 0.4_f32;
    let depth = per_channel(|c| f64::from(thickness / LENGTH[c]));
    // Without a size: shadow rays alone
    let mut scene = floor_below_a_slab(thickness);
    let toward = Vec3::new(0.3, -0.4, 1.0).normalize();
    scene.lights.push(distant(toward));
    let expected = GRAY * std::f32::consts::FRAC_1_PI * toward.z * (-depth / toward.z).exp();
    assert_within("distant", floor_radiance(scene, 64), expected);
    // From everywhere: both
    let mut scene = floor_below_a_slab(thickness);
    scene.environment = uniform_environment(Vec3::ONE);
    let expected = GRAY * per_channel(|c| 2.0 * exponential_integral_3(f64::from(depth[c])));
    assert_within("environment", floor_radiance(scene.clone(), samples(1 << 15)), expected);
    // The last event of a path
    scene.integrator.max_depth = 1;
    assert_within("last", floor_radiance(scene, samples(1 << 15)), expected);
}

/// A light inside a body does not shine out of it straight, nor does it throw a shadow.
#[test]
fn light_inside_a_body_is_not_seen_through_it() {
    let lit = |has_inner: bool| {
        let mut scene = floor_below_a_slab(0.4);
        scene.environment = uniform_environment(Vec3::ONE);
        if has_inner {
            scene.lights.push(Light::Sphere {
                center: Vec3::Z * 5.2,
                radius: 0.1,
                radiance: Vec3::ONE,
                visible: true,
            });
        }
        floor_radiance(scene, samples(1 << 15))
    };
    assert_agree("inner", lit(true), lit(false));
}

/// The material between surfaces that light crosses in all directions alike, or whose facets the view crosses.
fn between(surface: WalkSurface, eta: f32) -> Material {
    Material {
        subsurface_model: SubsurfaceModel::RandomWalk(surface),
        subsurface_eta: eta,
        specular_roughness: ScalarInput::constant(1.0),
        ..material()
    }
}

/// A diffuse surface shows A from every direction, a rough one on average over them.
#[test]
fn plane_of_diffuse_surface_returns_surface_albedo() {
    let lit = |material: Material| {
        let mut scene = plane(material);
        scene.environment = uniform_environment(Vec3::ONE);
        prepare(scene)
    };
    for g in [0.0, 0.8] {
        let anisotropic = |material: Material| Material { subsurface_scatter_anisotropy: g, ..material };
        let diffuse = lit(anisotropic(between(WalkSurface::Diffuse, 1.0)));
        for slope in [0.0, 3.0] {
            let direction = Vec3::new(slope, 0.0, -1.0).normalize();
            let result = measure(&diffuse, Vec3::new(3.3, 1.1, 0.0) - direction, direction, samples(1 << 16));
            assert_within(&format!("diffuse, g {g}, slope {slope}"), result, ALBEDO);
        }
        let rough = lit(anisotropic(between(WalkSurface::Rough, 1.0)));
        assert_within(&format!("rough, g {g}"), flux(&rough, samples(1 << 17), on_plane), ALBEDO);
    }
}

/// Share of the light on a plane that leaves it by flights up to `most`, α of it surviving each collision, with its error:
/// walk by walk.
fn returned_by(most: u32, alphas: [f64; 3]) -> (Vec3, Vec3) {
    let walks = 200_000;
    let mut random = SplitMix(9);
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for _ in 0..walks {
        let (mut depth, mut cosine) = (0.0, random.uniform().sqrt());
        for flight in 0..most {
            depth -= (1.0 - random.uniform()).ln() * cosine;
            if depth <= 0.0 {
                for (c, alpha) in alphas.iter().enumerate() {
                    let light = alpha.powi(flight as i32);
                    sum[c] += light;
                    squares[c] += light * light;
                }
                break;
            }
            cosine = 2.0 * random.uniform() - 1.0;
        }
    }
    let n = f64::from(walks);
    let variance = |c: usize| (squares[c] / n - (sum[c] / n) * (sum[c] / n)) / n;
    (per_channel(|c| sum[c] / n), per_channel(|c| variance(c).sqrt()))
}

/// Walks that are given up leave out the light of longer ones.
#[test]
fn walks_of_so_many_flights_return_the_light_of_so_many() {
    let albedos = Vec3::new(1.0, 0.9, 0.6);
    let inversion = AlbedoInversion::new(0.0, 1.0, Configuration::Diffuse).unwrap();
    let alphas = albedos.to_array().map(|a| inversion.single_scattering_albedo(f64::from(a)));
    for flights in [2_u16, 16, 256] {
        let mut scene = plane(Material {
            subsurface_color: ColorInput::constant(albedos),
            subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
            subsurface_flights: f32::from(flights),
            ..between(WalkSurface::Diffuse, 1.0)
        });
        scene.environment = uniform_environment(Vec3::ONE);
        let result = measure(&prepare(scene), Vec3::new(3.3, 1.1, 1.0), Vec3::NEG_Z, samples(1 << 16));
        assert_agree(&format!("{flights} flights"), result, returned_by(flights.into(), alphas));
    }
}

/// Seen through facets that refract, a half space shows the light that it returns of pencils in the facets' directions.
#[test]
fn refracting_facets_show_the_albedos_of_refracted_pencils() {
    let eta = 1.4_f32;
    let nodes = 16_u32;
    let returned: [Vec<f64>; 3] = SINGLE_SCATTERING_ALBEDOS.map(|alpha| {
        let pencil = |i: u32| Incidence::Pencil { cos_theta: f64::from(i + 1) / f64::from(nodes) };
        (0..nodes).map(|i| HalfSpace::with_boundary(alpha, 1.0, pencil(i)).unwrap().total().value).collect()
    });
    for slope in [0.0_f32, 2.0] {
        let toward = Vec3::new(slope, 0.0, 1.0).normalize();
        // Snell's law at facets that are drawn as they are seen
        let facets = Ggx::from_roughness(1.0);
        let mut expected = [0.0; 3];
        let n = 1 << 14;
        for i in 0..n {
            let [u, v, ..] = even(7, i);
            let facet = facets.sample_visible(toward, [u as f32, v as f32]);
            let along = toward.dot(facet);
            let inside = (1.0 - (1.0 - along * along) / (eta * eta)).sqrt();
            let below = -toward / eta + facet * (along / eta - inside);
            // Between the cosines that are solved, all far from grazing
            let place = f64::from(below.z.abs() * nodes as f32) - 1.0;
            let node = (place as usize).min(nodes as usize - 2);
            for (sum, returned) in expected.iter_mut().zip(&returned) {
                let value = returned[node] + (place - node as f64) * (returned[node + 1] - returned[node]);
                *sum += value / f64::from(n);
            }
        }
        let mut scene = plane(between(WalkSurface::Rough, eta));
        scene.environment = uniform_environment(Vec3::ONE);
        let point = Vec3::new(3.3, 1.1, 0.0);
        let result = measure(&prepare(scene), point + toward, -toward, samples(1 << 17));
        assert_within(&format!("slope {slope}"), result, Vec3::from_array(expected.map(|x| x as f32)));
    }
}

/// In the middle of a beam a diffuse surface returns the energy of the exact diffuse profile within the beam's radius, from
/// any direction.
#[test]
fn beam_on_a_diffuse_surface_returns_the_enclosed_energy_of_the_exact_profile() {
    let half_spaces =
        SINGLE_SCATTERING_ALBEDOS.map(|alpha| HalfSpace::new(alpha, Incidence::Cosine).unwrap());
    for radius in [0.2_f32, 0.6, 1.5, 4.0] {
        let quad = quad(Vec3::ZERO, Vec3::X * 200.0, Vec3::Y * 200.0);
        let mut scene = scene(vec![quad], between(WalkSurface::Diffuse, 1.0));
        let irradiance = 1.0 / (std::f32::consts::PI * radius * radius);
        let origin = Vec3::new(3.3, 1.1, 50.0);
        scene.lights.push(Light::Beam { origin, direction: Vec3::NEG_Z, radius, power: Vec3::ONE });
        let expected = per_channel(|c| half_spaces[c].enclosed(f64::from(radius / LENGTH[c])).value);
        let direction = Vec3::new(0.6, 0.3, -1.0).normalize();
        let result =
            measure(&prepare(scene), Vec3::new(3.3, 1.1, 0.0) - direction, direction, samples(1 << 16));
        assert_within(
            &format!("radius {radius}"),
            scaled(result, std::f32::consts::PI / irradiance),
            expected,
        );
    }
}

/// In even light a diffuse surface changes no total: a slab and the rings of a sphere return the light of an independent
/// walk, unscattered light included.
#[test]
fn bodies_of_diffuse_surface_agree_with_an_independent_walk() {
    let thickness = 1.2_f32;
    let top = quad(Vec3::ZERO, Vec3::X * 2e3, Vec3::Y * 2e3);
    let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 2e3, Vec3::X * 2e3);
    let mut slab = scene(vec![top, bottom], between(WalkSurface::Diffuse, 1.0));
    slab.environment = uniform_environment(Vec3::ONE);
    let shape = |scale| Shape::Slab { thickness: f64::from(thickness) * scale };
    let tallies = independent(shape, Lighting::Uniform, 400_000, 3);
    let result = flux(&prepare(slab), samples(1 << 15), on_plane);
    assert_agree("slab", result, estimates(|c| tallies[c].leaving()));
    let radius = 1.0_f32;
    let mut ball = scene(vec![sphere(radius, 96)], between(WalkSurface::Diffuse, 1.0));
    ball.environment = uniform_environment(Vec3::ONE);
    let shape = |scale| Shape::Sphere { radius: f64::from(radius) * scale };
    let tallies = independent(shape, Lighting::Uniform, 400_000, 4);
    let result = measure(&prepare(ball), Vec3::new(0.1, 9.0, 0.2), Vec3::NEG_Y, samples(1 << 15));
    assert_agree("ball", result, estimates(|c| tallies[c].leaving()));
}

/// White bodies of any surface in even light cannot be seen.
#[test]
fn white_body_of_diffuse_surface_cannot_be_seen() {
    for surface in [WalkSurface::Diffuse, WalkSurface::Rough, WalkSurface::Skin] {
        let mut scene = scene(vec![sphere(1.0, 48)], white(between(surface, 1.3)));
        scene.environment = seen(Vec3::ONE);
        let result = measure(&prepare(scene), Vec3::new(0.1, 9.0, 0.2), Vec3::NEG_Y, samples(1 << 15));
        assert_within(surface.name_of_walk(), result, Vec3::ONE);
    }
}
