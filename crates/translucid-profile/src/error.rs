//! Errors of parameters and of texts, with what is needed to mend them.

use std::fmt;

/// A parameter outside the range in which the model has a meaning.
///
/// ```
/// use translucid_profile::NormalizedDiffusion;
///
/// let error = NormalizedDiffusion::from_d(1.2, 1.0).unwrap_err();
/// assert_eq!(error.to_string(), "surface_albedo is 1.2, but must be in [0, 1]");
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterError {
    /// The parameter's name as the API spells it.
    pub parameter: &'static str,
    /// The value that was found.
    pub value: f64,
    /// The range or condition it must meet, worded to follow "must be".
    pub allowed: &'static str,
    /// A number that belongs behind `allowed`, where the range depends on other parameters.
    pub limit: Option<f64>,
}

impl ParameterError {
    /// The error of a parameter outside a range that does not depend on others.
    pub fn new(parameter: &'static str, value: f64, allowed: &'static str) -> Self {
        Self { parameter, value, allowed, limit: None }
    }

    /// Range or condition with its number, worded to follow "must be".
    pub fn requirement(&self) -> String {
        match self.limit {
            Some(limit) => format!("{} {}", self.allowed, Written(limit)),
            None => self.allowed.to_owned(),
        }
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { parameter, value, .. } = self;
        let (value, requirement) = (Written(*value), self.requirement());
        write!(f, "{parameter} is {value}, but must be {requirement}")
    }
}

impl std::error::Error for ParameterError {}

/// Names or a text that cannot be used: what was found, what is allowed, and what to do about it.
///
/// ```
/// let error = translucid_profile::convention::preset("skinn1").unwrap_err();
/// assert_eq!(error.message, "there is no preset \"skinn1\"");
/// assert!(error.help.unwrap().starts_with("did you mean \"skin1\"?"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError {
    /// The fault, with the value found and the values allowed; no final stop.
    pub message: String,
    /// Line of the text, from 1, if the fault is in one of its lines.
    pub line: Option<usize>,
    /// Advice, if there is any.
    pub help: Option<String>,
}

impl InputError {
    /// An error without advice.
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), line: None, help: None }
    }

    /// An error in a line, from 1.
    pub(crate) fn at_line(line: usize, message: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(message) }
    }

    /// Adds advice.
    pub(crate) fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

/// The message and the advice, without the line.
impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, " ({help})"))
    }
}

impl std::error::Error for InputError {}

/// A number as people write it: 0.95, but 1e200 and 3e-9 instead of all their zeros.
struct Written(f64);

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if magnitude >= 1e15 && magnitude.is_finite() || magnitude < 1e-4 && magnitude > 0.0 {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// Passes a parameter's value on if a condition holds.
///
/// # Errors
/// It does not hold; `allowed` states what does, worded to follow "must be".
pub fn require(
    holds: bool,
    parameter: &'static str,
    value: f64,
    allowed: &'static str,
) -> Result<f64, ParameterError> {
    if holds { Ok(value) } else { Err(ParameterError::new(parameter, value, allowed)) }
}

/// Passes a fraction on if it lies in [0, 1].
pub(crate) fn require_fraction(parameter: &'static str, value: f64) -> Result<f64, ParameterError> {
    require((0.0..=1.0).contains(&value), parameter, value, "in [0, 1]")
}

/// Passes a quantity on if it is finite and not negative.
pub(crate) fn require_non_negative(parameter: &'static str, value: f64) -> Result<f64, ParameterError> {
    require(value >= 0.0 && value.is_finite(), parameter, value, "finite and at least 0")
}

/// Passes a quantity on if it is finite and positive.
pub(crate) fn require_positive(parameter: &'static str, value: f64) -> Result<f64, ParameterError> {
    require(value > 0.0 && value.is_finite(), parameter, value, "finite and greater than 0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_spare_zeros() {
        let message = |value| ParameterError::new("x", value, "good").to_string();
        for (value, expected) in [
            (0.0, "0"),
            (-0.25, "-0.25"),
            (1e6, "1000000"),
            (1e200, "1e200"),
            (-3e-9, "-3e-9"),
            (f64::NAN, "NaN"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(message(value), format!("x is {expected}, but must be good"));
        }
        let most = ParameterError { limit: Some(1e-9), ..ParameterError::new("x", 1.0, "at most") };
        assert_eq!(most.to_string(), "x is 1, but must be at most 1e-9");
    }

    #[test]
    fn require_refuses_nan() {
        assert!(require_fraction("x", f64::NAN).is_err());
        assert!(require_non_negative("x", f64::NAN).is_err());
    }

    #[test]
    fn require_keeps_the_edges() {
        assert_eq!(require_fraction("x", 0.0), Ok(0.0));
        assert_eq!(require_fraction("x", 1.0), Ok(1.0));
        assert_eq!(require_non_negative("x", 0.0), Ok(0.0));
        assert!(require_non_negative("x", f64::INFINITY).is_err());
    }
}
