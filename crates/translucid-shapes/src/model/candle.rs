//! A candle with molten rim and drips, its wick and its flame.

use glam::{Vec2, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{
    blend, carve, common, ellipsoid, is_beyond, round_cone, rounded_cylinder, smoothstep, stalk,
};
use crate::implicit::noise::{fractal_noise, noise};
use crate::implicit::sculpture::{detail, height, sculpt, stand};
use crate::parameters::{ShapeParameter, Values};
use crate::primitive::lathe::{curve_profile, revolve};

pub(crate) const CANDLE: &[ShapeParameter] = &[
    height(9.0),
    ShapeParameter::ratio("slenderness", 1.6, 0.5, 6.0), // Height over diameter
    ShapeParameter::count("seed", 1.0, 0.0, 65535.0),    // Of drips and rim
    detail(100.0),
];

/// Radius of the wax before scaling.
const RADIUS: f32 = 2.8;

/// Drips: direction about the axis, how far down they run, thickness.
fn drips(seed: u32) -> Vec<(Vec2, f32, f32)> {
    (0..7)
        .map(|i| {
            let random =
                |k: u32| 0.5 + 0.5 * noise(Vec3::new(i as f32 * 3.7 + 0.5, k as f32 * 5.3 + 0.5, 0.5), seed);
            let angle = std::f32::consts::TAU * (i as f32 + 0.8 * random(1)) / 7.0;
            (Vec2::from_angle(angle), 0.8 + 7.0 * random(2) * random(3), 0.2 + 0.16 * random(4))
        })
        .collect()
}

pub(crate) fn candle(values: &Values) -> Result<Mesh, SceneError> {
    let seed = values.count("seed") as u32;
    let top = 2.0 * RADIUS * values.get("slenderness");
    let drips = drips(seed);
    let distance = move |p: Vec3| {
        let q = p - Vec3::new(0.0, 0.5 * top, 0.0);
        let cylinder = rounded_cylinder(q, RADIUS, 0.5 * top, 0.28);
        // Far from the surface the details do not matter.
        if cylinder > 0.8 || (cylinder < -0.8 && p.y < top - 2.3) {
            return 0.9 * cylinder;
        }
        // The rim sags here and there, by at most 0.35.
        let body = if is_beyond(-0.9 * (p.y - top + 0.65), -cylinder, 0.3) {
            cylinder
        } else {
            let around = Vec2::new(p.x, p.z).normalize_or_zero();
            let sag = 0.35 * fractal_noise(Vec3::new(1.3 * around.x, 0.0, 1.3 * around.y) + 7.0, 3, seed);
            common(cylinder, 0.9 * (p.y - top + 0.3 - sag), 0.3)
        };
        let pool =
            ellipsoid(p - Vec3::new(0.0, top + 0.05, 0.0), Vec3::new(0.86 * RADIUS, 1.35, 0.86 * RADIUS));
        let body = carve(body, pool, 0.35) + 0.012 * noise(1.2 * p, seed + 8);
        let runs = drips.iter().fold(f32::MAX, |nearest, &(side, length, width)| {
            // The ellipsoid's distance falls short, at most by the ratio of its radii; the blend takes 0.04.
            let away = Vec2::new(p.x, p.z).distance(RADIUS * side) - 0.14;
            let least = (away - 1.15 * width).min((away - 2.2 * width) * (1.4 / 2.2)) - 0.04;
            if is_beyond(least, body, 0.3) {
                return nearest;
            }
            let at = |y: f32, out: f32| Vec3::new(side.x, 0.0, side.y) * (RADIUS + out) + Vec3::Y * y;
            let end = (top - length).max(0.6);
            let run = round_cone(p, [at(top - 0.5, -0.14), at(end, -0.04)], [0.95 * width, 1.15 * width]);
            let bead = ellipsoid(p - at(end, -0.03), Vec3::new(1.4, 2.2, 1.4) * width);
            nearest.min(blend(run, bead, 0.15))
        });
        blend(body, runs, 0.3)
    };
    let bounds = [Vec3::new(-3.4, -0.1, -3.4), Vec3::new(3.4, top + 0.3, 3.4)];
    Ok(sculpt(bounds, distance, |_, _| Vec3::ONE, values))
}

pub(crate) const WICK: &[ShapeParameter] = &[height(1.3), detail(64.0)];

/// A burnt wick, bent at its tip.
pub(crate) fn wick(values: &Values) -> Result<Mesh, SceneError> {
    let bend = [Vec3::ZERO, Vec3::new(0.0, 0.8, 0.0), Vec3::new(0.12, 1.15, 0.05), Vec3::new(0.3, 1.35, 0.1)];
    let distance = move |p: Vec3| stalk(p, &bend, [0.1, 0.085]);
    // Ash above, wax-soaked cotton below.
    let color = |p: Vec3, _: Vec3| Vec3::splat(0.25 - 0.23 * smoothstep(0.1, 0.5, p.y));
    let bounds = [Vec3::new(-0.2, -0.2, -0.2), Vec3::new(0.5, 1.6, 0.4)];
    Ok(sculpt(bounds, distance, color, values))
}

pub(crate) const FLAME: &[ShapeParameter] = &[
    height(3.0),
    ShapeParameter::ratio("width", 0.3, 0.05, 1.0), // Over the height
    ShapeParameter::count("segments", 12.0, 6.0, 1024.0),
];

/// A teardrop.
pub(crate) fn flame(values: &Values) -> Result<Mesh, SceneError> {
    let (segments, width) = (values.count("segments"), values.get("width"));
    // The piriform curve: round below, pointed above.
    let curve = |t: f32| {
        let angle = std::f32::consts::PI * (t - 0.5);
        let y = libm::sinf(angle);
        Vec2::new(
            0.5 * width * 1.54 * libm::cosf(angle) * libm::powf(0.5 - 0.5 * y, 0.9).max(0.0) * 1.0,
            0.5 + 0.5 * y,
        )
    };
    let rings = segments;
    let mut profile = curve_profile(curve, rings);
    profile[0].position.x = 0.0;
    profile[0].normal = Vec2::NEG_Y;
    profile[rings].position.x = 0.0;
    profile[rings].normal = Vec2::Y;
    let mut mesh = revolve(&profile, segments);
    // Blue-white root, yellow body.
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| {
            Vec3::new(0.25, 0.35, 1.0).lerp(Vec3::new(1.0, 0.62, 0.22), smoothstep(0.02, 0.3, p.y))
                * (0.25 + 0.75 * smoothstep(0.02, 0.4, p.y))
        })
        .collect();
    stand(&mut mesh, values.get("height"));
    Ok(mesh)
}
