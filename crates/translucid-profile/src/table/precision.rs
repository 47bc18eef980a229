//! The two precisions of tables.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Sub};

use crate::table::monotone_cell::{Cell, RadialCell};
use crate::table::monotone_cell_f32::CellF32;

/// Number type of a table: `f64` for figures, `f32` for the inner loop of a renderer.
///
/// No other type has it.
pub trait Precision: Number {}

impl Precision for f64 {}
impl Precision for f32 {}

/// Arithmetic that tables are written in.
pub trait Number:
    Copy
    + Debug
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Send
    + Sync
    + 'static
{
    /// A cell of a radial table.
    type Cell: RadialCell<Self>;

    /// 0.
    const ZERO: Self;
    /// ½.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// Least normal number.
    const MIN_POSITIVE: Self;
    /// Greatest number.
    const MAX: Self;
    /// 1/2π.
    const INVERSE_TURN: Self;
    /// Bits of a number's fraction.
    const FRACTION_BITS: u32;
    /// Exponent bits of 1.
    const EXPONENT_BIAS: i32;
    /// Shares beyond a radius below this count as this: the last radius that a table gives, for single precision that
    /// of the least random number.
    const COMPLEMENT_MIN: Self;
    /// Lengths that the arithmetic of a view holds.
    const LENGTHS: [Self; 2];
    /// Radii below this many units of length count as this many for a profile that is finite at r = 0.
    const UNIT_RADIUS_MIN: Self;

    /// The nearest number of this precision.
    fn nearest(x: f64) -> Self;
    /// The number in double precision.
    fn wide(self) -> f64;
    /// The bits of the number without the last `shift`, which leave at most 32.
    fn leading_bits(self, shift: u32) -> u32;
    /// The number of these bits, followed by `shift` zeros.
    fn from_leading_bits(bits: u32, shift: u32) -> Self;
    /// The lesser of two numbers; the one that is not NaN.
    fn min(self, other: Self) -> Self;
    /// The greater of two numbers; the one that is not NaN.
    fn max(self, other: Self) -> Self;
    /// e to this power.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
}

macro_rules! number {
    ($number:ident, $bits:ident, $cell:ty, $complement_min:expr, $lengths:expr, $unit_radius_min:expr,
     $exp:path, $ln:path) => {
        impl Number for $number {
            type Cell = $cell;

            const ZERO: Self = 0.0;
            const HALF: Self = 0.5;
            const ONE: Self = 1.0;
            const MIN_POSITIVE: Self = $number::MIN_POSITIVE;
            const MAX: Self = $number::MAX;
            const INVERSE_TURN: Self = 0.5 / std::$number::consts::PI;
            const FRACTION_BITS: u32 = $number::MANTISSA_DIGITS - 1;
            const EXPONENT_BIAS: i32 = $number::MAX_EXP - 1;
            const COMPLEMENT_MIN: Self = $complement_min;
            const LENGTHS: [Self; 2] = $lengths;
            const UNIT_RADIUS_MIN: Self = $unit_radius_min;

            #[inline(always)]
            fn nearest(x: f64) -> Self {
                x as $number
            }

            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }

            #[inline(always)]
            fn leading_bits(self, shift: u32) -> u32 {
                (self.to_bits() >> shift) as u32
            }

            #[inline(always)]
            fn from_leading_bits(bits: u32, shift: u32) -> Self {
                $number::from_bits($bits::from(bits) << shift)
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                $number::min(self, other)
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                $number::max(self, other)
            }

            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }

            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
        }
    };
}

number!(f64, u64, Cell, f64::MIN_POSITIVE, [1e-150, 1e150], 1e-150, libm::exp, libm::log);
number!(f32, u32, CellF32, 1.0 / 8_589_934_592.0, [1e-18, 1e18], 1e-12, libm::expf, libm::logf);
