//! What can go wrong with a file that is written or resumed.

use std::fmt;
use std::path::{Path, PathBuf};

/// A file that cannot be written, or a checkpoint that cannot be used: which, why, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong; no final stop.
    pub message: String,
    /// What to do, if that is known.
    pub help: Option<String>,
}

impl OutputError {
    /// An error about a file.
    #[must_use]
    pub fn new(path: &Path, message: impl Into<String>) -> Self {
        Self { path: path.to_owned(), message: message.into(), help: None }
    }

    /// Adds advice.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for OutputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.message)?;
        if let Some(help) = &self.help {
            write!(f, " ({help})")?;
        }
        Ok(())
    }
}

impl std::error::Error for OutputError {}
