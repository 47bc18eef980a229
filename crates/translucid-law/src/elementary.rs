//! Functions that processors and devices compute each in their own way: in WGSL they are in `elementary.wgsl`.

use std::f32::consts::TAU;

use glam::{Vec2, Vec3};

/// Cosine and sine of a number of turns.
#[inline]
pub fn circle(turns: f32) -> Vec2 {
    circle_at(TAU * turns)
}

/// Cosine and sine of an angle \[rad\].
#[inline]
pub fn circle_at(angle: f32) -> Vec2 {
    let (sine, cosine) = libm::sincosf(angle);
    Vec2::new(cosine, sine)
}

/// The unit vector along `v`, or `other` where it has no direction.
#[inline]
pub fn unit_or(v: Vec3, other: Vec3) -> Vec3 {
    v.normalize_or(other)
}

/// A color whose channels are raised to a power.
#[inline]
pub fn color_power(color: Vec3, exponent: f32) -> Vec3 {
    color.powf(exponent)
}

/// Returns `true` if every component is 0.
#[inline]
pub fn is_zero_vector(v: Vec3) -> bool {
    v == Vec3::ZERO
}

/// Returns `true` for a number that is neither infinite nor a NaN.
#[inline]
pub fn is_finite(x: f32) -> bool {
    x.is_finite()
}

/// 1 or −1, by a number's sign.
#[inline]
pub fn sign_of(x: f32) -> f32 {
    1.0_f32.copysign(x)
}

/// The greatest component.
#[inline]
pub fn greatest(v: Vec3) -> f32 {
    v.max_element()
}
