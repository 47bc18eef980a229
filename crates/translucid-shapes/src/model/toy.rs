//! Toys: a bath duck and a building brick.

use glam::{Quat, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{
    ball, blend, common, ellipsoid, rounded_block, rounded_cylinder, smoothstep,
};
use crate::implicit::sculpture::{detail, height, sculpt, srgb};
use crate::parameters::{ShapeParameter, Values};

pub(crate) const DUCK: &[ShapeParameter] = &[height(6.4), detail(100.0)];

/// Center of the duck's head.
const HEAD: Vec3 = Vec3::new(0.0, 4.55, 1.25);

fn duck_body(p: Vec3) -> f32 {
    let body = ellipsoid(p - Vec3::new(0.0, 1.9, 0.0), Vec3::new(2.45, 1.95, 3.0));
    let chest = ball(p - Vec3::new(0.0, 2.1, 1.3), 1.75);
    let tail_turn = Quat::from_rotation_x(0.75);
    let tail = ellipsoid(tail_turn * (p - Vec3::new(0.0, 2.95, -2.75)), Vec3::new(1.05, 0.5, 1.2));
    let mirrored = Vec3::new(p.x.abs(), p.y, p.z);
    let wing_turn = Quat::from_rotation_y(-0.16) * Quat::from_rotation_x(0.32);
    let wing = ellipsoid(wing_turn * (mirrored - Vec3::new(2.2, 2.35, -0.45)), Vec3::new(0.5, 0.95, 1.75));
    let body = blend(blend(body, chest, 1.0), tail, 0.9);
    blend(blend(body, wing, 0.22), ball(p - HEAD, 1.62), 0.75)
}

fn duck_beak(p: Vec3) -> f32 {
    let q = p - HEAD - Vec3::new(0.0, -0.28, 1.75);
    let upper =
        ellipsoid(Quat::from_rotation_x(-0.25) * (q - Vec3::new(0.0, 0.16, 0.0)), Vec3::new(0.8, 0.24, 0.85));
    let lower =
        ellipsoid(Quat::from_rotation_x(0.2) * (q + Vec3::new(0.0, 0.12, 0.12)), Vec3::new(0.62, 0.2, 0.65));
    blend(upper, lower, 0.1)
}

fn duck_eye(p: Vec3) -> f32 {
    let mirrored = Vec3::new(p.x.abs(), p.y, p.z);
    ball((mirrored - HEAD - Vec3::new(0.72, 0.42, 1.3)) / Vec3::new(1.0, 1.25, 1.0), 0.3)
}

pub(crate) fn duck(values: &Values) -> Result<Mesh, SceneError> {
    let distance = |p: Vec3| {
        let duck = blend(blend(duck_body(p), duck_beak(p), 0.12), duck_eye(p), 0.05);
        common(duck, -p.y, 0.3)
    };
    let color = |p: Vec3, _: Vec3| {
        let beak = smoothstep(0.03, -0.01, duck_beak(p) - duck_body(p).min(0.02));
        let eye = smoothstep(0.03, 0.0, duck_eye(p));
        // A glint painted on the eye, as toy makers do.
        let glint = smoothstep(
            0.12,
            0.07,
            (Vec3::new(p.x.abs(), p.y, p.z) - HEAD - Vec3::new(0.72, 0.58, 1.58)).length(),
        );
        let eye_color = srgb(0x0a0808).lerp(Vec3::splat(0.9), glint);
        srgb(0xffc808).lerp(srgb(0xf0640a), beak).lerp(eye_color, eye)
    };
    let bounds = [Vec3::new(-3.0, -0.1, -4.0), Vec3::new(3.0, 6.4, 4.2)];
    Ok(sculpt(bounds, distance, color, values))
}

pub(crate) const BRICK: &[ShapeParameter] = &[
    height(2.2),
    ShapeParameter::count("columns", 4.0, 1.0, 8.0), // Of studs, along x
    ShapeParameter::count("rows", 2.0, 1.0, 8.0),    // Of studs, along z
    detail(90.0),
];

/// Distance between studs in units of the brick's own design.
const PITCH: f32 = 1.6;

/// A building brick with round studs.
pub(crate) fn brick(values: &Values) -> Result<Mesh, SceneError> {
    let (columns, rows) = (values.count("columns") as f32, values.count("rows") as f32);
    let half = Vec3::new(0.5 * PITCH * columns, 0.96, 0.5 * PITCH * rows);
    let distance = move |p: Vec3| {
        let block = rounded_block(p - Vec3::new(0.0, half.y, 0.0), half, 0.12);
        // The nearest stud.
        let nearest = |x: f32, half: f32, count: f32| {
            let index = ((x + half) / PITCH).floor().clamp(0.0, count - 1.0);
            x + half - (index + 0.5) * PITCH
        };
        let q = Vec3::new(nearest(p.x, half.x, columns), p.y - 2.0 * half.y, nearest(p.z, half.z, rows));
        blend(block, rounded_cylinder(q, 0.5, 0.36, 0.08), 0.08)
    };
    let bounds = [Vec3::new(-half.x, 0.0, -half.z), Vec3::new(half.x, 2.0 * half.y + 0.4, half.z)];
    Ok(sculpt(bounds, distance, |_, _| Vec3::ONE, values))
}
