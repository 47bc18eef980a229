//! Files that cannot be written, and work on their content that cannot be done.

use std::fmt;
use std::path::{Path, PathBuf};

/// A failure to write, resume or denoise: which file, why, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    /// The file, where it is about one.
    pub path: Option<PathBuf>,
    /// The fault, without a final stop.
    pub message: String,
    /// Advice, if there is any.
    pub help: Option<String>,
}

impl OutputError {
    /// An error about a file.
    pub fn new(path: &Path, message: impl Into<String>) -> Self {
        Self { path: Some(path.to_owned()), message: message.into(), help: None }
    }

    /// An error about no file.
    pub fn without_file(message: impl Into<String>) -> Self {
        Self { path: None, message: message.into(), help: None }
    }

    /// Adds advice.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// The message behind the path of its file.
    pub fn located_message(&self) -> String {
        let path = self.path.as_ref().map(|path| format!("{}: ", path.display()));
        path.unwrap_or_default() + &self.message
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.located_message())?;
        self.help.as_ref().map_or(Ok(()), |help| write!(f, " ({help})"))
    }
}

impl std::error::Error for OutputError {}
