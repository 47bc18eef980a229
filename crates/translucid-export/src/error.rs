//! Why there is no text.

use std::fmt;

use translucid_profile::ParameterError;

/// A combination that does not exist, or a parameter out of its range; names those that exist.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportError {
    /// Name of the parameter that is wrong: `to`, `what`, `model`, `surface_albedo` …
    pub parameter: &'static str,
    /// The value found, as text.
    pub found: String,
    /// The allowed values, worded to follow "must be" or "but".
    pub allowed: String,
}

impl ExportError {
    pub(crate) fn new(parameter: &'static str, found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self { parameter, found: found.into(), allowed: allowed.into() }
    }
}

impl fmt::Display for ExportError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { parameter, found, allowed } = self;
        write!(out, "{parameter} is {found}, but must be {allowed}")
    }
}

impl std::error::Error for ExportError {}

impl From<ParameterError> for ExportError {
    fn from(error: ParameterError) -> Self {
        Self::new(error.parameter, error.value.to_string(), error.requirement())
    }
}
