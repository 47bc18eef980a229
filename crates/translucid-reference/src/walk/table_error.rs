//! Errors of tables, said so that they can be mended.

use std::path::{Path, PathBuf};
use std::{fmt, io};

use translucid_profile::ParameterError;

use super::photon_ranges::PhotonRange;

/// Reason why a table could not be made, merged or read.
#[derive(Debug)]
pub enum TableError {
    /// A parameter is out of range.
    Parameter(ParameterError),
    /// Tables to be merged belong to different walks.
    Differs {
        /// Name of the first thing in which they differ.
        what: &'static str,
        /// Its value in the table that was to be extended.
        here: String,
        /// Its value in the other one.
        there: String,
    },
    /// Tables to be merged, or a table and a run that is to extend it, share photons.
    Repeated(PhotonRange),
    /// A sum of photons or orders is too large for 64 bits, or a seed has no more photons.
    TooMany,
    /// A device cannot walk, for the reason given.
    Device(String),
    /// A file cannot be read.
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Reason that the operating system gives.
        source: io::Error,
    },
    /// A file is not a table, or not a whole one.
    File {
        /// Path of the file.
        path: PathBuf,
        /// Name of the member of the archive, empty where the archive itself is meant.
        member: String,
        /// Problem: the value found and the values allowed.
        problem: String,
    },
}

impl TableError {
    pub(crate) fn unreadable(path: &Path) -> impl Fn(io::Error) -> Self {
        move |source| Self::Unreadable { path: path.to_owned(), source }
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter(error) => error.fmt(f),
            Self::Differs { what, here, there } => {
                write!(f, "the tables differ in {what}: {here} in one, {there} in the other")
            }
            Self::Repeated(range) => write!(f, "{range} would count twice"),
            Self::TooMany => write!(f, "the numbers of photons do not fit in 64 bits"),
            Self::Device(reason) => reason.fmt(f),
            Self::Unreadable { path, source } => write!(f, "cannot read {}: {source}", path.display()),
            Self::File { path, member, problem } if member.is_empty() => {
                write!(f, "{}: {problem}", path.display())
            }
            Self::File { path, member, problem } => write!(f, "{}, {member}: {problem}", path.display()),
        }
    }
}

impl std::error::Error for TableError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Parameter(error) => Some(error),
            Self::Unreadable { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<ParameterError> for TableError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}
