//! Why nothing was measured.

use std::fmt;
use std::path::Path;

use translucid_profile::ParameterError;
use translucid_scene::{Place, SceneError};

/// A reason why nothing was measured.
#[derive(Clone, Debug)]
pub struct MeasureError {
    /// The fault, with the value found and what is allowed.
    pub message: String,
    /// The photograph or file at fault; none where an option is.
    pub place: Option<Place>,
    /// Advice, if there is any.
    pub help: Option<String>,
}

impl MeasureError {
    /// A fault of an option.
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, help: None }
    }

    /// A fault of a photograph.
    pub(crate) fn of_photo(name: &str, message: impl Into<String>) -> Self {
        Self { place: Some(Place::file(Path::new(name))), ..Self::new(message) }
    }

    /// A fault of an option that a model has found.
    pub(crate) fn of_option(option: &str, error: &ParameterError) -> Self {
        Self::new(format!("`{option}`: {error}"))
    }

    /// Adds advice.
    pub(crate) fn with_help(self, advice: impl Into<String>) -> Self {
        Self { help: Some(advice.into()), ..self }
    }
}

impl fmt::Display for MeasureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for MeasureError {}

impl From<SceneError> for MeasureError {
    fn from(SceneError { message, place, help }: SceneError) -> Self {
        Self { message, place, help }
    }
}
