//! Lights on a device against those of the processor.
//!
//! Numbers are independent with fixed seeds. A mean counts as right within 4.5 standard errors (false-alarm rate 7e-6 a
//! comparison, below 1 % over the thousand or so of this file) plus a relative 2e-5 for single precision.

mod scenes;

use glam::Vec3;
use translucid_render::device::{LightWords, light_set, lights};
use translucid_render::internals::LightSample;
use translucid_testing::{SplitMix, power};

use super::evaluate::Evaluation;
use crate::program::{LAWS, LIGHT_SHADERS, constants};
use scenes::{Case, RED, all_kinds, by_power, many, maps, single_lights};

/// Words before those of the lights: they need not stand first.
const BEFORE: usize = 3;

/// Runs statements for every input; `lights_at` is set.
fn run(words: &LightWords, body: &str, widths: [usize; 2], inputs: &[f32]) -> Vec<f32> {
    let tables = [vec![7.0; BEFORE], words.tables.clone()].concat();
    let body = format!("lights_at = {BEFORE}u;\n{body}");
    let constants = constants();
    let shaders = [&LAWS[..], &[&constants], &LIGHT_SHADERS].concat();
    Evaluation { shaders: &shaders, body: &body, tables: &tables, images: &words.images, widths }.run(inputs)
}

const SAMPLE: &str = "
    let point = vec3f(inputs[i], inputs[i + 1], inputs[i + 2]);
    let normal = vec3f(inputs[i + 3], inputs[i + 4], inputs[i + 5]);
    let odds = light_odds(point, normal);
    let s = light_sample(point, normal, inputs[i + 6], vec2f(inputs[i + 7], inputs[i + 8]));
    var queried = -1.0;
    if (s.triangle != NO_TRIANGLE) {
        queried = emissive_triangle_pdf(odds, s.triangle, point, point + s.direction * s.distance);
    } else if (s.distance >= INFINITE_DISTANCE) {
        queried = environment_pdf(odds, normal, s.direction);
    } else {
        let hit = light_intersect(point, s.direction, INFINITE_DISTANCE, false);
        if (hit.is_hit && abs(hit.t - s.distance) <= 1e-3 * s.distance) {
            queried = light_hit_pdf(odds, hit, point);
        }
    }
    outputs[o] = select(0.0, 1.0, s.is_usable);
    outputs[o + 1] = select(0.0, 1.0, s.is_delta);
    outputs[o + 2] = s.direction.x;
    outputs[o + 3] = s.direction.y;
    outputs[o + 4] = s.direction.z;
    outputs[o + 5] = s.distance;
    outputs[o + 6] = s.radiance.x;
    outputs[o + 7] = s.radiance.y;
    outputs[o + 8] = s.radiance.z;
    outputs[o + 9] = s.pdf;
    outputs[o + 10] = queried;
";

/// A sample as the processor has it, with the density of the query functions (below 0 where the ray missed the light).
struct Drawn {
    sample: LightSample,
    queried: f32,
}

/// Samples at points with normals by independent numbers; none where it is not usable.
fn samples(words: &LightWords, at: &[(Vec3, Vec3)], seed: u64) -> Vec<Option<Drawn>> {
    let mut random = SplitMix(seed);
    let input = |(point, normal): &(Vec3, Vec3)| {
        let numbers = [(); 3].map(|()| random.uniform_f32());
        [point.to_array(), normal.to_array(), numbers].concat()
    };
    let inputs: Vec<f32> = at.iter().flat_map(input).collect();
    let drawn = |out: &[f32]| {
        let vector = |at: usize| Vec3::from_slice(&out[at..]);
        let sample = LightSample {
            direction: vector(2),
            distance: out[5],
            radiance: vector(6),
            pdf: out[9],
            is_delta: out[1] > 0.0,
            primitive: None,
        };
        (out[0] > 0.0).then_some(Drawn { sample, queried: out[10] })
    };
    run(words, SAMPLE, [9, 11], &inputs).chunks(11).map(drawn).collect()
}

fn direction(random: &mut SplitMix) -> Vec3 {
    let z = 1.0 - 2.0 * random.uniform();
    let (sin, cos) = (std::f64::consts::TAU * random.uniform()).sin_cos();
    let r = (1.0 - z * z).sqrt();
    glam::DVec3::new(r * cos, r * sin, z).as_vec3()
}

/// Points near the lights of a case and up to 100 times as far, with normals; every third takes light from all directions.
fn receivers(count: usize, seed: u64) -> Vec<(Vec3, Vec3)> {
    let mut random = SplitMix(seed);
    let receiver = |index: usize| {
        let distance = 10.0_f32.powf(3.0 * random.uniform_f32() - 1.0);
        let point = direction(&mut random) * distance;
        let normal = if index % 3 == 2 { Vec3::ZERO } else { direction(&mut random) };
        (point, normal)
    };
    (0..count).map(receiver).collect()
}

/// Means with standard errors of what samples estimate: the moments 1, x, y and z of the light about a point, or where there is
/// a normal the irradiance.
#[derive(Clone, Default)]
struct Moments {
    count: f64,
    sums: [f64; 4],
    squares: [f64; 4],
}

impl Moments {
    fn add(&mut self, normal: Vec3, sample: Option<&LightSample>) {
        self.count += 1.0;
        let Some(sample) = sample else { return };
        let weight = f64::from(sample.radiance.x) / f64::from(sample.pdf);
        let direction = sample.direction.to_array().map(f64::from);
        let moments = if normal == Vec3::ZERO {
            [1.0, direction[0], direction[1], direction[2]]
        } else {
            [f64::from(sample.direction.dot(normal).max(0.0)), 0.0, 0.0, 0.0]
        };
        for (k, moment) in moments.into_iter().enumerate() {
            self.sums[k] += weight * moment;
            self.squares[k] += (weight * moment).powi(2);
        }
    }

    /// Mean and squared standard error.
    fn mean(&self, k: usize) -> (f64, f64) {
        let mean = self.sums[k] / self.count;
        (mean, (self.squares[k] / self.count - mean * mean).max(0.0) / self.count)
    }
}

#[test]
fn samples_have_the_means_of_the_processor() {
    let mut random = SplitMix(3);
    for case in single_lights().into_iter().chain(maps()).chain([all_kinds(), many(), by_power()]) {
        let (set, words) = (light_set(&case.prepared), lights(&case.prepared).unwrap());
        let places: Vec<(Vec3, Vec3)> = case
            .points
            .iter()
            .flat_map(|&point| [(point, Vec3::ZERO), (point, direction(&mut random)), (point, Vec3::Z)])
            .collect();
        let at: Vec<_> = places.iter().copied().cycle().take(power(1 << 18) as usize).collect();
        let mut means = vec![[Moments::default(), Moments::default()]; places.len()];
        for (index, drawn) in samples(&words, &at, 4).into_iter().enumerate() {
            let place = index % places.len();
            let (point, normal) = places[place];
            let [ours, expected] = &mut means[place];
            ours.add(normal, drawn.map(|drawn| drawn.sample).as_ref());
            let [a, b, c] = [(); 3].map(|()| random.uniform_f32());
            expected.add(normal, set.sample(point, normal, a, [b, c]).as_ref());
        }
        for ([ours, expected], at) in means.iter().zip(&places) {
            for k in 0..4 {
                let ((a, a2), (b, b2)) = (ours.mean(k), expected.mean(k));
                let error = (a2 + b2).sqrt();
                let allowed = 4.5 * error + 2e-5 * expected.mean(0).0;
                assert!(
                    (a - b).abs() <= allowed,
                    "{} at {at:?}: mean {k} is {a}, not {b}, ± {error}",
                    case.name
                );
            }
        }
    }
}

/// MIS needs it. Off by more than 1e-3 is what lies at the rim of an ellipse that is seen at a slant: the strip there is short,
/// and its place has few digits. A ray may miss the rim of a light, or meet another light before it.
#[test]
fn samples_state_the_density_of_the_queries() {
    for case in single_lights().into_iter().chain(maps()).chain([all_kinds(), many(), by_power()]) {
        let words = lights(&case.prepared).unwrap();
        let mut at = receivers(12_000, 7);
        at.extend(case.points.iter().map(|&point| (point, Vec3::ZERO)).cycle().take(4000));
        let (mut compared, mut off, mut missed) = (0, 0, 0);
        for (drawn, at) in samples(&words, &at, 8).into_iter().zip(&at) {
            let Some(Drawn { sample, queried }) = drawn.filter(|drawn| !drawn.sample.is_delta) else {
                continue;
            };
            compared += 1;
            if queried < 0.0 {
                missed += 1;
                continue;
            }
            let error = (queried / sample.pdf - 1.0).abs();
            off += u32::from(error > 1e-3);
            assert!(error < 0.05, "{} at {at:?}: {queried} from queries, {sample:?}", case.name);
        }
        let (name, is_ellipse) = (case.name, case.name.contains("ellipse"));
        assert!(compared > 1000 && missed * 200 < compared, "{name}: {missed} of {compared} missed");
        assert!(off * 200 < compared && (is_ellipse || off == 0), "{name}: {off} of {compared} off");
    }
}

#[test]
fn rays_meet_the_lights_of_the_processor() {
    let body = "
        let hit = light_intersect(vec3f(inputs[i], inputs[i + 1], inputs[i + 2]),
            vec3f(inputs[i + 3], inputs[i + 4], inputs[i + 5]), inputs[i + 6], inputs[i + 7] > 0.0);
        outputs[o] = select(-1.0, hit.t, hit.is_hit);
        outputs[o + 1] = hit.radiance.x;";
    for case in
        single_lights().into_iter().chain([all_kinds(), many(), by_power()]).filter(|case| case.has_surface)
    {
        let (set, words) = (light_set(&case.prepared), lights(&case.prepared).unwrap());
        let mut random = SplitMix(11);
        let mut ray = |(origin, _): (Vec3, Vec3)| {
            let target = case.middle + direction(&mut random) * (1.2 * random.uniform_f32());
            let direction = (target - origin).normalize();
            let t_max = if random.uniform() < 0.5 {
                1e30
            } else {
                2.0 * random.uniform_f32() * origin.distance(target)
            };
            (origin, direction, t_max, random.uniform() < 0.5)
        };
        let rays: Vec<_> = receivers(20_000, 12).into_iter().map(&mut ray).collect();
        let inputs: Vec<f32> = rays
            .iter()
            .flat_map(|&(o, d, t, camera)| [o.x, o.y, o.z, d.x, d.y, d.z, t, f32::from(u8::from(camera))])
            .collect();
        let (mut hits, mut differ) = (0, 0);
        for (found, &(origin, direction, t_max, camera)) in
            run(&words, body, [8, 2], &inputs).chunks(2).zip(&rays)
        {
            let expected = if camera {
                set.intersect_visible(origin, direction, t_max)
            } else {
                set.intersect(origin, direction, t_max)
            };
            let (t, radiance) = expected.map_or((-1.0, 0.0), |hit| (hit.t, hit.radiance.x));
            hits += u32::from(expected.is_some());
            let is_equal = (found[0] - t).abs() <= 1e-3 * t.abs()
                && (found[1] - radiance).abs() <= 1e-3 * radiance + 1e-5 * RED;
            differ += u32::from(!is_equal);
        }
        assert!(hits > 200 && differ * 200 < hits, "{}: {hits} hits, {differ} differ", case.name);
    }
}

const BY_DIRECTION: &str = "
    let direction = vec3f(inputs[i], inputs[i + 1], inputs[i + 2]);
    let radiance = environment_radiance(direction);
    let background = background_radiance(direction);
    outputs[o] = radiance.x;
    outputs[o + 1] = radiance.y;
    outputs[o + 2] = radiance.z;
    outputs[o + 3] = background.x;
    outputs[o + 4] = environment_pdf(light_odds(vec3f(0.0), vec3f(0.0)), vec3f(0.0), direction);
    let normal = vec3f(0.48, -0.6, 0.64);
    outputs[o + 5] = environment_pdf(light_odds(vec3f(0.0), normal), normal, direction);
    outputs[o + 6] = select(0.0, 1.0, environment_is_visible());";

#[test]
fn light_from_infinity_is_that_of_the_processor() {
    let infinite = |case: &Case| !case.has_surface && case.is_infinite;
    for case in single_lights().into_iter().filter(infinite).chain(maps()) {
        let (set, words) = (light_set(&case.prepared), lights(&case.prepared).unwrap());
        let mut random = SplitMix(13);
        let mut directions: Vec<Vec3> = (0..200_000).map(|_| direction(&mut random)).collect();
        directions.extend([Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|axis| [axis, -axis]));
        let inputs: Vec<f32> = directions.iter().flat_map(|d| d.to_array()).collect();
        let (mut differ, mut densities) = (0, [(0.0, 0.0); 2]);
        for (found, &d) in run(&words, BY_DIRECTION, [3, 7], &inputs).chunks(7).zip(&directions) {
            let expected = set.environment_radiance(d);
            let error = (Vec3::from_slice(found) - expected).abs();
            let is_equal = error.cmple(1e-3 * expected.abs() + 1e-5 * case.peak).all();
            let background = (found[3] - set.background_radiance(d).x).abs();
            differ += u32::from(!is_equal || background > 1e-3 * found[3].abs() + 1e-5 * case.peak);
            for (k, (sum, squares)) in densities.iter_mut().enumerate() {
                let density = 4.0 * std::f64::consts::PI * f64::from(found[4 + k]);
                *sum += density;
                *squares += density * density;
            }
            assert_eq!(found[6] > 0.0, set.environment_visible());
        }
        // A disc has a rim
        assert!(differ <= 3, "{}: {differ} differ", case.name);
        let n = directions.len() as f64;
        for (sum, squares) in densities {
            let (mean, error) = (sum / n, (squares / n - (sum / n).powi(2)).max(0.0).sqrt() / n.sqrt());
            assert!(
                (mean - 1.0).abs() <= 4.5 * error + 2e-5,
                "{}: density sums to {mean} ± {error}",
                case.name
            );
        }
    }
}

#[test]
fn triangles_have_their_numbers() {
    let case = all_kinds();
    let (set, words) = (light_set(&case.prepared), lights(&case.prepared).unwrap());
    let body = "let odds = light_odds(vec3f(0.0), vec3f(0.0)); let to = vec3f(inputs[i + 1], inputs[i + 2], inputs[i + 3]); \
                outputs[o] = emissive_triangle_pdf(odds, u32(inputs[i]), vec3f(0.0), to); outputs[o + 1] = 0.0;";
    let mut compared = 0;
    for (primitive, triangle) in (0..).zip(&case.triangles) {
        let Some(number) = words.triangle(primitive) else { continue };
        let center = triangle.iter().sum::<Vec3>() / 3.0;
        let normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]).normalize();
        let expected = set.triangle_pdf(primitive, Vec3::ZERO, Vec3::ZERO, center, normal);
        let found = run(&words, body, [4, 2], &[number as f32, center.x, center.y, center.z])[0];
        assert!((found - expected).abs() <= 1e-3 * expected, "{primitive}: {found}, {expected}");
        compared += u32::from(expected > 0.0);
    }
    assert!(compared > 0 && words.triangle(1 << 20).is_none());
}

#[test]
fn too_many_lights_are_refused() {
    let case = scenes::spheres(4097);
    let message = lights(&case.prepared).unwrap_err().to_string();
    assert!(message.contains("4097 lights with a surface") && message.contains("up to 4096"), "{message}");
}
