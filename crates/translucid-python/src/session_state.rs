//! What a session is doing (idle, running, lost) and what is known of it meanwhile.

use std::sync::Arc;

use pyo3::PyErr;
use pyo3::exceptions::PyRuntimeError;
use translucid_render::{LiveFilm, Outcome, RunningSession, Session};
use translucid_scene::SceneError;

use crate::scene_error::scene_error;

/// The state of a session.
pub(crate) enum State {
    Idle(Box<Session>),
    Running(RunningSession),
    /// A defect ended it.
    Lost,
}

/// What is known of a session since its last edit, whatever it does.
pub(crate) struct Facts {
    pub(crate) film: Arc<LiveFilm>,
    pub(crate) notes: Vec<String>,
    pub(crate) exposure: f32,
    pub(crate) tone_mapping: &'static str,
    pub(crate) samples_per_pixel: u32,
}

impl Facts {
    pub(crate) fn of(session: &Session) -> Self {
        let film = session.view().film();
        Self {
            film: session.film(),
            notes: session
                .prepared()
                .notes()
                .iter()
                .map(ToString::to_string)
                .chain(refusal(session))
                .collect(),
            exposure: film.exposure,
            tone_mapping: film.tone_mapping.name(),
            samples_per_pixel: session.prepared().scene().integrator.samples_per_pixel,
        }
    }
}

/// Why the processor traces where a device was to be used if it can.
pub(crate) fn refusal(session: &Session) -> Option<String> {
    session.refusal().map(|reason| format!("the processor traces: {reason}"))
}

/// Why there is no session or no more of it.
pub(crate) enum Failure {
    Scene(SceneError),
    Work(String),
}

impl Failure {
    pub(crate) fn work(error: impl std::fmt::Display) -> Self {
        Self::Work(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::Scene(error)
    }
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Scene(error) => scene_error(error),
            Failure::Work(message) => PyRuntimeError::new_err(message),
        }
    }
}

pub(crate) fn lost() -> Failure {
    Failure::work("a defect has ended the session")
}

/// Has a session end if it runs, by `how`.
pub(crate) fn end(
    state: &mut State,
    how: impl FnOnce(RunningSession) -> (Session, Result<Outcome, SceneError>),
) -> Result<(), Failure> {
    match std::mem::replace(state, State::Lost) {
        State::Running(running) => {
            let (session, result) = how(running);
            *state = State::Idle(Box::new(session));
            result?;
        }
        other => *state = other,
    }
    Ok(())
}
