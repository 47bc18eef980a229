//! Exponentials and logarithms of optical depths: a few operations each, the same on every processor.

use std::f32::consts::{LN_2, LOG2_E};
use std::hint::select_unpredictable;

use glam::Vec3;

/// e^{−x} for x ≥ 0, to 3e-7 (1 + x) of it and not below 2^{−126}.
#[inline(always)]
pub(super) fn attenuation(x: f32) -> f32 {
    /// Added to a number below 2²² it leaves the nearest integer in the last bits.
    const ROUND: f32 = 12_582_912.0;
    let y = (-x * LOG2_E).max(-126.0);
    let rounded = y + ROUND;
    let f = (y - (rounded - ROUND)) * LN_2;
    let power = f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23));
    // e^f for |f| ≤ ln 2 / 2
    let series =
        1.0 + f * (1.0 + f * (0.5 + f * (1.0 / 6.0 + f * (1.0 / 24.0 + f * (1.0 / 120.0 + f / 720.0)))));
    power * series
}

/// [`attenuation`] of every channel.
#[inline(always)]
pub(super) fn attenuations(x: Vec3) -> Vec3 {
    Vec3::from_array(x.to_array().map(attenuation))
}

/// Optical depth −ln(1 − u) that a part u of the light does not reach, u in [0, 1), to 3e-7 of it.
#[inline]
pub(super) fn depth_reached(u: f32) -> f32 {
    let left = 1.0 - u;
    // left = m 2^k, m from √½ to √2
    let k = left.to_bits().wrapping_sub(std::f32::consts::FRAC_1_SQRT_2.to_bits()).cast_signed() >> 23;
    let m = f32::from_bits(left.to_bits().wrapping_sub((k << 23).cast_unsigned()));
    // ln m = 2 artanh((m − 1)/(m + 1)); of small u without the rounding of 1 − u. One division for both
    let is_small = k == 0;
    let above = select_unpredictable(is_small, u, 1.0 - m);
    let below = select_unpredictable(is_small, 2.0 - u, 1.0 + m);
    let s = above / below;
    let t = s * s;
    let series = 1.0 + t * (1.0 / 3.0 + t * (1.0 / 5.0 + t * (1.0 / 7.0 + t * (1.0 / 9.0))));
    2.0 * s * series - k as f32 * LN_2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attenuation_is_the_exponential() {
        for i in 0..4000_u16 {
            let x = f32::from(i) * 0.02;
            let (found, exact) = (f64::from(attenuation(x)), (-f64::from(x)).exp());
            assert!((found / exact - 1.0).abs() < 3e-7 * (1.0 + f64::from(x)), "{x}: {found} {exact}");
        }
        assert_eq!(attenuation(0.0), 1.0);
        for x in [88.0, 1e3, 1e30, f32::MAX, f32::INFINITY] {
            assert!((0.0..1e-37).contains(&attenuation(x)), "{x}");
        }
    }

    #[test]
    fn depth_is_the_logarithm() {
        assert_eq!(depth_reached(0.0), 0.0);
        let small = (0..120).map(|i| (-0.2 * i as f32).exp() * 0.999_999);
        let large = (1..24).map(|i| 1.0 - (-i as f32).exp2());
        for u in small.chain(large).chain((0..4000_u16).map(|i| (f32::from(i) + 0.3) / 4000.0)) {
            let (found, exact) = (f64::from(depth_reached(u)), -(-f64::from(u)).ln_1p());
            assert!((found / exact - 1.0).abs() < 3e-7, "{u}: {found} {exact}");
        }
    }
}
