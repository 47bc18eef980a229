//! Many lights: the tree against sums over all lights, and against the ways of selection that need no tree.
//!
//! Draws are independent with fixed seeds; a mean counts as right within four and a half standard errors (false-alarm
//! rate 7e-6 a comparison, below 1 % over the thousand or so of this file).

use translucid_scene::Light;

use super::*;

/// Uniform numbers of their own for light or receiver `index`.
fn random(seed: u64, index: u32) -> [f32; 8] {
    let ([a, b, c, d], [e, f, g, h]) = (numbers(seed, index), numbers(seed + 1000, index));
    [a, b, c, d, e, f, g, h]
}

/// A light with a power over six decades at a random place of a 20 × 20 × 4 hall: a sphere, a rectangle or a spot.
fn lamp(index: u32) -> Light {
    let [x, y, z, turn, tilt, power, size, angle] = random(31, index);
    let place = Vec3::new(20.0 * x - 10.0, 20.0 * y - 10.0, 4.0 * z);
    let direction = translucid_law::uniform_sphere([turn, tilt]);
    let frame = crate::sampling::Frame::from_normal(direction);
    let size = 0.02 + 0.3 * size * size;
    let radiance = RADIANCE * 10.0_f32.powf(6.0 * power - 3.0);
    match index % 3 {
        0 => Light::Sphere { center: place, radius: size, radiance, visible: true },
        1 => Light::Rectangle {
            center: place,
            edge_x: frame.x * size,
            edge_y: frame.y * (3.0 * size),
            radiance,
            visible: true,
        },
        _ => {
            let (inner_angle, outer_angle) = (60.0 * angle, 60.0 * angle + 20.0);
            Light::Spot {
                position: place,
                direction,
                radius: 0.0,
                intensity: radiance * size,
                inner_angle,
                outer_angle,
                visible: true,
            }
        }
    }
}

/// An emissive triangle of the hall.
fn shard(index: u32) -> EmissiveTriangle {
    let [x, y, z, turn, tilt, power, ..] = random(33, index);
    let place = Vec3::new(20.0 * x - 10.0, 20.0 * y - 10.0, 4.0 * z);
    let frame = crate::sampling::Frame::from_normal(translucid_law::uniform_sphere([turn, tilt]));
    let vertices = [place, place + 0.2 * frame.x, place + 0.3 * frame.y];
    let radiance = RADIANCE * 10.0_f32.powf(6.0 * power - 3.0);
    EmissiveTriangle { vertices, radiance, primitive: 7 + 3 * u64::from(index) }
}

/// Lamps, shards, two lights at infinity, a beam and the sky.
fn hall(count: u32) -> LightSet {
    let mut lights: Vec<Light> = (0..count).map(lamp).collect();
    lights.push(Light::Distant { direction: Vec3::Z, angular_radius: 3.0, irradiance: RADIANCE });
    lights.push(Light::Beam { origin: Vec3::Z * 9.0, direction: Vec3::NEG_Z, radius: 5.0, power: RADIANCE });
    light_set(lights, (0..count / 3).map(shard).collect(), Some(constant_sky()))
}

/// Points of the hall with normals; every fourth takes light from all directions.
fn receivers(count: u32) -> impl Iterator<Item = Receiver> {
    (0..count).map(|index| {
        let [x, y, z, a, b, ..] = random(37, index);
        let point = Vec3::new(24.0 * x - 12.0, 24.0 * y - 12.0, 4.0 * z);
        let normal = if index % 4 == 3 { Vec3::ZERO } else { translucid_law::uniform_sphere([a, b]) };
        Receiver { point, normal }
    })
}

const WAYS: [LightSelection; 3] = [LightSelection::Power, LightSelection::Weighed, LightSelection::Tree];

/// The sum falls short of 1 by the share of random numbers that lead to a cluster none of whose lights can contribute: its
/// bounds are too wide. Strata of random numbers give that share to one in 500.
#[test]
fn probabilities_of_all_lights_sum_to_one_with_that_of_none() {
    let strata = 2000;
    for count in [1, 3, 8, 9, 60, 700] {
        let hall = hall(count);
        for way in WAYS {
            let lights = hall.clone().with_selection(way);
            for receiver in receivers(24) {
                let odds = (0..lights.emitters.len()).map(|light| lights.probability(&receiver, light));
                let sum: f64 = odds.map(f64::from).sum();
                let chosen = (0..strata).filter(|&i| {
                    let u = (f64::from(i) + 0.5) / f64::from(strata);
                    lights.selection.choose(&lights.emitters, &receiver, u).is_some()
                });
                let share = chosen.count() as f64 / f64::from(strata);
                assert!(sum < 1.0 + 1e-5, "{count} lights, {way:?}: {sum}");
                assert!((sum - share).abs() < 2e-3, "{count} lights, {way:?}: {sum}, chosen {share}");
                assert!(sum > 1.0 - 1e-5 || way == LightSelection::Tree, "{count} lights, {way:?}: {sum}");
                assert!(sum > 0.3, "{count} lights, {way:?}: {sum}");
            }
        }
    }
}

#[test]
fn choose_states_the_probability_of_the_query() {
    let mut chosen = 0;
    for count in [1, 8, 60, 2000] {
        let hall = hall(count);
        for way in WAYS {
            let lights = hall.clone().with_selection(way);
            for (index, receiver) in receivers(60).enumerate() {
                let u = f64::from(numbers(41, index as u32)[0]);
                let choice = lights.selection.choose(&lights.emitters, &receiver, u);
                let Some((light, stated)) = choice else { continue };
                let asked = lights.probability(&receiver, light);
                assert!((asked - stated).abs() <= 1e-5 * asked, "{way:?}: {stated}, asked {asked}");
                chosen += 1;
            }
        }
    }
    assert!(chosen > 700, "{chosen}");
}

#[test]
fn no_light_that_can_contribute_is_left_out() {
    let lights = hall(400).with_selection(LightSelection::Tree);
    let mut contributing = 0;
    for (index, receiver) in receivers(400).enumerate() {
        for light in 0..lights.emitters.len() {
            let [a, b, ..] = numbers(43, (index * 1000 + light) as u32);
            let Some(sample) = lights.emitters.sample(light, receiver.point, [a, b]) else { continue };
            if sample.is_usable() && receiver.cosine(sample.direction) > 0.0 {
                contributing += 1;
                let probability = lights.probability(&receiver, light);
                assert!(probability > 0.0, "light {light} at {receiver:?}: {sample:?}");
            }
        }
    }
    assert!(contributing > 20_000, "{contributing}");
}

/// The border of a spot's cone and the rim of a rectangle's horizon, where bounds have to hold by a hair.
#[test]
fn lights_that_graze_are_not_left_out() {
    let spot = |i: u32| Light::Spot {
        radius: 0.0,
        visible: true,
        position: Vec3::new(3.0 * i as f32, 0.0, 1.0),
        direction: Vec3::NEG_Z,
        intensity: RADIANCE,
        inner_angle: 44.0,
        outer_angle: 45.0,
    };
    let wall = |i: u32| rectangle(Vec3::new(3.0 * i as f32, 0.0, 0.0), Vec3::X * 0.1, Vec3::Z * 0.1);
    let lights: Vec<Light> = (0..40).map(|i| if i < 20 { spot(i) } else { wall(i) }).collect();
    let lights = light_set(lights, Vec::new(), None).with_selection(LightSelection::Tree);
    for i in 0..40 {
        for angle in 0..64 {
            let (sin, cos) = (angle as f32 / 64.0 * std::f32::consts::TAU).sin_cos();
            let around = Vec3::new(3.0 * i as f32, 0.0, 0.0) + Vec3::new(cos, sin, 0.0) * 0.999;
            let receiver = Receiver { point: around, normal: Vec3::Z };
            for light in 0..40 {
                let sample = lights.emitters.sample(light, around, [0.9, 0.9]);
                let shines = sample.is_some_and(|s| s.is_usable() && receiver.cosine(s.direction) > 0.0);
                assert!(!shines || lights.probability(&receiver, light) > 0.0, "{light} at {around}");
            }
        }
    }
}

/// Walls of the hall along x = −3 and x = 4 up to a height of 3, with a door in each.
fn walled_off(from: Vec3, direction: Vec3, distance: f32) -> bool {
    [(-3.0, 2.0), (4.0, -6.0)].into_iter().any(|(wall, door): (f32, f32)| {
        let t = (wall - from.x) / direction.x;
        let at = from + direction * t;
        t > 0.0 && t < distance && at.z < 3.0 && (at.y - door).abs() > 1.0
    })
}

/// Mean and variance of a draw of the red irradiance by lights that are not walled off.
fn draws(
    count: u32,
    seed: u64,
    receiver: &Receiver,
    draw: impl Fn([f32; 4]) -> Option<LightSample>,
) -> (f64, f64) {
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in 0..count {
        if let Some(light) = draw(numbers(seed, index)) {
            let sight = !walled_off(receiver.point, light.direction, light.distance);
            let cosine = if sight { light.direction.dot(receiver.normal).max(0.0) } else { 0.0 };
            let value = f64::from(light.radiance.x) * f64::from(cosine) / f64::from(light.pdf);
            sum += value;
            squares += value * value;
        }
    }
    let n = f64::from(count);
    (sum / n, (squares / n - (sum / n).powi(2)).max(0.0))
}

fn by_selection(lights: &LightSet, receiver: &Receiver, count: u32) -> (f64, f64) {
    draws(count, 47, receiver, |[u, a, b, _]| lights.sample(receiver.point, receiver.normal, u, [a, b]))
}

/// The sum over all lights, each sampled by itself, with the variance of the sum's mean.
fn light_by_light(lights: &LightSet, receiver: &Receiver) -> (f64, f64) {
    let (mut sum, mut variance) = (0.0, 0.0);
    let count = 100;
    for light in 0..lights.emitters.len() {
        let (mean, spread) = draws(count, 100 + light as u64, receiver, |[a, b, ..]| {
            match lights.emitters.sources.get(light) {
                Some(source) if source.is_infinite() => {
                    let alone = LightSet { selection: Selection::Weighed, ..lights.clone() };
                    let only = Emitters { sources: vec![source.clone()], triangles: Vec::new() };
                    LightSet { emitters: only, infinite: vec![0], environment: None, ..alone }.sample(
                        receiver.point,
                        receiver.normal,
                        0.0,
                        [a, b],
                    )
                }
                _ => lights.emitters.sample(light, receiver.point, [a, b]).filter(LightSample::is_usable),
            }
        });
        sum += mean;
        variance += spread / f64::from(count);
    }
    (sum, variance)
}

#[test]
fn a_thousand_lights_behind_walls_shed_the_sum_of_their_light() {
    let mut hall: Vec<Light> = (0..1000).map(lamp).collect();
    hall.push(sphere(Vec3::Z, 0.0));
    let shards: Vec<_> = (0..200).map(shard).collect();
    let lights = light_set(hall, shards, None);
    assert!(matches!(lights.selection, Selection::Tree { .. }), "the tree is what suits them");
    let count = 40_000;
    for receiver in receivers(24).filter(Receiver::has_normal) {
        let (expected, known) = light_by_light(&lights, &receiver);
        let (mean, variance) = by_selection(&lights, &receiver, count);
        let error = (variance / f64::from(count) + known).sqrt();
        let allowed = 4.5 * error + 1e-5 * expected;
        assert!((mean - expected).abs() <= allowed, "{receiver:?}: {mean} ± {error}, {expected}");
    }
}

#[test]
fn lights_beside_the_tree_shed_theirs() {
    let lights = hall(40);
    let count = 40_000;
    for receiver in receivers(8).filter(Receiver::has_normal) {
        let (expected, known) = light_by_light(&lights, &receiver);
        let (mean, variance) = by_selection(&lights, &receiver, count);
        let error = (variance / f64::from(count) + known).sqrt();
        assert!((mean - expected).abs() <= 4.5 * error, "{receiver:?}: {mean} ± {error}, {expected}");
    }
}

/// Variance of one draw over the square of the mean, averaged over receivers, by way of selection.
#[test]
fn tree_is_nearly_as_quiet_as_weighing_every_light() {
    let hall = light_set((0..1000).map(lamp).collect(), (0..200).map(shard).collect(), None);
    // Nine of twelve have normals
    let count = if translucid_testing::is_thorough() { 48 } else { 12 };
    let [power, weighed, tree] = WAYS.map(|way| {
        let lights = hall.clone().with_selection(way);
        let relative = receivers(count).filter(Receiver::has_normal).map(|receiver| {
            let (mean, variance) = by_selection(&lights, &receiver, 4000);
            variance / (mean * mean)
        });
        let logarithms: Vec<f64> = relative.filter(|x| x.is_finite() && *x > 0.0).map(f64::ln).collect();
        (logarithms.iter().sum::<f64>() / logarithms.len() as f64).exp()
    });

    assert!(tree < 5.0 * weighed, "tree {tree}, every light weighed {weighed}, power {power}");
    assert!(tree < 0.05 * power, "tree {tree}, power {power}");
}

#[test]
fn mesh_of_triangles_sheds_what_the_same_rectangles_shed() {
    let panel = |i: u32| {
        let [x, y, z, a, b, ..] = random(51, i);
        let frame = crate::sampling::Frame::from_normal(translucid_law::uniform_sphere([a, b]));
        (Vec3::new(8.0 * x - 4.0, 8.0 * y - 4.0, 2.0 + z), 0.5 * frame.x, 0.7 * frame.y)
    };
    let rectangles = (0..60).map(|i| {
        let (center, x, y) = panel(i);
        rectangle(center, x, y)
    });
    let triangles = (0..60).flat_map(|i| {
        let (center, x, y) = panel(i);
        let corner = |s: f32, t: f32| center + s * x + t * y;
        let [a, b, c, d] = [corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        [triangle(2 * i, [a, b, c]), triangle(2 * i + 1, [a, c, d])]
    });
    let of_rectangles = light_set(rectangles.collect(), Vec::new(), None);
    let of_triangles = light_set(Vec::new(), triangles.collect(), None);
    for index in 0..12 {
        let [x, y, ..] = random(53, index);
        let (point, normal) = (Vec3::new(6.0 * x - 3.0, 6.0 * y - 3.0, 0.0), Vec3::Z);
        let (a, a_error) = irradiance(&of_rectangles, point, normal, normal, 30_000);
        let (b, b_error) = irradiance(&of_triangles, point, normal, normal, 30_000);
        let allowed = 4.5 * (a_error * a_error + b_error * b_error).sqrt();
        assert!((a - b).abs() < allowed, "{point}: {a} ± {a_error}, {b} ± {b_error}");
        assert!(allowed < 0.2 * a, "{point}: too noisy to tell, {a} ± {a_error}, {b} ± {b_error}");
    }
}

#[test]
fn rays_meet_the_same_lights_with_and_without_a_hierarchy() {
    let lights: Vec<Light> = (0..900).map(lamp).collect();
    let lights = light_set(lights, Vec::new(), None);
    let one_by_one: Vec<LightSet> = (0..900).map(|i| of_light(lamp(i))).collect();
    let mut met = 0;
    for (index, receiver) in receivers(3000).enumerate() {
        let [a, b, limit, _] = numbers(57, index as u32);
        let direction = translucid_law::uniform_sphere([a, b]);
        let t_max = if limit < 0.5 { f32::INFINITY } else { 20.0 * limit };
        let each = one_by_one.iter().filter_map(|one| one.intersect(receiver.point, direction, t_max));
        let nearest = each.map(|hit| hit.t).reduce(f32::min);
        let found = lights.intersect(receiver.point, direction, t_max).map(|hit| hit.t);
        assert_eq!(found, nearest, "{receiver:?} {direction}");
        met += u32::from(found.is_some());
    }
    assert!(met > 100, "{met}");
}

#[test]
fn invisible_lights_are_looked_through_in_a_hierarchy() {
    let mut lights: Vec<Light> = (0..100).map(|i| sphere(Vec3::new(i as f32, 5.0, 0.0), 0.1)).collect();
    lights.push(Light::Sphere { center: Vec3::Z, radius: 0.5, radiance: RADIANCE, visible: false });
    lights.push(Light::Sphere { center: Vec3::Z * 3.0, radius: 0.5, radiance: RADIANCE, visible: true });
    let lights = light_set(lights, Vec::new(), None);
    assert_eq!(lights.intersect(Vec3::ZERO, Vec3::Z, f32::INFINITY).unwrap().t, 0.5);
    assert_eq!(lights.intersect_visible(Vec3::ZERO, Vec3::Z, f32::INFINITY).unwrap().t, 2.5);
}

#[test]
fn any_arrangement_of_lights_makes_a_tree() {
    let alike: Vec<Light> = (0..5000).map(|_| sphere(Vec3::Z, 0.1)).collect();
    let shrinking: Vec<Light> = (0..200).map(|i| sphere(Vec3::Z * 0.7_f32.powi(i), 1e-5)).collect();
    let line: Vec<Light> = (0..3000).map(|i| sphere(Vec3::X * i as f32, 0.1)).collect();
    for (name, lights) in [("alike", alike), ("shrinking", shrinking), ("line", line)] {
        let lights = light_set(lights, Vec::new(), None);
        let receiver = Receiver { point: Vec3::NEG_Z, normal: Vec3::Z };
        let odds = (0..lights.emitters.len()).map(|light| f64::from(lights.probability(&receiver, light)));
        let sum: f64 = odds.sum();
        assert!((sum - 1.0).abs() < 1e-3, "{name}: {sum}");
    }
}

#[test]
fn a_tree_stays_finite_at_any_scale() {
    let all = light_set(extreme_lights(), Vec::new(), Some(sunny(5, 3)));
    assert_sane(&all.with_selection(LightSelection::Tree), "all extremes in a tree");
    for light in extreme_lights() {
        assert_sane(&of_light(light).with_selection(LightSelection::Tree), &format!("{light:?} in a tree"));
    }
}

#[test]
fn lights_that_are_black_or_have_no_size_are_in_no_tree() {
    let mut lights: Vec<Light> = (0..40).map(lamp).collect();
    lights.push(sphere(Vec3::Z, 0.0));
    lights.push(rectangle(Vec3::Z, Vec3::X, Vec3::ZERO));
    lights.push(Light::Sphere { center: Vec3::Z, radius: 1.0, radiance: Vec3::ZERO, visible: true });
    let black = EmissiveTriangle { radiance: Vec3::ZERO, ..shard(1) };
    let flat = EmissiveTriangle { vertices: [Vec3::Z; 3], ..shard(2) };
    let lights = light_set(lights, vec![black, flat, shard(3)], None);
    assert_eq!(lights.emitters.len(), 41);
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let lights = pool.install(|| light_set((0..9000).map(lamp).collect(), Vec::new(), None));
        let choices = receivers(200).enumerate().map(move |(index, receiver)| {
            let u = f64::from(numbers(59, index as u32)[0]);
            lights.selection.choose(&lights.emitters, &receiver, u)
        });
        choices.collect::<Vec<_>>()
    };
    assert_eq!(build(1), build(3));
}
