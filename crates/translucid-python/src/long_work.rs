//! Work that takes long: on a thread of its own, while Python looks after signals.

use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;

/// Time between two looks at signals and progress: Ctrl-C is answered within it.
const POLL: Duration = Duration::from_millis(50);

/// Longest that finished work waits to be taken: a signal handler may itself wait for what that work has locked.
const LONGEST_WAIT: Duration = Duration::from_millis(500);

/// Runs work that nothing can stop: where a signal or `poll` raises an exception, it is left to end by itself.
///
/// The flag tells it that nobody waits any more, for it to end early if it can.
///
/// # Errors
/// As of [`run`], or `RuntimeError` if no thread can be started.
pub(crate) fn run_or_abandon<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send + 'static,
    poll: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    run_and_hand_over(py, |stop, hand_over| _ = hand_over(work(stop)), poll)
}

/// Runs work as [`run_or_abandon`] does that hands its result over and is told whether it was taken: where an exception
/// has come first, it was not, and the work can undo what it did.
///
/// # Errors
/// As of [`run_or_abandon`].
pub(crate) fn run_and_hand_over<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool, &dyn Fn(T) -> bool) + Send + 'static,
    mut poll: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let (send, mut done) = channel();
    let run = move || {
        let hand_over = |result| {
            let (take, taken) = channel();
            send.send((result, take)).is_ok()
                && taken.recv_timeout(LONGEST_WAIT) != Err(RecvTimeoutError::Disconnected)
        };
        let work = AssertUnwindSafe(|| work(&flag, &|result| hand_over(Ok(result))));
        if let Err(panic) = std::panic::catch_unwind(work) {
            hand_over(Err(panic));
        }
    };
    std::thread::Builder::new().spawn(run)?;
    loop {
        let waited;
        (done, waited) = py.detach(move || {
            let waited = done.recv_timeout(POLL);
            (done, waited)
        });
        let abandon = |_: &PyErr| stop.store(true, Ordering::Relaxed);
        // Before a result is taken as well: Ctrl-C may have come while the work ended
        py.check_signals().inspect_err(abandon)?;
        if let Ok((result, take)) = waited {
            // A worker that has gone does not ask.
            let _ = take.send(());
            return result.or_else(|panic| std::panic::resume_unwind(panic));
        }
        poll(py).inspect_err(abandon)?;
    }
}

/// Runs work that looks at the flag it is given and ends soon after it is true; the interpreter is free meanwhile.
///
/// `poll` is called now and then with the interpreter attached, to report progress: its exception, as that of a signal,
/// stops the work and is passed on once it has ended.
///
/// # Errors
/// The first exception of `poll` or of a signal handler, `KeyboardInterrupt` for Ctrl-C.
pub(crate) fn run<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    mut poll: impl FnMut(Python<'_>) -> PyResult<()>,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let (send, mut done) = channel();
        let stop = &stop;
        let thread = scope.spawn(move || {
            let result = work(stop);
            // A poller that has gone is one that has stopped this work.
            let _ = send.send(());
            result
        });
        let mut raised = None;
        loop {
            // The receiver goes along and comes back: threads may not share it
            let waited;
            (done, waited) = py.detach(move || {
                let waited = done.recv_timeout(POLL);
                (done, waited)
            });
            if waited != Err(RecvTimeoutError::Timeout) {
                break;
            }
            if raised.is_none() {
                raised = py.check_signals().and_then(|()| poll(py)).err();
                stop.store(raised.is_some(), Ordering::Relaxed);
            }
        }
        let result = py.detach(|| thread.join()).unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        match raised {
            Some(error) => Err(error),
            None => py.check_signals().and_then(|()| poll(py)).map(|()| result),
        }
    })
}

/// Runs work that has nothing to report, as [`run_or_abandon`] does.
///
/// # Errors
/// As of [`run_or_abandon`], of a signal.
pub(crate) fn run_or_leave<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send + 'static,
) -> PyResult<T> {
    run_or_abandon(py, |_| work(), |_| Ok(()))
}
