//! The renderer against exact answers: A of a plane, transmission of a slab, the step edge, the spot.
//!
//! Every test fixes its seed. A mean counts as right within four standard errors (a false alarm in 2,700 comparisons, and
//! below 3 % over all of this file).

use glam::Vec3;
use translucid_profile::{Configuration, Model, Parameterization, d_from_surface_albedo};
use translucid_scene::{
    ColorInput, Light, Material, Object, ScalarInput, Scene, SubsurfaceMethod, SubsurfaceModel,
};
use translucid_testing::power;

use crate::common::{
    GRAY, assert_within, distant, matte, measure, precision, prepare, quad, sample_ray, samples, scene,
    sphere, uniform_environment,
};

const ALBEDO: Vec3 = Vec3::new(0.9, 0.5, 0.2);
const LENGTH: Vec3 = Vec3::new(1.0, 0.4, 0.05);

/// An index-matched translucent material without a specular interface, of the model whose slabs and edges have closed
/// forms.
fn translucent() -> Material {
    Material {
        name: "translucent".into(),
        specular_weight: ScalarInput::constant(0.0),
        subsurface_weight: ScalarInput::constant(1.0),
        subsurface_color: ColorInput::constant(ALBEDO),
        subsurface_radius_scale: ColorInput::constant(LENGTH),
        subsurface_model: SubsurfaceModel::Profile(Model::NormalizedDiffusion),
        ..Material::default()
    }
}

fn widths() -> [f64; 3] {
    std::array::from_fn(|c| {
        d_from_surface_albedo(
            f64::from(ALBEDO[c]),
            f64::from(LENGTH[c]),
            Parameterization::Mfp,
            Configuration::Diffuse,
        )
    })
}

#[test]
fn plane_under_uniform_light_returns_surface_albedo() {
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], translucent());
    scene.environment = uniform_environment(Vec3::ONE);
    let renderer = prepare(scene);
    // The origin lies on the diagonal: a probe that counted both triangles of an edge it passes within
    // rounding would return too much there.
    for point in [Vec3::ZERO, Vec3::new(3.3, 1.1, 0.0)] {
        for direction in [Vec3::NEG_Z, Vec3::new(0.6, 0.2, -0.3).normalize()] {
            let result = measure(&renderer, point - direction, direction, 1 << 16);
            assert_within(&format!("plane at {point} along {direction}"), result, ALBEDO);
        }
    }
}

/// A fifth of light from below is followed twice as often as chance would have it, beside the rest.
#[test]
fn plane_of_two_lobes_returns_both() {
    let material = Material {
        base_color: ColorInput::constant(ALBEDO),
        subsurface_weight: ScalarInput::constant(0.2),
        ..translucent()
    };
    let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material);
    scene.environment = uniform_environment(Vec3::ONE);
    let result = measure(&prepare(scene), Vec3::Z, Vec3::NEG_Z, samples(1 << 16));
    assert_within("plane of two lobes", result, ALBEDO);
}

/// Energy of the unit profile beyond r, cut at `tail` and renormalized.
fn beyond(r: f64, d: f64, tail: f64) -> f64 {
    let full = 0.25 * (-r / d).exp() + 0.75 * (-r / (3.0 * d)).exp();
    ((full - tail) / (1.0 - tail)).max(0.0)
}

/// Mean free paths of slabs.
const SLAB: Vec3 = Vec3::new(1.0, 0.6, 0.4);

/// A slab below z = 0 that is lit from below.
fn slab(thickness: f32) -> Scene {
    let top = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let bottom = quad(Vec3::NEG_Z * thickness, Vec3::Y * 1e3, Vec3::X * 1e3);
    let material = Material { subsurface_radius_scale: ColorInput::constant(SLAB), ..translucent() };
    let mut scene = scene(vec![top, bottom], material);
    scene.lights.push(distant(Vec3::NEG_Z));
    scene
}

fn widths_in_slab() -> [f64; 3] {
    std::array::from_fn(|c| {
        let (albedo, length) = (f64::from(ALBEDO[c]), f64::from(SLAB[c]));
        d_from_surface_albedo(albedo, length, Parameterization::Mfp, Configuration::Diffuse)
    })
}

/// Radiance of Lambertian light of these shares of A.
fn matte_light(shares: [f64; 3]) -> Vec3 {
    ALBEDO * Vec3::from_array(shares.map(|share| share as f32)) / std::f32::consts::PI
}

#[test]
fn slab_transmits_what_the_profile_says() {
    for thickness in [0.05_f32, 0.3, 1.0, 2.0] {
        let scene = slab(thickness);
        let tail = f64::from(scene.integrator.subsurface_tail);
        let result = measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, samples(1 << 18));
        let expected = matte_light(widths_in_slab().map(|d| beyond(f64::from(thickness), d, tail)));
        assert_within(&format!("slab {thickness}"), result, expected);
    }
}

/// ∫ p_c(r) Σ_{k: r ≤ R_k} p_k(ρ) / Σ_k p_k(ρ) dρ with r² = ρ² + h² through a slab of the thickness h, which the disks of
/// Cycles find from the axis along the normal alone; p_k is cut at R_k and renormalized.
fn across_disks(h: f64, widths: [f64; 3], tail: f64) -> [f64; 3] {
    let reaches = widths.map(|d| {
        let (mut low, mut high) = (0.0, 100.0 * d);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if beyond(middle, d, tail) > 0.0 { low = middle } else { high = middle }
        }
        low
    });
    let pdf = |k: usize, r: f64| {
        let d = widths[k];
        let inside = if r <= reaches[k] { 1.0 } else { 0.0 };
        inside * ((-r / d).exp() + (-r / (3.0 * d)).exp()) / (4.0 * d * (1.0 - tail))
    };
    let steps = 100_000;
    let step = reaches.into_iter().fold(0.0, f64::max) / f64::from(steps);
    let mut sums = [0.0; 3];
    for i in 0..steps {
        let rho = (f64::from(i) + 0.5) * step;
        let r = rho.hypot(h);
        let all: f64 = (0..3).map(|k| pdf(k, rho)).sum();
        let within: f64 = (0..3).filter(|&k| r <= reaches[k]).map(|k| pdf(k, rho)).sum();
        for (c, sum) in sums.iter_mut().enumerate() {
            *sum += pdf(c, r) * within / all * step;
        }
    }
    sums
}

#[test]
fn slab_transmits_what_the_disks_of_cycles_find() {
    for thickness in [0.05_f32, 0.3, 1.0, 2.0] {
        let mut scene = slab(thickness);
        scene.integrator.subsurface_method = SubsurfaceMethod::CyclesDisk;
        let tail = f64::from(scene.integrator.subsurface_tail);
        let result = measure(&prepare(scene), Vec3::new(0.1, 0.2, 1.0), Vec3::NEG_Z, samples(1 << 18));
        let expected = matte_light(across_disks(f64::from(thickness), widths_in_slab(), tail));
        assert_within(&format!("slab {thickness}"), result, expected);
    }
}

/// With the disks of Cycles, light that comes through a body reaches the camera, not a floor.
#[test]
fn bodies_are_lambertian_behind_a_diffuse_event_with_disks() {
    let light_of_floor = |method: SubsurfaceMethod| {
        let mut scene = slab(0.3);
        scene.objects.push(Object {
            name: "floor".into(),
            mesh: quad(Vec3::Z, Vec3::Y * 1e3, Vec3::X * 1e3).into(),
            material: 1,
            subsurface_group: 1,
            ..Object::default()
        });
        scene.materials.push(matte(GRAY));
        scene.integrator.subsurface_method = method;
        scene.integrator.max_depth = 3;
        measure(&prepare(scene), Vec3::Z * 0.5, Vec3::Z, samples(1 << 12)).0
    };
    assert_eq!(light_of_floor(SubsurfaceMethod::CyclesDisk), Vec3::ZERO);
    assert!(light_of_floor(SubsurfaceMethod::RayTraced).max_element() > 1e-3);
}

/// Energy of a unit profile that falls on a half plane at distance x ≥ 0 from its edge:
/// (1/4π)(Ki₁(x/d) + 3 Ki₁(x/3d)) with Ki₁(x) = ∫₀^∞ e^{−x cosh t}/cosh t dt, the integral of K₀.
fn half_plane(x: f64, d: f64) -> f64 {
    let ki = |x: f64| {
        let step = 1e-3;
        (0..20_000)
            .map(|i| (f64::from(i) + 0.5) * step)
            .map(|t| (-x * t.cosh()).exp() / t.cosh())
            .sum::<f64>()
            * step
    };
    (ki(x / d) + 3.0 * ki(x / (3.0 * d))) / (4.0 * std::f64::consts::PI)
}

#[test]
fn step_edge_of_light_follows_bessel_integral() {
    assert!((half_plane(0.0, 1.0) - 0.5).abs() < 1e-6);
    for x in [-1.5_f32, -0.5, -0.1, 0.1, 0.5, 1.5] {
        let plane = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
        let roof = quad(Vec3::new(1e3, 0.0, 50.0), Vec3::X * 1e3, Vec3::Y * 2e3);
        let mut scene = scene(vec![plane, roof], translucent());
        scene.objects[1].subsurface_group = 1;
        scene.integrator.subsurface_tail = 1e-6;
        scene.lights.push(distant(Vec3::Z));
        let result = measure(&prepare(scene), Vec3::new(x, 0.3, 1.0), Vec3::NEG_Z, samples(1 << 18));
        let expected = Vec3::from_array(std::array::from_fn(|c| {
            let far = half_plane(f64::from(x.abs()), widths()[c]);
            let lit = if x > 0.0 { far } else { 1.0 - far };
            (f64::from(ALBEDO[c]) * lit / std::f64::consts::PI) as f32
        }));
        for c in 0..3 {
            let (mean, error) = (result.0[c], result.1[c]);
            // Deep in the shadow a narrow channel gets less light than there are samples to see it.
            if expected[c] > 1e-3 {
                let z = (mean - expected[c]) / error.max(1e-6);
                assert!(z.abs() < 4.0, "x = {x}, channel {c}: {mean} ± {error}, expected {}", expected[c]);
            }
        }
    }
}

/// A beam of radius b on a plane: the light that leaves ring by ring is R(r) averaged over the disc.
#[test]
fn collimated_spot_reproduces_the_profile_in_rings() {
    let spot = 0.25_f32;
    let plane = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
    let gray = Material {
        subsurface_color: ColorInput::constant(Vec3::splat(0.8)),
        subsurface_radius_scale: ColorInput::constant(Vec3::ONE),
        ..translucent()
    };
    let mut scene = scene(vec![plane], gray);
    scene.integrator.subsurface_tail = 1e-6;
    scene.lights.push(Light::Beam {
        origin: Vec3::Z * 5.0,
        direction: Vec3::NEG_Z,
        radius: spot,
        power: Vec3::ONE,
    });
    let renderer = prepare(scene);
    let d = d_from_surface_albedo(0.8, 1.0, Parameterization::Mfp, Configuration::Diffuse);
    let profile = translucid_profile::NormalizedDiffusion::from_d(0.8, d).expect("valid parameters");
    for (inner, outer) in [(0.3_f32, 0.6_f32), (0.6, 1.0), (1.0, 1.5), (1.5, 2.0), (2.0, 3.0), (3.0, 5.0)] {
        let blocks = 24_u32;
        let per_block = power(if outer < 2.5 { 1 << 14 } else { 1 << 16 }) as u32;
        let means: Vec<f64> = (0..blocks)
            .map(|block| {
                let sum: f64 = (0..per_block)
                    .map(|index| {
                        // Radii uniform in area, one for each sample: a golden-ratio sequence.
                        let u = (f64::from(index) * 0.618_033_988_749_895 + f64::from(block) * 0.37).fract();
                        let (a, b) = (f64::from(inner).powi(2), f64::from(outer).powi(2));
                        let r = (a + (b - a) * u).sqrt() as f32;
                        let origin = Vec3::new(r, 0.0, 1.0);
                        let seed = u64::from(block) + 77;
                        f64::from(sample_ray(&renderer, origin, Vec3::NEG_Z, seed, index).radiance().y)
                    })
                    .sum();
                sum / f64::from(per_block) * std::f64::consts::PI
            })
            .collect();
        let n = f64::from(blocks);
        let mean = means.iter().sum::<f64>() / n;
        let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
        let expected = ring_average(&profile, f64::from(inner), f64::from(outer), f64::from(spot));
        let z = (mean - expected) / error;
        // By Student's t of 23 degrees of freedom a false alarm in 150, and 4 % over the six rings
        assert!(z.abs() < 3.0, "ring {inner}–{outer}: {mean} ± {error}, expected {expected}, z = {z}");
        assert!(error < precision() * expected, "ring {inner}–{outer}: too noisy to tell, {mean} ± {error}");
    }
}

/// R averaged over a ring of exit points and a disc of entry points, by midpoint sums.
fn ring_average(profile: &translucid_profile::NormalizedDiffusion, inner: f64, outer: f64, spot: f64) -> f64 {
    let n = 60;
    let mut sum = 0.0;
    for i in 0..n {
        let area =
            |a: f64, b: f64, k: i32| (a * a + (b * b - a * a) * (f64::from(k) + 0.5) / f64::from(n)).sqrt();
        let r = area(inner, outer, i);
        for j in 0..n {
            let s = area(0.0, spot, j);
            for k in 0..n {
                let angle = std::f64::consts::PI * (f64::from(k) + 0.5) / f64::from(n);
                let distance = (r * r + s * s - 2.0 * r * s * angle.cos()).sqrt();
                sum += profile.eval(distance);
            }
        }
    }
    sum / f64::from(n).powi(3)
}

/// Any plane at distance h from the exit point sees the profile's energy beyond h: here one that is
/// inclined to all probe axes, so that each axis alone must give the same mean as all together.
#[test]
fn each_probe_axis_alone_has_the_same_mean() {
    let h = 0.4_f32;
    let normal = Vec3::new(0.5, 0.6, -0.7).normalize();
    let side = normal.any_orthonormal_vector();
    let inclined = quad(normal * h, side * 1e3, normal.cross(side) * 1e3);
    // The exit face is small, so that the inclined plane does not cut it where probes look.
    let face = quad(Vec3::ZERO, Vec3::X * 1e-3, Vec3::Y * 1e-3);
    for shares in [
        [1.0, 1.0, 1.0],
        [0.25, 0.25, 1.0],
        [0.25, 0.25, 0.5],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, 0.0, 1.0],
    ] {
        let mut scene = scene(vec![face.clone(), inclined.clone()], translucent());
        scene.lights.push(distant(normal));
        let tail = f64::from(scene.integrator.subsurface_tail);
        let mut renderer = prepare(scene);
        translucid_render::internals::set_probe_axes(&mut renderer, shares);
        let exit = Vec3::new(2e-4, 1e-4, 0.0);
        let distance = f64::from(h - exit.dot(normal));
        let (mean, error) = measure(&renderer, exit + Vec3::Z * 0.1, Vec3::NEG_Z, samples(1 << 19));
        for c in 0..2 {
            let albedo = f64::from(ALBEDO[c]);
            let expected = (albedo / std::f64::consts::PI * beyond(distance, widths()[c], tail)) as f32;
            let z = (mean[c] - expected) / error[c];
            assert!(z.abs() < 4.0, "axes {shares:?}, channel {c}: {mean} ± {error}, expected {expected}");
            assert!(error[c] < 0.03 * expected, "axes {shares:?}, channel {c}: too noisy, {mean} ± {error}");
        }
    }
}

#[test]
fn zero_length_is_a_lambertian_sphere() {
    let material = Material { subsurface_radius: ScalarInput::constant(0.0), ..translucent() };
    let mut scene = scene(vec![sphere(1.0, 256)], material);
    scene.lights.push(distant(Vec3::new(0.3, 0.5, 0.8)));
    let toward = Vec3::new(0.3, 0.5, 0.8).normalize();
    let renderer = prepare(scene);
    for point in [Vec3::new(0.1, 0.2, 0.97), Vec3::new(0.5, 0.1, 0.8), Vec3::new(-0.4, 0.6, 0.6)] {
        let normal = point.normalize();
        let (mean, _) = measure(&renderer, normal * 3.0, -normal, 64);
        let expected = ALBEDO / std::f32::consts::PI * normal.dot(toward).max(0.0);
        assert!((mean - expected).abs().max_element() < 2e-3 * ALBEDO.x, "{mean} {expected}");
    }
}

/// With A = 1 under a specular interface and light from everywhere nothing is lost: reflection and matte
/// base share the energy by Fresnel, over one bounce and over many.
#[test]
fn furnace_returns_all_light() {
    for roughness in [0.0, 0.2, 0.6, 1.0] {
        let material = Material {
            subsurface_color: ColorInput::constant(Vec3::ONE),
            subsurface_radius: ScalarInput::constant(0.0),
            specular_weight: ScalarInput::constant(1.0),
            specular_roughness: ScalarInput::constant(roughness),
            ..translucent()
        };
        let mut scene = scene(vec![sphere(1.0, 64)], material);
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        for x in [0.0, 0.5, 0.9] {
            let (mean, error) = measure(&renderer, Vec3::new(x, 0.0, 3.0), Vec3::NEG_Z, samples(1 << 15));
            let z = (mean.x - 1.0) / error.x;
            // The tabulated albedo of the interface is good to 2e-3.
            assert!(
                z.abs() < 4.0 || (mean.x - 1.0).abs() < 3e-3,
                "roughness {roughness}, x {x}: {mean} ± {error}"
            );
        }
    }
}

/// Light from below comes with every sample that the camera takes of a glossy surface, whatever else is reflected there: if a
/// sample had one of the two, that choice alone would have a relative variance of 1/p − 1 = 0.6.
#[test]
fn gloss_adds_little_noise_to_light_from_below() {
    let [bare, glossy] = [0.0, 1.0].map(|weight| {
        let material = Material {
            specular_weight: ScalarInput::constant(weight),
            specular_ior: 2.0,
            subsurface_color: ColorInput::constant(GRAY),
            ..translucent()
        };
        let mut scene = scene(vec![quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3)], material);
        scene.environment = uniform_environment(Vec3::ONE);
        let renderer = prepare(scene);
        let samples: Vec<_> =
            (0..4096).map(|seed| sample_ray(&renderer, Vec3::Z, Vec3::NEG_Z, seed, 0)).collect();
        let reflects = samples.iter().filter(|sample| sample.specular.x > 0.0).count();
        assert_eq!(reflects > 0, weight > 0.0);
        let mean = |value: fn(f64) -> f64| {
            samples.iter().map(|sample| value(sample.subsurface.x.into())).sum::<f64>() / 4096.0
        };
        let mean_light = mean(|light| light);
        mean(|light| light * light) / mean_light.powi(2) - 1.0
    });
    assert!(glossy < bare + 0.1, "{glossy} {bare}");
}

/// Objects of different groups share no light, of the same group they do.
#[test]
fn groups_keep_light_apart() {
    for (group, expects_light) in [(0, true), (1, false)] {
        let top = quad(Vec3::ZERO, Vec3::X * 1e3, Vec3::Y * 1e3);
        let bottom = quad(Vec3::NEG_Z * 0.3, Vec3::Y * 1e3, Vec3::X * 1e3);
        let mut scene = scene(vec![top, bottom], translucent());
        scene.objects[1].subsurface_group = group;
        scene.lights.push(distant(Vec3::NEG_Z));
        let (mean, _) = measure(&prepare(scene), Vec3::Z, Vec3::NEG_Z, 1 << 12);
        assert_eq!(mean.x > 0.0, expects_light, "{mean}");
    }
}
