//! A bust in the manner of the twentieth century: a woman's head with closed eyes on a long neck.

use glam::{Quat, Vec2, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{
    ball, blend, blend_stalk, carve, carve_stalk, common, ellipsoid, is_beyond, round_cone, smoothstep,
};
use crate::implicit::noise::{fractal_noise, noise};
use crate::implicit::sculpture::{detail, height, sculpt};
use crate::parameters::{ShapeParameter, Values};

pub(crate) const BUST: &[ShapeParameter] = &[
    height(22.0),
    detail(190.0),
    ShapeParameter::count("seed", 1.0, 0.0, 65535.0),
    ShapeParameter::ratio("veins", 0.5, 0.0, 1.0), // Their strength
];

/// How far the shoulders are above where they were first drawn: a shorter neck.
const RAISE: Vec3 = Vec3::new(0.0, 1.1, 0.0);

/// Mirror image of a point on the left half.
fn mirrored(p: Vec3) -> Vec3 {
    Vec3::new(p.x.abs(), p.y, p.z)
}

/// Skull, cheeks and jaw. The chin is near y = 0, the crown at y = 10.4, the face looks to +z.
fn skull(p: Vec3, q: Vec3) -> f32 {
    let cranium = ellipsoid(p - Vec3::new(0.0, 6.3, -0.5), Vec3::new(3.35, 4.0, 4.15));
    let face = ellipsoid(p - Vec3::new(0.0, 3.7, 0.95), Vec3::new(2.75, 4.1, 2.85));
    let chin = ellipsoid(p - Vec3::new(0.0, 0.45, 2.5), Vec3::new(0.95, 0.8, 0.85));
    let jaw = round_cone(q, [Vec3::new(2.15, 2.5, -0.2), Vec3::new(0.35, 0.55, 2.2)], [0.75, 0.6]);
    let cheek = ellipsoid(q - Vec3::new(1.65, 3.3, 2.3), Vec3::new(0.95, 0.8, 0.8));
    let head = blend(cranium, face, 1.6);
    blend(blend(blend(head, jaw, 1.0), chin, 0.9), cheek, 0.9)
}

/// Nose from the brow to its tip with its wings.
fn nose(p: Vec3, q: Vec3) -> f32 {
    let bridge = round_cone(p, [Vec3::new(0.0, 5.2, 3.25), Vec3::new(0.0, 3.05, 4.35)], [0.34, 0.36]);
    let tip = ball(p - Vec3::new(0.0, 2.92, 4.32), 0.42);
    let wing = ellipsoid(q - Vec3::new(0.4, 2.8, 3.85), Vec3::new(0.33, 0.3, 0.42));
    blend(blend(bridge, tip, 0.25), wing, 0.25)
}

/// Lips that touch along a fine line.
fn lips(face: f32, p: Vec3, q: Vec3) -> f32 {
    let upper = ellipsoid(q - Vec3::new(0.28, 1.95, 3.55), Vec3::new(0.72, 0.22, 0.36));
    let lower = ellipsoid(q - Vec3::new(0.12, 1.52, 3.5), Vec3::new(0.66, 0.27, 0.38));
    let full = blend(blend(face, upper, 0.45), lower, 0.4);
    let line = [Vec3::new(0.0, 1.71, 3.98), Vec3::new(0.45, 1.77, 3.85), Vec3::new(0.95, 1.72, 3.5)];
    let parted = carve_stalk(full, q, &line, [0.08, 0.05], 0.2);
    let philtrum = round_cone(p, [Vec3::new(0.0, 2.55, 3.98), Vec3::new(0.0, 2.2, 4.0)], [0.1, 0.13]);
    carve(parted, philtrum, 0.2)
}

/// Sockets, closed lids with a crease below, and arched brows.
fn eyes(face: f32, q: Vec3) -> f32 {
    let socket = ellipsoid(q - Vec3::new(1.3, 4.65, 3.55), Vec3::new(0.95, 0.6, 0.75));
    let hollow = carve(face, socket, 0.7);
    let lid = ellipsoid(q - Vec3::new(1.34, 4.5, 2.55), Vec3::new(0.85, 0.62, 0.72));
    let closed = blend(hollow, lid, 0.2);
    let seam = [
        Vec3::new(0.65, 4.36, 3.02),
        Vec3::new(1.0, 4.17, 3.15),
        Vec3::new(1.5, 4.12, 3.13),
        Vec3::new(1.9, 4.24, 3.0),
    ];
    let seamed = carve_stalk(closed, q, &seam, [0.05, 0.05], 0.2);
    let brow = [Vec3::new(0.35, 5.2, 3.3), Vec3::new(1.2, 5.55, 3.15), Vec3::new(2.3, 5.25, 2.25)];
    blend_stalk(seamed, q, &brow, [0.2, 0.12], 0.55)
}

/// A thin ear with its bowl.
fn ear(q: Vec3) -> f32 {
    let turned =
        Quat::from_rotation_y(0.55) * Quat::from_rotation_z(0.18) * (q - Vec3::new(3.15, 4.15, -0.25));
    let shell = ellipsoid(turned, Vec3::new(0.32, 1.2, 0.78));
    let bowl = ellipsoid(turned - Vec3::new(0.34, 0.12, 0.08), Vec3::new(0.34, 0.85, 0.5));
    carve(shell, bowl, 0.2)
}

/// Hair on a head, drawn back into a knot, combed in waves from a parting.
fn hair(head: f32, p: Vec3, q: Vec3) -> f32 {
    const FILLET: f32 = 0.12;
    let cap = ellipsoid(p - Vec3::new(0.0, 6.55, -0.75), Vec3::new(3.65, 4.05, 4.25));
    // The hairline rises from the ear to the parting.
    let line = Vec3::new(0.0, 0.62, -0.78);
    let front = (p - Vec3::new(0.0, 7.75, 2.2)).dot(-line) - 0.22 * q.x * q.x * 0.5;
    let center = Vec3::new(0.0, 6.6, -5.3);
    let knot = ellipsoid(p - center, Vec3::new(1.65, 1.6, 1.25));
    // The strands add at most 0.05, the coil 0.06, and the fillet between cap and knot takes at most 0.1
    if is_beyond((cap - 0.05).max(front).min(knot - 0.06) - 0.1, head, FILLET) {
        return head;
    }
    let strands =
        0.05 * libm::sinf(7.0 * (0.9 * q.x + 0.16 * (1.2 * p.y + p.z)) + 1.2 * libm::sinf(0.9 * p.y));
    let cap = common(cap + strands, front, 0.35);
    let around = Vec2::new(p.x - center.x, p.y - center.y);
    let coil = 0.06 * libm::sinf(2.0 * libm::atan2f(around.x, around.y) + 6.5 * around.length());
    blend(head, blend(cap, knot + coil, 0.4), FILLET)
}

/// Fillet of the shoulders with the neck.
const NECK_FILLET: f32 = 2.0;

/// The neck.
fn neck(p: Vec3) -> f32 {
    round_cone(p - RAISE, [Vec3::new(0.0, -6.2, -1.6), Vec3::new(0.0, 2.2, -0.9)], [2.05, 1.75])
}

/// The ball that the shoulders are cut with: they are nowhere beyond it.
fn cut(p: Vec3) -> f32 {
    ball((p - RAISE - Vec3::new(0.0, -5.6, -1.2)) / Vec3::new(1.15, 1.0, 1.0), 4.9)
}

/// No more than the distance to the torso.
fn least_to_torso(p: Vec3) -> f32 {
    cut(p).min(neck(p)) - 0.25 * NECK_FILLET
}

/// Neck and shoulders, cut in a curve.
fn torso(p: Vec3) -> f32 {
    let (neck, cut) = (neck(p), cut(p));
    if is_beyond(cut, neck, NECK_FILLET) {
        return neck;
    }
    let (p, q) = (p - RAISE, mirrored(p) - RAISE);
    let shoulder = round_cone(q, [Vec3::new(0.0, -7.0, -1.4), Vec3::new(4.6, -8.2, -1.5)], [2.2, 1.7]);
    let chest = ellipsoid(p - Vec3::new(0.0, -8.6, -0.6), Vec3::new(4.2, 3.2, 2.4));
    let collar = [Vec3::new(0.45, -5.75, 0.75), Vec3::new(2.0, -5.75, 0.6), Vec3::new(4.2, -6.3, -0.6)];
    let body = blend(shoulder, chest, 1.5);
    let body = blend_stalk(body, q, &collar, [0.22, 0.12], 0.9);
    blend(common(body, cut, 0.35), neck, NECK_FILLET)
}

/// A turned foot under the shoulders.
fn foot(p: Vec3) -> f32 {
    let p = p - RAISE;
    let r = Vec2::new(p.x, p.z + 1.2).length();
    let waist = 1.25 + 0.16 * libm::powf((p.y + 11.6).abs(), 2.0).min(6.0);
    let column = 0.75 * (r - waist.min(2.35));
    let slab = (p.y + 12.6).abs() - 2.6;
    let plinth = Vec2::new(r - 2.55, (p.y + 14.7).abs() - 0.5);
    let plinth = plinth.max(Vec2::ZERO).length() + plinth.max_element().min(0.0) - 0.06;
    blend(common(column, slab, 0.2), plinth, 0.15)
}

fn figure(p: Vec3) -> f32 {
    // The head bows and turns a little.
    let pivot = Vec3::new(0.0, 1.0, -0.8);
    let turn = Quat::from_rotation_y(-0.12) * Quat::from_rotation_x(-0.13) * Quat::from_rotation_z(-0.05);
    if p.y < -4.0 {
        return blend(torso(p), foot(p), 0.5);
    }
    let h = turn * (p - pivot) + pivot;
    let hm = mirrored(h);
    let bare = skull(h, hm);
    if bare > 2.6 {
        return torso(p).min(bare - 1.2);
    }
    // Each feature only where it can change anything.
    let mut face = bare;
    if h.z > 1.2 && h.y < 7.0 {
        face = blend(face, nose(h, hm), 0.35);
        face = if h.y > 3.2 { eyes(face, hm) } else { lips(face, h, hm) };
    }
    let mut head = hair(face, h, hm);
    if hm.x > 1.8 && h.z.abs() < 2.0 {
        head = blend(head, ear(hm), 0.2);
    }
    if is_beyond(least_to_torso(p), head, 0.9) { head } else { blend(head, torso(p), 0.9) }
}

/// Surface albedo of white marble (H. W. Jensen et al., "A practical model for subsurface light transport",
/// 2001, table 1, as the albedo of a half space).
const MARBLE: Vec3 = Vec3::new(0.931, 0.913, 0.894);

/// Grey veins where folded noise passes through zero, on a faintly clouded ground.
pub(super) fn marble(p: Vec3, seed: u32, strength: f32) -> Vec3 {
    let warp = Vec3::new(noise(0.25 * p, seed), noise(0.25 * p, seed + 1), noise(0.25 * p, seed + 2));
    let q = p + 2.4 * warp;
    let vein = |scale: f32, width: f32, seed: u32| {
        let fold = fractal_noise(scale * Vec3::new(q.x, 0.55 * q.y, q.z), 4, seed).abs();
        smoothstep(width, 0.0, fold)
    };
    let presence = smoothstep(-0.25, 0.35, fractal_noise(0.16 * p, 2, seed + 9));
    let veins = presence * (0.75 * vein(0.16, 0.035, seed + 3) + 0.4 * vein(0.34, 0.03, seed + 5)).min(1.0);
    let clouds = 0.5 + 0.5 * fractal_noise(0.3 * q, 3, seed + 7);
    let ground = Vec3::ONE.lerp(Vec3::new(0.955, 0.955, 0.96), strength * clouds);
    MARBLE * ground.lerp(Vec3::new(0.62, 0.64, 0.68), strength * veins)
}

pub(crate) fn bust(values: &Values) -> Result<Mesh, SceneError> {
    let (seed, veins) = (values.count("seed") as u32, values.get("veins"));
    let color = move |p: Vec3, _: Vec3| marble(p, seed, veins);
    let bounds = [Vec3::new(-6.5, -14.3, -7.0), Vec3::new(6.5, 11.2, 5.6)];
    Ok(sculpt(bounds, figure, color, values))
}
