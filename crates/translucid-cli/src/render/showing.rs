//! Somebody who looks at a film while it is rendered, on a thread of their own.
//!
//! The rendering waits for them nowhere: they read the film a little at a time, and look the less often the longer that
//! takes.

use std::fs;
use std::io;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, TryRecvError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Least pause over the time of a processor that a look takes, of as many as there are threads, for all of them together
/// to lose one percent.
const PAUSES: u32 = 100;

/// Screen or file that a film is shown on.
pub(crate) trait Screen: Send + 'static {
    /// Name of its thread.
    const NAME: &'static str;
    /// Least time between two looks.
    const INTERVAL: Duration;

    /// Makes ready, before the first look.
    fn begin(&mut self) {}

    /// Shows what has changed, unless it is to stop on the way.
    fn show(&mut self, is_to_stop: &mut dyn FnMut() -> bool);

    /// Shows the film in the end, which nobody waits long for.
    fn finish(&mut self);
}

/// A film that is being shown.
pub(crate) struct Showing {
    ended: Sender<()>,
    thread: JoinHandle<()>,
}

impl Showing {
    /// Begins to show.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub(crate) fn start<S: Screen>(screen: S) -> io::Result<Self> {
        let (ended, end) = mpsc::channel();
        // On a pool's thread it is that pool's number
        let threads = rayon::current_num_threads() as u32;
        let show = move || run(screen, threads, &end);
        Ok(Self { ended, thread: thread::Builder::new().name(S::NAME.to_owned()).spawn(show)? })
    }

    /// Shows the last state of the film and waits until that is done, but not for long.
    pub(crate) fn finish(self) {
        if self.ended.send(()).is_ok() {
            // It has no more to say, even if it panicked
            let _ = self.thread.join();
        }
    }
}

/// Shows the film until the end comes.
fn run<S: Screen>(mut screen: S, threads: u32, end: &Receiver<()>) {
    let began = Instant::now();
    let mut cost = Duration::ZERO;
    screen.begin();
    loop {
        match end.recv_timeout((cost * PAUSES / threads.max(1)).max(S::INTERVAL)) {
            Err(RecvTimeoutError::Timeout) => {}
            Ok(()) => break,
            // The rendering has failed
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let before = computed(began);
        let mut is_ended = false;
        screen.show(&mut || {
            is_ended = end.try_recv() != Err(TryRecvError::Empty);
            is_ended
        });
        if is_ended {
            break;
        }
        cost = computed(began).saturating_sub(before);
    }
    screen.finish();
}

/// Time that this thread has had a processor; all time since its beginning where the system does not say, which counts
/// waiting, too.
fn computed(began: Instant) -> Duration {
    let account = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = account.and_then(|text| text.split_whitespace().next()?.parse().ok());
    nanoseconds.map_or_else(|| began.elapsed(), Duration::from_nanos)
}
