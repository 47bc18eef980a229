//! A left ear on the side of a head, of skin: thin where light from behind comes through.

use glam::{Quat, Vec3};
use translucid_scene::{Mesh, SceneError};

use crate::implicit::distance::{
    ball, blend, blend_stalk, carve, carve_stalk, ellipsoid, round_cone, smoothstep,
};
use crate::implicit::sculpture::{detail, height, sculpt};
use crate::parameters::{ShapeParameter, Values};

/// The height is that of the piece of head.
pub(crate) const EAR: &[ShapeParameter] = &[height(15.0), detail(300.0)];

/// The rim, from its root in the bowl over the top to the lobe.
const HELIX: [Vec3; 14] = [
    Vec3::new(0.35, -0.30, 0.05),
    Vec3::new(0.85, 0.08, 0.22),
    Vec3::new(1.25, 0.62, 0.20),
    Vec3::new(1.38, 1.35, 0.16),
    Vec3::new(1.18, 2.12, 0.18),
    Vec3::new(0.65, 2.72, 0.22),
    Vec3::new(-0.10, 2.95, 0.25),
    Vec3::new(-0.85, 2.78, 0.25),
    Vec3::new(-1.42, 2.28, 0.24),
    Vec3::new(-1.72, 1.55, 0.22),
    Vec3::new(-1.74, 0.75, 0.18),
    Vec3::new(-1.55, -0.05, 0.12),
    Vec3::new(-1.25, -0.80, 0.06),
    Vec3::new(-0.92, -1.55, 0.0),
];

/// The ridge within the rim, from above the lobe to its fork, and the fork's lower branch.
const ANTIHELIX: [Vec3; 7] = [
    Vec3::new(-0.42, -1.42, 0.16),
    Vec3::new(-0.78, -0.90, 0.26),
    Vec3::new(-0.95, -0.20, 0.34),
    Vec3::new(-0.88, 0.52, 0.34),
    Vec3::new(-0.62, 1.10, 0.27),
    Vec3::new(-0.30, 1.62, 0.12),
    Vec3::new(0.05, 2.12, 0.04),
];
const BRANCH: [Vec3; 4] = [
    Vec3::new(-0.80, 0.72, 0.22),
    Vec3::new(-0.35, 0.95, 0.14),
    Vec3::new(0.20, 1.05, 0.04),
    Vec3::new(0.75, 1.02, -0.05),
];

/// The ridges of an ear as curves.
struct Ridges {
    helix: [Vec3; 40],
    groove: [Vec3; 24],
    antihelix: [Vec3; 19],
    branch: [Vec3; 10],
}

impl Ridges {
    fn new() -> Self {
        let middle = Vec3::new(-0.18, 0.75, 0.0);
        let within = HELIX.map(|at| middle + (at - middle) * 0.79 + Vec3::new(0.0, 0.0, 0.20));
        let along: [Vec3; 9] = std::array::from_fn(|i| within[i + 4]);
        let groove = curve(&along);
        Self { helix: curve(&HELIX), groove, antihelix: curve(&ANTIHELIX), branch: curve(&BRANCH) }
    }
}

/// Points of the Catmull–Rom spline through others.
fn curve<const N: usize, const M: usize>(through: &[Vec3; N]) -> [Vec3; M] {
    std::array::from_fn(|i| {
        let at = i as f32 * (N - 1) as f32 / (M - 1) as f32;
        let piece = (at as usize).min(N - 2);
        let t = at - piece as f32;
        let [a, b, c, d] =
            [piece.saturating_sub(1), piece, piece + 1, (piece + 2).min(N - 1)].map(|j| through[j]);
        let (u, v) = ((c - a) * 0.5, (d - b) * 0.5);
        b + (u + ((c - b) * 3.0 - u * 2.0 - v + ((b - c) * 2.0 + u + v) * t) * t) * t
    })
}

/// The ear by itself: x toward the face, y up, z outward.
fn auricle(p: Vec3, ridges: &Ridges) -> f32 {
    // A dish: its edge comes forward
    let (x, y) = (p.x.clamp(-2.2, 2.2), (p.y - 0.3).clamp(-3.2, 3.2));
    let p = p - Vec3::new(0.0, 0.0, 0.05 * (x * x + 0.35 * y * y));
    let upper = ellipsoid(p - Vec3::new(-0.18, 0.95, 0.0), Vec3::new(1.62, 2.02, 0.26));
    let lobe = ellipsoid(p - Vec3::new(0.12, -2.12, -0.02), Vec3::new(0.88, 0.92, 0.30));
    let middle = ellipsoid(p - Vec3::new(-0.15, -0.75, 0.0), Vec3::new(1.20, 1.45, 0.28));
    let plate = blend(blend(upper, middle, 0.5), lobe, 0.6);
    // The bowl is a bump on the back
    let bump = ellipsoid(p - Vec3::new(0.22, -0.48, -0.42), Vec3::new(1.22, 1.32, 0.62));
    let plate = blend(plate, bump, 0.45);
    let plate = blend_stalk(plate, p, &ridges.antihelix, [0.27, 0.12], 0.30);
    let plate = blend_stalk(plate, p, &ridges.branch, [0.19, 0.10], 0.25);
    let bowl = ellipsoid(p - Vec3::new(0.32, -0.55, 0.16), Vec3::new(0.92, 0.95, 0.66));
    let plate = carve(plate, bowl, 0.30);
    let plate = carve_stalk(plate, p, &ridges.groove, [0.16, 0.13], 0.20);
    let rim = blend_stalk(plate, p, &ridges.helix, [0.22, 0.16], 0.14);
    let antitragus = ball(p - Vec3::new(-0.12, -1.50, 0.22), 0.30);
    let tragus = ellipsoid(
        Quat::from_rotation_y(0.5) * (p - Vec3::new(1.12, -0.62, 0.28)),
        Vec3::new(0.42, 0.50, 0.20),
    );
    blend(blend(rim, antitragus, 0.35), tragus, 0.35)
}

/// The side of the head with the ear, which stands off at the back.
fn side(p: Vec3, ridges: &Ridges) -> f32 {
    let head = ellipsoid(p - Vec3::new(3.6, 0.6, -5.1), Vec3::new(6.4, 7.5, 4.9));
    let jaw = round_cone(p, [Vec3::new(2.4, -2.6, -2.6), Vec3::new(5.6, -5.2, -3.6)], [1.9, 1.5]);
    let head = blend(head, jaw, 2.5);
    let q = Quat::from_rotation_z(-0.12) * p;
    let q = Quat::from_rotation_y(-0.46) * (q - Vec3::new(0.9, 0.0, 0.0)) + Vec3::new(0.9, 0.0, 0.0);
    // Flat ellipsoids, bent, are steeper than a distance
    let whole = blend(head, 0.75 * auricle(q - Vec3::new(0.0, 0.0, 0.35), ridges), 0.45);
    let canal = round_cone(q, [Vec3::new(0.72, -0.48, 0.1), Vec3::new(1.5, -0.3, -1.0)], [0.30, 0.22]);
    carve(whole, canal, 0.25)
}

pub(crate) fn ear(values: &Values) -> Result<Mesh, SceneError> {
    // Redder where there is no fat under the skin: the rim and the ridges
    let color = |p: Vec3, _: Vec3| {
        let red = smoothstep(-0.6, 0.9, p.z);
        Vec3::new(0.56, 0.36, 0.27).lerp(Vec3::new(0.58, 0.29, 0.22), red)
    };
    let ridges = Ridges::new();
    let bounds = [Vec3::new(-3.2, -7.4, -10.3), Vec3::new(10.3, 8.4, 3.2)];
    Ok(sculpt(bounds, |p| side(p, &ridges), color, values))
}
