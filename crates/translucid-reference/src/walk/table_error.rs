//! What can go wrong with a table, said so that it can be mended.

use std::path::{Path, PathBuf};
use std::{fmt, io};

use translucid_profile::ParameterError;

use super::photon_ranges::PhotonRange;

/// Why a table could not be made, merged, read or written.
#[derive(Debug)]
pub enum TableError {
    /// A parameter is out of range.
    Parameter(ParameterError),
    /// Tables to be merged belong to different walks.
    Differs {
        /// In what they differ.
        what: &'static str,
        /// What it is in the table that was to be extended.
        here: String,
        /// What it is in the other one.
        there: String,
    },
    /// Tables to be merged, or a table and a run that is to extend it, share photons.
    Repeated(PhotonRange),
    /// A sum of photons or orders is too large for 64 bits, or a seed has no more photons.
    TooMany,
    /// The operating system refuses a file.
    Io {
        /// The file.
        path: PathBuf,
        /// What was refused, worded to follow "cannot".
        action: &'static str,
        /// Why.
        source: io::Error,
    },
    /// A file is not a table, or not a whole one.
    File {
        /// The file.
        path: PathBuf,
        /// The member of the archive, empty where the archive itself is meant.
        member: String,
        /// What was found and what is allowed.
        problem: String,
    },
}

impl TableError {
    pub(crate) fn io(path: &Path, action: &'static str) -> impl Fn(io::Error) -> Self {
        move |source| Self::Io { path: path.to_owned(), action, source }
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
            Self::Io { path, action, source } => write!(f, "cannot {action} {}: {source}", path.display()),
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
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

impl From<ParameterError> for TableError {
    fn from(error: ParameterError) -> Self {
        Self::Parameter(error)
    }
}
