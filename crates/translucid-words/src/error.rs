//! Errors and warnings of inputs, with their places.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use translucid_profile::InputError;

/// Place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file; empty for a part of a scene that is made in code.
    pub path: PathBuf,
    /// Line, from 1, for text files.
    pub line: Option<usize>,
    /// The text and the byte range in it that a message should underline.
    pub excerpt: Option<(Arc<str>, Range<usize>)>,
    /// Position in words where lines mean nothing: "accessor 3", "byte 812", "material skin".
    pub part: Option<String>,
}

impl Place {
    /// A whole file.
    pub fn file(path: &Path) -> Self {
        Self { path: path.to_owned(), line: None, excerpt: None, part: None }
    }

    /// A line of a text file, from 1.
    pub fn line(path: &Path, line: usize) -> Self {
        Self { line: Some(line), ..Self::file(path) }
    }

    /// A named part of a binary file.
    pub fn part(path: &Path, part: impl Into<String>) -> Self {
        Self { part: Some(part.into()), ..Self::file(path) }
    }

    /// A byte range of a text whose whole content is at hand; the line follows from it.
    pub fn span(path: &Path, text: &Arc<str>, span: Range<usize>) -> Self {
        let line = 1 + text.as_bytes()[..span.start.min(text.len())].iter().filter(|&&b| b == b'\n').count();
        Self { line: Some(line), excerpt: Some((Arc::clone(text), span)), ..Self::file(path) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        match &self.part {
            Some(part) if self.path.as_os_str().is_empty() => f.write_str(part),
            Some(part) => write!(f, ", {part}"),
            None => Ok(()),
        }
    }
}

/// An input that cannot be used: what was found, where, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// The fault, with the value found and the values allowed; no final stop.
    pub message: String,
    /// Where, if it is in a file.
    pub place: Option<Place>,
    /// Advice, if there is any.
    pub help: Option<String>,
}

impl Error {
    /// An error at a place.
    pub fn at(place: Place, message: impl Into<String>) -> Self {
        Self { message: message.into(), place: Some(place), help: None }
    }

    /// The error of a text that is the content of a file.
    pub fn of_text(path: &Path, error: InputError) -> Self {
        let place = error.line.map_or_else(|| Place::file(path), |line| Place::line(path, line));
        Self { place: Some(place), ..error.into() }
    }

    /// An error that is in no file.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), place: None, help: None }
    }

    /// The error with the part of the scene that it is in before its message: "material skin, …".
    pub fn within(mut self, part: impl fmt::Display) -> Self {
        self.message = format!("{part}, {}", self.message);
        self
    }

    /// The error with a thing before its message, by the thing's name if it has one.
    pub fn within_named(self, thing: &str, name: &str) -> Self {
        if name.is_empty() { self.within(thing) } else { self.within(format_args!("{thing} {name}")) }
    }

    /// The error at a file, if it has no place yet.
    pub fn or_at(mut self, path: &Path) -> Self {
        self.place.get_or_insert_with(|| Place::file(path));
        self
    }

    /// Adds advice.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(place) = &self.place {
            write!(f, "{place}: ")?;
        }
        write!(f, "{}", self.message)?;
        if let Some(help) = &self.help {
            write!(f, " ({help})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

/// An error that is in no file.
impl From<InputError> for Error {
    fn from(error: InputError) -> Self {
        Self { message: error.message, place: None, help: error.help }
    }
}

/// Something a loader repaired or left out, and how often.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// The finding and the repair, with their count.
    pub message: String,
    /// Where.
    pub place: Option<Place>,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => write!(f, "{}", self.message),
        }
    }
}
