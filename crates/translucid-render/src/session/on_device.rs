//! A scene on a device that traces its paths, or on none where that cannot take it.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use translucid_scene::SceneError;

use crate::device::{DeviceScene, DeviceTrees, TracingDevice};
use crate::render::{Goal, LiveFilm, Outcome, PathTracing, PreparedScene, SampleProgress, View, render_on};

/// A device, and the scene on it once a picture of it is asked for.
pub struct OnDevice {
    device: Arc<dyn TracingDevice>,
    is_preferred: bool,
    state: State,
    /// The trees of the scene before the last edit.
    trees: DeviceTrees,
}

enum State {
    /// The device does not have the scene as it is now.
    Stale,
    Open(Box<dyn PathTracing>),
    /// Why the processor traces it.
    Refused(String),
}

impl OnDevice {
    /// A device that has to trace whatever comes.
    pub fn required(device: Arc<dyn TracingDevice>) -> Self {
        Self { device, is_preferred: false, state: State::Stale, trees: DeviceTrees::default() }
    }

    /// A device in whose place the processor traces the scenes that it cannot take.
    pub fn preferred(device: Arc<dyn TracingDevice>) -> Self {
        Self { is_preferred: true, ..Self::required(device) }
    }

    /// Has the device take the scene anew with the next picture: after an edit, or where pixels are filtered otherwise.
    pub fn renew(&mut self) {
        self.state = State::Stale;
    }

    /// Hands over the scene, if the device does not have it yet.
    ///
    /// # Errors
    /// The scene needs something that devices lack, or is too large, and the device is required.
    pub fn open(&mut self, prepared: &PreparedScene, view: &View) -> Result<(), SceneError> {
        if !matches!(self.state, State::Stale) {
            return Ok(());
        }
        let opened = DeviceScene::edited(prepared, view, &self.device.limits(), &mut self.trees)
            .and_then(|scene| Arc::clone(&self.device).open(&scene).map_err(SceneError::new));
        self.state = match opened {
            Ok(tracing) => State::Open(tracing),
            Err(error) if self.is_preferred => State::Refused(error.to_string()),
            Err(error) => return Err(error),
        };
        Ok(())
    }

    /// Name of the device, unless the processor traces in its place.
    pub fn name(&self) -> Option<&str> {
        (!matches!(self.state, State::Refused(_))).then(|| self.device.name())
    }

    /// Why the processor traces in place of a preferred device, in words.
    pub fn refusal(&self) -> Option<&str> {
        if let State::Refused(reason) = &self.state { Some(reason) } else { None }
    }

    /// Adds samples of a view to the film until the goal is reached; otherwise as
    /// [`PreparedScene::render`](PreparedScene::render).
    ///
    /// # Errors
    /// As [`open`](Self::open), or the device failed; samples that were done before are in the film.
    pub fn render(
        &mut self,
        prepared: &PreparedScene,
        view: &View,
        film: &LiveFilm,
        goal: &Goal,
        progress: &(dyn Fn(SampleProgress) + Sync),
        stop: &AtomicBool,
    ) -> Result<Outcome, SceneError> {
        self.open(prepared, view)?;
        match &mut self.state {
            State::Open(tracing) => {
                render_on(&mut **tracing, view, film, goal, progress, stop).map_err(SceneError::new)
            }
            _ => Ok(prepared.render(view, film, goal, progress, stop)),
        }
    }
}
