//! A session that is read while it runs in the background, and edited once it does not.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use translucid_render::{Edit, Event, LiveFilm, Outcome, Plan, RunningSession, Session, available_memory};
use translucid_scene::{Image, SceneError, Warning};

use crate::scene_error::warn;
use crate::session_state::{Facts, Failure, State, end, lost};

/// A session, and what can be read of it while it runs.
pub(crate) struct LiveSession {
    state: Mutex<State>,
    /// The parts that can be read while it runs.
    facts: Mutex<Facts>,
    threads: usize,
    progress: Arc<Progress>,
    /// Somebody waits for the session, for which [`work`](Self::work) is to end.
    is_wanted: AtomicBool,
}

/// Paths done and to be done.
#[derive(Default)]
struct Progress {
    done: AtomicU64,
    total: AtomicU64,
}

impl LiveSession {
    /// A session that is idle, to be rendered with so many threads, or with 0 by one per processor.
    pub(crate) fn new(session: Session, threads: usize) -> Self {
        Self {
            facts: Mutex::new(Facts::of(&session)),
            state: Mutex::new(State::Idle(Box::new(session))),
            threads,
            progress: Arc::default(),
            is_wanted: AtomicBool::new(false),
        }
    }

    /// Threads to render with, 0 for one per processor.
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// Paths done and to be done.
    pub(crate) fn progress(&self) -> [u64; 2] {
        [&self.progress.done, &self.progress.total].map(|count| count.load(Ordering::Relaxed))
    }

    /// True while it runs in the background.
    pub(crate) fn is_running(&self) -> bool {
        matches!(&*self.lock(), State::Running(running) if !running.is_finished())
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Facts of the session, whatever it does.
    pub(crate) fn facts(&self) -> MutexGuard<'_, Facts> {
        self.facts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The film that is read. Nobody waits for it who holds the interpreter.
    pub(crate) fn film(&self, py: Python<'_>) -> Arc<LiveFilm> {
        py.detach(|| Arc::clone(&self.facts().film))
    }

    /// Has it render these samples of each pixel in the background.
    ///
    /// # Errors
    /// It runs already, or the threads cannot be started.
    pub(crate) fn start_to(&self, py: Python<'_>, samples: Range<u32>) -> PyResult<()> {
        py.detach(|| {
            let mut state = self.lock();
            let session = match std::mem::replace(&mut *state, State::Lost) {
                State::Idle(session) => *session,
                State::Running(running) => {
                    *state = State::Running(running);
                    return Err(Failure::work("the session is running: wait for it, or cancel it"));
                }
                State::Lost => return Err(lost()),
            };
            let total = samples.len() as u64 * session.view().region().area();
            let progress = Arc::clone(&self.progress);
            progress.done.store(session.film().sums().paths(), Ordering::Relaxed);
            progress.total.store(total, Ordering::Relaxed);
            let point_memory = available_memory().unwrap_or(u64::MAX);
            let plan = Plan { samples, point_memory, ..Plan::samples(0) };
            let observer = move |event: &Event<'_>| {
                if let Event::Samples(now) = event {
                    progress.done.store(now.samples_done, Ordering::Relaxed);
                }
            };
            // What cannot be started is gone with its threads: there is no memory for a stack
            *state = State::Running(session.start(plan, self.threads, observer).map_err(Failure::work)?);
            Ok(())
        })?;
        Ok(())
    }

    /// Has the session end if it runs, by `how`.
    pub(crate) fn end(
        &self,
        py: Python<'_>,
        how: impl FnOnce(RunningSession) -> (Session, Result<Outcome, SceneError>) + Send,
    ) -> PyResult<()> {
        py.detach(|| {
            self.is_wanted.store(true, Ordering::Relaxed);
            let mut state = self.lock();
            self.is_wanted.store(false, Ordering::Relaxed);
            end(&mut state, how)?;
            // Whether a device can take an edited scene is known once it was to trace it
            if let State::Idle(session) = &*state {
                *self.facts() = Facts::of(session);
            }
            Ok::<_, Failure>(())
        })?;
        Ok(())
    }

    /// Ends the session if it runs, and returns what `use_it` makes of it.
    pub(crate) fn with_idle<T: Send>(
        &self,
        py: Python<'_>,
        use_it: impl FnOnce(&mut Session) -> Result<T, SceneError> + Send,
    ) -> PyResult<T> {
        Ok(py.detach(|| self.idle(use_it))?)
    }

    fn idle<T>(&self, use_it: impl FnOnce(&mut Session) -> Result<T, SceneError>) -> Result<T, Failure> {
        let mut state = self.lock();
        end(&mut state, RunningSession::stop)?;
        match &mut *state {
            State::Idle(session) => Ok(use_it(session)?),
            State::Running(_) | State::Lost => Err(lost()),
        }
    }

    /// Works with the session on its threads; ends it before if it runs. The work is told to stop by the flag, and where
    /// the session is ended meanwhile.
    pub(crate) fn work<T: Send>(
        &self,
        stop: &AtomicBool,
        work: impl FnOnce(&mut Session, &(dyn Fn() -> bool + Sync)) -> Result<T, SceneError> + Send,
    ) -> Result<T, Failure> {
        let is_stopped = || stop.load(Ordering::Relaxed) || self.is_wanted.load(Ordering::Relaxed);
        self.idle(|session| self.pool()?.install(|| work(session, &is_stopped)))
    }

    fn pool(&self) -> Result<rayon::ThreadPool, SceneError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build();
        pool.map_err(|error| SceneError::new(format!("cannot start the threads: {error}")))
    }

    /// Changes the session, which is ended if it runs; its film then begins anew.
    pub(crate) fn edit(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut Session) -> Result<(), SceneError> + Send,
    ) -> PyResult<()> {
        self.with_idle(py, |session| {
            self.pool()?.install(|| change(session))?;
            *self.facts() = Facts::of(session);
            Ok(())
        })
    }

    /// Makes an edit that may read files, and warns of what was repaired in them.
    pub(crate) fn edit_with_files(
        &self,
        py: Python<'_>,
        make: impl FnOnce(&Session, &mut Vec<Warning>) -> Result<(Vec<Arc<Image>>, Edit), SceneError> + Send,
    ) -> PyResult<()> {
        let mut warnings = Vec::new();
        self.edit(py, |session| {
            let (images, edit) = make(session, &mut warnings)?;
            for image in images {
                session.edit(Edit::AddImage(image))?;
            }
            session.edit(edit)?;
            session.edit(Edit::DropUnusedImages).map(drop)
        })?;
        warn(py, &warnings)
    }
}
