//! Ranges that numbers must be in, the same for those from files and those from code.

use std::fmt;

use crate::Error;

/// An interval of numbers; its ends are finite, so nothing infinite is in it, and no NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Low end.
    pub low: f64,
    /// High end.
    pub high: f64,
    /// Whether the low and the high end belong to it.
    closed: [bool; 2],
}

/// Largest coordinate and length \[L\]: products of four lengths stay within single precision.
const LARGEST_LENGTH: f64 = 1e9;
/// Largest coordinate of cameras and lights, and length of the latter \[L\]: they see and light the farthest meshes from
/// outside.
const LARGEST_REACH: f64 = 1e10;
/// Largest radiance, power and the like.
const LARGEST_LIGHT: f64 = 1e12;

impl Interval {
    /// Weights, roughnesses, albedos.
    pub const UNIT: Self = Self::closed(0.0, 1.0);
    /// Coordinates of meshes \[L\].
    pub const COORDINATE: Self = Self::closed(-LARGEST_LENGTH, LARGEST_LENGTH);
    /// Lengths that may be zero \[L\].
    pub const LENGTH: Self = Self::closed(0.0, LARGEST_LENGTH);
    /// Coordinates of cameras and lights \[L\].
    pub const PLACE: Self = Self::closed(-LARGEST_REACH, LARGEST_REACH);
    /// Distances and sizes of cameras and lights \[L\].
    pub const REACH: Self = Self::above(0.0, LARGEST_REACH);
    /// Radiances, irradiances, intensities, powers.
    pub const LIGHT: Self = Self::closed(0.0, LARGEST_LIGHT);
    /// Factors on images, which are clamped after them.
    pub const FACTOR: Self = Self::closed(0.0, 1e6);
    /// Angles in degrees.
    pub const ANGLE: Self = Self::closed(-36_000.0, 36_000.0);
    /// Components of a direction of any length.
    pub const DIRECTION: Self = Self::closed(-1e6, 1e6);
    /// Indices of refraction.
    pub const IOR: Self = Self::closed(1.0, 4.0);
    /// Factors of an object's size; those near zero are refused, too.
    pub const SCALE: Self = Self::closed(-LARGEST_LENGTH, LARGEST_LENGTH);

    /// `[low, high]`.
    pub const fn closed(low: f64, high: f64) -> Self {
        Self { low, high, closed: [true, true] }
    }

    /// `(low, high)`.
    pub const fn open(low: f64, high: f64) -> Self {
        Self { low, high, closed: [false, false] }
    }

    /// `(low, high]`.
    pub const fn above(low: f64, high: f64) -> Self {
        Self { low, high, closed: [false, true] }
    }

    /// `[low, high)`.
    pub const fn below(low: f64, high: f64) -> Self {
        Self { low, high, closed: [true, false] }
    }

    /// Returns `true` if a number is in the interval; NaN is in none.
    pub fn contains(self, x: f64) -> bool {
        let above = if self.closed[0] { x >= self.low } else { x > self.low };
        let below = if self.closed[1] { x <= self.high } else { x < self.high };
        above && below
    }

    /// Returns `true` if a number is in the interval with both rounded to single precision: 0.1 belongs to [0, 0.1].
    pub fn contains_single(self, x: f32) -> bool {
        let single = |end: f64| f64::from(end as f32);
        Self { low: single(self.low), high: single(self.high), ..self }.contains(f64::from(x))
    }

    /// The numbers nearest to the interval that are not in it, and those that are in none.
    pub fn outside(self) -> Vec<f64> {
        let low = if self.closed[0] { self.low.next_down() } else { self.low };
        let high = if self.closed[1] { self.high.next_up() } else { self.high };
        [low, high, f64::NAN, f64::NEG_INFINITY].into_iter().filter(|x| !self.contains(*x)).collect()
    }

    /// The number of the interval that is nearest to `x`; the lowest for NaN.
    pub fn nearest(self, x: f32) -> f32 {
        let (low, high) = (self.low as f32, self.high as f32);
        let low = if self.closed[0] { low } else { low.next_up() };
        let high = if self.closed[1] { high } else { high.next_down() };
        if x.is_nan() { low } else { x.clamp(low, high) }
    }

    /// Refuses a field's number that is not in the interval.
    ///
    /// # Errors
    /// It is not: the message names field, number and interval.
    pub fn check(self, field: &str, value: f32) -> Result<(), Error> {
        if self.contains_single(value) { Ok(()) } else { Err(refusal(field, Written(value), self.must_be())) }
    }

    /// Refuses a field's numbers if one is not in the interval, and names it.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn check_all(self, field: &str, values: impl AsRef<[f32]>) -> Result<(), Error> {
        let mut numbered = values.as_ref().iter().enumerate();
        match numbered.find(|&(_, &value)| !self.contains_single(value)) {
            Some((i, &value)) => Err(refusal(format!("{field}[{i}]"), Written(value), self.must_be())),
            None => Ok(()),
        }
    }

    fn must_be(self) -> String {
        format!("in {self}")
    }
}

/// An interval of whole numbers, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WholeInterval {
    /// Least number.
    pub low: u64,
    /// Greatest number.
    pub high: u64,
}

impl WholeInterval {
    /// `[low, high]`.
    pub const fn new(low: u64, high: u64) -> Self {
        Self { low, high }
    }

    /// The number of the interval that is nearest to `n`.
    pub fn nearest(self, n: u32) -> u32 {
        u64::from(n).clamp(self.low, self.high) as u32
    }

    /// Returns `true` if a number is in the interval.
    pub fn contains(self, n: u64) -> bool {
        (self.low..=self.high).contains(&n)
    }

    /// Refuses a field's number that is not in the interval.
    ///
    /// # Errors
    /// It is not: the message names field, number and interval.
    pub fn check(self, field: &str, value: impl Into<u64>) -> Result<(), Error> {
        let value = value.into();
        if self.contains(value) { Ok(()) } else { Err(refusal(field, value, self)) }
    }
}

impl fmt::Display for WholeInterval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a whole number in [{}, {}]", self.low, self.high)
    }
}

/// The error of a field with a value that it must not have: "FIELD = VALUE: must be …".
pub fn refusal(field: impl fmt::Display, value: impl fmt::Display, must_be: impl fmt::Display) -> Error {
    Error::new(format!("{field} = {value}: must be {must_be}"))
}

/// Refuses an index that is not below the number of things of a kind.
pub fn check_index(field: &str, index: usize, count: usize, things: &str) -> Result<(), Error> {
    if index < count {
        return Ok(());
    }
    Err(refusal(field, index, format!("less than {count}, the number of {things}")))
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let open = if self.closed[0] { '[' } else { '(' };
        let close = if self.closed[1] { ']' } else { ')' };
        write!(f, "{open}{}, {}{close}", Written(self.low), Written(self.high))
    }
}

/// A number with an exponent where the digits would be many.
pub(crate) struct Written<T>(pub(crate) T);

impl<T: Copy + Into<f64> + fmt::Display + fmt::LowerExp> fmt::Display for Written<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.into().abs();
        if size.is_finite() && (size >= 1e5 || (size != 0.0 && size < 1e-4)) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Interval, WholeInterval};

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

    #[test]
    fn interval_refuses_in_words() {
        let message = |range: Interval, value: f32| range.check("up[1]", value).unwrap_err().message;
        assert_eq!(message(Interval::UNIT, -2.0), "up[1] = -2: must be in [0, 1]");
        assert_eq!(message(Interval::REACH, f32::NAN), "up[1] = NaN: must be in (0, 1e10]");
        assert_eq!(message(Interval::LIGHT, f32::INFINITY), "up[1] = inf: must be in [0, 1e12]");
        assert_eq!(message(Interval::LIGHT, 1e38), "up[1] = 1e38: must be in [0, 1e12]");
        let error = Interval::COORDINATE.check_all("position", [0.0, 1.0, -1e10]).unwrap_err();
        assert_eq!(error.message, "position[2] = -1e10: must be in [-1e9, 1e9]");
        let error = WholeInterval::new(1, 8).check("width", 0_u32).unwrap_err();
        assert_eq!(error.message, "width = 0: must be a whole number in [1, 8]");
    }

    #[test]
    fn nearest_is_in_the_interval() {
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.5] {
            for range in [Interval::UNIT, Interval::open(-1.0, 1.0), Interval::REACH] {
                assert!(range.contains_single(range.nearest(x)), "{x} {range}");
            }
        }
        assert_eq!(Interval::UNIT.nearest(0.5), 0.5);
    }
}
