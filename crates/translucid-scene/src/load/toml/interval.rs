//! The values that a number may take.

use std::fmt;

/// Whether an end of an interval belongs to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum End {
    Closed,
    Open,
}

/// An interval of numbers; its ends are finite, so nothing infinite is in it, and no NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Interval {
    low: f64,
    high: f64,
    low_end: End,
    high_end: End,
}

/// Largest coordinate and length [L]: products of four lengths stay within single precision.
pub(super) const LARGEST_LENGTH: f64 = 1e9;
/// Largest radiance, power and the like.
const LARGEST_LIGHT: f64 = 1e12;

impl Interval {
    /// Weights, roughnesses, albedos.
    pub(super) const UNIT: Self = Self::closed(0.0, 1.0);
    /// Coordinates [L].
    pub(super) const COORDINATE: Self = Self::closed(-LARGEST_LENGTH, LARGEST_LENGTH);
    /// Lengths that may be zero [L].
    pub(super) const LENGTH: Self = Self::closed(0.0, LARGEST_LENGTH);
    /// Lengths above zero [L].
    pub(super) const POSITIVE_LENGTH: Self = Self::above(0.0, LARGEST_LENGTH);
    /// Radiances, irradiances, intensities, powers.
    pub(super) const LIGHT: Self = Self::closed(0.0, LARGEST_LIGHT);
    /// Factors on images, which are clamped after them.
    pub(super) const FACTOR: Self = Self::closed(0.0, 1e6);
    /// Angles in degrees.
    pub(super) const ANGLE: Self = Self::closed(-36_000.0, 36_000.0);
    /// Components of a direction of any length.
    pub(super) const DIRECTION: Self = Self::closed(-1e6, 1e6);
    /// Indices of refraction.
    pub(super) const IOR: Self = Self::closed(1.0, 4.0);

    /// `[low, high]`.
    pub(super) const fn closed(low: f64, high: f64) -> Self {
        Self { low, high, low_end: End::Closed, high_end: End::Closed }
    }

    /// `(low, high)`.
    pub(super) const fn open(low: f64, high: f64) -> Self {
        Self { low, high, low_end: End::Open, high_end: End::Open }
    }

    /// `(low, high]`.
    pub(super) const fn above(low: f64, high: f64) -> Self {
        Self { low, high, low_end: End::Open, high_end: End::Closed }
    }

    /// `[low, high)`.
    pub(super) const fn below(low: f64, high: f64) -> Self {
        Self { low, high, low_end: End::Closed, high_end: End::Open }
    }

    /// Whether a number is in the interval; NaN is in none.
    pub(super) fn contains(self, x: f64) -> bool {
        let above = match self.low_end {
            End::Closed => x >= self.low,
            End::Open => x > self.low,
        };
        let below = match self.high_end {
            End::Closed => x <= self.high,
            End::Open => x < self.high,
        };
        above && below
    }

    /// Whether a number in single precision is in the interval whose ends are, too: 0.1 belongs to [0, 0.1].
    pub(super) fn contains_single(self, x: f32) -> bool {
        let single = |end: f64| f64::from(end as f32);
        Self { low: single(self.low), high: single(self.high), ..self }.contains(f64::from(x))
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let open = if self.low_end == End::Closed { '[' } else { '(' };
        let close = if self.high_end == End::Closed { ']' } else { ')' };
        write!(f, "{open}{}, {}{close}", Written(self.low), Written(self.high))
    }
}

/// A number with an exponent where the digits would be many.
struct Written(f64);

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.abs() >= 1e5 || (self.0 != 0.0 && self.0.abs() < 1e-4) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Interval;

    #[test]
    fn interval_knows_its_ends() {
        assert!(Interval::closed(0.0, 1.0).contains(0.0) && Interval::closed(0.0, 1.0).contains(1.0));
        assert!(!Interval::open(0.0, 1.0).contains(0.0) && !Interval::open(0.0, 1.0).contains(1.0));
        assert!(!Interval::above(0.0, 1.0).contains(0.0) && Interval::above(0.0, 1.0).contains(1.0));
        assert!(Interval::below(0.0, 1.0).contains(0.0) && !Interval::below(0.0, 1.0).contains(1.0));
    }

    #[test]
    fn interval_knows_its_ends_in_single_precision() {
        // The single-precision number next to 0.1 is above it.
        assert!(
            Interval::above(0.0, 0.1).contains_single(0.1)
                && !Interval::above(0.0, 0.1).contains(f64::from(0.1_f32))
        );
        assert!(
            !Interval::above(0.0, 0.1).contains_single(0.0)
                && !Interval::closed(0.0, 0.1).contains_single(0.100_001)
        );
        assert!(!Interval::open(0.0, 180.0).contains_single(180.0));
    }

    #[test]
    fn interval_holds_no_nan_and_no_infinity() {
        for range in [Interval::COORDINATE, Interval::LIGHT, Interval::FACTOR, Interval::UNIT] {
            assert!(![f64::NAN, f64::INFINITY, f64::NEG_INFINITY].iter().any(|&x| range.contains(x)));
        }
    }

    #[test]
    fn interval_reads_as_in_mathematics() {
        assert_eq!(Interval::open(0.0, 180.0).to_string(), "(0, 180)");
        assert_eq!(Interval::above(0.0, 1e9).to_string(), "(0, 1e9]");
        assert_eq!(Interval::below(-0.5, 1e-6).to_string(), "[-0.5, 1e-6)");
    }
}
