//! Progress of a comparison, and a way to stop it.

use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Observer of long work, who may stop it.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Set to true, from any thread, it ends the work within a fraction of a second.
    pub stop: &'a AtomicBool,
    /// Called with the part of the work that is done, in \[0, 1\], from any of its threads.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl Default for Watch<'_> {
    /// Nobody.
    fn default() -> Self {
        static NEVER: AtomicBool = AtomicBool::new(false);
        Self { stop: &NEVER, progress: &|_| {} }
    }
}

/// The work was stopped from outside before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stopped;

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stopped before the end")
    }
}

impl std::error::Error for Stopped {}

/// Counts work that is done, in milliseconds that it takes on one core, roughly.
pub(super) struct Progress<'a> {
    watch: Watch<'a>,
    done: AtomicU64,
    total: u64,
}

impl<'a> Progress<'a> {
    /// Nothing done of the total, which is at least 1.
    pub(super) fn new(watch: Watch<'a>, total: u64) -> Self {
        Self { watch, done: AtomicU64::new(0), total: total.max(1) }
    }

    /// Reports progress.
    pub(super) fn add(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        (self.watch.progress)((done as f64 / self.total as f64).min(1.0));
    }

    /// Flag that sets the work an end.
    pub(super) fn stop(&self) -> &'a AtomicBool {
        self.watch.stop
    }

    /// Ends the work if that was asked for.
    pub(super) fn check(&self) -> Result<(), Stopped> {
        if self.watch.stop.load(Ordering::Relaxed) { Err(Stopped) } else { Ok(()) }
    }
}
