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

/// E₂(x) = ∫ e^{−xt}/t² dt from 1 on, for x ≥ 0, to 6e-7 [Abramowitz & Stegun 1964, 5.1.14 with 5.1.53 and 5.1.56].
pub(super) fn exponential_integral_2(x: f32) -> f32 {
    // Beyond, the powers overflow, and nothing is left
    let x = x.min(100.0);
    let polynomial = |c: &[f32]| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    if x < 1.0 {
        // E₁(x) + ln x
        let rest = polynomial(&[
            -0.577_215_66,
            0.999_991_93,
            -0.249_910_55,
            0.055_199_68,
            -0.009_760_04,
            0.001_078_57,
        ]);
        attenuation(x) - x * (rest - libm::logf(x.max(f32::MIN_POSITIVE)))
    } else {
        // 1 − x e^x E₁(x)
        let below = [3.958_496_9, 21.099_653, 25.632_956, 9.573_322, 1.0];
        let above = [0.267_773_74, 8.634_761, 18.059_017, 8.573_329, 1.0];
        let difference: [f32; 4] = std::array::from_fn(|i| below[i] - above[i]);
        attenuation(x) * polynomial(&difference) / polynomial(&below)
    }
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

    /// Beside values of Abramowitz & Stegun 1964, table 5.4, and its bounds, 5.1.19: e^{−x}/(x + 2) < E₂(x) < e^{−x}/(x + 1).
    #[test]
    fn exponential_integral_is_that_of_the_tables() {
        assert_eq!(exponential_integral_2(0.0), 1.0);
        for (x, exact) in [
            (0.01, 0.949_670_5),
            (0.1, 0.722_545_0),
            (0.5, 0.326_643_9),
            (1.0, 0.148_495_5),
            (2.0, 0.037_534_26),
        ] {
            let found = exponential_integral_2(x);
            assert!((found - exact).abs() < 6e-7, "{x}: {found}");
        }
        for i in 1..4000_u16 {
            let x = f32::from(i) * 0.02;
            let scaled = f64::from(exponential_integral_2(x)) * f64::from(x).exp();
            let (least, most) = (1.0 / (f64::from(x) + 2.0), 1.0 / (f64::from(x) + 1.0));
            assert!(least * (1.0 - 1e-4) < scaled && scaled < most * (1.0 + 1e-4), "{x}: {scaled}");
        }
        for x in [f32::MIN_POSITIVE, 1e-20, 100.0, 1e30, f32::MAX] {
            assert!((0.0..=1.0).contains(&exponential_integral_2(x)), "{x}");
        }
    }
}
