//! Maps of the unit square to directions.

use std::f32::consts::PI;

use glam::Vec3;

use crate::sampling::Frame;

/// Direction in a cone about `axis`, uniform in solid angle.
///
/// The cone is given by 1 − cos α: cos α itself is no more than 1 for cones under half a minute of arc.
pub(crate) fn uniform_cone(axis: Vec3, one_minus_cos: f32, v: [f32; 2]) -> Vec3 {
    let x = v[0] * one_minus_cos;
    polar(axis, 1.0 - x, (x * (2.0 - x)).max(0.0).sqrt(), 2.0 * PI * v[1])
}

/// Solid-angle density of [`uniform_cone`].
pub(crate) fn uniform_cone_pdf(one_minus_cos: f32) -> f32 {
    1.0 / (2.0 * PI * one_minus_cos)
}

/// Direction with density cos θ/π about a unit normal, by the concentric map of the square on the disc
/// [Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square"].
pub(crate) fn cosine_hemisphere(normal: Vec3, v: [f32; 2]) -> Vec3 {
    let (a, b) = (2.0 * v[0] - 1.0, 2.0 * v[1] - 1.0);
    let (radius, angle) = match (a == 0.0 && b == 0.0, a.abs() > b.abs()) {
        (true, _) => (0.0, 0.0),
        (false, true) => (a, PI / 4.0 * (b / a)),
        (false, false) => (b, PI / 2.0 - PI / 4.0 * (a / b)),
    };
    polar(normal, (1.0 - radius * radius).max(0.0).sqrt(), radius, angle)
}

/// Uniform direction.
pub(crate) fn uniform_sphere(v: [f32; 2]) -> Vec3 {
    uniform_cone(Vec3::Z, 2.0, v)
}

/// Unit vector by the cosine and sine of its angle to the axis and its angle about it.
fn polar(axis: Vec3, cos: f32, sin: f32, phi: f32) -> Vec3 {
    let (sin_phi, cos_phi) = libm::sincosf(phi);
    Frame::from_normal(axis).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos)).normalize_or(axis)
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
