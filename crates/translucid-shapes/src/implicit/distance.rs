//! Distance functions of simple solids, and how they combine.
//!
//! Negative inside. After Í. Quílez, "Distance functions" (2008–): exact where it says so, else a bound
//! that is exact at the surface to first order.

use glam::{Vec2, Vec3};

/// Ball about the origin (exact).
pub(crate) fn ball(p: Vec3, radius: f32) -> f32 {
    p.length() - radius
}

/// Ellipsoid about the origin, to first order at its surface.
pub(crate) fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let k0 = (p / radii).length();
    let k1 = (p / (radii * radii)).length();
    if k1 < 1e-6 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// Length of a vector in the plane, rounded once.
fn length(x: f32, y: f32) -> f32 {
    let (x, y) = (f64::from(x), f64::from(y));
    (x * x + y * y).sqrt() as f32
}

/// Convex hull of two balls (exact); the one at `a` must not contain the other.
// Inlined, what depends on nothing but the balls is computed once, mostly by the compiler.
#[inline(always)]
pub(crate) fn round_cone(p: Vec3, [a, b]: [Vec3; 2], [radius_a, radius_b]: [f32; 2]) -> f32 {
    let axis = b - a;
    let length = axis.length();
    let along = (p - a).dot(axis) / length;
    let across = ((p - a).length_squared() - along * along).max(0.0).sqrt();
    // The flank touches both balls: (cosine, sine) is its outward normal across and along the axis.
    let sine = (radius_a - radius_b) / length;
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let foot = along * cosine - across * sine;
    if foot < 0.0 {
        self::length(across, along) - radius_a
    } else if foot > length * cosine {
        self::length(across, along - length) - radius_b
    } else {
        across * cosine + along * sine - radius_a
    }
}

/// A stalk through points, its radius going evenly from the first to the last.
#[inline(always)]
pub(crate) fn stalk<const N: usize>(p: Vec3, points: &[Vec3; N], radii: [f32; 2]) -> f32 {
    let pieces = (N - 1).max(1) as f32;
    let radius = |i: usize| radii[0] + (radii[1] - radii[0]) * i as f32 / pieces;
    points.windows(2).enumerate().fold(f32::MAX, |nearest, (i, pair)| {
        nearest.min(round_cone(p, [pair[0], pair[1]], [radius(i), radius(i + 1)]))
    })
}

/// [`blend`] with a stalk, which is left alone where it is too far away to matter.
#[inline(always)]
pub(crate) fn blend_stalk<const N: usize>(
    a: f32,
    p: Vec3,
    points: &[Vec3; N],
    radii: [f32; 2],
    k: f32,
) -> f32 {
    if is_beyond(least_to_stalk(p, points, radii), a, k) { a } else { blend(a, stalk(p, points, radii), k) }
}

/// [`carve`] with a stalk, which is left alone where it is too far away to matter.
#[inline(always)]
pub(crate) fn carve_stalk<const N: usize>(
    a: f32,
    p: Vec3,
    points: &[Vec3; N],
    radii: [f32; 2],
    k: f32,
) -> f32 {
    -blend_stalk(-a, p, points, radii, k)
}

/// Whether `blend(a, b, k)` is `a` to the bit for every b of at least `least`, and as many as rounding adds.
pub(crate) fn is_beyond(least: f32, a: f32, k: f32) -> bool {
    least > a + k + 1e-3
}

/// No more than the distance to a stalk: that to a ball around it.
#[inline(always)]
fn least_to_stalk<const N: usize>(p: Vec3, points: &[Vec3; N], radii: [f32; 2]) -> f32 {
    let low = points.iter().fold(points[0], |low, &point| low.min(point));
    let high = points.iter().fold(points[0], |high, &point| high.max(point));
    let center = 0.5 * (low + high);
    let reach = points.iter().fold(0.0_f32, |reach, point| reach.max(point.distance(center)));
    ball(p - center, reach + radii[0].max(radii[1]))
}

/// Box about the origin with half-lengths `half`, its edges rounded to `edge` (exact).
pub(crate) fn rounded_block(p: Vec3, half: Vec3, edge: f32) -> f32 {
    let q = p.abs() - half + edge;
    q.max(Vec3::ZERO).length() + q.max_element().min(0.0) - edge
}

/// Cylinder about y of half-height `half`, its edges rounded to `edge` (exact).
pub(crate) fn rounded_cylinder(p: Vec3, radius: f32, half: f32, edge: f32) -> f32 {
    let q = Vec2::new(Vec2::new(p.x, p.z).length() - radius, p.y.abs() - half) + edge;
    q.max(Vec2::ZERO).length() + q.max_element().min(0.0) - edge
}

/// Union of two solids with a fillet of about `k` where they meet.
pub(crate) fn blend(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - 0.25 * h * h * k
}

/// Difference of `a` and `b`, the edge rounded by about `k`.
pub(crate) fn carve(a: f32, b: f32, k: f32) -> f32 {
    -blend(-a, b, k)
}

/// Intersection of `a` and `b`, the edge rounded by about `k`.
pub(crate) fn common(a: f32, b: f32, k: f32) -> f32 {
    -blend(-a, -b, k)
}

/// Rises smoothly from 0 at `low` to 1 at `high`.
pub(crate) fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
