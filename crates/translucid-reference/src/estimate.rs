//! A number and how far it may be off.

/// A figure with its error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The figure.
    pub value: f64,
    /// How far it may be off, at least 0.
    ///
    /// Of an exact solution: an estimate of the greatest numerical error.
    /// Of a walk: the standard error, one standard deviation of the figure.
    pub error: f64,
}

impl Estimate {
    /// A figure without an error.
    pub const ZERO: Self = Self { value: 0.0, error: 0.0 };

    /// The error as a part of the value; infinite for a value of 0 with an error.
    pub fn relative_error(self) -> f64 {
        if self.error == 0.0 { 0.0 } else { self.error / self.value.abs() }
    }
}
