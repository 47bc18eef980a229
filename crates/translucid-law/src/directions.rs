//! Maps of the unit square to directions.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::{Vec2, Vec3};

use crate::elementary::{circle, circle_at, unit_or};
use crate::frame::Frame;

/// Direction in a cone about `axis`, uniform in solid angle.
///
/// The cone is given by 1 − cos α: cos α itself is no more than 1 for cones under half a minute of arc.
#[inline]
pub fn uniform_cone(axis: Vec3, one_minus_cos: f32, v: [f32; 2]) -> Vec3 {
    let x = v[0] * one_minus_cos;
    polar(axis, 1.0 - x, (x * (2.0 - x)).max(0.0).sqrt(), circle(v[1]))
}

/// Solid-angle density of [`uniform_cone`].
#[inline]
pub fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos)
}

/// Direction with density cos θ/π about a unit normal, by the concentric map of the square on the disc
/// [Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square"].
#[inline]
pub fn cosine_hemisphere(normal: Vec3, v: [f32; 2]) -> Vec3 {
    let (a, b) = (2.0 * v[0] - 1.0, 2.0 * v[1] - 1.0);
    let mut radius = 0.0;
    let mut angle = 0.0;
    if a.abs() > b.abs() {
        radius = a;
        angle = FRAC_PI_4 * (b / a);
    } else if b != 0.0 {
        radius = b;
        angle = FRAC_PI_2 - FRAC_PI_4 * (a / b);
    }
    polar(normal, (1.0 - radius * radius).max(0.0).sqrt(), radius, circle_at(angle))
}

/// Area-preserving map of the unit square to the unit disk [Shirley & Chiu 1997].
#[inline]
pub fn concentric_disk(u: [f32; 2]) -> [f32; 2] {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return [0.0, 0.0];
    }
    let mut radius = b;
    let mut angle = 2.0 * FRAC_PI_4 - FRAC_PI_4 * a / b;
    if a.abs() > b.abs() {
        radius = a;
        angle = FRAC_PI_4 * b / a;
    }
    let around = circle_at(angle);
    [radius * around.x, radius * around.y]
}

/// A direction over the upper hemisphere with density cosθ/π.
#[inline]
pub fn sample_cosine(v: [f32; 2]) -> Vec3 {
    let around = circle(v[1]);
    let r = v[0].sqrt();
    // Never exactly on the horizon
    Vec3::new(r * around.x, r * around.y, (1.0 - v[0]).max(1e-7).sqrt())
}

/// Uniform direction.
#[inline]
pub fn uniform_sphere(v: [f32; 2]) -> Vec3 {
    uniform_cone(Vec3::Z, 2.0, v)
}

/// Unit vector by the cosine and sine of its angle to the axis, and those of its angle about it.
#[inline]
fn polar(axis: Vec3, cos: f32, sin: f32, around: Vec2) -> Vec3 {
    let frame = Frame::from_normal(axis);
    unit_or(frame.to_world(Vec3::new(sin * around.x, sin * around.y, cos)), axis)
}

/// 1 − cos α from sin² α, exact for small angles.
#[inline]
pub fn one_minus_cos(sin2: f32) -> f32 {
    sin2 / (1.0 + (1.0 - sin2).max(0.0).sqrt())
}

/// Barycentric coordinates of a triangle's second and third corner, uniform in area
/// [Heitz 2019, "A Low-Distortion Map Between Triangle and Square"].
#[inline]
pub fn uniform_triangle(v: [f32; 2]) -> [f32; 2] {
    if v[1] > v[0] {
        return [0.5 * v[0], v[1] - 0.5 * v[0]];
    }
    [v[0] - 0.5 * v[1], 0.5 * v[1]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of f over a grid of the square.
    fn mean(f: impl Fn([f32; 2]) -> f64) -> f64 {
        let n = 400;
        let at = |i: u32| (i as f32 + 0.5) / n as f32;
        (0..n * n).map(|i| f([at(i % n), at(i / n)])).sum::<f64>() / f64::from(n * n)
    }

    #[test]
    fn cosine_hemisphere_has_the_moments_of_its_density() {
        let n = Vec3::new(0.48, -0.6, 0.64);
        let side = Frame::from_normal(n).x;
        // E[cos^k] = 2/(2 + k); E[(ω·x)²] = 1/4; E[ω·x] = 0.
        assert!((mean(|v| f64::from(cosine_hemisphere(n, v).dot(n))) - 2.0 / 3.0).abs() < 1e-4);
        assert!((mean(|v| f64::from(cosine_hemisphere(n, v).dot(n)).powi(4)) - 1.0 / 3.0).abs() < 1e-4);
        assert!((mean(|v| f64::from(cosine_hemisphere(n, v).dot(side)).powi(2)) - 0.25).abs() < 1e-4);
        assert!(mean(|v| f64::from(cosine_hemisphere(n, v).dot(side))).abs() < 1e-4);
    }

    #[test]
    fn uniform_cone_fills_the_cone_evenly() {
        for one_minus_cos in [1e-10_f32, 1e-3, 0.5, 2.0] {
            let (least, most) = (f64::from(one_minus_cos) * 0.25, f64::from(one_minus_cos) * 0.75);
            // |ω − axis|² = 2(1 − cos θ), which does not cancel.
            let x = |v| f64::from((uniform_cone(Vec3::Z, one_minus_cos, v) - Vec3::Z).length_squared()) / 2.0;
            let share = mean(|v| f64::from(u8::from((least..most).contains(&x(v)))));
            assert!((share - 0.5).abs() < 0.01, "{one_minus_cos}: {share}");
        }
    }
}
