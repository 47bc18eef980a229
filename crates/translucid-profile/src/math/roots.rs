//! Roots of functions of one variable, for what has no closed inverse.

/// Root in [0, 1] of a function that falls from `at_ends[0]` > 0 at 0 to `at_ends[1]` < 0 at 1.
///
/// Ends where |f(x)| is below `tolerance(x)`, or the bracket cannot shrink any more.
/// Regula falsi that scales down the value at an end which stays (N. Anderson and Å. Björck 1973, *A new high order
/// method of regula falsi type*, BIT 13): order 1.7 where secants do, and never out of the bracket, which is halved
/// where three steps have not done so.
///
/// ```
/// use translucid_profile::roots::falling_root;
///
/// let root = falling_root(|x| 0.5 - x * x, [0.5, -0.5], |_| 1e-15);
/// assert!((root - 0.5_f64.sqrt()).abs() < 1e-15);
/// ```
pub fn falling_root(f: impl Fn(f64) -> f64, at_ends: [f64; 2], tolerance: impl Fn(f64) -> f64) -> f64 {
    let (mut left, mut at_left) = (0.0, at_ends[0]);
    let (mut right, mut at_right) = (1.0, at_ends[1]);
    let mut width_before = 2.0;
    for step in 0..200 {
        // Halve what three steps have not
        let slow = step % 3 == 0 && right - left > 0.5 * width_before;
        if step % 3 == 0 {
            width_before = right - left;
        }
        let share = if slow { 0.5 } else { at_left / (at_left - at_right) };
        let x = left + (right - left) * share;
        let value = f(x);
        if value.abs() < tolerance(x) || x <= left || x >= right {
            return x;
        }
        if value > 0.0 {
            let ratio = 1.0 - value / at_left;
            (left, at_left) = (x, value);
            at_right *= if ratio > 0.0 { ratio } else { 0.5 };
        } else {
            let ratio = 1.0 - value / at_right;
            (right, at_right) = (x, value);
            at_left *= if ratio > 0.0 { ratio } else { 0.5 };
        }
    }
    0.5 * (left + right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falling_root_finds_steep_and_flat_roots() {
        for power in [0.1, 0.5, 1.0, 3.0, 20.0] {
            for root in [1e-6_f64, 0.01, 0.3, 0.9, 1.0 - 1e-9] {
                let level = root.powf(power);
                let found = falling_root(|x| level - x.powf(power), [level, level - 1.0], |_| 1e-16);
                let level_found = found.powf(power);
                assert!((level_found - level).abs() < 1e-15, "{power} {root}: {found}");
            }
        }
    }
}
