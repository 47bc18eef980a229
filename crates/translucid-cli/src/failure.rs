//! Why a verb ended without its result.

use translucid_files::OutputError;
use translucid_profile::InputError;
use translucid_scene::{Place, SceneError};

/// A reason why a verb has no result: what is wrong, where, and what to do about it.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) kind: FailureKind,
    /// The fault, with the value found and the values allowed.
    pub(crate) message: String,
    /// The file that it is about.
    pub(crate) place: Option<Place>,
    /// Advice, if there is any.
    pub(crate) help: Option<String>,
}

/// Whose fault a failure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FailureKind {
    /// An option or a file that the user has named is wrong.
    Input,
    /// The input was right, but the work could not be done.
    Work,
    /// Another process is writing the output.
    Held,
    /// Ctrl-C or another signal to stop: what there is has been written.
    Interrupted,
}

impl Failure {
    /// How an interrupted command of several pictures goes on.
    pub(crate) const GO_ON: &str = "repeat the command with --resume to go on";

    /// An option that is wrong.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self { kind: FailureKind::Input, message: message.into(), place: None, help: None }
    }

    /// Work that could not be done.
    pub(crate) fn work(message: impl Into<String>) -> Self {
        Self { kind: FailureKind::Work, ..Self::input(message) }
    }

    /// An output that another process is writing.
    pub(crate) fn held(message: impl Into<String>) -> Self {
        Self { kind: FailureKind::Held, ..Self::input(message) }
    }

    /// Ctrl-C, and how to go on.
    pub(crate) fn interrupted(help: impl Into<String>) -> Self {
        Self { kind: FailureKind::Interrupted, ..Self::input("interrupted") }.with_help(help)
    }

    /// The failure of a picture, by its number from 0 among several: those before it are there, so that an interrupted command can go on.
    pub(crate) fn of_picture(self, number: usize) -> Self {
        match (self.kind, number) {
            (FailureKind::Interrupted, 1..) => Self::interrupted(Self::GO_ON),
            _ => self,
        }
    }

    /// A file that could be written when the work began, but not when it ended.
    pub(crate) fn late(error: OutputError) -> Self {
        let message = error.located_message();
        Self { help: error.help, ..Self::work(message) }
    }

    /// Something that the machine does not have.
    pub(crate) fn of_machine(error: SceneError) -> Self {
        Self { kind: FailureKind::Work, ..error.into() }
    }

    /// Adds advice.
    pub(crate) fn with_help(self, advice: impl Into<String>) -> Self {
        Self { help: Some(advice.into()), ..self }
    }

    /// 2 where the input is wrong, 1 where the work could not be done, 75 (`EX_TEMPFAIL` of sysexits.h) where it can be done
    /// later; of an interruption the signal decides.
    pub(crate) fn exit_code(&self) -> Option<u8> {
        match self.kind {
            FailureKind::Input => Some(2),
            FailureKind::Work => Some(1),
            FailureKind::Held => Some(75),
            FailureKind::Interrupted => None,
        }
    }
}

impl From<SceneError> for Failure {
    fn from(SceneError { message, place, help }: SceneError) -> Self {
        Self { place, help, ..Self::input(message) }
    }
}

impl From<InputError> for Failure {
    fn from(error: InputError) -> Self {
        Self { help: error.help, ..Self::input(error.message) }
    }
}

impl From<OutputError> for Failure {
    fn from(OutputError { path, message, help }: OutputError) -> Self {
        Self { place: path.as_deref().map(Place::file), help, ..Self::input(message) }
    }
}
