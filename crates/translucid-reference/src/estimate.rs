//! Figures with their errors.

/// A figure with its error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Value of the figure.
    pub value: f64,
    /// Error, at least 0: for an exact solution an estimate of the greatest numerical error, for a walk the standard
    /// error, one standard deviation of the figure.
    pub error: f64,
}

impl Estimate {
    /// A figure without an error.
    pub const ZERO: Self = Self { value: 0.0, error: 0.0 };

    /// Sum of two parts of a profile, which is neither below 0 nor infinite.
    pub(crate) fn plus(self, other: Self) -> Self {
        let value = (self.value + other.value).clamp(0.0, f64::MAX);
        Self { value, error: (self.error + other.error).min(f64::MAX) }
    }

    /// Energy that is at most 1: nothing leaves that has not entered.
    pub(crate) fn at_most_1(self) -> Self {
        Self { value: self.value.min(1.0), ..self }
    }

    /// Error as a part of the value; infinite for a value of 0 with an error.
    pub fn relative_error(self) -> f64 {
        if self.error == 0.0 { 0.0 } else { self.error / self.value.abs() }
    }
}
