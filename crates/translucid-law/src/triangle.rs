//! A triangle that emits on the side from which its corners are seen counter-clockwise.

use glam::Vec3;

use crate::receiver::Receiver;

/// Estimate of the irradiance by a triangle's corners and the luminance of its radiance; 0 only from behind and if the triangle
/// is below the horizon.
#[inline]
pub fn triangle_importance(a: Vec3, b: Vec3, c: Vec3, luminance: f32, receiver: &Receiver) -> f32 {
    let (to_a, to_b, to_c) = (a - receiver.point, b - receiver.point, c - receiver.point);
    // Twice the area times the height above the triangle
    let elevation = -to_a.dot((b - a).cross(c - a));
    let normal = receiver.normal;
    let highest = normal.dot(to_a).max(normal.dot(to_b)).max(normal.dot(to_c));
    if elevation <= 0.0 || (receiver.has_normal() && highest <= 0.0) {
        return 0.0;
    }
    let middle = (to_a + to_b + to_c) / 3.0;
    let (from_a, from_b, from_c) = (to_a - middle, to_b - middle, to_c - middle);
    let radius2 = from_a.dot(from_a).max(from_b.dot(from_b)).max(from_c.dot(from_c));
    let distance = middle.dot(middle).max(radius2).sqrt();
    let cosine = if receiver.has_normal() { (highest / distance).min(1.0) } else { 1.0 };
    let intensity = 0.5 * luminance * (elevation / distance);
    (intensity / distance / distance * cosine).max(f32::MIN_POSITIVE)
}
