//! A session on threads of its own.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use translucid_scene::SceneError;

use super::{Event, Plan, Session};
use crate::render::{LiveFilm, Outcome};

/// A session that runs in the background. Dropping it stops it.
pub struct RunningSession {
    film: Arc<LiveFilm>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<(Session, Result<Outcome, SceneError>)>>,
}

impl RunningSession {
    pub(super) fn start(
        mut session: Session,
        plan: Plan,
        threads: usize,
        observer: impl Fn(&Event<'_>) + Sync + Send + 'static,
    ) -> io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(io::Error::other)?;
        let (film, stop) = (session.film(), Arc::new(AtomicBool::new(false)));
        let flag = Arc::clone(&stop);
        let thread = std::thread::Builder::new().name("session".into()).spawn(move || {
            let result = pool.install(|| session.run(&plan, &observer, &flag));
            (session, result)
        })?;
        Ok(Self { film, stop, thread: Some(thread) })
    }

    /// The film, to be read at any time.
    pub fn film(&self) -> &LiveFilm {
        &self.film
    }

    /// Returns `true` if it has come to its end.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends the rendering within the time of a few paths and gives the session back, to be edited or to go on.
    pub fn stop(self) -> (Session, Result<Outcome, SceneError>) {
        self.stop.store(true, Ordering::Relaxed);
        self.wait()
    }

    /// Waits for the rendering to end.
    pub fn wait(mut self) -> (Session, Result<Outcome, SceneError>) {
        let Some(thread) = self.thread.take() else { unreachable!("only this takes the thread") };
        match thread.join() {
            Ok(ended) => ended,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

impl Drop for RunningSession {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic was the observer's or ours: nobody is left to hear of it
            let _ = thread.join();
        }
    }
}
