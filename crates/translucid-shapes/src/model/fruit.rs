//! Fruit: apple, pear, orange and its half, grapes, melon slice.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{ball, blend, blend_stalk, carve, common, round_cone, smoothstep, stalk};
use crate::implicit::noise::{cell_distance, fractal_noise, noise};
use crate::implicit::sculpture::{detail, height, sculpt, srgb};
use crate::parameters::{ShapeParameter, Values};

const SEED: ShapeParameter = ShapeParameter::count("seed", 1.0, 0.0, 65535.0);

/// Distance from the y axis.
fn radius_about_y(p: Vec3) -> f32 {
    Vec2::new(p.x, p.z).length()
}

/// Angle about the y axis in (−π, π].
fn angle_about_y(p: Vec3) -> f32 {
    libm::atan2f(p.x, p.z)
}

pub(crate) const APPLE: &[ShapeParameter] = &[height(7.6), detail(110.0), SEED];

/// The outside of a ring that overlaps itself has an apple's two hollows.
fn apple_flesh(p: Vec3) -> f32 {
    let taper = 1.0 + 0.045 * p.y - 0.006 * p.y * p.y;
    let lobes = 1.0 + 0.016 * libm::cosf(5.0 * angle_about_y(p)) * smoothstep(0.5, -3.2, p.y);
    let r = radius_about_y(p) / (taper * lobes);
    0.85 * (Vec2::new(r - 1.3, 0.86 * p.y + 0.02 * p.x).length() - 2.6)
}

const APPLE_STALK: [Vec3; 4] = [
    Vec3::new(0.0, 1.6, 0.0),
    Vec3::new(0.08, 2.7, 0.02),
    Vec3::new(0.3, 3.5, 0.1),
    Vec3::new(0.7, 4.2, 0.3),
];

pub(crate) fn apple(values: &Values) -> Result<Mesh, SceneError> {
    let seed = values.count("seed") as u32;
    let stem = |p: Vec3| stalk(p, &APPLE_STALK, [0.13, 0.17]);
    let distance = |p: Vec3| blend_stalk(apple_flesh(p), p, &APPLE_STALK, [0.13, 0.17], 0.12);
    let color = move |p: Vec3, _: Vec3| {
        if stem(p) < 0.03 {
            return srgb(0x5a4326);
        }
        let angle = angle_about_y(p);
        let around = 2.2 * Vec2::from_angle(angle);
        let streaks = fractal_noise(Vec3::new(5.0 * around.x, 0.35 * p.y, 5.0 * around.y), 4, seed);
        let patches = fractal_noise(0.35 * p, 3, seed + 20);
        let hollow = smoothstep(1.3, 0.3, radius_about_y(p)) + 0.4 * smoothstep(-2.0, -3.0, p.y);
        let blush = (0.85 + 0.5 * libm::cosf(angle - 0.5) * 0.6 + 0.9 * streaks + 0.7 * patches
            - 1.1 * hollow)
            .clamp(0.0, 1.0);
        let speckle = smoothstep(0.16, 0.1, cell_distance(2.6 * p, seed + 40));
        let skin = srgb(0xe2c060).lerp(srgb(0xb31420), smoothstep(0.1, 0.9, blush));
        skin.lerp(srgb(0xf0d890), 0.35 * speckle)
    };
    let bounds = [Vec3::new(-4.2, -3.2, -4.2), Vec3::new(4.2, 4.5, 4.2)];
    Ok(sculpt(bounds, distance, color, values))
}

pub(crate) const PEAR: &[ShapeParameter] = &[height(10.5), detail(120.0), SEED];

const PEAR_STALK: [Vec3; 4] = [
    Vec3::new(0.25, 7.6, 0.0),
    Vec3::new(0.42, 8.9, 0.05),
    Vec3::new(0.75, 9.6, 0.15),
    Vec3::new(1.3, 10.2, 0.3),
];

pub(crate) fn pear(values: &Values) -> Result<Mesh, SceneError> {
    let seed = values.count("seed") as u32;
    let stem = |p: Vec3| stalk(p, &PEAR_STALK, [0.17, 0.2]);
    let distance = move |p: Vec3| {
        // The neck leans.
        let lean = 0.06 * smoothstep(3.0, 9.0, p.y) * (p.y - 3.0);
        let q = p - Vec3::new(lean, 0.0, 0.0);
        let body = ball((q - Vec3::new(0.0, 3.3, 0.0)) / Vec3::new(1.0, 0.96, 1.0), 3.35);
        let neck = round_cone(q, [Vec3::new(0.0, 4.2, 0.0), Vec3::new(0.0, 7.1, 0.0)], [2.2, 1.35]);
        let uneven = 0.07 * noise(0.45 * p, seed);
        let flesh = blend(body, neck, 2.2) + uneven;
        let dimple = ball(p - Vec3::new(0.0, -0.35, 0.0), 0.6);
        blend_stalk(carve(flesh, dimple, 0.5), p, &PEAR_STALK, [0.17, 0.2], 0.25)
    };
    let color = move |p: Vec3, _: Vec3| {
        if stem(p) < 0.04 {
            return srgb(0x54391f);
        }
        let blush =
            0.5 + 0.6 * libm::cosf(angle_about_y(p) - 0.9) + 0.7 * fractal_noise(0.5 * p, 3, seed + 9);
        let speckle = smoothstep(0.2, 0.1, cell_distance(3.6 * p, seed + 40));
        let russet = smoothstep(7.6, 8.8, p.y + 0.5 * fractal_noise(1.5 * p, 3, seed + 3));
        let skin = srgb(0xc9c04c).lerp(srgb(0xc8752e), 0.6 * smoothstep(0.6, 1.2, blush));
        let skin = skin.lerp(srgb(0x8f9a35), 0.5 * smoothstep(0.2, -0.4, blush));
        skin.lerp(srgb(0x7a5a2c), (0.4 * speckle).max(0.6 * russet))
    };
    let bounds = [Vec3::new(-3.7, -0.4, -3.7), Vec3::new(3.7, 10.6, 3.7)];
    Ok(sculpt(bounds, distance, color, values))
}

/// Radius of an orange in natural size.
const ORANGE_RADIUS: f32 = 3.8;

/// Skin of an orange with its pores.
fn orange_skin(p: Vec3, seed: u32) -> f32 {
    let smooth = ball(p / Vec3::new(1.0, 0.95, 1.0), ORANGE_RADIUS);
    if smooth.abs() > 0.3 {
        return 0.93 * smooth;
    }
    let pores = smoothstep(0.55, 0.0, cell_distance(4.6 * p, seed));
    let navel = smoothstep(0.55, 0.1, Vec3::new(p.x, p.y - 3.6, p.z).length());
    0.93 * smooth + 0.028 * pores + 0.04 * fractal_noise(0.6 * p, 2, seed + 5) + 0.12 * navel
}

fn orange_peel_color(p: Vec3, seed: u32) -> Vec3 {
    let mottled = 0.5 + 0.5 * fractal_noise(0.9 * p, 3, seed + 7);
    let skin = srgb(0xf08a12).lerp(srgb(0xe87008), mottled);
    let stalk = smoothstep(0.42, 0.3, Vec3::new(p.x, p.y - 3.55, p.z).length());
    skin.lerp(srgb(0x6c6a34), stalk)
}

pub(crate) const ORANGE: &[ShapeParameter] = &[height(7.4), detail(96.0), SEED];

pub(crate) fn orange(values: &Values) -> Result<Mesh, SceneError> {
    let seed = values.count("seed") as u32;
    let distance = move |p: Vec3| orange_skin(p, seed);
    let color = move |p: Vec3, _: Vec3| orange_peel_color(p, seed);
    Ok(sculpt([Vec3::splat(-4.0), Vec3::splat(4.0)], distance, color, values))
}

pub(crate) const ORANGE_HALF: &[ShapeParameter] =
    &[height(3.9), detail(170.0), SEED, ShapeParameter::count("wedges", 10.0, 4.0, 16.0)];

/// Where on the cut face of an orange a point lies.
struct CutFace {
    /// Distance from the axis.
    radius: f32,
    /// Distance from the nearest membrane \[cm\], ≥ 0.
    membrane: f32,
    /// Number of the wedge.
    wedge: f32,
}

fn cut_face(p: Vec3, wedges: usize, seed: u32) -> CutFace {
    let warp = 0.12 * fractal_noise(0.8 * p, 2, seed + 60);
    let radius = radius_about_y(p);
    let turn = (angle_about_y(p) + warp) / TAU * wedges as f32;
    let wedge = turn.round();
    // Uneven wedges: each membrane is shifted a little.
    let across = 0.5 - (turn - wedge).abs();
    CutFace {
        radius,
        membrane: across * TAU / wedges as f32 * radius,
        wedge: wedge.rem_euclid(wedges as f32),
    }
}

/// Outer radius of the pulp.
const PULP_RADIUS: f32 = 3.3;

/// 1 in the pulp, 0 in membranes and pith, smooth between.
fn pulp_amount(face: &CutFace) -> f32 {
    let rounded = face.membrane - 0.35 * smoothstep(PULP_RADIUS - 0.5, PULP_RADIUS, face.radius);
    smoothstep(0.02, 0.09, rounded)
        * smoothstep(PULP_RADIUS, PULP_RADIUS - 0.1, face.radius)
        * smoothstep(0.35, 0.55, face.radius)
}

pub(crate) fn orange_half(values: &Values) -> Result<Mesh, SceneError> {
    let (seed, wedges) = (values.count("seed") as u32, values.count("wedges"));
    // Juice sacs: drops drawn out along the radius.
    let sacs = move |p: Vec3, face: &CutFace| {
        let turn = angle_about_y(p);
        cell_distance(
            Vec3::new(1.3 * face.radius, 9.0 * turn * (0.4 + 0.2 * face.radius), face.wedge * 7.0),
            seed + 31,
        )
    };
    let distance = move |p: Vec3| {
        let body = orange_skin(p, seed);
        // Away from the cut face its relief does not matter.
        if p.y < -0.4 || body > 0.5 {
            return body;
        }
        if p.y > 0.5 {
            return body.max(p.y);
        }
        let face = cut_face(p, wedges, seed);
        let pulp = pulp_amount(&face);
        let relief = if pulp == 0.0 { -0.03 } else { pulp * (0.05 - 0.05 * sacs(p, &face)) - 0.03 };
        common(body, p.y - relief, 0.08)
    };
    let color = move |p: Vec3, n: Vec3| {
        let depth = -0.93 * ball(p / Vec3::new(1.0, 0.95, 1.0), ORANGE_RADIUS);
        if n.y < 0.35 || depth < 0.1 {
            return orange_peel_color(p, seed);
        }
        let face = cut_face(p, wedges, seed);
        let pith = srgb(0xf6e6c0).lerp(srgb(0xf09a20), smoothstep(0.24, 0.1, depth));
        let juice = srgb(0xf58a0a).lerp(srgb(0xffb638), smoothstep(0.1, 0.7, sacs(p, &face)));
        let membrane = srgb(0xf9cf80).lerp(pith, smoothstep(PULP_RADIUS - 0.2, PULP_RADIUS, face.radius));
        membrane.lerp(juice, pulp_amount(&face))
    };
    let bounds = [Vec3::new(-4.0, -4.0, -4.0), Vec3::new(4.0, 0.3, 4.0)];
    Ok(sculpt(bounds, distance, color, values))
}

pub(crate) const MELON_SLICE: &[ShapeParameter] = &[height(5.2), detail(110.0), SEED];

/// A wedge of watermelon lying on its rind's edge: red flesh, pale and green rind, dark seeds.
pub(crate) fn melon_slice(values: &Values) -> Result<Mesh, SceneError> {
    let seed = values.count("seed") as u32;
    let radius = 9.0;
    // The slice stands on its rind, centered over the origin; the melon's center is at its upper edge.
    let half_angle = 0.2 * PI;
    let distance = move |p: Vec3| {
        let rind = ball(p, radius);
        let side = Vec2::new(libm::cosf(half_angle), libm::sinf(half_angle));
        common(rind, p.z.abs() * side.x + p.y * side.y, 0.15)
    };
    let color = move |p: Vec3, _: Vec3| {
        let depth = radius - p.length();
        let stripes = smoothstep(-0.1, 0.25, noise(Vec3::new(0.35 * p.x, 1.3 * p.y, 1.3 * p.z), seed));
        let skin = srgb(0x2c5a24).lerp(srgb(0x7fa05a), stripes);
        let rind = skin.lerp(srgb(0xdfe6b4), smoothstep(0.08, 0.3, depth));
        let flesh = srgb(0xd8383c).lerp(srgb(0xe86058), 0.5 + 0.5 * fractal_noise(1.8 * p, 3, seed + 4));
        rind.lerp(flesh, smoothstep(0.7, 1.3, depth + 0.2 * noise(p, seed + 2)))
    };
    let bounds = [Vec3::new(-9.2, -9.2, -6.0), Vec3::new(9.2, 0.4, 6.0)];
    Ok(sculpt(bounds, distance, color, values))
}
