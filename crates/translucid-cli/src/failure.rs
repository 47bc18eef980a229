//! Why a verb ended without its result.

use translucid_image::OutputError;
use translucid_scene::SceneError;

/// What kept a verb from its result.
#[derive(Debug)]
pub(crate) enum Failure {
    /// A scene, mesh or image file is wrong, or an option does not fit it.
    Scene(SceneError),
    /// An option is wrong.
    Input {
        /// What is wrong, with the value found and the values allowed.
        message: String,
        /// What to do, if that is known.
        help: Option<String>,
    },
    /// A file given by the user cannot be written or resumed from, or there is nothing to denoise with.
    File(OutputError),
    /// The input was right, but the work could not be done.
    Work {
        /// What went wrong.
        message: String,
        /// What to do, if that is known.
        help: Option<String>,
    },
    /// Ctrl-C: what there is has been written.
    Interrupted {
        /// How to go on.
        help: String,
    },
}

impl Failure {
    /// An option that is wrong.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self::Input { message: message.into(), help: None }
    }

    /// Work that could not be done.
    pub(crate) fn work(message: impl Into<String>) -> Self {
        Self::Work { message: message.into(), help: None }
    }

    /// A file that could be written when the work began, but not when it ended.
    pub(crate) fn late(error: OutputError) -> Self {
        Self::Work { message: error.located_message(), help: error.help }
    }

    /// Adds advice to a wrong option.
    pub(crate) fn with_help(self, advice: impl Into<String>) -> Self {
        match self {
            Self::Input { message, .. } => Self::Input { message, help: Some(advice.into()) },
            Self::Work { message, .. } => Self::Work { message, help: Some(advice.into()) },
            other => other,
        }
    }

    /// 2 where the input is wrong, else 1.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_) | Self::Input { .. } | Self::File(_) => 2,
            Self::Work { .. } | Self::Interrupted { .. } => 1,
        }
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::File(error)
    }
}
